use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use super::content::{Content, WriteSettings, lost_in_float32};
use super::decode::output::Output;
#[cfg(feature = "exr")]
use super::exr;
use super::file::{write_whole, write_with_sidecar};
use super::frame::{Channel, Frame};
use super::metadata::{Encoding, Metadata, Stored};
#[cfg(feature = "png")]
use super::png;
#[cfg(feature = "npy")]
use super::{npy, npz};
#[cfg(feature = "cloud")]
use super::{pcd, ply, points};
use crate::error::{Error, Result, escaped};
use crate::watch::Watch;

/// The file formats. This list is the only place that knows all of them.
pub const FORMATS: &[Format] = &[
    #[cfg(feature = "png")]
    Format {
        name: "png",
        holds: Holds::OneChannel,
        only_pictures: true,
        has_sidecar: false,
        takes_mattes: false,
        summary: "a picture to look at: one channel, 8 bits, sRGB; distances in steps and identifiers of 16 bits",
        check: png::check,
        stored: png::stored,
        encode: png::encode,
        decode: super::decode::png::decode,
    },
    #[cfg(feature = "exr")]
    Format {
        name: "exr",
        holds: Holds::AllChannels,
        only_pictures: true,
        has_sidecar: false,
        takes_mattes: true,
        summary: "OpenEXR: all channels of a picture, float32 and uint32, ZIP compression",
        check: exr::check,
        stored: |channel, _| exr::stored(channel),
        encode: exr::encode,
        decode: super::decode::exr::decode,
    },
    #[cfg(feature = "npy")]
    Format {
        name: "npy",
        holds: Holds::OneChannel,
        only_pictures: false,
        has_sidecar: true,
        takes_mattes: true,
        summary: "a NumPy array: one channel, exact values",
        check: |_| Ok(()),
        stored: |channel, _| Stored::exact(channel, vec!["the array".to_owned()]),
        encode: |content, out| {
            (content.channels.iter()).try_for_each(|c| npy::encode(content.shape, c, out))
        },
        decode: super::decode::npy::decode,
    },
    #[cfg(feature = "npy")]
    Format {
        name: "npz",
        holds: Holds::AllChannels,
        only_pictures: false,
        has_sidecar: false,
        takes_mattes: true,
        summary: "NumPy arrays: all channels, exact values, packed if that is asked for",
        check: |_| Ok(()),
        stored: |channel, _| Stored::exact(channel, vec![channel.name.to_string()]),
        encode: npz::encode,
        decode: super::decode::npz::decode,
    },
    #[cfg(feature = "cloud")]
    Format {
        name: "ply",
        holds: Holds::Points,
        only_pictures: false,
        has_sidecar: false,
        takes_mattes: false,
        summary: "a point cloud: all channels of what was hit, exact values, colours as sRGB bytes",
        check: |content| ply::LAYOUT.check(content),
        stored: |channel, _| ply::LAYOUT.stored(channel),
        encode: ply::encode,
        decode: super::decode::points::ply,
    },
    #[cfg(feature = "cloud")]
    Format {
        name: "pcd",
        holds: Holds::Points,
        only_pictures: false,
        has_sidecar: false,
        takes_mattes: false,
        summary: "a point cloud for PCL and ROS: the same with float32 where that is fine enough",
        check: |content| pcd::LAYOUT.check(content),
        stored: |channel, _| pcd::LAYOUT.stored(channel),
        encode: pcd::encode,
        decode: super::decode::points::pcd,
    },
];

/// A file format.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// The name, in lower case: the extension that chooses it, without the dot.
    pub name: &'static str,
    /// The part of a frame that a file holds.
    pub holds: Holds,
    /// Whether it stores only pictures, `[rows, columns]`, and no batches of rays.
    pub only_pictures: bool,
    /// Whether the metadata is in a separate file, `NAME.json`, because the format has no place for
    /// it.
    pub has_sidecar: bool,
    /// Whether it stores Cryptomattes, and does not make colours or columns of them.
    pub takes_mattes: bool,
    /// The purpose, as a phrase for lists.
    pub summary: &'static str,
    /// Whether this content can be stored.
    check: fn(&Content<'_>) -> Result<()>,
    /// The record of a stored channel.
    stored: fn(&Channel, &WriteSettings) -> Stored,
    /// Writes content that was checked.
    encode: fn(&Content<'_>, &mut dyn Write) -> io::Result<()>,
    /// Decodes a file of any origin. The second argument limits the bytes of its numbers.
    pub(super) decode: fn(&[u8], u64) -> std::result::Result<Output, String>,
}

/// The part of a [`Frame`] that one file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// One channel.
    OneChannel,
    /// All channels of the frame.
    AllChannels,
    /// All channels, of those elements that have a `position`, which must be among them: a point
    /// cloud. Misses are left out.
    Points,
}

