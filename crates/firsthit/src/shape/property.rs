//! Numbers by name that a file gives the vertices or the faces of a mesh.

use std::fmt::{self, Debug, Formatter};

use crate::error::Result;
use crate::geometry::summary::Count;
use crate::geometry::{require, single};
use crate::memory::Storage;

/// Numbers that a file gives to a mesh by name, such as a scan's quality: one for each vertex or polygon. Rays do
/// not ask for them.
#[derive(Debug, Clone, PartialEq)]
pub struct Property {
    /// What the file calls it.
    pub name: String,
    /// What has the numbers.
    pub of: PropertyOf,
    /// The numbers.
    pub values: PropertyValues,
}

/// What has a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PropertyOf {
    /// The vertices, a number for each.
    Vertices,
    /// The polygons, a number for each: triangles look theirs up by [`Mesh::face`](super::Mesh::face).
    Faces,
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
        f.debug_tuple(kind)
            .field(&Count(self.len(), "numbers"))
            .finish()
    }
}

impl PropertyValues {
    /// How many there are.
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

    /// One of them, if there are so many.
    pub fn get(&self, index: usize) -> Option<f64> {
        match self {
            Self::Single(values) => values.get(index).map(|&value| value.into()),
            Self::Double(values) => values.get(index).copied(),
        }
    }

    /// Adds one; as float32 where that is what is kept.
    pub(crate) fn push(&mut self, value: f64) {
        match self {
            Self::Single(values) => values.edit(|values| values.push(single(value))),
            Self::Double(values) => values.edit(|values| values.push(value)),
        }
    }
}

impl Property {
    /// Refuses numbers that are not as many as what has them.
    pub(super) fn check(&self, vertices: usize, faces: usize) -> Result<()> {
        let (is_right, expected) = match self.of {
            PropertyOf::Vertices => (self.values.len() == vertices, "as many as vertices"),
            PropertyOf::Faces => (self.values.len() >= faces, "one for each face"),
        };
        let got = format!("{} of '{}'", self.values.len(), self.name);
        require("properties", expected, is_right, got)
    }
}
