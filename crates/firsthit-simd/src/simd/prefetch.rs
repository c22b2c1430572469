//! Prefetches, which every processor of these architectures has, whichever lanes are used.

/// See [`Lanes::prefetch`](super::Lanes::prefetch).
#[inline(always)]
pub(super) fn prefetch<T>(what: &T) {
    prefetch_lines(std::ptr::from_ref(what).cast(), size_of::<T>(), size_of::<T>());
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

/// Prefetches as many cache lines as `most` bytes have. Beyond `size` bytes it takes the first line
/// again, so that the loop has a fixed length.
#[inline(always)]
fn prefetch_lines(start: *const i8, size: usize, most: usize) {
    for line in 0..most.div_ceil(64) {
        let offset = if 64 * line < size { 64 * line } else { 0 };
        prefetch_line(start.wrapping_add(offset));
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn prefetch_line(at: *const i8) {
    use std::arch::x86_64::*;
    // SAFETY: every x86-64 processor has the instruction, and it may be given any address.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(at) };
}

/// Prefetches a cache line by assembly, since Rust has no stable intrinsic for it.
#[cfg(target_arch = "aarch64")]
#[inline(always)]
#[expect(clippy::pointers_in_nomem_asm_block, reason = "nothing is read or written through it")]
fn prefetch_line(at: *const i8) {
    // SAFETY: every such processor has the instruction. It is a hint: it may be given any address,
    // changes no register or flag, and what is in memory does not depend on it.
    unsafe {
        std::arch::asm!(
            "prfm pldl1keep, [{at}]",
            at = in(reg) at,
            options(nomem, nostack, preserves_flags)
        );
    }
}
