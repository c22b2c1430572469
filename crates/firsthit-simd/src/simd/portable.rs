//! The lanes in plain Rust: what every other instruction set must do.

use bytemuck::Pod;

use super::lanes::inlined;
use super::{Kernel, LANES, Lanes, WIDE};
use crate::geometry::arrays::from_fn;

/// The instruction set of plain Rust: instructions that every machine has.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portable;

/// Runs a kernel. Not inlined: every instruction set falls back to it, and each copy would have to
/// be compiled.
#[inline(never)]
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Portable)
}

type F = [f32; LANES];
type D = [f64; WIDE];

#[inline(always)]
fn mask(is_set: impl Fn(usize) -> bool) -> u16 {
    (0..LANES).fold(0, |mask, k| mask | u16::from(is_set(k)) << k)
}

#[inline(always)]
fn mask64(is_set: impl Fn(usize) -> bool) -> u8 {
    (0..WIDE).fold(0, |mask, k| mask | u8::from(is_set(k)) << k)
}

/// See [`Lanes::compress`].
#[inline(always)]
pub(super) fn compress(mask: u16, from: &F, to: &mut F) {
    let mut left = mask;
    for to in to.iter_mut().take(mask.count_ones() as usize) {
        *to = from[left.trailing_zeros() as usize % LANES];
        left &= left - 1;
    }
}

impl Lanes for Portable {
    // Machines without lanes are rare, and packets in plain Rust were a quarter of all machine
    // code.
    const HAS_PACKETS: bool = false;
    type Floats = F;
    type Doubles = D;

    inlined! {
        fn load(self, from: &F) -> F = *from;
        fn add(self, a: F, b: F) -> F = from_fn(|k| a[k] + b[k]);
        fn sub(self, a: F, b: F) -> F = from_fn(|k| a[k] - b[k]);
        fn mul(self, a: F, b: F) -> F = from_fn(|k| a[k] * b[k]);
        fn div(self, a: F, b: F) -> F = from_fn(|k| a[k] / b[k]);
        fn min(self, a: F, b: F) -> F = from_fn(|k| if a[k] < b[k] { a[k] } else { b[k] });
        fn max(self, a: F, b: F) -> F = from_fn(|k| if a[k] > b[k] { a[k] } else { b[k] });
        fn abs(self, a: F) -> F = from_fn(|k| a[k].abs());
        fn floor(self, a: F) -> F = from_fn(|k| a[k].floor());
        fn ceil(self, a: F) -> F = from_fn(|k| a[k].ceil());
        fn mul_add(self, a: F, b: F, c: F) -> F = from_fn(|k| a[k] * b[k] + c[k]);
        fn neg_mul_add(self, a: F, b: F, c: F) -> F = from_fn(|k| c[k] - a[k] * b[k]);
        fn mul_sub(self, a: F, b: F, c: F) -> F = from_fn(|k| a[k] * b[k] - c[k]);
        fn lt(self, a: F, b: F) -> u16 = mask(|k| a[k] < b[k]);
        fn le(self, a: F, b: F) -> u16 = mask(|k| a[k] <= b[k]);
        fn same(self, a: F, b: F) -> u16 = mask(|k| a[k].to_bits() == b[k].to_bits());
        fn largest(self, a: F) -> f32 = a.into_iter().fold(f32::NEG_INFINITY, f32::max);
        fn smallest(self, a: F) -> f32 = a.into_iter().fold(f32::INFINITY, f32::min);
        fn load_widened(self, from: &[f32; WIDE]) -> D = from_fn(|k| f64::from(from[k]));
        fn load64(self, from: &D) -> D = *from;
        fn add64(self, a: D, b: D) -> D = from_fn(|k| a[k] + b[k]);
        fn sub64(self, a: D, b: D) -> D = from_fn(|k| a[k] - b[k]);
        fn mul64(self, a: D, b: D) -> D = from_fn(|k| a[k] * b[k]);
        fn div64(self, a: D, b: D) -> D = from_fn(|k| a[k] / b[k]);
        fn sqrt64(self, a: D) -> D = from_fn(|k| a[k].sqrt());
        fn abs64(self, a: D) -> D = from_fn(|k| a[k].abs());
        fn max64(self, a: D, b: D) -> D = from_fn(|k| if a[k] > b[k] { a[k] } else { b[k] });
        fn fused_mul_sub64(self, a: D, b: D, c: D) -> D = from_fn(|k| a[k].mul_add(b[k], -c[k]));
        fn fused_mul_add64(self, a: D, b: D, c: D) -> D = from_fn(|k| a[k].mul_add(b[k], c[k]));
        fn lt64(self, a: D, b: D) -> u8 = mask64(|k| a[k] < b[k]);
        fn le64(self, a: D, b: D) -> u8 = mask64(|k| a[k] <= b[k]);
    }

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        run(kernel)
    }
    #[inline(always)]
    fn splat(self, x: f32) -> F {
        [x; LANES]
    }
    #[inline(always)]
    fn store(self, x: F, to: &mut F) {
        *to = x;
    }
    #[inline(always)]
    fn permute_by(self, table: F, places: F) -> F {
        from_fn(|k| table[places[k].to_bits() as usize % LANES])
    }
    #[inline(always)]
    fn load_places(self, from: &[u8; LANES]) -> F {
        from_fn(|k| f32::from_bits(u32::from(from[k])))
    }
    #[inline(always)]
    fn same_sixteen(self, a: F, b: F) -> u16 {
        mask(|k| a[k].to_bits() & !15 == b[k].to_bits() & !15)
    }
    #[inline(always)]
    fn select(self, mask: u16, a: F, b: F) -> F {
        from_fn(|k| if mask >> k & 1 == 1 { a[k] } else { b[k] })
    }
    #[inline(always)]
    fn smallest_of_each(self, of: [&F; LANES]) -> F {
        let key = |(behind, x): (u32, f32)| x.to_bits() & !15 | behind;
        from_fn(|k| {
            let keys = (0..16).rev().zip(*of[k]).map(key);
            f32::from_bits(keys.fold(u32::MAX, u32::min))
        })
    }
    #[inline(always)]
    fn compress(self, mask: u16, a: F, to: &mut F) {
        compress(mask, &a, to);
    }
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding is what this is for")]
    fn store_narrowed(self, x: D, to: &mut [f32; WIDE]) {
        *to = from_fn(|k| x[k] as f32);
    }
    #[inline(always)]
    fn splat64(self, x: f64) -> D {
        [x; WIDE]
    }
    #[inline(always)]
    fn store64(self, x: D, to: &mut D) {
        *to = x;
    }
    #[inline(always)]
    fn fused_neg_mul_add64(self, a: D, b: D, c: D) -> D {
        from_fn(|k| (-a[k]).mul_add(b[k], c[k]))
    }
    #[inline(always)]
    fn select64(self, mask: u8, a: D, b: D) -> D {
        from_fn(|k| if mask >> k & 1 == 1 { a[k] } else { b[k] })
    }
    #[inline(always)]
    fn interleave64(self, a: D, b: D) -> [D; 2] {
        let lane = |k: usize| [a, b][k % 2][k / 2];
        [from_fn(lane), from_fn(|k| lane(k + WIDE))]
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
