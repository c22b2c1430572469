//! The names of the channels that files get: those asked for, or what their formats are for.

use std::path::{Path, PathBuf};

use firsthit::image;

/// The channels of a picture's file: those that were asked for, else those that its format is for.
pub(crate) fn channels(asked: &[String], path: &Path) -> Vec<String> {
    if !asked.is_empty() {
        return asked.to_vec();
    }
    let format = image::format_of(path);
    let names = format.map_or(&["color"][..], |format| format.holds.default_channels());
    names.iter().map(|&name| name.to_owned()).collect()
}

/// The names of channels, those first that some of the `files` cannot do without.
pub(crate) fn with_required<'a>(
    names: &[String],
    files: impl IntoIterator<Item = &'a PathBuf>,
) -> Vec<String> {
    let holds = files.into_iter().filter_map(|path| image::format_of(path).ok());
    let required = holds.flat_map(|format| format.holds.required_channels());
    let required = required.map(|&name| name.to_owned());
    let required = required.filter(|name| !names.iter().any(|given| given.trim() == name));
    required.chain(names.iter().cloned()).collect()
}
