//! The instructions of every x86-64 processor, whichever lanes are used: prefetches and a fence.

use std::arch::x86_64::*;

pub(super) use super::prefetch::{prefetch, prefetch_either};

/// The number of bytes to the next address that is a multiple of a power of two. (`align_offset` is
/// a call.)
#[inline(always)]
pub(super) fn up_to_a_multiple<T>(at: *const T, of: usize) -> usize {
    at.addr().wrapping_neg() & (of - 1)
}

/// See [`Lanes::end_streams`](super::Lanes::end_streams).
#[inline(always)]
pub(super) fn end_streams() {
    // SAFETY: every x86-64 processor has the instruction.
    unsafe { _mm_sfence() };
}