impl Holds {
    /// The channels that a file cannot do without.
    pub fn required_channels(self) -> &'static [&'static str] {
        match self {
            Self::Points => &["position"],
            Self::OneChannel | Self::AllChannels => &[],
        }
    }

    /// The channels of a picture's file by default.
    pub fn default_channels(self) -> &'static [&'static str] {
        match self {
            Self::Points => &["position", "normal", "color", "object"],
            Self::OneChannel | Self::AllChannels => &["color"],
        }
    }
}

/// Writes all of `frame` to a file, whole or not at all, in the format that `path`'s extension
/// names.
///
/// # Errors
///
/// The errors of [`format_of`] and [`Format::write`].
pub fn write(frame: &Frame, path: &Path) -> Result<()> {
    format_of(path)?.write(frame, None, WriteSettings::default(), path, &())
}

/// Writes the channel `name` of `frame` to a file, otherwise as [`write()`].
///
/// # Errors
///
/// The errors of [`format_of`] and [`Format::write`].
pub fn write_channel(frame: &Frame, name: &str, path: &Path) -> Result<()> {
    format_of(path)?.write(frame, Some(name), WriteSettings::default(), path, &())
}

impl Frame {
    /// Writes it to a file, whole or not at all, in the format that the path's extension names (see
    /// [`FORMATS`](super::FORMATS)): `.png` and `.npy` take a frame of one channel, `.exr` and
    /// `.npz` all channels, `.ply` and `.pcd` all channels of what was hit.
    ///
    /// ```no_run
    /// use firsthit::{Render, Scene};
    ///
    /// let scene = Scene::new(vec![])?;
    /// Render::new(&scene).channels(&["color", "z"]).frame()?.save("all.exr")?;
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`write`](super::write()).
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write(self, path.as_ref())
    }

    /// Writes one of its channels to a file, otherwise as [`save`](Self::save).
    ///
    /// # Errors
    ///
    /// The errors of [`write_channel`](super::write_channel).
    pub fn save_channel(&self, name: &str, path: impl AsRef<Path>) -> Result<()> {
        write_channel(self, name, path.as_ref())
    }
}

/// The format that the extension of `path` names, in upper or lower case. Call it before hours of
/// rendering.
///
/// # Errors
///
/// [`Error::Argument`] if there is no such format.
pub fn format_of(path: &Path) -> Result<&'static Format> {
    let extension = path.extension().unwrap_or_default();
    (FORMATS.iter()).find(|format| extension.eq_ignore_ascii_case(format.name)).ok_or_else(|| {
        let got = format!("{} (known: {})", escaped(path), known_extensions());
        Error::argument("path", "a name with a known format's extension", got)
    })
}

/// The extensions of all formats, for messages.
#[doc(hidden)]
pub fn known_extensions() -> String {
    let known: Vec<String> = FORMATS.iter().map(|format| format!(".{}", format.name)).collect();
    known.join(", ")
}

/// The format called `name`, in upper or lower case: for outputs without an extension.
///
/// # Errors
///
/// [`Error::Argument`] if there is no such format.
pub fn format_named(name: &str) -> Result<&'static Format> {
    (FORMATS.iter()).find(|format| format.name.eq_ignore_ascii_case(name)).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        let got = format!("{} (known: {})", escaped(Path::new(name)), known.join(", "));
        Error::argument("format", "a known format", got)
    })
}

