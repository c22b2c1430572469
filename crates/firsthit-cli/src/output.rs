//! Which channels go to which files.

use std::io::Write;
use std::path::{Path, PathBuf};

use firsthit::channel::{self, Kind};
use firsthit::error::escaped;
use firsthit::image::{self, Format, Frame, Holds, format_of, legend};

use crate::failure::Failure;

/// Stands for the channel's name in the name of a file.
const PLACEHOLDER: &str = "{channel}";

/// The channels that were asked for.
pub(crate) fn kinds(names: &[String]) -> Result<Vec<&'static Kind>, Failure> {
    let mut kinds: Vec<&'static Kind> = Vec::new();
    for name in names {
        let name = match name.trim() {
            "depth" => {
                eprintln!(
                    "firsthit: note: depth is written as z, the distance along the camera's aim"
                );
                "z"
            }
            name => name,
        };
        let kind = channel::kind(name)?;
        if !kinds.iter().any(|other| other.name == kind.name) {
            kinds.push(kind);
        }
    }
    Ok(kinds)
}

/// A file to be written, checked before any work is done.
#[derive(Debug)]
pub(crate) struct Target {
    path: PathBuf,
    format: &'static Format,
    /// The only channel in it; `None`: all.
    channel: Option<&'static str>,
}

/// The files for the `kinds`.
pub(crate) fn targets(
    outputs: &[PathBuf],
    kinds: &[&'static Kind],
    input: Option<&Path>,
) -> Result<Vec<Target>, Failure> {
    let mut targets: Vec<Target> = Vec::new();
    for path in outputs {
        let text = path.to_string_lossy();
        if text.contains(PLACEHOLDER) {
            for kind in kinds {
                let path = PathBuf::from(text.replace(PLACEHOLDER, kind.name));
                targets.push(target(path, Some(kind.name))?);
            }
        } else {
            let only = only_channel(path, kinds)?;
            targets.push(target(path.clone(), only)?);
        }
    }
    check_paths(&targets, input)?;
    Ok(targets)
}

fn target(path: PathBuf, channel: Option<&'static str>) -> Result<Target, Failure> {
    let format = format_of(&path)?;
    Ok(Target {
        path,
        format,
        channel,
    })
}

/// The channel for a file that holds one: the only one there is, or the colours.
fn only_channel(path: &Path, kinds: &[&'static Kind]) -> Result<Option<&'static str>, Failure> {
    if format_of(path)?.holds == Holds::AllChannels {
        return Ok(None);
    }
    match kinds {
        [kind] => Ok(Some(kind.name)),
        kinds if kinds.iter().any(|kind| kind.name == "color") => Ok(Some("color")),
        _ => Err(Failure::usage(format!(
            "{} holds one channel of several; put {PLACEHOLDER} into the name for a file of each, or use .npz",
            escaped(path)
        ))),
    }
}

fn check_paths(targets: &[Target], input: Option<&Path>) -> Result<(), Failure> {
    let input = input.and_then(|input| input.canonicalize().ok());
    for (k, target) in targets.iter().enumerate() {
        if targets[..k].iter().any(|other| other.path == target.path) {
            return Err(Failure::usage(format!(
                "{} is named twice as an output",
                escaped(&target.path)
            )));
        }
        if input.is_some() && target.path.canonicalize().ok() == input {
            return Err(Failure::usage(format!(
                "{} is the input; it will not be overwritten",
                escaped(&target.path)
            )));
        }
    }
    Ok(())
}

/// Writes all files; returns what to say about them.
pub(crate) fn write(frame: &Frame, targets: &[Target]) -> Result<Vec<String>, Failure> {
    let mut lines = Vec::new();
    for target in targets {
        target.format.write(frame, target.channel, &target.path)?;
        let shown = target
            .channel
            .filter(|_| target.format.name == "png")
            .and_then(|name| frame.channel(name));
        if let Some(legend) = shown.and_then(legend) {
            lines.push(format!("{}: {legend}", escaped(&target.path)));
        }
    }
    Ok(lines)
}

/// The files' names, for a line of text.
pub(crate) fn names(targets: &[Target]) -> String {
    targets
        .iter()
        .map(|target| escaped(&target.path))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Writes all channels to standard output.
pub(crate) fn stream(frame: &Frame, format: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    image::format_named(format)?.encode(frame, None, &mut out, Path::new("standard output"))?;
    out.flush().map_err(|error| Failure::stdout(&error))
}
