//! The triangles of one object that the plane crosses: a segment of each.

use std::cmp::Ordering;

use super::plane::SectionPlane;
use crate::error::Result;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::difference;
use crate::geometry::exact::{Scaled, determinant};
use crate::geometry::{Bounds, DVec3, Ray, Transform, compare_points};
use crate::memory;
use crate::parallel;
use crate::scene::Object;
use crate::shape::{Facing, Mesh};
use crate::watch::{Watch, stop_if_asked};

/// The number of triangles that are looked at between two questions whether to stop.
pub(super) const CHUNK: usize = 1 << 14;

/// An edge, by its ends in the world: the lower one first, in the order of x, then y, then z. No
/// zero in it is negative. So triangles that meet at an edge have the same one, whether or not they
/// share vertices.
pub(super) type Edge = [DVec3; 2];

/// The part of a triangle in the plane: from the edge at which its border leaves the positive side
/// to the one at which it comes back. The inside of a solid is then on the left, seen from where
/// the normal points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// The edges of its start and its end.
    pub(super) edges: [Edge; 2],
    pub(super) primitive: i32,
}

/// An object's mesh in the world.
pub(super) struct Placed<'a> {
    mesh: &'a Mesh,
    transform: &'a Transform,
    /// Whether the transform turns the outside in.
    is_mirrored: bool,
}

impl<'a> Placed<'a> {
    /// `None` for an object that is not a mesh.
    pub(super) fn new(object: &'a Object) -> Option<Self> {
        let transform = object.transform();
        Some(Self { mesh: object.mesh()?, transform, is_mirrored: is_mirrored(transform) })
    }

    /// A box around its points as they are in the world, to the last bit: a point and the box's
    /// corners go through the same operations, and rounding is monotone.
    fn bounds(&self) -> Bounds {
        let bounds = self.mesh.bounds();
        if self.transform.is_identity() {
            return bounds;
        }
        bounds.transformed(self.transform.world_from_object())
    }

    /// Whether its coordinates in the world are within the range of all that is computed.
    pub(super) fn is_in_range(&self) -> bool {
        let Bounds { low, high } = self.bounds();
        let largest = low.abs().max(high.abs());
        self.bounds().is_empty() || largest.cmple(DVec3::splat(Ray::FARTHEST)).all()
    }

    /// Whether all of it is on one side. The vertices on the plane count as positive.
    fn is_on_one_side(&self, plane: &SectionPlane) -> bool {
        let corners = self.bounds().corners();
        let above = corners.map(|corner| plane.side(corner) != Ordering::Less);
        above.iter().all(|&is_above| is_above == above[0])
    }

    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        let corners = self.mesh.corners(triangle);
        // Adding zero makes negative zeros positive.
        if self.transform.is_identity() {
            return corners.map(|corner| corner + DVec3::ZERO);
        }
        let world_from_object = self.transform.world_from_object();
        corners.map(|corner| world_from_object.transform_point3(corner) + DVec3::ZERO)
    }

    /// The facing of the mesh's triangles.
    pub(super) fn facing(&self) -> Result<&'a Facing> {
        self.mesh.facing()
    }

    pub(super) fn is_closed(&self) -> Result<bool> {
        self.mesh.is_closed()
    }

    /// The segments of all triangles that the plane crosses, in the order of the triangles. They
    /// face as their corners say, or as `facing` does.
    pub(super) fn segments(
        &self,
        plane: &SectionPlane,
        facing: Option<&Facing>,
        watch: &dyn Watch,
    ) -> Result<Vec<Segment>> {
        let count = self.mesh.triangles().len();
        if self.mesh.bounds().is_empty() || self.is_on_one_side(plane) {
            return Ok(Vec::new());
        }
        memory::check("the triangles of a section", count.saturating_mul(size_of::<u32>()))?;
        let crossed = in_chunks(count, watch, |triangle| {
            let above = above(plane, &self.corners(triangle));
            (above[0] != above[1] || above[0] != above[2]).then_some(triangle)
        })?;
        let bytes = crossed.len().saturating_mul(2 * size_of::<Segment>());
        memory::check("the segments of a section", bytes)?;
        in_chunks(crossed.len(), watch, |k| {
            let is_turned = facing.is_some_and(|facing| facing.is_turned(crossed[k]));
            self.segment(plane, crossed[k], is_turned)
        })
    }

    /// The segment of a triangle that the plane crosses. One that starts and ends at the same edge,
    /// for two of the triangle's corners are in one place, is none.
    fn segment(&self, plane: &SectionPlane, triangle: usize, is_turned: bool) -> Option<Segment> {
        let corners = self.corners(triangle);
        let above = above(plane, &corners);
        let edge = |leaves: bool| {
            let is_it = |&k: &usize| above[k] == leaves && above[(k + 1) % 3] != leaves;
            let k = (0..3).find(is_it)?;
            Some(edge_between(corners[k], corners[(k + 1) % 3]))
        };
        let [start, end] = [edge(true)?, edge(false)?];
        let edges = if self.is_mirrored == is_turned { [start, end] } else { [end, start] };
        let primitive = i32::try_from(triangle).unwrap_or(i32::MAX);
        (start != end).then_some(Segment { edges, primitive })
    }
}

/// Whether each corner is on the positive side: those on the plane are.
fn above(plane: &SectionPlane, corners: &[DVec3; 3]) -> [bool; 3] {
    corners.map(|corner| plane.side(corner) != Ordering::Less)
}

fn edge_between(a: DVec3, b: DVec3) -> Edge {
    if compare_points(a, b) == Ordering::Greater { [b, a] } else { [a, b] }
}

/// Whether a transform makes a left hand of a right one.
fn is_mirrored(transform: &Transform) -> bool {
    let matrix = transform.world_from_object().matrix3;
    let column =
        |column: DVec3| Scaled::new(&column.to_array().map(|x| difference(Scalar, x, 0.0)));
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(column);
    determinant(&x, &y, &z).high < 0.0
}

/// Maps `of` over the numbers below `count`, in their order, by all threads.
fn in_chunks<T: Send>(
    count: usize,
    watch: &dyn Watch,
    of: impl Fn(usize) -> Option<T> + Sync,
) -> Result<Vec<T>> {
    let part = |chunk: usize| {
        stop_if_asked(watch)?;
        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
        Ok(range.filter_map(&of).collect::<Vec<T>>())
    };
    let parts = parallel::try_map(0..count.div_ceil(CHUNK), part)?;
    Ok(parts.into_iter().flatten().collect())
}
