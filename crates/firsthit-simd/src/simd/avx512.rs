//! The lanes in AVX-512: a register each.

use std::arch::x86_64::*;

use bytemuck::Pod;

use super::lanes::inlined;
use super::{Kernel, LANES, Lanes, WIDE, x86};

/// Proof that this machine has AVX-512 F, BW, DQ and VL, and what comes before them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx512(());

pub(super) fn is_available() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && super::avx2::is_available()
}

/// Runs a kernel that is compiled for the features. Not inlined, so that [`Lanes::call`] shares it.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
fn with_features<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Avx512(()))
}

/// Runs a kernel; with AVX2 or less where AVX-512 is missing.
#[inline]
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    if is_available() {
        // SAFETY: the line above asked for the features.
        unsafe { with_features(kernel) }
    } else {
        super::avx2::run(kernel)
    }
}

/// An intrinsic of the instruction set.
macro_rules! x86 {
    ($e:expr) => {
        // SAFETY: an `Avx512` is made only where the machine has the features.
        unsafe { $e }
    };
}

type F = __m512;
type D = __m512d;

impl Lanes for Avx512 {
    type Floats = F;
    type Doubles = D;

    inlined! {
        fn splat(self, x: f32) -> F = x86!(_mm512_set1_ps(x));
        fn load(self, from: &[f32; LANES]) -> F = x86!(_mm512_loadu_ps(from.as_ptr()));
        fn add(self, a: F, b: F) -> F = x86!(_mm512_add_ps(a, b));
        fn sub(self, a: F, b: F) -> F = x86!(_mm512_sub_ps(a, b));
        fn mul(self, a: F, b: F) -> F = x86!(_mm512_mul_ps(a, b));
        fn div(self, a: F, b: F) -> F = x86!(_mm512_div_ps(a, b));
        fn min(self, a: F, b: F) -> F = x86!(_mm512_min_ps(a, b));
        fn max(self, a: F, b: F) -> F = x86!(_mm512_max_ps(a, b));
        fn abs(self, a: F) -> F = x86!(_mm512_abs_ps(a));
        fn mul_add(self, a: F, b: F, c: F) -> F = x86!(_mm512_fmadd_ps(a, b, c));
        fn neg_mul_add(self, a: F, b: F, c: F) -> F = x86!(_mm512_fnmadd_ps(a, b, c));
        fn mul_sub(self, a: F, b: F, c: F) -> F = x86!(_mm512_fmsub_ps(a, b, c));
        fn lt(self, a: F, b: F) -> u16 = x86!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b));
        fn le(self, a: F, b: F) -> u16 = x86!(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b));
        fn select(self, mask: u16, a: F, b: F) -> F = x86!(_mm512_mask_blend_ps(mask, b, a));
        fn largest(self, a: F) -> f32 = x86!(_mm512_reduce_max_ps(a));
        fn smallest(self, a: F) -> f32 = x86!(_mm512_reduce_min_ps(a));
        fn splat64(self, x: f64) -> D = x86!(_mm512_set1_pd(x));
        fn load64(self, from: &[f64; WIDE]) -> D = x86!(_mm512_loadu_pd(from.as_ptr()));
        fn add64(self, a: D, b: D) -> D = x86!(_mm512_add_pd(a, b));
        fn sub64(self, a: D, b: D) -> D = x86!(_mm512_sub_pd(a, b));
        fn mul64(self, a: D, b: D) -> D = x86!(_mm512_mul_pd(a, b));
        fn div64(self, a: D, b: D) -> D = x86!(_mm512_div_pd(a, b));
        fn sqrt64(self, a: D) -> D = x86!(_mm512_sqrt_pd(a));
        fn abs64(self, a: D) -> D = x86!(_mm512_abs_pd(a));
        fn max64(self, a: D, b: D) -> D = x86!(_mm512_max_pd(a, b));
        fn fused_mul_sub64(self, a: D, b: D, c: D) -> D = x86!(_mm512_fmsub_pd(a, b, c));
        fn fused_mul_add64(self, a: D, b: D, c: D) -> D = x86!(_mm512_fmadd_pd(a, b, c));
        fn fused_neg_mul_add64(self, a: D, b: D, c: D) -> D = x86!(_mm512_fnmadd_pd(a, b, c));
        fn lt64(self, a: D, b: D) -> u8 = x86!(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b));
        fn le64(self, a: D, b: D) -> u8 = x86!(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b));
        fn select64(self, mask: u8, a: D, b: D) -> D = x86!(_mm512_mask_blend_pd(mask, b, a));
    }

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        x86!(with_features(kernel))
    }
    #[inline(always)]
    fn store(self, x: F, to: &mut [f32; LANES]) {
        x86!(_mm512_storeu_ps(to.as_mut_ptr(), x));
    }
    #[inline(always)]
    fn floor(self, a: F) -> F {
        x86!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a))
    }
    #[inline(always)]
    fn ceil(self, a: F) -> F {
        x86!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(a))
    }
    #[inline(always)]
    fn permute_by(self, table: F, places: F) -> F {
        x86!(_mm512_permutexvar_ps(_mm512_castps_si512(places), table))
    }
    #[inline(always)]
    fn load_places(self, from: &[u8; LANES]) -> F {
        x86!(_mm512_castsi512_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128(from.as_ptr().cast()))))
    }
    #[inline(always)]
    fn same(self, a: F, b: F) -> u16 {
        x86!(_mm512_cmpeq_epi32_mask(_mm512_castps_si512(a), _mm512_castps_si512(b)))
    }
    #[inline(always)]
    fn same_sixteen(self, a: F, b: F) -> u16 {
        x86!({
            let others = _mm512_xor_si512(_mm512_castps_si512(a), _mm512_castps_si512(b));
            _mm512_testn_epi32_mask(others, _mm512_set1_epi32(!15))
        })
    }
    #[inline(always)]
    fn smallest_of_each(self, of: [&[f32; LANES]; LANES]) -> F {
        // Two shuffles put the halves of two rows into two registers, whose minimum holds what is
        // left of both rows. The same for two such minima, and so on, until one number of each row
        // is left. Rows four apart go together first: the last two shuffles work within quarters of
        // a register, and so the result is in order.
        x86!({
            let behind = _mm512_set_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            macro_rules! key {
                ($k:literal) => {{
                    let bits = _mm512_castps_si512(_mm512_loadu_ps(of[$k].as_ptr()));
                    _mm512_or_si512(_mm512_and_si512(bits, _mm512_set1_epi32(!15)), behind)
                }};
            }
            macro_rules! two {
                ($a:literal, $b:literal) => {{
                    let (a, b) = (key!($a), key!($b));
                    _mm512_min_epu32(
                        _mm512_shuffle_i32x4::<0x44>(a, b),
                        _mm512_shuffle_i32x4::<0xee>(a, b),
                    )
                }};
            }
            macro_rules! four {
                ($a:literal, $b:literal, $c:literal, $d:literal) => {{
                    let (a, b) = (two!($a, $b), two!($c, $d));
                    _mm512_min_epu32(
                        _mm512_shuffle_i32x4::<0x88>(a, b),
                        _mm512_shuffle_i32x4::<0xdd>(a, b),
                    )
                }};
            }
            macro_rules! eight {
                ($a:expr, $b:expr) => {{
                    let (a, b) = ($a, $b);
                    _mm512_castsi512_ps(_mm512_min_epu32(
                        _mm512_unpacklo_epi64(a, b),
                        _mm512_unpackhi_epi64(a, b),
                    ))
                }};
            }
            let a = eight!(four!(0, 4, 8, 12), four!(1, 5, 9, 13));
            let b = eight!(four!(2, 6, 10, 14), four!(3, 7, 11, 15));
            _mm512_castsi512_ps(_mm512_min_epu32(
                _mm512_castps_si512(_mm512_shuffle_ps::<0x88>(a, b)),
                _mm512_castps_si512(_mm512_shuffle_ps::<0xdd>(a, b)),
            ))
        })
    }
    #[inline(always)]
    fn compress(self, mask: u16, a: F, to: &mut [f32; LANES]) {
        // In the register: to memory the instruction takes a hundred cycles on some processors.
        self.store(x86!(_mm512_maskz_compress_ps(mask, a)), to);
    }
    #[inline(always)]
    fn load_widened(self, from: &[f32; WIDE]) -> D {
        x86!(_mm512_cvtps_pd(_mm256_loadu_ps(from.as_ptr())))
    }
    #[inline(always)]
    fn store_narrowed(self, x: D, to: &mut [f32; WIDE]) {
        x86!(_mm256_storeu_ps(to.as_mut_ptr(), _mm512_cvtpd_ps(x)));
    }
    #[inline(always)]
    fn store64(self, x: D, to: &mut [f64; WIDE]) {
        x86!(_mm512_storeu_pd(to.as_mut_ptr(), x));
    }
    #[inline(always)]
    fn interleave64(self, a: D, b: D) -> [D; 2] {
        x86!([
            _mm512_permutex2var_pd(a, _mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11), b),
            _mm512_permutex2var_pd(a, _mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15), b)
        ])
    }
    #[inline(always)]
    fn narrow(self, first: D, second: D) -> F {
        x86!({
            let (first, second) = (_mm512_cvtpd_ps(first), _mm512_cvtpd_ps(second));
            _mm512_insertf32x8::<1>(_mm512_castps256_ps512(first), second)
        })
    }
    #[inline(always)]
    fn widen(self, x: F) -> [D; 2] {
        x86!([
            _mm512_cvtps_pd(_mm512_castps512_ps256(x)),
            _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(x))
        ])
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
        assert_eq!(from.len(), to.len());
        let length = size_of_val(to);
        let (from, to) = (from.as_ptr().cast::<i8>(), to.as_mut_ptr().cast::<i8>());
        let head = x86::up_to_a_multiple(to, 64).min(length);
        let lines = (length - head) / 64;
        // (Not a closure: that would not be compiled with the features.)
        macro_rules! part {
            ($at:expr, $bytes:expr) => {{
                let mask = (1_u64 << $bytes) - 1;
                // SAFETY: both have `length` bytes, `$at + $bytes` is no more, and bytes that are
                // not in the mask are not touched; an `Avx512` is made only where the machine has
                // the features.
                unsafe {
                    let bytes = _mm512_maskz_loadu_epi8(mask, from.wrapping_add($at));
                    _mm512_mask_storeu_epi8(to.wrapping_add($at), mask, bytes);
                }
            }};
        }
        // Even a store of nothing has its line fetched.
        if head > 0 {
            part!(0, head);
        }
        for line in 0..lines {
            let at = head + 64 * line;
            // SAFETY: the 64 bytes are in both, and those that are written begin at a multiple of
            // 64.
            unsafe {
                let bytes = _mm512_loadu_si512(from.wrapping_add(at).cast());
                _mm512_stream_si512(to.wrapping_add(at).cast(), bytes);
            }
        }
        let at = head + 64 * lines;
        if at < length {
            part!(at, length - at);
        }
    }
    #[inline(always)]
    fn end_streams(self) {
        x86::end_streams();
    }
}
