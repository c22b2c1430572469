//! The lanes in NEON: four registers each.
//!
//! It is compiled where the target has NEON, as all usual targets of 64-bit ARM have, with fused
//! multiply-add. So code of this file has the features everywhere, and may have closures around
//! lanes.

use std::arch::aarch64::*;

use bytemuck::Pod;

use super::lanes::inlined;
use super::portable::compress;
use super::{Kernel, LANES, Lanes, WIDE, prefetch};
use crate::geometry::arrays::from_fn;

/// Proof that this code is compiled for a target with NEON.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neon(());

/// Always, but for Miri, which knows few of the instructions.
pub(super) fn is_available() -> bool {
    !cfg!(miri)
}

/// Runs a kernel; in plain Rust where that is not available. Not inlined, so that [`Lanes::call`]
/// shares it.
#[inline(never)]
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    if is_available() { kernel.run(Neon(())) } else { super::portable::run(kernel) }
}

/// Intrinsics of the instruction set.
macro_rules! neon {
    ($e:expr) => {
        // SAFETY: this file is compiled only for targets that have the instructions.
        unsafe { $e }
    };
}

/// An intrinsic for all registers of its arguments, however many those are.
macro_rules! each {
    ($intrinsic:path, $($argument:expr),+) => {
        from_fn(|k| neon!($intrinsic($($argument[k]),+)))
    };
}

type F = [float32x4_t; 4];
type D = [float64x2_t; 4];
/// The mask of a condition: lanes of ones, and of zeros.
type Where<const N: usize> = [uint32x4_t; N];
type Where64<const N: usize> = [uint64x2_t; N];

#[inline(always)]
fn load(from: &[f32; 4]) -> float32x4_t {
    // SAFETY: a reference to sixteen bytes, which may have any alignment; and as in `neon`.
    unsafe { vld1q_f32(from.as_ptr()) }
}

#[inline(always)]
fn store(x: float32x4_t, to: &mut [f32; 4]) {
    // SAFETY: as above, and this reference is the only one.
    unsafe { vst1q_f32(to.as_mut_ptr(), x) }
}

#[inline(always)]
fn load64(from: &[f64; 2]) -> float64x2_t {
    // SAFETY: as above.
    unsafe { vld1q_f64(from.as_ptr()) }
}

#[inline(always)]
fn store64(x: float64x2_t, to: &mut [f64; 2]) {
    // SAFETY: as above.
    unsafe { vst1q_f64(to.as_mut_ptr(), x) }
}

#[inline(always)]
fn integers(from: &[u32; 4]) -> uint32x4_t {
    // SAFETY: as above.
    unsafe { vld1q_u32(from.as_ptr()) }
}

#[inline(always)]
fn integers64(from: &[u64; 2]) -> uint64x2_t {
    // SAFETY: as above.
    unsafe { vld1q_u64(from.as_ptr()) }
}

#[inline(always)]
fn bits(x: float32x4_t) -> uint32x4_t {
    neon!(vreinterpretq_u32_f32(x))
}

#[inline(always)]
fn from_bits(x: uint32x4_t) -> float32x4_t {
    neon!(vreinterpretq_f32_u32(x))
}

// The instructions for minima and maxima give NaN where either is NaN, and order zeros by their
// signs.

#[inline(always)]
fn min(a: float32x4_t, b: float32x4_t) -> float32x4_t {
    neon!(vbslq_f32(vcltq_f32(a, b), a, b))
}

#[inline(always)]
fn max(a: float32x4_t, b: float32x4_t) -> float32x4_t {
    neon!(vbslq_f32(vcgtq_f32(a, b), a, b))
}

#[inline(always)]
fn max64(a: float64x2_t, b: float64x2_t) -> float64x2_t {
    neon!(vbslq_f64(vcgtq_f64(a, b), a, b))
}

/// The bits of a mask that belong to register `k`.
#[inline(always)]
fn mask_bits(k: usize) -> uint32x4_t {
    integers(&[1, 2, 4, 8].map(|bit: u32| bit << (4 * k)))
}

