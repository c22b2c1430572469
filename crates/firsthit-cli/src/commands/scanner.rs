//! The scanner that options describe, turn by turn.

use firsthit::camera::Convention;
use firsthit::image::read_regular;
use firsthit::sensor::{Lidar, Lissajous, Pattern, Raster, Rosette, Spinning};
use firsthit::trajectory::{BodyAxes, TrajectoryFormat};
use firsthit::{DAffine3, DMat3, DVec3, Pose, Trajectory};

use crate::args::{Given, PlaceArgs, ScannerArgs};
use crate::camera::matrix_of_file;
use crate::failure::Failure;
use crate::hints::number;

/// The largest trajectory or table that is read, in bytes.
const MOST_BYTES: u64 = 1 << 30;

/// The options that some scanners take and others do not, each with those that do.
const TAKERS: [(&str, &[&str]); 16] = [
    ("columns", &["lidar", "elevations", "raster"]),
    ("rate", &["lidar", "elevations", "raster"]),
    ("azimuth-start", &["elevations"]),
    ("azimuth-end", &["elevations"]),
    ("direction", &["elevations"]),
    ("rows", &["raster"]),
    ("serpentine", &["raster"]),
    ("flash", &["raster"]),
    ("frequencies", &["rosette", "lissajous"]),
    ("points", &["rosette", "lissajous"]),
    ("point-rate", &["rosette", "lissajous"]),
    ("share", &["rosette"]),
    ("phase", &["lissajous"]),
    // A table of beams has times of its own.
    ("start", &["lidar", "elevations", "raster", "rosette", "lissajous"]),
    ("turns", &["lidar", "elevations", "raster", "rosette", "lissajous"]),
    ("duration", &["lidar", "elevations", "raster", "rosette", "lissajous"]),
];

/// A scanner: of a head, a picture of a raster, or all points of a curve in each turn.
pub(super) struct Scanner<'a> {
    args: &'a ScannerArgs,
    drive: Option<Trajectory>,
    /// The beams of a table.
    table: Option<Pattern>,
    /// The time of the first turn's first firing, in seconds.
    start: f64,
    /// Rows and columns of a turn.
    pub(super) shape: [usize; 2],
    pub(super) name: String,
    pub(super) turns: usize,
}

impl<'a> Scanner<'a> {
    pub(super) fn of(
        given: &Given,
        args: &'a ScannerArgs,
        place: &PlaceArgs,
    ) -> Result<Self, Failure> {
        check(given)?;
        let drive = drive(given, place)?;
        let table = args
            .pattern
            .as_ref()
            .map(|path| Pattern::read_csv(&read_regular(path, MOST_BYTES)?, path));
        let mut scanner = Self {
            args,
            table: table.transpose()?,
            start: args.start.or(drive.as_ref().map(Trajectory::start)).unwrap_or_default(),
            drive,
            shape: [0; 2],
            name: String::new(),
            turns: 1,
        };
        let first = scanner.pattern(0)?;
        scanner.shape = first.shape();
        first.name().clone_into(&mut scanner.name);
        scanner.turns = scanner.count()?;
        let columns = scanner.turns.checked_mul(scanner.shape[1]);
        if columns.is_none_or(|columns| columns >= 1 << 31) {
            return Err(Failure::usage(format!(
                "all turns must have fewer than 2^31 columns, got {} turns of {}",
                scanner.turns, scanner.shape[1]
            )));
        }
        Ok(scanner)
    }

    /// The scanner in one of its turns.
    pub(super) fn at(&self, turn: usize, pose: Pose) -> Result<Lidar, Failure> {
        let pattern = self.pattern(turn)?;
        Ok(match &self.drive {
            Some(drive) => Lidar::carried(pattern, pose, drive)?,
            None => Lidar::new(pattern, pose)?,
        })
    }

    /// Whether its pose depends on what is up in the 3D file.
    pub(super) fn needs_up(&self, place: &PlaceArgs) -> bool {
        place.pose.is_none() && place.up.is_none() && self.drive.is_none()
    }

