//! Sensors, channels, the loop from rays to frames, and scans of laser scanners.
//!
//! It may never know how a scene is read.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]

pub mod channel;
pub mod render;
pub mod scan;
pub mod sensor;

pub(crate) use firsthit_accel::shape;
pub(crate) use firsthit_camera::{camera, trajectory};
pub(crate) use firsthit_geometry::{error, geometry, parallel, sampling, watch};
pub(crate) use firsthit_image::image;
pub(crate) use firsthit_scene::scene;
pub(crate) use firsthit_shade::{edge, shade};
pub(crate) use firsthit_shoot::shoot;
pub(crate) use firsthit_simd::memory;
