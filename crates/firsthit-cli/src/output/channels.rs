//! The channels that can be asked for, by what makes the numbers.

use firsthit::channel::{ATTRIBUTE, ChannelKind, KINDS, asked};
use firsthit::error::escape_controls;
use firsthit::image::{FORMATS, Format};

use crate::console::say;
use crate::failure::Failure;
use crate::hints::meant;

/// The source of the numbers, which decides what can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ChannelSource {
    /// A camera: pixels, that make a picture.
    Camera,
    /// The user's own rays: a list.
    Rays,
}

impl ChannelSource {
    /// The channels that can be asked for.
    pub(crate) fn channels(self) -> impl Iterator<Item = &'static ChannelKind> {
        KINDS.iter().filter(move |kind| self.has(kind))
    }

    fn has(self, kind: &ChannelKind) -> bool {
        let takes_sensor = kind.needs_sensor() || kind.needs_samples() || kind.is_edge();
        self == Self::Camera || !takes_sensor
    }

    /// The kinds of files there are, `None` being CSV, which is for lists alone.
    pub(super) fn forms(self) -> impl Iterator<Item = (&'static str, Option<&'static Format>)> {
        let formats = FORMATS.iter().filter(move |format| match self {
            Self::Camera => true,
            Self::Rays => !format.only_pictures,
        });
        let formats = formats.map(|format| (format.name, Some(format)));
        formats.chain((self == Self::Rays).then_some(("csv", None)))
    }
}

/// The channels that were asked for.
pub(crate) fn kinds(
    names: &[String],
    source: ChannelSource,
    quiet: bool,
) -> Result<Vec<&'static ChannelKind>, Failure> {
    let mut kinds: Vec<&'static ChannelKind> = Vec::new();
    for name in names {
        let wanted = match name.trim() {
            "depth" => "z",
            name => name,
        };
        let kind = match with_more(wanted)? {
            Some(kind) => kind,
            None => named(wanted, source)?,
        };
        if !source.has(kind) {
            return Err(Failure::usage(format!(
                "--channels: {wanted} takes a camera, and is for firsthit render"
            )));
        }
        if name.trim() == "depth" && !quiet {
            say("firsthit: note: depth is written as z, the distance along the camera's aim");
        }
        if !has(&kinds, kind)? {
            kinds.push(kind);
        }
    }
    Ok(kinds)
}

/// Whether a kind is one of some already. Fails for another one of its name.
pub(crate) fn has(kinds: &[&ChannelKind], kind: &ChannelKind) -> Result<bool, Failure> {
    let Some(other) = kinds.iter().find(|other| other.name == kind.name) else {
        return Ok(false);
    };
    let is_same = other.components == kind.components
        && other.attribute_name() == kind.attribute_name()
        && other.occlusion() == kind.occlusion();
    if is_same {
        return Ok(true);
    }
    let what = match kind.attribute_name() {
        Some(_) => "attributes",
        None => "channels",
    };
    Err(Failure::usage(format!("--channels: two {what} would both be called {}", kind.name)))
}

/// The channel of that name.
fn named(wanted: &str, source: ChannelSource) -> Result<&'static ChannelKind, Failure> {
    KINDS.iter().find(|kind| kind.name == wanted).ok_or_else(|| {
        let known: Vec<&str> = source.channels().map(|kind| &*kind.name).collect();
        let meant = meant(wanted, known.iter().copied().chain(["depth"]));
        Failure::usage(format!(
            "--channels: there is no channel \"{}\", only {}, and attribute:NAME{meant}",
            escape_controls(wanted),
            known.join(", ")
        ))
    })
}

/// A channel that says more after a colon, if that is what is asked for: an attribute by its name,
/// whether any mesh has it being known later; the Cryptomatte of another number of pairs than the
/// usual one; or ambient occlusion up to a length. Channels are arguments of the program, and live
/// as long.
fn with_more(wanted: &str) -> Result<Option<&'static ChannelKind>, Failure> {
    let takes_more = |kind: &&ChannelKind| kind.matte().is_some() || kind.occlusion().is_some();
    let mut known = KINDS.iter().filter(takes_more);
    let name = wanted.split_once(':').map(|(name, _)| name);
    if !wanted.starts_with(ATTRIBUTE) && !known.any(|kind| Some(&*kind.name) == name) {
        return Ok(None);
    }
    let kind = asked(wanted).map_err(|error| {
        if wanted == ATTRIBUTE {
            Failure::usage("--channels: attribute: takes the name of an attribute of the meshes")
        } else {
            Failure::usage(format!("--channels: {error}"))
        }
    })?;
    Ok(Some(Box::leak(Box::new(kind.into_owned()))))
}