    /// Its pose in the world, or in the coordinates of the body that carries it; `up` is that of
    /// the 3D file.
    pub(super) fn pose(&self, place: &PlaceArgs, up: DVec3) -> Result<Pose, Failure> {
        if let Some(path) = &place.pose {
            let matrix = Convention::OpenGl.pose(matrix_of_file(path)?);
            return Ok(Pose::from_matrix(
                &matrix.map_err(|error| Failure::from(error).in_file(path))?,
            )?);
        }
        let position = place.position.unwrap_or(DVec3::ZERO);
        let axes = if self.drive.is_some() {
            let body = place.body.unwrap_or(BodyAxes::ForwardsLeftUp);
            let ahead = BodyAxes::ForwardsLeftUp.body_from_camera().conjugate();
            let turn = Pose::new(DVec3::ZERO, body.body_from_camera() * ahead)?;
            let axes = turn.world_from_body().matrix3;
            // Axes go to axes: what is not -1, 0 or 1 is rounding.
            DMat3::from_cols(axes.x_axis.round(), axes.y_axis.round(), axes.z_axis.round())
        } else {
            axes(place.aim, place.up.unwrap_or(up))?
        };
        Ok(Pose::from_matrix(&DAffine3::from_mat3_translation(axes, position))?)
    }

    /// The beams of a turn.
    fn pattern(&self, turn: usize) -> Result<Pattern, Failure> {
        let args = self.args;
        let rate = args.rate.unwrap_or(10.0);
        let start = self.start + turn as f64 / rate;
        if let Some(model) = args.lidar {
            return Ok(model.pattern(rate, args.columns, start)?);
        }
        if let Some(lasers) = &args.elevations {
            let usual = Spinning::default();
            return Ok(Pattern::spinning(&Spinning {
                elevations: lasers.0.clone(),
                columns: args.columns.unwrap_or(usual.columns),
                azimuth_start: args.azimuth_start.unwrap_or(usual.azimuth_start),
                azimuth_end: args.azimuth_end.unwrap_or(usual.azimuth_end),
                direction: args.direction.unwrap_or_default(),
                rate,
                start,
                ..usual
            })?);
        }
        if let Some([horizontal_fov, vertical_fov]) = args.raster {
            if args.flash && args.serpentine {
                let what = "--serpentine must be left out with --flash, whose points are at once";
                return Err(Failure::usage(what));
            }
            return Ok(Pattern::raster(&Raster {
                horizontal_fov,
                vertical_fov,
                rows: args.rows.ok_or_else(|| needed("raster", "rows"))?,
                columns: args.columns.ok_or_else(|| needed("raster", "columns"))?,
                rate: if args.flash { 0.0 } else { rate },
                is_serpentine: args.serpentine,
                start,
            })?);
        }
        match &self.table {
            Some(table) => Ok(table.clone()),
            None => self.curve(turn),
        }
    }

    /// The points of a turn, whose curve continues from turn to turn.
    fn curve(&self, turn: usize) -> Result<Pattern, Failure> {
        let args = self.args;
        let kind = if args.rosette.is_some() { "rosette" } else { "lissajous" };
        let frequencies = args.frequencies.ok_or_else(|| needed(kind, "frequencies"))?;
        let points = args.points.ok_or_else(|| needed(kind, "points"))?;
        let point_rate = args.point_rate.ok_or_else(|| needed(kind, "point-rate"))?;
        let start = self.start + turn as f64 * points as f64 / point_rate;
        let made = match (args.rosette, args.lissajous) {
            (_, Some([horizontal_fov, vertical_fov])) => Pattern::lissajous(&Lissajous {
                horizontal_fov,
                vertical_fov,
                frequencies,
                phase: args.phase.unwrap_or(90.0),
                points,
                point_rate,
                start,
            }),
            (fov, None) => Pattern::rosette(&Rosette {
                fov: fov.unwrap_or_default(),
                frequencies,
                share: args.share.unwrap_or(0.5),
                points,
                point_rate,
                start,
            }),
        };
        Ok(made?)
    }

