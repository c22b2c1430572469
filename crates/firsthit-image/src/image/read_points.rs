//! Reads points: clouds of any format, and our own outputs with positions.

// A reader that panics is a reader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

use std::path::Path;

#[cfg(feature = "exr")]
use super::decode::exr;
use super::decode::output::{Array, ArrayValues, Output};
use super::decode::points;
#[cfg(feature = "npy")]
use super::decode::{npy, npz};
use super::read::{MOST_BYTES, read_regular, wrong};
use crate::error::Result;

/// The names of the array that has the coordinates, in outputs of ours and in archives of other
/// programs.
const POSITIONS: [&str; 5] = ["points", "position", "point", "positions", "xyz"];

/// The names of three arrays that have them.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The most bytes of numbers that a byte of LAZ stands for, in what scanners write.
const MOST_UNPACKED: u64 = 64;

/// Points with whatever else their file says of each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// The positions, in the order of the file. Those of rays that met nothing are not finite.
    pub positions: Vec<[f64; 3]>,
    /// Further numbers of each point: arrays of `[n]` or of `[n, components]`.
    pub columns: Vec<Array>,
    /// The doubts about the file: a line each.
    pub notes: Vec<String>,
}

/// Reads points from a file, which its first bytes tell the format of: PLY (of a mesh the
/// vertices), PCD, LAS, LAZ, NPY of the shape (n, 3), NPZ and EXR with an array `points` or a
/// channel `position`, or text. The file is then an [input](crate::inputs).
///
/// Text has a line for each point, with commas, semicolons, tabs or blanks between its numbers. The
/// first line may have the names of the columns, of which x, y and z are the coordinates; without
/// names the first three are. Lines with #, // or % before them are comments.
///
/// # Errors
///
/// [`Error::Read`](crate::error::Error::Read) if the system refuses, and
/// [`Error::Parse`](crate::error::Error::Parse) for content that is no such file, or that would
/// take more memory than there is.
pub fn read_points(path: &Path) -> Result<Points> {
    let bytes = read_regular(path, u64::MAX)?;
    points_of(path, &bytes)
}

/// Reads points from a file's content. `name` is its name in messages.
///
/// # Errors
///
/// The errors of [`read_points`], but for [`Error::Read`](crate::error::Error::Read).
pub fn points_of(name: &Path, bytes: &[u8]) -> Result<Points> {
    decoded(bytes).map_err(|what| wrong(name, what))
}

fn decoded(bytes: &[u8]) -> std::result::Result<Points, String> {
    // Points that are not packed are as large in memory as their file, or eight times where the
    // numbers are bytes.
    let most = MOST_BYTES.max((bytes.len() as u64).saturating_mul(8));
    let is_pcd = ["# .PCD", "VERSION", "FIELDS"];
    let output = if bytes.starts_with(b"ply") {
        points::vertices(bytes, most)?
    } else if bytes.starts_with(b"LASF") {
        points::las(bytes, most.max((bytes.len() as u64).saturating_mul(MOST_UNPACKED)))?
    } else if is_pcd.iter().any(|mark| bytes.starts_with(mark.as_bytes())) {
        points::pcd(bytes, most)?
    } else if let Some(output) = array(bytes, most) {
        output?
    } else {
        points::text(bytes)?
    };
    of_output(output)
}

/// The arrays of NumPy and `OpenEXR`.
fn array(bytes: &[u8], most: u64) -> Option<std::result::Result<Output, String>> {
    match bytes {
        #[cfg(feature = "npy")]
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => Some(npy::decode(bytes, most)),
        #[cfg(feature = "npy")]
        [b'P', b'K', ..] => Some(npz::decode(bytes, most)),
        #[cfg(feature = "exr")]
        [0x76, 0x2f, 0x31, 0x01, ..] => Some(exr::decode(bytes, most)),
        _ => None,
    }
}

/// Takes the coordinates out of a file's arrays.
fn of_output(output: Output) -> std::result::Result<Points, String> {
    let Output { mut arrays, notes, .. } = output;
    let named = |arrays: &[Array], wanted: &str| {
        let is_it = |array: &Array| array.name.as_deref() == Some(wanted);
        arrays.iter().position(is_it)
    };
    let alone = (arrays.len() == 1 && arrays.iter().all(|array| array.name.is_none())).then_some(0);
    let place = POSITIONS.iter().find_map(|name| named(&arrays, name));
    let (shape, positions) = if let Some(place) = place.or(alone) {
        let array = arrays.remove(place);
        let Some((&3, shape)) = array.shape.split_last() else {
            let shape = &array.shape;
            return Err(format!("points must be an array of the shape (n, 3), got {shape:?}"));
        };
        let numbers = floats(&array)?;
        (shape.to_vec(), numbers.as_chunks().0.to_vec())
    } else if let [Some(x), Some(y), Some(z)] = AXES.map(|axis| named(&arrays, axis)) {
        let axis = |place: usize| match arrays.get(place) {
            Some(array) => floats(array).map(|values| (array.shape.clone(), values)),
            None => Ok((Vec::new(), Vec::new())),
        };
        let ((shape, x), (of_y, y), (of_z, z)) = (axis(x)?, axis(y)?, axis(z)?);
        if shape != of_y || shape != of_z {
            return Err("x, y and z are arrays of different shapes".to_owned());
        }
        arrays.retain(|array| !AXES.iter().any(|axis| array.name.as_deref() == Some(axis)));
        let points = x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]);
        (shape, points.collect())
    } else {
        let names: Vec<String> = (arrays.iter())
            .map(|array| crate::error::escape_controls(array.name.as_deref().unwrap_or("an array")))
            .take(20)
            .collect();
        let expected = "expected an array points or position, or columns x, y and z";
        return Err(format!("{expected}, got {}", names.join(", ")));
    };
    let columns = arrays.into_iter().filter_map(|array| column(array, &shape));
    Ok(Points { positions, columns: columns.collect(), notes })
}

/// An array as a column of points of this shape, if it has as many elements.
fn column(array: Array, shape: &[usize]) -> Option<Array> {
    let components = match array.shape.strip_prefix(shape)? {
        [] => 1,
        &[components] if components > 0 => components,
        _ => return None,
    };
    let count: usize = shape.iter().product();
    let shape = match components {
        1 => vec![count],
        _ => vec![count, components],
    };
    array.name.is_some().then_some(Array { shape, components, ..array })
}

fn floats(array: &Array) -> std::result::Result<Vec<f64>, String> {
    if array.dtype == "bool" {
        return Err("expected floats (32 or 64 bit) or integers, got bool".to_owned());
    }
    let mut floats = Vec::new();
    (floats.try_reserve_exact(array.numbers.len()))
        .map_err(|_| "no memory is free for its points")?;
    match &array.numbers {
        ArrayValues::Float64(values) => floats.extend(values),
        ArrayValues::Float32(values) => floats.extend(values.iter().copied().map(f64::from)),
        ArrayValues::Integer(values) => floats.extend(values.iter().map(|&value| value as f64)),
    }
    Ok(floats)
}
