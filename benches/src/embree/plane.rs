//! The memory for results, as kernel measurements found it fastest, for Embree too. Lines of 64
//! bytes, written at once and past the cache; planes that do not start at the same place of a
//! 4096-byte page.

/// A line of the cache.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Line(pub(super) [u32; 16]);

/// One number for each ray, as bits.
#[derive(Debug)]
pub(super) struct Plane {
    lines: Vec<Line>,
    first: usize,
}

impl Plane {
    /// The plane for `rays` results; `number` tells the planes of a set apart.
    pub(super) fn new(rays: usize, number: usize) -> Self {
        let first = 17 * number;
        let lines = vec![Line([u32::MAX; 16]); first + rays.div_ceil(16)];
        Self { lines, first }
    }

    /// The bits of ray `index`.
    pub(super) fn get(&self, index: usize) -> u32 {
        self.lines[self.first + index / 16].0[index % 16]
    }

    /// Writes line `index`.
    #[inline(always)]
    pub(super) fn write(&mut self, index: usize, line: &Line) {
        let target = &mut self.lines[self.first + index];
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{__m128i, _mm_load_si128, _mm_stream_si128};
            let from: *const __m128i = (&raw const *line).cast();
            let to: *mut __m128i = (&raw mut *target).cast();
            for quarter in 0..4 {
                // SAFETY: both lines are alive, 64 bytes long and aligned to 64; SSE2 is part of
                // x86-64.
                unsafe { _mm_stream_si128(to.add(quarter), _mm_load_si128(from.add(quarter))) };
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            *target = *line;
        }
    }
}

/// Orders streamed lines before what follows.
pub(super) fn settle() {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a fence has no conditions; SSE is part of x86-64.
    unsafe {
        std::arch::x86_64::_mm_sfence();
    }
}
