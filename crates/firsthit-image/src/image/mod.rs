//! Results and their file formats: named channels over the pixels of a picture or the rays of a
//! batch.
//!
//! A [`Frame`] holds the channels. [`write()`] stores it in the [`Format`] that the path's
//! extension names; [`FORMATS`] lists the formats. A file appears whole or not at all, see
//! [`write_whole`]. Every file holds the same [`Metadata`], and [`read`] reads any of them back.
//!
//! Colours are linear in a frame; PNG and point clouds apply the sRGB curve, and PNG a
//! [`DisplayTransform`](crate::geometry::DisplayTransform) before it if asked to. Nothing is
//! filtered or resized, and the same frame gives the same bytes on every machine.

#[cfg(feature = "png")]
mod channel_colors;
mod compare;
mod content;
mod cryptomatte;
mod decode;
#[cfg(feature = "exr")]
mod exr;
mod file;
mod format;
mod frame;
#[cfg(feature = "cloud")]
mod las;
mod metadata;
mod names;
#[cfg(feature = "npy")]
mod npy;
#[cfg(feature = "npy")]
mod npz;
mod origin;
#[cfg(feature = "cloud")]
mod pcd;
#[cfg(feature = "cloud")]
mod ply;
#[cfg(feature = "png")]
mod png;
#[cfg(feature = "cloud")]
mod points;
mod read;
#[cfg(feature = "cloud")]
mod read_points;
mod returns;
#[cfg(any(feature = "png", feature = "cloud"))]
mod srgb;
#[cfg(feature = "png")]
mod steps;
mod stream;
#[cfg(feature = "png")]
mod tones;

#[cfg(feature = "png")]
pub use channel_colors::{color_of_identifier, legend, short_legend};
pub use compare::{Difference, compare};
pub use content::{Far, WriteSettings};
pub use cryptomatte::{Cryptomatte, matte_id};
#[cfg(feature = "exr")]
#[doc(hidden)]
pub use decode::exr::decode as decode_exr;
#[cfg(feature = "npy")]
pub use decode::npy::{NpyHeader, NpyValues};
pub use decode::output::{Array, ArrayValues, Output};
#[doc(hidden)]
pub use file::check_writable;
pub use file::{sidecar_of, write_whole};
#[doc(hidden)]
pub use format::known_extensions;
pub use format::{FORMATS, Format, Holds, format_named, format_of, write, write_channel};
pub use frame::{Channel, Data, Description, Display, Frame, Unit};
pub use metadata::{ChannelRecord, Encoding, METADATA_VERSION, Metadata, Pixels, Stored};
pub use names::{Names, ObjectNames};
pub use origin::{
    CameraRecord, ColorsRecord, Intrinsics, Origin, Pose, SensorRecord, ShadingRecord, TimedPose,
    TrajectoryRecord,
};
#[cfg(feature = "cloud")]
pub use points::is_point_cloud;
pub use read::{read, read_bytes, read_regular};
#[cfg(feature = "cloud")]
pub use read_points::{Points, points_of, read_points};
pub use returns::{SCAN_EXTENSIONS, write_scan};
