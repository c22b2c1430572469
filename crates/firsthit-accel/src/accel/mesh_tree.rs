//! The tree over a mesh's triangles: 16-wide nodes over meshlets, in float32.
//!
//! It has a [space](Space) of its own, in which no coordinate is larger than 1. So float32 is
//! enough for a mesh of any size at any place, and constants bound its rounding (`bounds.rs`).

use std::borrow::Cow;
use std::sync::Arc;

use super::meshlet::Meshlet;
use super::node::Node;
use super::space::Space;
use crate::geometry::DVec3;
use crate::memory::Storage;
use crate::shape::Meshes;
use crate::shape::triangle::DeparturePoint;
use crate::simd::{LANES, Lanes, set_bits};

/// A 16-wide tree over the triangles of one mesh.
#[derive(Debug, Clone)]
pub struct MeshTree {
    pub(super) space: Space,
    /// Whether the leaves hold the coordinates of the mesh without rounding, so that the exact test
    /// can take them from there.
    pub(super) is_exact: bool,
    /// Whether vertices in the same place are one to a leaf; see `build/weld.rs`.
    pub(super) is_welded: bool,
    /// The root first. None for a mesh that is empty or has a coordinate beyond 1e90
    /// ([`Space::new`]).
    pub(super) nodes: Storage<Node>,
    pub(super) leaves: Storage<Meshlet>,
    /// The triangles' indices, those of a leaf side by side.
    pub(super) order: Storage<u32>,
    /// Pairs of the lowest of some triangles with the same corners, and another of them that is in
    /// no leaf; sorted. The lowest is always in a leaf, since it wins every tie. In a quick tree
    /// others may be too, and are then in no pair.
    pub(super) copies: Storage<[u32; 2]>,
    /// The triangles still in each leaf, a bit each, where some have been [taken
    /// out](Self::take_out).
    pub(super) present: Option<Arc<[u16]>>,
    /// The children of each node that have triangles, a bit each, where some have been taken out.
    pub(super) children_left: Option<Arc<[u16]>>,
    /// The cost of a ray through the mesh's box when the tree was [built](Self::build); see
    /// `build/refit.rs`.
    pub(super) cost: f64,
    /// Whether it was [built in little time](Self::build_watched).
    pub(super) is_quick: bool,
}

impl MeshTree {
    /// The size in bytes, in memory or in a mapped file.
    pub fn bytes(&self) -> usize {
        size_of_val::<[_]>(&self.nodes)
            + size_of_val::<[_]>(&self.leaves)
            + size_of_val::<[_]>(&self.order)
            + size_of_val::<[_]>(&self.copies)
            + self.present.as_deref().map_or(0, size_of_val)
    }

    /// Whether it was [built in little time](Self::build_watched).
    #[doc(hidden)]
    #[inline]
    pub fn is_quick(&self) -> bool {
        self.is_quick
    }

    /// Pairs of triangles in one place, to the last bit: one of a leaf, and one that is in none.
    #[doc(hidden)]
    #[inline]
    pub fn copies(&self) -> &[[u32; 2]] {
        &self.copies
    }

    /// Whether there are triangles in one place, to the last bit.
    #[doc(hidden)]
    #[inline]
    pub fn has_copies(&self) -> bool {
        !self.copies.is_empty()
    }

    /// Keeps of some triangles of a leaf, a bit each, those that have not been taken out.
    #[inline(always)]
    pub(super) fn present(&self, leaf: u32, triangles: u16) -> u16 {
        match &self.present {
            None => triangles,
            Some(present) => triangles & present[leaf as usize],
        }
    }

    /// The children of a node that have triangles left, a bit each.
    #[inline(always)]
    pub(super) fn children_left(&self, node: u32) -> u16 {
        match &self.children_left {
            None => u16::MAX,
            Some(left) => left[node as usize],
        }
    }

