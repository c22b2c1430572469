//! Checks the places of files: they can be written, each once, and over no input.

use std::io;
use std::path::{Path, PathBuf};

use firsthit::error::escaped;
use firsthit::image::sidecar_of;
use firsthit::inputs;

use super::targets::{Order, Target};
use crate::failure::Failure;

/// Refuses targets that cannot be written, are named twice, or are files that were read.
pub(crate) fn check_orders(orders: &[Order]) -> Result<(), Failure> {
    check_paths(orders.iter().flat_map(|order| &order.targets))
}

/// Refuses a further output that is one of the files already.
pub(crate) fn check_other(path: &Path, orders: &[Order]) -> Result<(), Failure> {
    let targets = orders.iter().flat_map(|order| &order.targets);
    check_paths(targets.chain([&Target::other(path)]))
}

/// Targets of outputs of other kinds.
pub(crate) fn check_files(paths: &[PathBuf]) -> Result<(), Failure> {
    let targets: Vec<Target> = paths.iter().map(|path| Target::other(path)).collect();
    check_paths(&targets)
}

pub(crate) fn check_paths<'a>(
    targets: impl IntoIterator<Item = &'a Target>,
) -> Result<(), Failure> {
    let mut seen: Vec<PathBuf> = Vec::new();
    let with_sidecar = targets.into_iter().flat_map(|target| {
        let Target { path, format, .. } = target;
        let has_one = format.is_some_and(|format| format.has_sidecar);
        [Some(path.clone()), has_one.then(|| sidecar_of(path))]
    });
    for path in with_sidecar.flatten() {
        let path = &path;
        let place = place(path)?;
        if seen.contains(&place) {
            return Err(Failure::usage(format!("{} is named twice as an output", escaped(path))));
        }
        if inputs::is_input(path) {
            return Err(Failure::usage(format!(
                "{} is an input; it will not be overwritten",
                escaped(path)
            )));
        }
        seen.push(place);
    }
    Ok(())
}

/// The file that `path` leads to, however it is spelled. Fails for one that cannot be written:
/// better now than after hours of rendering.
fn place(path: &Path) -> Result<PathBuf, Failure> {
    let refused = |what: &str| Err(Failure::not_written(format!("{}: {what}", escaped(path))));
    if let Ok(there) = path.metadata() {
        if there.is_dir() {
            return Err(is_folder(path));
        }
        if there.is_file() && there.permissions().readonly() {
            return refused("the file is read-only");
        }
        if let Ok(place) = path.canonicalize() {
            return Ok(place);
        }
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) if folder.is_dir() => Ok(folder.join(name)),
        (Ok(_), _) => refused("its folder is a file"),
        (Err(error), _) if error.kind() == io::ErrorKind::NotFound => {
            refused("the folder does not exist")
        }
        (Err(error), _) => refused(&error.to_string()),
    }
}

pub(super) fn is_folder(path: &Path) -> Failure {
    Failure::not_written(format!("{}: is a folder, not a file", escaped(path)))
}
