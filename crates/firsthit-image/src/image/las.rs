//! Scans as LAS 1.4, in points of format 6, and packed as LAZ:
//! <https://www.asprs.org/wp-content/uploads/2019/07/LAS_1_4_r15.pdf>.
//!
//! 1. Coordinates are steps from the lowest corner, of 1e-4 scene units or of ten times as much
//!    until they reach.
//! 2. Fields that the format has no place for are in extra bytes behind each point.
//! 3. The metadata are a record behind the points, where it may be longer than 64 KiB, as that of a
//!    long drive is.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "what LAS holds is within what its types hold"
)]

use std::io::Cursor;

use ::laz::laszip::LazItemRecordBuilder;
use ::laz::{LasZipCompressor, LazVlr};

use super::frame::{Channel, Data, Frame};
use super::metadata::KEY;
use crate::error::{Error, Result};
use crate::geometry::single;

/// The bytes of the header, and of the description of a column of extra bytes.
const HEADER: u32 = 375;
const DESCRIPTION: u16 = 192;

/// The point format, and the bytes of its points.
const FORMAT: u8 = 6;
const POINT: u16 = 30;

/// The bit of the format that says that points are packed.
const PACKED: u8 = 1 << 7;

/// The bit that says that coordinate systems, of which there is none, are in WKT: format 6 asks for
/// it.
const WKT: u16 = 1 << 4;

/// The most returns of a pulse that four bits hold.
const MOST_RETURNS: i32 = 15;

/// The columns behind each point: the name, the number of the type in LAS, the bytes, and the
/// meaning.
const EXTRA: [(&str, u8, u16, &str); 6] = [
    ("range", 10, 8, "distance along the beam"),
    ("incidence", 9, 4, "angle to the normal, rad"),
    ("object", 6, 4, "identifier of the object"),
    ("ring", 6, 4, "number of the laser"),
    ("row", 6, 4, "row of the beam"),
    ("column", 6, 4, "column of the beam"),
];

/// The place of points in a file: the length of a step, and where steps begin.
struct Steps {
    scale: f64,
    offset: [f64; 3],
}

/// The lowest and the highest corner of a box.
type Corners = [[f64; 3]; 2];

/// The bytes of a file of a scan.
pub(super) fn encode(frame: &Frame, is_packed: bool) -> Result<Vec<u8>> {
    let (points, _) = doubles(frame, "point")?.as_chunks::<3>();
    let steps = Steps::over(corners(points.iter().copied()))?;
    let (rows, bounds) = rows(frame, points, &steps)?;
    let how = is_packed.then(|| {
        let items = LazItemRecordBuilder::default_for_point_format_id(FORMAT, extra_bytes());
        LazVlr::from_laz_items(items.expect("LASzip knows format 6"))
    });
    let mut records = vlr("LASF_Spec", 4, &EXTRA.map(described).concat(), KEY);
    if let Some(how) = &how {
        let mut packing = Vec::new();
        how.write_to(&mut packing).map_err(no_memory)?;
        records.extend(vlr("laszip encoded", 22204, &packing, "firsthit"));
    }
    let start = HEADER + u32::try_from(records.len()).unwrap_or(u32::MAX);
    let mut file = Cursor::new(Vec::new());
    let out = file.get_mut();
    out.resize(HEADER as usize, 0);
    out.extend(records);
    match how {
        None => out.extend(rows),
        Some(how) => {
            file.set_position(start.into());
            let mut packer = LasZipCompressor::new(&mut file, how).map_err(no_memory)?;
            packer.compress_many(&rows).map_err(no_memory)?;
            packer.done().map_err(no_memory)?;
        }
    }
    let mut out = file.into_inner();
    let end = out.len() as u64;
    let said = frame.metadata().to_json();
    out.extend(record_header::<8>(KEY, 1, said.len() as u64, "metadata, JSON"));
    out.extend(said.bytes());
    let header = header(frame, [u64::from(start), end], is_packed, &steps, bounds)?;
    out[..HEADER as usize].copy_from_slice(&header);
    Ok(out)
}

