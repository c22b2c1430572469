//! The lanes in WebAssembly's `simd128`: four registers each.
//!
//! It has no fused multiply-add. Of float32 none is asked for; that of float64 is emulated, to the
//! bit (`geometry/fused.rs`).

use std::arch::wasm32::*;
use std::array::from_fn;
use std::ops::{BitAnd, BitOr, Not};

use bytemuck::Pod;

use super::lanes::inlined;
use super::portable::compress;
use super::{Kernel, LANES, Lanes, WIDE};
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::fused::{self, RoundToOdd};

/// The instructions of a module that is compiled for them: a machine without them refuses the
/// module.
#[derive(Debug, Clone, Copy)]
pub(super) struct Simd128;

/// Runs a kernel. Not inlined, so that [`Lanes::call`] shares it.
#[inline(never)]
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Simd128)
}

type F = [v128; 4];
type D = [v128; 4];

/// An intrinsic for all registers of its arguments.
macro_rules! four {
    ($intrinsic:path, $($argument:expr),+) => {
        from_fn(|k| $intrinsic($($argument[k]),+))
    };
}

/// Sixteen bytes of memory.
macro_rules! load {
    ($from:expr) => {{
        let from: &[_] = $from;
        assert!(size_of_val(from) == 16);
        // SAFETY: a reference to sixteen bytes, which may have any alignment.
        unsafe { v128_load(from.as_ptr().cast()) }
    }};
}

/// The other way.
macro_rules! store {
    ($to:expr, $x:expr) => {{
        let to: &mut [_] = $to;
        assert!(size_of_val(to) == 16);
        // SAFETY: a reference to sixteen bytes, which may have any alignment and hold any bits.
        unsafe { v128_store(to.as_mut_ptr().cast(), $x) }
    }};
}

/// A bit of each lane, of lanes that are all ones or all zeros.
#[inline(always)]
fn mask(x: [v128; 4]) -> u16 {
    let low = i16x8_narrow_i32x4(x[0], x[1]);
    let high = i16x8_narrow_i32x4(x[2], x[3]);
    i8x16_bitmask(i8x16_narrow_i16x8(low, high))
}

#[inline(always)]
fn mask64(x: D) -> u8 {
    let low = i32x4_shuffle::<0, 2, 4, 6>(x[0], x[1]);
    let high = i32x4_shuffle::<0, 2, 4, 6>(x[2], x[3]);
    i16x8_bitmask(i16x8_narrow_i32x4(low, high))
}

/// The other way.
#[inline(always)]
fn lanes_of(mask: u16) -> [v128; 4] {
    let mask = u32x4_splat(u32::from(mask));
    let first = u32x4(1, 2, 4, 8);
    [first, u32x4_shl(first, 4), u32x4_shl(first, 8), u32x4_shl(first, 12)]
        .map(|bits| i32x4_eq(v128_and(mask, bits), bits))
}

#[inline(always)]
fn lanes_of64(mask: u8) -> D {
    let mask = u64x2_splat(u64::from(mask));
    let first = u64x2(1, 2);
    [first, u64x2_shl(first, 2), u64x2_shl(first, 4), u64x2_shl(first, 6)]
        .map(|bits| i64x2_eq(v128_and(mask, bits), bits))
}

/// The lanes of `x` that the bytes of `places` are in, as bytes of all sixteen lanes.
#[inline(always)]
fn swizzle(table: F, places: v128) -> v128 {
    // Of an index beyond a register's bytes there comes zero.
    let from = |k: usize, first: u8| u8x16_swizzle(table[k], u8x16_sub(places, u8x16_splat(first)));
    v128_or(v128_or(from(0, 0), from(1, 16)), v128_or(from(2, 32), from(3, 48)))
}

/// The smallest of each of four rows' lanes, none of which is negative.
#[inline(always)]
fn smallest_of_four(rows: [v128; 4]) -> v128 {
    let [a, b, c, d] = rows;
    let two =
        |a, b| i32x4_min(i32x4_shuffle::<0, 1, 4, 5>(a, b), i32x4_shuffle::<2, 3, 6, 7>(a, b));
    let (ab, cd) = (two(a, b), two(c, d));
    i32x4_min(i32x4_shuffle::<0, 2, 4, 6>(ab, cd), i32x4_shuffle::<1, 3, 5, 7>(ab, cd))
}

