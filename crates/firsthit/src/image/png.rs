use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder, SrgbRenderingIntent};

use super::Channel;
use super::colormap::ColorMap;
use crate::error::{Error, Result};

/// The longest side that a PNG can have.
const LONGEST: usize = (1 << 31) - 1;

/// How many bytes an IDAT chunk has. Fixed, like the compression, so that the file is the same everywhere.
const CHUNK: usize = 1 << 16;

/// Refuses what is no picture.
pub(super) fn check(shape: &[usize], _channels: &[&Channel]) -> Result<()> {
    match shape {
        [rows, columns] if (1..=LONGEST).contains(rows) && (1..=LONGEST).contains(columns) => {
            Ok(())
        }
        _ => {
            let expected = "[rows, columns], each from 1 to 2^31 - 1, for a PNG";
            Err(Error::argument("shape", expected, format!("{shape:?}")))
        }
    }
}

/// Writes one channel as 8 bit RGB, row by row: no second picture is held in memory.
pub(super) fn encode(
    shape: &[usize],
    channels: &[&Channel],
    out: &mut dyn Write,
) -> io::Result<()> {
    let (&[rows, columns], &[channel]) = (shape, channels) else {
        return Err(io::Error::other("not a picture of one channel"));
    };
    let mut writer = header(rows, columns, out)?;
    let mut writer = writer.stream_writer_with_size(CHUNK)?;
    let map = ColorMap::of(channel);
    let mut values = Vec::with_capacity(columns * channel.components);
    let mut bytes = vec![0; columns * 3];
    for row in 0..rows {
        let start = row * columns * channel.components;
        let end = start + columns * channel.components;
        values.clear();
        values.extend((start..end).map(|index| channel.data.value(index)));
        map.apply(&values, channel.components, &mut bytes);
        writer.write_all(&bytes)?;
    }
    writer.finish()?;
    Ok(())
}

fn header(
    rows: usize,
    columns: usize,
    out: &mut dyn Write,
) -> io::Result<png::Writer<&mut dyn Write>> {
    let side = |pixels: usize| u32::try_from(pixels).map_err(io::Error::other);
    let mut encoder = Encoder::new(out, side(columns)?, side(rows)?);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.set_compression(Compression::Fast);
    Ok(encoder.write_header()?)
}
