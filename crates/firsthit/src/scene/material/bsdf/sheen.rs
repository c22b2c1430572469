//! The fuzz of cloth: glTF's `KHR_materials_sheen`, after Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF" (SIGGRAPH
//! Courses 2017).

use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use super::microfacet::half;
use crate::geometry::{Color, DVec3};
use crate::parallel;

/// A layer of fibres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheen {
    color: Color,
    roughness: f64,
    /// What it reflects of white light from everywhere, to whoever looks.
    albedo: f64,
}

/// With less than this, fibres stand so straight that nothing is seen of them.
const LEAST_ROUGHNESS: f64 = 0.07;

impl Sheen {
    /// `None` for one that is black.
    pub(super) fn new(color: Color, roughness: f64, out: DVec3) -> Option<Self> {
        let roughness = roughness.max(LEAST_ROUGHNESS);
        (color.max_element() > 0.0).then(|| Self {
            color,
            roughness,
            albedo: albedo(out.z, roughness),
        })
    }

    pub(super) fn value(&self, out: DVec3, into: DVec3) -> Color {
        self.color * distribution(self.roughness, out, into)
    }

    /// What it leaves to the layers below.
    pub(super) fn left(&self, into: DVec3) -> f64 {
        let albedo = self.albedo.max(albedo(into.z.abs(), self.roughness));
        (1.0 - self.color.max_element() * albedo).max(0.0)
    }

    /// How bright it is, to whoever looks.
    pub(super) fn brightness(&self) -> f64 {
        self.color.max_element() * self.albedo
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

/// Their function Lambda.
fn masked(cosine: f64, alpha: f64) -> f64 {
    let exponent = if cosine < 0.5 {
        fitted(cosine, alpha)
    } else {
        2.0 * fitted(0.5, alpha) - fitted(1.0 - cosine, alpha)
    };
    libm::exp(exponent)
}

/// Their table 1, between alpha 0 and 1.
fn fitted(x: f64, alpha: f64) -> f64 {
    let rest = (1.0 - alpha) * (1.0 - alpha);
    let between = |zero: f64, one: f64| one + rest * (zero - one);
    let [a, b, c] = [
        between(25.3245, 21.5473),
        between(3.32435, 3.82987),
        between(0.16801, 0.19823),
    ];
    let [d, e] = [between(-1.27393, -1.97760), between(-4.85967, -4.32054)];
    a / (1.0 + b * libm::pow(x, c)) + d * x + e
}

const SIDE: usize = 24;

/// The albedo for cosines (the columns) and roughnesses (the rows) from 0 to 1.
fn albedos() -> &'static [[f64; SIDE]; SIDE] {
    static ALBEDOS: OnceLock<[[f64; SIDE]; SIDE]> = OnceLock::new();
    parallel::once(&ALBEDOS, || {
        let step = 1.0 / (SIDE - 1) as f64;
        std::array::from_fn(|row| {
            let roughness = (row as f64 * step).max(LEAST_ROUGHNESS);
            let cosine = |column| (column as f64 * step).max(1e-3);
            std::array::from_fn(|column| integrated(cosine(column), roughness, 32))
        })
    })
}

/// The albedo as a sum over directions: `steps` cosines, as many angles over half a turn.
fn integrated(cosine: f64, roughness: f64, steps: u32) -> f64 {
    let out = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
    let at = |row: u32, column: u32| {
        let (sin, cos) = libm::sincos(PI * middle(column));
        let z = middle(row);
        let radius = (1.0 - z * z).sqrt();
        z * distribution(roughness, out, DVec3::new(radius * cos, radius * sin, z))
    };
    let sum: f64 = (0..steps * steps).map(|k| at(k / steps, k % steps)).sum();
    TAU * sum / f64::from(steps * steps)
}

/// The albedo between the table's entries.
fn albedo(cosine: f64, roughness: f64) -> f64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and SIDE - 2"
    )]
    let place = |x: f64| {
        let x = x.clamp(0.0, 1.0) * (SIDE - 1) as f64;
        let cell = x.floor().min((SIDE - 2) as f64);
        (cell as usize, x - cell)
    };
    let ((row, down), (column, across)) = (place(roughness), place(cosine));
    let along = |row: usize| {
        let [a, b] = [albedos()[row][column], albedos()[row][column + 1]];
        a + across * (b - a)
    };
    along(row) + down * (along(row + 1) - along(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_integral() {
        for roughness in [0.2, 0.33, 0.7, 1.0] {
            for cosine in [0.1, 0.3, 0.55, 1.0] {
                let exact = integrated(cosine, roughness, 400);
                let found = albedo(cosine, roughness);
                assert!(
                    (exact - found).abs() < 0.01,
                    "{roughness} {cosine}: {exact} {found}"
                );
            }
        }
    }
}
