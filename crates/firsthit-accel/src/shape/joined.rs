//! Several meshes in one space, as one list of triangles: what a tree over all of them numbers.
//!
//! The triangles of the first mesh come first, in their order, then those of the second, and so on.
//! So of two triangles the lower number is that of the lower (mesh, triangle).

use std::collections::HashMap;
use std::sync::Arc;

use super::{Crossing, Crowds, Mesh, Positions};
use crate::error::{Error, Result};
use crate::geometry::{Bounds, DVec3, Ray, arrays};
use crate::memory;

/// The triangles of one mesh, or of several that are joined, by their numbers.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub enum Meshes<'a> {
    One(&'a Mesh),
    Joined(&'a JoinedMeshes),
}

impl<'a> From<&'a Mesh> for Meshes<'a> {
    #[inline(always)]
    fn from(mesh: &'a Mesh) -> Self {
        Self::One(mesh)
    }
}

impl<'a> Meshes<'a> {
    /// The mesh that has a triangle, and its number there.
    #[inline(always)]
    fn locate(self, triangle: u32) -> (&'a Mesh, u32) {
        match self {
            Self::One(mesh) => (mesh, triangle),
            Self::Joined(joined) => {
                let (member, triangle) = joined.locate(triangle);
                (&joined.meshes[member], triangle)
            }
        }
    }

    /// The only mesh, unless several are joined.
    #[inline(always)]
    pub fn one(self) -> Option<&'a Mesh> {
        match self {
            Self::One(mesh) => Some(mesh),
            Self::Joined(_) => None,
        }
    }

    /// The number of triangles.
    pub fn count(self) -> usize {
        match self {
            Self::One(mesh) => mesh.triangles().len(),
            Self::Joined(joined) => joined.starts[joined.meshes.len()] as usize,
        }
    }

    /// Whether all vertices are float32.
    pub(crate) fn are_single(self) -> bool {
        let is_single = |mesh: &Mesh| matches!(mesh.positions().as_ref(), Positions::Single(_));
        match self {
            Self::One(mesh) => is_single(mesh),
            Self::Joined(joined) => joined.meshes.iter().all(|mesh| is_single(mesh)),
        }
    }

    /// The smallest box around all triangles.
    pub fn bounds(self) -> Bounds {
        match self {
            Self::One(mesh) => mesh.bounds(),
            Self::Joined(joined) => joined.bounds,
        }
    }

    /// See [`Mesh::corners`].
    #[inline(always)]
    pub fn corners(self, triangle: u32) -> [DVec3; 3] {
        let (mesh, triangle) = self.locate(triangle);
        mesh.corners(triangle as usize)
    }

    /// The largest number that the place of a triangle's mesh in the world is computed from; 0
    /// where there is one mesh alone.
    pub fn farthest(self, triangle: u32) -> f64 {
        match self {
            Self::One(_) => 0.0,
            Self::Joined(joined) => joined.farthest[joined.locate(triangle).0],
        }
    }

    /// See [`Mesh::nearest_t`].
    #[inline]
    pub fn nearest_t(self, ray: &Ray, crossing: &Crossing) -> f64 {
        let (mesh, triangle) = self.locate(crossing.primitive.cast_unsigned());
        let primitive = triangle.cast_signed();
        mesh.nearest_t(ray, &Crossing { primitive, ..*crossing })
    }

    /// See [`Mesh::is_flat`]. The planes of joined meshes are known for each alone.
    #[inline(always)]
    pub fn is_flat(self) -> bool {
        self.one().is_some_and(Mesh::is_flat)
    }

    /// See [`Mesh::are_in_one_plane`].
    #[inline(always)]
    pub fn are_in_one_plane(self, one: u32, other: u32) -> bool {
        match self {
            Self::One(mesh) => mesh.are_in_one_plane(one, other),
            Self::Joined(joined) => joined.are_in_one_plane(one, other),
        }
    }

    /// See [`Mesh::crowds`]. Joined meshes have none.
    #[inline(always)]
    #[doc(hidden)]
    pub fn crowds(self) -> Option<&'a Crowds> {
        self.one()?.crowds()
    }

    /// Counts that the order of two triangles along a ray had to be found exactly; see
    /// [`Mesh::ask_for_planes`].
    #[cold]
    pub fn ask_for_planes(self, one: u32, other: u32) {
        let ((mesh, _), (same, _)) = (self.locate(one), self.locate(other));
        if std::ptr::eq(mesh, same) {
            mesh.ask_for_planes();
        }
    }
}

/// The number of triangles in a block, of whose first one the mesh is noted.
const BLOCK: usize = 64;

/// See [the module](self).
#[derive(Debug, Clone)]
#[doc(hidden)]
pub struct JoinedMeshes {
    meshes: Vec<Arc<Mesh>>,
    /// The number of each mesh's first triangle, and in the end how many there are.
    starts: Vec<u32>,
    /// The mesh that has the first triangle of each [`BLOCK`].
    blocks: Vec<u32>,
    bounds: Bounds,
    /// The largest number that the place of each mesh in the world is computed from.
    farthest: Vec<f64>,
    /// The least and the largest of these.
    farthest_ends: [f64; 2],
}

