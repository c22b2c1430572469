//! The points of shapes that are nearest to a point, in the world.
//!
//! Distances do not survive a transform that stretches, so each shape measures in the world: it
//! takes itself there first. Shapes are compared by the square of the distance, as the
//! float64 number that they say.

mod ellipse;
mod segment;
mod triangle;

pub(crate) use ellipse::{Principal, onto_ellipse};
pub(crate) use triangle::nearest_on_lone_triangle;
#[doc(hidden)]
pub use triangle::nearest_on_triangle;

use crate::geometry::{DMat3, DVec2, DVec3};

/// The point of a primitive that is nearest to a point of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// The square of the distance, in the world.
    pub squared: f64,
    /// The nearest point, in the world.
    pub point: DVec3,
    /// The part of the shape.
    pub primitive: i32,
    /// The weights of corners 1 and 2 in a triangle, else NaN.
    pub barycentric: DVec2,
}

impl Nearest {
    /// The point `point` of a shape that is not a mesh, seen from `from`.
    pub(super) fn at(point: DVec3, from: DVec3, primitive: i32) -> Self {
        Self::apart((point - from).length_squared(), point, primitive)
    }

    /// The point with a square of the distance that is more precise than from the point.
    pub(super) fn apart(squared: f64, point: DVec3, primitive: i32) -> Self {
        Self { squared, point, primitive, barycentric: DVec2::NAN }
    }

    /// The nearer of two, of equally near ones the first.
    pub(super) fn or(self, other: Self) -> Self {
        if other.squared < self.squared { other } else { self }
    }
}

/// The factor on lengths of a map that keeps angles; `None` for one that bends spheres.
///
/// The columns of such a map are perpendicular and of one length. Products of a few rotations are
/// so but for rounding, for which 2^-46 of that length's square is room.
pub(crate) fn similarity(map: &DMat3) -> Option<f64> {
    const ROUNDING: f64 = 64.0 * f64::EPSILON;
    let gram = map.transpose() * *map;
    let square = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
    let off = gram - DMat3::from_diagonal(DVec3::splat(square));
    let largest = [off.x_axis, off.y_axis, off.z_axis].map(|column| column.abs().max_element());
    let is_one = largest.iter().all(|&off| off <= ROUNDING * square);
    is_one.then(|| square.sqrt())
}
