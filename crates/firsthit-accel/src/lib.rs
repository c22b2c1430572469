//! Shapes, which rays meet, and the trees over triangles and objects, which rule out what a ray
//! cannot meet.
//!
//! It knows meshes, each in its own space. It may never know an object, a material, a lens or an
//! engine.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]
#![allow(
    missing_debug_implementations,
    reason = "what other crates of the house share with this one, and users never see"
)]

pub mod accel;
pub mod shape;

pub(crate) use firsthit_geometry::{error, geometry, parallel, watch};
pub(crate) use firsthit_simd::{memory, simd};
