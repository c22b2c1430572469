//! The slab test of one ray with the sixteen boxes of a node, of sixteen rays with one box, and of
//! the intervals around several rays' numbers with a node.
//!
//! Each operation of the test is monotone in its arguments, rounding included. So a box that the
//! intervals miss is missed by every ray, to the bit of its own test.

use super::packet::RAYS;
use crate::accel::node::Node;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
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
const SMALLEST: f32 = 1e-30;

/// One over a component of a direction, and the two [ends](Slabs::ends) along its axis. For float64
/// of one ray or of lanes, with the same bits: no operation is fused.
#[inline(always)]
pub(in crate::accel) fn slab<A: Arithmetic>(
    of: A,
    start: A::Number,
    direction: A::Number,
    margin: A::Number,
) -> (A::Number, [A::Number; 2]) {
    let (zero, smallest) = (of.number(0.0), of.number(f64::from(SMALLEST)));
    let back = of.lt(direction, zero);
    let minus_if_back = |x: A::Number| of.select(back, of.sub(zero, x), x);
    let is_small = of.lt(minus_if_back(direction), smallest);
    let over = of.div(of.number(1.0), of.select(is_small, minus_if_back(smallest), direction));
    let (wider, minus) = (minus_if_back(margin), of.sub(zero, over));
    (over, [of.mul(of.add(start, wider), minus), of.mul(of.sub(start, wider), minus)])
}

/// [`slab`] in float32, for the tree of a mesh. It has a form of its own with fewer operations,
/// fused where lanes can; the margin covers its rounding (see `prepare.rs`).
#[inline(always)]
pub(in crate::accel) fn narrow_slab<L: Lanes>(
    l: L,
    start: L::Floats,
    direction: L::Floats,
    margin: L::Floats,
) -> (L::Floats, [L::Floats; 2]) {
    let over = l.div(l.splat(1.0), direction);
    // Finite for a zero, too.
    let over = l.max(l.min(over, l.splat(1.0 / SMALLEST)), l.splat(-1.0 / SMALLEST));
    let (size, minus) = (l.abs(over), l.sub(l.splat(0.0), margin));
    let first = l.neg_mul_add(start, over, l.mul(minus, size));
    (over, [first, l.neg_mul_add(start, over, l.mul(margin, size))])
}

/// The rays, a lane each, that meet the box of a child of a node, which is there, at depths from
/// `entry` to `exit`: to the bit what [`Slabs::boxes`] says of each ray.
#[inline(always)]
pub(in crate::accel) fn rays_at<L: Lanes>(
    l: L,
    (node, child): (&Node, usize),
    (inverse, ends): (&[[f32; RAYS]; 3], &[[[f32; RAYS]; 2]; 3]),
    (mut entry, mut exit): (L::Floats, L::Floats),
) -> u16 {
    for axis in 0..3 {
        let low = l.splat(node.planes[2 * axis][child % RAYS]);
        let high = l.splat(node.planes[2 * axis + 1][child % RAYS]);
        let inverse = l.load(&inverse[axis]);
        let [first, last] = &ends[axis];
        let (first, last) = (l.load(first), l.load(last));
        let near = l.min(l.mul_add(low, inverse, first), l.mul_add(high, inverse, first));
        let far = l.max(l.mul_add(low, inverse, last), l.mul_add(high, inverse, last));
        (entry, exit) = (l.max(entry, near), l.min(exit, far));
    }
    l.le(entry, exit)
}

impl Slabs {
    /// The slabs of a ray whose direction has a largest component of one, for boxes that seem wider
    /// by `margin`.
    #[expect(clippy::cast_possible_truncation, reason = "the margin covers the rounding")]
    #[inline(always)]
    pub(in crate::accel) fn new(start: DVec3, direction: DVec3, margin: f64) -> Self {
        let (mut inverse, mut ends) = ([0.0; 3], [[0.0; 2]; 3]);
        for axis in 0..3 {
            let (over, both) = slab(Scalar, start[axis], direction[axis], margin);
            inverse[axis] = over as f32;
            ends[axis] = arrays::map(both, |end| end as f32);
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

/// The least and the largest of the numbers that some rays' slab tests take.
pub(in crate::accel) struct Intervals {
    /// Of one over the direction along each axis; all numbers where rays go in both directions.
    pub(in crate::accel) inverse: [[f32; 2]; 3],
    /// The least of the first ends, and the largest of the last.
    pub(in crate::accel) ends: [[f32; 2]; 3],
}

impl Intervals {
    /// The intervals before there is a ray: all numbers.
    pub(in crate::accel) const ALL: Self = Self {
        inverse: [[f32::NEG_INFINITY, f32::INFINITY]; 3],
        ends: [[f32::NEG_INFINITY, f32::INFINITY]; 3],
    };

    /// The intervals around the numbers of `rays`.
    #[inline(always)]
    pub(in crate::accel) fn around<L: Lanes>(
        l: L,
        rays: u16,
        inverse: &[[f32; RAYS]; 3],
        ends: &[[[f32; RAYS]; 2]; 3],
    ) -> Self {
        let mut around = Self::ALL;
        for axis in 0..3 {
            let back = l.lt(l.load(&inverse[axis]), l.splat(0.0)) & rays;
            if back == 0 || back == rays {
                let ([first, last], inverse) = (&ends[axis], &inverse[axis]);
                around.inverse[axis] = [least(l, rays, inverse), most(l, rays, inverse)];
                around.ends[axis] = [least(l, rays, first), most(l, rays, last)];
            }
        }
        around
    }

    /// The boxes of a node that any ray may meet at depths from `first` to `last`, and the depths.
    #[inline(always)]
    pub(in crate::accel) fn boxes<L: Lanes>(
        &self,
        l: L,
        node: &Node,
        [first, last]: [f32; 2],
    ) -> (u16, L::Floats) {
        let (mut entry, mut exit) = (l.splat(first), l.splat(last));
        for axis in 0..3 {
            let [low, high] = self.inverse[axis];
            let is_back = usize::from(high < 0.0);
            if is_back == 0 && low < 0.0 {
                continue;
            }
            let (low, high) = (l.splat(low), l.splat(high));
            let [first, last] = arrays::map(self.ends[axis], |end| l.splat(end));
            let near = l.load(&node.planes[2 * axis + is_back]);
            let far = l.load(&node.planes[2 * axis + (is_back ^ 1)]);
            entry = l.max(entry, l.min(l.mul_add(near, low, first), l.mul_add(near, high, first)));
            exit = l.min(exit, l.max(l.mul_add(far, low, last), l.mul_add(far, high, last)));
        }
        (l.le(entry, exit), entry)
    }
}

/// The least of some rays' numbers.
#[inline(always)]
pub(in crate::accel) fn least<L: Lanes>(l: L, rays: u16, numbers: &[f32; RAYS]) -> f32 {
    l.smallest(l.select(rays, l.load(numbers), l.splat(f32::INFINITY)))
}

/// The largest of some rays' numbers.
#[inline(always)]
pub(in crate::accel) fn most<L: Lanes>(l: L, rays: u16, numbers: &[f32; RAYS]) -> f32 {
    l.largest(l.select(rays, l.load(numbers), l.splat(f32::NEG_INFINITY)))
}
