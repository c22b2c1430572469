//! The stored result: named channels over the elements of a picture or a batch, and their file formats.
//!
//! A [`Frame`] holds what came out. [`write()`] stores it, in the [`Format`] that the path's extension
//! names; [`FORMATS`] lists them. A file appears whole or not at all, see [`write_whole`].
//!
//! Colours are linear in a frame and in NPY and NPZ; only PNG applies the sRGB curve. Nothing is ever
//! filtered, tone-mapped or resized here, and the same frame gives the same bytes on every machine.

mod colormap;
mod file;
mod format;
mod frame;
mod npy;
mod npz;
mod png;
mod srgb;

pub use colormap::legend;
pub use file::write_whole;
pub use format::{FORMATS, Format, Holds, format_named, format_of, write, write_channel};
pub use frame::{Channel, Data, Frame, Picture};
