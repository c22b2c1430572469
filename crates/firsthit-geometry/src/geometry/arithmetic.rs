//! One way to write a computation for a single number and for lanes of them.
//!
//! The results for one ray and for eight at once must come to the same bits. Written once, it
//! does.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use std::ops::{BitAnd, BitOr, Not};

use super::fused::mul_add;

/// Float64 arithmetic on numbers of a kind: each operation rounds once, to nearest.
#[doc(hidden)]
pub trait Arithmetic: Copy {
    /// One float64, or lanes of them.
    type Number: Copy;
    /// The lanes in which a condition holds.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// `x`, in all lanes.
    fn number(self, x: f64) -> Self::Number;
    /// `a + b`.
    fn add(self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// `a - b`.
    fn sub(self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// `a * b`.
    fn mul(self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// `a / b`.
    fn div(self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// The square root; NaN of a negative number.
    fn sqrt(self, a: Self::Number) -> Self::Number;
    /// The larger; `b` where they are equal or either is NaN.
    fn max(self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// `a * b + c`, rounded once.
    fn fused_mul_add(self, a: Self::Number, b: Self::Number, c: Self::Number) -> Self::Number;
    /// `a * b - c`, rounded once.
    fn fused_mul_sub(self, a: Self::Number, b: Self::Number, c: Self::Number) -> Self::Number;
    /// `c - a * b`, rounded once.
    fn fused_neg_mul_add(self, a: Self::Number, b: Self::Number, c: Self::Number) -> Self::Number;
    /// The lanes with `a < b`; not those where either is NaN.
    fn lt(self, a: Self::Number, b: Self::Number) -> Self::Mask;
    /// The lanes with `a <= b`; not those where either is NaN.
    fn le(self, a: Self::Number, b: Self::Number) -> Self::Mask;
    /// `a` in the mask, elsewhere `b`.
    fn select(self, mask: Self::Mask, a: Self::Number, b: Self::Number) -> Self::Number;
    /// Whether all is in the mask.
    fn is_everywhere(self, mask: Self::Mask) -> bool;
    /// Whether there is anything in the mask.
    fn is_anywhere(self, mask: Self::Mask) -> bool;
}

/// `a / b` by the inverse of `b`, rounded as a division rounds it, which takes longer. (One
/// multiplication and two fused ones: Markstein, "Computation of elementary functions on the IBM
/// RISC System/6000 processor", IBM Journal of Research and Development 34(1), 1990; Brisebarre,
/// Muller and Raina, "Accelerating correctly rounded floating-point division when the divisor is
/// known in advance", IEEE Transactions on Computers 53(8), 2004.) But `+0 / -1` is `+0`, and where
/// `a` or the quotient is so small that what is left over has no digits, the last digit may be
/// another.
#[inline(always)]
#[doc(hidden)]
pub fn quotient_by_inverse<A: Arithmetic>(
    of: A,
    a: A::Number,
    b: A::Number,
    inverse: A::Number,
) -> A::Number {
    let first = of.mul(a, inverse);
    let beyond = of.fused_mul_sub(first, b, a);
    of.fused_neg_mul_add(beyond, inverse, first)
}

/// Pairs of numbers: while one waits for a result, the other is computed.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Pairs<A>(pub A);

/// The lanes in which a condition holds, of each of the two.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct PairOfMasks<M>(pub [M; 2]);

impl<M: Copy + BitAnd<Output = M>> BitAnd for PairOfMasks<M> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self([self.0[0] & other.0[0], self.0[1] & other.0[1]])
    }
}

impl<M: Copy + BitOr<Output = M>> BitOr for PairOfMasks<M> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self([self.0[0] | other.0[0], self.0[1] | other.0[1]])
    }
}

impl<M: Copy + Not<Output = M>> Not for PairOfMasks<M> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self([!self.0[0], !self.0[1]])
    }
}

/// Operations that are those of the two.
macro_rules! of_two {
    ($($name:ident($($from:ident),+);)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($from: Self::Number),+) -> Self::Number {
                [self.0.$name($($from[0]),+), self.0.$name($($from[1]),+)]
            }
        )*
    };
}

