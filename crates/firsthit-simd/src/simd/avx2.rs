//! The lanes in AVX2 with fused multiply-add: two registers each.

use std::arch::asm;
use std::arch::x86_64::*;

use bytemuck::Pod;

use super::lanes::inlined;
use super::{Kernel, LANES, Lanes, WIDE, x86};

/// Proof that this machine has AVX2 and fused multiply-add.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx2(());

pub(super) fn is_available() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

/// Runs a kernel that is compiled for the features. Not inlined, so that [`Lanes::call`] shares it.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
fn with_features<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Avx2(()))
}

/// Runs a kernel; in plain Rust where AVX2 is missing.
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    if is_available() {
        // SAFETY: the line above asked for the features.
        unsafe { with_features(kernel) }
    } else {
        super::portable::run(kernel)
    }
}

/// An intrinsic of the instruction set.
macro_rules! x86 {
    ($e:expr) => {
        // SAFETY: an `Avx2` is made only where the machine has the features.
        unsafe { $e }
    };
}

/// An intrinsic for both registers of its arguments.
macro_rules! both {
    ($intrinsic:path, $($argument:expr),+) => {
        x86!([$intrinsic($($argument[0]),+), $intrinsic($($argument[1]),+)])
    };
}

// After the macros, which it uses.
mod reduce;

type F = [__m256; 2];
type D = [__m256d; 2];

/// A bit of eight lanes each, as the sign of the lane.
#[inline(always)]
fn signs(mask: u8) -> __m256 {
    x86!({
        let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        let mask = _mm256_set1_epi32(i32::from(mask));
        _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(mask, bits), bits))
    })
}

/// The signs, in lanes twice as wide.
#[inline(always)]
fn widen_signs(x: __m256) -> D {
    x86!({
        let x = _mm256_castps_si256(x);
        let (low, high) = (_mm256_castsi256_si128(x), _mm256_extracti128_si256::<1>(x));
        [
            _mm256_castsi256_pd(_mm256_cvtepi32_epi64(low)),
            _mm256_castsi256_pd(_mm256_cvtepi32_epi64(high)),
        ]
    })
}

/// The sign bits of a register, by an instruction that the compiler does not see through: it would
/// put two such masks together from lanes, with five shuffles and comparisons in place of a shift.
macro_rules! sign_bits {
    ($name:ident, $instruction:literal, $register:ty) => {
        #[target_feature(enable = "avx2")]
        #[inline]
        fn $name(x: $register) -> u32 {
            let bits: u32;
            // SAFETY: it reads and writes registers alone.
            unsafe {
                asm!(
                    concat!($instruction, " {:e}, {}"),
                    out(reg) bits,
                    in(ymm_reg) x,
                    options(pure, nomem, nostack, preserves_flags),
                );
            }
            bits
        }
    };
}

sign_bits!(sign_bits, "vmovmskps", __m256);
sign_bits!(sign_bits64, "vmovmskpd", __m256d);

/// The sign bits of sixteen lanes.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "eight bits each")]
fn mask(x: F) -> u16 {
    let [low, high] = x86!([sign_bits(x[0]), sign_bits(x[1])]);
    (low | high << 8) as u16
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "four bits each")]
fn mask64(x: D) -> u8 {
    let [low, high] = x86!([sign_bits64(x[0]), sign_bits64(x[1])]);
    (low | high << 4) as u8
}

/// Four lanes of each in turns.
#[inline(always)]
fn interleave_half(a: __m256d, b: __m256d) -> D {
    x86!({
        let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        [_mm256_permute2f128_pd::<0x20>(even, odd), _mm256_permute2f128_pd::<0x31>(even, odd)]
    })
}

#[inline(always)]
fn permute_half(table: F, places: __m256) -> __m256 {
    x86!({
        let places = _mm256_castps_si256(places);
        let low = _mm256_permutevar8x32_ps(table[0], places);
        let high = _mm256_permutevar8x32_ps(table[1], places);
        let is_high = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(places));
        _mm256_blendv_ps(low, high, is_high)
    })
}

/// The set lanes for each mask of eight lanes, in front of anything.
static FRONTS: [[u8; 8]; 256] = {
    let mut fronts = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                fronts[mask][count] = lane;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    fronts
};

#[inline(always)]
fn compress_half(mask: u8, a: __m256) -> __m256 {
    let lanes = &FRONTS[usize::from(mask)];
    x86!({
        let lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(lanes.as_ptr().cast()));
        _mm256_permutevar8x32_ps(a, lanes)
    })
}

#[inline(always)]
fn widen_half(a: __m256) -> D {
    x86!([
        _mm256_cvtps_pd(_mm256_castps256_ps128(a)),
        _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a))
    ])
}

#[inline(always)]
fn narrow_half(x: D) -> __m256 {
    x86!(_mm256_set_m128(_mm256_cvtpd_ps(x[1]), _mm256_cvtpd_ps(x[0])))
}

