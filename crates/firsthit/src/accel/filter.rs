//! Which triangles of a leaf may a ray meet? Decided in float32 where that is certain, and only there.
//!
//! The test is the exact one's (`shape/triangle.rs`): on which sides of the sheared triangle's edges the ray passes. Let `E`
//! bound what a sheared coordinate is off, and `X` the coordinates themselves. Then each side, a difference of two products, is off by at most `B = (4.2 E + 9 u X) X`: 4 E X from the
//! coordinates (and the 0.2 for what is quadratic in E), 4 u X^2 from rounding, and as much again. So
//!
//! - where one side is below -B and another above B, the exact test finds the same signs and rejects;
//! - where all are beyond B on the same side, the exact test finds the same signs and accepts.
//!
//! The first needs a `B` for rays that are inside the triangle: there no coordinate is larger than the
//! triangle's extent across the ray, which is at most its extent along an axis twice, and E. The second needs one for
//! any ray: what looks like a tiny inside may be the rounding of a triangle without any, far from the ray. But the ray
//! passes the leaf's box, so no coordinate is larger than the leaf's extent along an axis twice, and what the test
//! of the box allows for.
//!
//! `E`, in units of u, of a vertex at the depth D that is P from the start across the axis of the depth: two differences
//! 2 P; two along the ray, times a slope of at most 1, 2 D; the slope itself D; product and difference, where they are not
//! fused, D + X. As P is at most X + D, and X twice an extent, that is 6 D and 6 extents. To that comes the
//! ray's `blur`, three times, in which is what float64 rounds when it makes the ray ready. The exact test adds nothing.
//!
//! Where the ray meets the inside for certain, its depth is the corners' mean with the sides as weights. Two things are off:
//! - The corners' places, by E along x and y. Then the plane through them passes the ray at a depth that is off by
//!   the plane's slopes times E, and a slope is at most the triangle's extent across times its spread in depth, over the sum
//!   of the sides (a triangle in a rectangle has half its area at most): 2 E X spread / sum.
//! - The sides' own rounding, 3 u X^2 each (two products, and a difference that inside is no more than X^2). It comes to
//!   that over the sum times what each corner's depth is from the mean, which is twice the spread for all three:
//!   6 u X^2 spread / sum.
//!
//! That sum is the one computed. The exact one of the first is smaller by 9 u X^2 at most: as each side is above
//! the bound, 4.3 E X + 9.2 u X^2, it is two thirds of that at least, and the difference comes to 2.1 u X^2 spread / sum: in
//! all 2 E X + 8.1 u X^2. (Beams and tiles have a simpler bound: where each side is off by B, the mean is off by B / sum
//! times what each corner's depth is from it, 2 B spread / sum.)

use super::bounds::{
    BLURS, BOX_MARGIN, DEPTH, EXTENT_ACROSS, MEAN, MEAN_BY_SIZE, SIDE_BY_ERROR, SIDE_BY_SIZE,
    VERTEX,
};
use super::edges::{Sides, depths};
use super::meshlet::Meshlet;
use super::rays::tree_ray::TreeRay;
use crate::simd::Lanes;

/// What float32 knows about a leaf's triangles.
pub(crate) struct Candidates<L: Lanes> {
    /// Those the ray may meet.
    pub(super) possible: u16,
    /// Those of them whose inside it meets for certain.
    pub(super) certain: u16,
    /// Depths between which the ray meets the triangle, if it does.
    pub(super) low: L::Floats,
    pub(super) high: L::Floats,
}

/// The candidates of `leaf` at depths from 0 to `limit`; `None` without any.
#[inline(always)]
pub(super) fn filter<L: Lanes>(
    l: L,
    ray: &TreeRay,
    leaf: &Meshlet,
    limit: f32,
) -> Option<Candidates<L>> {
    let [x, y, z] = ray.axes;
    macro_rules! relative {
        ($axis:ident, $k:literal) => {{
            let [high, low] = ray.start[$k];
            let vertices = l.load(&leaf.vertices[$axis % 3]);
            l.sub(l.sub(vertices, l.splat(high)), l.splat(low))
        }};
    }
    let z = l.mul(relative!(z, 2), l.splat(ray.forwards));
    let x = l.neg_mul_add(l.splat(ray.slope[0]), z, relative!(x, 0));
    let y = l.neg_mul_add(l.splat(ray.slope[1]), z, relative!(y, 1));
    let [a, b, c] = &leaf.corners;
    let (az, bz, cz) = (l.permute(z, a), l.permute(z, b), l.permute(z, c));
    let (nearest, farthest) = (l.min(l.min(az, bz), cz), l.max(l.max(az, bz), cz));
    let deep = l.max(l.abs(nearest), l.abs(farthest));
    let blur = l.splat(BLURS * ray.blur);
    macro_rules! bound {
        ($extent:expr, $more:expr) => {{
            let fixed = l.splat(VERTEX * $extent + BLURS * ray.blur);
            let error = l.mul_add(deep, l.splat(VERTEX), fixed);
            let size = l.mul_add(
                error,
                l.splat(2.1),
                l.splat(EXTENT_ACROSS * $extent + $more),
            );
            let share = l.mul_add(
                error,
                l.splat(SIDE_BY_ERROR),
                l.mul(size, l.splat(SIDE_BY_SIZE)),
            );
            (l.mul(share, size), error, size)
        }};
    }
    let (bound, error, size) = bound!(leaf.size, 0.0);

    let (ax, bx, cx) = (l.permute(x, a), l.permute(x, b), l.permute(x, c));
    let (ay, by, cy) = (l.permute(y, a), l.permute(y, b), l.permute(y, c));
    let sides = Sides::new(l, [ax, ay], [bx, by], [cx, cy]);
    let outside = sides.outside(l, bound);
    let slack = l.mul_add(deep, l.splat(DEPTH), blur);
    let spread = l.sub(farthest, nearest);
    let (nearest, farthest) = (l.sub(nearest, slack), l.add(farthest, slack));
    let between = l.le(nearest, l.splat(limit)) & l.le(l.splat(0.0), farthest);
    let possible = leaf.filled & !outside & between;
    if possible == 0 {
        return None;
    }
    let (sure, ..) = bound!(leaf.extent, 2.0 * BOX_MARGIN);
    let certain = sides.inside(l, sure);
    let [depth, over] = sides.depth(l, [az, bz, cz]);
    let share = l.mul_add(error, l.splat(MEAN), l.mul(size, l.splat(MEAN_BY_SIZE)));
    let mean_error = l.mul(l.mul(share, size), l.mul(spread, over));
    let error = l.add(mean_error, slack);
    let [low, high] = depths(l, certain, [depth, error], [nearest, farthest]);
    let possible = possible & l.le(low, l.splat(limit)) & l.le(l.splat(0.0), high);
    Some(Candidates {
        possible,
        certain,
        low,
        high,
    })
}
