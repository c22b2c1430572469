//! A file per command.

pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod info;
pub(crate) mod render;
pub(crate) mod schema;
pub(crate) mod shoot;
