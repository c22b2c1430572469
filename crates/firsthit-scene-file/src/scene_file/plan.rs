//! Every key of a plan of a data set, which the package for Python makes.

use super::camera::{LINE_CAMERA, RIG_CAMERA};
use super::plan_output::WRITTEN;
use super::table::{Form, Key, Pick, Record, Rule, keys, optional, record, required};
use crate::geometry::Domain;
use crate::sensor::{Readout, Turn};
use crate::trajectory::{BodyAxes, Extrapolation, Interpolation, TrajectoryFormat};

/// The most frames of a scene.
const MOST_FRAMES: i64 = 1_000_000_000;
/// The most rows, columns and rays of a sensor.
const MOST: i64 = 1 << 31;

pub(super) const SIZE: Form = Form::Whole(1, MOST);
pub(super) const NUMBERS: Form = Form::Array(&Form::NUMBER, 1, usize::MAX);
pub(super) const PAIR: Form = Form::Array(&Form::NUMBER, 2, 2);
const NAMES: Form = Form::Array(&Form::Text, 2, 2);
const CLASS: Form = Form::Either(&Form::Text, &Form::FLAG);
const BODY: Form = Form::OneOf(|| BodyAxes::NAMES.to_vec());
const DEGREES: Form = Form::Of(Domain::From(-360.0, 360.0));
const ELEVATION: Form = Form::Of(Domain::From(-90.0, 90.0));

pub(super) static PLAN: Record = record! {
    "plan", "A plan of a data set for firsthit: scenes, sensors, poses, and what is written.";
    Pick::Always => [keys! {
        /// The version of this form of plan. There is one, 1, which is the default.
        version: optional(Form::Whole(1, 1)),
        /// The scenes.
        scenes: required(Form::List(&PLANNED_SCENE)),
        /// The sensors, all on one rig, whose axes are forwards, left, up.
        sensors: required(Form::List(&SENSOR)),
        /// The rig's poses.
        poses: required(Form::Table(&POSES)),
        /// Files to write. Default: an NPZ of colours for each camera, and an NPZ for each lidar.
        output: optional(Form::Table(&WRITTEN)),
    }];
};

static PLANNED_SCENE: Record = record! {
    "planned_scene", "A scene.";
    Pick::Always => [keys! {
        /// A file that firsthit reads, relative to the plan and in its folder or below.
        file: required(Form::Path),
        /// The name in records. Default: file.
        name: optional(Form::Text),
        /// Names or patterns of objects, and their classes; false for no class.
        classes: optional(Form::Named(&CLASS)),
        /// The direction upwards, of any length. Default: what the scene says.
        up: optional(Form::DIRECTION),
        /// The meaning of one instance. Default: object.
        by: optional(Form::OneOf(|| vec!["object", "node"])),
        /// Keypoints of classes, each a table [scenes.keypoints.CLASS].
        keypoints: optional(Form::Named(&Form::Table(&KEYPOINTS))),
    }];
};

static KEYPOINTS: Record = record! {
    "keypoints", "Points of a class, and lines between them.";
    Pick::Always => [keys! {
        /// Names and places.
        points: required(Form::Named(&Form::VECTOR)),
        /// The space of the places. Default: object.
        frame: optional(Form::OneOf(|| vec!["object", "world"])),
        /// Pairs of names.
        skeleton: optional(Form::Array(&NAMES, 0, usize::MAX)),
        /// How far from a point its surface may be. Default: 0.
        tolerance: optional(Form::NON_NEGATIVE),
    }];
};

const NAME: &[Key] = keys! {
    /// The name of its files: letters, digits, _ and -. Default: kind.
    name: optional(Form::Text),
};

const ANNOTATE: &[Key] = keys! {
    /// Whether its pictures are annotated, where annotations are asked for. Default: true for a
    /// camera, false for a moving one.
    annotate: optional(Form::FLAG),
};

const ROLLING: &[Key] = keys! {
    /// The seconds that all lines take together. The first begins at the frame's time.
    readout: required(Form::NON_NEGATIVE),
    /// The order of the lines. Default: top_down.
    direction: optional(Form::OneOf(|| Readout::NAMES.to_vec())),
};

const SWEPT: &[Key] = keys! {
    /// How many rows there are.
    lines: required(SIZE),
    /// How many of them in a second.
    line_rate: required(Form::POSITIVE),
};

