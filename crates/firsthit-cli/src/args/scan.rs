//! Options of a laser scanner: which one it is, where it stands or how it drives, and what of its
//! beams is kept.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use firsthit::DVec3;
use firsthit::scan::{Returns, Rings};
use firsthit::sensor::{LidarModel, Turn};
use firsthit::trajectory::{BodyAxes, Extrapolation, Interpolation, TrajectoryFormat};

use super::{Given, LoadArgs, RunArgs};
use crate::help;
use crate::values::{self, named};

#[derive(Debug, Args)]
#[command(
    after_help = help::SCAN_EXAMPLES,
    override_usage = "firsthit scan [OPTIONS] <SCANNER> <FILE>",
)]
pub(crate) struct ScanArgs {
    #[command(flatten)]
    pub(crate) given: Given,
    /// The 3D file: glTF, GLB, OBJ, PLY, STL, OFF or FHS, or a scene file (TOML)
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) scanner: ScannerArgs,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
    #[command(flatten)]
    pub(crate) returns: ReturnsArgs,
    /// Where to write: .npz, .ply, .pcd, .las, .laz or .csv; may be given several times [default:
    /// the name of the 3D file with -scan.ply]
    #[arg(short, long, value_name = "FILE", help_heading = "General")]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

#[derive(Debug, Args)]
#[command(
    next_help_heading = "Scanner",
    group(ArgGroup::new("scanner").args(["lidar", "elevations", "raster", "rosette", "lissajous", "pattern"]).required(true)),
)]
pub(crate) struct ScannerArgs {
    /// A scanner by its maker's name
    #[arg(
        long,
        value_name = "NAME",
        value_parser = named::<LidarModel>(LidarModel::NAMES),
        ignore_case = true,
    )]
    pub(crate) lidar: Option<LidarModel>,
    /// A head that turns, with N lasers from LOW to HIGH degrees above level
    #[arg(long, value_name = "LOW,HIGH,N", value_parser = values::elevations)]
    pub(crate) elevations: Option<values::Elevations>,
    /// Rows and columns of equal angles ahead, H degrees wide and V degrees high, with --rows and
    /// --columns
    #[arg(long, value_name = "H,V", value_parser = values::pair)]
    pub(crate) raster: Option<[f64; 2]>,
    /// Two prisms that turn, whose beam draws a rose in a circle of FOV degrees, with
    /// --frequencies, --points and --point-rate
    #[arg(long, value_name = "FOV", value_parser = values::finite)]
    pub(crate) rosette: Option<f64>,
    /// A mirror that swings about two axes, H degrees wide and V degrees high, with --frequencies,
    /// --points and --point-rate
    #[arg(long, value_name = "H,V", value_parser = values::pair)]
    pub(crate) lissajous: Option<[f64; 2]>,
    /// A table of beams (CSV): the columns azimuth and elevation in degrees and, where there are
    /// some, time in seconds and ring
    #[arg(long, value_name = "FILE")]
    pub(crate) pattern: Option<PathBuf>,
    /// How often each laser fires in a turn [default: as often as the scanner of --lidar does, else
    /// 1024]; with --raster: points across, without a default
    #[arg(long, value_name = "N", value_parser = values::count)]
    pub(crate) columns: Option<usize>,
    /// Turns in a second, or pictures of a raster [default: 10]
    #[arg(long, value_name = "HZ", value_parser = values::positive)]
    pub(crate) rate: Option<f64>,
    /// With --elevations: where the head starts to turn [default: 180, behind]
    #[arg(long, value_name = "DEGREES", value_parser = values::finite)]
    pub(crate) azimuth_start: Option<f64>,
    /// With --elevations: where the turn ends [default: -180]
    #[arg(long, value_name = "DEGREES", value_parser = values::finite)]
    pub(crate) azimuth_end: Option<f64>,
    /// With --elevations: which way the head turns, seen from above [default: clockwise]
    #[arg(long, value_name = "TURN", value_parser = named::<Turn>(Turn::NAMES))]
    pub(crate) direction: Option<Turn>,
    /// With --raster: points down
    #[arg(long, value_name = "N", value_parser = values::count)]
    pub(crate) rows: Option<usize>,
    /// With --raster: scan every other row from the right
    #[arg(long)]
    pub(crate) serpentine: bool,
    /// With --raster: all points of a picture are at its first time
    #[arg(long)]
    pub(crate) flash: bool,
    /// Turns of the prisms, or swings of the mirror, in a second; a prism with a negative number
    /// turns the other way
    #[arg(long, value_name = "F1,F2", value_parser = values::pair)]
    pub(crate) frequencies: Option<[f64; 2]>,
    /// How many points a turn has
    #[arg(long, value_name = "N", value_parser = values::count)]
    pub(crate) points: Option<usize>,
    /// Points in a second
    #[arg(long, value_name = "HZ", value_parser = values::positive)]
    pub(crate) point_rate: Option<f64>,
    /// With --rosette: the first prism's share of the deflection, from 0 to 1 [default: 0.5]
    #[arg(long, value_name = "SHARE", value_parser = values::share)]
    pub(crate) share: Option<f64>,
    /// With --lissajous: the phase of the upward swing at the time 0 [default: 90]
    #[arg(long, value_name = "DEGREES", value_parser = values::finite)]
    pub(crate) phase: Option<f64>,
    /// The time of the first firing [default: the trajectory's first time, else 0]
    #[arg(long, value_name = "SECONDS", value_parser = values::finite)]
    pub(crate) start: Option<f64>,
    /// How often the head turns, or how many pictures a raster has, or how often the --points of a
    /// rose or a Lissajous figure follow [default: as often as fits into the trajectory, else once]
    #[arg(long, value_name = "N", value_parser = values::count)]
    pub(crate) turns: Option<usize>,
    /// As many whole turns as fit into this time
    #[arg(long, value_name = "SECONDS", value_parser = values::positive, conflicts_with = "turns")]
    pub(crate) duration: Option<f64>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Place")]
