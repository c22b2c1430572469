//! Which channels go to which files, settled before any work is done.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use firsthit::channel::{ATTRIBUTE, KINDS, Kind, asked};
use firsthit::error::{escape_controls, escaped};
use firsthit::image::{
    self, Display, FORMATS, Format, Frame, Holds, WriteSettings, short_legend, sidecar_of,
    write_whole,
};
use firsthit::scene_file::nearest_word;

use serde_json::{Value, json};

use crate::asked::with_required;
use crate::console::say;
use crate::failure::Failure;
use crate::hits_csv::write_csv;
use crate::progress::Interrupt;

/// Stands for the channel's name in the name of a file.
pub(crate) const PLACEHOLDER: &str = "{channel}";

/// Where the numbers come from, which decides what can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    /// A camera: pixels, that make a picture.
    Camera,
    /// The user's own rays: a list.
    Rays,
}

impl Source {
    /// The channels that can be asked for.
    pub(crate) fn channels(self) -> impl Iterator<Item = &'static Kind> {
        KINDS.iter().filter(move |kind| self.has(kind))
    }

    fn has(self, kind: &Kind) -> bool {
        let takes_sensor = kind.needs_sensor() || kind.needs_samples() || kind.is_edge();
        self == Self::Camera || !takes_sensor
    }

    /// The kinds of files there are, `None` being CSV, which is for lists alone.
    fn forms(self) -> impl Iterator<Item = (&'static str, Option<&'static Format>)> {
        let formats = FORMATS.iter().filter(move |format| match self {
            Self::Camera => true,
            Self::Rays => !format.only_pictures,
        });
        let extensions = formats.flat_map(|format| {
            let with = move |&extension| (extension, Some(format));
            format.extensions.iter().map(with)
        });
        extensions.chain((self == Self::Rays).then_some(("csv", None)))
    }
}

/// The channels that were asked for.
pub(crate) fn kinds(
    names: &[String],
    source: Source,
    quiet: bool,
) -> Result<Vec<&'static Kind>, Failure> {
    let mut kinds: Vec<&'static Kind> = Vec::new();
    for name in names {
        let wanted = match name.trim() {
            "depth" => "z",
            name => name,
        };
        if let Some(kind) = attribute(wanted)? {
            match kinds.iter().find(|other| other.name == kind.name) {
                None => kinds.push(kind),
                Some(other) if other.attribute_name() == kind.attribute_name() => {}
                Some(_) => {
                    return Err(Failure::usage(format!(
                        "--channels: two attributes would both be called {}",
                        kind.name
                    )));
                }
            }
            continue;
        }
        let with_ranks = with_ranks(wanted)?;
        let known = KINDS.iter().find(|kind| kind.name == wanted);
        let Some(kind) = with_ranks.or(known) else {
            let known: Vec<&str> = source.channels().map(|kind| &*kind.name).collect();
            let meant = nearest_word(wanted, known.iter().copied());
            let meant = meant.map_or(String::new(), |meant| format!("; did you mean {meant}?"));
            return Err(Failure::usage(format!(
                "--channels: there is no channel \"{}\", only {}, and attribute:NAME{meant}",
                escape_controls(wanted),
                known.join(", ")
            )));
        };
        if !source.has(kind) {
            return Err(Failure::usage(format!(
                "--channels: {wanted} takes a camera, and is for firsthit render"
            )));
        }
        if name.trim() == "depth" && !quiet {
            say("firsthit: note: depth is written as z, the distance along the camera's aim");
        }
        if !kinds.iter().any(|other| other.name == kind.name) {
            kinds.push(kind);
        }
    }
    Ok(kinds)
}

/// The channel of an attribute, if that is what is asked for; whether any mesh has it is known later. Channels are arguments of
/// the program, and live as long.
fn attribute(wanted: &str) -> Result<Option<&'static Kind>, Failure> {
    if !wanted.starts_with(ATTRIBUTE) {
        return Ok(None);
    }
    let kind = asked(wanted).map_err(|_| {
        Failure::usage("--channels: attribute: takes the name of an attribute of the meshes")
    })?;
    Ok(Some(Box::leak(Box::new(kind.into_owned()))))
}