/// The header of a file whose points begin and end at `places`.
fn header(
    frame: &Frame,
    [start, end]: [u64; 2],
    is_packed: bool,
    steps: &Steps,
    [low, high]: Corners,
) -> Result<Vec<u8>> {
    let mut head = Vec::new();
    head.extend(b"LASF");
    head.extend([0, WKT].map(u16::to_le_bytes).concat());
    head.extend([0; 16]);
    head.extend([1, 4]);
    head.extend(padded::<32>("firsthit"));
    head.extend(padded::<32>(concat!("firsthit ", env!("CARGO_PKG_VERSION"))));
    // There is no day: the same scan has the same bytes.
    head.extend([0; 4]);
    head.extend((HEADER as u16).to_le_bytes());
    let records = 1 + u32::from(is_packed);
    head.extend([start as u32, records].map(u32::to_le_bytes).concat());
    head.push(if is_packed { FORMAT | PACKED } else { FORMAT });
    head.extend((POINT + extra_bytes()).to_le_bytes());
    // Counts of 32 bits, which format 6 leaves at 0.
    head.extend([0; 24]);
    head.extend([steps.scale; 3].map(f64::to_le_bytes).concat());
    head.extend(steps.offset.map(f64::to_le_bytes).concat());
    for (high, low) in high.into_iter().zip(low) {
        head.extend([high, low].map(f64::to_le_bytes).concat());
    }
    head.extend([0, end].map(u64::to_le_bytes).concat());
    head.extend(1_u32.to_le_bytes());
    let count: usize = frame.shape().iter().product();
    head.extend((count as u64).to_le_bytes());
    head.extend(by_return(frame)?.map(u64::to_le_bytes).concat());
    Ok(head)
}

/// The number of bytes behind a point.
fn extra_bytes() -> u16 {
    EXTRA.iter().map(|column| column.2).sum()
}

/// The points, one after the other, and the corners of what they are as steps.
fn rows(frame: &Frame, points: &[[f64; 3]], steps: &Steps) -> Result<(Vec<u8>, Corners)> {
    let [times, ranges, incidences] =
        ["time", "range", "incidence"].map(|name| doubles(frame, name));
    let (times, ranges, incidences) = (times?, ranges?, incidences?);
    let [numbers, totals] =
        ["return_number", "number_of_returns"].map(|name| integers(frame, name));
    let (numbers, totals) = (numbers?, totals?);
    let identifiers = EXTRA[2..].iter().map(|column| integers(frame, column.0));
    let identifiers = identifiers.collect::<Result<Vec<&[i32]>>>()?;
    let intensities = optional(frame, "intensity", doubles)?;
    let classes = optional(frame, "classification", integers)?;
    let mut rows = Vec::new();
    let stored = points.iter().enumerate().map(|(k, point)| {
        let at: [f64; 3] = std::array::from_fn(|axis| steps.of(axis, point[axis]));
        rows.extend(at.map(|steps| (steps as i32).to_le_bytes()).concat());
        let intensity = intensities.map_or(0.0, |values| values[k].clamp(0.0, 1.0) * 65535.0);
        rows.extend((intensity.round_ties_even() as u16).to_le_bytes());
        let class = classes.map_or(0, |values| values[k] as u8);
        rows.extend([told(numbers[k]) | told(totals[k]) << 4, 0, class, 0, 0, 0, 0, 0]);
        rows.extend([times[k], ranges[k]].map(f64::to_le_bytes).concat());
        rows.extend(single(incidences[k]).to_le_bytes());
        rows.extend(identifiers.iter().flat_map(|values| values[k].to_le_bytes()));
        std::array::from_fn(|axis| at[axis] * steps.scale + steps.offset[axis])
    });
    let bounds = corners(stored);
    Ok((rows, bounds))
}

impl Steps {
    /// Steps that reach over a box.
    fn over([low, high]: Corners) -> Result<Self> {
        let offset = low.map(f64::floor);
        let extent = (0..3).map(|axis| high[axis] - offset[axis]).fold(0.0, f64::max);
        let scales = (-4..12).filter_map(|exponent| format!("1e{exponent}").parse().ok());
        let scale = { scales }.find(|scale: &f64| extent / scale < f64::from(i32::MAX));
        let scale = scale.ok_or_else(|| Error::argument("point", "within 1e20 for LAS", extent))?;
        Ok(Self { scale, offset })
    }

