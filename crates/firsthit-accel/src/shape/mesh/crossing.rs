//! A ray and the triangles of a mesh: where they meet, and which of two crossings is first.

use std::cmp::Ordering;

use crate::geometry::Ray;
use crate::shape::triangle::{EdgeRule, Meeting, Shear, TriangleHit, are_close};
use crate::shape::{Crossing, Mesh};

impl Mesh {
    /// Intersects the ray of `shear` with a triangle, at any `t`.
    pub fn intersect_triangle(
        &self,
        triangle: usize,
        edges: EdgeRule,
        shear: &Shear,
    ) -> Option<TriangleHit> {
        shear.intersect_with(edges, self.corners(triangle))
    }

    /// Whether `new` is the first of two crossings of a ray with triangles of the mesh: the one
    /// with the smaller nearest `t`, of equal ones the lower triangle.
    #[inline]
    #[doc(hidden)]
    pub fn precedes(&self, ray: &Ray, new: &Crossing, old: &Crossing) -> bool {
        if are_close(new.t, old.t) { self.precedes_closely(ray, new, old) } else { new.t < old.t }
    }

    #[cold]
    fn precedes_closely(&self, ray: &Ray, new: &Crossing, old: &Crossing) -> bool {
        let key = |crossing: &Crossing| (self.nearest_t(ray, crossing), crossing.primitive);
        key(new) < key(old)
    }

    /// The float64 nearest to the exact `t` of a crossing.
    #[inline]
    #[doc(hidden)]
    pub fn nearest_t(&self, ray: &Ray, crossing: &Crossing) -> f64 {
        let meeting = self.meeting(ray, crossing);
        meeting.map_or(crossing.t, |meeting| meeting.nearest_t())
    }

    /// The order along a ray of two crossings with the same nearest `t`: see `triangle/crossed.rs`.
    /// Of triangles in one place the lower index is first.
    #[doc(hidden)]
    pub fn compare(&self, ray: &Ray, one: &Crossing, other: &Crossing) -> Ordering {
        let [first, second] = [one, other].map(|crossing| self.meeting(ray, crossing));
        let order = match (first, second) {
            // Exact arithmetic would find them equal, but many copies are many comparisons.
            (Some(first), Some(second)) if !first.is_in_place_of(&second) => first.compare(&second),
            _ => Ordering::Equal,
        };
        order.then(one.primitive.cmp(&other.primitive))
    }

    #[inline]
    fn meeting(&self, ray: &Ray, crossing: &Crossing) -> Option<Meeting<f64>> {
        let triangle = usize::try_from(crossing.primitive).ok()?;
        Some(Meeting::new(ray.origin, ray.direction, self.corners(triangle)))
    }

    /// The first crossing of a ray that is ready for triangles, by brute force.
    pub(crate) fn first_crossing(&self, ray: &Ray, shear: &Shear) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        for (triangle, primitive) in (0..self.triangles.len()).zip(0..) {
            if let Some(hit) = self.intersect_triangle(triangle, EdgeRule::Closed, shear)
                && ray.holds(hit.t)
            {
                let new = hit.crossing(primitive);
                if first.is_none_or(|first| self.precedes(ray, &new, &first)) {
                    first = Some(new);
                }
            }
        }
        first
    }
}