#[inline(always)]
fn mask_bits64(k: usize) -> uint64x2_t {
    integers64(&[1, 2].map(|bit: u64| bit << (2 * k)))
}

/// A bit of each lane.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "sixteen bits at most")]
fn mask<const N: usize>(x: Where<N>) -> u16 {
    let none = neon!(vdupq_n_u32(0));
    let with = |set, (k, x)| neon!(vorrq_u32(set, vandq_u32(x, mask_bits(k))));
    let set = x.into_iter().enumerate().fold(none, with);
    // No two lanes have a bit in common, so that their sum is all of them.
    neon!(vaddvq_u32(set)) as u16
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "eight bits at most")]
fn mask64<const N: usize>(x: Where64<N>) -> u8 {
    let none = neon!(vdupq_n_u64(0));
    let with = |set, (k, x)| neon!(vorrq_u64(set, vandq_u64(x, mask_bits64(k))));
    let set = x.into_iter().enumerate().fold(none, with);
    neon!(vaddvq_u64(set)) as u8
}

/// The other way.
#[inline(always)]
fn lanes_of<const N: usize>(mask: u16) -> Where<N> {
    from_fn(|k| neon!(vtstq_u32(vdupq_n_u32(u32::from(mask)), mask_bits(k))))
}

#[inline(always)]
fn lanes_of64<const N: usize>(mask: u8) -> Where64<N> {
    from_fn(|k| neon!(vtstq_u64(vdupq_n_u64(u64::from(mask)), mask_bits64(k))))
}

/// The places of the bytes of the lanes that the last four bits of each lane number.
#[inline(always)]
fn places_of_bytes(places: float32x4_t) -> uint8x16_t {
    neon!({
        let lane = vandq_u32(bits(places), vdupq_n_u32(15));
        let first = vmulq_u32(lane, vdupq_n_u32(0x0404_0404));
        vreinterpretq_u8_u32(vaddq_u32(first, vdupq_n_u32(0x0302_0100)))
    })
}

/// Four lanes of a row as keys: the last four bits of each replaced by those of `behind`.
#[inline(always)]
fn key(row: &[f32; 4], behind: &[u32; 4]) -> uint32x4_t {
    neon!({
        let above = vbicq_u32(bits(load(row)), vdupq_n_u32(15));
        vorrq_u32(above, integers(behind))
    })
}

/// The smallest key of every fourth lane of a row.
#[inline(always)]
fn keys(row: &[f32; LANES]) -> uint32x4_t {
    let [a, b, c, d]: &[[f32; 4]; 4] = bytemuck::cast_ref(row);
    neon!(vminq_u32(
        vminq_u32(key(a, &[15, 14, 13, 12]), key(b, &[11, 10, 9, 8])),
        vminq_u32(key(c, &[7, 6, 5, 4]), key(d, &[3, 2, 1, 0])),
    ))
}

/// The smallest lane of each of four.
#[inline(always)]
fn smallest_of_four([a, b, c, d]: [uint32x4_t; 4]) -> uint32x4_t {
    neon!(vpminq_u32(vpminq_u32(a, b), vpminq_u32(c, d)))
}

impl Lanes for Neon {
    type Floats = F;
    type Doubles = D;

