//! The light that a rough boundary leaves to the diffuse base below it.
//!
//! glTF's diffuse lobe is what a single microfacet lets through. It knows nothing of what others
//! reflect of light from other directions, so that both lobes together would give more than they
//! get where a surface is seen from the side, nearly twice as much where it is smooth. Here the
//! diffuse lobe is scaled by albedos, as glTF has it below its sheen: as much as is left seen from
//! either direction, of which the lesser counts, so that light may go either way. Where both lobes
//! stay within what they get, they are glTF's.

use super::albedo::{Albedos, AlbedosOfRoughness, mean};
use super::fresnel;
use super::microfacet::{LEAST_ROUGHNESS, Microfacets};

/// Albedos of microfacets that reflect everything, and of microfacets that reflect by the power of
/// [`fresnel::grazing`] alone.
static REFLECTED: Albedos<2> =
    Albedos::new(LEAST_ROUGHNESS, |cosine, roughness| reflected(cosine, roughness, [48, 16]));

/// The scale of a diffuse lobe below a boundary.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leftover {
    /// `None` for a smooth boundary.
    rough: Option<AlbedosOfRoughness<2>>,
    /// The boundary's reflectance at normal incidence, and the factor on its reflection.
    head_on: f64,
    weight: f64,
    /// The share left in the viewer's direction, and the albedo that the scaled lobe then has.
    seen: [f64; 2],
}

impl Leftover {
    /// Below a boundary of that roughness that reflects `head_on` head on, of the lightest colour,
    /// `weight` times, seen with a cosine.
    pub(super) fn new(roughness: f64, (head_on, weight): (f64, f64), cosine: f64) -> Self {
        let is_smooth = Microfacets::of_roughness(roughness).is_smooth();
        let leftover = Self {
            rough: (!is_smooth).then(|| REFLECTED.of(roughness)),
            head_on,
            weight,
            seen: [1.0; 2],
        };
        Self { seen: leftover.seen_from(cosine), ..leftover }
    }

    /// The factor on the diffuse lobe, by the cosine of the direction that light comes from.
    pub(super) fn share(&self, into: f64) -> f64 {
        self.seen[0].min(self.seen_from(into)[0])
    }

    /// The albedo of a white base's diffuse lobe in the viewer's direction, seen from the side;
    /// `None` where the lobe is glTF's.
    pub(super) fn albedo_from_side(&self) -> Option<f64> {
        (self.seen[0] < 1.0).then_some(self.seen[1])
    }

    /// The factor by the cosine of one direction, and how much the lobe then reflects.
    fn seen_from(&self, cosine: f64) -> [f64; 2] {
        let [all, grazing] = (self.rough)
            .map_or_else(|| [1.0, fresnel::grazing(cosine)], |albedos| albedos.at(cosine));
        let reflected = self.weight * (self.head_on * (all - grazing) + grazing);
        let of_facets = self.head_on + (1.0 - self.head_on) * mean_grazing(cosine);
        let diffuse = 1.0 - self.weight * of_facets;
        if reflected + diffuse > 1.0 {
            let left = (1.0 - reflected).max(0.0);
            [left / diffuse, left]
        } else {
            [1.0, diffuse]
        }
    }
}

/// See [`REFLECTED`], as a sum over the microfacets that are seen: circles of a disc, more of them
/// towards its edge, and points of half a circle.
fn reflected(cosine: f64, roughness: f64, steps: [u32; 2]) -> [f64; 2] {
    let facets = Microfacets::of_roughness(roughness);
    mean(steps, |circle, angle| {
        let rest = 1.0 - circle;
        let spread = 3.0 * rest * rest;
        let [all, facet] = facets.seen_at(cosine, (1.0 - rest * rest * rest).sqrt(), angle);
        [spread * all, spread * all * fresnel::grazing(facet)]
    })
}

/// The mean of [`fresnel::grazing`] over the microfacets that reflect light from everywhere, by its
/// cosine, to a direction: a polynomial for the sum over directions.
fn mean_grazing(cosine: f64) -> f64 {
    let x = 1.0 - cosine.abs().min(1.0);
    8.2e-5 + x * (0.002_043_6 + x * (0.009_25 + x * (0.007_851_5 + x * 0.008_939_5)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::DVec3;
    use crate::sampling::Draws;
    use crate::sampling::warp;
    use crate::scene::material::bsdf::microfacet::half;

    fn out(cosine: f64) -> DVec3 {
        DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
    }

    #[test]
    fn the_polynomial_is_the_mean_over_directions() {
        const COUNT: u32 = 1 << 12;
        for cosine in [0.0, 0.1, 0.3, 0.6, 1.0] {
            let of = |k| {
                let into = warp::cosine_hemisphere(Draws::new(5, k).two());
                fresnel::grazing(out(cosine).dot(half(out(cosine), into)))
            };
            let exact = (0..COUNT).map(of).sum::<f64>() / f64::from(COUNT);
            let found = mean_grazing(cosine);
            assert!((exact - found).abs() < 2e-4, "{cosine}: {exact} {found}");
        }
    }

    #[test]
    fn the_table_is_the_sum_from_smooth_to_rough_and_up_to_grazing_directions() {
        for roughness in [0.015, 0.05, 0.084, 0.3, 0.71, 1.0] {
            for degrees in [0.0_f64, 40.0, 70.0, 85.0, 88.6, 89.5, 89.9] {
                let cosine = libm::cos(degrees.to_radians());
                let [all, grazing] = reflected(cosine, roughness, [400, 60]);
                let [found, found_grazing] = REFLECTED.of(roughness).at(cosine);
                let dielectric = |all: f64, grazing: f64| 0.04 * all + 0.96 * grazing;
                let off = dielectric(all, grazing) - dielectric(found, found_grazing);
                assert!(
                    off < 0.002 && off > -0.004 && (all - found).abs() < 0.004,
                    "{roughness} {degrees}: {all} {found}, {grazing} {found_grazing}"
                );
            }
        }
    }
}
