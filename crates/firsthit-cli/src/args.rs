//! The command line: every option in one place, the help texts being what users read.

#![allow(
    clippy::doc_markdown,
    reason = "help texts are no Markdown: names of channels stand as they are typed"
)]

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use firsthit::camera::{Focus, PixelMatrix, StandardView};
use firsthit::edge::{Dash, EdgeKinds};
use firsthit::geometry::ColorMap;
use firsthit::scene::ColorBy;
use firsthit::{Background, Color, DVec3, RayStart, Side, ToneMap};

use crate::completion::ChannelNames;
use crate::environment::{self, EnvironmentArg};
use crate::help;
use crate::output::Source;
use crate::values::{self, LightArg, Parameters, Sky, Target};

/// The general raycaster: what does this ray meet first?
#[derive(Debug, Parser)]
#[command(name = "firsthit", version, propagate_version = true, max_term_width = 100, after_help = help::EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Make a picture of a 3D file, or compute distances, identifiers, normals, ... for its pixels.
    Render(Box<RenderArgs>),
    /// Shoot rays of your own at a 3D file.
    Shoot(ShootArgs),
    /// Build the trees of a 3D file, and save it all as a .fhs file, which opens in milliseconds.
    Build(BuildArgs),
    /// Find the nearest points of a 3D file, and how far away they are.
    Nearest(NearestArgs),
    /// Tell which points are inside the objects of a 3D file.
    #[command(after_help = help::INSIDE_EXAMPLES)]
    Inside(ListArgs),
    /// Tell which points see each other, past the objects of a 3D file.
    #[command(after_help = help::VISIBLE_EXAMPLES)]
    Visible(ListArgs),
    /// Measure how thick the objects of a 3D file are, at points of their surfaces.
    #[command(after_help = help::THICKNESS_EXAMPLES)]
    Thickness(ListArgs),
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
    /// Scan a 3D file with a laser scanner: its returns as a point cloud (Python package).
    #[command(after_help = help::SCAN_EXAMPLES)]
    Scan(InPythonArgs),
    /// Make the frames and annotations of a plan: scenes, sensors and poses (Python package).
    #[command(after_help = help::DATASET_EXAMPLES)]
    Dataset(InPythonArgs),
    /// Tell which parts of a job are there, and which are missing (Python package).
    #[command(after_help = help::PARTS_EXAMPLES)]
    Parts(InPythonArgs),
    /// Pack the parts of a job, or the frames of a data set, into tar files for training (Python package).
    #[command(after_help = help::PACK_EXAMPLES)]
    Pack(InPythonArgs),
    /// Render the embedded example scene.
    Demo(DemoArgs),
    /// Print the JSON Schema of scene files, with which editors complete and check them.
    #[command(after_help = help::SCHEMA_EXAMPLES)]
    Schema,
    /// Print the completions for a shell, to source or to save.
    #[command(after_help = help::COMPLETIONS_EXAMPLES)]
    Completions {
        /// The shell to complete in.
        shell: clap_complete::Shell,
    },
}

