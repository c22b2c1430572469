//! The commands that ask about a 3D file, or about an output.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use firsthit::measure::FillRule;
use firsthit::{DVec3, Side};

use super::look::{ColorsArgs, LightingArgs};
use super::{CameraArgs, Given, LoadArgs, PickArgs, RunArgs, SceneArgs, TreeArgs};
use crate::completion::ChannelNames;
use crate::help;
use crate::output::ChannelSource;
use crate::values;

#[derive(Debug, Args)]
#[command(after_help = help::SHOOT_EXAMPLES)]
pub(crate) struct ShootArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The rays, or only their origins: .npy, .npz or .csv, or - for standard input. From CSV on
    /// standard input to CSV on standard output, lines are answered as they arrive. With --from
    /// points in any format that firsthit nearest takes
    pub(crate) rays: PathBuf,
    /// The directions of the rays, if RAYS has only their origins
    pub(crate) directions: Option<PathBuf>,
    /// Where a sensor is: a ray goes from there to each point of RAYS, where its t is 1
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, conflicts_with = "directions")]
    pub(crate) from: Option<DVec3>,
    /// Where to write: .npz, .npy (one channel), .csv, .ply or .pcd (a point cloud of what was
    /// hit), - for standard output; may be given several times [default: - as CSV]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The format on standard output [default: csv]
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<StreamFormat>,
    /// The channels to compute, with commas between: t, object, primitive, face, node, mesh,
    /// material, normal, incidence, position, barycentric, uv, base_color, front, valid, and
    /// attribute:NAME for an attribute of the meshes [default: t,object,primitive; for .ply and
    /// .pcd position and normal too]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(ChannelSource::Rays),
        hide_possible_values = true
    )]
    pub(crate) channels: Vec<String>,
    /// Hits have a t above this. With a negative one, rays also meet the surface that they start on
    /// [default: 0]
    #[arg(long, value_name = "T", value_parser = values::t_min)]
    pub(crate) t_min: Option<f64>,
    /// Hits have a t up to this, itself included [default: inf]
    #[arg(long, value_name = "T", value_parser = values::t_max)]
    pub(crate) t_max: Option<f64>,
    /// The side of surfaces that rays pass through: the front is where the normal points
    #[arg(long, value_name = "SIDE", value_parser = values::named::<Side>(Side::NAMES))]
    pub(crate) cull: Option<Side>,
    /// Write every hit of each ray, in order, not only the first: an element for each hit, with the
    /// channel ray before the others, the number of its ray. Each crossing of a surface counts
    /// once, at edges too
    #[arg(long)]
    pub(crate) all: bool,
    /// As --all, but at most the first K hits of each ray
    #[arg(
        long,
        value_name = "K",
        value_parser = clap::value_parser!(u32).range(1..),
        conflicts_with = "all",
    )]
    pub(crate) nearest: Option<u32>,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(after_help = help::BUILD_EXAMPLES)]
pub(crate) struct BuildArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or OFF, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// Where to write: a name that ends in .fhs [default: the file's name with .fhs]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(after_help = help::NEAREST_EXAMPLES)]
pub(crate) struct NearestArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The points, or - for standard input: PLY, PCD, LAS, LAZ, NPY, NPZ, EXR, or text such as CSV
    /// and XYZ
    pub(crate) points: PathBuf,
    /// Where to write: .npz, .csv, .ply or .pcd (a point cloud of the nearest points), .npy with
    /// {channel} in its name, - for standard output; may be given several times [default: - as CSV;
    /// none with --cloud]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// Write the points again with all their columns, and with the column distance: .ply, .pcd,
    /// .npz or .csv; may be given several times
    #[arg(long, value_name = "FILE", conflicts_with = "count")]
    pub(crate) cloud: Vec<PathBuf>,
    /// The format on standard output [default: csv]
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<StreamFormat>,
    /// How many nearest points each point gets, each of another object or primitive; a channel says
    /// for which point each is [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) count: Option<u32>,
    /// The largest distance that counts, itself included [default: inf]
    #[arg(long, value_name = "LENGTH", value_parser = values::tolerance)]
    pub(crate) radius: Option<f64>,
    /// Make distances negative inside. All objects must be closed
    #[arg(long, conflicts_with_all = ["count", "radius"])]
    pub(crate) signed: bool,
    /// Take open objects, too: points are inside of them as their winding number says
    #[arg(long, requires = "signed")]
    pub(crate) allow_open: bool,
    /// Which points a closed mesh holds: those that it goes around any number of times but zero
    /// (nonzero), or an odd number of times (parity) [default: nonzero]
    #[arg(
        long,
        value_name = "RULE",
        value_parser = values::named::<FillRule>(FillRule::NAMES),
        requires = "signed",
    )]
    pub(crate) rule: Option<FillRule>,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

