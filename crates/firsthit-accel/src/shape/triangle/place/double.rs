//! A crossing in twice the digits of float64.
//!
//! 1. Compute `n = E x F`, `n.R` and `n.d` in twice the digits (`geometry/double.rs`).
//! 2. Give up where one of the dot products is so small beside the vectors that too few digits are
//!    left (`SURE`), or where a product would leave the range of float64.
//! 3. Divide, in twice the digits: `t = n.R / n.d`.
//! 4. Take the weights from `t d - R`, rounded to float64 (`weights.rs`).
//!
//! # Error bounds
//!
//! A dot product is off by less than 2^-98 of the product of the lengths. Where it is more than
//! 2^-41 of that, it is off by less than 2^-57 of itself, and `t` by less than an eighth of a unit
//! in float64's last place. [`Sight`] has the bound of one ray, which is mostly far smaller.

use super::weights::Edges;
use super::{Place, Vector, high, plain_dot, power, splat, splat_double};
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::double::{Double, DoubleVector, between, cross, dot, dot_plain, quotient};

/// A triangle's plane, in twice the digits.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Plane<N> {
    first: Vector<N>,
    edges: Edges<N>,
    normal: DoubleVector<N>,
    /// The edges' squares.
    squares: [N; 2],
}

impl<N: Copy> Plane<N> {
    #[inline(always)]
    #[doc(hidden)]
    pub fn new<A: Arithmetic<Number = N>>(a: A, corners: &[Vector<N>; 3]) -> Self {
        let [first, second, third] = corners;
        let (e, f) = (between(a, second, first), between(a, third, first));
        let normal = cross(a, &e, &f);
        let (edges, squares) = Edges::new(a, [high(&e), high(&f)], high(&normal));
        Self { first: *first, edges, normal, squares }
    }

    /// The plane as it is seen from an origin, and where that is enough.
    #[inline(always)]
    #[doc(hidden)]
    pub fn seen_from<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        origin: &Vector<N>,
    ) -> (A::Mask, Start<N>) {
        let start = between(a, &self.first, origin);
        let above = dot(a, &self.normal, &start);
        let reach = plain_dot(a, &high(&start), &high(&start));
        let [e, f] = self.squares;
        let bound = a.mul(a.mul(a.mul(e, f), a.number(SURE)), reach);
        let is_enough = a.lt(bound, a.mul(above.high, above.high))
            & in_range(a, e)
            & in_range(a, f)
            & in_range(a, reach);
        (is_enough, Start { start, above })
    }

    /// The place along a direction, and where that is enough.
    #[inline(always)]
    #[doc(hidden)]
    pub fn place<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        from: &Start<N>,
        d: &Vector<N>,
    ) -> (A::Mask, Place<N>) {
        let (is_enough, t) = self.t(a, from, d);
        let r = left_over(a, t, d, &from.start);
        let [v, w] = self.edges.weights(a, &r);
        (is_enough, [t.high, v, w])
    }

    #[inline(always)]
    fn t<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        from: &Start<N>,
        d: &Vector<N>,
    ) -> (A::Mask, Double<N>) {
        let slope = dot_plain(a, &self.normal, d);
        let t = quotient(a, from.above, slope);
        let length = plain_dot(a, d, d);
        let [e, f] = self.squares;
        let bound = a.mul(a.mul(a.mul(e, f), a.number(SURE)), length);
        let is_enough = a.lt(bound, a.mul(slope.high, slope.high)) & in_range(a, length);
        (is_enough, t)
    }
}

/// Where a ray comes to the points at a height above a plane, in units of its normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    /// The `t` at height 0.
    t: Double<f64>,
    /// `t` is off by less than this.
    off: f64,
    /// The change of `t` for a unit of height.
    per_height: f64,
}

impl Sight {
    /// The float64 nearest to the exact `t` at no height, if that is sure. Of two it is the even
    /// one.
    #[inline(always)]
    pub(super) fn nearest(&self) -> Option<f64> {
        let t = self.t.high;
        let beside = self.t.low.abs() + self.off;
        (t + beside == t && t - beside == t).then_some(t)
    }