#[derive(Debug, Args)]
#[command(after_help = help::render())]
pub(crate) struct RenderArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)
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
    /// The side of surfaces that the camera's rays pass through: with back, into a room through its walls. The front is where the
    /// normal points. Shadows are cast all the same
    #[arg(long, value_name = "SIDE")]
    pub(crate) cull: Option<CulledSide>,
    #[command(flatten)]
    pub(crate) pick: PickArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub(crate) struct CameraArgs {
    /// A camera of the file, by its name or its number (from 0), as firsthit info lists them; or the picture or point cloud that
    /// firsthit made with a camera, such as out.exr. The options below override what it says [default: the first one of a
    /// scene file, none of other files]
    #[arg(long, value_name = "NAME|NUMBER|FILE", allow_hyphen_values = true)]
    pub(crate) camera: Option<String>,
    /// The folder of a COLMAP reconstruction, with cameras.bin and images.bin, or else cameras.txt and images.txt: the camera is that
    /// of the --image. The options below override what it says
    #[arg(long, value_name = "FOLDER", conflicts_with = "camera")]
    pub(crate) colmap: Option<PathBuf>,
    /// The image of the reconstruction, by its name, such as frames/0001.jpg
    #[arg(
        long,
        value_name = "NAME",
        requires = "colmap",
        allow_hyphen_values = true
    )]
    pub(crate) image: Option<String>,
    /// Look at the model from a standard side, so that it fills the picture. This replaces the file's camera. The front
    /// is the side that faces -y if z is up, and +z if y is up [default: iso, a three-quarter view from above]
    #[arg(long, value_name = "VIEW", value_parser = values::view(), conflicts_with_all = ["position", "aim", "look_at"])]
    pub(crate) view: Option<StandardView>,
    /// Where the camera is [default: where the model fills the picture; of a panorama, the middle of the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) position: Option<DVec3>,
    /// The direction in which the camera looks
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true, conflicts_with = "look_at")]
    pub(crate) aim: Option<DVec3>,
    /// The point at which the camera looks; auto is the middle of the scene [default: auto]
    #[arg(long, value_name = "X,Y,Z|auto", value_parser = values::target, allow_hyphen_values = true)]
    pub(crate) look_at: Option<Target>,
    /// Which way is up [default: 0,1,0 for glTF and OBJ, 0,0,1 for PLY and STL. Without --position and --aim, an OBJ, PLY
    /// or STL model that clearly stands on a flat base along y or z is shown upright. If the camera looks along
    /// that axis: 0,0,-1 for glTF and OBJ, 0,1,0 for PLY and STL]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) up: Option<DVec3>,
    /// The vertical field of view: degrees from the picture's lower to its upper edge; of a fisheye those of the circle that
    /// touches the longer edges, of a panorama those across [default: 45; 180 of a fisheye, 360 of a panorama]
    #[arg(long, value_name = "DEGREES", value_parser = values::fov, conflicts_with_all = ["viewplane", "focal_length", "orthographic"], allow_hyphen_values = true)]
    pub(crate) fov: Option<f64>,
    /// The distance from the camera to the viewplane, in scene units
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, requires = "viewplane", allow_hyphen_values = true)]
    pub(crate) focal_length: Option<f64>,
    /// The viewplane's width and height, in scene units
    #[arg(long, value_name = "WxH", value_parser = values::lengths, allow_hyphen_values = true)]
    pub(crate) viewplane: Option<(f64, f64)>,
    /// The diameter of the lens, in scene units: colours are sharp at --focus, and blurred nearer and farther. Needs --samples, 64
    /// or more for a smooth blur. All other channels stay those of a pinhole [default: 0, a pinhole, or the file's]
    #[arg(long, value_name = "LENGTH", value_parser = values::tolerance, allow_hyphen_values = true)]
    pub(crate) aperture: Option<f64>,
    /// Where a picture with an --aperture is sharp: the distance along the aim, or a point at that distance
    #[arg(long, value_name = "DISTANCE|X,Y,Z", value_parser = values::focus, allow_hyphen_values = true)]
    pub(crate) focus: Option<Focus>,
    /// The intrinsic matrix: focal lengths and principal point in pixels, and the skew if there is one. Needs --convention and
    /// --size
    #[arg(long, value_name = "FX,FY,CX,CY[,SKEW]", value_parser = values::intrinsics, requires = "convention", requires = "size", conflicts_with_all = ["fov", "viewplane", "orthographic"], allow_hyphen_values = true)]
    pub(crate) intrinsics: Option<PixelMatrix>,
    /// A text file with the 3 x 4 or 4 x 4 matrix of the camera's pose, row by row, with blanks or commas between. Needs
    /// --convention
    #[arg(long, value_name = "FILE", requires = "convention", conflicts_with_all = ["position", "aim", "look_at", "up", "view"])]
    pub(crate) pose: Option<PathBuf>,
    /// Whose words --intrinsics and --pose are in. opencv: x right, y down, z forwards, the matrix takes the world to the
    /// camera, the first pixel's centre is (0, 0); colmap: the same with (0.5, 0.5); ros: as opencv with the inverse matrix;
    /// opengl, blender, gltf, nerfstudio: x right, y up, z backwards, the matrix takes the camera to the world, (0.5, 0.5);
    /// pytorch3d: x left, y up, z forwards, the matrix takes rows of the world to the camera, (0.5, 0.5)
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(firsthit::camera::Convention::NAMES), hide_possible_values = true)]
    pub(crate) convention: Option<String>,
    /// Perspective rays go through a viewplane, and orthographic ones are parallel. Panoramas: equirectangular, cylindrical,
    /// cube_map, octahedral. Fisheyes: equidistant, equisolid, stereographic, orthographic_fisheye, with --fov, by default 180.
    /// Calibrated, with --intrinsics and --parameters: opencv, opencv_fisheye, kannala_brandt, double_sphere, eucm, ucm, mei, fov,
    /// thin_prism_fisheye, rad_tan_thin_prism_fisheye [default: perspective, or the file's]
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(firsthit::Projection::NAMES), hide_possible_values = true, conflicts_with = "orthographic")]
    pub(crate) projection: Option<String>,
    /// The numbers of the projection by their names, as docs/cameras.md lists them. For the distortion of
    /// a calibrated camera, such as k1=-0.2,k2=0.05
    #[arg(long, value_name = "NAME=NUMBER,...", value_parser = values::parameters, requires = "projection", allow_hyphen_values = true)]
    pub(crate) parameters: Option<Parameters>,
    /// The same as --projection orthographic
    #[arg(long)]
    pub(crate) orthographic: bool,
    /// Where rays start, with t = 0. Rays that start on the viewplane do not meet what is between it and the eye
    /// [default: viewplane with --focal-length, else eye]
    #[arg(long, value_name = "WHERE")]
    pub(crate) ray_start: Option<RayStartArg>,
    /// Columns and rows of pixels [default: 1024x768; with --viewplane as many rows as make square pixels; 1024x512 of a
    /// panorama]
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
    /// The channels to compute, with commas between: color, t, range, z (or depth), object, primitive, face,
    /// node, mesh, material, normal, incidence, position, barycentric, uv, base_color, front, valid (whether the lens sees
    /// anything), edge, crypto_object, crypto_material, and attribute:NAME for an attribute of the meshes [default: color; for .ply and .pcd position, normal, color, object]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = ChannelNames(Source::Camera), hide_possible_values = true)]
    pub(crate) channels: Vec<String>,
    /// Write a table that explains a picture of the channel object: the number of each object, its name, its colour in the
    /// picture (sRGB) and its count of pixels, as .csv or .json
    #[arg(long, value_name = "FILE")]
    pub(crate) legend: Option<PathBuf>,
    /// Write distances (t, range, z) to .png as 16 bit numbers, which count steps of LENGTH scene units; 0 is a
    /// miss. Otherwise a PNG of distances is in false colours, to look at
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_hyphen_values = true)]
    pub(crate) png_scale: Option<f64>,
    /// Antialiasing: the colour is the mean of this many points of a pixel. They are the first ones of a fixed
    /// low-discrepancy sequence; 1 is the pixel's centre [default: 16 with soft shadows, else 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536), allow_hyphen_values = true)]
    pub(crate) samples: Option<u32>,
    /// Take no more samples where the noise of a pixel's brightness is below this, 1 being white; 0.005 is about a level of 255
    /// [default: all samples everywhere]
    #[arg(long, value_name = "LEVEL", value_parser = values::positive, allow_hyphen_values = true)]
    pub(crate) noise: Option<f64>,
    /// Keep the state of the colours in this file (.npz), and go on from there if it exists: so many samples in several runs give
    /// the bytes of as many in one
    #[arg(long, value_name = "FILE")]
    pub(crate) resume: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) display: DisplayArgs,
}

