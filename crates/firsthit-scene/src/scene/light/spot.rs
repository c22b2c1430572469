use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::{LightSample, LightSource};
use crate::geometry::{Color, DVec2, DVec3, Domain, settings, unit};

settings! {
    /// Light from one point into a cone, falling off with the square of the distance, and from full
    /// light at the inner angle to none at the outer one.
    pub struct SpotLight {
        /// The light's position.
        position: DVec3, Domain::Position, required DVec3::ZERO;
        /// The direction of the cone's axis; any length but zero.
        direction: DVec3, Domain::Direction, required DVec3::NEG_Z;
        /// The irradiance over pi of a surface that faces the light at distance 1 on the cone's
        /// axis, which is the radiant intensity there over pi.
        intensity: Color, Domain::Light, default Color::ONE;
        /// Between the middle and the end of full light, in radians; less than the outer angle.
        inner_angle: f64, Domain::From(0.0, FRAC_PI_2), default 0.0;
        /// Between the middle and the end of all light, in radians; at most a quarter turn.
        outer_angle: f64, Domain::From(0.0, FRAC_PI_2), default FRAC_PI_4;
    }
}

impl LightSource for SpotLight {
    fn sample(&self, at: DVec3, _u: DVec2) -> Option<LightSample> {
        let towards = self.position - at;
        let along = unit(-towards).dot(unit(self.direction));
        let share = within_cone(along, self.inner_angle, self.outer_angle);
        Some(LightSample {
            towards,
            distance: 1.0,
            light: share * self.intensity / towards.length_squared(),
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

/// The falloff of a spot's light towards its edge: the square of the cosine's way from the outer
/// angle to the inner one, as `KHR_lights_punctual` suggests.
fn within_cone(cosine: f64, inner_angle: f64, outer_angle: f64) -> f64 {
    let (inner, outer) = (libm::cos(inner_angle), libm::cos(outer_angle));
    let share = ((cosine - outer) / (inner - outer).max(1e-9)).clamp(0.0, 1.0);
    share * share
}