    /// All triangles of the tree that have not been taken out.
    #[inline(never)]
    pub(super) fn all_present(&self) -> Cow<'_, [u32]> {
        if self.present.is_none() {
            return Cow::Borrowed(&self.order);
        }
        let leaves = (0..).zip(&self.leaves);
        let present = leaves.flat_map(|(number, leaf)| {
            let lanes = set_bits(self.present(number, leaf.filled));
            lanes.map(|lane| self.triangle(leaf, lane))
        });
        Cow::Owned(present.collect())
    }

    /// The copies of a triangle of a leaf: the second of each pair.
    #[inline(always)]
    pub(super) fn copies_of(&self, triangle: u32) -> &[[u32; 2]] {
        // Few meshes have any, and a search in a kernel is a call.
        if self.copies.is_empty() {
            return &[];
        }
        self.search_copies(triangle)
    }

    #[inline(never)]
    fn search_copies(&self, triangle: u32) -> &[[u32; 2]] {
        let first = self.copies.partition_point(|&[of, _]| of < triangle);
        let count = self.copies[first..].partition_point(|&[of, _]| of == triangle);
        &self.copies[first..first + count]
    }

    /// Whether float32 can tell what is ahead of a point that a ray leaves: whether how far its
    /// origin may be off that is nothing beside the rounding of float32.
    #[inline(always)]
    #[doc(hidden)]
    pub fn is_sharp_from(&self, point: &DeparturePoint) -> bool {
        const SHARP: f64 = 1.0 / (1_u64 << 30) as f64;
        point.off * self.space.scale < SHARP
    }

    /// Whether rays from `origin` are too far away for depths in float64; see
    /// `traverse/distant.rs`.
    #[inline(always)]
    #[doc(hidden)]
    pub fn is_distant(&self, origin: DVec3) -> bool {
        self.space.is_distant(origin)
    }

    /// Whether there is anything to traverse.
    #[doc(hidden)]
    #[inline]
    pub fn has_nodes(&self) -> bool {
        !self.nodes.is_empty()
    }

    /// The index in the mesh of a triangle, by its leaf and lane (see [`super::TriangleId`]).
    #[inline(always)]
    #[doc(hidden)]
    pub fn triangle_at(&self, leaf_lane: u32) -> u32 {
        self.triangle(&self.leaves[leaf_lane as usize / LANES], leaf_lane as usize % LANES)
    }

    /// The corners of that triangle, as the mesh has them.
    #[inline(always)]
    #[doc(hidden)]
    pub fn corners_at(&self, mesh: Meshes<'_>, leaf_lane: u32) -> [DVec3; 3] {
        self.corners(mesh, &self.leaves[leaf_lane as usize / LANES], leaf_lane as usize % LANES)
    }

    /// The corners of a triangle of a leaf, as the mesh has them.
    #[inline(always)]
    pub(super) fn corners(&self, mesh: Meshes<'_>, leaf: &Meshlet, lane: usize) -> [DVec3; 3] {
        if self.is_exact {
            let [a, b, c] = leaf.triangle(lane);
            [self.space.restored(a), self.space.restored(b), self.space.restored(c)]
        } else {
            mesh.corners(self.triangle(leaf, lane))
        }
    }

    /// The indices in the mesh of a leaf's triangles, as bits; anything in lanes without a
    /// triangle.
    #[inline(always)]
    pub(super) fn triangles_of<L: Lanes>(&self, l: L, leaf: &Meshlet) -> L::Floats {
        let from = &self.order[leaf.first as usize..];
        if let Some(all) = from.first_chunk() {
            l.load(bytemuck::cast_ref::<[u32; LANES], _>(all))
        } else {
            let mut padded = [0; LANES];
            padded[..from.len()].copy_from_slice(from);
            l.load(bytemuck::cast_ref(&padded))
        }
    }

    /// A triangle of a leaf by its index in the mesh.
    #[inline(always)]
    pub(super) fn triangle(&self, leaf: &Meshlet, lane: usize) -> u32 {
        self.order[leaf.first as usize + lane]
    }
}