/// How PNGs show colours.
#[derive(Debug, Args)]
pub(crate) struct DisplayArgs {
    /// Make the colours of a .png brighter by so many stops: each is twice as bright; negative ones are darker. All other files
    /// keep the colours as they are [default: 0, or the file's]
    #[arg(long, value_name = "STOPS", value_parser = values::finite, allow_hyphen_values = true)]
    pub(crate) exposure: Option<f64>,
    /// Bring bright colours into a .png, after --exposure: none shows what is above 1 as 1, neutral is Khronos PBR Neutral
    /// [default: none, or the file's]
    #[arg(long, value_name = "NAME", value_parser = values::tone_map())]
    pub(crate) tone_map: Option<ToneMap>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Colour and light (COLOR: see below)")]
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
pub(crate) struct LightingArgs {
    /// How hits get their colour [default: direct]
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(firsthit::Shader::NAMES))]
    pub(crate) shader: Option<String>,
    /// A setting of the shader, such as reach=2 or shadows=false; may be given several times. docs/shading.md lists them
    #[arg(long, value_name = "NAME=VALUE", value_parser = values::setting, allow_hyphen_values = true)]
    pub(crate) set: Vec<(String, String)>,
    /// Lights that go with the camera: auto, studio, overcast, sun, headlight, shoulder; or a light:
    /// directional:X,Y,Z@DEGREES (where it goes, and how large the sun is), point:X,Y,Z, sphere:CENTER:RADIUS,
    /// disc:CENTER:NORMAL:RADIUS, rectangle:CENTER:EDGE:EDGE, which may be given several times [default: the file's, else auto]
    #[arg(long, value_name = "NAME|KIND:X,Y,Z", value_parser = values::light, allow_hyphen_values = true)]
    pub(crate) light: Vec<LightArg>,
    /// Light from all around, in place of the file's: a picture of all directions (.hdr or .exr), turned by degrees about up; or the
    /// sky and the sun of a clear day, by the degrees at which the sun stands above the horizon, and around from +x
    #[arg(long, value_name = "FILE[@DEGREES]|daylight:ELEVATION[,AZIMUTH]", value_parser = environment::parse, allow_hyphen_values = true)]
    pub(crate) environment: Option<EnvironmentArg>,
    /// What the --environment is multiplied by [default: 1]
    #[arg(long, value_name = "NUMBER", value_parser = values::tolerance, requires = "environment", allow_hyphen_values = true)]
    pub(crate) environment_strength: Option<f64>,
    /// The --environment lights, and pictures show the background instead
    #[arg(long, requires = "environment")]
    pub(crate) environment_hidden: bool,
    /// A ground under everything, of which only shadows are seen [default: with automatic light, and a camera above it]
    #[arg(long, overrides_with = "no_ground")]
    pub(crate) ground: bool,
    /// No ground
    #[arg(long)]
    pub(crate) no_ground: bool,
    /// Ambient light of the shader lambert, which is the same from all directions [default: 0.25,0.25,0.25]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) ambient: Option<Color>,
    /// Light surfaces as if nothing cast a shadow
    #[arg(long)]
    pub(crate) no_shadows: bool,
    /// The colour of the objects to which the file gives none [default: 0.6,0.6,0.6]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) color: Option<Color>,
    /// The colour where nothing is hit, or transparent [default: 0.12,0.17,0.24]
    #[arg(long, value_name = "COLOR", value_parser = values::background, conflicts_with = "sky", allow_hyphen_values = true)]
    pub(crate) background: Option<Background>,
    /// A sky where nothing is hit: the colours of the horizon and of the zenith
    #[arg(long, value_name = "COLOR:COLOR", value_parser = values::sky, allow_hyphen_values = true)]
    pub(crate) sky: Option<Sky>,
}

