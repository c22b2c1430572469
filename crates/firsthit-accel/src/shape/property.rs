//! Numbers by name that a file gives the vertices, the corners or the faces of a mesh.

use std::fmt::{self, Debug, Formatter};

use crate::error::Result;
use crate::geometry::summary::Count;
use crate::geometry::{names, require, single};
use crate::memory::Storage;

/// Numbers that a file gives to a mesh by name, such as a scan's quality: one or several for each
/// vertex, corner or polygon. `channel::attribute` looks them up where rays met the mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Property {
    /// The name in the file.
    pub name: String,
    /// The elements that have the numbers.
    pub of: PropertyOf,
    /// The number of components of each value.
    pub components: usize,
    /// The rule for the value between the corners of a triangle.
    pub between: Between,
    /// The numbers, those of one vertex, corner or polygon after the other.
    pub values: PropertyValues,
}

/// The rule for the value between the corners of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Between {
    /// The mean of the corners' values by the barycentric weights: for quantities.
    Interpolated,
    /// The value of the corner with the largest weight, of equal ones the first: for labels, which
    /// have no mean.
    NearestCorner,
}

/// The elements of a mesh that have a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PropertyOf {
    /// The vertices, numbers for each.
    Vertices,
    /// The corners of the triangles, numbers for each: three times as many as triangles.
    Corners,
    /// The polygons, numbers for each: triangles look theirs up by
    /// [`Mesh::face`](super::Mesh::face).
    Faces,
}

names! {
    PropertyOf, "of":
    "vertices" => Vertices;
    "corners" => Corners;
    "faces" => Faces;
}

/// A property's numbers, as small as they can be without a loss.
#[derive(Clone, PartialEq)]
pub enum PropertyValues {
    /// Numbers that float32 holds exactly.
    Single(Storage<f32>),
    /// Others.
    Double(Storage<f64>),
}

/// A summary: they are many.
impl Debug for PropertyValues {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let kind = match self {
            Self::Single(_) => "Single",
            Self::Double(_) => "Double",
        };
        f.debug_tuple(kind).field(&Count(self.len(), "numbers")).finish()
    }
}

impl PropertyValues {
    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Single(values) => values.len(),
            Self::Double(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at an index; `None` beyond the last.
    pub fn get(&self, index: usize) -> Option<f64> {
        match self {
            Self::Single(values) => values.get(index).map(|&value| value.into()),
            Self::Double(values) => values.get(index).copied(),
        }
    }

    /// Adds one; as float32 where that is what is kept.
    #[doc(hidden)]
    pub fn push(&mut self, value: f64) {
        match self {
            Self::Single(values) => values.edit(|values| values.push(single(value))),
            Self::Double(values) => values.edit(|values| values.push(value)),
        }
    }
}

impl Property {
    /// A property of one number for each vertex, corner or face, interpolated.
    pub fn new(name: impl Into<String>, of: PropertyOf, values: PropertyValues) -> Self {
        Self { name: name.into(), of, components: 1, between: Between::Interpolated, values }
    }

    /// Refuses numbers that are not as many as what has them.
    pub(super) fn check(&self, counts: &Counts) -> Result<()> {
        let named = |what: String| format!("{what} of '{}'", self.name);
        let has_some = self.components > 0;
        require("properties", "at least one number for each", has_some, named("0".into()))?;
        let (count, expected) = match self.of {
            PropertyOf::Vertices => (counts.vertices, "as many as vertices"),
            PropertyOf::Corners => (counts.triangles.saturating_mul(3), "three for each triangle"),
            PropertyOf::Faces => (counts.faces, "one for each face"),
        };
        let length = self.values.len();
        let has = length / self.components;
        let is_right = match self.of {
            PropertyOf::Faces => has >= count,
            PropertyOf::Vertices | PropertyOf::Corners => has == count,
        };
        let is_whole = length.is_multiple_of(self.components);
        let got = match self.components {
            1 => named(length.to_string()),
            components => named(format!("{length} numbers, {components} for each,")),
        };
        require("properties", expected, is_right && is_whole, got)
    }

    /// Writes the numbers at a point of a triangle, as many as there is room for.
    pub(super) fn look_up(&self, point: &PointOfTriangle, out: &mut [f64]) {
        let indices = match self.of {
            PropertyOf::Faces => [point.face; 3],
            PropertyOf::Vertices => point.vertices.map(|vertex| vertex as usize),
            PropertyOf::Corners => [0, 1, 2].map(|k| 3 * point.triangle + k),
        };
        let value = |index: usize, n: usize| {
            let number = self.values.get(index * self.components + n);
            number.unwrap_or(f64::NAN)
        };
        let nearest = nearest_corner(point.weights);
        for (n, out) in out.iter_mut().enumerate().take(self.components) {
            *out = match (self.of, self.between) {
                (PropertyOf::Faces, _) => value(point.face, n),
                (_, Between::NearestCorner) => value(indices[nearest], n),
                (_, Between::Interpolated) => {
                    mean(indices.map(|index| value(index, n)), point.weights)
                }
            };
        }
    }
}

/// The numbers of a mesh's elements that can have properties.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counts {
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) faces: usize,
}

/// A point of a mesh, where properties are looked up.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointOfTriangle {
    pub(super) triangle: usize,
    pub(super) vertices: [u32; 3],
    pub(super) face: usize,
    pub(super) weights: [f64; 3],
}

/// The corner of the largest weight, of equal ones the first.
fn nearest_corner(weights: [f64; 3]) -> usize {
    let later = |best: usize, k: usize| if weights[k] > weights[best] { k } else { best };
    later(later(0, 1), 2)
}

/// The sum of the weighted values, corner after corner. A corner of weight zero does not count, so
/// that at a vertex its value comes out as it is, whatever the others are.
pub(super) fn mean(values: [f64; 3], weights: [f64; 3]) -> f64 {
    let corners = values.into_iter().zip(weights);
    let counting = corners.filter(|&(_, weight)| weight != 0.0);
    let sum = counting.map(|(value, weight)| weight * value);
    sum.reduce(|sum, value| sum + value).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_equal_weights_the_first_corner_is_nearest() {
        assert_eq!(nearest_corner([0.25, 0.5, 0.25]), 1);
        assert_eq!(nearest_corner([0.0, 0.5, 0.5]), 1);
        assert_eq!(nearest_corner([0.4, 0.2, 0.4]), 0);
        assert_eq!(nearest_corner([0.1, 0.2, 0.7]), 2);
    }

    #[test]
    fn a_corner_of_weight_zero_does_not_count() {
        let values = [f64::NAN, 7.0, f64::INFINITY];
        assert_eq!(mean(values, [0.0, 1.0, 0.0]), 7.0);
        assert!(mean(values, [0.5, 0.5, 0.0]).is_nan());
        assert_eq!(mean([1.0, 2.0, 4.0], [0.25, 0.25, 0.5]), 2.75);
    }
}