impl JoinedMeshes {
    /// Joins meshes with triangles, each with the largest number that its place in the world is
    /// computed from. `None` for more triangles than a number of 31 bits can count.
    pub fn new(meshes: Vec<Arc<Mesh>>, farthest: Vec<f64>) -> Option<Self> {
        let mut starts = Vec::with_capacity(meshes.len() + 1);
        let mut blocks = Vec::new();
        let (mut end, mut bounds) = (0, Bounds::EMPTY);
        for (member, mesh) in (0..).zip(&meshes) {
            starts.push(u32::try_from(end).ok()?);
            end += mesh.triangles().len();
            blocks.resize(end.div_ceil(BLOCK), member);
            bounds = bounds.union(mesh.bounds());
        }
        starts.push(i32::try_from(end).ok()?.cast_unsigned());
        Some(Self {
            meshes,
            starts,
            blocks,
            bounds,
            farthest_ends: (farthest.iter())
                .fold([f64::INFINITY, 0.0], |[least, most], &farthest| {
                    [least.min(farthest), most.max(farthest)]
                }),
            farthest,
        })
    }

    /// The mesh that has a triangle, and the triangle's number there.
    #[inline]
    pub fn locate(&self, triangle: u32) -> (usize, u32) {
        let mut member = self.blocks[triangle as usize / BLOCK] as usize;
        while self.starts[member + 1] <= triangle {
            member += 1;
        }
        (member, triangle - self.starts[member])
    }

    /// The box around a mesh.
    pub fn bounds_of(&self, member: usize) -> Bounds {
        self.meshes[member].bounds()
    }

    /// The least and the largest number that the place of a mesh is computed from.
    #[inline]
    pub fn farthest(&self) -> [f64; 2] {
        self.farthest_ends
    }

    /// The numbers of a mesh's triangles: the first, and the first that is another's.
    #[inline]
    pub fn range(&self, member: usize) -> [u32; 2] {
        [self.starts[member], self.starts[member + 1]]
    }

    #[inline(always)]
    fn are_in_one_plane(&self, one: u32, other: u32) -> bool {
        let ((member, one), (same, other)) = (self.locate(one), self.locate(other));
        member == same && self.meshes[member].are_in_one_plane(one, other)
    }

    /// All triangles as one mesh, for a tree to be built over them. Positions that several share
    /// are there once.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] where there is no memory for it, or there are more vertices than triangles
    /// can name.
    pub fn as_one(&self) -> Result<Mesh> {
        let mut firsts: HashMap<*const Positions, u32> = HashMap::new();
        let mut distinct = Vec::new();
        let mut count = 0;
        for mesh in &self.meshes {
            let positions = mesh.positions();
            firsts.entry(Arc::as_ptr(positions)).or_insert_with(|| {
                distinct.push(positions.as_ref());
                let first = count;
                count += positions.len();
                u32::try_from(first).unwrap_or(u32::MAX)
            });
        }
        if u32::try_from(count).is_err() {
            return Err(Error::Limit {
                what: "vertices of objects that share a tree",
                got: count.to_string(),
                limit: u32::MAX.to_string(),
            });
        }
        let mut triangles = memory::filled(self.starts[self.meshes.len()] as usize, [0; 3])?;
        let mut left = &mut triangles[..];
        for mesh in &self.meshes {
            let first = firsts[&Arc::as_ptr(mesh.positions())];
            let (part, after) = left.split_at_mut(mesh.triangles().len());
            for (out, corners) in part.iter_mut().zip(mesh.triangles()) {
                *out = arrays::map(*corners, |corner| corner + first);
            }
            left = after;
        }
        Ok(Mesh::of_others(Positions::concatenated(&distinct)?, triangles, self.bounds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of `triangles` triangles.
    fn strip(triangles: u32, beside: f64) -> Arc<Mesh> {
        let points = (0..triangles + 2).map(|k| [beside + f64::from(k / 2), f64::from(k % 2), 0.0]);
        let triangles = (0..triangles).map(|k| [k, k + 1, k + 2]).collect();
        Arc::new(Mesh::new(Positions::compact(points.collect()), triangles).unwrap())
    }

    #[test]
    fn each_triangle_is_found_in_its_mesh() {
        let sizes = [1, 63, 64, 1, 1, 200, 2, 1, 129];
        let meshes: Vec<_> = sizes.map(|size| strip(size, f64::from(size))).into();
        let joined = JoinedMeshes::new(meshes.clone(), vec![0.0; 9]).unwrap();
        let whole = joined.as_one().unwrap();
        let all = (0..).zip(sizes);
        let expected = all.flat_map(|(member, size)| (0..size).map(move |k| (member, k)));
        let mut count = 0;
        for (number, (member, triangle)) in (0..).zip(expected) {
            assert_eq!(joined.locate(number), (member, triangle));
            let corners = meshes[member].corners(triangle as usize);
            assert_eq!(Meshes::Joined(&joined).corners(number), corners);
            assert_eq!(whole.corners(number as usize), corners);
            count += 1;
        }
        assert_eq!(Meshes::Joined(&joined).count(), count);
        assert_eq!(whole.bounds(), joined.bounds);
    }

    #[test]
    fn positions_that_meshes_share_are_there_once() {
        let all = strip(10, 0.0);
        let half = |triangles: &[[u32; 3]]| {
            Arc::new(Mesh::new(Arc::clone(all.positions()), triangles.to_vec()).unwrap())
        };
        let (low, high) = all.triangles().split_at(4);
        let joined = JoinedMeshes::new(vec![half(low), half(high)], vec![0.0; 2]).unwrap();
        let whole = joined.as_one().unwrap();
        assert_eq!(whole.positions(), all.positions());
        assert_eq!(whole.triangles(), all.triangles());
    }
}