/// Lines along edges.
#[derive(Debug, Args)]
#[command(next_help_heading = "Edges")]
pub(crate) struct EdgeArgs {
    /// Draw lines along edges over the colours, so many pixels wide; below 1 they are fainter. The channel edge has their
    /// coverage [default: no lines, or the file's; 1 with any of the options below]
    #[arg(long, value_name = "WIDTH", value_parser = values::line_width, allow_hyphen_values = true)]
    pub(crate) edges: Option<f64>,
    /// Which edges: silhouette (a surface turns away from the eye), crease (its triangles meet at an angle), boundary (it ends),
    /// object (another object is behind, or nothing), material (between two materials), wireframe (between all polygons), with
    /// commas between [default: silhouette,crease,boundary,material]
    #[arg(long, value_name = "KINDS", value_parser = values::edge_kinds)]
    pub(crate) edge_kinds: Option<EdgeKinds>,
    /// Neighbours whose own normals are more than so many degrees apart meet in a crease [default: 30]
    #[arg(long, value_name = "DEGREES", value_parser = values::edge_angle, allow_hyphen_values = true)]
    pub(crate) edge_angle: Option<f64>,
    /// The colour of the lines [default: black]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) edge_color: Option<Color>,
    /// Draw dashed what something hides: the lengths of dashes and of gaps, in pixels, such as --hidden-edges=3,2
    /// [default: not at all; 6,4 without lengths]
    #[arg(long, value_name = "DASH,GAP", value_parser = values::dash, num_args = 0..=1, require_equals = true, default_missing_value = "6,4")]
    pub(crate) hidden_edges: Option<Dash>,
    /// Draw the edges of all polygons, beside the others
    #[arg(long)]
    pub(crate) wireframe: bool,
}

