//! The command line: every option in one place, the help texts being what users read.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use firsthit::camera::StandardView;
use firsthit::{Background, Color, DVec3, RayStart};

use crate::completion::ChannelNames;
use crate::help;
use crate::output::Source;
use crate::values::{self, LightArg, Sky, Target};

/// The general raycaster: what does this ray meet first?
#[derive(Debug, Parser)]
#[command(name = "firsthit", version, propagate_version = true, max_term_width = 100, after_help = help::EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Make a picture, or distances, identifiers, normals, ... of a 3D file.
    Render(Box<RenderArgs>),
    /// Shoot any rays at a 3D file.
    Shoot(ShootArgs),
    /// Say what is in a 3D file, or what an output says of itself.
    Info(InfoArgs),
    /// Compare two outputs, channel by channel.
    Diff(DiffArgs),
    /// Render the embedded example scene.
    Demo(DemoArgs),
    /// Print the JSON Schema of scene files, by which editors complete and check them.
    #[command(after_help = help::SCHEMA_EXAMPLES)]
    Schema,
    /// Print the completions for a shell, to be sourced or saved.
    #[command(after_help = help::COMPLETIONS_EXAMPLES)]
    Completions {
        /// The shell to complete in.
        shell: clap_complete::Shell,
    },
}

#[derive(Debug, Args)]
#[command(after_help = help::render())]
pub(crate) struct RenderArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY or STL, or a scene file (TOML)
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    #[command(flatten)]
    pub(crate) light: LightingArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub(crate) struct CameraArgs {
    /// One of the file's cameras, by its name or its number from 0 on, as firsthit info lists them; the options
    /// below replace what it says [default: a scene file's first, of other files none]
    #[arg(long, value_name = "NAME|NUMBER", allow_hyphen_values = true)]
    pub(crate) camera: Option<String>,
    /// Fit the model into the picture in a standard view, in place of the file's camera. The front faces -y if z is up,
    /// +z if y is up [default: iso, a three-quarter view from above]
    #[arg(long, value_name = "VIEW", value_parser = values::view(), conflicts_with_all = ["position", "aim", "look_at"])]
    pub(crate) view: Option<StandardView>,
    /// Where the camera is [default: where the model fills the picture]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) position: Option<DVec3>,
    /// The direction it looks in
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true, conflicts_with = "look_at")]
    pub(crate) aim: Option<DVec3>,
    /// The point it looks at; auto is the middle of the scene [default: auto]
    #[arg(long, value_name = "X,Y,Z|auto", value_parser = values::target, allow_hyphen_values = true)]
    pub(crate) look_at: Option<Target>,
    /// Which way is up [default: 0,1,0 for glTF and OBJ, 0,0,1 for PLY and STL. Without a position or an aim, OBJ, PLY
    /// and STL files that clearly stand on a flat base along y or z are seen upright. If the camera looks along that
    /// axis: 0,0,-1 for glTF and OBJ, 0,1,0 for PLY and STL]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) up: Option<DVec3>,
    /// Degrees from the picture's lower to its upper edge [default: 45]
    #[arg(long, value_name = "DEGREES", value_parser = values::fov, conflicts_with_all = ["viewplane", "focal_length", "orthographic"], allow_hyphen_values = true)]
    pub(crate) fov: Option<f64>,
    /// The distance from the camera to the viewplane, in scene units
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, requires = "viewplane", allow_hyphen_values = true)]
    pub(crate) focal_length: Option<f64>,
    /// The viewplane's width and height, in scene units
    #[arg(long, value_name = "WxH", value_parser = values::lengths, allow_hyphen_values = true)]
    pub(crate) viewplane: Option<(f64, f64)>,
    /// How rays are made: through a viewplane, parallel to the aim, or in all directions (a panorama) [default:
    /// perspective, or the file's]
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(firsthit::Projection::NAMES), conflicts_with = "orthographic")]
    pub(crate) projection: Option<String>,
    /// Short for --projection orthographic
    #[arg(long)]
    pub(crate) orthographic: bool,
    /// Where rays start, and t counts from: what lies between the eye and the viewplane is not seen
    /// from the viewplane [default: viewplane with --focal-length, else eye]
    #[arg(long, value_name = "WHERE")]
    pub(crate) ray_start: Option<RayStartArg>,
    /// Columns and rows of pixels [default: 1024x768, or as high as the viewplane's shape asks]
    #[arg(long, value_name = "WxH", value_parser = values::pixels, allow_hyphen_values = true)]
    pub(crate) size: Option<(usize, usize)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RayStartArg {
    Viewplane,
    Eye,
}

