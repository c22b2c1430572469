//! The options of pictures and of the files they are written to.

use std::path::PathBuf;

use clap::Args;
use firsthit::image::Far;
use firsthit::{Side, ToneMap};

use super::{CameraArgs, ColorsArgs, EdgeArgs, Given, LightingArgs, RunArgs, SceneArgs};
use crate::completion::ChannelNames;
use crate::help;
use crate::output::ChannelSource;
use crate::values;

#[derive(Debug, Args)]
#[command(after_help = help::render())]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) given: Given,
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    #[command(flatten)]
    pub(crate) light: LightingArgs,
    #[command(flatten)]
    pub(crate) colors: ColorsArgs,
    #[command(flatten)]
    pub(crate) edges: EdgeArgs,
    /// The side of surfaces that the camera's rays pass through: with back, into a room through its
    /// walls. The front is where the normal points. Shadows are cast all the same
    #[arg(long, value_name = "SIDE", value_parser = values::named::<Side>(Side::NAMES))]
    pub(crate) cull: Option<Side>,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct PictureArgs {
    /// Where to write: .png (one channel), .npy (one), .exr or .npz (all), .ply or .pcd (a point
    /// cloud); may be given several times. {channel} in the name makes a file of each channel
    /// [default: what a scene file asks for, else the file's name with .png]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The channels to compute, with commas between: color, t, range, z (or depth), object,
    /// primitive, face, node, mesh, material, normal, incidence, position, barycentric, uv,
    /// base_color, front, valid (whether the lens sees anything), edge, alpha, ao[:LENGTH] (ambient
    /// occlusion, of what is up to LENGTH away), samples, crypto_object, crypto_material, and
    /// attribute:NAME for an attribute of the meshes [default: color; for .ply and .pcd position,
    /// normal, color, object]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(ChannelSource::Camera),
        hide_possible_values = true,
    )]
    pub(crate) channels: Vec<String>,
    /// Write a table that explains a picture of the channel object: the number of each object, its
    /// name, its colour in the picture (sRGB) and its count of pixels, as .csv or .json
    #[arg(long, value_name = "FILE")]
    pub(crate) legend: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) files: FileArgs,
    /// Antialiasing: the colour is the mean of this many points of a pixel. They are the first ones
    /// of a fixed low-discrepancy sequence; 1 is the pixel's centre [default: the file's, else 256
    /// with --noise, else 16 where the shader draws random numbers or there is a ground, else 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub(crate) samples: Option<u32>,
    /// Stop sampling where the standard error of a pixel's brightness (as sRGB shows it, 1 is
    /// white) is below LEVEL. First checked after 32 samples. 0.005 is about a level of 255
    /// [default: all samples everywhere]
    #[arg(long, value_name = "LEVEL", value_parser = values::positive)]
    pub(crate) noise: Option<f64>,
    /// Save the state of the picture to FILE (.npz), and continue from it if it exists. Several
    /// runs give the same bytes as one run. Ctrl-C saves it too
    #[arg(long, value_name = "FILE")]
    pub(crate) resume: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) display: DisplayArgs,
}

/// Options for the storage of numbers.
#[derive(Debug, Args)]
pub(crate) struct FileArgs {
    /// Write distances (t, range, z) to .png as 16 bit numbers, which count steps of LENGTH scene
    /// units; 0 is a miss. Otherwise a PNG of distances is in false colours, to look at
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub(crate) png_scale: Option<f64>,
    /// The number for distances beyond 65535 steps of --png-scale: saturate makes them 65535, zero
    /// makes them 0, as a miss [default: they are an error]
    #[arg(
        long,
        value_name = "HOW",
        value_parser = values::named::<Far>(Far::NAMES),
        requires = "png_scale",
    )]
    pub(crate) far: Option<Far>,
    /// Write identifiers (object, primitive, face, node, mesh, material) to .png as 16 bit numbers,
    /// each plus one; 0 is a miss. Otherwise a PNG of identifiers is in false colours
    #[arg(long)]
    pub(crate) png_labels: bool,
    /// The type of distances, positions and other numbers that are computed as float64, in all
    /// files: the nearest float32 halves a .npz [default: float64]
    #[arg(
        long,
        value_name = "TYPE",
        value_parser = ["float32", "float64"],
        hide_possible_values = true,
    )]
    pub(crate) dtype: Option<String>,
    /// Pack .npz files, by deflate; np.load reads them as all others
    #[arg(long)]
    pub(crate) compress: bool,
}

impl FileArgs {
    /// Whether float64 numbers are rounded to float32.
    pub(crate) fn is_rounded(&self) -> bool {
        self.dtype.as_deref() == Some("float32")
    }
}

/// Options for the display of colours in PNGs.
#[derive(Debug, Args)]
pub(crate) struct DisplayArgs {
    /// Make the colours of a .png brighter by this number of stops: each is twice as bright;
    /// negative ones are darker. All other files keep the colours as they are [default: 0, or the
    /// file's]
    #[arg(long, value_name = "STOPS", value_parser = values::finite)]
    pub(crate) exposure: Option<f64>,
    /// Bring bright colours into a .png, after --exposure: none shows what is above 1 as 1, neutral
    /// is Khronos PBR Neutral [default: none, or the file's]
    #[arg(long, value_name = "NAME", value_parser = values::named::<ToneMap>(ToneMap::NAMES))]
    pub(crate) tone_map: Option<ToneMap>,
}

#[derive(Debug, Args)]
#[command(after_help = help::DEMO_EXAMPLES)]
pub(crate) struct DemoArgs {
    #[command(flatten)]
    pub(crate) given: Given,
    /// Columns and rows of pixels
    #[arg(
        long,
        value_name = "COLUMNSxROWS",
        value_parser = values::pixels,
        default_value = "1024x640",
    )]
    pub(crate) size: [usize; 2],
    /// Where to write: .png (one channel), .npy (one), .exr or .npz (all), .ply or .pcd (a point
    /// cloud); may be given several times. {channel} in the name makes a file of each channel
    /// [default: demo.png]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The channels to compute, with commas between; see firsthit render --help [default: color]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(ChannelSource::Camera),
        hide_possible_values = true
    )]
    pub(crate) channels: Vec<String>,
    #[command(flatten)]
    pub(crate) files: FileArgs,
    /// Antialiasing: the colour is the mean of this many points of a pixel [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub(crate) samples: Option<u32>,
    #[command(flatten)]
    pub(crate) display: DisplayArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}
