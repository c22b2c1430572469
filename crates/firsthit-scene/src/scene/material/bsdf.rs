//! The scattering of light by a surface: its bidirectional scattering distribution function (BSDF).

mod albedo;
mod coat;
mod dielectric;
mod frame;
mod fresnel;
mod lambertian;
mod layered;
mod leftover;
mod lobes;
mod microfacet;
mod sheen;
#[cfg(test)]
mod tests;

use std::f64::consts::PI;

pub(super) use coat::coat_share;
pub(super) use frame::Frame;
#[doc(hidden)]
pub use lambertian::Lambertian;
pub(super) use layered::Layers;

use layered::Layered;

use crate::geometry::{Color, DVec2, DVec3, is_light, unit};
use crate::scene::{Material, SurfaceInteraction};

/// The bidirectional scattering distribution function at a point of a surface, for the ray that
/// sees it.
///
/// All directions are in the world, of length one, and point away from the surface.
#[derive(Debug, Clone)]
pub struct Bsdf {
    frame: Frame,
    kind: BsdfKind,
    /// The absorption coefficient inside of a clear solid, per scene unit; and whether the surface
    /// is seen from outside.
    inside: Option<Color>,
    is_front: bool,
    occlusion: f64,
}

#[derive(Debug, Clone)]
enum BsdfKind {
    /// Lambert's, of this albedo.
    Matte(Color),
    /// The layered model, boxed because it is large and most surfaces are matte.
    Layered(Box<Layered>),
}

/// A direction drawn of a [`Bsdf`]: light that comes from there is scattered to the ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// The direction that light comes from.
    pub towards: DVec3,
    /// The factor on the radiance from there: the distribution times the cosine, divided by the
    /// probability density.
    pub weight: Color,
    /// The probability density of this direction, per steradian; `None` where there is one
    /// direction only, as in a mirror.
    pub pdf: Option<f64>,
}

impl BsdfSample {
    /// The only direction of its kind; `None` without light.
    fn single(towards: DVec3, weight: Color) -> Option<Self> {
        is_light(weight).then_some(Self { towards, weight, pdf: None })
    }

    /// The sample, weighted for a draw with the probability `share`.
    fn drawn(self, share: f64) -> Self {
        let weight = self.weight / share;
        Self { weight, ..self }
    }
}

impl SurfaceInteraction<'_> {
    /// The scattering where that is all that the surface does to light: it is matte, has neither a
    /// normal map nor an occlusion map, and emits nothing. The normals are NaN where it has none.
    #[inline]
    #[doc(hidden)]
    pub fn plain_matte(&self) -> Option<Lambertian> {
        if !self.material().is_none_or(Material::is_plain_matte) {
            return None;
        }
        let [normal, geometric] = self.seen_normals();
        Some(Lambertian { normal, geometric, albedo: self.color() })
    }

    /// The shading normal, of length one, and that of the face, both on the side that is seen.
    #[inline]
    fn seen_normals(&self) -> [DVec3; 2] {
        let side = self.side();
        [side * self.shading_normal(), side * self.normal()]
    }

    /// The surface's scattering distribution for the ray; `None` where it has no normal.
    pub fn bsdf(&self) -> Option<Bsdf> {
        let normal = self.normal();
        if !normal.is_finite() {
            return None;
        }
        let side = self.side();
        let [normal, geometric] = self.seen_normals();
        let frame = Frame { normal, geometric, out: -unit(self.ray().direction) };
        let bsdf = match self.material() {
            None => Bsdf::even(frame, self.color()),
            Some(material) => material.model.bsdf(self, frame, side),
        };
        Some(Bsdf { is_front: side > 0.0, occlusion: self.occlusion(), ..bsdf })
    }
}

impl Bsdf {
    fn new(frame: Frame, kind: BsdfKind) -> Self {
        Self { frame, kind, inside: None, is_front: true, occlusion: 1.0 }
    }

    /// The scattering of a matte surface.
    pub fn matte(normal: DVec3, color: Color) -> Self {
        let frame = Frame { normal, geometric: normal, out: normal };
        Self::even(frame, color)
    }

    /// A matte BSDF in a frame.
    pub(super) fn even(frame: Frame, color: Color) -> Self {
        Self::new(frame, BsdfKind::Matte(color))
    }

