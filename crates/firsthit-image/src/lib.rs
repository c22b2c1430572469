//! Named channels (AOVs) in frames, their metadata, and the formats of outputs.
//!
//! It may never know where a channel comes from: no scene, no camera, no ray that is traced.
//!
//! Internal: it promises nothing to other programs. Use `firsthit`.

#![forbid(unsafe_code)]
#![cfg_attr(
    not(all(feature = "exr", feature = "png", feature = "npy", feature = "cloud")),
    allow(
        dead_code,
        unused_imports,
        reason = "some code serves only formats that are not enabled"
    )
)]

pub mod image;

pub(crate) use firsthit_geometry::{error, geometry, inputs, parallel, watch};
