//! Hits to linear colours, and lines along edges.
//!
//! It sees hits, and asks for more by an engine. It may never know a tree or a file.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]

pub mod edge;
pub mod shade;

pub(crate) use firsthit_accel::shape;
pub(crate) use firsthit_camera::camera;
pub(crate) use firsthit_geometry::{error, geometry, parallel, sampling, watch};
pub(crate) use firsthit_scene::scene;
pub(crate) use firsthit_shoot::shoot;
pub(crate) use firsthit_simd::{memory, simd};
