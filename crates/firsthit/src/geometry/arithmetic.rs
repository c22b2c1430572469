//! One way to write a computation for a single number and for lanes of them.
//!
//! What is computed for one ray and for eight at once must come to the same bits. Written once, it does.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use std::ops::{BitAnd, BitOr};

/// Float64 arithmetic on numbers of a kind: each operation rounds once, to nearest.
pub(crate) trait Arithmetic: Copy {
    /// One float64, or lanes of them.
    type Number: Copy;
    /// Where something is so.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

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
    /// The larger; `b` where they are equal or either is NaN.
    fn max(self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// `a * b + c`, rounded once.
    fn fused_mul_add(self, a: Self::Number, b: Self::Number, c: Self::Number) -> Self::Number;
    /// `a * b - c`, rounded once.
    fn fused_mul_sub(self, a: Self::Number, b: Self::Number, c: Self::Number) -> Self::Number;
    /// `c - a * b`, rounded once.
    fn fused_neg_mul_add(self, a: Self::Number, b: Self::Number, c: Self::Number) -> Self::Number;
    /// Where `a < b`; not where either is NaN.
    fn lt(self, a: Self::Number, b: Self::Number) -> Self::Mask;
    /// `a` in the mask, elsewhere `b`.
    fn select(self, mask: Self::Mask, a: Self::Number, b: Self::Number) -> Self::Number;
    /// Whether there is anything in the mask.
    fn is_anywhere(self, mask: Self::Mask) -> bool;
}

/// One number at a time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scalar;

impl Arithmetic for Scalar {
    type Number = f64;
    type Mask = bool;

    #[inline(always)]
    fn number(self, x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn add(self, a: f64, b: f64) -> f64 {
        a + b
    }
    #[inline(always)]
    fn sub(self, a: f64, b: f64) -> f64 {
        a - b
    }
    #[inline(always)]
    fn mul(self, a: f64, b: f64) -> f64 {
        a * b
    }
    #[inline(always)]
    fn div(self, a: f64, b: f64) -> f64 {
        a / b
    }
    #[inline(always)]
    fn max(self, a: f64, b: f64) -> f64 {
        if a > b { a } else { b }
    }
    #[inline(always)]
    fn fused_mul_add(self, a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
    #[inline(always)]
    fn fused_mul_sub(self, a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, -c)
    }
    #[inline(always)]
    fn fused_neg_mul_add(self, a: f64, b: f64, c: f64) -> f64 {
        (-a).mul_add(b, c)
    }
    #[inline(always)]
    fn lt(self, a: f64, b: f64) -> bool {
        a < b
    }
    #[inline(always)]
    fn select(self, mask: bool, a: f64, b: f64) -> f64 {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn is_anywhere(self, mask: bool) -> bool {
        mask
    }
}