/// A list of questions about a scene, each with one number for an answer.
#[derive(Debug, Args)]
pub(crate) struct ListArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The points, or - for standard input: PLY, PCD, LAS, LAZ, NPY, NPZ, EXR, or text such as CSV
    /// and XYZ. The pairs of points of firsthit visible without --from: .npy, .npz or .csv
    pub(crate) points: PathBuf,
    /// Where to write: .npz, .npy or .csv, - for standard output; may be given several times
    /// [default: - as CSV]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The format on standard output [default: csv]
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<StreamFormat>,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
pub(crate) struct VisibleArgs {
    /// Where a sensor is: whether each point is seen from there, in place of pairs of points
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) from: Option<DVec3>,
    /// Let surfaces nearer to either point than this hide nothing, in scene units: the error of
    /// points that are rounded, as to float32
    #[arg(long, value_name = "DISTANCE", value_parser = values::tolerance, default_value_t = 0.0)]
    pub(crate) tolerance: f64,
    #[command(flatten)]
    pub(crate) list: ListArgs,
}

/// A list of questions about solids.
#[derive(Debug, Args)]
pub(crate) struct SolidArgs {
    #[command(flatten)]
    pub(crate) list: ListArgs,
    #[command(flatten)]
    pub(crate) fill: FillArgs,
}

/// Options for the inside of objects.
#[derive(Debug, Args)]
pub(crate) struct FillArgs {
    /// Which points a closed mesh holds: those that it goes around any number of times but zero
    /// (nonzero), or an odd number of times (parity) [default: nonzero]
    #[arg(long, value_name = "RULE", value_parser = values::named::<FillRule>(FillRule::NAMES))]
    pub(crate) rule: Option<FillRule>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum StreamFormat {
    Csv,
    Npy,
    Npz,
}

#[derive(Debug, Args)]
#[command(after_help = help::INFO_EXAMPLES)]
pub(crate) struct InfoArgs {
    /// The 3D file, a scene file (TOML), or an output: .png, .exr, .npy, .npz, .pcd, .las, .laz, or
    /// a point cloud that is .ply. Of a .fhs file all checksums are compared
    pub(crate) file: PathBuf,
    /// Print JSON. Of a 3D file: triangles, vertices, bounds as [[low], [high]] (null if nothing is
    /// there), objects, up, cameras, lights, environment (null if there is none), materials,
    /// textures, counts of these, warnings. Of an output: format, arrays, counts, metadata (null if
    /// there are none), notes. Of each kind the first 10000 are listed
    #[arg(long)]
    pub(crate) json: bool,
    /// List everything, not only the first 20 of each kind (10000 with --json)
    #[arg(long)]
    pub(crate) all: bool,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
}

#[derive(Debug, Args)]
#[command(after_help = help::DIFF_EXAMPLES)]
pub(crate) struct DiffArgs {
    /// An output: .png, .exr, .npy, .npz, .ply or .pcd
    pub(crate) a: PathBuf,
    /// Another output, of any of these formats
    pub(crate) b: PathBuf,
    /// Numbers that differ by no more than this are equal; identifiers must be the same [default:
    /// 0]
    #[arg(long, value_name = "X", value_parser = values::tolerance)]
    pub(crate) tolerance: Option<f64>,
    /// The channels to compare, with commas between [default: all of both files]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(ChannelSource::Camera),
        hide_possible_values = true,
        visible_alias = "channel"
    )]
    pub(crate) channels: Vec<String>,
    /// Print JSON: equal, tolerance, channels, only_in_a, only_in_b, warnings
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::SECTION_EXAMPLES)]
pub(crate) struct SectionArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// A point of the plane [default: the middle of the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) origin: Option<DVec3>,
    /// The direction at right angles to the plane, of any length [default: the model's up]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) normal: Option<DVec3>,
    /// Where to write: .svg (a drawing), .dxf (for CAD) or .json (all numbers); may be given
    /// several times [default: none, only what the section comes to is printed]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) fill: FillArgs,
    #[command(flatten)]
    pub(crate) pick: PickArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(after_help = help::lint())]
