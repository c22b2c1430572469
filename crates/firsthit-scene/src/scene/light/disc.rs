use std::f64::consts::PI;

use super::{LightHit, LightSample, LightSource, from_area, met_flat};
use crate::geometry::{Color, DVec2, DVec3, Domain, settings, unit};
use crate::sampling::{TangentFrame, warp};

settings! {
    /// A disc that shines on one side, evenly.
    pub struct DiscLight {
        /// The centre.
        center: DVec3, Domain::Position, required DVec3::ZERO;
        /// The side that shines; any length but zero.
        normal: DVec3, Domain::Direction, required DVec3::NEG_Z;
        /// The radius.
        radius: f64, Domain::Positive, default 1.0;
        /// The radiance: the colour that the light has itself.
        emission: Color, Domain::Light, default Color::ONE;
    }
}

impl DiscLight {
    fn area(&self) -> f64 {
        PI * self.radius * self.radius
    }
}

impl LightSource for DiscLight {
    fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample> {
        let normal = unit(self.normal);
        let TangentFrame { x, y, .. } = TangentFrame::around(normal);
        let within = self.radius * warp::disc(u);
        let point = self.center + within.x * x + within.y * y;
        from_area(at, point, normal, self.area(), self.emission)
    }

    fn intersect(&self, at: DVec3, towards: DVec3) -> Option<LightHit> {
        let plane = (self.center, unit(self.normal));
        let largest = self.radius * self.radius * (1.0 + 1e-12);
        met_flat(at, towards, plane, self.area(), self.emission, |point| {
            (point - self.center).length_squared() <= largest
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
