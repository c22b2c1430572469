use super::{LightHit, LightSample, LightSource};
use crate::geometry::{Color, DVec2, DVec3, Domain, settings, unit};
use crate::sampling::{TangentFrame, warp};

settings! {
    /// Parallel light from infinitely far away. With an angle it comes from a round sun of that
    /// diameter, and shadows are soft.
    pub struct DirectionalLight {
        /// The direction in which the light goes, not where it comes from; of any length but zero.
        direction: DVec3, Domain::Direction, required DVec3::NEG_Z;
        /// The irradiance over pi of a surface that faces the light.
        color: Color, Domain::Light, default Color::ONE;
        /// The diameter of the sun as an angle, in degrees; that of Earth's sun is 0.53.
        angle_degrees: f64, Domain::From(0.0, 180.0), default 0.0;
    }
}

impl DirectionalLight {
    /// One minus the cosine of the angle from the sun's middle to its edge.
    fn height(&self) -> f64 {
        // By half the angle: next to 0 the cosine itself would lose half of the digits.
        let sine = libm::sin(0.25 * self.angle_degrees.to_radians());
        2.0 * sine * sine
    }

    /// Precomputes the parts that are equal for all points.
    pub(super) fn prepared(&self) -> Sun {
        let (height, towards) = (self.height(), -unit(self.direction));
        Sun {
            height,
            frame: TangentFrame::around(towards),
            parallel: -self.direction,
            // A surface that faces the middle takes `color`: the mean cosine over the sun is 1 -
            // height / 2.
            light: self.color / (1.0 - 0.5 * height),
        }
    }
}

/// A directional light with what is the same for all points.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Sun {
    height: f64,
    /// The frame whose z is towards the sun's middle.
    frame: TangentFrame,
    /// Towards the middle, of the length that was given.
    parallel: DVec3,
    light: Color,
}

impl Sun {
    #[inline(always)]
    pub fn sample(&self, u: DVec2) -> LightSample {
        let distance = f64::INFINITY;
        if self.height <= 0.0 {
            return LightSample { towards: self.parallel, distance, light: self.light, pdf: None };
        }
        LightSample {
            towards: self.frame.world(warp::cap(u, self.height)),
            distance,
            light: self.light,
            pdf: Some(warp::cap_density(self.height)),
        }
    }
}

impl LightSource for DirectionalLight {
    fn sample(&self, _at: DVec3, u: DVec2) -> Option<LightSample> {
        Some(self.prepared().sample(u))
    }

    fn intersect(&self, _at: DVec3, towards: DVec3) -> Option<LightHit> {
        let height = self.height();
        let away = towards + unit(self.direction);
        // The square of a chord between two directions is twice one minus their cosine.
        let is_met = height > 0.0 && 0.5 * away.length_squared() <= height * (1.0 + 1e-12);
        is_met.then(|| LightHit {
            distance: f64::INFINITY,
            radiance: self.color / (2.0 * height * (1.0 - 0.5 * height)),
            pdf: warp::cap_density(height),
        })
    }

    fn has_size(&self) -> bool {
        self.angle_degrees > 0.0
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.color *= factor;
        self
    }
}
