use std::f64::consts::PI;

use super::{LightHit, LightSample, LightSource};
use crate::geometry::{Color, DVec2, DVec3, Domain, settings};
use crate::sampling::{TangentFrame, warp};

settings! {
    /// A sphere that shines, outwards and evenly.
    ///
    /// Directions are drawn evenly from the cone in which a point sees it (Shirley, Wang and
    /// Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM Transactions on
    /// Graphics 15(1), 1996).
    pub struct SphereLight {
        /// The centre.
        center: DVec3, Domain::Position, required DVec3::ZERO;
        /// The radius.
        radius: f64, Domain::Positive, default 1.0;
        /// The radiance: the colour that the light has itself.
        emission: Color, Domain::Light, default Color::ONE;
    }
}

impl SphereLight {
    /// The vector from a point to the centre, and one minus the cosine of the cone in which the
    /// point sees the sphere; `None` from within.
    fn cone(&self, at: DVec3) -> Option<(DVec3, f64)> {
        let to_center = self.center - at;
        let share = self.radius * self.radius / to_center.length_squared();
        (share < 1.0).then(|| (to_center, share / (1.0 + (1.0 - share).sqrt())))
    }

    /// The distance to the sphere in a direction of length one that meets it.
    fn distance(&self, to_center: DVec3, towards: DVec3) -> f64 {
        let along = to_center.dot(towards);
        let beside = to_center - along * towards;
        let half = self.radius * self.radius - beside.length_squared();
        along - half.max(0.0).sqrt()
    }
}

impl LightSource for SphereLight {
    fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample> {
        let (to_center, height) = self.cone(at)?;
        let middle = to_center / to_center.length();
        let direction = TangentFrame::around(middle).world(warp::cap(u, height));
        let distance = self.distance(to_center, direction);
        // Written so that a NaN fails.
        (distance > 0.0).then(|| LightSample {
            towards: distance * direction,
            distance: 1.0,
            light: self.emission * (1.0 / (PI * warp::cap_density(height))),
            pdf: Some(warp::cap_density(height)),
        })
    }

    fn intersect(&self, at: DVec3, towards: DVec3) -> Option<LightHit> {
        let (to_center, height) = self.cone(at)?;
        let beside = to_center - to_center.dot(towards) * towards;
        let is_met = to_center.dot(towards) > 0.0
            && beside.length_squared() <= self.radius * self.radius * (1.0 + 1e-12);
        is_met.then(|| LightHit {
            distance: self.distance(to_center, towards),
            radiance: self.emission,
            pdf: warp::cap_density(height),
        })
    }

    fn has_size(&self) -> bool {
        true
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.emission *= factor;
        self
    }
}