    fn of(&self, axis: usize, x: f64) -> f64 {
        ((x - self.offset[axis]) / self.scale).round_ties_even()
    }
}

/// The corners of the box around points; of none the origin.
fn corners(mut points: impl Iterator<Item = [f64; 3]>) -> Corners {
    let Some(first) = points.next() else {
        return [[0.0; 3]; 2];
    };
    points.fold([first; 2], |[low, high], point| {
        let axes =
            |of: fn(f64, f64) -> f64, end: [f64; 3]| std::array::from_fn(|k| of(end[k], point[k]));
        [axes(f64::min, low), axes(f64::max, high)]
    })
}

/// A number of returns; what LAS cannot count is the last that it can.
fn told(number: i32) -> u8 {
    number.clamp(0, MOST_RETURNS) as u8
}

/// The number of points of each number of return.
fn by_return(frame: &Frame) -> Result<[u64; MOST_RETURNS as usize]> {
    let mut counts = [0; MOST_RETURNS as usize];
    for &number in integers(frame, "return_number")? {
        if let Some(place) = told(number).checked_sub(1) {
            counts[usize::from(place)] += 1;
        }
    }
    Ok(counts)
}

fn channel<'a>(frame: &'a Frame, name: &str) -> Result<&'a Channel> {
    let missing = || Error::argument("channel", "among those of a scan", name);
    frame.channel(name).ok_or_else(missing)
}

fn doubles<'a>(frame: &'a Frame, name: &str) -> Result<&'a [f64]> {
    match &channel(frame, name)?.data {
        Data::Float64(values) => Ok(values),
        other => Err(Error::argument("channel", "float64", format!("{} of {name}", other.kind()))),
    }
}

fn integers<'a>(frame: &'a Frame, name: &str) -> Result<&'a [i32]> {
    match &channel(frame, name)?.data {
        Data::Int32(values) => Ok(values),
        other => Err(Error::argument("channel", "int32", format!("{} of {name}", other.kind()))),
    }
}

/// The numbers of a channel that a scan need not have.
fn optional<'a, T>(
    frame: &'a Frame,
    name: &str,
    numbers: fn(&'a Frame, &str) -> Result<T>,
) -> Result<Option<T>> {
    let is_there = frame.channel(name).is_some();
    is_there.then(|| numbers(frame, name)).transpose()
}

/// A record before the points.
fn vlr(user: &str, number: u16, content: &[u8], about: &str) -> Vec<u8> {
    let length = content.len() as u64;
    let mut record = record_header::<2>(user, number, length, about);
    record.extend(content);
    record
}

/// The header of a record, whose length is a number of `N` bytes.
fn record_header<const N: usize>(user: &str, number: u16, length: u64, about: &str) -> Vec<u8> {
    let mut header = vec![0; 2];
    header.extend(padded::<16>(user));
    header.extend(number.to_le_bytes());
    header.extend(&length.to_le_bytes()[..N]);
    header.extend(padded::<32>(about));
    header
}

/// The description of a column of extra bytes.
fn described((name, kind, _, about): (&str, u8, u16, &str)) -> [u8; DESCRIPTION as usize] {
    let mut made = [0; DESCRIPTION as usize];
    made[2] = kind;
    made[4..36].copy_from_slice(&padded::<32>(name));
    made[160..].copy_from_slice(&padded::<32>(about));
    made
}

/// A text, with zeros behind it.
fn padded<const N: usize>(text: &str) -> [u8; N] {
    let mut made = [0; N];
    made[..text.len()].copy_from_slice(text.as_bytes());
    made
}

/// The error of `LASzip` for a file in memory.
fn no_memory(error: impl std::fmt::Display) -> Error {
    Error::Limit {
        what: "packed points",
        got: error.to_string(),
        limit: "the memory there is".into(),
    }
}
