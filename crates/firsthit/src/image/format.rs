use std::io::{self, Write};
use std::path::Path;

use super::{Channel, Frame, npy, npz, png, write_whole};
use crate::error::{Error, Result, escaped};

/// The file formats. This list is the only place that knows all of them.
pub const FORMATS: &[Format] = &[
    Format {
        name: "png",
        extensions: &["png"],
        holds: Holds::OneChannel,
        summary: "a picture to look at: one channel, 8 bits, sRGB",
        check: png::check,
        encode: png::encode,
    },
    Format {
        name: "npy",
        extensions: &["npy"],
        holds: Holds::OneChannel,
        summary: "a NumPy array: one channel, exact values",
        check: npy::check,
        encode: |shape, channels, out| channels.iter().try_for_each(|c| npy::encode(shape, c, out)),
    },
    Format {
        name: "npz",
        extensions: &["npz"],
        holds: Holds::AllChannels,
        summary: "NumPy arrays: all channels, exact values, uncompressed",
        check: npy::check,
        encode: npz::encode,
    },
];

/// A file format.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// What it is called, in lower case.
    pub name: &'static str,
    /// The extensions that choose it, in lower case and without the dot.
    pub extensions: &'static [&'static str],
    /// How much of a frame a file of it takes.
    pub holds: Holds,
    /// What it is for, as a phrase for lists.
    pub summary: &'static str,
    /// Whether this shape and these channels can be stored.
    check: fn(&[usize], &[&Channel]) -> Result<()>,
    /// Writes what was checked.
    encode: fn(&[usize], &[&Channel], &mut dyn Write) -> io::Result<()>,
}

/// How much of a [`Frame`] one file takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// One channel.
    OneChannel,
    /// All channels of the frame.
    AllChannels,
}

/// Writes all of `frame` to a file, whole or not at all, in the format that `path`'s extension names.
///
/// # Errors
///
/// Those of [`format_of`] and [`Format::write`].
pub fn write(frame: &Frame, path: &Path) -> Result<()> {
    format_of(path)?.write(frame, None, path)
}

/// Writes the channel `name` of `frame` to a file, otherwise as [`write()`].
///
/// # Errors
///
/// Those of [`format_of`] and [`Format::write`].
pub fn write_channel(frame: &Frame, name: &str, path: &Path) -> Result<()> {
    format_of(path)?.write(frame, Some(name), path)
}

/// The format that `path`'s extension names, in any case. To be asked before hours of rendering.
///
/// # Errors
///
/// [`Error::Argument`] if there is no such format.
pub fn format_of(path: &Path) -> Result<&'static Format> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let extension = extension.to_lowercase();
    (FORMATS.iter())
        .find(|format| format.extensions.contains(&extension.as_str()))
        .ok_or_else(|| {
            let known = FORMATS.iter().flat_map(|format| format.extensions);
            let known: Vec<String> = known.map(|known| format!(".{known}")).collect();
            let got = format!("{} (known: {})", escaped(path), known.join(", "));
            Error::argument("path", "a name with a known format's extension", got)
        })
}

/// The format called `name`, in any case: where there is no extension to tell it.
///
/// # Errors
///
/// [`Error::Argument`] if there is no such format.
pub fn format_named(name: &str) -> Result<&'static Format> {
    (FORMATS.iter())
        .find(|format| format.name.eq_ignore_ascii_case(name))
        .ok_or_else(|| {
            let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
            let got = format!("{} (known: {})", escaped(Path::new(name)), known.join(", "));
            Error::argument("format", "a known format", got)
        })
}

impl Format {
    /// Writes `frame`, or only the channel called `channel`, to a file, see [`write_whole`].
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the frame has no such channel, has several where this format
    /// [holds](Self::holds) one, or has a shape that this format cannot store; then nothing was opened.
    /// [`Error::Write`] if the system refuses.
    pub fn write(&self, frame: &Frame, channel: Option<&str>, path: &Path) -> Result<()> {
        let channels = self.select(frame, channel)?;
        write_whole(path, |out| (self.encode)(&frame.shape, &channels, out))
    }

    /// Writes the same bytes as [`write`](Self::write) to any writer, which need not be buffered.
    /// `target` is what errors call it.
    ///
    /// # Errors
    ///
    /// As [`write`](Self::write). What `out` took until an error stays there.
    pub fn encode(
        &self,
        frame: &Frame,
        channel: Option<&str>,
        out: &mut dyn Write,
        target: &Path,
    ) -> Result<()> {
        let channels = self.select(frame, channel)?;
        let mut out = io::BufWriter::new(out);
        (self.encode)(&frame.shape, &channels, &mut out)
            .and_then(|()| out.flush())
            .map_err(|source| Error::Write {
                path: target.to_owned(),
                source,
            })
    }

    /// The channels that go into the file, checked.
    fn select<'a>(&self, frame: &'a Frame, channel: Option<&str>) -> Result<Vec<&'a Channel>> {
        let all: Vec<&Channel> = frame.channels.iter().collect();
        let channels = match channel {
            None => all,
            Some(name) => match frame.channel(name) {
                Some(channel) => vec![channel],
                None => return Err(Error::argument("channel", "one of the frame's", name)),
            },
        };
        if self.holds == Holds::OneChannel && channels.len() != 1 {
            let names: Vec<&str> = channels.iter().map(|channel| channel.name).collect();
            let got = format!("{} for {}: [{}]", names.len(), self.name, names.join(", "));
            let expected = "the single one that this format holds; name it, or choose npz";
            return Err(Error::argument("channel", expected, got));
        }
        (self.check)(&frame.shape, &channels)?;
        Ok(channels)
    }
}
