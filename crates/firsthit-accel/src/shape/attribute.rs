//! Attributes of a mesh: numbers at vertices or corners, interpolated over triangles.

use std::fmt::{self, Debug, Formatter};

use crate::error::{Error, Result};
use crate::geometry::summary::Count;
use crate::geometry::{arrays, require};
use crate::memory::Storage;
use crate::shape::Mesh;

/// Values at the corners of a mesh's triangles: normals, texture coordinates, colours.
#[derive(Clone, PartialEq)]
pub struct Attribute<const N: usize> {
    /// The values.
    pub values: Storage<[f32; N]>,
    /// The indices of the values at each triangle's corners; `None`: the indices of its vertices.
    pub corners: Option<Storage<[u32; 3]>>,
}

/// A summary: they are many.
impl<const N: usize> Debug for Attribute<N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Attribute")
            .field("values", &Count(self.values.len(), "values"))
            .field("has_corners", &self.corners.is_some())
            .finish_non_exhaustive()
    }
}

impl<const N: usize> Attribute<N> {
    /// A value for each vertex.
    pub fn per_vertex(values: Vec<[f32; N]>) -> Self {
        Self { values: values.into(), corners: None }
    }

    /// The value between the corners of a triangle, by barycentric weights.
    pub(super) fn interpolate(
        &self,
        triangle: usize,
        vertices: [u32; 3],
        weights: [f64; 3],
    ) -> [f64; N] {
        let values = self.at_corners(triangle, vertices);
        arrays::from_fn(|n| {
            // As sums of the standard library begin.
            let mut sum = -0.0;
            for k in 0..3 {
                sum += weights[k] * f64::from(values[k][n]);
            }
            sum
        })
    }

    /// The values at the corners of a triangle of the mesh.
    pub(crate) fn of_triangle(&self, triangle: usize, mesh: &Mesh) -> [[f32; N]; 3] {
        self.at_corners(triangle, mesh.triangles()[triangle])
    }

    /// The values at the corners of a triangle.
    #[inline]
    pub(super) fn at_corners(&self, triangle: usize, vertices: [u32; 3]) -> [[f32; N]; 3] {
        let corners = self.corners.as_ref().map_or(vertices, |corners| corners[triangle]);
        let [a, b, c] = corners;
        [self.values[a as usize], self.values[b as usize], self.values[c as usize]]
    }

    pub(super) fn check(
        &self,
        name: &'static str,
        positions: usize,
        triangles: &[[u32; 3]],
    ) -> Result<()> {
        let count = self.values.len();
        let Some(corners) = &self.corners else {
            return require(name, "as many as vertices", count == positions, count);
        };
        let is_whole = corners.len() == triangles.len();
        let expected = "three indices for each triangle";
        require(name, expected, is_whole, corners.len())?;
        check_indices(name, corners, count)
    }
}

/// Refuses triangles that name one of `count` things that is not there.
pub(super) fn check_indices(
    name: &'static str,
    triangles: &[[u32; 3]],
    count: usize,
) -> Result<()> {
    let is_bad = |corners: &[u32; 3]| corners.iter().any(|&k| k as usize >= count);
    match triangles.iter().position(is_bad) {
        None => Ok(()),
        Some(bad) => {
            let got = format!("{:?} in triangle {bad}, of {count}", triangles[bad]);
            Err(Error::argument(name, "indices of what is there", got))
        }
    }
}
