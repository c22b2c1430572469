//! Triangles over shared vertices: the mesh itself. Its attributes are in `mesh/attributes.rs`,
//! how rays meet it in `mesh/crossing.rs`.

mod asked;
mod attributes;
mod closed;
mod crossing;
mod crowds;
mod digest;
mod disjoint_sets;
mod facing;
mod named;
mod parts;
mod planes;
mod reach;
mod rings;
mod stored;
mod surface;
mod tangents;
mod weld;

pub use named::NamedAttribute;
pub(crate) use stored::are_below;
#[doc(hidden)]
pub use {
    crowds::Crowds,
    disjoint_sets::DisjointSets,
    facing::{Facing, edges, sorted},
    stored::MeshParts,
    weld::Welded,
};

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

use super::attribute::check_indices;
use super::{Attribute, Positions, Property};
use crate::error::{Error, Result};
use crate::geometry::{Bounds, DVec2, DVec3, moderation, unit};
use crate::memory::Storage;

/// Triangles over shared vertices. Immutable; objects share it through an [`Arc`].
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::{DVec3, Mesh, Object, Positions, Scene, shoot};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2], [0, 2, 3]])?;
/// // Objects that share the Arc share the mesh and its tree.
/// let scene = Scene::new(vec![Object::new(Arc::new(mesh))])?;
/// let hit = shoot(&scene, DVec3::new(0.2, 0.7, 9.0), DVec3::NEG_Z);
/// assert_eq!((hit.t, hit.primitive), (9.0, 1));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Mesh {
    positions: Arc<Positions>,
    triangles: Storage<[u32; 3]>,
    bounds: Bounds,
    faces: Option<Storage<u32>>,
    normals: Option<Attribute<3>>,
    uvs: Option<Attribute<2>>,
    second_uvs: Option<Attribute<2>>,
    tangents: Option<Attribute<4>>,
    colors: Option<Attribute<3>>,
    alphas: Option<Attribute<1>>,
    slots: Option<Storage<u32>>,
    properties: Vec<Property>,
    closed: closed::Closed,
    blocks: reach::Blocks,
}

/// A summary: meshes are large.
impl Debug for Mesh {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let has = [
            ("faces", self.faces.is_some()),
            ("normals", self.normals.is_some()),
            ("uvs", self.uvs.is_some()),
            ("second_uvs", self.second_uvs.is_some()),
            ("tangents", self.tangents.is_some()),
            ("colors", self.colors.is_some()),
            ("alphas", self.alphas.is_some()),
            ("slots", self.slots.is_some()),
        ];
        let has: Vec<_> = has.iter().filter(|(_, has)| *has).collect();
        let has: Vec<_> = has.into_iter().map(|(name, _)| name).collect();
        f.debug_struct("Mesh")
            .field("triangles", &self.triangles.len())
            .field("vertices", &self.positions.len())
            .field("bounds", &self.bounds)
            .field("has", &has)
            .field("properties", &self.properties.len())
            .finish_non_exhaustive()
    }
}

/// The box around triangles whose corners are there, and finite.
fn checked_bounds(positions: &Positions, triangles: &[[u32; 3]]) -> Result<Bounds> {
    let bounds = match positions {
        Positions::Single(points) => bounds_of(points, triangles),
        Positions::Double(points) => bounds_of(points, triangles),
    };
    if let Some(Bounds { low, high }) = bounds {
        // Of zeros with two signs `min` and `max` may return either, from machine to machine.
        return Ok(Bounds { low: low + 0.0, high: high + 0.0 });
    }
    check_indices("triangles", triangles, positions.len())?;
    let mut corners = triangles.iter().flatten();
    let bad = corners.find(|&&k| !positions.get(k).is_finite());
    let got = bad.map_or_else(String::new, |&bad| format!("{} at index {bad}", positions.get(bad)));
    Err(Error::argument("vertices", "finite", got))
}

impl Mesh {
    /// Whether its triangles are those of another mesh, to the last bit and in the same order,
    /// whatever they look like.
    #[doc(hidden)]
    pub fn is_congruent(&self, other: &Self) -> bool {
        // (Equal zeros may have different signs, which shows in a hit's weights.)
        let same_bits = || {
            let bits = |mesh: &Self, k: u32| mesh.positions.get(k).to_array().map(f64::to_bits);
            let mut corners = self.triangles.iter().flatten();
            corners.all(|&k| bits(self, k) == bits(other, k))
        };
        self.triangles == other.triangles
            && (Arc::ptr_eq(&self.positions, &other.positions) || same_bits())
    }

    /// The mesh of `triangles`, which index `positions`; counter-clockwise is front. Several meshes
    /// may share their positions: surfaces that meet there have no cracks between them.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an index without a vertex and for a triangle whose corner is NaN or
    /// infinite, [`Error::Limit`] for more triangles than an identifier can name.
    pub fn new(positions: impl Into<Arc<Positions>>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        let positions = positions.into();
        if i32::try_from(triangles.len()).is_err() {
            let (got, limit) = (triangles.len().to_string(), i32::MAX.to_string());
            return Err(Error::Limit { what: "triangles in a mesh", got, limit });
        }
        let bounds = checked_bounds(&positions, &triangles)?;
        Ok(Self::of_others(positions, triangles, bounds))
    }

