//! The edge test of `edges.rs` for the samples of a tile, where sides are linear in the sample's
//! place.

use crate::accel::bounds::MEAN;
use crate::accel::edges::{Sides, depths};
use crate::simd::Lanes;

/// The triangles that have all samples of their bounding boxes outside. A linear side is largest
/// and smallest at corners of the box.
#[inline(always)]
pub(super) fn all_beside<L: Lanes>(
    l: L,
    [constants, across, down]: [[L::Floats; 3]; 3],
    [width, height]: [L::Floats; 2],
    bound: L::Floats,
) -> u16 {
    let zero = l.splat(0.0);
    macro_rules! end {
        ($k:literal, $choose:ident) => {{
            let along = l.$choose(l.mul(across[$k], width), zero);
            let down = l.$choose(l.mul(down[$k], height), zero);
            l.add(l.add(constants[$k], along), down)
        }};
    }
    let most = [end!(0, max), end!(1, max), end!(2, max)];
    let least = [end!(0, min), end!(1, min), end!(2, min)];
    beside(l, most, least, bound)
}

/// The ranges of samples that are outside their triangles for certain: one side is below `-bound`
/// everywhere in the range, and another above `bound`. `most` and `least` are the largest and the
/// smallest that each side is in the range.
#[inline(always)]
pub(super) fn beside<L: Lanes>(
    l: L,
    most: [L::Floats; 3],
    least: [L::Floats; 3],
    bound: L::Floats,
) -> u16 {
    let below = l.min(l.min(most[0], most[1]), most[2]);
    let above = l.max(l.max(least[0], least[1]), least[2]);
    l.lt(below, l.sub(l.splat(0.0), bound)) & l.lt(bound, above)
}

/// The edge test of sixteen pairs of a sample and a triangle.
pub(super) struct EdgeTest<L: Lanes> {
    /// The pairs that may meet.
    pub(super) possible: u16,
    /// Pairs that meet for certain, if they are possible.
    pub(super) certain: u16,
    /// The depths between which they meet.
    pub(super) low: L::Floats,
    pub(super) high: L::Floats,
}

impl<L: Lanes> EdgeTest<L> {
    /// Builds the test from the sides and their bound, and from the depths of the corners, the
    /// nearest and the farthest. `None` when no pair of `here` may meet.
    #[inline(always)]
    pub(super) fn new(
        l: L,
        sides: [L::Floats; 3],
        bound: L::Floats,
        corners: [L::Floats; 3],
        [nearest, farthest]: [L::Floats; 2],
        depth_error: f32,
        here: u16,
    ) -> Option<Self> {
        let sides = Sides(sides);
        let possible = here & !sides.outside(l, bound);
        if possible == 0 {
            return None;
        }
        let certain = sides.inside(l, bound);
        let [depth, over] = sides.depth(l, corners);
        let spread = l.sub(farthest, nearest);
        let weights = l.mul(l.mul(l.mul(l.splat(MEAN), bound), spread), over);
        let error = l.add(weights, l.splat(depth_error));
        let [low, high] = depths(l, certain, [depth, error], [nearest, farthest]);
        Some(Self { possible, certain, low, high })
    }
}
