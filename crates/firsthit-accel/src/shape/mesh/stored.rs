//! The arrays of a mesh, and the assembly of a mesh from untrusted arrays.

use std::sync::Arc;

use super::{Mesh, bounds_of};
use crate::geometry::Bounds;
use crate::memory::Storage;
use crate::parallel;
use crate::shape::property::Counts;
use crate::shape::{Attribute, Positions, Property, PropertyOf};

/// The number of elements that one task checks.
const CHUNK: usize = 1 << 16;

/// All that a mesh is made from.
#[derive(Debug)]
#[doc(hidden)]
pub struct MeshParts {
    pub positions: Arc<Positions>,
    /// Whether every coordinate of the positions is finite. If not, those of the triangles are
    /// asked one by one.
    pub is_finite: bool,
    pub triangles: Storage<[u32; 3]>,
    pub bounds: Bounds,
    pub faces: Option<Storage<u32>>,
    pub normals: Option<Attribute<3>>,
    pub uvs: Option<Attribute<2>>,
    pub second_uvs: Option<Attribute<2>>,
    pub tangents: Option<Attribute<4>>,
    pub colors: Option<Attribute<3>>,
    pub alphas: Option<Attribute<1>>,
    pub slots: Option<Storage<u32>>,
    pub properties: Vec<Property>,
}

impl Positions {
    /// Whether every coordinate is finite.
    #[doc(hidden)]
    pub fn are_finite(&self) -> bool {
        match self {
            Self::Single(points) => parallel::all(points.as_flattened().chunks(CHUNK), |part| {
                part.iter().fold(true, |all, x| all & x.is_finite())
            }),
            Self::Double(points) => parallel::all(points.as_flattened().chunks(CHUNK), |part| {
                part.iter().fold(true, |all, x| all & x.is_finite())
            }),
        }
    }
}

impl Mesh {
    /// The mesh of these parts. They are checked as those of any mesh are, by all threads of the
    /// current rayon pool, except for the bounds, of which only the form is: to find them takes
    /// longer than everything else.
    ///
    /// # Errors
    ///
    /// In words, what is wrong.
    #[doc(hidden)]
    pub fn from_parts(parts: MeshParts) -> Result<Self, &'static str> {
        let vertices = parts.positions.len();
        let triangles = &parts.triangles;
        let count = triangles.len();
        if i32::try_from(count).is_err() || u32::try_from(vertices).is_err() {
            return Err("a mesh has more triangles or vertices than identifiers name");
        }
        if !are_below(triangles.as_flattened(), vertices) {
            return Err("a triangle has a vertex that is not there");
        }
        let Bounds { low, high } = parts.bounds;
        let is_box = low.is_finite() && high.is_finite() && low.cmple(high).all();
        if is_box == triangles.is_empty() || (!is_box && !is_empty(parts.bounds)) {
            return Err("a mesh's bounds are none");
        }
        let is_finite = || match &*parts.positions {
            Positions::Single(points) => bounds_of(points, triangles).is_some(),
            Positions::Double(points) => bounds_of(points, triangles).is_some(),
        };
        if !parts.is_finite && !is_finite() {
            return Err("a triangle has a corner that is not finite");
        }
        let faces = (parts.faces.as_ref())
            .is_none_or(|faces| faces.len() == count && are_below(faces, i32::MAX as usize + 1));
        let slots = (parts.slots.as_ref()).is_none_or(|slots| slots.len() == count);
        if !faces || !slots {
            return Err("a mesh's faces or slots are not one for each triangle");
        }
        let attributes = fits(parts.normals.as_ref(), vertices, count)
            && fits(parts.uvs.as_ref(), vertices, count)
            && fits(parts.second_uvs.as_ref(), vertices, count)
            && fits(parts.tangents.as_ref(), vertices, count)
            && fits(parts.colors.as_ref(), vertices, count)
            && fits(parts.alphas.as_ref(), vertices, count);
        if !attributes {
            return Err("an attribute does not fit its mesh");
        }
        let mesh = Self {
            positions: parts.positions,
            triangles: parts.triangles,
            bounds: parts.bounds,
            faces: parts.faces,
            normals: parts.normals,
            uvs: parts.uvs,
            second_uvs: parts.second_uvs,
            tangents: parts.tangents,
            colors: parts.colors,
            alphas: parts.alphas,
            slots: parts.slots,
            closed: super::closed::Closed::default(),
            blocks: super::reach::Blocks::default(),
            properties: Vec::new(),
        };
        mesh.with_checked_properties(parts.properties)
    }

    fn with_checked_properties(mut self, properties: Vec<Property>) -> Result<Self, &'static str> {
        let is_of_faces = |property: &Property| property.of == PropertyOf::Faces;
        let faces = match &self.faces {
            Some(faces) if properties.iter().any(is_of_faces) => {
                let largest = parallel::map(faces.chunks(CHUNK), |part| part.iter().max());
                let last = largest.into_iter().flatten().max();
                last.map_or(0, |&last| last as usize + 1)
            }
            _ => self.triangles.len(),
        };
        let counts =
            Counts { vertices: self.positions.len(), triangles: self.triangles.len(), faces };
        let fits = |property: &Property| property.check(&counts).is_ok();
        if !properties.iter().all(fits) {
            return Err("a property does not fit its mesh");
        }
        self.properties = properties;
        Ok(self)
    }
}

/// Whether it is the box of nothing, as meshes have it that are empty.
fn is_empty(bounds: Bounds) -> bool {
    bounds == Bounds::EMPTY
}

/// Whether an attribute fits a mesh with these numbers of vertices and triangles.
fn fits<const N: usize>(
    attribute: Option<&Attribute<N>>,
    vertices: usize,
    triangles: usize,
) -> bool {
    let Some(attribute) = attribute else {
        return true;
    };
    match &attribute.corners {
        None => attribute.values.len() == vertices,
        Some(corners) => {
            corners.len() == triangles && are_below(corners.as_flattened(), attribute.values.len())
        }
    }
}

/// Whether all indices are below `count`.
pub(crate) fn are_below(indices: &[u32], count: usize) -> bool {
    // The largest of a part: without a branch, so that it is as fast as memory.
    let largest = |part: &[u32]| part.iter().fold(0, |largest, &index| index.max(largest));
    parallel::all(indices.chunks(CHUNK), |part| (largest(part) as usize) < count)
}
