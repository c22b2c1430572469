//! What the sides of triangles' edges say about samples, with a triangle or a sample in each lane.

use crate::simd::Lanes;

/// Which triangles have all samples of their bounding boxes beyond one of their edges. (A side is linear: the corners
/// of the box tell.)
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

/// Where all of a range of samples is past the triangle, `most` and `least` being the sides' ends in it: one side is
/// below all bounds everywhere, and one above.
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

/// What the sides of the edges say; as in `filter.rs`.
pub(super) struct Verdict<L: Lanes> {
    /// The samples that the triangle may be met at, and which of these, or others, are inside it for certain.
    pub(super) possible: u16,
    pub(super) certain: u16,
    /// Depths between which it is met there.
    pub(super) low: L::Floats,
    pub(super) high: L::Floats,
}

impl<L: Lanes> Verdict<L> {
    /// `None` when nothing is possible among `here`.
    #[inline(always)]
    pub(super) fn new(
        l: L,
        [u, v, w]: [L::Floats; 3],
        bound: L::Floats,
        [az, bz, cz]: [L::Floats; 3],
        [nearest, farthest]: [L::Floats; 2],
        depth_error: f32,
        here: u16,
    ) -> Option<Self> {
        let (least, most) = (l.min(l.min(u, v), w), l.max(l.max(u, v), w));
        let minus = l.sub(l.splat(0.0), bound);
        let possible = here & !(l.lt(least, minus) & l.lt(bound, most));
        if possible == 0 {
            return None;
        }
        let certain = l.lt(bound, least) | l.lt(most, minus);
        let sum = l.add(l.add(u, v), w);
        let over = l.div(l.splat(1.0), sum);
        let depth = l.mul(l.mul_add(u, az, l.mul_add(v, bz, l.mul(w, cz))), over);
        let spread = l.sub(farthest, nearest);
        let weights = l.mul(l.mul(l.mul(l.splat(2.1), bound), spread), l.abs(over));
        let around = l.add(weights, l.splat(depth_error));
        Some(Self {
            possible,
            certain,
            low: l.select(certain, l.max(l.sub(depth, around), nearest), nearest),
            high: l.select(certain, l.min(l.add(depth, around), farthest), farthest),
        })
    }
}
