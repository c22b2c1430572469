//! The fuzz of cloth: glTF's `KHR_materials_sheen`, after Estevez and Kulla, "Production Friendly
//! Microfacet Sheen BRDF" (SIGGRAPH Courses 2017).

use std::f64::consts::{PI, TAU};

use super::albedo::{Albedos, AlbedosOfRoughness, mean};
use super::microfacet::half;
use crate::geometry::{Color, DVec3};

/// A layer of fibres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheen {
    color: Color,
    roughness: f64,
    albedos: AlbedosOfRoughness<1>,
    /// The albedo by the model's formula in the viewer's direction: above 1 where the surface is
    /// seen from the side.
    albedo: f64,
}

/// The least roughness of a sheen that shows: below, fibres stand too straight.
const LEAST_ROUGHNESS: f64 = 0.07;

static ALBEDOS: Albedos<1> =
    Albedos::new(LEAST_ROUGHNESS, |cosine, roughness| albedo(cosine, roughness, [32, 24]));

impl Sheen {
    /// `None` for one that is black.
    pub(super) fn new(color: Color, roughness: f64, out: DVec3) -> Option<Self> {
        let roughness = roughness.max(LEAST_ROUGHNESS);
        (color.max_element() > 0.0).then(|| {
            let albedos = ALBEDOS.of(roughness);
            let [albedo] = albedos.at(out.z);
            Self { color, roughness, albedos, albedo }
        })
    }

    /// The larger albedo of both directions: with either it gives no more than it gets.
    fn largest_albedo(&self, into: DVec3) -> f64 {
        let [albedo] = self.albedos.at(into.z);
        self.albedo.max(albedo)
    }

    pub(super) fn value(&self, out: DVec3, into: DVec3) -> Color {
        let most = self.largest_albedo(into).max(1.0);
        self.color * (distribution(self.roughness, out, into) / most)
    }

    /// The share of light that the sheen leaves to the layers below.
    pub(super) fn left(&self, into: DVec3) -> f64 {
        let albedo = self.largest_albedo(into).min(1.0);
        (1.0 - self.color.max_element() * albedo).max(0.0)
    }

    /// The approximate albedo in the viewer's direction.
    pub(super) fn brightness(&self) -> f64 {
        self.color.max_element() * self.albedo.min(1.0)
    }
}

fn distribution(roughness: f64, out: DVec3, into: DVec3) -> f64 {
    let alpha = roughness * roughness;
    let normal = half(out, into);
    let sine = (1.0 - normal.z * normal.z).max(0.0).sqrt();
    let distribution = (2.0 + 1.0 / alpha) * libm::pow(sine, 1.0 / alpha) / TAU;
    let hidden = 1.0 + masked(out.z, alpha) + masked(into.z, alpha);
    distribution / (hidden * 4.0 * out.z * into.z)
}

/// The masking function Lambda of the paper.
fn masked(cosine: f64, alpha: f64) -> f64 {
    let exponent = if cosine < 0.5 {
        fitted(cosine, alpha)
    } else {
        2.0 * fitted(0.5, alpha) - fitted(1.0 - cosine, alpha)
    };
    libm::exp(exponent)
}

/// The fit of the paper's table 1, between alpha 0 and 1.
fn fitted(x: f64, alpha: f64) -> f64 {
    let rest = (1.0 - alpha) * (1.0 - alpha);
    let between = |zero: f64, one: f64| one + rest * (zero - one);
    let [a, b, c] =
        [between(25.3245, 21.5473), between(3.32435, 3.82987), between(0.16801, 0.19823)];
    let [d, e] = [between(-1.27393, -1.97760), between(-4.85967, -4.32054)];
    a / (1.0 + b * libm::pow(x, c)) + d * x + e
}

/// The albedo as a sum over directions: cosines and angles of half a turn, more of both where light
/// comes from the side and from behind.
fn albedo(cosine: f64, roughness: f64, steps: [u32; 2]) -> [f64; 1] {
    let out = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    mean(steps, |row, column| {
        let (sin, cos) = libm::sincos(PI * column * column);
        let z = row * row;
        let radius = (1.0 - z * z).sqrt();
        let into = DVec3::new(radius * cos, radius * sin, z);
        let spread = 4.0 * row * column;
        [TAU * spread * z * distribution(roughness, out, into)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_integral() {
        for roughness in [0.07, 0.075, 0.2, 0.33, 0.7, 0.96] {
            for cosine in [0.002, 0.01, 0.03, 0.1, 0.3, 0.55, 1.0] {
                let [exact] = albedo(cosine, roughness, [400, 100]);
                let [found] = ALBEDOS.of(roughness).at(cosine);
                assert!(
                    (exact - found).abs() < 0.003 * exact.max(1.0),
                    "{roughness} {cosine}: {exact} {found}"
                );
            }
        }
    }
}