/// Four rows of four to four columns.
#[inline(always)]
fn transpose_half(a: __m256d, b: __m256d, c: __m256d, d: __m256d) -> [__m256d; 4] {
    x86!({
        let (ab, cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
        let (other_ab, other_cd) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab, cd),
            _mm256_permute2f128_pd::<0x20>(other_ab, other_cd),
            _mm256_permute2f128_pd::<0x31>(ab, cd),
            _mm256_permute2f128_pd::<0x31>(other_ab, other_cd),
        ]
    })
}

impl Lanes for Avx2 {
    type Floats = F;
    type Doubles = D;

    inlined! {
        fn splat(self, x: f32) -> F = x86!([_mm256_set1_ps(x); 2]);
        fn add(self, a: F, b: F) -> F = both!(_mm256_add_ps, a, b);
        fn sub(self, a: F, b: F) -> F = both!(_mm256_sub_ps, a, b);
        fn mul(self, a: F, b: F) -> F = both!(_mm256_mul_ps, a, b);
        fn div(self, a: F, b: F) -> F = both!(_mm256_div_ps, a, b);
        fn min(self, a: F, b: F) -> F = both!(_mm256_min_ps, a, b);
        fn max(self, a: F, b: F) -> F = both!(_mm256_max_ps, a, b);
        fn abs(self, a: F) -> F = both!(_mm256_andnot_ps, self.splat(-0.0), a);
        fn floor(self, a: F) -> F = both!(_mm256_floor_ps, a);
        fn ceil(self, a: F) -> F = both!(_mm256_ceil_ps, a);
        fn mul_add(self, a: F, b: F, c: F) -> F = both!(_mm256_fmadd_ps, a, b, c);
        fn neg_mul_add(self, a: F, b: F, c: F) -> F = both!(_mm256_fnmadd_ps, a, b, c);
        fn mul_sub(self, a: F, b: F, c: F) -> F = both!(_mm256_fmsub_ps, a, b, c);
        fn lt(self, a: F, b: F) -> u16 = mask(both!(_mm256_cmp_ps::<_CMP_LT_OQ>, a, b));
        fn le(self, a: F, b: F) -> u16 = mask(both!(_mm256_cmp_ps::<_CMP_LE_OQ>, a, b));
        fn largest(self, a: F) -> f32 = reduce::largest(a);
        fn smallest(self, a: F) -> f32 = reduce::smallest(a);
        fn smallest_of_each(self, of: [&[f32; LANES]; LANES]) -> F = reduce::smallest_of_each(of);
        fn splat64(self, x: f64) -> D = x86!([_mm256_set1_pd(x); 2]);
        fn add64(self, a: D, b: D) -> D = both!(_mm256_add_pd, a, b);
        fn sub64(self, a: D, b: D) -> D = both!(_mm256_sub_pd, a, b);
        fn mul64(self, a: D, b: D) -> D = both!(_mm256_mul_pd, a, b);
        fn div64(self, a: D, b: D) -> D = both!(_mm256_div_pd, a, b);
        fn sqrt64(self, a: D) -> D = both!(_mm256_sqrt_pd, a);
        fn abs64(self, a: D) -> D = both!(_mm256_andnot_pd, self.splat64(-0.0), a);
        fn max64(self, a: D, b: D) -> D = both!(_mm256_max_pd, a, b);
        fn fused_mul_sub64(self, a: D, b: D, c: D) -> D = both!(_mm256_fmsub_pd, a, b, c);
        fn fused_mul_add64(self, a: D, b: D, c: D) -> D = both!(_mm256_fmadd_pd, a, b, c);
        fn fused_neg_mul_add64(self, a: D, b: D, c: D) -> D = both!(_mm256_fnmadd_pd, a, b, c);
        fn lt64(self, a: D, b: D) -> u8 = mask64(both!(_mm256_cmp_pd::<_CMP_LT_OQ>, a, b));
        fn le64(self, a: D, b: D) -> u8 = mask64(both!(_mm256_cmp_pd::<_CMP_LE_OQ>, a, b));
    }

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        x86!(with_features(kernel))
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> F {
        x86!([_mm256_loadu_ps(from.as_ptr()), _mm256_loadu_ps(from.as_ptr().wrapping_add(8))])
    }
    #[inline(always)]
    fn store(self, x: F, to: &mut [f32; LANES]) {
        x86!({
            _mm256_storeu_ps(to.as_mut_ptr(), x[0]);
            _mm256_storeu_ps(to.as_mut_ptr().wrapping_add(8), x[1]);
        });
    }
    #[inline(always)]
    fn permute_by(self, table: F, places: F) -> F {
        [permute_half(table, places[0]), permute_half(table, places[1])]
    }
    #[inline(always)]
    fn load_places(self, from: &[u8; LANES]) -> F {
        let (low, high) = from.split_at(8);
        x86!([
            _mm256_castsi256_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(low.as_ptr().cast()))),
            _mm256_castsi256_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(high.as_ptr().cast()))),
        ])
    }
    #[inline(always)]
    fn same(self, a: F, b: F) -> u16 {
        mask(x86!([
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(
                _mm256_castps_si256(a[0]),
                _mm256_castps_si256(b[0])
            )),
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(
                _mm256_castps_si256(a[1]),
                _mm256_castps_si256(b[1])
            ))
        ]))
    }
    #[inline(always)]
    fn same_sixteen(self, a: F, b: F) -> u16 {
        let bits = self.splat(f32::from_bits(!15));
        self.same(both!(_mm256_and_ps, a, bits), both!(_mm256_and_ps, b, bits))
    }
    #[inline(always)]
    fn select(self, mask: u16, a: F, b: F) -> F {
        let [low, high] = mask.to_le_bytes();
        let signs = [signs(low), signs(high)];
        both!(_mm256_blendv_ps, b, a, signs)
    }
    #[inline(always)]
    fn compress(self, mask: u16, a: F, to: &mut [f32; LANES]) {
        let [low, high] = mask.to_le_bytes();
        let front = to.as_mut_ptr();
        let behind = front.wrapping_add(low.count_ones() as usize);
        // SAFETY: eight numbers from `behind` on end with the sixteenth at the latest; an `Avx2` is
        // made only where the machine has the features.
        unsafe {
            _mm256_storeu_ps(front, compress_half(low, a[0]));
            _mm256_storeu_ps(behind, compress_half(high, a[1]));
        }
    }
    #[inline(always)]
    fn load_widened(self, from: &[f32; WIDE]) -> D {
        widen_half(x86!(_mm256_loadu_ps(from.as_ptr())))
    }
    #[inline(always)]
    fn store_narrowed(self, x: D, to: &mut [f32; WIDE]) {
        // One store: a load of all eight would wait until two are in the cache.
        x86!(_mm256_storeu_ps(to.as_mut_ptr(), narrow_half(x)));
    }
    #[inline(always)]
    fn load64(self, from: &[f64; WIDE]) -> D {
        x86!([_mm256_loadu_pd(from.as_ptr()), _mm256_loadu_pd(from.as_ptr().wrapping_add(4))])
    }
    #[inline(always)]
    fn store64(self, x: D, to: &mut [f64; WIDE]) {
        x86!({
            _mm256_storeu_pd(to.as_mut_ptr(), x[0]);
            _mm256_storeu_pd(to.as_mut_ptr().wrapping_add(4), x[1]);
        });
    }
    #[inline(always)]
    fn select64(self, mask: u8, a: D, b: D) -> D {
        let signs = widen_signs(signs(mask));
        both!(_mm256_blendv_pd, b, a, signs)
    }
    #[inline(always)]
    fn interleave64(self, a: D, b: D) -> [D; 2] {
        [interleave_half(a[0], b[0]), interleave_half(a[1], b[1])]
    }
    #[inline(always)]
    fn narrow(self, first: D, second: D) -> F {
        [narrow_half(first), narrow_half(second)]
    }
    #[inline(always)]
    fn widen(self, x: F) -> [D; 2] {
        [widen_half(x[0]), widen_half(x[1])]
    }
    #[inline(always)]
    fn transpose64(self, rows: [D; WIDE]) -> [D; WIDE] {
        let [a, b, c, d, e, f, g, h] = rows;
        macro_rules! columns {
            ($part:literal) => {{
                let first = transpose_half(a[$part], b[$part], c[$part], d[$part]);
                let second = transpose_half(e[$part], f[$part], g[$part], h[$part]);
                [
                    [first[0], second[0]],
                    [first[1], second[1]],
                    [first[2], second[2]],
                    [first[3], second[3]],
                ]
            }};
        }
        let ([a, b, c, d], [e, f, g, h]) = (columns!(0), columns!(1));
        [a, b, c, d, e, f, g, h]
    }
    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        x86::prefetch(what);
    }
    #[inline(always)]
    fn prefetch_either<T, U>(self, is_other: bool, index: u32, whats: &[T], others: &[U]) {
        x86::prefetch_either(is_other, index, whats, others);
    }
    #[inline(always)]
    fn stream<T: Pod>(self, from: &[T], to: &mut [T]) {
        let from: &[u8] = bytemuck::cast_slice(from);
        let to: &mut [u8] = bytemuck::cast_slice_mut(to);
        let head = x86::up_to_a_multiple(to.as_ptr(), 32).min(to.len());
        let (from_head, from) = from.split_at(head);
        let (to_head, to) = to.split_at_mut(head);
        // Nothing mostly, and a call.
        if head > 0 {
            to_head.copy_from_slice(from_head);
        }
        let (from, from_tail) = from.as_chunks::<32>();
        let (to, to_tail) = to.as_chunks_mut::<32>();
        for k in 0..to.len() {
            let (from, to) = (&from[k], &mut to[k]);
            // SAFETY: each has 32 bytes, and those that are written begin at a multiple of 32; an
            // `Avx2` is made only where the machine has the features.
            unsafe {
                let bytes = _mm256_loadu_si256(from.as_ptr().cast());
                _mm256_stream_si256(to.as_mut_ptr().cast(), bytes);
            }
        }
        if !to_tail.is_empty() {
            to_tail.copy_from_slice(from_tail);
        }
    }
    #[inline(always)]
    fn end_streams(self) {
        x86::end_streams();
    }
}
