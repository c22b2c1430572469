//! Groups the triangles that lie in one plane, exactly.
//!
//! Where thousands lie in one place, as in drawings, each ray would compare all of them exactly. So
//! after as many such comparisons as there are triangles their planes are found:
//!
//! 1. Sort the triangles by their planes as float64 computes them, rounded to 20 bits.
//! 2. Of those with the same numbers each whose corners are in the plane of the first one, without
//!    rounding, is said to be in that.
//! 3. Triangles on top of one another nearly in one plane are a crowd (`crowds.rs`).
//!
//! Triangles that are not said to lie in one plane may do so nevertheless: rounding may part them.

use std::cmp::Ordering;

use super::Mesh;
use super::crowds::Crowds;
use super::weld::sort;
use crate::geometry::DVec3;
use crate::geometry::orientation::orient_3d;
use crate::memory;

/// The least size of numbers with which float64 tells the triangles that have an area.
const LEAST: f64 = 1e-60;
const MOST: f64 = 1e60;

/// The planes of a mesh's triangles.
pub(super) struct Planes {
    /// The first triangle in the plane of each triangle.
    firsts: Vec<u32>,
    /// Whether all are in one plane.
    are_one: bool,
    crowds: Option<Crowds>,
}

impl Mesh {
    /// Whether all triangles are known to lie in one plane.
    #[inline(always)]
    #[doc(hidden)]
    pub fn is_flat(&self) -> bool {
        let planes = self.closed.planes.known();
        planes.is_some_and(|planes| planes.are_one)
    }

    /// Whether two different triangles are known to lie in one plane. Neither is without an area
    /// then.
    #[inline(always)]
    #[doc(hidden)]
    pub fn are_in_one_plane(&self, one: u32, other: u32) -> bool {
        match self.closed.planes.known() {
            Some(Planes { firsts, .. }) => firsts[one as usize] == firsts[other as usize],
            None => false,
        }
    }

    /// The crowds that are known: triangles on top of one another, nearly in one plane.
    #[inline(always)]
    pub(crate) fn crowds(&self) -> Option<&Crowds> {
        self.closed.planes.known()?.crowds.as_ref()
    }

    /// Counts that the order of two triangles along a ray had to be found exactly.
    #[cold]
    #[inline(never)]
    #[doc(hidden)]
    pub fn ask_for_planes(&self) {
        let planes = &self.closed.planes;
        planes.ask(self.triangles.len(), || self.find_planes());
    }

    fn find_planes(&self) -> Option<Planes> {
        let mut firsts = memory::filled(self.triangles.len(), 0).ok()?;
        let mut keys = memory::filled(self.triangles.len(), (0, 0)).ok()?;
        let mut count = 0;
        for (triangle, plane) in (0..).zip(&mut firsts) {
            *plane = triangle;
            if let Some(key) = self.plane_key(triangle) {
                keys[count] = (key, triangle);
                count += 1;
            }
        }
        let keys = &mut keys[..count];
        sort(keys, Ord::cmp);
        for same in keys.chunk_by(|one, other| one.0 == other.0) {
            let first = same[0].1;
            let [a, b, c] = self.corners(first as usize);
            for &(_, triangle) in &same[1..] {
                let is_in = |corner: DVec3| orient_3d([a, b, c, corner]) == Ordering::Equal;
                if self.corners(triangle as usize).into_iter().all(is_in) {
                    firsts[triangle as usize] = first;
                }
            }
        }
        let are_one = count == firsts.len() && firsts.iter().all(|&first| first == firsts[0]);
        let crowds = if are_one { None } else { Crowds::find(self) };
        Some(Planes { firsts, are_one, crowds })
    }

    /// A number for the plane of a triangle, which others may have too; `None` where float64 is not
    /// sure of an area.
    fn plane_key(&self, triangle: u32) -> Option<u64> {
        let [a, b, c] = self.corners(triangle as usize);
        let (e, f) = (b - a, c - a);
        let lengths = [e, f].map(|edge| edge.abs().max_element());
        let size = self.bounds.low.abs().max(self.bounds.high.abs());
        let size = size.max_element();
        let normal = e.cross(f);
        let along = normal.abs().to_array();
        let largest = along.into_iter().fold(0.0, f64::max);
        let is_sure = largest > 64.0 * f64::EPSILON * lengths[0] * lengths[1];
        if !is_sure || size > MOST || lengths[0].min(lengths[1]) < LEAST {
            return None;
        }
        let axis = along.iter().position(|&x| x == largest)?;
        let normal = normal / normal[axis];
        let numbers = [normal.x, normal.y, normal.z, normal.dot(a) / size];
        #[expect(clippy::cast_possible_truncation, reason = "moderate numbers")]
        let rounded = numbers.map(|x| (x * f64::from(1 << 20)).round() as i64);
        Some(rounded.into_iter().fold(0, |key: u64, x| {
            (key.rotate_left(23) ^ x.cast_unsigned()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        }))
    }
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering;

    use crate::geometry::DVec3;
    use crate::geometry::orientation::orient_3d;
    use crate::shape::{Mesh, Positions};

    /// Numbers between 0 and 1 of 20 bits.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 44) as f64 / f64::from(1 << 20)
        }
    }

    #[test]
    fn planes_are_known_after_as_many_questions_as_triangles_and_are_exact() {
        let mut next = numbers();
        let mut points = Vec::new();
        // In turn level, oblique, and off that by a last bit; in the end one without an area in the
        // level plane.
        for k in 0..300 {
            for _ in 0..3 {
                let (x, y) = (next(), next());
                let z = [0.0, 0.5 * x + 0.25 * y, 0.5 * x + 0.25 * y + 2.0][k % 3];
                points.push(if k % 3 == 2 { [x, y, z.next_up()] } else { [x, y, z] });
            }
        }
        points.extend([[0.0; 3], [0.5, 0.5, 0.0], [1.0, 1.0, 0.0]]);
        let count = u32::try_from(points.len() / 3).unwrap();
        let triangles = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = Mesh::new(Positions::Double(points.into()), triangles).unwrap();
        for _ in 0..count {
            mesh.ask_for_planes();
            assert!(!mesh.are_in_one_plane(0, 0));
        }
        mesh.ask_for_planes();
        let normal = |k: u32| {
            let [a, b, c] = mesh.corners(k as usize);
            (b - a).cross(c - a) != DVec3::ZERO
        };
        for one in 0..count {
            for other in 0..one {
                let [a, b, c] = mesh.corners(one as usize);
                let is_in = |corner| orient_3d([a, b, c, corner]) == Ordering::Equal;
                let corners = mesh.corners(other as usize);
                let are_in_one = normal(one) && normal(other) && corners.into_iter().all(is_in);
                let are_known = mesh.are_in_one_plane(one, other);
                assert!(are_in_one || !are_known, "{one} {other}");
                // Those of the first two kinds are found.
                let are_of_a_kind = one % 3 == other % 3 && one % 3 != 2;
                assert!(are_known || !(are_in_one && are_of_a_kind), "{one} {other}");
            }
        }
    }
}
