//! A rough boundary as many microfacets: their slopes are as Trowbridge and Reitz have them ("GGX":
//! Walter and others, "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007), and
//! one hides another as their heights have it (Heitz, "Understanding the Masking-Shadowing Function
//! in Microfacet-Based BRDFs", Journal of Computer Graphics Techniques 3(2), 2014).
//!
//! Directions are in the frame of the surface, whose normal is +z.

use std::f64::consts::PI;

use super::fresnel;
use crate::geometry::{DVec2, DVec3};
use crate::sampling::warp;

/// The microfacets of a boundary, by the square of the roughness that people set. Zero is a mirror.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Microfacets {
    alpha: f64,
}

/// The least roughness that is not taken as smooth: below, light spreads by less than a hundredth
/// of a degree.
const SMOOTH: f64 = 1e-4;

/// The least roughness that is not smooth.
pub(super) const LEAST_ROUGHNESS: f64 = 0.01;

impl Microfacets {
    /// Microfacets with a roughness from 0 to 1.
    pub(super) fn of_roughness(roughness: f64) -> Self {
        let alpha = roughness * roughness;
        Self { alpha: if alpha < SMOOTH { 0.0 } else { alpha.min(1.0) } }
    }

    pub(super) fn is_smooth(self) -> bool {
        self.alpha == 0.0
    }

    /// The distribution of normals, D.
    fn distribution(self, normal: DVec3) -> f64 {
        let squared = self.alpha * self.alpha;
        // Not by the cosine alone, which is next to one.
        let slope = normal.x * normal.x + normal.y * normal.y;
        let stretched = normal.z * normal.z + slope / squared;
        1.0 / (PI * squared * stretched * stretched)
    }

    /// The root in Smith's functions of a cosine.
    fn smith_root(self, cosine: f64) -> f64 {
        let squared = self.alpha * self.alpha;
        (squared + (1.0 - squared) * cosine * cosine).sqrt()
    }

    /// The reflection distribution of microfacets that reflect everything: distribution times
    /// visibility, glTF's D V. None of it for a smooth boundary, which has it in one direction
    /// only.
    pub(super) fn reflection(self, out: DVec3, into: DVec3) -> f64 {
        if self.is_smooth() {
            return 0.0;
        }
        self.distribution(half(out, into)) * self.visibility(out.z, into.z)
    }

    fn visibility(self, out: f64, into: f64) -> f64 {
        0.5 / (into * self.smith_root(out) + out * self.smith_root(into))
    }

    /// The pdf of the normals that `out` sees.
    fn visible_normal_pdf(self, out: DVec3, normal: DVec3) -> f64 {
        2.0 * out.dot(normal).max(0.0) * self.distribution(normal)
            / (out.z + self.smith_root(out.z))
    }

    /// A microfacet's normal, as often as `out` sees it (Heitz, "Sampling the GGX Distribution of
    /// Visible Normals", Journal of Computer Graphics Techniques 7(4), 2018).
    pub(super) fn sample(self, out: DVec3, u: DVec2) -> DVec3 {
        self.visible_normal(out, warp::disc(u))
    }

    /// The visible normal for a point of the unit disc.
    fn visible_normal(self, out: DVec3, point: DVec2) -> DVec3 {
        let stretched = DVec3::new(self.alpha * out.x, self.alpha * out.y, out.z).normalize();
        // Level, so that what is hidden of the disc is hidden from below.
        let across = stretched.cross(DVec3::Z).try_normalize();
        let across = across.unwrap_or(DVec3::X);
        let up = across.cross(stretched);
        let rest = (1.0 - point.x * point.x).max(0.0);
        let share = 0.5 * (1.0 + stretched.z);
        let y = (1.0 - share) * rest.sqrt() + share * point.y;
        let z = (rest - y * y).max(0.0).sqrt();
        let normal = point.x * across + y * up + z * stretched;
        DVec3::new(self.alpha * normal.x, self.alpha * normal.y, normal.z.max(0.0)).normalize()
    }

    /// The reflected share and the cosine of incidence of the microfacet for a point of a disc,
    /// seen with a cosine. The point is at `radius`, and `angle` goes from 0 to 1 along half a
    /// circle; the other half is its mirror image.
    pub(super) fn seen_at(self, cosine: f64, radius: f64, angle: f64) -> [f64; 2] {
        let out = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let (sin, cos) = libm::sincos(PI * (angle - 0.5));
        let facet = self.visible_normal(out, DVec2::new(radius * cos, radius * sin));
        let into = reflected(out, facet).z;
        let all = if into > 0.0 {
            2.0 * into * (cosine + self.smith_root(cosine)) * self.visibility(cosine, into)
        } else {
            0.0
        };
        [all, out.dot(facet)]
    }

    /// The probability density of directions that the microfacets of [`sample`](Self::sample)
    /// reflect.
    pub(super) fn reflection_pdf(self, out: DVec3, into: DVec3) -> f64 {
        self.distribution(half(out, into)) / (2.0 * (out.z + self.smith_root(out.z)))
    }

    /// The normal of the microfacet that lets light through from `into` to `out`, whose sides have
    /// indices in the ratio `ior`, and how densely such normals become directions. `None` where
    /// none does. (Walter and others 2007, equations 16 and 17.)
    pub(super) fn refracting(out: DVec3, into: DVec3, ior: f64) -> Option<(DVec3, f64)> {
        let normal = -(out + ior * into);
        let normal = (normal * normal.z.signum()).try_normalize()?;
        let (above, below) = (out.dot(normal), into.dot(normal));
        let is_between = above > 0.0 && below < 0.0;
        let sum = below + above / ior;
        is_between.then(|| (normal, below.abs() / (sum * sum)))
    }

    /// The transmission distribution of radiance through microfacets that let everything through. A
    /// ray's radiance is the less the wider its cone, so it goes with the square of the indices.
    pub(super) fn refraction(
        self,
        (out, into): (DVec3, DVec3),
        (normal, spread): (DVec3, f64),
        ior: f64,
    ) -> f64 {
        let (above, below) = (out.z, into.z.abs());
        // Visibility has 4 cosines below it.
        let masked = 4.0 * self.visibility(above, below) * self.distribution(normal);
        masked * out.dot(normal) * spread / (ior * ior)
    }

    pub(super) fn refraction_pdf(self, out: DVec3, (normal, spread): (DVec3, f64)) -> f64 {
        self.visible_normal_pdf(out, normal) * spread
    }
}

/// The normal of the microfacet that reflects `into` to `out`.
pub(super) fn half(out: DVec3, into: DVec3) -> DVec3 {
    (out + into).normalize()
}

/// `out`, reflected about this normal.
pub(super) fn reflected(out: DVec3, normal: DVec3) -> DVec3 {
    2.0 * out.dot(normal) * normal - out
}

/// The direction of light that a microfacet refracts to `out`.
pub(super) fn through(out: DVec3, normal: DVec3, ior: f64) -> Option<DVec3> {
    fresnel::refracted(out, normal, ior).filter(|into| into.z < 0.0)
}

/// The transmitted direction through a thin wall: the mirror image of a reflected one.
pub(super) fn thin(direction: DVec3) -> DVec3 {
    DVec3::new(direction.x, direction.y, -direction.z)
}
