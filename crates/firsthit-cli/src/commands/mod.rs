//! A file per command.

pub(crate) mod build;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod diff;
pub(crate) mod info;
pub(crate) mod info_looks;
mod info_output;
pub(crate) mod inside;
pub(crate) mod lint;
mod list;
mod listing;
pub(crate) mod nearest;
pub(crate) mod probe;
pub(crate) mod render;
pub(crate) mod schema;
pub(crate) mod section;
pub(crate) mod shoot;
mod shoot_stream;
mod shot;
mod sinks;
pub(crate) mod thickness;
pub(crate) mod visible;
