//! Point clouds: the elements that have a position, each as a row of numbers.
//!
//! 1. An element is a point if its channel `position` is finite: misses are left out.
//! 2. Every channel becomes one or more columns, under the names that programs look for; colours
//!    become sRGB bytes.
//! 3. The points are written in the frame's order, each as the bytes of its columns, little-endian,
//!    without padding.
//!
//! [`ply`](super::ply) and [`pcd`](super::pcd) differ in the header, in some names and in how wide
//! a float is: a [`Layout`].

use std::fs::File;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::path::Path;

use super::content::{Content, check_float32, lost_in_float32, refuse_mattes};
use super::frame::{Channel, Data, Display, Unit};
use super::metadata::{Encoding, KEY, Stored};
use super::srgb::{srgb, unpremultiplied};
use crate::error::{Error, Result};
use crate::geometry::single;

/// The channel whose numbers are the coordinates.
pub(super) const POSITION: &str = "position";

/// The channel of a scan that has them.
const POINT: &str = "point";

/// Readers keep a line of a header in 1024 bytes, or in 256.
const LINE: usize = 200;

/// The layout of a point in a format.
pub(super) struct Layout {
    /// The names of a normal's three columns.
    pub(super) normal: [&'static str; 3],
    /// Whether float64 stays what it is; else it is rounded to float32 where that is fine enough.
    pub(super) has_doubles: bool,
    /// Whether the bytes of a colour are one column of 32 bits: blue, green, red, and alpha or 0.
    pub(super) has_packed_colors: bool,
}

/// The type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    Float64,
    Float32,
    Int32,
    Byte,
    /// Four bytes of a colour.
    Packed,
}

impl Layout {
    /// The type of each of the channel's columns.
    pub(super) fn type_of(&self, channel: &Channel) -> Type {
        match (&channel.data, channel.display) {
            (_, Display::Color) if self.has_packed_colors => Type::Packed,
            (_, Display::Color) | (Data::Bool(_), _) => Type::Byte,
            (Data::Int32(_), _) => Type::Int32,
            // Seconds since 1970 take more digits than a float32 has.
            (Data::Float64(_), _) if self.has_doubles || is_time(channel) => Type::Float64,
            _ if lost_in_float32(channel).is_some() => Type::Float64,
            _ => Type::Float32,
        }
    }

    /// The names of the channel's columns.
    pub(super) fn names(&self, channel: &Channel) -> Vec<String> {
        let named = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        match (&*channel.name, channel.components) {
            ("color", 3) if self.has_packed_colors => named(&["rgb"]),
            ("color", _) if self.has_packed_colors => named(&["rgba"]),
            ("color", count) => named(&["red", "green", "blue", "alpha"][..count.min(4)]),
            (POSITION | POINT, 3) => named(&["x", "y", "z"]),
            ("sensor_point", 3) => named(&["sensor_x", "sensor_y", "sensor_z"]),
            ("normal", 3) => named(&self.normal),
            ("uv", 2) => named(&["u", "v"]),
            // `z` is a coordinate.
            ("z", 1) => named(&["depth"]),
            (name, 1) => named(&[name]),
            (name, count) => (0..count).map(|k| format!("{name}_{k}")).collect(),
        }
    }

    pub(super) fn stored(&self, channel: &Channel) -> Stored {
        let (dtype, encoding) = match self.type_of(channel) {
            Type::Float64 => ("float64", Encoding::Exact),
            Type::Float32 if matches!(channel.data, Data::Float32(_)) => {
                ("float32", Encoding::Exact)
            }
            Type::Float32 => ("float32", Encoding::Rounded),
            Type::Int32 => ("int32", Encoding::Exact),
            Type::Byte if channel.display != Display::Color => ("uint8", Encoding::Exact),
            Type::Byte | Type::Packed => ("uint8", Encoding::Picture),
        };
        Stored::new(self.names(channel), dtype, encoding, channel.miss())
    }

    /// Refuses a frame without positions, and numbers that the columns cannot hold.
    pub(super) fn check(&self, content: &Content<'_>) -> Result<()> {
        let expected = "channels other than a Cryptomatte for a point cloud (use exr)";
        refuse_mattes(content, expected)?;
        if !content.channels.iter().any(|channel| is_position(channel)) {
            let names: Vec<&str> = content.channels.iter().map(|c| &*c.name).collect();
            let expected = "position, and any others, for a point cloud";
            return Err(Error::argument("channel", expected, names.join(", ")));
        }
        let expected = "in the range of float32 for a PCD (or use ply)";
        let mut rounded = (content.channels.iter()).filter(|c| self.type_of(c) == Type::Float32);
        rounded.try_for_each(|channel| check_float32(channel, content.shape, expected))
    }

