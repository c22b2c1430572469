//! The slab test of one ray with the sixteen boxes of a node.

use crate::accel::node::Node;
use crate::geometry::{DVec3, arrays};
use crate::simd::Lanes;

/// A ray made ready for boxes, along the axes of space.
#[derive(Debug, Clone, Copy)]
pub(in crate::accel) struct Slabs {
    /// One over the direction; finite.
    pub(in crate::accel) inverse: [f32; 3],
    /// Minus the start over the direction, for the first and for the last plane of a box that the
    /// ray meets along each axis. Each is moved by the margin, so that boxes seem wider.
    pub(in crate::accel) ends: [[f32; 2]; 3],
}

/// A component of a direction that is smaller moves a ray by less than every margin. One over it is
/// taken to be a huge number of its sign, which still tells inside from outside.
pub(in crate::accel) const SMALLEST: f32 = 1e-30;

impl Slabs {
    /// The slabs of a ray whose direction has a largest component of one, for boxes that seem wider
    /// by `margin`.
    #[expect(clippy::cast_possible_truncation, reason = "the margin covers the rounding")]
    #[inline(always)]
    pub(in crate::accel) fn new(start: DVec3, direction: DVec3, margin: f64) -> Self {
        let (mut inverse, mut ends) = ([0.0; 3], [[0.0; 2]; 3]);
        for axis in 0..3 {
            let is_back = direction[axis] < 0.0;
            let wider = if is_back { -margin } else { margin };
            let smallest = f64::from(SMALLEST);
            let over = if direction[axis].abs() < smallest {
                (1.0 / smallest).copysign(wider)
            } else {
                1.0 / direction[axis]
            };
            inverse[axis] = over as f32;
            let start = start[axis];
            ends[axis] = arrays::map([start + wider, start - wider], |end| (end * -over) as f32);
        }
        Self { inverse, ends }
    }

    /// The boxes of a node that the ray may meet at depths from `first` to `last`, and the depths.
    ///
    /// Ize, "Robust BVH Ray Traversal", Journal of Computer Graphics Techniques 2(2), 2013. It
    /// departs in the margin: there distances are multiplied after the test, here the two ends have
    /// it already, which costs no time.
    #[inline(always)]
    pub(in crate::accel) fn boxes<L: Lanes>(
        &self,
        l: L,
        node: &Node,
        [first, last]: [f32; 2],
    ) -> (u16, L::Floats) {
        macro_rules! end {
            ($axis:literal, $side:literal) => {{
                // Backwards, the high plane comes first.
                let is_back = (self.inverse[$axis].to_bits() >> 31) as usize;
                let plane = l.load(&node.planes[2 * $axis + (is_back ^ $side) % 2]);
                l.mul_add(plane, l.splat(self.inverse[$axis]), l.splat(self.ends[$axis][$side]))
            }};
        }
        let entry = l.max(l.max(end!(0, 0), end!(1, 0)), l.max(end!(2, 0), l.splat(first)));
        let exit = l.min(l.min(end!(0, 1), end!(1, 1)), l.min(end!(2, 1), l.splat(last)));
        (l.le(entry, exit), entry)
    }
}
