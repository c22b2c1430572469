//! Samples: points of pixels and of lenses, numbers for shaders, choices by weights, and maps from
//! the unit square.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

pub(crate) mod distribution;
mod draws;
mod pixel;
mod sobol;
mod tangent_frame;
pub(crate) mod warp;

pub use draws::Draws;
pub(crate) use draws::key;
pub(crate) use pixel::{offset, on_lens};
pub(crate) use tangent_frame::TangentFrame;
