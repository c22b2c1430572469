//! The boundary of a dielectric: the reflected and the transmitted share of light.

use super::fresnel;
use crate::geometry::Color;

/// A boundary with glTF's `KHR_materials_ior` and `KHR_materials_specular`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dielectric {
    /// The reflectance at normal incidence, for Schlick's formula.
    f0: Color,
    weight: f64,
    tint: Color,
}

/// The reflected light of a boundary, and the share that continues into the surface or through it.
pub(super) struct Split {
    pub(super) reflected: Color,
    pub(super) on: f64,
}

impl Dielectric {
    pub(super) fn new(ior: f64, weight: f64, tint: Color) -> Self {
        let f0 = (fresnel::head_on(ior) * tint).min(Color::ONE);
        Self { f0, weight, tint }
    }

    /// The lightest colour of its reflection head on, and how much of it there is.
    pub(super) fn lightest(&self) -> (f64, f64) {
        (self.f0.max_element(), self.weight)
    }

    /// The split by Schlick's formula, as on opaque surfaces and thin walls.
    pub(super) fn schlick(&self, cosine: f64) -> Split {
        self.split(fresnel::schlick(self.f0, cosine))
    }

    /// Exactly, as on solids, whose inner side reflects as well. `ior` is the index of the other
    /// side.
    pub(super) fn exact(&self, cosine: f64, ior: f64) -> Split {
        let reflectance = fresnel::dielectric(cosine, ior);
        self.split((reflectance * self.tint).min(Color::ONE))
    }

    fn split(&self, reflectance: Color) -> Split {
        let reflected = self.weight * reflectance;
        Split {
            reflected,
            // No colour but the lightest: what is not reflected has none (KHR_materials_specular).
            on: 1.0 - reflected.max_element(),
        }
    }
}