pub(crate) struct PlaceArgs {
    /// Where the scanner is, in scene units; with --trajectory in the body's coordinates [default:
    /// the origin]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) position: Option<DVec3>,
    /// The direction that is forwards, azimuth 0 [default: 1,0,0, or 0,1,0 where up is along x]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) aim: Option<DVec3>,
    /// The direction that is upwards, as far as --aim allows [default: as the 3D file says; OBJ has
    /// 0,1,0 and PLY and STL have 0,0,1, unless the model clearly stands on a flat base along the
    /// other of the two]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector)]
    pub(crate) up: Option<DVec3>,
    /// A text file with the 3 x 4 or 4 x 4 matrix that takes the scanner's coordinates (forwards,
    /// left, up) to the world's, or with --trajectory to the body's: row by row, with blanks or
    /// commas between
    #[arg(long, value_name = "FILE", conflicts_with_all = ["position", "aim", "up"])]
    pub(crate) pose: Option<PathBuf>,
    /// How the body moves that carries the scanner: a table with the columns
    /// time,x,y,z,qx,qy,qz,qw, in seconds and scene units
    #[arg(long, value_name = "FILE")]
    pub(crate) trajectory: Option<PathBuf>,
    /// The format of --trajectory [default: csv]
    #[arg(
        long,
        value_name = "FORMAT",
        value_parser = named::<TrajectoryFormat>(TrajectoryFormat::NAMES),
        requires = "trajectory",
    )]
    pub(crate) trajectory_format: Option<TrajectoryFormat>,
    /// Which ways the axes of the body in --trajectory point [default: forwards-left-up for csv and
    /// ros; tum and kitti need it]
    #[arg(
        long,
        value_name = "AXES",
        value_parser = named::<BodyAxes>(BodyAxes::NAMES),
        requires = "trajectory",
    )]
    pub(crate) body: Option<BodyAxes>,
    /// The motion between the poses [default: linear]
    #[arg(
        long,
        value_name = "HOW",
        value_parser = named::<Interpolation>(Interpolation::NAMES),
        requires = "trajectory",
    )]
    pub(crate) interpolation: Option<Interpolation>,
    /// Whether beams before and after the trajectory are refused, or it stays where it is (hold)
    /// [default: refuse]
    #[arg(
        long,
        value_name = "HOW",
        value_parser = named::<Extrapolation>(Extrapolation::NAMES),
        requires = "trajectory",
    )]
    pub(crate) extrapolation: Option<Extrapolation>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Returns")]
pub(crate) struct ReturnsArgs {
    /// Which returns of a beam are kept; a beam without --divergence has the surfaces that its line
    /// crosses
    #[arg(
        long,
        value_name = "WHICH",
        value_parser = named::<Returns>(Returns::NAMES),
        default_value = "first",
    )]
    pub(crate) returns: Returns,
    /// With --returns all: how many of a beam, the nearest [default: all]
    #[arg(long, value_name = "N", value_parser = values::count)]
    pub(crate) max_returns: Option<usize>,
    /// The full angle of a beam's cone, such as 0.003 [default: a beam is a line]
    #[arg(long, value_name = "RADIANS", value_parser = values::finite)]
    pub(crate) divergence: Option<f64>,
    /// How many lines fill the cone of --divergence [default: 16]
    #[arg(long, value_name = "N", value_parser = values::count, requires = "divergence")]
    pub(crate) subrays: Option<usize>,
    /// Hits up to this far behind the nearest of a return belong to it, in scene units
    #[arg(long, value_name = "LENGTH", value_parser = values::finite, default_value = "0")]
    pub(crate) range_gate: f64,
    /// Ranges are longer than this, and what is nearer blocks its line, in scene units
    #[arg(long, value_name = "LENGTH", value_parser = values::finite, default_value = "0")]
    pub(crate) min_range: f64,
    /// The longest range, in scene units [default: no limit]
    #[arg(long, value_name = "LENGTH", value_parser = values::finite)]
    pub(crate) max_range: Option<f64>,
    /// Add an intensity: the surface's luminance times the cosine of incidence
    #[arg(long)]
    pub(crate) intensity: bool,
    /// How rings count: the maker's numbers, or from the lowest laser on, as drivers of ROS count
    #[arg(
        long,
        value_name = "HOW",
        value_parser = named::<Rings>(Rings::NAMES),
        default_value = "maker",
    )]
    pub(crate) rings: Rings,
    /// The class of the objects of a name, from 0 to 255, as LAS has it: 2 is ground, 6 a building;
    /// may be given several times
    #[arg(long = "class", value_name = "NAME=N", value_parser = values::class)]
    pub(crate) classes: Vec<(String, u8)>,
    /// The standard deviation of ranges: SIGMA in scene units, plus SHARE of the range; needs
    /// --seed
    #[arg(long, value_name = "SIGMA[,SHARE]", value_parser = values::noise)]
    pub(crate) noise: Option<[f64; 2]>,
    /// The probability that a return is lost, from 0 to 1; needs --seed
    #[arg(long, value_name = "SHARE", value_parser = values::share)]
    pub(crate) dropout: Option<f64>,
    /// The seed of --noise and --dropout; turn k, from 0, has the seed N + k
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..1 << 63))]
    pub(crate) seed: Option<u64>,
}