    /// A layered BSDF in a frame.
    pub(super) fn layered(frame: Frame, is_front: bool, layers: &Layers) -> Self {
        let frame = frame.bent();
        let kind = BsdfKind::Layered(Box::new(Layered::new(&frame, layers, is_front)));
        Self {
            inside: layers.absorption.filter(|_| layers.transmission > 0.0),
            ..Self::new(frame, kind)
        }
    }

    /// The normal of the face, on the side that is seen.
    pub fn geometric(&self) -> DVec3 {
        self.frame.geometric
    }

    /// The reflected radiance for light from one direction: pi times the bidirectional scattering
    /// distribution, times the cosine to the normal. So it is the cosine for a white matte surface.
    /// Mirror reflection is not in it: see [`branches`](Self::branches).
    pub fn value(&self, towards: DVec3) -> Color {
        match &self.kind {
            BsdfKind::Matte(color) => Lambertian::new(&self.frame, *color).value(towards),
            BsdfKind::Layered(layered) => PI * layered.value(&self.frame, towards),
        }
    }

    /// The probability density with which [`sample`](Self::sample) draws a direction, per
    /// steradian. Single directions have none.
    pub fn pdf(&self, towards: DVec3) -> f64 {
        match &self.kind {
            BsdfKind::Matte(color) => Lambertian::new(&self.frame, *color).pdf(towards),
            BsdfKind::Layered(layered) => layered.pdf(&self.frame, towards),
        }
    }

    /// A direction that light may come from, for three numbers from 0 to 1. `None` where none is
    /// scattered.
    pub fn sample(&self, u: [f64; 3]) -> Option<BsdfSample> {
        match &self.kind {
            BsdfKind::Matte(color) => {
                Lambertian::new(&self.frame, *color).sample(DVec2::new(u[0], u[1]))
            }
            BsdfKind::Layered(layered) => layered.sample(&self.frame, u),
        }
    }

    /// The directions in which a mirror or clear matter shows something: each that light comes from
    /// in one way only, and the exact weight of its radiance. They and [`value`](Self::value) are
    /// all that the surface scatters.
    pub fn branches(&self) -> impl Iterator<Item = BsdfSample> {
        let branches = match &self.kind {
            BsdfKind::Matte(_) => [None; 3],
            BsdfKind::Layered(layered) => layered.branches(&self.frame),
        };
        branches.into_iter().flatten()
    }

    /// Whether light is scattered evenly in all directions.
    pub fn is_diffuse(&self) -> bool {
        matches!(self.kind, BsdfKind::Matte(_))
    }

    /// The scattering by itself where it is that of a matte surface.
    #[doc(hidden)]
    pub fn lambertian(&self) -> Option<Lambertian> {
        match self.kind {
            BsdfKind::Matte(color) => Some(Lambertian::new(&self.frame, color)),
            BsdfKind::Layered(_) => None,
        }
    }

    /// The share of light from all directions that reaches the surface by the occlusion map; 1
    /// without one.
    pub fn occlusion(&self) -> f64 {
        self.occlusion
    }

    /// The absorption coefficient on the way that the ray has come, per scene unit, where it meets
    /// the surface of a clear solid from inside. See [`beyond`](Self::beyond).
    pub fn behind(&self) -> Option<Color> {
        self.inside.filter(|_| !self.is_front)
    }

    /// The index of refraction beyond the surface, divided by that of the side that is seen, for a
    /// ray that continues through it in a direction. 1 where the ray stays on its side, and for
    /// thin walls. Refraction divides radiance by its square.
    pub fn eta(&self, towards: DVec3) -> f64 {
        match &self.kind {
            BsdfKind::Layered(layered) if towards.dot(self.frame.geometric) < 0.0 => {
                layered.ior.unwrap_or(1.0)
            }
            _ => 1.0,
        }
    }

    /// The absorption coefficient beyond the surface of a clear solid, per scene unit, for a ray
    /// that continues through it in a direction; `None` where the ray stays on its side. After a
    /// length d, exp(-d times this) is left of light (Beer, 1852).
    pub fn beyond(&self, towards: DVec3) -> Option<Color> {
        let absorption = self.inside?;
        let goes_through = towards.dot(self.frame.geometric) < 0.0;
        goes_through.then_some(if self.is_front { absorption } else { Color::ZERO })
    }
}
