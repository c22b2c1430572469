//! Writing, and saying how to read it back.

use std::io::{self, Write};
use std::path::Path;

use firsthit::channel::ChannelKind;
use firsthit::error::escaped;
use firsthit::image::{
    self, Display, Far, Format, Frame, WriteSettings, short_legend, write_whole,
};
use serde_json::{Value, json};

use super::targets::{Target, is_png};
use crate::console::{say, warn};
use crate::failure::Failure;
use crate::hits_csv::write_csv;
use crate::progress::Progress;

/// The JSON about files: their names, what is in them, and how to read a picture back.
pub(crate) fn as_json(
    targets: &[Target],
    kinds: &[&ChannelKind],
    legends: &[Option<String>],
) -> Vec<Value> {
    let one = |(target, legend): (&Target, &Option<String>)| {
        let channels: Vec<&str> = match target.channel {
            Some(name) => vec![name],
            None => kinds.iter().map(|kind| &*kind.name).collect(),
        };
        json!({
            "file": target.path.to_string_lossy(),
            "channels": channels,
            "legend": legend,
        })
    };
    let legends = legends.iter().chain(std::iter::repeat(&None));
    targets.iter().zip(legends).map(one).collect()
}

/// Writes all files, each whole or not at all; returns how to read each back, where that takes
/// words.
pub(crate) fn write(
    frame: &Frame,
    targets: &[Target],
    settings: WriteSettings,
    progress: &Progress,
) -> Result<Vec<Option<String>>, Failure> {
    let mut legends = Vec::new();
    // All of them, or none because of what one cannot hold.
    for target in targets {
        if let Some(format) = target.format {
            let checked = format.check(frame, target.channel, settings);
            checked.map_err(|error| Failure::of_options(error, &["png_scale"]))?;
        }
    }
    for target in targets {
        let Target { path, format, channel } = target;
        match format {
            Some(format) => {
                format.write(frame, *channel, settings, path, progress)?;
                warn_of_rounding(format, frame, *channel, path);
            }
            None => write_whole(path, progress, |out| write_csv(frame, out))?,
        }
        let shown = channel.filter(|_| is_png(target));
        let shown = shown.and_then(|name| frame.channel(name));
        legends.push(shown.and_then(|channel| legend(channel, settings)));
    }
    Ok(legends)
}

/// Warns of positions that a file holds with too few digits.
fn warn_of_rounding(format: &Format, frame: &Frame, channel: Option<&str>, path: &Path) {
    let warning = format.warning(frame, channel);
    warn(warning.map(|warning| format!("{}: {warning}", escaped(path))).as_slice());
}

/// The text that explains how to read a picture back.
fn legend(channel: &image::Channel, settings: WriteSettings) -> Option<String> {
    match settings.png_scale {
        Some(scale) if channel.display == Display::Distance => {
            let name = &channel.name;
            let far = settings.png_far.map_or("", |far| match far {
                Far::Saturate => "; what is beyond 65535 steps is 65535",
                Far::Zero => "; what is beyond 65535 steps is 0",
            });
            Some(format!("{name} in steps of {scale}, 16 bits; misses 0{far}"))
        }
        _ if settings.png_labels && channel.display == Display::Identifier => {
            let name = &channel.name;
            Some(format!("{name} plus one, 16 bits; misses 0"))
        }
        _ => short_legend(channel),
    }
}

/// Says how to read pictures back.
pub(crate) fn say_legends(targets: &[Target], legends: &[Option<String>]) {
    for (target, legend) in targets.iter().zip(legends) {
        if let Some(legend) = legend {
            say(format_args!("{}: {legend}", escaped(&target.path)));
        }
    }
}

/// Writes all channels to standard output.
pub(crate) fn stream(frame: &Frame, format: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let (settings, name) = (WriteSettings::default(), Path::new("standard output"));
    let format = image::format_named(format)?;
    format.encode(frame, None, settings, &mut out, name)?;
    warn_of_rounding(format, frame, None, name);
    out.flush().map_err(|error| Failure::stdout(&error))
}
