//! Searches of a tree, in place of visits to all that it holds: for the boxes that end beyond a
//! place, for those around a transformed mesh, and for the triangles in some boxes.

use std::sync::Arc;

use super::bvh::Bvh;
use super::mesh_tree::MeshTree;
use super::node::{LEAF, WIDTH};
use crate::geometry::{Bounds, DAffine3, DVec3, arrays};
use crate::shape::Meshes;
use crate::simd::set_bits;

/// At least the rounding of a vertex to float32, in units of the tree.
const ROUNDED: f64 = 1.0 / (1_u64 << 22) as f64;

impl Bvh {
    /// Calls `visit` with the boxes that may end beyond what was found, the farthest of each node
    /// first: upwards along an axis, with `side` 0 downwards. `visit` returns where what was found
    /// ends then.
    #[doc(hidden)]
    pub fn each_beyond(
        &self,
        [axis, side]: [usize; 2],
        mut found: f64,
        mut visit: impl FnMut(u32) -> f64,
    ) {
        let sign = [-1.0, 1.0][side];
        let mut stack = Vec::from_iter(self.nodes.first().map(|_| (0, f64::INFINITY)));
        while let Some((child, reach)) = stack.pop() {
            // Boxes were rounded after the same operations.
            if reach < sign * ((found - self.space.origin[axis]) * self.space.scale) {
                continue;
            }
            if child & LEAF != 0 {
                found = visit(child & !LEAF);
                continue;
            }
            let node = &self.nodes[child as usize];
            let ends = node.planes[2 * axis + side].map(|end| sign * f64::from(end));
            let bottom = stack.len();
            let all = node.children.into_iter().zip(ends);
            stack.extend(all.filter(|&(_, end)| end > f64::NEG_INFINITY));
            stack[bottom..].sort_unstable_by(|(_, a), (_, b)| a.total_cmp(b));
        }
    }
}

impl MeshTree {
    /// A box around the mesh after a transform, in constant time: the box around the transformed
    /// boxes of the root's children. `None` for a tree without nodes.
    #[doc(hidden)]
    pub fn transformed_bounds(&self, transform: &DAffine3) -> Option<Bounds> {
        self.nodes.first()?;
        let children = self.children(0).map(|(bounds, _)| bounds);
        let transformed = children.map(|bounds| bounds.transformed(transform));
        Some(transformed.fold(Bounds::EMPTY, Bounds::union))
    }

    /// The smallest box around the mesh after a transform, to the last bit of transforming all
    /// corners of its triangles. `None` for a tree without nodes.
    ///
    /// For each of the six ends, descend from the root to the farthest child first, and leave out a
    /// child whose box ends before the farthest corner found so far. A corner of a box bounds the
    /// vertices in the box to the last bit, because it goes through the same operations and
    /// rounding is monotone.
    #[doc(hidden)]
    pub fn smallest_bounds(&self, mesh: Meshes<'_>, transform: &DAffine3) -> Option<Bounds> {
        self.nodes.first()?;
        let end = |axis: usize, sign: f64| {
            let along = |point: DVec3| sign * transform.transform_point3(point)[axis];
            sign * self.farthest(mesh, along, sign * transform.matrix3.row(axis))
        };
        Some(Bounds {
            low: DVec3::from(arrays::from_fn(|axis| end(axis, -1.0))),
            high: DVec3::from(arrays::from_fn(|axis| end(axis, 1.0))),
        })
    }

    /// Takes triangles out of the leaves; each is in one of the boxes `around`. If one has copies
    /// they are taken out, too.
    #[doc(hidden)]
    pub fn take_out(&mut self, around: &[Bounds], is_out: impl Fn(u32) -> bool) {
        let filled = || self.leaves.iter().map(|leaf| leaf.filled).collect();
        let mut present: Arc<[u16]> = self.present.take().unwrap_or_else(filled);
        let all = Arc::make_mut(&mut present);
        self.each_near(around, |number, bit, triangle| {
            if is_out(triangle) {
                all[number as usize] &= !bit;
            }
        });
        self.present = Some(present);
        self.find_children_left();
    }

