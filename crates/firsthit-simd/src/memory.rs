//! Whether there is memory, asked before it is needed; what comes in large pages; and arrays in
//! shared memory.

use bytemuck::Zeroable;

use crate::error::{Error, Result};
use crate::simd;
pub use crate::simd::Storage;
pub use crate::simd::{BLOCK_ALIGNMENT, Block};

/// Refuses what would take more memory than the system gives at this moment.
///
/// To be asked before work of many allocations that cannot each fail in an orderly manner: in Rust
/// a small one that fails ends the process. Under a limit on the address space (`ulimit -v`) the
/// answer is exact, but for what other threads take meanwhile.
///
/// # Errors
///
/// [`Error::Limit`].
pub fn check(what: &'static str, bytes: usize) -> Result<()> {
    // WebAssembly's memory never shrinks again: what is not yet addressed is as good as free, and
    // is not reserved for a try.
    #[cfg(target_arch = "wasm32")]
    if bytes <= unaddressed() {
        return Ok(());
    }
    let mut probe = Vec::<u8>::new();
    let refused = probe.try_reserve_exact(bytes).is_err();
    // Without this the compiler may see that the reserved memory is unused, and not reserve it.
    std::hint::black_box(&mut probe);
    if refused {
        return Err(short_of(what, format!("{bytes} bytes")));
    }
    Ok(())
}

/// The number of bytes by which a 32-bit module's memory can still grow, if the host lets it.
#[cfg(target_arch = "wasm32")]
fn unaddressed() -> usize {
    const PAGE_BYTES: usize = 1 << 16;
    // The last page is left, so that no address overflows.
    let pages = (usize::MAX / PAGE_BYTES).saturating_sub(std::arch::wasm32::memory_size::<0>());
    pages * PAGE_BYTES
}

/// A vector of `count` zeros, which cost nothing before they are written, or an error when memory
/// is short.
pub fn zeroed<T: Zeroable>(count: usize) -> Result<Vec<T>> {
    let vec = bytemuck::allocation::try_zeroed_vec(count).map_err(|()| no_room(count))?;
    simd::prefer_large_pages(&vec);
    Ok(vec)
}

/// Makes a vector so long; its memory is used again where that is enough.
pub fn fit<T: Zeroable + Clone>(values: &mut Vec<T>, count: usize) -> Result<()> {
    if count <= values.capacity() {
        values.resize(count, T::zeroed());
        return Ok(());
    }
    // The old values go first: there may not be room for both.
    *values = Vec::new();
    *values = zeroed(count)?;
    Ok(())
}

/// An empty vector with room for `count` elements, in large pages where that is worth it. Unlike
/// the others here it is for what has been asked for before: the process ends where there is no
/// memory.
pub fn room<T>(count: usize) -> Vec<T> {
    let mut vec = Vec::with_capacity(count);
    simd::prefer_large_pages(vec.spare_capacity_mut());
    vec
}

/// A copy in such [room].
pub fn copy<T: Copy>(values: &[T]) -> Vec<T> {
    let mut copy = room(values.len());
    copy.extend_from_slice(values);
    copy
}

/// A vector of `count` times `value`, or an error instead of an abort when memory is short.
pub fn filled<T: Clone>(count: usize, value: T) -> Result<Vec<T>> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(count).map_err(|_| no_room(count))?;
    vec.resize(count, value);
    Ok(vec)
}

/// The error that a vector could not grow, by what it is for.
pub fn no_room_for(what: &'static str) -> Error {
    short_of(what, "more".into())
}

fn no_room(count: usize) -> Error {
    short_of("elements of a result", count.to_string())
}

fn short_of(what: &'static str, got: String) -> Error {
    let limit = "the memory there is".into();
    Error::Limit { what, got, limit }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused() {
        assert!(check("bytes of a test", 1 << 20).is_ok());
        let error = check("bytes of a test", isize::MAX as usize).unwrap_err();
        assert!(error.to_string().starts_with("bytes of a test: "), "{error}");
    }
}