    /// The mesh of triangles that other meshes have, in this box: nothing is checked.
    pub(super) fn of_others(
        positions: impl Into<Arc<Positions>>,
        triangles: Vec<[u32; 3]>,
        bounds: Bounds,
    ) -> Self {
        Self {
            positions: positions.into(),
            triangles: triangles.into(),
            bounds,
            faces: None,
            normals: None,
            uvs: None,
            second_uvs: None,
            tangents: None,
            colors: None,
            alphas: None,
            slots: None,
            properties: Vec::new(),
            closed: closed::Closed::default(),
            blocks: reach::Blocks::default(),
        }
    }

    /// The mesh with other vertices under its triangles and attributes. A scene that has this mesh
    /// in the place of the old one refits the old one's tree to it (`Scene::with_objects`).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for another number of vertices, and for a triangle whose corner is NaN
    /// or infinite.
    pub fn with_positions(self, positions: impl Into<Arc<Positions>>) -> Result<Self> {
        let positions = positions.into();
        let (count, got) = (self.positions.len(), positions.len());
        if got != count {
            let got = format!("{got}, there were {count}");
            return Err(Error::argument("vertices", "as many as there were", got));
        }
        let bounds = checked_bounds(&positions, &self.triangles)?;
        Ok(Self {
            positions,
            bounds,
            closed: closed::Closed::default(),
            blocks: reach::Blocks::default(),
            ..self
        })
    }

    /// The vertices, shared with other meshes perhaps: some may belong to no triangle of this one.
    #[inline]
    pub fn positions(&self) -> &Arc<Positions> {
        &self.positions
    }

    /// The triangles' vertex indices, in file order.
    #[inline]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The smallest box around all triangles.
    #[inline]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The three corners of a triangle, in object space.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.positions.three(self.triangles[triangle])
    }

    /// The triangle's own normal, counter-clockwise front, of length one; NaN if it has no area.
    #[inline]
    pub fn normal(&self, triangle: usize) -> DVec3 {
        normal_of(self.corners(triangle))
    }
}

/// The normal of a triangle with these corners; see [`Mesh::normal`].
#[inline(always)]
#[doc(hidden)]
pub fn normal_of([a, b, c]: [DVec3; 3]) -> DVec3 {
    // Not edges of length one: their rounding would give collinear corners an area.
    let (ab, ac) = (b - a, c - a);
    unit((moderation(ab) * ab).cross(moderation(ac) * ac))
}

/// The point of a triangle with these corners where the corners 1 and 2 have these weights.
#[inline(always)]
#[doc(hidden)]
pub fn point_of([a, b, c]: [DVec3; 3], weights: DVec2) -> DVec3 {
    a + (weights.x * (b - a) + weights.y * (c - a))
}

/// The box around the corners of all triangles, in one pass; `None` if a corner is not there or not
/// finite.
fn bounds_of<T>(points: &[[T; 3]], triangles: &[[u32; 3]]) -> Option<Bounds>
where
    T: Copy + PartialOrd + Into<f64>,
{
    let Some(&[first, ..]) = triangles.first() else {
        return Some(Bounds::EMPTY);
    };
    let [mut low, mut high] = [*points.get(first as usize)?; 2];
    let mut is_finite = true;
    for &corner in triangles.iter().flatten() {
        let point = points.get(corner as usize)?;
        for axis in 0..3 {
            let x = point[axis];
            low[axis] = if x < low[axis] { x } else { low[axis] };
            high[axis] = if x > high[axis] { x } else { high[axis] };
            is_finite &= Into::<f64>::into(x).abs() < f64::INFINITY;
        }
    }
    is_finite.then(|| Bounds {
        low: DVec3::from(low.map(Into::into)),
        high: DVec3::from(high.map(Into::into)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_without_a_vertex_are_refused() {
        let points = vec![[0.0; 3]; 3];
        let error = Mesh::new(Positions::compact(points), vec![[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "triangles must be indices of what is there, got [0, 1, 3] in triangle 1, of 3"
        );
    }

    #[test]
    fn a_corner_that_is_not_finite_is_refused_and_an_unused_vertex_is_not() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f64::NAN; 3]];
        assert!(Mesh::new(Positions::compact(points.clone()), vec![[0, 1, 2]]).is_ok());
        assert!(Mesh::new(Positions::compact(points), vec![[0, 1, 3]]).is_err());
    }

    #[test]
    fn corners_on_a_line_have_no_normal() {
        for k in 1..100 {
            let [x, y, z] = [1.0, f64::from(k), f64::from(k % 7) + 0.5];
            let points = vec![[0.0; 3], [x, y, z], [3.0 * x, 3.0 * y, 3.0 * z]];
            let mesh = Mesh::new(Positions::compact(points), vec![[0, 1, 2]]).unwrap();
            assert!(mesh.normal(0).is_nan(), "{k}");
        }
    }

    #[test]
    fn tiny_triangles_have_normals_too() {
        let points = vec![[0.0; 3], [1e-200, 0.0, 0.0], [0.0, 1e-200, 0.0]];
        let mesh = Mesh::new(Positions::compact(points), vec![[0, 1, 2]]).unwrap();
        assert_eq!(mesh.normal(0), DVec3::Z);
    }
}
