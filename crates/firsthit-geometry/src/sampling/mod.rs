//! Samples: points of pixels and of lenses, numbers for shaders, choices by weights, and maps from
//! the unit square.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

#[doc(hidden)]
pub mod distribution;
mod draws;
mod pixel;
mod sobol;
mod tangent_frame;
#[doc(hidden)]
pub mod warp;

pub use draws::Draws;
#[doc(hidden)]
pub use draws::key;
#[doc(hidden)]
pub use pixel::{offset, on_lens};
#[doc(hidden)]
pub use tangent_frame::TangentFrame;
