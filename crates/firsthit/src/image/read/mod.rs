//! Outputs read back: our own, and what other programs make of the same formats.
//!
//! A file is bytes from a stranger here too: what it claims is compared with what it holds before anything is
//! made from it.

// A reader that panics is a reader that a file can crash.
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::indexing_slicing
    )
)]

#[cfg(feature = "exr")]
pub(super) mod exr;
#[cfg(feature = "npy")]
pub(super) mod npy;
#[cfg(feature = "npy")]
mod npy_header;
#[cfg(feature = "npy")]
pub(super) mod npz;
#[cfg(feature = "png")]
pub(super) mod png;

#[cfg(feature = "npy")]
pub use npy_header::{NpyHeader, NpyValues};

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use super::file::sidecar_of;
use super::{Encoding, Metadata, format_of};
use crate::error::{Error, Place, Result};

/// What the numbers of one file may take in memory, in bytes, where nobody says: 16,384 squared pixels of four
/// channels.
const MOST_BYTES: u64 = 1 << 32;

/// Metadata are short; a sidecar that is longer is none.
const LONGEST_METADATA: u64 = 1 << 24;

/// What a file holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Output {
    /// The channels, as numbers. Those of ours have the values that were written, misses included.
    pub arrays: Vec<Array>,
    /// What the file says about itself; `None` for a file of another program.
    pub metadata: Option<Metadata>,
    /// What is doubtful about it: a line each.
    pub notes: Vec<String>,
}

/// The numbers of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// The channel's name; `None` where the file does not tell it.
    pub name: Option<String>,
    /// `[rows, columns]`, or `[n]`; then the components, if there are several.
    pub shape: Vec<usize>,
    /// How many numbers each element has.
    pub components: usize,
    /// The numbers, row by row.
    pub numbers: Numbers,
    /// The NumPy name of the type in the file.
    pub dtype: String,
    /// Whether they are bytes to look at, not values.
    pub is_picture: bool,
}

/// Numbers of any type, in one that holds them exactly.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    /// Double precision.
    Float64(Vec<f64>),
    /// Single precision, or half.
    Float32(Vec<f32>),
    /// Whole numbers, and truth values as 0 and 1.
    Integer(Vec<i64>),
}

impl Output {
    /// The channel of that name.
    pub fn array(&self, name: &str) -> Option<&Array> {
        (self.arrays.iter()).find(|array| array.name.as_deref() == Some(name))
    }
}

