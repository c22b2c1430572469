//! Files to be written, and what is in each.

use std::path::{Path, PathBuf};

use firsthit::channel::{ChannelKind, PLACEHOLDER};
use firsthit::error::escaped;
use firsthit::image::{Format, Holds};

use super::channels::{ChannelSource, has, kinds};
use super::paths::{check_orders, check_paths, is_folder};
use crate::asked::with_required;
use crate::failure::Failure;

/// A file to be written.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) path: PathBuf,
    /// `None`: CSV.
    pub(super) format: Option<&'static Format>,
    /// The only channel in it; `None`: all.
    pub(super) channel: Option<&'static str>,
}

impl Target {
    /// A file of another kind than channels.
    pub(super) fn other(path: &Path) -> Self {
        Self { path: path.to_owned(), format: None, channel: None }
    }
}

/// Files that are made together, and what is in them.
#[derive(Debug)]
pub(crate) struct Order {
    pub(crate) kinds: Vec<&'static ChannelKind>,
    pub(crate) targets: Vec<Target>,
}

/// The orders of a camera's picture, for `outputs`, each with the names of its channels. Files with
/// equal channels are one order.
pub(crate) fn orders(
    outputs: &[(PathBuf, Vec<String>)],
    quiet: bool,
) -> Result<Vec<Order>, Failure> {
    let mut orders: Vec<Order> = Vec::new();
    for (path, channels) in outputs {
        let channels = with_required(channels, [path]);
        let kinds = kinds(&channels, ChannelSource::Camera, quiet || !orders.is_empty())?;
        let made = targets(std::slice::from_ref(path), &kinds, ChannelSource::Camera)?;
        // A picture has one channel of a name.
        for order in &orders {
            for kind in &kinds {
                has(&order.kinds, kind)?;
            }
        }
        let is_same = |order: &&mut Order| {
            let names = order.kinds.iter().map(|kind| &kind.name);
            names.eq(kinds.iter().map(|kind| &kind.name))
        };
        match orders.iter_mut().find(is_same) {
            Some(order) => order.targets.extend(made),
            None => orders.push(Order { kinds, targets: made }),
        }
    }
    check_orders(&orders)?;
    for (_, channels) in outputs {
        let same = outputs.iter().filter(|(_, others)| others == channels);
        let same: Vec<PathBuf> = same.map(|(path, _)| path.clone()).collect();
        let kinds = kinds(channels, ChannelSource::Camera, true)?;
        let targets = targets(&same, &kinds, ChannelSource::Camera)?;
        check_all_go_somewhere(&targets, &kinds)?;
    }
    Ok(orders)
}

/// The files for a cloud of points with any columns.
pub(crate) fn clouds(paths: &[PathBuf]) -> Result<Vec<Target>, Failure> {
    let target = |path: &PathBuf| {
        let format = format(path, ChannelSource::Rays)?;
        if format.is_some_and(|format| format.holds == Holds::OneChannel) {
            let path = escaped(path);
            let what = format!("--cloud: {path} holds one channel; use .ply, .pcd, .npz or .csv");
            return Err(Failure::usage(what));
        }
        let path = path.clone();
        Ok(Target { path, format, channel: None })
    };
    paths.iter().map(target).collect()
}