impl EdgeArgs {
    /// The options, and whether each is given.
    pub(crate) fn given(&self) -> [(&'static str, bool); 6] {
        [
            ("--edges", self.edges.is_some()),
            ("--edge-kinds", self.edge_kinds.is_some()),
            ("--edge-angle", self.edge_angle.is_some()),
            ("--edge-color", self.edge_color.is_some()),
            ("--hidden-edges", self.hidden_edges.is_some()),
            ("--wireframe", self.wireframe),
        ]
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Colours by numbers")]
#[expect(clippy::struct_field_names, reason = "as the options are called")]
pub(crate) struct ColorsArgs {
    /// Colour surfaces by numbers: attribute:NAME for an attribute of the meshes, object, face, height, or incidence. The shader lights
    /// these colours as others
    #[arg(long, value_name = "WHAT", value_parser = values::color_by)]
    pub(crate) color_by: Option<ColorBy>,
    /// The colour map [default: viridis]
    #[arg(long, value_name = "NAME", value_parser = values::color_map())]
    pub(crate) color_map: Option<ColorMap>,
    /// The numbers of the first and the last colour [default: the least and the largest that the scene has, seen or not]
    #[arg(long, value_name = "MIN,MAX", value_parser = values::range, allow_hyphen_values = true)]
    pub(crate) color_range: Option<[f64; 2]>,
    /// The colour of numbers below the --color-range [default: the map's first]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) color_below: Option<Color>,
    /// The colour of numbers above the --color-range [default: the map's last]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) color_above: Option<Color>,
    /// The colour where there is no number [default: the surface's own]
    #[arg(long, value_name = "COLOR", value_parser = values::color, allow_hyphen_values = true)]
    pub(crate) color_missing: Option<Color>,
    /// Draw a bar of the colours with their numbers at the right edge. The metadata say them in any case
    #[arg(long)]
    pub(crate) color_bar: bool,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct LoadArgs {
    /// Fail where there would be a warning for unusable triangles, which are left out (a corner is NaN, infinite or
    /// enormous), or for a text file that seems to be truncated
    #[arg(long)]
    pub(crate) strict: bool,
    /// The memory that the file's content may take once it is unpacked, in bytes, or with K, M, G or T for powers of
    /// 1024. What the content describes may take 256 times its size, plus 1/256 of this limit
    #[arg(long, value_name = "SIZE", value_parser = values::memory, default_value = "8G", allow_hyphen_values = true)]
    pub(crate) max_memory: u64,
    /// The largest width and height of a texture, in texels. The texture may take SIDE x SIDE bytes in all, at four
    /// bytes a texel
    #[arg(long, value_name = "SIDE", value_parser = clap::value_parser!(u32).range(1..=1 << 20), default_value = "16384", allow_hyphen_values = true)]
    pub(crate) max_texture: u32,
}

/// Which objects are there.
#[derive(Debug, Args)]
pub(crate) struct PickArgs {
    /// Hide the objects with this name, or else with this identifier; may be given several times. Nothing meets them, and
    /// the others keep their identifiers
    #[arg(long, value_name = "OBJECT")]
    pub(crate) hide: Vec<String>,
    /// Hide all objects but those with this name, or else with this identifier; may be given several times
    #[arg(long, value_name = "OBJECT")]
    pub(crate) only: Vec<String>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct RunArgs {
    /// The number of threads; the result is the same for any [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_hyphen_values = true)]
    pub(crate) threads: Option<u16>,
    /// Print only warnings and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Report the run and its warnings as one JSON object: on standard output, or on standard error if the results go to
    /// standard output
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::SHOOT_EXAMPLES)]
pub(crate) struct ShootArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The rays, or only their origins: .npy, .npz or .csv, or - for standard input. From CSV on standard input to CSV on
    /// standard output, lines are answered as they arrive
    pub(crate) rays: PathBuf,
    /// The directions of the rays, if RAYS has only their origins
    pub(crate) directions: Option<PathBuf>,
    /// Where to write: .npz, .npy (one channel), .csv, .ply or .pcd (a point cloud of what was hit), - for standard
    /// output; may be given several times [default: - as CSV]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The format on standard output [default: csv]
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<StreamFormat>,
    /// The channels to compute, with commas between: t, object, primitive, face, node, mesh, material, normal,
    /// incidence, position, barycentric, uv, base_color, front, valid, and attribute:NAME for an attribute of the meshes [default:
    /// t,object,primitive; for .ply and .pcd position and normal too]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(Source::Rays),
        hide_possible_values = true
    )]
    pub(crate) channels: Vec<String>,
    /// Hits have a t above this. With a negative one, rays also meet the surface that they start on [default: 0]
    #[arg(long, value_name = "T", value_parser = values::t_min, allow_hyphen_values = true)]
    pub(crate) t_min: Option<f64>,
    /// Hits have a t up to this, itself included [default: inf]
    #[arg(long, value_name = "T", value_parser = values::t_max, allow_hyphen_values = true)]
    pub(crate) t_max: Option<f64>,
    /// The side of surfaces that rays pass through: the front is where the normal points
    #[arg(long, value_name = "SIDE")]
    pub(crate) cull: Option<CulledSide>,
    /// Write every hit of each ray, in order, not only the first: an element for each hit, with the channel ray before the
    /// others, the number of its ray. Each crossing of a surface counts once, at edges too
    #[arg(long)]
    pub(crate) all: bool,
    /// As --all, but at most the first K hits of each ray
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..), allow_hyphen_values = true, conflicts_with = "all")]
    pub(crate) nearest: Option<u32>,
    #[command(flatten)]
    pub(crate) pick: PickArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(after_help = help::BUILD_EXAMPLES)]