/// A row's bits with the last four replaced by 15 less the lane, the smallest of every fourth.
#[inline(always)]
fn keys(row: &[f32; LANES]) -> v128 {
    let key = |k: usize, behind| {
        let x = load!(&row[4 * k..4 * k + 4]);
        v128_or(v128_andnot(x, u32x4_splat(15)), behind)
    };
    i32x4_min(
        i32x4_min(key(0, u32x4(15, 14, 13, 12)), key(1, u32x4(11, 10, 9, 8))),
        i32x4_min(key(2, u32x4(7, 6, 5, 4)), key(3, u32x4(3, 2, 1, 0))),
    )
}

/// Two float64, for the emulation.
#[derive(Debug, Clone, Copy)]
struct Two;

/// The mask of a condition: lanes of ones, and of zeros.
#[derive(Debug, Clone, Copy)]
struct Where(v128);

impl BitAnd for Where {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(v128_and(self.0, other.0))
    }
}

impl BitOr for Where {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(v128_or(self.0, other.0))
    }
}

impl Not for Where {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(v128_not(self.0))
    }
}

impl Arithmetic for Two {
    type Number = v128;
    type Mask = Where;

    inlined! {
        fn number(self, x: f64) -> v128 = f64x2_splat(x);
        fn add(self, a: v128, b: v128) -> v128 = f64x2_add(a, b);
        fn sub(self, a: v128, b: v128) -> v128 = f64x2_sub(a, b);
        fn mul(self, a: v128, b: v128) -> v128 = f64x2_mul(a, b);
        fn div(self, a: v128, b: v128) -> v128 = f64x2_div(a, b);
        fn sqrt(self, a: v128) -> v128 = f64x2_sqrt(a);
        fn max(self, a: v128, b: v128) -> v128 = f64x2_pmax(b, a);
        fn lt(self, a: v128, b: v128) -> Where = Where(f64x2_lt(a, b));
        fn le(self, a: v128, b: v128) -> Where = Where(f64x2_le(a, b));
        fn select(self, mask: Where, a: v128, b: v128) -> v128 = v128_bitselect(a, b, mask.0);
        fn is_everywhere(self, mask: Where) -> bool = i64x2_all_true(mask.0);
        fn is_anywhere(self, mask: Where) -> bool = v128_any_true(mask.0);
    }

    #[inline(always)]
    fn fused_mul_add(self, a: v128, b: v128, c: v128) -> v128 {
        fused::emulated(self, a, b, c).unwrap_or_else(|| one_by_one(a, b, c))
    }
    #[inline(always)]
    fn fused_mul_sub(self, a: v128, b: v128, c: v128) -> v128 {
        self.fused_mul_add(a, b, f64x2_neg(c))
    }
    #[inline(always)]
    fn fused_neg_mul_add(self, a: v128, b: v128, c: v128) -> v128 {
        self.fused_mul_add(f64x2_neg(a), b, c)
    }
}

impl RoundToOdd for Two {
    #[inline(always)]
    fn abs(self, x: v128) -> v128 {
        f64x2_abs(x)
    }
    #[inline(always)]
    fn to_odd(self, rounded: v128, rest: v128) -> v128 {
        // One up where both have one sign, else one down.
        let step = v128_or(i64x2_shr(v128_xor(rounded, rest), 63), i64x2_splat(1));
        let is_inexact = f64x2_ne(rest, f64x2_splat(0.0));
        // All ones where the last bit is not set.
        let is_even = i64x2_sub(v128_and(rounded, i64x2_splat(1)), i64x2_splat(1));
        i64x2_add(rounded, v128_and(step, v128_and(is_inexact, is_even)))
    }
}

/// The fused result for numbers outside of the emulation's range.
#[cold]
#[inline(never)]
fn one_by_one(a: v128, b: v128, c: v128) -> v128 {
    let fused = |a: f64, b: f64, c: f64| fused::mul_add(a, b, c);
    f64x2(
        fused(f64x2_extract_lane::<0>(a), f64x2_extract_lane::<0>(b), f64x2_extract_lane::<0>(c)),
        fused(f64x2_extract_lane::<1>(a), f64x2_extract_lane::<1>(b), f64x2_extract_lane::<1>(c)),
    )
}

