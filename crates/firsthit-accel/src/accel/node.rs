//! A node of a [`MeshTree`](super::MeshTree) or a [`Bvh`](super::Bvh): sixteen boxes and what is in
//! them.

use bytemuck::{Pod, Zeroable};

use crate::simd::LANES;

/// The most children of a node.
pub(super) const WIDTH: usize = LANES;
/// Marks a child that is a leaf.
pub(super) const LEAF: u32 = 1 << 31;

/// Boxes side by side, and what is in them.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
#[doc(hidden)]
pub struct Node {
    /// The boxes' ends: low x, high x, low y, high y, low z, high z. The box of a child that is not
    /// there begins at plus infinity and ends at minus infinity, so no ray meets it.
    pub(super) planes: [[f32; WIDTH]; 6],
    /// The index of a node or, with [`LEAF`], of a leaf; in a [`Bvh`](super::Bvh) of a box.
    pub(super) children: [u32; WIDTH],
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [LEAF; WIDTH],
    };

    /// Whether a child is not there.
    #[inline(always)]
    pub(super) fn is_vacant(&self, child: usize) -> bool {
        self.planes[0][child] > self.planes[1][child]
    }
}
