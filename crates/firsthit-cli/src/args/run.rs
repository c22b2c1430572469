//! Options of several commands: how a file is read, what of it, and how the program works.

use std::path::PathBuf;

use clap::Args;
use firsthit::scene::{Build, BuildSettings};

use crate::values;

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct LoadArgs {
    /// Fail where there would be a warning for unusable triangles, which are left out (a corner is
    /// NaN, infinite or enormous), or for a text file that seems to be truncated
    #[arg(long)]
    pub(crate) strict: bool,
    /// The memory that the file's content may take once it is unpacked, in bytes, or with K, M, G
    /// or T for powers of 1024. The described content may take 256 times its size, plus 1/256
    /// of this limit
    #[arg(long, value_name = "SIZE", value_parser = values::memory, default_value = "8G")]
    pub(crate) max_memory: u64,
    /// The largest width and height of a texture, in texels. The texture may take SIDE x SIDE bytes
    /// in all, at four bytes a texel
    #[arg(
        long,
        value_name = "SIDE",
        value_parser = clap::value_parser!(u32).range(1..=1 << 20),
        default_value = "16384",
    )]
    pub(crate) max_texture: u32,
    /// The unit of a mesh file's or a model's lengths, um, mm, cm, m, km, in or ft: they become
    /// metres
    #[arg(long, value_name = "UNIT", value_parser = values::unit(), conflicts_with = "scale")]
    pub(crate) units: Option<f64>,
    /// The factor of all lengths of a mesh file or a model
    #[arg(long, value_name = "FACTOR", value_parser = values::factor)]
    pub(crate) scale: Option<f64>,
    /// A folder whose files the file may name, as textures, beside those of its own folder; may be
    /// given several times. A file that is not found by its whole name is looked for by the last
    /// part of it
    #[arg(long, value_name = "FOLDER")]
    pub(crate) resources: Vec<PathBuf>,
    /// Allow the folder above the file's own too: ../textures/wood.png is read
    #[arg(long)]
    pub(crate) allow_parent: bool,
    /// The variant of a glTF file's materials, by its name; firsthit info lists them [default: the
    /// materials that the file shows without one]
    #[arg(long, value_name = "NAME")]
    pub(crate) variant: Option<String>,
}

/// Options for building trees.
#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct TreeArgs {
    /// How the trees over meshes are built: fast in a third of the time or less, best so that each
    /// ray takes least. auto is fast where few rays are shot for each triangle, and best where many
    /// are, or their number is unknown. The result is the same for all. A .fhs file has its trees
    #[arg(
        long,
        value_name = "HOW",
        value_parser = values::named::<Build>(Build::NAMES),
        default_value = "auto",
    )]
    pub(crate) build: Build,
}

impl TreeArgs {
    /// The settings, with the number of rays where it is known.
    pub(crate) fn settings(&self, rays: Option<u64>) -> BuildSettings {
        BuildSettings { build: self.build, rays }
    }
}

/// Options that pick objects.
#[derive(Debug, Args)]
pub(crate) struct PickArgs {
    /// Hide the objects with this name, or else with this identifier; may be given several times.
    /// Nothing meets them, and the others keep their identifiers
    #[arg(long, value_name = "OBJECT")]
    pub(crate) hide: Vec<String>,
    /// Hide all objects but those with this name, or else with this identifier; may be given
    /// several times
    #[arg(long, value_name = "OBJECT")]
    pub(crate) only: Vec<String>,
    /// Take translucent surfaces of meshes (alpha mode BLEND of glTF) as cut out: where alpha is
    /// below this number from 0 to 1 nothing is there, and elsewhere they are opaque
    #[arg(long, value_name = "ALPHA", value_parser = values::share)]
    pub(crate) blend_below: Option<f64>,
}

/// Options of a scene that is asked: how its file is read, what of it, and how trees are built.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    #[command(flatten)]
    pub(crate) pick: PickArgs,
    #[command(flatten)]
    pub(crate) trees: TreeArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
}

/// How much is said on standard error: options of every command.
#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct VerbosityArgs {
    /// Print only results, warnings and errors
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Print a line for each step that is done: how much it was, the seconds, and the memory in use
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    pub(crate) verbose: bool,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct RunArgs {
    /// The number of threads; the result is the same for any [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Report the run and its warnings as one JSON object: on standard output, or on standard error
    /// if the results go to standard output
    #[arg(long)]
    pub(crate) json: bool,
}
