//! Rays, hits, pixel grids, boxes, transforms, colours and exact arithmetic, and what every crate
//! of firsthit needs: errors, the loop over all threads, how a caller watches it, and which files
//! were read.
//!
//! It may never know what a scene, a camera or a file format is.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]
#![allow(
    missing_debug_implementations,
    reason = "what other crates of the house share with this one, and users never see"
)]

pub mod error;
pub mod geometry;
pub mod inputs;
#[doc(hidden)]
pub mod parallel;
pub mod sampling;
pub mod watch;