pub(crate) struct BuildArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY or STL, or a scene file (TOML)
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
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The points: .npy, .npz or .csv, or - for standard input
    pub(crate) points: PathBuf,
    /// Where to write: .npz, .csv, .ply or .pcd (a point cloud of the nearest points), .npy with {channel} in its name,
    /// - for standard output; may be given several times [default: - as CSV]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The format on standard output [default: csv]
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<StreamFormat>,
    /// How many nearest points each point gets, each of another object or primitive; a channel says for which point
    /// each is [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_hyphen_values = true)]
    pub(crate) count: Option<u32>,
    /// The largest distance that counts, itself included [default: inf]
    #[arg(long, value_name = "LENGTH", value_parser = values::tolerance, allow_hyphen_values = true)]
    pub(crate) radius: Option<f64>,
    /// Make distances negative inside. All objects must be closed
    #[arg(long, conflicts_with_all = ["count", "radius"])]
    pub(crate) signed: bool,
    #[command(flatten)]
    pub(crate) pick: PickArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

/// A list of questions about a scene, each with one number for an answer.
#[derive(Debug, Args)]
pub(crate) struct ListArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The points, or the pairs of points: .npy, .npz or .csv, or - for standard input
    pub(crate) points: PathBuf,
    /// Where to write: .npz, .npy or .csv, - for standard output; may be given several times [default: - as CSV]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// The format on standard output [default: csv]
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<StreamFormat>,
    #[command(flatten)]
    pub(crate) pick: PickArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum CulledSide {
    Front,
    Back,
}

impl From<CulledSide> for Side {
    fn from(side: CulledSide) -> Self {
        match side {
            CulledSide::Front => Self::Front,
            CulledSide::Back => Self::Back,
        }
    }
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
    /// The 3D file, a scene file (TOML), or an output: .png, .exr, .npy, .npz, .pcd, or a point cloud that is .ply. Of a .fhs file
    /// all checksums are compared
    pub(crate) file: PathBuf,
    /// Print JSON. Of a 3D file: triangles, vertices, bounds as [[low], [high]] (null if nothing is there), objects, up,
    /// cameras, lights, materials, textures, counts of these, warnings. Of an output: format, arrays, counts, metadata
    /// (null if there are none), notes. Of each kind the first 10000 are listed
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
    /// Numbers that differ by no more than this are equal; identifiers must be the same [default: 0]
    #[arg(long, value_name = "X", value_parser = values::tolerance, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// The channels to compare, with commas between [default: all of both files]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(Source::Camera),
        hide_possible_values = true,
        visible_alias = "channel"
    )]
    pub(crate) channels: Vec<String>,
    /// Print JSON: equal, tolerance, channels, `only_in_a`, `only_in_b`, warnings
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::SECTION_EXAMPLES)]
pub(crate) struct SectionArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// A point of the plane [default: the middle of the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) origin: Option<DVec3>,
    /// The direction at right angles to the plane, of any length [default: the model's up]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) normal: Option<DVec3>,
    /// Where to write: .svg (a drawing), .dxf (for CAD) or .json (all numbers); may be given several times [default: none,
    /// only what the section comes to is printed]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
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
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// Kinds of findings that are not looked for, with commas between; see below
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = values::lint_kind())]
    pub(crate) ignore: Vec<String>,
    /// Write all meshes to a PLY file whose faces are coloured by what is wrong with them
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// How many places of each kind are listed [default: 3, or 100 with --json]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) places: Option<u32>,
    /// Print JSON: clean, checked (the kinds), findings (kind, count, of, note, places), warnings. A place has object, name,
    /// primitive (null if it is about no triangle) and position (null if it is nowhere)
    #[arg(long)]
    pub(crate) json: bool,
    /// The number of threads; the result is the same for any [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_hyphen_values = true)]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
}