    /// The channels, each with the type of its columns.
    pub(super) fn columns<'a>(&self, content: &Content<'a>) -> Vec<(&'a Channel, Type)> {
        content.channels.iter().map(|channel| (*channel, self.type_of(channel))).collect()
    }
}

/// Writes the points: the rows of the file.
pub(super) fn write_rows(
    content: &Content<'_>,
    columns: &[(&Channel, Type)],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut row = Vec::new();
    for index in points(content) {
        row.clear();
        for &(channel, kind) in columns {
            append(channel, kind, index, &mut row);
        }
        out.write_all(&row)?;
    }
    Ok(())
}

fn is_position(channel: &Channel) -> bool {
    matches!(&*channel.name, POSITION | POINT) && channel.components == 3
}

fn is_time(channel: &Channel) -> bool {
    channel.description.unit == Unit::Second
}

/// The content with metadata that count its points.
pub(super) fn counted(content: Content<'_>) -> Content<'_> {
    let count = points(&content).count() as u64;
    Content { metadata: content.metadata.clone().of_points(count), ..content }
}

/// The elements that are points.
pub(super) fn points<'a>(content: &'a Content<'_>) -> impl Iterator<Item = usize> + 'a {
    let channels = content.channels.iter();
    let positions = channels.filter(|channel| is_position(channel));
    positions.flat_map(|channel| {
        let count = channel.data.len() / channel.components;
        let is_point = |index: &usize| {
            let mut axes = *index * channel.components..(*index + 1) * channel.components;
            axes.all(|place| channel.data.value(place).is_finite())
        };
        (0..count).filter(is_point)
    })
}

/// Appends one element of a channel to its point's row.
fn append(channel: &Channel, kind: Type, index: usize, row: &mut Vec<u8>) {
    let places = index * channel.components..(index + 1) * channel.components;
    if channel.display == Display::Color {
        let bytes = color(channel, places);
        match kind {
            Type::Packed => row.extend(packed(bytes, channel.is_transparent())),
            _ => row.extend(&bytes[..channel.components]),
        }
        return;
    }
    for place in places {
        match (&channel.data, kind) {
            (Data::Float64(values), Type::Float64) => row.extend(values[place].to_le_bytes()),
            (Data::Float64(values), _) => row.extend(single(values[place]).to_le_bytes()),
            (Data::Float32(values), _) => row.extend(values[place].to_le_bytes()),
            (Data::Int32(values), _) => row.extend(values[place].to_le_bytes()),
            (Data::Bool(values), _) => row.push(u8::from(values[place])),
        }
    }
}

/// Red, green, blue and alpha, as the bytes of a PNG.
fn color(channel: &Channel, mut places: Range<usize>) -> [u8; 4] {
    let mut color = [0.0; 4];
    color.fill_with(|| places.next().map_or(1.0, |place| channel.data.value(place)));
    unpremultiplied(color, |color| color.map(|level| srgb().byte(level)))
}

/// Blue, green and red, and alpha where there is one: the bytes of the number `0xAARRGGBB`.
fn packed([red, green, blue, alpha]: [u8; 4], is_transparent: bool) -> [u8; 4] {
    [blue, green, red, if is_transparent { alpha } else { 0 }]
}

/// The metadata as lines of comments, each of `mark`, the key and a piece of the JSON.
pub(super) fn comments(content: &Content<'_>, mark: &str) -> String {
    let text = content.metadata.to_json();
    // It is ASCII, so that no piece ends within a character.
    let pieces = text.as_bytes().chunks(LINE).map(String::from_utf8_lossy);
    let lines = pieces.map(|piece| format!("{mark} {KEY} {piece}\n"));
    lines.collect()
}

/// Whether a file begins as the point clouds do that firsthit writes. A PLY may also be a mesh.
pub fn is_point_cloud(path: &Path) -> bool {
    let mut start = Vec::new();
    let is_file = path.metadata().is_ok_and(|there| there.is_file());
    let read = is_file.then(|| File::open(path)?.take(128).read_to_end(&mut start));
    read.is_some_and(|read| read.is_ok())
        && [super::ply::MARK, super::pcd::MARK].iter().any(|mark| {
            let text = start.strip_prefix(mark.as_bytes());
            let own = format!("{KEY} ");
            text.is_some_and(|text| text.starts_with(own.as_bytes()))
        })
}
