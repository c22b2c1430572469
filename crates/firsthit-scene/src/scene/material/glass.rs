//! Clear matter.

use super::bsdf::{Bsdf, Frame, Layers};
use crate::geometry::{Color, Domain, settings};
use crate::scene::SurfaceInteraction;

settings! {
    /// Clear matter with a smooth boundary, as glass and water. Its surface must be closed; what
    /// passes it is multiplied by the material's colour.
    pub struct Glass {
        /// The index of refraction. Default: 1.5.
        ior: f64, Domain::Positive, default 1.5;
        /// The absorption coefficient inside, per scene unit: after a length d there is exp(-d
        /// times this) left. Default: [0, 0, 0].
        absorption: Color, Domain::Color, default Color::ZERO;
    }
}

impl Glass {
    pub(super) fn bsdf(self, surface: &SurfaceInteraction<'_>, frame: Frame, side: f64) -> Bsdf {
        let normal = surface.mapped_normal(side).unwrap_or(frame.normal);
        let layers = Layers {
            base: surface.color(),
            metallic: 0.0,
            roughness: 0.0,
            ior: self.ior,
            specular: 1.0,
            specular_color: Color::ONE,
            transmission: 1.0,
            absorption: Some(self.absorption),
            coat: (0.0, 0.0, frame.normal),
            sheen: (Color::ZERO, 0.0),
        };
        Bsdf::layered(Frame { normal, ..frame }, side > 0.0, &layers)
    }
}