/// The Cryptomatte of another number of pairs than the usual one, if that is what is asked for.
fn with_ranks(wanted: &str) -> Result<Option<&'static Kind>, Failure> {
    let mut mattes = KINDS.iter().filter(|kind| kind.matte().is_some());
    let name = wanted.split_once(':').map(|(name, _)| name);
    if !mattes.any(|kind| Some(&*kind.name) == name) {
        return Ok(None);
    }
    let kind = asked(wanted).map_err(|error| Failure::usage(format!("--channels: {error}")))?;
    Ok(Some(Box::leak(Box::new(kind.into_owned()))))
}

/// A file to be written.
#[derive(Debug)]
pub(crate) struct Target {
    path: PathBuf,
    /// `None`: CSV.
    format: Option<&'static Format>,
    /// The only channel in it; `None`: all.
    channel: Option<&'static str>,
}

/// Files that are made together, and what is in them.
#[derive(Debug)]
pub(crate) struct Order {
    pub(crate) kinds: Vec<&'static Kind>,
    pub(crate) targets: Vec<Target>,
}

/// What a camera's picture goes to: `outputs`, each with the names of its channels; none of `inputs` may be
/// among them. Files with the same channels are one order.
pub(crate) fn orders(
    outputs: &[(PathBuf, Vec<String>)],
    inputs: &[&Path],
    quiet: bool,
) -> Result<Vec<Order>, Failure> {
    let mut orders: Vec<Order> = Vec::new();
    for (path, channels) in outputs {
        let channels = with_required(channels, [path]);
        let kinds = kinds(&channels, Source::Camera, quiet || !orders.is_empty())?;
        let made = targets(std::slice::from_ref(path), &kinds, Source::Camera, inputs)?;
        let names = |kinds: &[&Kind]| {
            kinds
                .iter()
                .map(|kind| (kind.name.clone(), kind.components))
                .collect::<Vec<_>>()
        };
        match orders
            .iter_mut()
            .find(|order| names(&order.kinds) == names(&kinds))
        {
            Some(order) => order.targets.extend(made),
            None => orders.push(Order {
                kinds,
                targets: made,
            }),
        }
    }
    check_paths(orders.iter().flat_map(|order| &order.targets), inputs)?;
    for (_, channels) in outputs {
        let same = outputs.iter().filter(|(_, others)| others == channels);
        let same: Vec<PathBuf> = same.map(|(path, _)| path.clone()).collect();
        let kinds = kinds(channels, Source::Camera, true)?;
        let targets = targets(&same, &kinds, Source::Camera, inputs)?;
        check_all_go_somewhere(&targets, &kinds)?;
    }
    Ok(orders)
}

/// Refuses to write over what was read.
pub(crate) fn check_not_inputs(orders: &[Order], inputs: &[PathBuf]) -> Result<(), Failure> {
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    check_paths(orders.iter().flat_map(|order| &order.targets), &inputs)
}

/// The files for the `kinds`; none of `inputs` may be among them.
pub(crate) fn targets(
    outputs: &[PathBuf],
    kinds: &[&'static Kind],
    source: Source,
    inputs: &[&Path],
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
                targets.push(Target {
                    path,
                    format,
                    channel,
                });
            }
        } else {
            let format = format(path, source)?;
            let channel = only_channel(path, format, kinds)?;
            let path = path.clone();
            targets.push(Target {
                path,
                format,
                channel,
            });
        }
    }
    check_paths(&targets, inputs)?;
    check_mattes(&targets, kinds)?;
    Ok(targets)
}

