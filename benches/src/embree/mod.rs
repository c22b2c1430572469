//! Embree 4, opened at run time: devices, scenes, and its doors for rays.
#![expect(unsafe_code, reason = "Embree is a C library; every block says what it rests on")]
#![expect(
    clippy::inline_always,
    reason = "what fills packets must end up in `trace::wide`, to be compiled for wide registers"
)]

mod api;
mod control;
mod device;
mod gather;
mod model;
mod packet;
mod plane;
mod source;
mod trace;

pub(crate) use control::FlushToZero;
pub(crate) use device::{Device, Library, Scene};
pub(crate) use gather::Gathered;
pub(crate) use model::Model;
pub(crate) use source::{Columns, Pixels, Source};
pub(crate) use trace::{Answers, Door};
