use super::{LightSample, LightSource};
use crate::geometry::{Color, DVec2, DVec3, Domain, settings};

settings! {
    /// Light from one point, falling off with the square of the distance.
    pub struct PointLight {
        /// The light's position.
        position: DVec3, Domain::Position, required DVec3::ZERO;
        /// The irradiance over pi of a surface that faces the light at distance 1, which is the
        /// radiant intensity over pi; it falls off with the square of the distance.
        intensity: Color, Domain::Light, default Color::ONE;
    }
}

impl LightSource for PointLight {
    fn sample(&self, at: DVec3, _u: DVec2) -> Option<LightSample> {
        let towards = self.position - at;
        Some(LightSample {
            towards,
            distance: 1.0,
            light: self.intensity / towards.length_squared(),
            pdf: None,
        })
    }

    fn has_size(&self) -> bool {
        false
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.intensity *= factor;
        self
    }
}
