//! The files that a scene file asks for.

use std::path::Path;

use super::section::Section;
use super::table::{Form, Pick, Record, keys, optional, record, required};
use crate::channel::{self, ATTRIBUTE, KINDS, PLACEHOLDER};
use crate::error::{Error, Result, escape_controls};
use crate::image::{Format, format_of, known_extensions, sidecar_of};
use crate::io::fault::Checked;
use crate::io::{Report, read};
use crate::world::Output;

pub(super) static OUTPUT: Record = record! {
    "output", "A file to be written.";
    Pick::Always => [keys! {
        /// The file's name, relative to the scene file and in its folder or below; the
        /// extension tells the format. {channel} in it makes a file of each channel.
        file: required(Form::Path),
        /// The channels to write, by name, or "attribute:NAME" for an attribute of the meshes.
        /// Default: ["color"]; for a point cloud (.ply, .pcd) ["position", "normal", "color",
        /// "object"].
        channels: optional(Form::Array(&Form::OneOfOr(|| KINDS.iter().map(|kind| &*kind.name).collect(), ATTRIBUTE), 1, usize::MAX)),
    }];
};

pub(super) fn read(section: &Section<'_, '_>, report: &Report) -> Checked<Output> {
    let name = section.need("file", Section::text)?;
    let refused = |name: &str, reason: String| {
        let name = escape_controls(name);
        section.fault_at("file", format!("'{name}' is not written: {reason}"))
    };
    let scene = report.source.base().map_err(|reason| refused(name, reason))?;
    let path = read::sibling_to_be(scene, name).map_err(|reason| refused(name, reason))?;
    let Ok(format) = format_of(&path) else {
        let (name, known) = (escape_controls(name), known_extensions());
        let what = format!("'{name}' is not written: it must end in one of {known}");
        return Err(section.fault_at("file", what));
    };
    let mut channels: Vec<String> =
        section.items("channels").filter_map(|item| Some(item.as_str()?.to_owned())).collect();
    if channels.is_empty() {
        let default = format.holds.default_channels().iter();
        channels.extend(default.map(|&name| name.to_owned()));
    }
    check_made(scene, (name, format), &channels)
        .map_err(|(name, reason)| refused(&name, reason))?;
    Ok(Output { path, channels })
}

impl Output {
    /// The output with other channels, for an output of the file `scene`. Each channel may be a
    /// file of its own.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a file that would lead out of the scene's folder, and for one that
    /// is not regular.
    pub fn with_channels(&self, scene: &Path, channels: Vec<String>) -> Result<Self> {
        let folder = scene.parent().unwrap_or(Path::new(""));
        let name = self.path.strip_prefix(folder).unwrap_or(&self.path);
        let name = name.to_string_lossy();
        let made = check_made(scene, (&name, format_of(&self.path)?), &channels);
        made.map_err(|(name, reason)| {
            let got = format!("{}: {reason}", escape_controls(&name));
            Error::argument("output", "in the folder of the scene file", got)
        })?;
        let path = self.path.clone();
        Ok(Self { path, channels })
    }
}

/// Refuses an output if a file that comes of it may not be written, with that file's name and the
/// reason: links may stand under other names than its own.
fn check_made(
    scene: &Path,
    (name, format): (&str, &Format),
    channels: &[String],
) -> std::result::Result<(), (String, String)> {
    for name in made(name, channels) {
        let sidecar = format.has_sidecar.then(|| sidecar_of(Path::new(&name)));
        let sidecar = sidecar.map(|path| path.to_string_lossy().into_owned());
        for name in [Some(name), sidecar].into_iter().flatten() {
            read::sibling_to_be(scene, &name).map_err(|reason| (name, reason))?;
        }
    }
    Ok(())
}

/// The names of the files that are made: one, or one of each channel.
fn made(name: &str, channels: &[String]) -> Vec<String> {
    if !name.contains(PLACEHOLDER) {
        return vec![name.to_owned()];
    }
    let of_channel = |channel: &String| {
        let asked = channel::asked(channel).ok()?;
        Some(name.replace(PLACEHOLDER, &asked.name_in_path()))
    };
    channels.iter().filter_map(of_channel).collect()
}
