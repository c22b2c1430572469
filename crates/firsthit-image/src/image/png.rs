use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder, SrgbRenderingIntent};

use super::channel_colors::{ChannelColors, legend};
use super::content::{Content, WriteSettings, picture_sides, refuse_mattes};
use super::frame::{Channel, Display};
use super::metadata::{Encoding, KEY, Stored};
use super::steps;
use crate::error::{Error, Result};
use crate::geometry::{DisplayTransform, ToneMap};
use crate::parallel;

/// The number of bytes of an IDAT chunk. Fixed, like the compression, so that files are equal
/// everywhere.
const CHUNK: usize = 1 << 16;

/// The approximate number of bytes of colours that are made at a time: they stay near the cores
/// until they are packed.
const BLOCK: usize = 1 << 19;

/// Refuses a frame that is no picture, distances that do not fit into 16 bits of the chosen steps,
/// and colours of an exposure that is no number.
pub(super) fn check(content: &Content<'_>) -> Result<()> {
    picture_sides(content.shape, "[rows, columns], each from 1 to 2^31 - 1, for a PNG")?;
    refuse_mattes(content, "a channel other than a Cryptomatte for a PNG (use exr)")?;
    let has_too_many = |c: &&&Channel| c.display == Display::Quantity && c.components > 3;
    if let Some(channel) = content.channels.iter().find(has_too_many) {
        let expected = "a channel of one to three numbers for a PNG (or use npz)";
        let got = format!("{}, which has {}", channel.name, channel.components);
        return Err(Error::argument("channel", expected, got));
    }
    let scales = (content.channels.iter()).filter_map(|c| Some((c, scale(c, &content.settings)?)));
    for (channel, scale) in scales {
        steps::check(channel, scale, content.settings.png_far, content.shape)?;
    }
    let mut labels = (content.channels.iter()).filter(|c| is_labels(c, &content.settings));
    labels.try_for_each(|channel| steps::check_labels(channel, content.shape))?;
    if (content.channels.iter()).any(|channel| channel.display == Display::Color) {
        content.settings.display.check()?;
    }
    Ok(())
}

/// The length of a step, for a channel that is stored in steps.
fn scale(channel: &Channel, settings: &WriteSettings) -> Option<f64> {
    settings.png_scale.filter(|_| channel.display == Display::Distance)
}

/// Whether a channel is stored as numbers plus one.
fn is_labels(channel: &Channel, settings: &WriteSettings) -> bool {
    settings.png_labels && channel.display == Display::Identifier
}

pub(super) fn stored(channel: &Channel, settings: &WriteSettings) -> Stored {
    let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    if let Some(scale) = scale(channel, settings) {
        return Stored {
            scale: Some(scale),
            far: settings.png_far.map(|far| far.steps().to_string()),
            ..Stored::new(names(&["grey"]), "uint16", Encoding::Steps, "0")
        };
    }
    if is_labels(channel, settings) {
        return Stored::new(names(&["grey"]), "uint16", Encoding::Labels, "0");
    }
    let is_color = channel.display == Display::Color;
    let miss = if is_color { channel.miss() } else { "black" };
    let DisplayTransform { exposure, tone_map } = settings.display;
    let is_mapped = is_color && tone_map != ToneMap::default();
    let names = names(if channel.is_transparent() {
        &["red", "green", "blue", "alpha"]
    } else {
        &["red", "green", "blue"]
    });
    Stored {
        legend: legend(channel),
        exposure: Some(exposure).filter(|&stops| is_color && stops != 0.0),
        tone_map: is_mapped.then(|| tone_map.name().to_owned()),
        ..Stored::new(names, "uint8", Encoding::Picture, miss)
    }
}

/// Writes one channel row by row: no second picture is held in memory.
pub(super) fn encode(content: &Content<'_>, out: &mut dyn Write) -> io::Result<()> {
    let (&[rows, columns], &[channel]) = (content.shape, &content.channels[..]) else {
        return Err(io::Error::other("not a picture of one channel"));
    };
    let text = content.metadata.to_json();
    let settings = &content.settings;
    let scale = scale(channel, settings);
    if scale.is_some() || is_labels(channel, settings) {
        let mut writer = header((rows, columns), ColorType::Grayscale, &text, out)?;
        let mut writer = writer.stream_writer_with_size(CHUNK)?;
        match scale {
            Some(scale) => {
                steps::encode(channel, scale, settings.png_far, columns, &mut writer)?;
            }
            None => steps::encode_labels(channel, columns, &mut writer)?,
        }
        writer.finish()?;
    } else {
        let color = if channel.is_transparent() { ColorType::Rgba } else { ColorType::Rgb };
        let mut writer = header((rows, columns), color, &text, out)?;
        let mut writer = writer.stream_writer_with_size(CHUNK)?;
        let row = columns * color.samples();
        encode_colors(channel, content.settings.display, row, &mut writer)?;
        writer.finish()?;
    }
    Ok(())
}

/// Writes the picture in rows of `row` bytes. All threads of the current rayon pool make a block of
/// rows, then one packs it.
fn encode_colors(
    channel: &Channel,
    display: DisplayTransform,
    row: usize,
    out: &mut dyn Write,
) -> io::Result<()> {
    let map = ChannelColors::of(channel, display);
    let values_of_row = row / map.bytes() * channel.components;
    let rows = channel.data.len() / values_of_row;
    let rows_of_block = (BLOCK / row).clamp(1, rows.max(1));
    let mut bytes = vec![0; rows_of_block * row];
    for first in (0..rows).step_by(rows_of_block) {
        let block = &mut bytes[..rows_of_block.min(rows - first) * row];
        parallel::each(block.chunks_mut(row).enumerate(), |(k, bytes)| {
            let start = (first + k) * values_of_row;
            let mut values = Vec::new();
            channel.data.read(start..start + values_of_row, &mut values);
            map.apply(&values, channel.components, bytes);
        });
        out.write_all(block)?;
    }
    Ok(())
}

/// Everything before the pixels. Grey is 16 bits and no colour: it says nothing of sRGB.
fn header<'a>(
    (rows, columns): (usize, usize),
    color: ColorType,
    text: &str,
    out: &'a mut dyn Write,
) -> io::Result<png::Writer<&'a mut dyn Write>> {
    let side = |pixels: usize| u32::try_from(pixels).map_err(io::Error::other);
    let mut encoder = Encoder::new(out, side(columns)?, side(rows)?);
    encoder.set_color(color);
    if color == ColorType::Grayscale {
        encoder.set_depth(BitDepth::Sixteen);
    } else {
        encoder.set_depth(BitDepth::Eight);
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    encoder.set_compression(Compression::Fast);
    // Before the pixels: readers that stop at the last row see it too.
    encoder.add_text_chunk(KEY.to_owned(), text.to_owned())?;
    Ok(encoder.write_header()?)
}
