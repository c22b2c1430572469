//! Sections, faults of meshes, and why a ray meets what it meets.
//!
//! It may never know a shader or a file of a model.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]

pub mod explain;
pub mod lint;
pub mod section;

pub(crate) use firsthit_accel::{accel, shape};
pub(crate) use firsthit_camera::camera;
pub(crate) use firsthit_geometry::{error, geometry, parallel, watch};
#[cfg(feature = "frame")]
pub(crate) use firsthit_image::image;
pub(crate) use firsthit_scene::scene;
pub(crate) use firsthit_shoot::{shoot, solid};
pub(crate) use firsthit_simd::memory;
