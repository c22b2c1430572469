//! What a format gets to write.

use super::frame::Channel;
use super::metadata::Metadata;
use crate::error::{Error, Result};
use crate::watch::Watch;

/// What a format leaves open.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WriteSettings {
    /// What one step of a 16 bit PNG is, in scene units: distances are then stored in such steps, 0 being
    /// a miss. `None`: as pictures to look at.
    pub png_scale: Option<f64>,
}

/// What goes into a file.
pub(super) struct Content<'a> {
    pub(super) shape: &'a [usize],
    pub(super) channels: Vec<&'a Channel>,
    pub(super) settings: WriteSettings,
    pub(super) metadata: Metadata,
    /// For what takes long before the first byte is written.
    pub(super) watch: &'a dyn Watch,
}

/// `[rows, columns]` of a picture, each from 1 to what the format can say.
pub(super) fn picture_sides(shape: &[usize], expected: &'static str) -> Result<(usize, usize)> {
    const LONGEST: usize = (1 << 31) - 1;
    match *shape {
        [rows, columns] if (1..=LONGEST).contains(&rows) && (1..=LONGEST).contains(&columns) => {
            Ok((rows, columns))
        }
        _ => Err(Error::argument("shape", expected, format!("{shape:?}"))),
    }
}

/// The row and the column of an element that a message is about.
pub(super) fn pixel(index: usize, shape: &[usize]) -> String {
    match shape {
        [_, columns] => format!("row {}, column {}", index / columns, index % columns),
        _ => format!("element {index}"),
    }
}