const SCANNED: &[Key] = keys! {
    /// Its place on the rig. Default: [0, 0, 0].
    position: optional(Form::VECTOR),
    /// The rows of the matrix that takes its coordinates to the rig's, instead of position.
    pose: optional(Form::Matrix),
    /// Which of a beam's returns are kept. Default: first.
    returns: optional(Form::OneOf(|| vec!["first", "last", "strongest", "all"])),
    /// The angle of a beam, in degrees.
    divergence: optional(Form::NUMBER),
    /// How many rays a beam has. Default: 16.
    subrays: optional(SIZE),
    /// The distance within which returns are one. Default: 0.
    range_gate: optional(Form::NUMBER),
    /// The most returns of a beam.
    max_returns: optional(SIZE),
    /// The least distance. Default: 0.
    min_range: optional(Form::NUMBER),
    /// The largest distance.
    max_range: optional(Form::NUMBER),
    /// Whether returns have an intensity. Default: false.
    intensity: optional(Form::FLAG),
    /// How lasers are numbered. Default: maker.
    rings: optional(Form::OneOf(|| vec!["maker", "lowest-first"])),
    /// Numbers of classes by the names of objects.
    classes: optional(Form::Named(&Form::Whole(0, 255))),
    /// The standard deviation of distances; or two numbers, and the second for each unit of
    /// distance.
    noise: optional(Form::Either(&Form::NUMBER, &PAIR)),
    /// The share of returns that are lost.
    dropout: optional(Form::NUMBER),
};

static SENSOR: Record = record! {
    "sensor", "A sensor on the rig.";
    Pick::Default("kind", "camera") => [NAME, ANNOTATE] [Rule::Also(&RIG_CAMERA)];
    Pick::Tag("kind", "rolling_shutter") => [NAME, ANNOTATE, ROLLING] [Rule::Also(&RIG_CAMERA)];
    Pick::Tag("kind", "pushbroom") => [NAME, ANNOTATE, SWEPT] [Rule::Also(&LINE_CAMERA)];
    Pick::Tag("kind", "lidar") => [NAME, SCANNED] [Rule::NotBoth("position", "pose"), Rule::Also(&BEAMS)];
};

const MOVING: &[Key] = keys! {
    /// Whether each beam starts where the rig is at its time. Default: false.
    moving: optional(Form::FLAG),
};

const RATE: &[Key] = keys! {
    /// Turns or frames in a second. Default: 10.
    rate: optional(Form::POSITIVE),
};

const FOVS: &[Key] = keys! {
    /// Degrees across.
    horizontal_fov: required(Form::NUMBER),
    /// Degrees from the lowest beam to the highest.
    vertical_fov: required(Form::NUMBER),
};

const POINTS: &[Key] = keys! {
    /// The two frequencies of the pattern, in turns a second.
    frequencies: required(PAIR),
    /// How many points there are.
    points: required(SIZE),
    /// How many of them in a second.
    point_rate: required(Form::POSITIVE),
};

static BEAMS: Record = record! {
    "lidar", "The beams of a lidar: of a model, from a file, or in a pattern.";
    Pick::Has("model") => [MOVING, RATE, keys! {
        /// The name of a model, such as vlp-16, in any case.
        model: required(Form::Text),
        /// Columns of a turn. Default: the model's.
        columns: optional(SIZE),
    }];
    Pick::Has("file") => [keys! {
        /// A table of beams (CSV), with times of its own.
        file: required(Form::Path),
    }];
    Pick::Tag("pattern", "spinning") => [MOVING, RATE, keys! {
        /// The elevation of each laser, in degrees.
        elevations: required(NUMBERS),
        /// Columns of a turn. Default: 1024.
        columns: optional(SIZE),
        /// The azimuth of the first column, in degrees. Default: 180.
        azimuth_start: optional(Form::NUMBER),
        /// The azimuth at which the turn ends. Default: -180.
        azimuth_end: optional(Form::NUMBER),
        /// The direction of the rotation, seen from above. Default: clockwise.
        direction: optional(Form::OneOf(|| Turn::NAMES.to_vec())),
        /// The azimuth of each laser from its column's, in degrees.
        azimuth_offsets: optional(NUMBERS),
        /// The time of each laser from its column's, in seconds.
        firing_offsets: optional(NUMBERS),
    }];
    Pick::Tag("pattern", "raster") => [MOVING, RATE, FOVS, keys! {
        /// Rows of beams.
        rows: required(SIZE),
        /// Columns of beams.
        columns: required(SIZE),
        /// Whether every other row goes backwards. Default: false.
        serpentine: optional(Form::FLAG),
    }];
    Pick::Tag("pattern", "rosette") => [MOVING, POINTS, keys! {
        /// The angle of the circle that holds the pattern, in degrees.
        fov: required(Form::NUMBER),
        /// The first prism's share of the deflection. Default: 0.5.
        share: optional(Form::NUMBER),
    }];
    Pick::Tag("pattern", "lissajous") => [MOVING, POINTS, FOVS, keys! {
        /// The phase between the two, in degrees. Default: 90.
        phase: optional(Form::NUMBER),
    }];
};

