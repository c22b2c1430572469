//! Plain data of what a file describes, scene files, built scenes, and the reader of any file.
//!
//! It may never know what is done with a scene: it traces no ray.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]
#![cfg_attr(
    not(all(feature = "fhs", feature = "scene-file")),
    allow(
        dead_code,
        unused_imports,
        reason = "some code serves only formats that are not enabled"
    )
)]

#[cfg(feature = "fhs")]
pub mod fhs;
pub mod load;
#[cfg(feature = "scene-file")]
pub mod scene_file;
pub mod world;

pub(crate) use firsthit_accel::{accel, shape};
pub(crate) use firsthit_camera::camera;
#[cfg(feature = "scene-file")]
pub(crate) use firsthit_camera::trajectory;
pub(crate) use firsthit_geometry::{error, geometry, parallel, watch};
#[cfg(any(feature = "fhs", feature = "scene-file"))]
pub(crate) use firsthit_image::image;
pub(crate) use firsthit_io::io;
#[cfg(feature = "scene-file")]
pub(crate) use firsthit_render::{channel, sensor};
pub(crate) use firsthit_scene::scene;
pub(crate) use firsthit_shade::{edge, shade};
pub(crate) use firsthit_simd::memory;
