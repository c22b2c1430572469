//! The edge test of `edges.rs` for a tile's samples: where the sides of a triangle's edges are linear.

use crate::accel::bounds::MEAN;
use crate::accel::edges::{Sides, depths};
use crate::simd::Lanes;

/// Which triangles have all samples of their bounding boxes beyond one of their edges: a linear side is largest and
/// smallest at corners of the box.
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

/// Which ranges of samples are outside their triangles, from the largest and the smallest that each side is in the
/// range: one side is below `-bound` everywhere, and one above `bound`.
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

/// What the edge test says of sixteen pairs of a sample and a triangle.
pub(super) struct EdgeTest<L: Lanes> {
    /// The pairs that may meet.
    pub(super) possible: u16,
    /// Those of them, and perhaps others, that meet for certain.
    pub(super) certain: u16,
    /// Depths between which they meet.
    pub(super) low: L::Floats,
    pub(super) high: L::Floats,
}

impl<L: Lanes> EdgeTest<L> {
    /// From the sides, their bound, the corners' depths and the ends of these; `None` when no pair of `here` may meet.
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
        Some(Self {
            possible,
            certain,
            low,
            high,
        })
    }
}