/// Refuses channels of which the file would have two numbers under one name: `a` has two and is
/// stored as `a_0` and `a_1`, and so is another channel called `a_1`.
fn names_differ(metadata: &Metadata) -> Result<()> {
    let mut owners = BTreeMap::new();
    for channel in &metadata.channels {
        for stored in channel.stored.iter().flat_map(|stored| &stored.names) {
            if let Some(owner) = owners.insert(stored, &channel.name) {
                let got = format!("{stored} of {owner} and of {}", channel.name);
                return Err(Error::argument(
                    "channel",
                    "one whose names in the file differ from those of the others",
                    got,
                ));
            }
        }
    }
    Ok(())
}

impl Format {
    /// Writes `frame`, or only the channel called `channel`, to a file, see [`write_whole`]. A
    /// format that [`has_sidecar`](Self::has_sidecar) also writes `NAME.json`, unless `path` is a
    /// device or a pipe.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the frame has no such channel, has several where this format
    /// [holds](Self::holds) one, or has a shape or values that this format cannot store; then
    /// nothing was opened. [`Error::Write`] if the system refuses, [`Error::Interrupted`] when
    /// `watch` stops it.
    pub fn write(
        &self,
        frame: &Frame,
        channel: Option<&str>,
        settings: WriteSettings,
        path: &Path,
        watch: &dyn Watch,
    ) -> Result<()> {
        let content = self.content(frame, channel, settings, watch)?;
        let data = |out: &mut dyn Write| (self.encode)(&content, out);
        if self.has_sidecar {
            let text = content.metadata.to_json() + "\n";
            write_with_sidecar(path, watch, data, text.as_bytes())
        } else {
            write_whole(path, watch, data)
        }
    }

    /// Writes the same bytes as [`write`](Self::write) to any writer, which need not be buffered.
    /// Errors call it `target`.
    ///
    /// # Errors
    ///
    /// As [`write`](Self::write). Bytes that `out` took before an error stay there.
    pub fn encode(
        &self,
        frame: &Frame,
        channel: Option<&str>,
        settings: WriteSettings,
        out: &mut dyn Write,
        target: &Path,
    ) -> Result<()> {
        let content = self.content(frame, channel, settings, &())?;
        let mut out = io::BufWriter::new(out);
        (self.encode)(&content, &mut out)
            .and_then(|()| out.flush())
            .map_err(|source| Error::Write { path: target.to_owned(), source })
    }

    /// Checks a frame as [`write`](Self::write) does before it opens anything. Call it first where
    /// several files are to be written, or none.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`], as [`write`](Self::write).
    pub fn check(
        &self,
        frame: &Frame,
        channel: Option<&str>,
        settings: WriteSettings,
    ) -> Result<()> {
        self.content(frame, channel, settings, &()).map(drop)
    }

    /// The warning that a file of `frame`, or of `channel` alone, holds positions with too few digits.
    pub fn warning(&self, frame: &Frame, channel: Option<&str>) -> Option<String> {
        let mut channels =
            frame.channels.iter().filter(|held| channel.is_none_or(|name| held.name == name));
        channels.find_map(|channel| {
            let error = lost_in_float32(channel)?;
            let is_rounded =
                (self.stored)(channel, &WriteSettings::default()).encoding == Encoding::Rounded;
            let name = &channel.name;
            let warning = || format!("{name} as float32 is off by up to {error:?}; use npz or ply");
            is_rounded.then(warning)
        })
    }

    /// The content of the file, checked.
    fn content<'a>(
        &self,
        frame: &'a Frame,
        channel: Option<&str>,
        settings: WriteSettings,
        watch: &'a dyn Watch,
    ) -> Result<Content<'a>> {
        let channels = self.select(frame, channel)?;
        let stored = |channel: &Channel| Some((self.stored)(channel, &settings));
        let content = Content {
            shape: &frame.shape,
            metadata: Metadata::of(frame, &channels, stored),
            channels,
            settings,
            watch,
        };
        names_differ(&content.metadata)?;
        (self.check)(&content)?;
        Ok(match self.holds {
            #[cfg(feature = "cloud")]
            Holds::Points => points::counted(content),
            _ => content,
        })
    }

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
            let names: Vec<&str> = channels.iter().map(|channel| &*channel.name).collect();
            let got = format!("{} for {}: [{}]", names.len(), self.name, names.join(", "));
            let expected = "the single one that this format holds; name it, or choose exr or npz";
            return Err(Error::argument("channel", expected, got));
        }
        Ok(channels)
    }
}
