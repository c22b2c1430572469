//! Files of meshes, models and environments: a file or a folder for each format.
//!
//! A file is untrusted: no count in it sizes an allocation, every index in it is checked, and no
//! file outside its folder is opened.

// A loader that panics is a loader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

mod decimal;
mod environment;
pub mod fault;
mod format;
mod formats;
#[cfg(feature = "gltf")]
mod gltf;
mod gzip;
pub mod memory_budget;
mod model;
#[cfg(feature = "obj")]
mod mtl;
#[cfg(feature = "obj")]
mod obj;
#[cfg(feature = "off")]
mod off;
#[cfg(any(feature = "gltf", feature = "obj", feature = "ply"))]
mod picture;
#[cfg(feature = "ply")]
mod ply;
mod polygon;
pub mod read;
mod recognize;
mod report;
mod sanitize;
mod scale;
mod settings;
mod source;
#[cfg(feature = "stl")]
mod stl;
mod surface;
mod text;
mod warnings;

pub use environment::{load_environment, load_environment_part};
pub use format::{Format, ModelFormat, format_of};
pub use formats::{FORMATS, load_part};
pub use model::{Model, NamedCamera};
pub use report::Report;
pub use settings::{LoadSettings, UNITS};
pub use source::has_extension;
pub use surface::{TOO_FAR, polygons};