impl<A: Arithmetic> Arithmetic for Pairs<A> {
    type Number = [A::Number; 2];
    type Mask = PairOfMasks<A::Mask>;

    of_two! {
        add(a, b);
        sub(a, b);
        mul(a, b);
        div(a, b);
        sqrt(a);
        max(a, b);
        fused_mul_add(a, b, c);
        fused_mul_sub(a, b, c);
        fused_neg_mul_add(a, b, c);
    }

    #[inline(always)]
    fn number(self, x: f64) -> Self::Number {
        [self.0.number(x); 2]
    }
    #[inline(always)]
    fn lt(self, a: Self::Number, b: Self::Number) -> Self::Mask {
        PairOfMasks([self.0.lt(a[0], b[0]), self.0.lt(a[1], b[1])])
    }
    #[inline(always)]
    fn le(self, a: Self::Number, b: Self::Number) -> Self::Mask {
        PairOfMasks([self.0.le(a[0], b[0]), self.0.le(a[1], b[1])])
    }
    #[inline(always)]
    fn select(self, mask: Self::Mask, a: Self::Number, b: Self::Number) -> Self::Number {
        [self.0.select(mask.0[0], a[0], b[0]), self.0.select(mask.0[1], a[1], b[1])]
    }
    #[inline(always)]
    fn is_everywhere(self, mask: Self::Mask) -> bool {
        self.0.is_everywhere(mask.0[0]) && self.0.is_everywhere(mask.0[1])
    }
    #[inline(always)]
    fn is_anywhere(self, mask: Self::Mask) -> bool {
        self.0.is_anywhere(mask.0[0]) || self.0.is_anywhere(mask.0[1])
    }
}

/// Operations of one number.
macro_rules! of_one {
    ($($name:ident($($from:ident),+) => $result:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($from: f64),+) -> f64 {
                $result
            }
        )*
    };
}

/// One number at a time.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Scalar;

impl Arithmetic for Scalar {
    type Number = f64;
    type Mask = bool;

    of_one! {
        add(a, b) => a + b;
        sub(a, b) => a - b;
        mul(a, b) => a * b;
        div(a, b) => a / b;
        sqrt(a) => a.sqrt();
        max(a, b) => if a > b { a } else { b };
        fused_mul_add(a, b, c) => mul_add(a, b, c);
        fused_mul_sub(a, b, c) => mul_add(a, b, -c);
        fused_neg_mul_add(a, b, c) => mul_add(-a, b, c);
    }

    #[inline(always)]
    fn number(self, x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn lt(self, a: f64, b: f64) -> bool {
        a < b
    }
    #[inline(always)]
    fn le(self, a: f64, b: f64) -> bool {
        a <= b
    }
    #[inline(always)]
    fn select(self, mask: bool, a: f64, b: f64) -> f64 {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn is_everywhere(self, mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn is_anywhere(self, mask: bool) -> bool {
        mask
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quotient_by_the_inverse_is_rounded_as_that_of_a_division() {
        let digits = |k: u64| k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 12;
        let number = |exponent: u64, digits: u64| f64::from_bits(exponent << 52 | digits);
        let ones = (1 << 52) - 1;
        for k in 0..200_000 {
            // From 1 to 2, the hardest of them next to the ends, of any size, and a little below
            // the divisor.
            let near = digits(k) >> (k % 53);
            let any = number(1023 - 300 + k % 600, digits(!k));
            for b in [number(1023, near), number(1023, ones - near)] {
                for a in [any, number(1023, ones - near / 2), b - (k % 9) as f64 * f64::EPSILON] {
                    for (a, b) in [(a, b), (-a, b), (a, -2.0 * b), (b, b), (0.0, b), (-0.0, b)] {
                        let found = quotient_by_inverse(Scalar, a, b, 1.0 / b);
                        assert_eq!(found.to_bits(), (a / b).to_bits(), "{a:e} / {b:e}");
                    }
                }
            }
        }
    }
}
