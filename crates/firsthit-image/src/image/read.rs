//! Reads outputs back: our own, and other programs' files in the same formats.

// A reader that panics is a reader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use super::decode::output::{Array, Output};
use super::file::sidecar_of;
use super::format::format_of;
use super::metadata::Metadata;
use crate::error::{Error, Place, Result};
use crate::inputs;

/// The default limit of memory for the numbers of one file, in bytes: 16,384 squared pixels of four
/// channels.
pub(super) const MOST_BYTES: u64 = 1 << 32;

/// Metadata are short; a sidecar that is longer is none.
pub(super) const LONGEST_METADATA: u64 = 1 << 24;

/// Reads an output: a file in one of [`FORMATS`](super::FORMATS), which its extension tells. It may
/// be written over: who takes it for an input tells [`inputs`].
///
/// # Errors
///
/// [`Error::Argument`] for an extension that no format has, [`Error::Read`] if the system refuses,
/// [`Error::Parse`] for content that is no such file, that is damaged, or that would take more than
/// 4 GiB.
pub fn read(path: &Path) -> Result<Output> {
    // A folder is refused as such, before its extension is.
    if path.is_dir() {
        return Err(Error::Read {
            path: path.to_owned(),
            source: io::Error::new(io::ErrorKind::InvalidInput, "a folder, not a file"),
        });
    }
    let format = format_of(path)?;
    let bytes = regular(path, MOST_BYTES)?;
    let mut output = (format.decode)(&bytes, MOST_BYTES).map_err(|what| wrong(path, what))?;
    if format.has_sidecar {
        read_sidecar(path, &mut output)?;
    }
    Ok(output)
}

/// Reads an output from a file's content. `name` is the file's name in messages; its extension
/// tells the format. The numbers may take `max_memory` bytes.
///
/// # Errors
///
/// The errors of [`read`], but for [`Error::Read`].
pub fn read_bytes(name: &Path, bytes: &[u8], max_memory: u64) -> Result<Output> {
    let format = format_of(name)?;
    (format.decode)(bytes, max_memory).map_err(|what| wrong(name, what))
}

pub(super) fn wrong(path: &Path, what: String) -> Error {
    Error::Parse { path: path.to_owned(), place: Place::File, what }
}

fn read_sidecar(path: &Path, output: &mut Output) -> Result<()> {
    let beside = sidecar_of(path);
    if !beside.exists() {
        return Ok(());
    }
    let bytes = regular(&beside, LONGEST_METADATA)?;
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

/// The whole content of a regular file of at most `limit` bytes, which is then an [input](inputs).
/// Devices and pipes, which may never end, are refused.
///
/// # Errors
///
/// [`Error::Read`] if the system refuses or it is no regular file, [`Error::Parse`] for a longer
/// one.
pub fn read_regular(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let bytes = regular(path, limit)?;
    inputs::note(path);
    Ok(bytes)
}

fn regular(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let refuse = |source| Error::Read { path: path.to_owned(), source };
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
