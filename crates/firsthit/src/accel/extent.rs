//! Boxes around a mesh wherever a transform takes it, by its tree and not by all its triangles.

use super::mesh_tree::MeshTree;
use super::node::{LEAF, WIDTH};
use crate::geometry::{Bounds, DAffine3, DVec3, arrays};
use crate::shape::Mesh;
use crate::simd::set_bits;

/// How much wider a node's box is than the rounded vertices in it, in units of the tree: at least the rounding of one to float32.
const ROUNDED: f64 = 1.0 / (1_u64 << 22) as f64;

impl MeshTree {
    /// A box around the mesh after a transform, in constant time: the box around the transformed boxes of the root's children.
    /// `None` for a tree without nodes.
    pub(crate) fn transformed_bounds(&self, transform: &DAffine3) -> Option<Bounds> {
        self.nodes.first()?;
        let children = self.children(0).map(|(bounds, _)| bounds);
        let transformed = children.map(|bounds| bounds.transformed(transform));
        Some(transformed.fold(Bounds::EMPTY, Bounds::union))
    }

    /// The smallest box around the mesh after a transform, to the last bit of transforming all corners of its triangles. `None` for a
    /// tree without nodes.
    ///
    /// For each of its six ends visit the tree from the root, of a node's children the farthest first. A child whose box ends before
    /// what was found is left out. The corners of a box bound its vertices to the last bit: they go through the same operations, and
    /// rounding is monotone.
    pub(crate) fn smallest_bounds(&self, mesh: &Mesh, transform: &DAffine3) -> Option<Bounds> {
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

    /// The largest value of an affine function with a gradient at the triangles' corners.
    fn farthest(&self, mesh: &Mesh, along: impl Fn(DVec3) -> f64, gradient: DVec3) -> f64 {
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
        let (space, margin) = (self.space, if self.is_exact { 0.0 } else { ROUNDED });
        (0..WIDTH).filter_map(move |child| {
            let end = |side: usize, margin: f64| {
                let planes: [f64; 3] =
                    arrays::from_fn(|axis| node.planes[2 * axis + side][child].into());
                (DVec3::from(planes) + margin) * space.unscale + space.origin
            };
            let (low, high) = (end(0, -margin), end(1, margin));
            (low.x <= high.x).then_some((Bounds { low, high }, node.children[child]))
        })
    }
}
