//! The content that a format writes.

use super::frame::{Channel, Data, Display};
use super::metadata::Metadata;
use crate::error::{Error, Result};
use crate::geometry::{DisplayTransform, named, single};
use crate::watch::Watch;

/// Settings of some formats.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WriteSettings {
    /// The step of a 16 bit PNG in scene units: distances are stored as a number of steps, misses
    /// as 0. `None`: distances are stored as colours.
    pub png_scale: Option<f64>,
    /// The number of a 16 bit PNG in place of distances beyond its last step, 65535. `None`: they
    /// are an error.
    pub png_far: Option<Far>,
    /// Whether PNGs of identifiers hold their numbers, each plus one, in 16 bits, and misses as 0.
    /// Otherwise they are stored as colours.
    pub png_labels: bool,
    /// Whether an NPZ is packed, by deflate.
    pub compress: bool,
    /// The display transform of colours in a PNG. All other formats hold them as they are.
    pub display: DisplayTransform,
}

named! {
    /// The number of a 16 bit PNG in place of distances beyond its last step.
    pub enum Far, "far":
    /// The last step.
    #[default]
    "saturate" => Saturate;
    /// 0, as for a miss.
    "zero" => Zero;
}

impl Far {
    /// The number in the file.
    pub(super) fn steps(self) -> u16 {
        match self {
            Self::Saturate => u16::MAX,
            Self::Zero => 0,
        }
    }
}

/// The content of a file, checked.
pub(super) struct Content<'a> {
    pub(super) shape: &'a [usize],
    pub(super) channels: Vec<&'a Channel>,
    pub(super) settings: WriteSettings,
    pub(super) metadata: Metadata,
    /// Stops work that takes long before the first byte is written.
    pub(super) watch: &'a dyn Watch,
}

/// `[rows, columns]` of a picture, each from 1 to 2^31 - 1.
pub(super) fn picture_sides(shape: &[usize], expected: &'static str) -> Result<(usize, usize)> {
    const LONGEST: usize = (1 << 31) - 1;
    match *shape {
        [rows, columns] if (1..=LONGEST).contains(&rows) && (1..=LONGEST).contains(&columns) => {
            Ok((rows, columns))
        }
        _ => Err(Error::argument("shape", expected, format!("{shape:?}"))),
    }
}

/// Refuses mattes, for a format that would make something else of them.
#[cfg(any(feature = "png", feature = "cloud"))]
pub(super) fn refuse_mattes(content: &Content<'_>, expected: &'static str) -> Result<()> {
    let mattes = (content.channels.iter()).find(|channel| channel.display == Display::Matte);
    match mattes {
        Some(channel) => Err(Error::argument("channel", expected, &*channel.name)),
        None => Ok(()),
    }
}

/// The row and the column of an element, for messages.
pub(super) fn pixel(index: usize, shape: &[usize]) -> String {
    match shape {
        [_, columns] => format!("row {}, column {}", index / columns, index % columns),
        _ => format!("element {index}"),
    }
}

/// Refuses finite numbers that float32 would make infinite, and so a miss.
#[cfg(any(feature = "exr", feature = "cloud"))]
pub(super) fn check_float32(
    channel: &Channel,
    shape: &[usize],
    expected: &'static str,
) -> Result<()> {
    let Data::Float64(values) = &channel.data else {
        return Ok(());
    };
    let is_lost = |value: &f64| value.is_finite() && single(*value).is_infinite();
    match values.iter().position(is_lost) {
        None => Ok(()),
        Some(index) => {
            let place = pixel(index / channel.components, shape);
            let got = format!("{:?} at {place}", values[index]);
            Err(Error::argument(channel.argument(), expected, got))
        }
    }
}

/// The largest error of positions in float32, if that is more than a millionth of their largest
/// side, or than a thousandth of a unit where all are equal: so far from the origin, as in
/// coordinates of a country, float32 has too few digits.
pub(super) fn lost_in_float32(channel: &Channel) -> Option<f64> {
    let Data::Float64(values) = &channel.data else {
        return None;
    };
    if channel.display != Display::Position {
        return None;
    }
    let (mut error, mut side) = (0.0_f64, 0.0_f64);
    for axis in 0..channel.components {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let along = values.iter().skip(axis).step_by(channel.components);
        for &value in along.filter(|value| value.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
            error = error.max((value - f64::from(single(value))).abs());
        }
        side = side.max(high - low);
    }
    let bound = if side > 0.0 { 1e-6 * side } else { 1e-3 };
    (error > bound).then_some(error)
}
