//! Distances as whole numbers of steps, in 16 bits: what depth cameras write. And identifiers as
//! their numbers plus one.

use std::io::{self, Write};

use super::content::{Far, pixel};
use super::frame::{Channel, Data};
use crate::error::{Error, Result};

/// The largest number of steps.
const MOST: f64 = 65_535.0;

/// Refuses distances that are not 1 to 65535 steps of `scale`, misses aside: nothing is saturated,
/// and no hit becomes the 0 of a miss, unless `far` says what becomes of those beyond.
pub(super) fn check(
    channel: &Channel,
    scale: f64,
    far: Option<Far>,
    shape: &[usize],
) -> Result<()> {
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(Error::argument("png_scale", "positive and finite", scale));
    }
    let (mut nearest, mut farthest) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
    for index in 0..channel.data.len() {
        let distance = channel.data.value(index);
        if distance.is_nan() {
            let got = format!("NaN at {}", pixel(index, shape));
            return Err(Error::argument(channel.argument(), "a distance, for a 16 bit PNG", got));
        }
        if distance < nearest.0 {
            nearest = (distance, index);
        }
        if distance < f64::INFINITY && distance > farthest.0 {
            farthest = (distance, index);
        }
    }
    let (distance, index) = farthest;
    if far.is_none() && steps(distance, scale) > MOST {
        let got = format!(
            "{scale}: {} is {distance} at {}; a scale of {} fits",
            channel.name,
            pixel(index, shape),
            fitting(distance)
        );
        let expected = "so large that 65535 steps reach the farthest hit, unless `far` is given";
        return Err(Error::argument("png_scale", expected, got));
    }
    let (distance, index) = nearest;
    if distance < f64::INFINITY && steps(distance, scale) < 1.0 {
        let got = format!(
            "{scale}: {} is {distance} at {}, less than half a step, and 0 is a miss",
            channel.name,
            pixel(index, shape),
        );
        let expected = "so small that the nearest hit is a step or more";
        return Err(Error::argument("png_scale", expected, got));
    }
    Ok(())
}

/// Rounded to nearest, halves up.
fn steps(distance: f64, scale: f64) -> f64 {
    (distance / scale + 0.5).floor()
}

/// A scale with which `distance` fits: three digits, rounded up.
fn fitting(distance: f64) -> f64 {
    let text = format!("{:.2e}", distance / MOST);
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let hundredths = digits.replace('.', "").parse::<u32>().unwrap_or(0) + 1;
    let exponent = exponent.parse::<i32>().unwrap_or(0) - 2;
    // By way of text, because a power of ten is no number of float64.
    format!("{hundredths}e{exponent}").parse().unwrap_or(distance)
}

/// Writes what was checked.
pub(super) fn encode(
    channel: &Channel,
    scale: f64,
    far: Option<Far>,
    columns: usize,
    out: &mut dyn Write,
) -> io::Result<()> {
    rows(channel, columns, out, |distance| {
        if distance == f64::INFINITY {
            return 0;
        }
        let steps = steps(distance, scale);
        match far {
            Some(far) if steps > MOST => far.steps(),
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a whole number from 1 to 65535, as `check` saw"
            )]
            _ => steps as u16,
        }
    })
}

/// Refuses identifiers that, plus one, do not fit.
pub(super) fn check_labels(channel: &Channel, shape: &[usize]) -> Result<()> {
    let Data::Int32(identifiers) = &channel.data else {
        let expected = "a channel of identifiers, for labels in a 16 bit PNG";
        return Err(Error::argument("channel", expected, &*channel.name));
    };
    let is_beyond = |identifier: &i32| f64::from(*identifier) >= MOST;
    match identifiers.iter().position(is_beyond) {
        None => Ok(()),
        Some(index) => {
            let (number, place) = (identifiers[index], pixel(index, shape));
            let got = format!("{number} at {place}");
            let expected = "identifiers up to 65534, for labels in a 16 bit PNG";
            Err(Error::argument(channel.argument(), expected, got))
        }
    }
}

/// Writes identifiers that were checked, each plus one; misses are 0.
pub(super) fn encode_labels(
    channel: &Channel,
    columns: usize,
    out: &mut dyn Write,
) -> io::Result<()> {
    rows(channel, columns, out, |identifier| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number from 0 to 65535, as `check_labels` saw"
        )]
        let label = (identifier + 1.0).max(0.0) as u16;
        label
    })
}

/// Writes a number for each value, row by row, big-endian as PNG has it.
fn rows(
    channel: &Channel,
    columns: usize,
    out: &mut dyn Write,
    number: impl Fn(f64) -> u16,
) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(columns * 2);
    for start in (0..channel.data.len()).step_by(columns) {
        bytes.clear();
        for index in start..start + columns {
            bytes.extend(number(channel.data.value(index)).to_be_bytes());
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}
