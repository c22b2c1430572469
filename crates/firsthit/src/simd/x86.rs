//! What every x86-64 processor has, whichever lanes are used: prefetches and a fence.

use std::arch::x86_64::*;

pub(super) use super::prefetch::{prefetch, prefetch_either};

/// See [`Lanes::end_streams`](super::Lanes::end_streams).
#[inline(always)]
pub(super) fn end_streams() {
    // SAFETY: every x86-64 processor has the instruction.
    unsafe { _mm_sfence() };
}
