//! Distances as whole numbers of steps, in 16 bits: what depth cameras write.

use std::io::{self, Write};

use super::content::pixel;
use super::frame::Channel;
use crate::error::{Error, Result};

/// The largest number of steps.
const MOST: f64 = 65_535.0;

/// Refuses distances that are not 1 to 65535 steps of `scale`, misses aside: nothing is saturated, and no hit
/// becomes the 0 of a miss.
pub(super) fn check(channel: &Channel, scale: f64, shape: &[usize]) -> Result<()> {
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(Error::argument("png_scale", "positive and finite", scale));
    }
    let (mut nearest, mut farthest) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
    for index in 0..channel.data.len() {
        let distance = channel.data.value(index);
        if distance.is_nan() {
            let got = format!("NaN at {}", pixel(index, shape));
            return Err(Error::argument(
                channel.argument(),
                "a distance, for a 16 bit PNG",
                got,
            ));
        }
        if distance < nearest.0 {
            nearest = (distance, index);
        }
        if distance < f64::INFINITY && distance > farthest.0 {
            farthest = (distance, index);
        }
    }
    let (distance, index) = farthest;
    if steps(distance, scale) > MOST {
        let got = format!(
            "{scale}: {} is {distance} at {}; a scale of {} fits",
            channel.name,
            pixel(index, shape),
            fitting(distance)
        );
        let expected = "so large that 65535 steps reach the farthest hit";
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
    format!("{hundredths}e{exponent}")
        .parse()
        .unwrap_or(distance)
}

/// Writes what was checked, row by row, big-endian as PNG has it.
pub(super) fn encode(
    channel: &Channel,
    scale: f64,
    columns: usize,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(columns * 2);
    for start in (0..channel.data.len()).step_by(columns) {
        bytes.clear();
        for index in start..start + columns {
            let distance = channel.data.value(index);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a whole number from 1 to 65535, as `check` saw"
            )]
            let steps = if distance == f64::INFINITY {
                0
            } else {
                steps(distance, scale) as u16
            };
            bytes.extend(steps.to_be_bytes());
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}
