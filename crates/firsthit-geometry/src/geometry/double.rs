//! Twice the digits: a number as the sum of two float64.
//!
//! Sums and products of two float64 are exact that way: Knuth, "The Art of Computer Programming" 2,
//! 4.2.2, theorem C; Dekker, "A Floating-Point Technique for Extending the Available Precision",
//! Numerische Mathematik 18, 1971, with a fused multiply-add for the product.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use super::arithmetic::Arithmetic;

/// The sum of two numbers, the second of them hardly more than the rounding of the first.
#[derive(Debug, Clone, Copy, Default)]
#[doc(hidden)]
pub struct Double<N> {
    /// Nearly all of it.
    pub high: N,
    /// The rest.
    pub low: N,
}

/// A vector of them.
#[doc(hidden)]
pub type DoubleVector<N> = [Double<N>; 3];

/// `x + y`, exactly.
#[inline(always)]
#[doc(hidden)]
pub fn sum<A: Arithmetic>(a: A, x: A::Number, y: A::Number) -> Double<A::Number> {
    let high = a.add(x, y);
    let of_y = a.sub(high, x);
    let of_x = a.sub(high, of_y);
    let low = a.add(a.sub(x, of_x), a.sub(y, of_y));
    Double { high, low }
}

/// `x + y`, exactly where `y` is not larger (Dekker); else off by a rounding of `y`.
#[inline(always)]
#[doc(hidden)]
pub fn sum_of_smaller<A: Arithmetic>(a: A, x: A::Number, y: A::Number) -> Double<A::Number> {
    let high = a.add(x, y);
    let low = a.sub(y, a.sub(high, x));
    Double { high, low }
}

/// `x - y`, exactly.
#[inline(always)]
#[doc(hidden)]
pub fn difference<A: Arithmetic>(a: A, x: A::Number, y: A::Number) -> Double<A::Number> {
    let high = a.sub(x, y);
    let of_y = a.sub(x, high);
    let of_x = a.add(high, of_y);
    let low = a.add(a.sub(x, of_x), a.sub(of_y, y));
    Double { high, low }
}

/// `x * y`, exactly where no part of it is too small for float64.
#[inline(always)]
#[doc(hidden)]
pub fn product<A: Arithmetic>(a: A, x: A::Number, y: A::Number) -> Double<A::Number> {
    let high = a.mul(x, y);
    let low = a.fused_mul_sub(x, y, high);
    Double { high, low }
}

/// `p - q` for points, exactly.
#[inline(always)]
#[doc(hidden)]
pub fn between<A: Arithmetic>(
    a: A,
    p: &[A::Number; 3],
    q: &[A::Number; 3],
) -> DoubleVector<A::Number> {
    [difference(a, p[0], q[0]), difference(a, p[1], q[1]), difference(a, p[2], q[2])]
}

/// `x * y - z * w`, off by a few 2^-106 of the products.
#[inline(always)]
fn minor<A: Arithmetic>(
    a: A,
    [x, y]: [Double<A::Number>; 2],
    [z, w]: [Double<A::Number>; 2],
) -> Double<A::Number> {
    let (left, right) = (product(a, x.high, y.high), product(a, z.high, w.high));
    let Double { high, low } = difference(a, left.high, right.high);
    let of_lows = a.fused_mul_add(x.high, y.low, a.mul(x.low, y.high));
    let of_others = a.fused_mul_add(z.high, w.low, a.mul(z.low, w.high));
    let rest = a.add(a.sub(left.low, right.low), a.sub(of_lows, of_others));
    sum_of_smaller(a, high, a.add(low, rest))
}

/// The cross product, off by a few 2^-106 of the lengths' product.
#[inline(always)]
#[doc(hidden)]
pub fn cross<A: Arithmetic>(
    a: A,
    p: &DoubleVector<A::Number>,
    q: &DoubleVector<A::Number>,
) -> DoubleVector<A::Number> {
    [
        minor(a, [p[1], q[2]], [p[2], q[1]]),
        minor(a, [p[2], q[0]], [p[0], q[2]]),
        minor(a, [p[0], q[1]], [p[1], q[0]]),
    ]
}

/// The dot product of first parts with plain numbers: the sum, and what of it is lost.
#[inline(always)]
fn dot_of_highs<A: Arithmetic>(
    a: A,
    p: &DoubleVector<A::Number>,
    q: [A::Number; 3],
) -> (A::Number, A::Number) {
    let [x, y, z] =
        [product(a, p[0].high, q[0]), product(a, p[1].high, q[1]), product(a, p[2].high, q[2])];
    let two = sum(a, x.high, y.high);
    let Double { high, low } = sum(a, two.high, z.high);
    let rest = a.add(a.add(x.low, y.low), z.low);
    (high, a.add(rest, a.add(two.low, low)))
}

/// The dot product, off by a few 2^-106 of the lengths' product.
#[inline(always)]
#[doc(hidden)]
pub fn dot<A: Arithmetic>(
    a: A,
    p: &DoubleVector<A::Number>,
    q: &DoubleVector<A::Number>,
) -> Double<A::Number> {
    let (high, mut rest) = dot_of_highs(a, p, [q[0].high, q[1].high, q[2].high]);
    for k in 0..3 {
        let of_lows = a.fused_mul_add(p[k].high, q[k].low, a.mul(p[k].low, q[k].high));
        rest = a.add(rest, of_lows);
    }
    sum_of_smaller(a, high, rest)
}

/// The dot product with a vector of plain numbers.
#[inline(always)]
#[doc(hidden)]
pub fn dot_plain<A: Arithmetic>(
    a: A,
    p: &DoubleVector<A::Number>,
    q: &[A::Number; 3],
) -> Double<A::Number> {
    let (high, mut rest) = dot_of_highs(a, p, *q);
    for k in 0..3 {
        rest = a.fused_mul_add(p[k].low, q[k], rest);
    }
    sum_of_smaller(a, high, rest)
}

/// `x / y`, off by a few 2^-104 of itself.
#[inline(always)]
#[doc(hidden)]
pub fn quotient<A: Arithmetic>(
    a: A,
    x: Double<A::Number>,
    y: Double<A::Number>,
) -> Double<A::Number> {
    let inverse = a.div(a.number(1.0), y.high);
    let first = a.mul(x.high, inverse);
    // The remainder of x: it has few digits, so hardly any are lost.
    let left = a.fused_neg_mul_add(first, y.high, x.high);
    let left = a.add(left, a.fused_neg_mul_add(first, y.low, x.low));
    sum_of_smaller(a, first, a.mul(left, inverse))
}

#[cfg(test)]
mod tests {
    use super::super::arithmetic::Scalar;
    use super::*;

    #[test]
    fn what_float64_loses_is_kept() {
        let twice = |x: Double<f64>| (2.0 * x.high, 2.0 * x.low);
        assert_eq!(twice(difference(Scalar, 1.0, 1e-20)), (2.0, -2e-20));
        let [one, three] = [1.0, 3.0].map(|high| Double { high, low: 0.0 });
        let third = quotient(Scalar, one, three);
        assert_eq!(third.high, 1.0 / 3.0);
        assert!((third.low - (-third.high).mul_add(3.0, 1.0) / 3.0).abs() < 1e-31);
    }
}
