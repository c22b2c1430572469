//! A ray made ready for a [`MeshTree`](super::super::MeshTree): float32, in the tree's space, with bounds for all
//! rounding.
//!
//! A length along the ray is a *depth*: a coordinate along the axis on which the direction is longest, counted from the
//! ray's start forwards. So the direction's other components are at most 1 for a depth of 1, and nothing leaves the
//! range of float32. The error bounds are shares of the reach (see `bounds.rs`). That is at least 1, so products too
//! small for float32 do no harm.

use crate::accel::node::Node;
use crate::simd::Lanes;

/// One of the rays of a [`Packet`](super::packet::Packet).
#[derive(Debug, Clone, Copy)]
pub(crate) struct TreeRay {
    /// The axis along which the direction is longest comes last.
    pub(in crate::accel) axes: [usize; 3],
    /// The start in two parts, along those axes.
    pub(in crate::accel) start: [[f32; 2]; 3],
    /// How far the ray moves along the first two of them for a depth of 1.
    pub(in crate::accel) slope: [f32; 2],
    /// Which way it goes along the third: 1 or -1.
    pub(in crate::accel) forwards: f32,
    /// The part of the error that does not shrink near the start: the rounding of the start in float64, and that of the
    /// vertices where float32 does not hold them.
    pub(in crate::accel) blur: f32,
    /// One over the direction, along the axes of space; finite.
    pub(in crate::accel) inverse: [f32; 3],
    /// Minus the start over the direction, for the first and for the last plane of a box that the ray meets along each
    /// axis. Each is moved by the margin, so that boxes seem wider.
    pub(in crate::accel) ends: [[f32; 2]; 3],
}

impl TreeRay {
    /// Which of a node's boxes the ray may meet at a depth of at most `limit`, and at which depths.
    ///
    /// Ize, "Robust BVH Ray Traversal", Journal of Computer Graphics Techniques 2(2), 2013. It departs in the margin:
    /// there distances are multiplied after the test, here the two ends have it already, which costs no time.
    #[inline(always)]
    pub(in crate::accel) fn boxes<L: Lanes>(
        &self,
        l: L,
        node: &Node,
        limit: f32,
    ) -> (u16, L::Floats) {
        macro_rules! end {
            ($axis:literal, $side:literal) => {{
                // Backwards, the high plane comes first.
                let is_back = (self.inverse[$axis].to_bits() >> 31) as usize;
                let plane = l.load(&node.planes[2 * $axis + (is_back ^ $side) % 2]);
                l.mul_add(
                    plane,
                    l.splat(self.inverse[$axis]),
                    l.splat(self.ends[$axis][$side]),
                )
            }};
        }
        let entry = l.max(
            l.max(end!(0, 0), end!(1, 0)),
            l.max(end!(2, 0), l.splat(0.0)),
        );
        let exit = l.min(
            l.min(end!(0, 1), end!(1, 1)),
            l.min(end!(2, 1), l.splat(limit)),
        );
        (l.le(entry, exit), entry)
    }
}