    /// A float64 that the nearest `t` of no point between two heights is before.
    #[inline(always)]
    pub(crate) fn earliest(&self, [low, high]: [f64; 2]) -> f64 {
        let height = if self.per_height > 0.0 { low } else { high };
        let moved = height * self.per_height;
        // More than what `per_height`, the product and the sums are off by.
        let rounding = 4.0 * f64::EPSILON * (moved.abs() + self.t.low.abs());
        let slack = self.off + rounding + f64::MIN_POSITIVE;
        self.t.high + (self.t.low + moved - slack)
    }
}

/// The place of a plane relative to an origin.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Start<N> {
    /// The vector from the origin to corner 0.
    start: DoubleVector<N>,
    /// The origin's distance from the plane times the length of the normal: `n.R`.
    above: Double<N>,
}

impl Plane<f64> {
    /// Where a ray comes to the plane; `None` where twice the digits are not enough.
    #[inline(always)]
    pub(crate) fn sight(&self, origin: &Vector<f64>, d: &Vector<f64>) -> Option<Sight> {
        let start = between(Scalar, &self.first, origin);
        let above = dot(Scalar, &self.normal, &start);
        let slope = dot_plain(Scalar, &self.normal, d);
        let (from, along) = (high(&start), plain_dot(Scalar, d, d));
        let reach = plain_dot(Scalar, &from, &from);
        let [e, f] = self.squares;
        let are_in_range = [e, f, reach, along].map(|square| in_range(Scalar, square));
        let off = |square: f64| OFF * (e * f * square).sqrt();
        let per_height = 1.0 / slope.high;
        let of_slope = off(along) * per_height.abs();
        let is_sure = of_slope < power(-60);
        if are_in_range.contains(&false) || !is_sure {
            return None;
        }
        let t = quotient(Scalar, above, slope);
        let of_start = off(reach) * per_height.abs();
        // Twice the sum is more than what is left out: products of these, and roundings.
        let off = 2.0 * (of_start + (of_slope + power(-100)) * t.high.abs());
        Some(Sight { t, off, per_height })
    }

    /// The height of a point above the plane, in units of the normal, and more than it is off by.
    pub(crate) fn height(&self, point: &Vector<f64>) -> [f64; 2] {
        let from = between(Scalar, point, &self.first);
        let height = dot(Scalar, &self.normal, &from).high;
        let largest = high(&from).into_iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let [e, f] = self.squares;
        let off = 4.0 * OFF * (e * f).sqrt() * largest + f64::EPSILON * height.abs();
        [height, off + f64::MIN_POSITIVE]
    }

    /// The plane in all lanes.
    #[inline(always)]
    #[doc(hidden)]
    pub fn splat<A: Arithmetic>(&self, a: A) -> Plane<A::Number> {
        Plane {
            first: splat(a, &self.first),
            edges: self.edges.splat(a),
            normal: splat_double(a, &self.normal),
            squares: [a.number(self.squares[0]), a.number(self.squares[1])],
        }
    }
}

impl Start<f64> {
    /// The place in all lanes.
    #[inline(always)]
    pub fn splat<A: Arithmetic>(&self, a: A) -> Start<A::Number> {
        Start {
            start: splat_double(a, &self.start),
            above: Double { high: a.number(self.above.high), low: a.number(self.above.low) },
        }
    }
}

/// The error of a dot product at most, as a share of the product of the lengths; see the error
/// bounds above.
const OFF: f64 = power(-98);

/// The square of what a dot product must be at least, as a share of the product of the lengths; see
/// the error bounds above.
const SURE: f64 = power(-82);

/// The lanes in which products of vectors with this square stay in the range of float64.
#[inline(always)]
fn in_range<A: Arithmetic>(a: A, squared: A::Number) -> A::Mask {
    a.lt(a.number(1e-40), squared) & a.lt(squared, a.number(1e40))
}

/// `t d - start`.
#[inline(always)]
pub(super) fn left_over<A: Arithmetic>(
    a: A,
    t: Double<A::Number>,
    d: &Vector<A::Number>,
    start: &DoubleVector<A::Number>,
) -> Vector<A::Number> {
    macro_rules! along {
        ($k:literal) => {
            a.add(
                a.fused_mul_sub(t.high, d[$k], start[$k].high),
                a.fused_mul_sub(t.low, d[$k], start[$k].low),
            )
        };
    }
    [along!(0), along!(1), along!(2)]
}
