//! The files that a scene file asks for.

use std::path::Path;

use super::section::Section;
use super::table::{Form, Pick, Record, Variant, keys, optional, required};
use crate::channel::{self, ATTRIBUTE, KINDS, PLACEHOLDER};
use crate::error::escape_controls;
use crate::image::{FORMATS, format_of, sidecar_of};
use crate::io::fault::Checked;
use crate::io::{Report, read};
use crate::world::Output;

pub(super) static OUTPUT: Record = Record {
    name: "output",
    about: "A file to be written.",
    variants: &[Variant {
        pick: Pick::Always,
        keys: &[keys! {
            /// Its name, relative to the scene file and in its folder or below; the extension tells the format. {channel} in
            /// it makes a file of each channel.
            file: required(Form::Path),
            /// What to write: channels by name, or "attribute:NAME" for an attribute of the meshes. Default: ["color"]; for a
            /// point cloud (.ply, .pcd) ["position", "normal", "color", "object"].
            channels: optional(Form::SomeOf(|| KINDS.iter().map(|kind| &*kind.name).collect(), Some(ATTRIBUTE))),
        }],
        rules: &[],
    }],
};

pub(super) fn read(section: &Section<'_, '_>, report: &Report) -> Checked<Output> {
    let name = section.need("file", Section::text)?;
    let refused = |name: &str, reason: String| {
        let name = escape_controls(name);
        section.fault_at("file", format!("'{name}' is not written: {reason}"))
    };
    let scene = report
        .source
        .base()
        .map_err(|reason| refused(name, reason))?;
    let allowed =
        |name: &str| read::sibling_to_be(scene, name).map_err(|reason| refused(name, reason));
    let path = allowed(name)?;
    let Ok(format) = format_of(&path) else {
        let known = FORMATS.iter().flat_map(|format| format.extensions);
        let known: Vec<String> = known.map(|extension| format!(".{extension}")).collect();
        let (name, known) = (escape_controls(name), known.join(", "));
        let what = format!("'{name}' is not written: it must end in one of {known}");
        return Err(section.fault_at("file", what));
    };
    let mut channels: Vec<String> = section
        .items("channels")
        .filter_map(|item| Some(item.as_str()?.to_owned()))
        .collect();
    if channels.is_empty() {
        let default = format.holds.default_channels().iter();
        channels.extend(default.map(|&name| name.to_owned()));
    }
    // So must every file that comes of it: links may stand under other names than its own.
    for name in made(name, &channels) {
        allowed(&name)?;
        if format.has_sidecar {
            allowed(&sidecar_of(Path::new(&name)).to_string_lossy())?;
        }
    }
    Ok(Output { path, channels })
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