    inlined! {
        fn splat(self, x: f32) -> F = [neon!(vdupq_n_f32(x)); 4];
        fn add(self, a: F, b: F) -> F = each!(vaddq_f32, a, b);
        fn sub(self, a: F, b: F) -> F = each!(vsubq_f32, a, b);
        fn mul(self, a: F, b: F) -> F = each!(vmulq_f32, a, b);
        fn div(self, a: F, b: F) -> F = each!(vdivq_f32, a, b);
        fn min(self, a: F, b: F) -> F = from_fn(|k| min(a[k], b[k]));
        fn max(self, a: F, b: F) -> F = from_fn(|k| max(a[k], b[k]));
        fn abs(self, a: F) -> F = each!(vabsq_f32, a);
        fn floor(self, a: F) -> F = each!(vrndmq_f32, a);
        fn ceil(self, a: F) -> F = each!(vrndpq_f32, a);
        // Their intrinsics add to the first argument, or subtract from it.
        fn mul_add(self, a: F, b: F, c: F) -> F = each!(vfmaq_f32, c, a, b);
        fn neg_mul_add(self, a: F, b: F, c: F) -> F = each!(vfmsq_f32, c, a, b);
        fn mul_sub(self, a: F, b: F, c: F) -> F = self.mul_add(a, b, each!(vnegq_f32, c));
        fn lt(self, a: F, b: F) -> u16 = mask::<4>(each!(vcltq_f32, a, b));
        fn le(self, a: F, b: F) -> u16 = mask::<4>(each!(vcleq_f32, a, b));
        fn splat64(self, x: f64) -> D = [neon!(vdupq_n_f64(x)); 4];
        fn add64(self, a: D, b: D) -> D = each!(vaddq_f64, a, b);
        fn sub64(self, a: D, b: D) -> D = each!(vsubq_f64, a, b);
        fn mul64(self, a: D, b: D) -> D = each!(vmulq_f64, a, b);
        fn div64(self, a: D, b: D) -> D = each!(vdivq_f64, a, b);
        fn sqrt64(self, a: D) -> D = each!(vsqrtq_f64, a);
        fn abs64(self, a: D) -> D = each!(vabsq_f64, a);
        fn max64(self, a: D, b: D) -> D = from_fn(|k| max64(a[k], b[k]));
        fn fused_mul_add64(self, a: D, b: D, c: D) -> D = each!(vfmaq_f64, c, a, b);
        fn fused_neg_mul_add64(self, a: D, b: D, c: D) -> D = each!(vfmsq_f64, c, a, b);
        fn lt64(self, a: D, b: D) -> u8 = mask64::<4>(each!(vcltq_f64, a, b));
        fn le64(self, a: D, b: D) -> u8 = mask64::<4>(each!(vcleq_f64, a, b));
    }

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        run(kernel)
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> F {
        let from: &[[f32; 4]; 4] = bytemuck::cast_ref(from);
        from_fn(|k| load(&from[k]))
    }
    #[inline(always)]
    fn store(self, x: F, to: &mut [f32; LANES]) {
        let to: &mut [[f32; 4]; 4] = bytemuck::cast_mut(to);
        for (x, to) in x.into_iter().zip(to) {
            store(x, to);
        }
    }
    #[inline(always)]
    fn permute_by(self, table: F, places: F) -> F {
        let [a, b, c, d] = each!(vreinterpretq_u8_f32, table);
        let table = uint8x16x4_t(a, b, c, d);
        from_fn(|k| {
            let bytes = neon!(vqtbl4q_u8(table, places_of_bytes(places[k])));
            neon!(vreinterpretq_f32_u8(bytes))
        })
    }
    #[inline(always)]
    fn load_places(self, from: &[u8; LANES]) -> F {
        // SAFETY: a reference to sixteen bytes; and as in `neon`.
        let places = unsafe { vld1q_u8(from.as_ptr()) };
        let [low, high] = neon!([vmovl_u8(vget_low_u8(places)), vmovl_high_u8(places)]);
        let four = neon!([
            vmovl_u16(vget_low_u16(low)),
            vmovl_high_u16(low),
            vmovl_u16(vget_low_u16(high)),
            vmovl_high_u16(high),
        ]);
        from_fn(|k| from_bits(four[k]))
    }
    #[inline(always)]
    fn same(self, a: F, b: F) -> u16 {
        mask::<4>(from_fn(|k| neon!(vceqq_u32(bits(a[k]), bits(b[k])))))
    }
    #[inline(always)]
    fn same_sixteen(self, a: F, b: F) -> u16 {
        // The difference is below the last four bits' end.
        mask::<4>(from_fn(|k| {
            let differs = neon!(veorq_u32(bits(a[k]), bits(b[k])));
            neon!(vcltq_u32(differs, vdupq_n_u32(16)))
        }))
    }
    #[inline(always)]
    fn select(self, mask: u16, a: F, b: F) -> F {
        let lanes = lanes_of::<4>(mask);
        each!(vbslq_f32, lanes, a, b)
    }
    #[inline(always)]
    fn largest(self, [a, b, c, d]: F) -> f32 {
        neon!(vmaxvq_f32(vmaxq_f32(vmaxq_f32(a, b), vmaxq_f32(c, d))))
    }
    #[inline(always)]
    fn smallest(self, [a, b, c, d]: F) -> f32 {
        neon!(vminvq_f32(vminq_f32(vminq_f32(a, b), vminq_f32(c, d))))
    }
    #[inline(always)]
    fn smallest_of_each(self, of: [&[f32; LANES]; LANES]) -> F {
        from_fn(|k| from_bits(smallest_of_four(from_fn(|row| keys(of[4 * k + row])))))
    }
    #[inline(always)]
    fn compress(self, mask: u16, a: F, to: &mut [f32; LANES]) {
        let mut from = [0.0; LANES];
        self.store(a, &mut from);
        compress(mask, &from, to);
    }
    #[inline(always)]
    fn load_widened(self, from: &[f32; WIDE]) -> D {
        let from: &[[f32; 4]; 2] = bytemuck::cast_ref(from);
        let [low, high] = from_fn(|k| load(&from[k]));
        neon!([
            vcvt_f64_f32(vget_low_f32(low)),
            vcvt_high_f64_f32(low),
            vcvt_f64_f32(vget_low_f32(high)),
            vcvt_high_f64_f32(high),
        ])
    }
    #[inline(always)]
    fn store_narrowed(self, [a, b, c, d]: D, to: &mut [f32; WIDE]) {
        let [low, high]: &mut [[f32; 4]; 2] = bytemuck::cast_mut(to);
        store(neon!(vcvt_high_f32_f64(vcvt_f32_f64(a), b)), low);
        store(neon!(vcvt_high_f32_f64(vcvt_f32_f64(c), d)), high);
    }
    #[inline(always)]
    fn load64(self, from: &[f64; WIDE]) -> D {
        let from: &[[f64; 2]; 4] = bytemuck::cast_ref(from);
        from_fn(|k| load64(&from[k]))
    }
    #[inline(always)]
    fn store64(self, x: D, to: &mut [f64; WIDE]) {
        let to: &mut [[f64; 2]; 4] = bytemuck::cast_mut(to);
        for (x, to) in x.into_iter().zip(to) {
            store64(x, to);
        }
    }
    #[inline(always)]
    fn fused_mul_sub64(self, a: D, b: D, c: D) -> D {
        self.fused_mul_add64(a, b, each!(vnegq_f64, c))
    }
    #[inline(always)]
    fn select64(self, mask: u8, a: D, b: D) -> D {
        let lanes = lanes_of64::<4>(mask);
        each!(vbslq_f64, lanes, a, b)
    }
    #[inline(always)]
    fn interleave64(self, a: D, b: D) -> [D; 2] {
        let two = |k: usize| neon!([vzip1q_f64(a[k], b[k]), vzip2q_f64(a[k], b[k])]);
        let four = |[a, b]: [float64x2_t; 2], [c, d]: [float64x2_t; 2]| [a, b, c, d];
        [four(two(0), two(1)), four(two(2), two(3))]
    }
    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        prefetch::prefetch(what);
    }
    #[inline(always)]
    fn prefetch_either<T, U>(self, is_other: bool, index: u32, whats: &[T], others: &[U]) {
        prefetch::prefetch_either(is_other, index, whats, others);
    }
    // No intrinsic writes past the caches.
    #[inline(always)]
    fn stream<T: Pod>(self, from: &[T], to: &mut [T]) {
        to.copy_from_slice(from);
    }
    #[inline(always)]
    fn end_streams(self) {}
}
