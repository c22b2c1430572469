//! Which triangles of a leaf may a ray meet? Decided in float32 where that is certain, and only there.
//!
//! The test is that of the judge (`shape/triangle.rs`): the sides of the sheared triangle's edges that the
//! ray is on. Let `E` bound what a sheared coordinate is off, and `X` the coordinates themselves. Then each
//! side, a difference of two products, is off by at most `B = (4.2 E + 9 u X) X`: 4 E X from the
//! coordinates (and the 0.2 for what is quadratic in E), 4 u X^2 from rounding, and as much again. So
//!
//! - where one side is below -B and another above B, the judge finds the same signs and rejects;
//! - where all are beyond B on the same side, the judge finds the same signs and accepts.
//!
//! `X` needs to hold only where the verdict is used: there the ray is inside the triangle, the judge's or
//! this one, so no coordinate is larger than the triangle's extent across the ray, which is at most its
//! extent along an axis twice, and E. `E` in units of `u reach`: the vertex 1, the start 1 and their
//! difference 1; the same along the ray, times a slope of at most 1; the slope itself 1; product and
//! difference 2 where they are not fused: in all 8. The judge's own rounding is 2^-29 of that.

use super::meshlet::Meshlet;
use super::ray::{TreeRay, U};
use crate::simd::Lanes;

/// What float32 knows about a leaf's triangles.
pub(super) struct Candidates<L: Lanes> {
    /// Those the ray may meet.
    pub(super) possible: u16,
    /// Those of them whose inside it meets for certain.
    pub(super) certain: u16,
    /// Depths between which the judge's is, where it meets one.
    pub(super) low: L::Floats,
    pub(super) high: L::Floats,
}

/// The candidates of `leaf` at depths from 0 to `limit`; `None` without any.
#[inline(always)]
pub(super) fn filter<L: Lanes>(
    l: L,
    ray: &TreeRay<L>,
    leaf: &Meshlet,
    limit: f32,
) -> Option<Candidates<L>> {
    let error = 9.0 * U * ray.reach + 3.0 * ray.blur;
    let size = 2.02 * leaf.size + 2.1 * error;
    let bound = 1.01 * (4.2 * error + 9.0 * U * size) * size;

    let [x, y, z] = ray.axes;
    let z = l.mul(
        l.sub(l.load(&leaf.vertices[z % 3]), ray.start[2]),
        ray.forwards,
    );
    let x = l.neg_mul_add(
        ray.slope[0],
        z,
        l.sub(l.load(&leaf.vertices[x % 3]), ray.start[0]),
    );
    let y = l.neg_mul_add(
        ray.slope[1],
        z,
        l.sub(l.load(&leaf.vertices[y % 3]), ray.start[1]),
    );
    let [a, b, c] = &leaf.corners;
    let (ax, bx, cx) = (l.permute(x, a), l.permute(x, b), l.permute(x, c));
    let (ay, by, cy) = (l.permute(y, a), l.permute(y, b), l.permute(y, c));
    let u = l.mul_sub(cx, by, l.mul(cy, bx));
    let v = l.mul_sub(ax, cy, l.mul(ay, cx));
    let w = l.mul_sub(bx, ay, l.mul(by, ax));
    let (least, most) = (l.min(l.min(u, v), w), l.max(l.max(u, v), w));
    let (minus, plus) = (l.splat(-bound), l.splat(bound));
    let possible = leaf.filled & !(l.lt(least, minus) & l.lt(plus, most));
    if possible == 0 {
        return None;
    }
    let certain = l.lt(plus, least) | l.lt(most, minus);

    let (az, bz, cz) = (l.permute(z, a), l.permute(z, b), l.permute(z, c));
    let slack = l.splat(ray.depth_error());
    let nearest = l.sub(l.min(l.min(az, bz), cz), slack);
    let farthest = l.add(l.max(l.max(az, bz), cz), slack);
    let possible = possible & l.le(nearest, l.splat(limit)) & l.le(l.splat(0.0), farthest);
    if possible == 0 {
        return None;
    }
    // The corners' depths in the mean of the sides. The weights are off by 6 B / |sum| in all, and what they
    // weigh differs by no more than the triangle's size.
    let sum = l.add(l.add(u, v), w);
    let depth = l.div(l.mul_add(u, az, l.mul_add(v, bz, l.mul(w, cz))), sum);
    let weights = l.div(l.splat(6.1 * bound * leaf.size), l.abs(sum));
    let around = l.add(weights, slack);
    // Where the sides say too little, the triangle's own depths.
    Some(Candidates {
        possible,
        certain,
        low: l.select(certain, l.max(l.sub(depth, around), nearest), nearest),
        high: l.select(certain, l.min(l.add(depth, around), farthest), farthest),
    })
}
