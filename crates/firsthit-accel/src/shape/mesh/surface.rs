//! Meshes as surfaces, by brute force over all triangles: scenes put a tree over them.

use std::sync::Arc;

use super::Mesh;
use crate::geometry::{Bounds, DVec3, Digest, Ray, Transform};
#[cfg(test)]
use crate::shape::Positions;
use crate::shape::triangle::Shear;
use crate::shape::{Crossing, Nearest, Surface, nearest_on_lone_triangle};

impl Surface for Arc<Mesh> {
    fn bounds(&self) -> Bounds {
        Mesh::bounds(self)
    }

    /// The support of the triangles' corners: vertices without a triangle do not count.
    fn support(&self, direction: DVec3) -> f64 {
        self.reach(direction)
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        self.first_crossing(ray, &Shear::new(ray))
    }

    fn normal(&self, _point: DVec3, primitive: i32) -> DVec3 {
        usize::try_from(primitive).map_or(DVec3::NAN, |triangle| Mesh::normal(self, triangle))
    }

    fn onto(&self, point: DVec3, _primitive: i32) -> DVec3 {
        point
    }

    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        for (primitive, triangle) in (0..).zip(0..self.triangles.len()) {
            let corners = self.corners(triangle).map(|corner| place.point_in_world(corner));
            visit(nearest_on_lone_triangle(from, corners, primitive));
        }
    }

    fn digest(&self, digest: &mut Digest) {
        Mesh::digest(self, digest);
    }
}

#[cfg(test)]
impl crate::shape::conformance::Conforming for Arc<Mesh> {
    /// An octahedron and a pyramid that leans.
    fn examples() -> Vec<Self> {
        let mesh = |points: &[[f64; 3]], triangles: &[[u32; 3]]| {
            Self::new(Mesh::new(Positions::compact(points.to_vec()), triangles.to_vec()).unwrap())
        };
        let tips =
            [[1., 0., 0.], [0., 1., 0.], [-1., 0., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
        let around = [[0, 1], [1, 2], [2, 3], [3, 0]];
        let sides: Vec<_> = around.iter().flat_map(|&[a, b]| [[a, b, 4], [b, a, 5]]).collect();
        let pyramid = [[0.1, 0., 0.], [2., 0., 0.3], [2., 2., 0.], [0., 2.2, 0.], [0.7, 0.1, 3.1]];
        let faces = [[0, 3, 2], [0, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        vec![mesh(&tips, &sides), mesh(&pyramid, &faces)]
    }

    /// The distance to the nearest triangle; inside, where every normal points away, negative.
    fn distance(&self, point: DVec3) -> f64 {
        let to = |triangle| {
            let [a, b, c] = self.corners(triangle);
            let inside = [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(p, q)| (q - p).cross(point - p).dot(Mesh::normal(self, triangle)) >= 0.0);
            let edge = |p: DVec3, q: DVec3| {
                let along = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
                (point - p - along * (q - p)).length()
            };
            let height = (point - a).dot(Mesh::normal(self, triangle));
            if inside { height.abs() } else { edge(a, b).min(edge(b, c)).min(edge(c, a)) }
        };
        let distance = (0..self.triangles.len()).map(to).fold(f64::INFINITY, f64::min);
        let behind =
            |triangle| (point - self.corners(triangle)[0]).dot(Mesh::normal(self, triangle)) < 0.0;
        if (0..self.triangles.len()).all(behind) { -distance } else { distance }
    }
}
