//! A crossing in plain float64, with one correction.
//!
//! 1. Guess `t = n.R / n.d`. That loses digits where the ray grazes the plane, and where the
//!    triangle is far from the origin compared with its size.
//! 2. Compute `r = t d - R`, which leads from corner 0 to the point at `t`. The point is in the
//!    triangle, so `r` is no longer than the triangle's longer edge, however far away the origin
//!    is: its error is small.
//! 3. In the plane `n.r` would be zero. Subtract `n.r / n.d` from `t`, and correct `r` likewise.
//! 4. Take the weights from `r` (`weights.rs`).
//!
//! This is one step of iterative refinement: Wilkinson, "Rounding Errors in Algebraic Processes",
//! Her Majesty's Stationery Office 1963. It departs in that `r` is computed with the digits of
//! everything else: it needs no more, since it is short.
//!
//! # Error bounds
//!
//! To the first order in u = 2^-53. `h` is the longer of |E| and |F|. `R` is exact, as a sum of two
//! numbers, and `r` is off by 2 u |r| for the `t` that was computed. So `n.r` is off by at most the
//! sum of these:
//!
//! - 2 u |n| h: `r`;
//! - 3 u |n| h: the rounding of the dot product;
//! - u |n| h: the last rounding of `n`;
//! - u |E| |F| h: the rounding of the products in `n`;
//! - u |n| h: the rounding of `E` and `F`. As `r = v E + w F`, an error `e` of `E` comes to
//!   `e.(F x r) = -v e.n`.
//!
//! It follows that:
//!
//! - The sum is at most u h (7 |n| + h^2). Where it is less than u |n.R|, `t` is off by less than
//!   u |t| before its last rounding.
//! - Both sides are compared as squares: that of the sum is below u^2 h^2 (56 |n|^2 + 8 h^4).
//!   `Plain::error` takes an eighth more, 63 and 9, for all that is not of the first order.
//! - The divisor `n.d` is off by a share of u |R| / h at most, and the correction is a share of 2
//!   u |R| / h of `t`. With |R| up to 2^23 h (`is_near`) their product is 2^-6 u.

use super::weights::Edges;
use super::{Place, Vector, high, minus, plain_cross, plain_dot, power, splat, splat_double};
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::double::{DoubleVector, between};

/// A triangle in plain float64.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Plain<N> {
    first: Vector<N>,
    edges: Edges<N>,
    /// The normal's square.
    squared: N,
    /// The longer edge's square.
    size: N,
    /// The square of what `n.R` must be more than; see the error bounds above.
    error: N,
}

impl<N: Copy> Plain<N> {
    #[inline(always)]
    pub(crate) fn new<A: Arithmetic<Number = N>>(a: A, corners: &[Vector<N>; 3]) -> Self {
        let [first, second, third] = corners;
        let (e, f) = (minus(a, second, first), minus(a, third, first));
        let normal = plain_cross(a, &e, &f);
        let squared = plain_dot(a, &normal, &normal);
        let of_first = plain_dot(a, &e, &e);
        let size = a.max(of_first, plain_dot(a, &f, &f));
        let of_size = a.mul(a.mul(a.number(9.0), size), size);
        let error = a.mul(size, a.fused_mul_add(a.number(63.0), squared, of_size));
        // Both inverses by one division.
        let inverse = a.div(a.number(1.0), a.mul(squared, of_first));
        let edges = Edges {
            vectors: [e, f],
            normal,
            of_normal: a.mul(inverse, of_first),
            of_first: a.mul(inverse, squared),
        };
        Self { first: *first, edges, squared, size, error }
    }

    /// The triangle as it is seen from an origin, and where float64 is enough.
    #[inline(always)]
    pub fn seen_from<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        origin: &Vector<N>,
    ) -> (A::Mask, PlainStart<N>) {
        let start = between(a, &self.first, origin);
        let high = high(&start);
        let above = plain_dot(a, &self.edges.normal, &high);
        let is_enough = a.lt(self.error, a.mul(above, above));
        let far = plain_dot(a, &high, &high);
        let is_near = a.lt(far, a.mul(a.number(power(46)), self.size));
        // Nothing overflows, and nothing that counts is too small for float64.
        let in_range = a.lt(a.number(1e-120), self.squared) & a.lt(self.size, a.number(1e60));
        (is_enough & is_near & in_range, PlainStart { start, above })
    }

    /// The place along a direction.
    #[inline(always)]
    pub fn place<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        from: &PlainStart<N>,
        d: &Vector<N>,
    ) -> Place<N> {
        let PlainStart { start, above } = from;
        let inverse = a.div(a.number(1.0), plain_dot(a, &self.edges.normal, d));
        let guess = a.mul(*above, inverse);
        macro_rules! vector {
            ($k:ident => $value:expr) => {
                [
                    {
                        let $k = 0;
                        $value
                    },
                    {
                        let $k = 1;
                        $value
                    },
                    {
                        let $k = 2;
                        $value
                    },
                ]
            };
        }
        let r = vector!(k => a.sub(a.fused_mul_sub(guess, d[k], start[k].high), start[k].low));
        let correction = a.mul(plain_dot(a, &self.edges.normal, &r), inverse);
        let t = a.sub(guess, correction);
        let r = vector!(k => a.fused_neg_mul_add(correction, d[k], r[k]));
        let [v, w] = self.edges.weights(a, &r);
        [t, v, w]
    }
}

/// The place of a triangle relative to an origin.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct PlainStart<N> {
    /// The vector from the origin to corner 0.
    start: DoubleVector<N>,
    /// The origin's distance from the plane times the length of the normal: `n.R`.
    above: N,
}

impl Plain<f64> {
    /// The triangle in all lanes.
    #[inline(always)]
    pub fn splat<A: Arithmetic>(&self, a: A) -> Plain<A::Number> {
        Plain {
            first: splat(a, &self.first),
            edges: self.edges.splat(a),
            squared: a.number(self.squared),
            size: a.number(self.size),
            error: a.number(self.error),
        }
    }
}

impl PlainStart<f64> {
    /// The place in all lanes.
    #[inline(always)]
    pub fn splat<A: Arithmetic>(&self, a: A) -> PlainStart<A::Number> {
        PlainStart { start: splat_double(a, &self.start), above: a.number(self.above) }
    }
}