impl From<RayStartArg> for RayStart {
    fn from(arg: RayStartArg) -> Self {
        match arg {
            RayStartArg::Viewplane => Self::Viewplane,
            RayStartArg::Eye => Self::Eye,
        }
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct PictureArgs {
    /// Where to write: .png (one channel), .npy (one), .exr or .npz (all), .ply or .pcd (a point cloud); may be given
    /// several times. {channel} in the name makes a file of each channel [default: what a scene file asks for, else the
    /// file's name with .png]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// What to compute, with commas between: color, t, range, z (or depth), object, primitive, face,
    /// normal, position, barycentric, uv, front [default: color; for .ply and .pcd position, normal, color, object]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = ChannelNames(Source::Camera), hide_possible_values = true)]
    pub(crate) channels: Vec<String>,
    /// Write a table beside a picture of objects: each object's number, name, colour in the picture (sRGB) and count
    /// of pixels, as .csv or .json
    #[arg(long, value_name = "FILE")]
    pub(crate) legend: Option<PathBuf>,
    /// Write distances (t, range, z) to .png as 16 bit numbers of steps, one step being LENGTH in scene
    /// units and 0 a miss, instead of as pictures to look at
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_hyphen_values = true)]
    pub(crate) png_scale: Option<f64>,
    /// Antialiasing: the colour is the mean of this many points of a pixel; 1 is the pixel's centre [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536), allow_hyphen_values = true)]
    pub(crate) samples: Option<u32>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Colour and light (COLOR: see below)")]
pub(crate) struct LightingArgs {
    /// How hits get their colour [default: lambert]
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(firsthit::Shader::NAMES))]
    pub(crate) shader: Option<String>,
    /// A light, directional:X,Y,Z (where it goes) or point:X,Y,Z (where it is); may be given several
    /// times [default: the file's, else one over the camera's shoulder]
    #[arg(long, value_name = "KIND:X,Y,Z", value_parser = values::light, allow_hyphen_values = true)]
    pub(crate) light: Vec<LightArg>,
    /// Light from everywhere [default: 0.25,0.25,0.25]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) ambient: Option<Color>,
    /// Leave out the shadows
    #[arg(long)]
    pub(crate) no_shadows: bool,
    /// The colour of all objects that the file gives none [default: 0.6,0.6,0.6]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) color: Option<Color>,
    /// The colour where nothing is hit, or transparent [default: 0.12,0.17,0.24]
    #[arg(long, value_name = "COLOR", value_parser = values::background, conflicts_with = "sky", allow_hyphen_values = true)]
    pub(crate) background: Option<Background>,
    /// A sky where nothing is hit: the colours of the horizon and of the zenith
    #[arg(long, value_name = "COLOR:COLOR", value_parser = values::sky, allow_hyphen_values = true)]
    pub(crate) sky: Option<Sky>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct LoadArgs {
    /// Fail where a file has triangles that cannot be used (NaN, infinite or enormous corners) instead of
    /// leaving them out, and where a text file seems to be truncated instead of warning
    #[arg(long)]
    pub(crate) strict: bool,
    /// How much memory the file's content may take, unpacked; in bytes, or with K, M, G or T for their
    /// 1024th powers. What a file describes may take 256 times its size and 1/256 of this
    #[arg(long, value_name = "SIZE", value_parser = values::memory, default_value = "8G", allow_hyphen_values = true)]
    pub(crate) max_memory: u64,
    /// How many texels a texture may have across or down; in all it may have as many bytes as the square of
    /// that
    #[arg(long, value_name = "SIDE", value_parser = clap::value_parser!(u32).range(1..=1 << 20), default_value = "16384", allow_hyphen_values = true)]
    pub(crate) max_texture: u32,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct RunArgs {
    /// How many threads to use; the result is the same for any number [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_hyphen_values = true)]
    pub(crate) threads: Option<u16>,
    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Report the run, with its warnings, as one JSON object on standard output, or on standard error if the results
    /// go to standard output
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::SHOOT_EXAMPLES)]
pub(crate) struct ShootArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY or STL, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The rays, or only their origins: .npy, .npz or .csv, - for standard input. CSV from standard input to CSV on
    /// standard output is answered line by line, as it comes
    pub(crate) rays: PathBuf,
    /// The rays' directions, if RAYS are only origins
    pub(crate) directions: Option<PathBuf>,
    /// Where to write: .npz, .npy (one channel), .csv, .ply or .pcd (a point cloud of what was hit), - for standard
    /// output; may be given several times [default: - as CSV]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The format on standard output [default: csv]
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<StreamFormat>,
    /// What to compute, with commas between: t, object, primitive, face, normal, position, barycentric,
    /// uv, front [default: t,object,primitive; for .ply and .pcd position and normal too]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(Source::Rays),
        hide_possible_values = true
    )]
    pub(crate) channels: Vec<String>,
    /// The t that rays begin at, which does not yet count; a negative one lets them meet what they start on [default: 0]
    #[arg(long, value_name = "T", value_parser = values::t_min, allow_hyphen_values = true)]
    pub(crate) t_min: Option<f64>,
    /// The largest t that counts [default: inf]
    #[arg(long, value_name = "T", value_parser = values::t_max, allow_hyphen_values = true)]
    pub(crate) t_max: Option<f64>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
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
    /// The 3D file, a scene file (TOML), or an output: .png, .exr, .npy, .npz, .pcd, or a point cloud that is .ply
    pub(crate) file: PathBuf,
    /// As JSON: of a 3D file triangles, vertices, bounds as [[low], [high]] (null when nothing is there), objects, up,
    /// cameras, lights, materials, textures, counts of all these, warnings; of an output format, arrays, counts, metadata
    /// (null when there are none), notes. Of each kind the first 10000 are listed
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
    /// Another one, of any of these formats
    pub(crate) b: PathBuf,
    /// The largest difference of two numbers that is none; identifiers must be equal [default: 0]
    #[arg(long, value_name = "X", value_parser = values::tolerance, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// What to compare, with commas between [default: all channels of both]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(Source::Camera),
        hide_possible_values = true,
        visible_alias = "channel"
    )]
    pub(crate) channels: Vec<String>,
    /// As JSON: equal, tolerance, channels, `only_in_a`, `only_in_b`, warnings
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::DEMO_EXAMPLES)]
pub(crate) struct DemoArgs {
    /// Columns and rows of pixels
    #[arg(long, value_name = "WxH", value_parser = values::pixels, default_value = "1024x640", allow_hyphen_values = true)]
    pub(crate) size: (usize, usize),
    /// Where to write: .png (one channel), .npy (one), .exr or .npz (all), .ply or .pcd (a point cloud); may be given
    /// several times. {channel} in the name makes a file of each channel [default: demo.png]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// What to compute, with commas between; see firsthit render --help [default: color]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(Source::Camera),
        hide_possible_values = true
    )]
    pub(crate) channels: Vec<String>,
    /// Write distances (t, range, z) to .png as 16 bit numbers of steps, one step being LENGTH in scene
    /// units and 0 a miss, instead of as pictures to look at
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_hyphen_values = true)]
    pub(crate) png_scale: Option<f64>,
    /// Antialiasing: the colour is the mean of this many points of a pixel [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536), allow_hyphen_values = true)]
    pub(crate) samples: Option<u32>,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}
