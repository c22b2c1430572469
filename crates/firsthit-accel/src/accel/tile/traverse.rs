//! The rays of a camera's tile, 16 by 16 pixels, together through the tree of a mesh.
//!
//! 1. Put planes around the tile's rays ([`TileFrustum`]).
//! 2. At a node, test its sixteen boxes against the planes, and continue with the nearest one that
//!    is left.
//! 3. At a leaf, rasterise its triangles into the tile's [`VisibilityBuffer`] (`raster.rs`).
//! 4. Where float32 cannot tell which triangle of a pixel is nearer, ask the [`ExactTest`].
//!
//! Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", ACM Transactions on Graphics
//! 24(3), 2005. It departs in the leaves, where triangles are rasterised, and no ray is traversed
//! alone.

use super::frustum::TileFrustum;
use super::raster::{LeafRaster, RasterScratch};
use super::visibility::{Displacements, ExactTest, VisibilityBuffer};
use crate::accel::mesh_tree::MeshTree;
use crate::accel::node::{LEAF, Node};
use crate::accel::traverse::stack::Stack;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// Memory for tiles, to be used again.
#[derive(Debug)]
#[doc(hidden)]
pub struct TileScratch {
    stack: Stack,
    raster: Box<RasterScratch>,
}

impl Default for TileScratch {
    fn default() -> Self {
        Self { stack: Stack::new(), raster: Box::default() }
    }
}

/// Puts the triangles of a mesh into `buffer` where they are nearer than what is there.
#[inline(always)]
#[doc(hidden)]
pub fn fill_buffer<L: Lanes>(
    l: L,
    scratch: &mut TileScratch,
    tree: &MeshTree,
    (frustum, displacements): (&TileFrustum, Option<&Displacements>),
    object: u32,
    buffer: &mut VisibilityBuffer,
    exact: &mut impl ExactTest,
) {
    let TileScratch { stack, raster } = scratch;
    stack.clear();
    let mut index = 0_u32;
    let mut entry = 0.0_f32;
    let mut limit = buffer.limit(l);
    loop {
        if index & LEAF == 0 {
            let node = &tree.nodes[index as usize];
            open(l, tree, node, frustum, limit, stack);
        } else {
            let number = index & !LEAF;
            let leaf = &tree.leaves[number as usize];
            let mut leaf = LeafRaster {
                frustum,
                displacements,
                leaf,
                filled: tree.present(number, leaf.filled),
                first: tree.order.get(leaf.first as usize),
                object,
                leaf_lane: number * 16,
                buffer,
                exact,
                scratch: raster,
                changed: 0,
            };
            leaf.run(l, entry, limit);
            let changed = leaf.changed;
            if changed != 0 {
                for block in set_bits(changed) {
                    buffer.update_block(l, block);
                }
                limit = buffer.limit(l);
            }
        }
        let Some(next) = stack.pop_within(limit) else {
            return;
        };
        (entry, index) = next;
    }
}

/// Puts the children that the frustum may meet onto the stack, the nearest on top.
#[inline(always)]
fn open<L: Lanes>(
    l: L,
    tree: &MeshTree,
    node: &Node,
    frustum: &TileFrustum,
    limit: f32,
    stack: &mut Stack,
) {
    let (met, nearest) = frustum.boxes(l, node, limit);
    let mut entries = Aligned([0.0; LANES]);
    l.store(nearest, &mut entries.0);
    let base = stack.len();
    for child in set_bits(met) {
        let index = node.children[child];
        if index & LEAF == 0 {
            l.prefetch(&tree.nodes[index as usize]);
        } else {
            l.prefetch(&tree.leaves[(index & !LEAF) as usize]);
        }
        let key = u64::from(entries.0[child].to_bits()) << 32 | u64::from(index);
        stack.insert(base, key);
    }
}