/// The files for the `kinds`.
pub(crate) fn targets(
    outputs: &[PathBuf],
    kinds: &[&'static ChannelKind],
    source: ChannelSource,
) -> Result<Vec<Target>, Failure> {
    let mut targets: Vec<Target> = Vec::new();
    for path in outputs {
        let text = path.to_string_lossy();
        if text.contains(PLACEHOLDER) {
            for kind in kinds {
                let path = PathBuf::from(text.replace(PLACEHOLDER, &kind.name_in_path()));
                let format = format(&path, source)?;
                if format.is_some_and(|format| format.holds == Holds::Points) {
                    return Err(Failure::usage(format!(
                        "--output: a point cloud holds all channels; leave {PLACEHOLDER} out of {}",
                        escaped(Path::new(&*text))
                    )));
                }
                let channel = Some(&*kind.name);
                targets.push(Target { path, format, channel });
            }
        } else {
            let format = format(path, source)?;
            let channel = only_channel(path, format, kinds)?;
            let path = path.clone();
            targets.push(Target { path, format, channel });
        }
    }
    check_paths(&targets)?;
    check_mattes(&targets, kinds)?;
    Ok(targets)
}

/// Refuses Cryptomattes for files that hold none, before any work is done.
fn check_mattes(targets: &[Target], kinds: &[&'static ChannelKind]) -> Result<(), Failure> {
    for target in targets {
        let mut held =
            (kinds.iter()).filter(|kind| target.channel.is_none_or(|of| kind.name == of));
        let matte = held.find(|kind| kind.matte().is_some());
        let takes = target.format.is_some_and(|format| format.takes_mattes);
        if let (Some(kind), false) = (matte, takes) {
            return Err(Failure::usage(format!(
                "--output: {} holds no Cryptomatte ({}); use .exr or .npz",
                escaped(&target.path),
                kind.name
            )));
        }
    }
    Ok(())
}

fn format(path: &Path, source: ChannelSource) -> Result<Option<&'static Format>, Failure> {
    if path.is_dir() {
        return Err(is_folder(path));
    }
    let wanted = path.extension().unwrap_or_default();
    let mut forms = source.forms();
    let found = forms.find(|(extension, _)| wanted.eq_ignore_ascii_case(extension));
    found.map(|(_, format)| format).ok_or_else(|| {
        let known: Vec<String> = source.forms().map(|(name, _)| format!(".{name}")).collect();
        Failure::usage(format!(
            "--output: {} must end in one of {}",
            escaped(path),
            known.join(", ")
        ))
    })
}

/// The channel for a file that holds one: the only one there is, or the colours.
fn only_channel(
    path: &Path,
    format: Option<&Format>,
    kinds: &[&'static ChannelKind],
) -> Result<Option<&'static str>, Failure> {
    if format.is_none_or(|format| format.holds != Holds::OneChannel) {
        return Ok(None);
    }
    match kinds {
        [kind] => Ok(Some(&*kind.name)),
        kinds if kinds.iter().any(|kind| kind.name == "color") => Ok(Some("color")),
        _ => Err(Failure::usage(format!(
            "{} holds one channel of several; put {PLACEHOLDER} into the name for a file of each, or use .npz",
            escaped(path)
        ))),
    }
}

/// Refuses channels that were asked for and would go nowhere.
pub(crate) fn check_all_go_somewhere(
    targets: &[Target],
    kinds: &[&'static ChannelKind],
) -> Result<(), Failure> {
    let goes = |kind: &ChannelKind| {
        let takes = |target: &Target| target.channel.is_none_or(|name| name == kind.name);
        targets.iter().any(takes)
    };
    match kinds.iter().find(|kind| !goes(kind)) {
        None => Ok(()),
        Some(kind) => Err(Failure::usage(format!(
            "the channel {} goes to no file: {} takes one channel; put {PLACEHOLDER} into a name for a file of each, or add -o with a name in .npz",
            kind.name,
            names(targets)
        ))),
    }
}

impl Order {
    /// The channels in files, each with the name of the file's format.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&'static str, &'static ChannelKind)> {
        let formats = self.targets.iter().filter_map(|target| Some((target.format?, target)));
        formats.flat_map(|(format, target)| {
            let kinds = self.kinds.iter().copied();
            let in_it = kinds.filter(|kind| target.channel.is_none_or(|name| kind.name == name));
            in_it.map(|kind| (format.name, kind))
        })
    }
}

pub(super) fn is_png(target: &Target) -> bool {
    target.format.is_some_and(|format| format.name == "png")
}

/// The files' names, for a line of text.
pub(crate) fn names<'a>(targets: impl IntoIterator<Item = &'a Target>) -> String {
    let targets = targets.into_iter();
    let names: Vec<String> = targets.map(|target| escaped(&target.path)).collect();
    names.join(", ")
}
