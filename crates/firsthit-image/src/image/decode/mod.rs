//! The decoders: bytes to numbers, a file per format.
//!
//! The bytes are untrusted. A decoder compares the sizes that a file claims with its length before
//! it allocates.

// A reader that panics is a reader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

#[cfg(feature = "exr")]
pub(super) mod exr;
#[cfg(feature = "npy")]
pub(super) mod npy;
#[cfg(feature = "npy")]
pub(super) mod npz;
pub(super) mod output;
#[cfg(feature = "png")]
pub(super) mod png;
#[cfg(feature = "cloud")]
pub(super) mod points;
