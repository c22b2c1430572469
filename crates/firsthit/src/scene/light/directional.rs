use super::{LightHit, LightSample, LightSource};
use crate::geometry::{Color, DVec2, DVec3, Domain, settings, unit};
use crate::sampling::{TangentFrame, warp};

settings! {
    /// Parallel light from infinitely far away. With an angle it comes from a round sun of that diameter, and shadows are soft.
    pub struct DirectionalLight {
        /// Where the light goes, not where it comes from; of any length but zero.
        direction: DVec3, Domain::Direction, required DVec3::NEG_Z;
        /// What a white surface that faces the light takes.
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

    /// What is the same for all points.
    pub(super) fn prepared(&self) -> Sun {
        let (height, towards) = (self.height(), -unit(self.direction));
        Sun {
            height,
            frame: TangentFrame::around(towards),
            parallel: -self.direction,
            // A surface that faces the middle takes `color`: the mean cosine over the sun is 1 - height / 2.
            light: self.color / (1.0 - 0.5 * height),
        }
    }
}

/// A directional light with what is the same for all points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sun {
    height: f64,
    /// Its z is towards the sun's middle.
    frame: TangentFrame,
    /// Towards the middle, of the length that was given.
    parallel: DVec3,
    light: Color,
}

impl Sun {
    pub(super) fn is_behind(&self, normal: DVec3) -> bool {
        // By the height: next to 0 the cosine would lose half of the digits.
        let sine = (self.height * (2.0 - self.height)).sqrt();
        // More than rounding below the horizon. A sun of half a turn is above every horizon in part.
        self.height < 1.0 && self.frame.z.dot(normal) < -(sine + 1e-9)
    }

    pub(super) fn sample(&self, u: DVec2) -> LightSample {
        let distance = f64::INFINITY;
        if self.height <= 0.0 {
            return LightSample {
                towards: self.parallel,
                distance,
                light: self.light,
                pdf: None,
            };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Draws;

    /// Of a sun that is behind a surface no sample is above its horizon; and one that is not is seen in part.
    #[test]
    fn suns_are_behind_surfaces_with_all_of_their_disc() {
        for angle_degrees in [0.0, 1e-7, 0.53, 60.0, 120.0, 179.0, 180.0] {
            let light = DirectionalLight {
                direction: DVec3::new(0.3, -0.5, -1.2),
                color: Color::ONE,
                angle_degrees,
            };
            let sun = light.prepared();
            let mut behind = 0;
            for turn in 0..=180 {
                let (sine, cosine) = libm::sincos(f64::from(turn).to_radians());
                let normal = cosine * sun.frame.z + sine * sun.frame.x;
                let mut numbers = (0..512).map(|sample| Draws::new(7, sample).two());
                let is_above = |u: DVec2| sun.sample(u).towards.dot(normal) > 0.0;
                let is_seen = numbers.any(is_above);
                let is_behind = sun.is_behind(normal);
                assert!(!(is_behind && is_seen), "{angle_degrees} {turn}");
                behind += u32::from(is_behind);
            }
            // From a quarter of a turn and half of the sun on.
            let expected = (90.0 - 0.5 * angle_degrees).max(0.0);
            assert!(
                (f64::from(behind) - expected).abs() <= 1.0,
                "{angle_degrees} {behind}"
            );
        }
    }
}