/// Refuses Cryptomattes for files that hold none, before any work is done.
fn check_mattes(targets: &[Target], kinds: &[&'static Kind]) -> Result<(), Failure> {
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

fn format(path: &Path, source: Source) -> Result<Option<&'static Format>, Failure> {
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

fn is_folder(path: &Path) -> Failure {
    Failure::not_written(format!("{}: is a folder, not a file", escaped(path)))
}

/// The channel for a file that holds one: the only one there is, or the colours.
fn only_channel(
    path: &Path,
    format: Option<&Format>,
    kinds: &[&'static Kind],
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
    kinds: &[&'static Kind],
) -> Result<(), Failure> {
    let goes = |kind: &Kind| {
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

/// Refuses a further output that is one of the files already.
pub(crate) fn check_other(
    path: &Path,
    orders: &[Order],
    inputs: &[PathBuf],
) -> Result<(), Failure> {
    let targets = orders.iter().flat_map(|order| &order.targets);
    let other = Target {
        path: path.to_owned(),
        format: None,
        channel: None,
    };
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    check_paths(targets.chain([&other]), &inputs)
}

/// Refuses outputs of other kinds that cannot be written, are named twice, or are among the inputs.
pub(crate) fn check_files(paths: &[PathBuf], inputs: &[PathBuf]) -> Result<(), Failure> {
    let target = |path: &PathBuf| Target {
        path: path.clone(),
        format: None,
        channel: None,
    };
    let targets: Vec<Target> = paths.iter().map(target).collect();
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    check_paths(&targets, &inputs)
}

fn check_paths<'a>(
    targets: impl IntoIterator<Item = &'a Target>,
    inputs: &[&Path],
) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = inputs
        .iter()
        .filter_map(|input| input.canonicalize().ok())
        .collect();
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
            return Err(Failure::usage(format!(
                "{} is named twice as an output",
                escaped(path)
            )));
        }
        if inputs.contains(&place) {
            return Err(Failure::usage(format!(
                "{} is an input; it will not be overwritten",
                escaped(path)
            )));
        }
        seen.push(place);
    }
    Ok(())
}

/// The file that `path` leads to, however it is spelled. Fails for one that cannot be written: better now
/// than after hours of rendering.
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

/// Whether some of the files can hold distances in steps of a scale.
pub(crate) fn takes_scale(Order { kinds, targets }: &Order) -> bool {
    has_png_of(Display::Distance, kinds, targets)
}

/// Whether some of the files show colours.
pub(crate) fn shows_colors(Order { kinds, targets }: &Order) -> bool {
    has_png_of(Display::Color, kinds, targets)
}

/// Whether one of the files is a PNG of a channel that is shown so.
fn has_png_of(display: Display, kinds: &[&Kind], targets: &[Target]) -> bool {
    let is_shown_so = |name: &str| {
        let kind = kinds.iter().find(|kind| kind.name == name);
        kind.is_some_and(|kind| kind.display == display)
    };
    (targets.iter()).any(|target| is_png(target) && target.channel.is_some_and(is_shown_so))
}

fn is_png(target: &Target) -> bool {
    target.format.is_some_and(|format| format.name == "png")
}

/// What `--json` says of files: their names, what is in them, and how to read a picture back.
pub(crate) fn as_json(
    targets: &[Target],
    kinds: &[&Kind],
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

/// Writes all files, each whole or not at all; returns how to read each back, where that takes words.
pub(crate) fn write(
    frame: &Frame,
    targets: &[Target],
    settings: WriteSettings,
    interrupted: &AtomicBool,
) -> Result<Vec<Option<String>>, Failure> {
    let watch = Interrupt(interrupted);
    let mut legends = Vec::new();
    // All of them, or none because of what one cannot hold.
    for target in targets {
        if let Some(format) = target.format {
            format.check(frame, target.channel, settings)?;
        }
    }
    for target in targets {
        let Target {
            path,
            format,
            channel,
        } = target;
        match format {
            Some(format) => format.write(frame, *channel, settings, path, &watch)?,
            None => write_whole(path, &watch, |out| write_csv(frame, out))?,
        }
        let shown = channel.filter(|_| is_png(target));
        let shown = shown.and_then(|name| frame.channel(name));
        legends.push(shown.and_then(|channel| legend(channel, settings)));
    }
    Ok(legends)
}

/// How to read a picture back.
fn legend(channel: &image::Channel, settings: WriteSettings) -> Option<String> {
    match settings.png_scale {
        Some(scale) if channel.display == Display::Distance => {
            let name = &channel.name;
            Some(format!("{name} in steps of {scale}, 16 bits; misses 0"))
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

/// The files' names, for a line of text.
pub(crate) fn names<'a>(targets: impl IntoIterator<Item = &'a Target>) -> String {
    let targets = targets.into_iter();
    let names: Vec<String> = targets.map(|target| escaped(&target.path)).collect();
    names.join(", ")
}

/// Writes all channels to standard output.
pub(crate) fn stream(frame: &Frame, format: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let (settings, name) = (WriteSettings::default(), Path::new("standard output"));
    image::format_named(format)?.encode(frame, None, settings, &mut out, name)?;
    out.flush().map_err(|error| Failure::stdout(&error))
}
