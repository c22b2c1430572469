//! The point of a segment that is nearest to a point.
//!
//! Neighbours share an edge, so its distance must be a function of the edge alone: the ends are
//! brought into an order first.
//!
//! 1. Decide in float64 whether an end is nearest, or a point between: by the signs of two dot
//!    products. Where rounding could matter, in twice the digits.
//! 2. Of an end, the distance is that of two points.
//! 3. Else compute the offset of the point between. Where it is shorter than half the way to the
//!    farther end, float64 would lose digits: compute it in twice the digits.
//!
//! # Error bounds
//!
//! In units of 2^-53. A dot product of a difference of points with an edge is off by 2 for the two
//! differences, 1 for each product and 2 for the sum, times the sum of the products' sizes; `DOT`
//! is twice that. The offset of a point between is off by 4 times the way to the farther end across
//! the segment (what it is off along the segment changes its length only in the second order);
//! where step 3 takes float64, that is 8 times the distance.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use crate::geometry::DVec3;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{Double, DoubleVector, between, dot, product, quotient, sum};

/// See the error bounds.
const DOT: f64 = 6.0 * f64::EPSILON;

/// The nearest point of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Foot {
    pub(super) squared: f64,
    /// The place between the ends: 0 at the first, 1 at the second.
    pub(super) share: f64,
}

/// Differences of two points without rounding.
#[inline(always)]
pub(super) fn apart(p: DVec3, q: DVec3) -> DoubleVector<f64> {
    between(Scalar, &p.to_array(), &q.to_array())
}

/// `p - q` times `r - q`; its sign is that of the exact product, but for what twice the digits
/// round.
#[inline(always)]
fn along(p: DVec3, q: DVec3, r: DVec3) -> f64 {
    let (x, y) = (p - q, r - q);
    let plain = x.dot(y);
    if plain.abs() > DOT * (x * y).abs().element_sum() {
        plain
    } else {
        along_exactly(p, q, r).high
    }
}

#[inline(always)]
fn along_exactly(p: DVec3, q: DVec3, r: DVec3) -> Double<f64> {
    dot(Scalar, &apart(p, q), &apart(r, q))
}

/// Whether `a` comes before `b` in the order of their coordinates.
#[inline(always)]
fn is_before(a: DVec3, b: DVec3) -> bool {
    a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.z < b.z)))
}

/// The point of the segment from `a` to `b` that is nearest to `p`.
#[inline(always)]
pub(super) fn nearest_on_segment(p: DVec3, a: DVec3, b: DVec3) -> Foot {
    if is_before(b, a) {
        let foot = ordered(p, b, a);
        Foot { share: 1.0 - foot.share, ..foot }
    } else {
        ordered(p, a, b)
    }
}

#[inline(always)]
fn ordered(p: DVec3, a: DVec3, b: DVec3) -> Foot {
    let end = |end: DVec3, share| Foot { squared: (end - p).length_squared(), share };
    let from_a = along(p, a, b);
    if from_a.is_nan() || from_a <= 0.0 {
        return end(a, 0.0);
    }
    let from_b = along(p, b, a);
    if from_b <= 0.0 {
        return end(b, 1.0);
    }
    let share = from_a / (from_a + from_b);
    let (to_a, to_b, edge) = (a - p, b - p, b - a);
    let offset =
        if share <= 0.5 { to_a + share * edge } else { to_b - from_b / (from_a + from_b) * edge };
    let squared = offset.length_squared();
    let farther = to_a.length_squared().max(to_b.length_squared());
    if 4.0 * squared >= farther { Foot { squared, share } } else { between_exactly(p, a, b) }
}

/// The foot in double-double, for a point that is nearest between the ends.
#[inline(always)]
fn between_exactly(p: DVec3, a: DVec3, b: DVec3) -> Foot {
    let (to_a, edge) = (apart(a, p), apart(b, a));
    let (from_a, length) = (along_exactly(p, a, b), dot(Scalar, &edge, &edge));
    let share = quotient(Scalar, from_a, length);
    let offset = [0, 1, 2].map(|k| {
        let way = product(Scalar, share.high, edge[k].high);
        let rest = share.high.mul_add(edge[k].low, share.low * edge[k].high) + way.low;
        let moved = sum(Scalar, to_a[k].high, way.high);
        moved.high + (moved.low + (to_a[k].low + rest))
    });
    Foot { squared: DVec3::from(offset).length_squared(), share: share.high.clamp(0.0, 1.0) }
}
