//! `from_fn`, `map` and copies of arrays, for kernels: they are always inlined.
//!
//! The standard library's call functions that are not marked to be inlined. In a kernel these stay
//! calls, which are not compiled for its instruction set.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

/// An array whose element `k` is `of(k)`. It has at least one.
#[inline(always)]
#[doc(hidden)]
pub fn from_fn<T: Copy, const N: usize>(mut of: impl FnMut(usize) -> T) -> [T; N] {
    let mut made = [of(0); N];
    let mut k = 1;
    while k < N {
        made[k] = of(k);
        k += 1;
    }
    made
}

/// An array whose elements are those of `elements`, mapped by `of`.
#[inline(always)]
#[doc(hidden)]
pub fn map<T: Copy, U: Copy, const N: usize>(
    elements: [T; N],
    mut of: impl FnMut(T) -> U,
) -> [U; N] {
    from_fn(|k| of(elements[k]))
}

/// Copies the first `N` elements, in registers where they are few.
#[inline(always)]
#[doc(hidden)]
pub fn copy<T: Copy, const N: usize>(from: &[T], to: &mut [T]) {
    let (from, to) = (from.first_chunk::<N>(), to.first_chunk_mut::<N>());
    *to.expect("there is room") = *from.expect("there are as many");
}
