//! The leaf: up to sixteen triangles over up to sixteen shared vertices, in 256 bytes.

use bytemuck::{Pod, Zeroable};

use crate::simd::LANES;

/// A leaf and a lane are one number of 32 bits ([`super::TriangleId`]).
pub(super) const MOST_LEAVES: usize = (1 << 28) - 1;

/// The number of a leaf and a lane.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "there are sixteen lanes")]
pub(super) fn leaf_lane(leaf: u32, lane: usize) -> u32 {
    leaf * LANES as u32 + (lane % LANES) as u32
}

/// Triangles over vertices of their own, in the tree's space, as float32. Plain data: every byte of
/// it has a meaning.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
#[doc(hidden)]
pub struct Meshlet {
    /// The vertices, an array for each axis. Unused lanes repeat the first vertex.
    pub(super) vertices: [[f32; LANES]; 3],
    /// The lanes of the triangles' vertices, for each corner.
    pub(super) corners: [[u8; LANES]; 3],
    /// The place of the first triangle in the tree's order.
    pub(super) first: u32,
    /// The largest extent of a triangle along an axis.
    pub(super) size: f32,
    /// The largest extent of all of them together along an axis.
    pub(super) extent: f32,
    /// The lanes that have a triangle, a bit each.
    pub(super) filled: u16,
    /// Zero: no byte is left undefined.
    pub(super) reserved: u16,
}

impl Meshlet {
    /// The corners of a triangle, in the tree's space.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> [[f32; 3]; 3] {
        let corner = |k: usize| {
            let vertex = self.vertex(lane, k);
            [self.vertices[0][vertex], self.vertices[1][vertex], self.vertices[2][vertex]]
        };
        [corner(0), corner(1), corner(2)]
    }

    /// The lane of a triangle's corner among the vertices.
    #[inline(always)]
    pub(super) fn vertex(&self, lane: usize, corner: usize) -> usize {
        usize::from(self.corners[corner % 3][lane % LANES]) % LANES
    }
}
