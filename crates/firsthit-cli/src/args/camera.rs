//! The options of the camera.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use firsthit::camera::{Convention, Focus, FovAxis, PixelMatrix, StandardView};
use firsthit::{DVec3, Projection, RayStart};

use crate::values::{self, Parameters, Target, named};

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(
    next_help_heading = "Camera",
    group(ArgGroup::new("in other words").args(["intrinsics", "pose"]).multiple(true)),
)]
pub(crate) struct CameraArgs {
    /// A camera of the file, by its name or its number (from 0), as firsthit info lists them; or
    /// the picture or point cloud that firsthit made with a camera, such as out.exr. The options
    /// below override what it says [default: the first one of a scene file, none of other files]
    #[arg(long, value_name = "NAME|NUMBER|FILE")]
    pub(crate) camera: Option<String>,
    /// The folder of a COLMAP reconstruction, with cameras.bin and images.bin, or else cameras.txt
    /// and images.txt: the camera is that of the --image. The options below override what it says
    #[arg(long, value_name = "FOLDER", conflicts_with = "camera")]
    pub(crate) colmap: Option<PathBuf>,
    /// The image of the reconstruction, by its name, such as frames/0001.jpg
    #[arg(long, value_name = "NAME", requires = "colmap")]
    pub(crate) image: Option<String>,
    /// Look at the model from a standard side, so that it fills the picture. This replaces the
    /// file's camera. The front is the side that faces -y if z is up, and +z if y is up [default:
    /// iso, a three-quarter view from above]
    #[arg(
        long,
        value_name = "VIEW",
        value_parser = named::<StandardView>(StandardView::NAMES),
        conflicts_with_all = ["position", "aim", "look_at"],
    )]
    pub(crate) view: Option<StandardView>,
    /// Where the camera is [default: where the model fills the picture; of a panorama, the middle
    /// of the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) position: Option<DVec3>,
    /// The direction in which the camera looks
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, conflicts_with = "look_at")]
    pub(crate) aim: Option<DVec3>,
    /// The point at which the camera looks; auto is the middle of the scene [default: auto]
    #[arg(long, value_name = "X,Y,Z|auto", value_parser = values::target)]
    pub(crate) look_at: Option<Target>,
    /// Which way is up [default: 0,1,0 for glTF and OBJ, 0,0,1 for PLY and STL. Without --position
    /// and --aim, an OBJ, PLY or STL model that clearly stands on a flat base along y or z is shown
    /// upright. If the camera looks along that axis: 0,0,-1 for glTF and OBJ, 0,1,0 for PLY and
    /// STL]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) up: Option<DVec3>,
    /// The field of view: degrees from the picture's lower to its upper edge, or along --fov-axis;
    /// of a fisheye those of the circle that touches the longer edges, of a panorama those across
    /// [default: 45; 180 of a fisheye, 360 of a panorama]
    #[arg(
        long,
        value_name = "DEGREES",
        value_parser = values::fov,
        conflicts_with_all = ["viewplane", "focal_length", "orthographic", "parameters"],
    )]
    pub(crate) fov: Option<f64>,
    /// How --fov is measured: from the lower to the upper edge, from the left to the right one, or
    /// from corner to corner [default: vertical, or the file's]
    #[arg(
        long,
        value_name = "AXIS",
        value_parser = named::<FovAxis>(FovAxis::NAMES),
        conflicts_with_all = ["viewplane", "focal_length", "orthographic", "intrinsics", "parameters"],
    )]
    pub(crate) fov_axis: Option<FovAxis>,
    /// The distance from the camera to the viewplane, in scene units
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, requires = "viewplane")]
    pub(crate) focal_length: Option<f64>,
    /// The viewplane's width and height, in scene units
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = values::lengths)]
    pub(crate) viewplane: Option<(f64, f64)>,
    /// The diameter of the lens, in scene units: colours are sharp at --focus, and blurred nearer
    /// and farther. Needs --samples, 64 or more for a smooth blur. All other channels stay those of
    /// a pinhole [default: 0, a pinhole, or the file's]
    #[arg(long, value_name = "LENGTH", value_parser = values::tolerance)]
    pub(crate) aperture: Option<f64>,
    /// Where a picture with an --aperture is sharp: the distance along the aim, or a point at that
    /// distance
    #[arg(long, value_name = "DISTANCE|X,Y,Z", value_parser = values::focus)]
    pub(crate) focus: Option<Focus>,
    /// The intrinsic matrix: focal lengths and principal point in pixels, and the skew if there is
    /// one. Needs --convention and --size
    #[arg(
        long,
        value_name = "FX,FY,CX,CY[,SKEW]",
        value_parser = values::intrinsics,
        requires = "convention",
        requires = "size",
        conflicts_with_all = ["fov", "viewplane", "orthographic"],
    )]
    pub(crate) intrinsics: Option<PixelMatrix>,
    /// A text file with the 3 x 4 or 4 x 4 matrix of the camera's pose, row by row, with blanks or
    /// commas between. Needs --convention
    #[arg(
        long,
        value_name = "FILE",
        requires = "convention",
        conflicts_with_all = ["position", "aim", "look_at", "up", "view"],
    )]
    pub(crate) pose: Option<PathBuf>,
    /// Whose words --intrinsics and --pose are in. opencv: x right, y down, z forwards, the matrix
    /// takes the world to the camera, the first pixel's centre is (0, 0); colmap: the same with
    /// (0.5, 0.5); ros: as opencv with the inverse matrix; opengl, blender, gltf, nerfstudio: x
    /// right, y up, z backwards, the matrix takes the camera to the world, (0.5, 0.5); pytorch3d: x
    /// left, y up, z forwards, the matrix takes rows of the world to the camera, (0.5, 0.5)
    #[arg(
        long,
        value_name = "NAME",
        value_parser = named::<Convention>(Convention::NAMES),
        hide_possible_values = true,
        requires = "in other words",
    )]
    pub(crate) convention: Option<Convention>,
    /// Perspective rays go through a viewplane, and orthographic ones are parallel. Panoramas:
    /// equirectangular, cylindrical, cube_map, octahedral. Fisheyes: equidistant, equisolid,
    /// stereographic, orthographic_fisheye, with --fov, by default 180. Calibrated, with
    /// --intrinsics and --parameters: opencv, opencv_fisheye, kannala_brandt, double_sphere, eucm,
    /// ucm, mei, fov, thin_prism_fisheye, rad_tan_thin_prism_fisheye [default: perspective, or the
    /// file's]
    #[arg(
        long,
        value_name = "NAME",
        value_parser = named::<Projection>(Projection::NAMES),
        hide_possible_values = true,
        conflicts_with = "orthographic",
    )]
    pub(crate) projection: Option<Projection>,
    /// The numbers of the projection by their names, as docs/cameras.md lists them. For the
    /// distortion of a calibrated camera, such as k1=-0.2,k2=0.05
    #[arg(
        long,
        value_name = "NAME=NUMBER,...",
        value_parser = values::parameters,
        requires = "projection",
    )]
    pub(crate) parameters: Option<Parameters>,
    /// Make rays parallel, as --projection orthographic does
    #[arg(long)]
    pub(crate) orthographic: bool,
    /// Where rays start, with t = 0. Rays that start on the viewplane do not meet what is between
    /// it and the eye [default: viewplane with --focal-length, else eye]
    #[arg(long, value_name = "WHERE", value_parser = named::<RayStart>(RayStart::NAMES))]
    pub(crate) ray_start: Option<RayStart>,
    /// Columns and rows of pixels [default: 1024x768; with --viewplane as many rows as make square
    /// pixels; 1024x512 of a panorama]
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = values::pixels)]
    pub(crate) size: Option<[usize; 2]>,
}
