//! Lanes, masks and instruction sets, for kernels that are written once, and memory: mapped,
//! shared, or asked for before it is needed.
//!
//! All `unsafe` code of the library is here, and its other crates forbid it. It may never know what
//! is traced: no shape, no tree.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![allow(
    missing_debug_implementations,
    reason = "what other crates of the house share with this one, and users never see"
)]

#[doc(hidden)]
pub mod memory;
#[doc(hidden)]
pub mod simd;

pub(crate) use firsthit_geometry::{error, geometry, parallel};