impl Numbers {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Float64(values) => values.len(),
            Self::Float32(values) => values.len(),
            Self::Integer(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Reads an output: a file in one of [`FORMATS`](super::FORMATS), which its extension tells.
///
/// # Errors
///
/// [`Error::Argument`] for an extension that no format has, [`Error::Read`] if the system refuses,
/// [`Error::Parse`] for content that is no such file, that is damaged, or that would take more than 4 GiB.
pub fn read(path: &Path) -> Result<Output> {
    // A folder is refused as such, before its extension is.
    if path.is_dir() {
        return Err(Error::Read {
            path: path.to_owned(),
            source: io::Error::new(io::ErrorKind::InvalidInput, "a folder, not a file"),
        });
    }
    let format = format_of(path)?;
    let bytes = regular_file(path, MOST_BYTES)?;
    let mut output = (format.decode)(&bytes, MOST_BYTES).map_err(|what| wrong(path, what))?;
    if format.has_sidecar {
        read_sidecar(path, &mut output)?;
    }
    Ok(output)
}

/// The same from a file's content. `name` is what messages call it; its extension tells the format. The numbers
/// may take `max_memory` bytes.
///
/// # Errors
///
/// Those of [`read`], but for [`Error::Read`].
pub fn read_bytes(name: &Path, bytes: &[u8], max_memory: u64) -> Result<Output> {
    let format = format_of(name)?;
    (format.decode)(bytes, max_memory).map_err(|what| wrong(name, what))
}

fn wrong(path: &Path, what: String) -> Error {
    Error::Parse {
        path: path.to_owned(),
        place: Place::File,
        what,
    }
}

fn read_sidecar(path: &Path, output: &mut Output) -> Result<()> {
    let beside = sidecar_of(path);
    if !beside.exists() {
        return Ok(());
    }
    let bytes = regular_file(&beside, LONGEST_METADATA)?;
    let text = String::from_utf8(bytes).map_err(|_| wrong(&beside, "not UTF-8".to_owned()))?;
    let metadata = Metadata::from_json(&text).map_err(|what| wrong(&beside, what))?;
    let [array] = output.arrays.as_mut_slice() else {
        return Ok(());
    };
    // Somebody may have replaced the array alone.
    match metadata.channels.as_slice() {
        [channel] if fits(array, &metadata.shape, channel.components, &channel.dtype) => {
            array.name = Some(channel.name.clone());
            array.components = usize::try_from(channel.components).unwrap_or(1);
            output.metadata = Some(metadata);
        }
        _ => output.notes.push(format!(
            "{} belongs to another array: its shape or its type is not this one's",
            crate::error::escaped(&beside)
        )),
    }
    Ok(())
}

/// Whether an array is the one that metadata speak of.
fn fits(array: &Array, shape: &[u64], components: u64, dtype: &str) -> bool {
    let mut expected = shape.to_vec();
    if components > 1 {
        expected.push(components);
    }
    let shape = array.shape.iter().map(|&side| side as u64);
    array.dtype == dtype && shape.eq(expected)
}

/// The metadata of a file as its text; those that cannot be read are a note, not an error: the numbers are
/// there all the same.
fn metadata_of(text: Option<&str>, notes: &mut Vec<String>) -> Option<Metadata> {
    match Metadata::from_json(text?) {
        Ok(metadata) => Some(metadata),
        Err(what) => {
            notes.push(crate::error::escape_controls(&what));
            None
        }
    }
}

/// The channel of `metadata` that a file with one channel holds, and how it is stored.
fn only_channel(metadata: Option<&Metadata>) -> Option<(&str, Encoding, Option<f64>)> {
    let [channel] = metadata?.channels.as_slice() else {
        return None;
    };
    let stored = channel.stored.as_ref()?;
    Some((&channel.name, stored.encoding, stored.scale))
}

/// How many elements an array has, if its numbers fit into memory.
fn elements(shape: &[u64], bytes_each: u64, most: u64) -> std::result::Result<usize, String> {
    let count = shape.iter().try_fold(1_u64, |n, &side| n.checked_mul(side));
    let fits = |count: &u64| count.checked_mul(bytes_each).is_some_and(|n| n <= most);
    (count.filter(fits))
        .and_then(|count| usize::try_from(count).ok())
        .ok_or_else(|| format!("{shape:?} numbers are over the limit of {most} bytes"))
}

/// `values` in memory, if there is room for `count` of them.
fn collected<T>(
    count: usize,
    values: impl Iterator<Item = T>,
) -> std::result::Result<Vec<T>, String> {
    let mut all = Vec::new();
    all.try_reserve_exact(count)
        .map_err(|_| format!("no memory is free for its {count} numbers"))?;
    all.extend(values.take(count));
    Ok(all)
}

/// The whole content of a regular file. Devices and pipes, which may never end, are refused.
fn regular_file(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let refuse = |source| Error::Read {
        path: path.to_owned(),
        source,
    };
    // Asked before opening: to open a pipe waits for its other end.
    let there = fs::metadata(path).map_err(refuse)?;
    if !there.is_file() {
        let what = if there.is_dir() {
            "a folder, not a file"
        } else {
            "a device or a pipe, not a regular file"
        };
        return Err(refuse(io::Error::new(io::ErrorKind::InvalidInput, what)));
    }
    if there.len() > limit {
        return Err(wrong(path, format!("is over the limit of {limit} bytes")));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(refuse)?;
    file.take(limit).read_to_end(&mut bytes).map_err(refuse)?;
    Ok(bytes)
}
