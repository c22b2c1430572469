//! Lanes and instruction sets: the only room with `unsafe` code.
//!
//! A kernel is written once, generic over [`Lanes`], in plain safe code. [`run`] compiles it for every
//! instruction set and calls the version that was asked for. [`Portable`](portable::Portable) says in plain
//! Rust what each operation means; the others must do the same to the bit, wherever a result is not only
//! used to rule things out.
//!
//! All that a kernel calls must be `#[inline(always)]`: only what is inlined into the function with the
//! instruction set's features is compiled with them.

#![allow(unsafe_code, reason = "intrinsics; see each `SAFETY` line")]
#![allow(
    clippy::inline_always,
    reason = "what is not inlined is not compiled for the instruction set"
)]
#![allow(clippy::wildcard_imports, reason = "a room full of intrinsics")]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod lanes;
mod pages;
mod portable;
mod set;

pub(crate) use lanes::{Aligned, LANES, Lanes, WIDE};
pub(crate) use pages::prefer_large_pages;
pub use set::InstructionSet;

/// Something to be computed with lanes.
pub(crate) trait Kernel {
    /// What comes out.
    type Output;
    /// Does it; `#[inline(always)]` in every implementation.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Runs `kernel` with an instruction set; with the portable one where this machine has none of that name.
#[inline]
pub(crate) fn run<K: Kernel>(set: InstructionSet, kernel: K) -> K::Output {
    match set {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx512 => avx512::run(kernel),
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => avx2::run(kernel),
        _ => kernel.run(portable::Portable),
    }
}
