//! Hits as CSV.

use std::io::{self, Write};
use std::ops::Range;

use firsthit::channel::ATTRIBUTE;
use firsthit::image::{Data, Frame};

use crate::failure::Failure;

/// One line for each ray, after a header; a channel of several numbers makes several columns.
pub(crate) fn write_csv(frame: &Frame, out: &mut dyn Write) -> io::Result<()> {
    write_header(frame, out)?;
    let count: usize = frame.shape().iter().product();
    write_rows(frame, 0..count, out)
}

/// Writes all lines to standard output.
pub(crate) fn stream_csv(frame: &Frame) -> Result<(), Failure> {
    let mut out = io::BufWriter::new(io::stdout().lock());
    let written = write_csv(frame, &mut out).and_then(|()| out.flush());
    written.map_err(|error| Failure::stdout(&error))
}

/// The names of the columns.
pub(crate) fn write_header(frame: &Frame, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{}", header(frame).join(","))
}

/// The lines of some rays.
pub(crate) fn write_rows(frame: &Frame, rows: Range<usize>, out: &mut dyn Write) -> io::Result<()> {
    for row in rows {
        let mut separator = "";
        for channel in frame.channels() {
            for k in row * channel.components..(row + 1) * channel.components {
                write!(out, "{separator}")?;
                match &channel.data {
                    Data::Float64(values) => write_number(values[k], out)?,
                    Data::Float32(values) => write!(out, "{}", values[k])?,
                    Data::Int32(values) => write!(out, "{}", values[k])?,
                    Data::Bool(values) => write!(out, "{}", u8::from(values[k]))?,
                }
                separator = ",";
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn header(frame: &Frame) -> Vec<String> {
    let mut header = Vec::new();
    for channel in frame.channels() {
        match (channel.components, &*channel.name) {
            (1, name) => header.push(name.to_owned()),
            (3, "barycentric") => header.extend((0..3).map(|k| format!("barycentric_{k}"))),
            (count, name) if name.starts_with(ATTRIBUTE) => {
                header.extend((0..count).map(|k| format!("{name}_{k}")));
            }
            (2, name) => header.extend(["u", "v"].map(|axis| format!("{name}_{axis}"))),
            (3, name @ "base_color") => {
                header.extend(["r", "g", "b"].map(|level| format!("{name}_{level}")));
            }
            (count, name) if count != 3 => {
                header.extend((0..count).map(|k| format!("{name}_{k}")));
            }
            (_, name) => header.extend(["x", "y", "z"].map(|axis| format!("{name}_{axis}"))),
        }
    }
    header
}

/// The shortest number that reads back as the same one.
fn write_number(number: f64, out: &mut dyn Write) -> io::Result<()> {
    if number.is_nan() {
        // As numpy has it.
        return write!(out, "nan");
    }
    let size = number.abs();
    if size != 0.0 && size.is_finite() && !(1e-5..1e16).contains(&size) {
        // Otherwise 1e-300 would have 300 zeros.
        write!(out, "{number:e}")
    } else {
        write!(out, "{number}")
    }
}
