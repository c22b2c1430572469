//! From pixels to rays: a camera is a pose and a lens. And poses over time.
//!
//! It may never know what rays meet: no shape, no scene.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]

pub mod camera;
pub mod trajectory;

pub(crate) use firsthit_geometry::{error, geometry};
pub(crate) use firsthit_simd::{memory, simd};
