//! Rays to answers: engines, queries, nearest points, and what is inside. Nearly all kernels are
//! compiled here.
//!
//! It may never know how an answer looks: no colour, no camera, no picture.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]
#![allow(
    missing_debug_implementations,
    reason = "what other crates of the house share with this one, and users never see"
)]

pub mod measure;
pub mod nearest;
pub mod shoot;
#[doc(hidden)]
pub mod solid;

pub(crate) use firsthit_accel::{accel, shape};
pub(crate) use firsthit_geometry::{error, geometry, parallel, watch};
pub(crate) use firsthit_scene::scene;
pub(crate) use firsthit_simd::{memory, simd};
