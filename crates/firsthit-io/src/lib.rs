//! Readers of meshes, models and environment maps, and the only door to their files.
//!
//! A file is untrusted. This crate may never know how its scene looks in a picture: no shader, no
//! sensor.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]
#![allow(
    missing_debug_implementations,
    reason = "what other crates of the house share with this one, and users never see"
)]
#![cfg_attr(
    not(all(
        feature = "gltf",
        feature = "obj",
        feature = "ply",
        feature = "off",
        feature = "stl",
        feature = "exr"
    )),
    allow(
        dead_code,
        unused_imports,
        reason = "some code serves only formats that are not enabled"
    )
)]

#[doc(hidden)]
pub mod io;

pub(crate) use firsthit_accel::shape;
pub(crate) use firsthit_camera::camera;
pub(crate) use firsthit_geometry::{error, geometry, inputs, watch};
#[cfg(feature = "exr")]
pub(crate) use firsthit_image::image;
pub(crate) use firsthit_scene::scene;
pub(crate) use firsthit_simd::memory;
