//! Objects, materials, textures, lights, environments, and the trees over them.
//!
//! A scene is data. It may never know how it is asked: no engine, no shader, no file format.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]
#![allow(
    missing_debug_implementations,
    reason = "what other crates of the house share with this one, and users never see"
)]

pub mod scene;

pub(crate) use firsthit_accel::{accel, shape};
pub(crate) use firsthit_geometry::{error, geometry, parallel, sampling, watch};
pub(crate) use firsthit_simd::{memory, simd};