    /// The number of turns.
    fn count(&self) -> Result<usize, Failure> {
        let args = self.args;
        let (what, seconds) = match (args.turns, args.duration, &self.drive) {
            (Some(turns), ..) => return Ok(turns),
            _ if self.table.is_some() => return Ok(1),
            (_, Some(seconds), _) => ("--duration", seconds),
            (.., Some(drive)) => ("--trajectory, after the start,", drive.end() - self.start),
            _ => return Ok(1),
        };
        let rate = args.rate.unwrap_or(10.0);
        let (rate, too_long) = if let (Some(points), Some(rate)) = (args.points, args.point_rate) {
            let turn = number(points as f64 / rate);
            let what = format!("the {turn} s of {points} points: say --turns or fewer --points");
            (rate / points as f64, what)
        } else {
            let noun = args.raster.map_or("turn", |_| "picture");
            let turn = number(1.0 / rate);
            (rate, format!("a {noun} of {turn} s: say --turns or another --rate"))
        };
        // A turn that is longer by rounding alone fits.
        let turns = (seconds * rate + 1e-6).floor();
        if turns < 1.0 {
            return Err(Failure::usage(format!(
                "{what} has {} s, less than {too_long}",
                number(seconds)
            )));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "too many are refused"
        )]
        Ok(turns as usize)
    }
}

/// The failure of a scanner that lacks an option.
fn needed(kind: &str, option: &str) -> Failure {
    Failure::usage(format!("--{kind} needs --{option}"))
}

/// Refuses options of other scanners.
fn check(given: &Given) -> Result<(), Failure> {
    let kinds = ["lidar", "elevations", "raster", "rosette", "lissajous"];
    let kind = kinds.into_iter().find(|kind| given.has(kind)).unwrap_or("pattern");
    for (name, takers) in TAKERS {
        if given.has(name) && !takers.contains(&kind) {
            let takers: Vec<String> = takers.iter().map(|taker| format!("--{taker}")).collect();
            return Err(Failure::usage(match kind {
                "pattern" => format!("--{name} must be left out with --pattern"),
                _ => format!("--{name} needs {}", takers.join(" or ")),
            }));
        }
    }
    Ok(())
}

/// The motion of the body that carries the scanner, if one does.
fn drive(given: &Given, place: &PlaceArgs) -> Result<Option<Trajectory>, Failure> {
    let Some(path) = &place.trajectory else {
        return Ok(None);
    };
    if let Some(option) = ["aim", "up"].into_iter().find(|option| given.has(option)) {
        return Err(Failure::usage(format!(
            "--{option} must be left out with --trajectory: give a --pose"
        )));
    }
    let format = place.trajectory_format.unwrap_or(TrajectoryFormat::Csv);
    if place.body.is_none() && matches!(format, TrajectoryFormat::Tum | TrajectoryFormat::Kitti) {
        return Err(Failure::usage(format!(
            "--body must be given with --trajectory-format {}",
            format.name()
        )));
    }
    let drive = format.read(&read_regular(path, MOST_BYTES)?, path)?;
    let drive = drive.interpolated(place.interpolation.unwrap_or_default())?;
    Ok(Some(drive.extrapolated(place.extrapolation.unwrap_or_default())))
}

/// The axes forwards, left and up of a scanner that stands still.
fn axes(aim: Option<DVec3>, up: DVec3) -> Result<DMat3, Failure> {
    let is_along_x = up.x.abs() > 0.9 * up.length();
    let forwards = aim.unwrap_or(if is_along_x { DVec3::Y } else { DVec3::X });
    let left = up.cross(forwards);
    // Of two that are parallel the product is rounding.
    let is_flat = left.length() <= 1e-9 * up.length() * forwards.length();
    if is_flat || left.length().is_nan() {
        let what = "--aim and --up must be directions that are not parallel";
        return Err(Failure::usage(what));
    }
    // Without an aim the world's forwards, as far as up allows.
    let forwards = if aim.is_some() { forwards } else { left.cross(up) };
    let (left, forwards) = (left / left.length(), forwards / forwards.length());
    Ok(DMat3::from_cols(forwards, left, forwards.cross(left)))
}
