//! A ray made ready for a [`MeshTree`](super::super::MeshTree): float32, in the tree's space, with
//! bounds for all rounding.
//!
//! A length along the ray is a *depth*: a coordinate along the axis on which the direction is
//! longest, counted from the ray's start forwards. So the direction's other components are at most
//! 1 for a depth of 1, and nothing leaves the range of float32. The error bounds are shares of the
//! reach (see `bounds.rs`). That is at least 1, so products too small for float32 do no harm.

use super::slabs::Slabs;
use crate::accel::node::Node;
use crate::simd::Lanes;

/// One of the rays of a [`Packet`](super::packet::Packet).
#[derive(Debug, Clone, Copy)]
pub(crate) struct TreeRay {
    /// The axis along which the direction is longest comes last.
    pub(in crate::accel) axes: [usize; 3],
    /// The start in two parts, along those axes.
    pub(in crate::accel) start: [[f32; 2]; 3],
    /// The movement of the ray along the first two axes for a depth of 1.
    pub(in crate::accel) slope: [f32; 2],
    /// The direction along the third axis: 1 or -1.
    pub(in crate::accel) forwards: f32,
    /// The part of the error that does not shrink near the start: the rounding of the start in
    /// float64, and that of the vertices where float32 does not hold them.
    pub(in crate::accel) blur: f32,
    pub(in crate::accel) slabs: Slabs,
}

impl TreeRay {
    /// The boxes of a node that the ray may meet at a depth of at most `limit`, and the depths.
    #[inline(always)]
    pub(in crate::accel) fn boxes<L: Lanes>(
        &self,
        l: L,
        node: &Node,
        limit: f32,
    ) -> (u16, L::Floats) {
        self.slabs.boxes(l, node, [0.0, limit])
    }
}
