//! The command line: every option in one place, the help texts being what users read.

#![allow(
    clippy::doc_markdown,
    reason = "help texts are no Markdown: names of channels stand as they are typed"
)]

mod camera;
mod given;
mod look;
mod picture;
mod queries;
mod run;
mod scan;

pub(crate) use camera::CameraArgs;
pub(crate) use given::Given;
pub(crate) use look::{ColorsArgs, EdgeArgs, LightingArgs};
pub(crate) use picture::{DemoArgs, DisplayArgs, FileArgs, RenderArgs};
pub(crate) use queries::{
    BuildArgs, DiffArgs, InPythonArgs, InfoArgs, LintArgs, ListArgs, NearestArgs, ProbeArgs,
    SectionArgs, ShootArgs, SolidArgs, StreamFormat, ViewArgs, VisibleArgs,
};
pub(crate) use run::{LoadArgs, PickArgs, RunArgs, SceneArgs, TreeArgs, VerbosityArgs};
pub(crate) use scan::{PlaceArgs, ScanArgs, ScannerArgs};

use clap::{Arg, Parser, Subcommand, ValueHint};

use crate::help;

/// Lets the value of an option begin with a hyphen, as negative numbers do, where it is neither a
/// file nor a word of a list.
pub(crate) fn may_begin_with_hyphen(option: Arg) -> Arg {
    let is_open = option.get_action().takes_values()
        && option.get_value_hint() == ValueHint::Unknown
        && option.get_possible_values().is_empty();
    if is_open { option.allow_hyphen_values(true) } else { option }
}

/// The general raycaster: what does this ray meet first?
#[derive(Debug, Parser)]
#[command(
    name = "firsthit",
    version,
    propagate_version = true,
    max_term_width = 100,
    after_help = help::EXAMPLES,
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) verbosity: VerbosityArgs,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Make a picture of a 3D file, or compute distances, identifiers, normals, ... for its pixels.
    Render(Box<RenderArgs>),
    /// Look at a 3D file in the browser: turn it, and ask what a pixel shows.
    #[command(after_help = help::VIEW_EXAMPLES)]
    View(Box<ViewArgs>),
    /// Shoot rays of your own at a 3D file.
    Shoot(ShootArgs),
    /// Build the trees of a 3D file, and save it all as a .fhs file, which opens in milliseconds.
    Build(BuildArgs),
    /// Find the nearest points of a 3D file, and how far away they are.
    Nearest(NearestArgs),
    /// Tell which points are inside the objects of a 3D file.
    #[command(after_help = help::INSIDE_EXAMPLES)]
    Inside(SolidArgs),
    /// Tell which points see each other, past the objects of a 3D file.
    #[command(after_help = help::VISIBLE_EXAMPLES)]
    Visible(VisibleArgs),
    /// Measure how thick the objects of a 3D file are, at points of their surfaces.
    #[command(after_help = help::THICKNESS_EXAMPLES)]
    Thickness(SolidArgs),
    /// Explain one ray: what it meets first, why not another object, and what lies behind.
    Probe(Box<ProbeArgs>),
    /// Show what is in a 3D file, or what an output says of itself.
    Info(InfoArgs),
    /// Compare two outputs, channel by channel.
    Diff(DiffArgs),
    /// Cut a 3D file by a plane: its curves as a drawing, for CAD, or as numbers.
    Section(SectionArgs),
    /// Find what may be wrong with a 3D file: holes, flipped faces, self-intersections and more.
    Lint(LintArgs),
    /// Scan a 3D file with a laser scanner: points, ranges, rings, times and more of all returns,
    /// as a point cloud.
    Scan(Box<ScanArgs>),
    /// Make the frames and annotations of a plan: scenes, sensors and poses (Python package).
    #[command(after_help = help::DATASET_EXAMPLES)]
    Dataset(InPythonArgs),
    /// Tell which parts of a job are there, and which are missing (Python package).
    #[command(after_help = help::PARTS_EXAMPLES)]
    Parts(InPythonArgs),
    /// Pack the parts of a job, or the frames of a data set, into tar files for training (Python
    /// package).
    #[command(after_help = help::PACK_EXAMPLES)]
    Pack(InPythonArgs),
    /// Render the embedded example scene.
    Demo(DemoArgs),
    /// Print the JSON Schema of scene files, with which editors complete and check them.
    #[command(after_help = help::SCHEMA_EXAMPLES)]
    Schema {
        /// Print that of the plans of data sets.
        #[arg(long)]
        plan: bool,
    },
    /// Print the completions for a shell, to source or to save.
    #[command(after_help = help::COMPLETIONS_EXAMPLES)]
    Completions {
        /// The shell to complete in.
        shell: clap_complete::Shell,
    },
}
