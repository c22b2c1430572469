//! What every x86-64 processor has, whichever lanes are used: prefetches and a fence.

use std::arch::x86_64::*;

/// See [`Lanes::prefetch`](super::Lanes::prefetch).
#[inline(always)]
pub(super) fn prefetch<T>(what: &T) {
    prefetch_lines(
        std::ptr::from_ref(what).cast(),
        size_of::<T>(),
        size_of::<T>(),
    );
}

/// See [`Lanes::prefetch_either`](super::Lanes::prefetch_either).
#[inline(always)]
pub(super) fn prefetch_either<T, U>(is_other: bool, index: u32, whats: &[T], others: &[U]) {
    let (start, size) = if is_other {
        (others.as_ptr().cast::<i8>(), size_of::<U>())
    } else {
        (whats.as_ptr().cast::<i8>(), size_of::<T>())
    };
    let start = start.wrapping_add(size * index as usize);
    prefetch_lines(start, size, size_of::<T>().max(size_of::<U>()));
}

/// Prefetches as many cache lines as `most` bytes have. Beyond `size` bytes it takes the first line again, so that the
/// loop has a fixed length.
#[inline(always)]
fn prefetch_lines(start: *const i8, size: usize, most: usize) {
    for line in 0..most.div_ceil(64) {
        let offset = if 64 * line < size { 64 * line } else { 0 };
        // SAFETY: every x86-64 processor has the instruction, and it may be given any address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(offset)) };
    }
}

/// See [`Lanes::end_streams`](super::Lanes::end_streams).
#[inline(always)]
pub(super) fn end_streams() {
    // SAFETY: every x86-64 processor has the instruction.
    unsafe { _mm_sfence() };
}