/// See [`Lanes::fused_mul_add64`]. Not inlined: it is some two hundred instructions, and kernels
/// have many of it.
#[inline(never)]
fn fused_mul_add64(a: D, b: D, c: D) -> D {
    from_fn(|k| Two.fused_mul_add(a[k], b[k], c[k]))
}

impl Lanes for Simd128 {
    type Floats = F;
    type Doubles = D;

    inlined! {
        fn splat(self, x: f32) -> F = [f32x4_splat(x); 4];
        fn load(self, from: &[f32; LANES]) -> F = from_fn(|k| load!(&from[4 * k..4 * k + 4]));
        fn add(self, a: F, b: F) -> F = four!(f32x4_add, a, b);
        fn sub(self, a: F, b: F) -> F = four!(f32x4_sub, a, b);
        fn mul(self, a: F, b: F) -> F = four!(f32x4_mul, a, b);
        fn div(self, a: F, b: F) -> F = four!(f32x4_div, a, b);
        // Theirs give the first argument where either is NaN or both are the same, so the arguments
        // change places.
        fn min(self, a: F, b: F) -> F = four!(f32x4_pmin, b, a);
        fn max(self, a: F, b: F) -> F = four!(f32x4_pmax, b, a);
        fn abs(self, a: F) -> F = four!(f32x4_abs, a);
        fn floor(self, a: F) -> F = four!(f32x4_floor, a);
        fn ceil(self, a: F) -> F = four!(f32x4_ceil, a);
        fn mul_add(self, a: F, b: F, c: F) -> F = self.add(self.mul(a, b), c);
        fn neg_mul_add(self, a: F, b: F, c: F) -> F = self.sub(c, self.mul(a, b));
        fn mul_sub(self, a: F, b: F, c: F) -> F = self.sub(self.mul(a, b), c);
        fn lt(self, a: F, b: F) -> u16 = mask(four!(f32x4_lt, a, b));
        fn le(self, a: F, b: F) -> u16 = mask(four!(f32x4_le, a, b));
        fn same(self, a: F, b: F) -> u16 = mask(four!(i32x4_eq, a, b));
        fn splat64(self, x: f64) -> D = [f64x2_splat(x); 4];
        fn load64(self, from: &[f64; WIDE]) -> D = from_fn(|k| load!(&from[2 * k..2 * k + 2]));
        fn add64(self, a: D, b: D) -> D = four!(f64x2_add, a, b);
        fn sub64(self, a: D, b: D) -> D = four!(f64x2_sub, a, b);
        fn mul64(self, a: D, b: D) -> D = four!(f64x2_mul, a, b);
        fn div64(self, a: D, b: D) -> D = four!(f64x2_div, a, b);
        fn sqrt64(self, a: D) -> D = four!(f64x2_sqrt, a);
        fn abs64(self, a: D) -> D = four!(f64x2_abs, a);
        fn max64(self, a: D, b: D) -> D = four!(f64x2_pmax, b, a);
        fn fused_mul_add64(self, a: D, b: D, c: D) -> D = fused_mul_add64(a, b, c);
        fn lt64(self, a: D, b: D) -> u8 = mask64(four!(f64x2_lt, a, b));
        fn le64(self, a: D, b: D) -> u8 = mask64(four!(f64x2_le, a, b));
    }

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        run(kernel)
    }
    #[inline(always)]
    fn store(self, x: F, to: &mut [f32; LANES]) {
        for k in 0..4 {
            store!(&mut to[4 * k..4 * k + 4], x[k]);
        }
    }
    #[inline(always)]
    fn permute_by(self, table: F, places: F) -> F {
        from_fn(|k| {
            // The four bytes of a lane.
            let lane = v128_and(places[k], u32x4_splat(15));
            let bytes =
                u32x4_add(u32x4_mul(lane, u32x4_splat(0x0404_0404)), u32x4_splat(0x0302_0100));
            swizzle(table, bytes)
        })
    }
    #[inline(always)]
    fn load_places(self, from: &[u8; LANES]) -> F {
        let bytes = load!(from);
        let (low, high) = (u16x8_extend_low_u8x16(bytes), u16x8_extend_high_u8x16(bytes));
        [
            u32x4_extend_low_u16x8(low),
            u32x4_extend_high_u16x8(low),
            u32x4_extend_low_u16x8(high),
            u32x4_extend_high_u16x8(high),
        ]
    }
    #[inline(always)]
    fn same_sixteen(self, a: F, b: F) -> u16 {
        let bits = [u32x4_splat(!15); 4];
        self.same(four!(v128_and, a, bits), four!(v128_and, b, bits))
    }
    #[inline(always)]
    fn select(self, mask: u16, a: F, b: F) -> F {
        let lanes = lanes_of(mask);
        four!(v128_bitselect, a, b, lanes)
    }
    #[inline(always)]
    fn largest(self, a: F) -> f32 {
        let four = f32x4_pmax(f32x4_pmax(a[0], a[1]), f32x4_pmax(a[2], a[3]));
        let two = f32x4_pmax(four, i64x2_shuffle::<1, 1>(four, four));
        f32x4_extract_lane::<0>(two).max(f32x4_extract_lane::<1>(two))
    }
    #[inline(always)]
    fn smallest(self, a: F) -> f32 {
        let four = f32x4_pmin(f32x4_pmin(a[0], a[1]), f32x4_pmin(a[2], a[3]));
        let two = f32x4_pmin(four, i64x2_shuffle::<1, 1>(four, four));
        f32x4_extract_lane::<0>(two).min(f32x4_extract_lane::<1>(two))
    }
    #[inline(always)]
    fn smallest_of_each(self, of: [&[f32; LANES]; LANES]) -> F {
        from_fn(|k| {
            smallest_of_four([
                keys(of[4 * k]),
                keys(of[4 * k + 1]),
                keys(of[4 * k + 2]),
                keys(of[4 * k + 3]),
            ])
        })
    }
    #[inline(always)]
    fn compress(self, mask: u16, a: F, to: &mut [f32; LANES]) {
        let mut from = [0.0; LANES];
        self.store(a, &mut from);
        compress(mask, &from, to);
    }
    #[inline(always)]
    fn load_widened(self, from: &[f32; WIDE]) -> D {
        let (low, high) = (load!(&from[..4]), load!(&from[4..]));
        [
            f64x2_promote_low_f32x4(low),
            f64x2_promote_low_f32x4(i64x2_shuffle::<1, 1>(low, low)),
            f64x2_promote_low_f32x4(high),
            f64x2_promote_low_f32x4(i64x2_shuffle::<1, 1>(high, high)),
        ]
    }
    #[inline(always)]
    fn store_narrowed(self, x: D, to: &mut [f32; WIDE]) {
        let two =
            |a, b| i64x2_shuffle::<0, 2>(f32x4_demote_f64x2_zero(a), f32x4_demote_f64x2_zero(b));
        store!(&mut to[..4], two(x[0], x[1]));
        store!(&mut to[4..], two(x[2], x[3]));
    }
    #[inline(always)]
    fn store64(self, x: D, to: &mut [f64; WIDE]) {
        for k in 0..4 {
            store!(&mut to[2 * k..2 * k + 2], x[k]);
        }
    }
    #[inline(always)]
    fn fused_mul_sub64(self, a: D, b: D, c: D) -> D {
        fused_mul_add64(a, b, four!(f64x2_neg, c))
    }
    #[inline(always)]
    fn fused_neg_mul_add64(self, a: D, b: D, c: D) -> D {
        fused_mul_add64(four!(f64x2_neg, a), b, c)
    }
    #[inline(always)]
    fn select64(self, mask: u8, a: D, b: D) -> D {
        let lanes = lanes_of64(mask);
        four!(v128_bitselect, a, b, lanes)
    }
    #[inline(always)]
    fn interleave64(self, a: D, b: D) -> [D; 2] {
        let even = |k: usize| i64x2_shuffle::<0, 2>(a[k], b[k]);
        let odd = |k: usize| i64x2_shuffle::<1, 3>(a[k], b[k]);
        [[even(0), odd(0), even(1), odd(1)], [even(2), odd(2), even(3), odd(3)]]
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
    #[inline(always)]
    fn prefetch_either<T, U>(self, _: bool, _: u32, _: &[T], _: &[U]) {}
    #[inline(always)]
    fn stream<T: Pod>(self, from: &[T], to: &mut [T]) {
        to.copy_from_slice(from);
    }
    #[inline(always)]
    fn end_streams(self) {}
}
