//! The largest and the smallest of lanes.

use std::arch::x86_64::*;

use super::{F, LANES, WIDE};

/// See [`Lanes::largest`](super::Lanes::largest).
#[inline(always)]
pub(super) fn largest(a: F) -> f32 {
    x86!({
        let eight = _mm256_max_ps(a[0], a[1]);
        let four = _mm_max_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
        let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
        _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps::<1>(two, two)))
    })
}

/// See [`Lanes::smallest`](super::Lanes::smallest).
#[inline(always)]
pub(super) fn smallest(a: F) -> f32 {
    x86!({
        let eight = _mm256_min_ps(a[0], a[1]);
        let four = _mm_min_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
        let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
        _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps::<1>(two, two)))
    })
}

/// See [`Lanes::smallest_of_each`](super::Lanes::smallest_of_each); in the steps of `avx512.rs`.
#[inline(always)]
pub(super) fn smallest_of_each(of: [&[f32; LANES]; LANES]) -> F {
    x86!({
        let first = _mm256_set_epi32(8, 9, 10, 11, 12, 13, 14, 15);
        let second = _mm256_set_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        macro_rules! key {
            ($of:expr, $behind:ident) => {
                _mm256_or_si256(
                    _mm256_and_si256(
                        _mm256_loadu_si256($of.as_ptr().cast()),
                        _mm256_set1_epi32(!15),
                    ),
                    $behind,
                )
            };
        }
        macro_rules! one {
            ($k:literal) => {{
                let [low, high]: &[[f32; WIDE]; 2] = bytemuck::cast_ref(of[$k]);
                _mm256_min_epu32(key!(low, first), key!(high, second))
            }};
        }
        macro_rules! two {
            ($a:literal, $b:literal) => {{
                let (a, b) = (one!($a), one!($b));
                _mm256_min_epu32(
                    _mm256_permute2x128_si256::<0x20>(a, b),
                    _mm256_permute2x128_si256::<0x31>(a, b),
                )
            }};
        }
        macro_rules! four {
            ($a:literal, $b:literal, $c:literal, $d:literal) => {{
                let (a, b) = (two!($a, $b), two!($c, $d));
                _mm256_castsi256_ps(_mm256_min_epu32(
                    _mm256_unpacklo_epi64(a, b),
                    _mm256_unpackhi_epi64(a, b),
                ))
            }};
        }
        macro_rules! eight {
            ($a:expr, $b:expr) => {{
                let (a, b) = ($a, $b);
                _mm256_castsi256_ps(_mm256_min_epu32(
                    _mm256_castps_si256(_mm256_shuffle_ps::<0x88>(a, b)),
                    _mm256_castps_si256(_mm256_shuffle_ps::<0xdd>(a, b)),
                ))
            }};
        }
        [
            eight!(four!(0, 4, 1, 5), four!(2, 6, 3, 7)),
            eight!(four!(8, 12, 9, 13), four!(10, 14, 11, 15)),
        ]
    })
}
