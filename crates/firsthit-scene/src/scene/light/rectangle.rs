use super::{LightHit, LightSample, LightSource, from_area, met_flat};
use crate::geometry::{Color, DVec2, DVec3, Domain, settings};

settings! {
    /// A rectangle, or another parallelogram, that shines on one side, evenly: on the side from
    /// which the turn from `edge_u` to `edge_v` is counter-clockwise.
    pub struct RectangleLight {
        /// The centre.
        center: DVec3, Domain::Position, required DVec3::ZERO;
        /// The vector from one edge to the opposite one.
        edge_u: DVec3, Domain::Direction, required DVec3::Y;
        /// The vector from another edge to the opposite one, not parallel to the first.
        edge_v: DVec3, Domain::Direction, required DVec3::X;
        /// The radiance: the colour that the light has itself.
        emission: Color, Domain::Light, default Color::ONE;
    }
}

impl LightSource for RectangleLight {
    fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample> {
        let normal = self.edge_u.cross(self.edge_v);
        let area = normal.length();
        let point = self.center + (u.x - 0.5) * self.edge_u + (u.y - 0.5) * self.edge_v;
        from_area(at, point, normal / area, area, self.emission)
    }

    fn intersect(&self, at: DVec3, towards: DVec3) -> Option<LightHit> {
        let normal = self.edge_u.cross(self.edge_v);
        let area = normal.length();
        let plane = (self.center, normal / area);
        met_flat(at, towards, plane, area, self.emission, |point| {
            // The shares of the edges, by Cramer's rule in the plane.
            let from = point - self.center;
            let u = from.cross(self.edge_v).dot(normal) / (area * area);
            let v = self.edge_u.cross(from).dot(normal) / (area * area);
            u.abs().max(v.abs()) <= 0.5 * (1.0 + 1e-12)
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