pub(crate) struct LintArgs {
    /// The 3D files: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or scene files (TOML)
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Kinds of findings that are not looked for, with commas between; see below
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = values::lint_kind())]
    pub(crate) ignore: Vec<String>,
    /// Write all meshes to a PLY file whose faces are coloured by what is wrong with them
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// How many places of each kind are listed [default: 3, or 100 with --json]
    #[arg(long, value_name = "N")]
    pub(crate) places: Option<u32>,
    /// Print JSON: is_clean, checked (the kinds), files (file, is_clean, findings), warnings. A
    /// finding has kind, count, of, note and places. A place has object, name, primitive (null if
    /// it is about no triangle) and position (null if it is nowhere)
    #[arg(long)]
    pub(crate) json: bool,
    /// The number of threads; the result is the same for any [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) trees: TreeArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
}

#[derive(Debug, Args)]
#[command(
    after_help = help::PROBE_EXAMPLES,
    group(clap::ArgGroup::new("which ray").required(true).args(["pixel", "ray"])),
)]
pub(crate) struct ProbeArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The pixel through whose centre the ray goes: its row from the top and its column from the
    /// left, both from 0. The picture is that of firsthit render with the same options
    #[arg(long, value_name = "ROW,COLUMN", value_parser = values::pixel)]
    pub(crate) pixel: Option<[usize; 2]>,
    /// The ray itself, OX,OY,OZ,DX,DY,DZ: its origin and its direction, of any length
    #[arg(long, value_name = "RAY", value_parser = values::ray,
        conflicts_with_all = ["camera", "colmap", "image", "view", "position", "aim", "look_at", "up", "fov", "fov_axis", "focal_length",
        "viewplane", "aperture", "focus", "intrinsics", "pose", "convention", "projection", "parameters", "orthographic",
        "ray_start", "size"])]
    pub(crate) ray: Option<(DVec3, DVec3)>,
    /// Hits have a t above this. With a negative one, the ray also meets what is behind its start
    /// [default: 0]
    #[arg(long, value_name = "T", value_parser = values::t_min)]
    pub(crate) t_min: Option<f64>,
    /// Hits have a t up to this, itself included [default: inf]
    #[arg(long, value_name = "T", value_parser = values::t_max)]
    pub(crate) t_max: Option<f64>,
    /// The side of surfaces that the ray passes through: the front is where the normal points
    #[arg(long, value_name = "SIDE", value_parser = values::named::<Side>(Side::NAMES))]
    pub(crate) cull: Option<Side>,
    /// List every object and everything behind the hit, not only the first of each kind
    #[arg(long)]
    pub(crate) all: bool,
    /// Print JSON, with every object: pixel, ray, fault, hit, behind, behind_count, counts,
    /// candidates, guessed, warnings. Infinite numbers are null; a miss has null for hit
    #[arg(long)]
    pub(crate) json: bool,
    /// The number of threads; the result is the same for any [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
}

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) given: Given,
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// Write the page to this file, part.html, with the scene inside, and serve nothing. Browsers
    /// open it without this program and without a network
    #[arg(short, long, value_name = "FILE", conflicts_with_all = ["port", "no_browser", "keep"])]
    pub(crate) output: Option<PathBuf>,
    /// The port on 127.0.0.1 to listen on. To look from another machine: ssh -L PORT:127.0.0.1:PORT
    /// [default: one that is free]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) port: Option<u16>,
    /// Print the page's address, and open no browser
    #[arg(long)]
    pub(crate) no_browser: bool,
    /// Go on when no page has asked for three minutes
    #[arg(long)]
    pub(crate) keep: bool,
    /// The number of threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) light: LightingArgs,
    #[command(flatten)]
    pub(crate) colors: ColorsArgs,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
}

/// The arguments of a command that is written in Python, which alone understands them.
#[derive(Debug, Args)]
pub(crate) struct InPythonArgs {
    /// The arguments of the command: its help comes with the Python package (pip install . in a
    /// clone, see README.md)
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    pub(crate) _arguments: Vec<std::ffi::OsString>,
}