#[derive(Debug, Args)]
#[command(after_help = help::PROBE_EXAMPLES, group(clap::ArgGroup::new("which ray").required(true).args(["pixel", "ray"])))]
pub(crate) struct ProbeArgs {
    /// The 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    /// The pixel through whose centre the ray goes: its column from the left and its row from the top, both from 0. The picture is
    /// that of firsthit render with the same options
    #[arg(long, value_name = "X,Y", value_parser = values::pixel, allow_hyphen_values = true)]
    pub(crate) pixel: Option<(usize, usize)>,
    /// The ray itself: its origin and its direction, of any length
    #[arg(long, value_name = "OX,OY,OZ,DX,DY,DZ", value_parser = values::ray, allow_hyphen_values = true,
        conflicts_with_all = ["camera", "colmap", "image", "view", "position", "aim", "look_at", "up", "fov", "focal_length",
        "viewplane", "intrinsics", "pose", "projection", "orthographic", "ray_start", "size"])]
    pub(crate) ray: Option<(DVec3, DVec3)>,
    /// Hits have a t above this. With a negative one, the ray also meets what is behind its start [default: 0]
    #[arg(long, value_name = "T", value_parser = values::t_min, allow_hyphen_values = true)]
    pub(crate) t_min: Option<f64>,
    /// Hits have a t up to this, itself included [default: inf]
    #[arg(long, value_name = "T", value_parser = values::t_max, allow_hyphen_values = true)]
    pub(crate) t_max: Option<f64>,
    /// The side of surfaces that the ray passes through: the front is where the normal points
    #[arg(long, value_name = "SIDE")]
    pub(crate) cull: Option<CulledSide>,
    /// List every object and everything behind the hit, not only the first of each kind
    #[arg(long)]
    pub(crate) all: bool,
    /// Print JSON, with every object: pixel, ray, fault, hit, behind, behind_count, counts, candidates, guessed, warnings. Infinite numbers are
    /// null; a miss has null for hit
    #[arg(long)]
    pub(crate) json: bool,
    /// The number of threads; the result is the same for any [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_hyphen_values = true)]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) pick: PickArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
}

/// Whatever a command takes that is written in Python, which alone understands it.
#[derive(Debug, Args)]
pub(crate) struct InPythonArgs {
    /// What the command takes: its help comes with the Python package (pip install firsthit)
    #[arg(
        value_name = "ARGUMENTS",
        trailing_var_arg = true,
        allow_hyphen_values = true
    )]
    pub(crate) _arguments: Vec<std::ffi::OsString>,
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
    /// The channels to compute, with commas between; see firsthit render --help [default: color]
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = ChannelNames(Source::Camera),
        hide_possible_values = true
    )]
    pub(crate) channels: Vec<String>,
    /// Write distances (t, range, z) to .png as 16 bit numbers, which count steps of LENGTH scene units; 0 is a
    /// miss. Otherwise a PNG of distances is in false colours, to look at
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_hyphen_values = true)]
    pub(crate) png_scale: Option<f64>,
    /// Antialiasing: the colour is the mean of this many points of a pixel [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536), allow_hyphen_values = true)]
    pub(crate) samples: Option<u32>,
    #[command(flatten)]
    pub(crate) display: DisplayArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}