const SEED: &[Key] = keys! {
    /// The seed of all random numbers. Default: 0.
    seed: optional(Form::Whole(0, i64::MAX)),
};

const BY_CHANCE: &[Key] = keys! {
    /// How many poses there are in each scene.
    count: required(Form::Whole(1, MOST_FRAMES)),
    /// Limits of a turn about the forwards, in degrees. Default: 0.
    roll: optional(Form::Span(&DEGREES)),
    /// The direction that elevations count from, and the rig's up. Default: the scene's up.
    up: optional(Form::DIRECTION),
    /// The least distance of the nearest surface. Default: 0.
    clearance: optional(Form::NON_NEGATIVE),
    /// Whether places inside of objects are refused. Default: false.
    outside_objects: optional(Form::FLAG),
    /// How many places are tried for a frame. Default: 100.
    tries: optional(Form::Whole(1, 1_000_000)),
};

static POSES: Record = record! {
    "poses", "The poses of the rig.";
    Pick::Tag("kind", "sphere") => [SEED, BY_CHANCE, keys! {
        /// The point that the rig looks at. Default: the middle of the scene's bounds.
        center: optional(Form::VECTOR),
        /// The distance of the rig, or two: those between them are as likely.
        radius: required(Form::Span(&Form::POSITIVE)),
        /// Limits in degrees. Default: [-180, 180].
        azimuth: optional(Form::Span(&DEGREES)),
        /// Limits in degrees. Default: [-90, 90].
        elevation: optional(Form::Span(&ELEVATION)),
    }];
    Pick::Tag("kind", "inside") => [SEED, BY_CHANCE, keys! {
        /// The box's lower corner. Default: that of the scene's bounds.
        low: optional(Form::VECTOR),
        /// The box's upper corner.
        high: optional(Form::VECTOR),
        /// Limits of the forwards' azimuth, in degrees. Default: [-180, 180].
        yaw: optional(Form::Span(&DEGREES)),
        /// Limits of the forwards' elevation, in degrees. Default: 0.
        pitch: optional(Form::Span(&ELEVATION)),
    }] [Rule::Needs("low", "high"), Rule::Needs("high", "low")];
    Pick::Tag("kind", "path") => [SEED, keys! {
        /// The way of the rig.
        trajectory: required(Form::Table(&TRAJECTORY)),
        /// Frames in a second, from start to end.
        rate: optional(Form::POSITIVE),
        /// So many frames, evenly from start to end.
        count: optional(Form::Whole(1, MOST_FRAMES)),
        /// The times themselves.
        times: optional(NUMBERS),
        /// For rate and count. Default: the trajectory's.
        start: optional(Form::NUMBER),
        /// For rate and count. Default: the trajectory's.
        end: optional(Form::NUMBER),
    }] [
        Rule::NotBoth("rate", "times"),
        Rule::NotBoth("rate", "count"),
        Rule::NotBoth("times", "count"),
        Rule::NotBoth("times", "start"),
        Rule::NotBoth("times", "end"),
    ];
    Pick::Tag("kind", "list") => [SEED, keys! {
        /// Which ways the body's axes point.
        body: required(BODY),
        /// Matrices that take the body's coordinates to the world's: rows, 3 x 4 or 4 x 4 each.
        matrices: optional(Form::Array(&Form::Matrix, 1, usize::MAX)),
        /// An array (n, 4, 4) or (n, 3, 4) as NPY.
        file: optional(Form::Path),
    }] [Rule::OneOf("matrices", "file")];
};

const BETWEEN: &[Key] = keys! {
    /// Which ways the axes of its poses point.
    body: required(BODY),
    /// Poses between two that are given. Default: linear.
    interpolation: optional(Form::OneOf(|| Interpolation::NAMES.to_vec())),
    /// Poses before the first and after the last. Default: refuse.
    extrapolation: optional(Form::OneOf(|| Extrapolation::NAMES.to_vec())),
};

static TRAJECTORY: Record = record! {
    "trajectory", "Poses over time.";
    Pick::Has("file") => [BETWEEN, keys! {
        /// A file of poses.
        file: required(Form::Path),
        /// Its format. Default: csv.
        format: optional(Form::OneOf(|| TrajectoryFormat::NAMES.to_vec())),
        /// The file of the times, of KITTI.
        times_file: optional(Form::Path),
    }];
    Pick::Has("times") => [BETWEEN, keys! {
        /// Seconds, rising.
        times: required(NUMBERS),
        /// A place for each time.
        positions: required(Form::Array(&Form::VECTOR, 1, usize::MAX)),
        /// A quaternion [x, y, z, w] for each time.
        rotations: optional(Form::Array(&Form::Quaternion, 1, usize::MAX)),
    }];
};