    /// Takes all other triangles out of the leaves.
    #[doc(hidden)]
    pub fn keep_only(&mut self, around: &[Bounds], is_in: impl Fn(u32) -> bool) {
        let mut present: Vec<u16> = vec![0; self.leaves.len()];
        self.each_near(around, |number, bit, triangle| {
            if is_in(triangle) {
                present[number as usize] |= self.present(number, bit);
            }
        });
        self.present = Some(present.into());
        self.find_children_left();
    }

    fn find_children_left(&mut self) {
        let mut left: Vec<u16> = vec![0; self.nodes.len()];
        // Children stand behind their parents.
        for k in (0..self.nodes.len()).rev() {
            let node = &self.nodes[k];
            for child in (0..WIDTH).filter(|&child| !node.is_vacant(child)) {
                let index = node.children[child];
                let number = index & !LEAF;
                let has_some = if index & LEAF == 0 {
                    left[number as usize] != 0
                } else {
                    self.present(number, u16::MAX) != 0
                };
                left[k] |= u16::from(has_some) << child;
            }
        }
        self.children_left = Some(left.into());
    }

    /// Calls `visit` with the leaf, the bit there and the number of each triangle that may be in
    /// one of some boxes.
    fn each_near(&self, around: &[Bounds], mut visit: impl FnMut(u32, u16, u32)) {
        for number in self.leaves_near(around) {
            let leaf = &self.leaves[number as usize];
            for lane in set_bits(leaf.filled) {
                visit(number, 1 << lane, self.triangle(leaf, lane));
            }
        }
    }

    /// The leaves that may have triangles in one of some boxes, and others where these are many.
    fn leaves_near(&self, around: &[Bounds]) -> Vec<u32> {
        /// The most boxes that are searched; with more all leaves are looked at.
        const FEW: usize = 16;
        let all = 0..u32::try_from(self.leaves.len()).unwrap_or(u32::MAX);
        if around.len() > FEW {
            return all.collect();
        }
        let rounding = ROUNDED * self.space.unscale;
        let mut is_near = vec![false; self.leaves.len()];
        for around in around {
            let (low, high) = (around.low - rounding, around.high + rounding);
            let mut stack = vec![0];
            while let Some(index) = stack.pop() {
                if index & LEAF != 0 {
                    is_near[(index & !LEAF) as usize] = true;
                    continue;
                }
                for (bounds, child) in self.children(index) {
                    if bounds.low.cmple(high).all() && low.cmple(bounds.high).all() {
                        stack.push(child);
                    }
                }
            }
        }
        all.filter(|&leaf| is_near[leaf as usize]).collect()
    }

    /// The largest value of an affine function with a gradient at the triangles' corners.
    fn farthest(&self, mesh: Meshes<'_>, along: impl Fn(DVec3) -> f64, gradient: DVec3) -> f64 {
        let mut farthest = f64::NEG_INFINITY;
        let mut stack = vec![(f64::INFINITY, 0_u32)];
        while let Some((bound, index)) = stack.pop() {
            if bound <= farthest {
                continue;
            }
            if index & LEAF != 0 {
                let leaf = &self.leaves[(index & !LEAF) as usize];
                for lane in set_bits(leaf.filled) {
                    for corner in self.corners(mesh, leaf, lane) {
                        farthest = farthest.max(along(corner));
                    }
                }
                continue;
            }
            let base = stack.len();
            for (Bounds { low, high }, child) in self.children(index) {
                let corner = DVec3::select(gradient.cmpge(DVec3::ZERO), high, low);
                stack.push((along(corner), child));
            }
            stack[base..].sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
        }
        farthest
    }

    /// The boxes of a node's children in the mesh's space, and the children.
    fn children(&self, node: u32) -> impl Iterator<Item = (Bounds, u32)> {
        let node = &self.nodes[node as usize];
        let space = self.space;
        // Where an end is so far from the origin that float64 rounds by more, float32 holds the
        // vertices without rounding.
        let margin = if self.is_exact { 0.0 } else { ROUNDED * space.unscale };
        (0..WIDTH).filter_map(move |child| {
            let end = |side: usize| {
                space.restored(arrays::from_fn(|axis| node.planes[2 * axis + side][child]))
            };
            let bounds = Bounds { low: end(0) - margin, high: end(1) + margin };
            (!bounds.is_empty()).then_some((bounds, node.children[child]))
        })
    }
}
