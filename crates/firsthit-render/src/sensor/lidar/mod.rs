//! Laser scanners: a pattern of beams, and where the scanner is at the time of each.

mod csv;
mod models;
mod pattern;
mod scanned;
mod spinning;
mod tables;

pub use models::LidarModel;
pub use pattern::Pattern;
pub use scanned::{Lissajous, Raster, Rosette};
pub use spinning::{Spinning, Turn};

use std::collections::BTreeMap;

use super::moving::{digest_of, rows_of, trajectory_record};
use super::{Record, Sensor};
use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, DVec3, Ray, Rays, require};
use crate::image::{SensorRecord, TrajectoryRecord};
use crate::memory;
use crate::trajectory::{Pose, Trajectory};

/// A laser scanner: a [`Pattern`] of beams at a place, or carried by a body that moves while it
/// scans.
///
/// Its own frame is that of ROS (REP 103): x forwards, y to the left, z upwards. All beams start at
/// its origin. A beam's direction has length one, so that `t` is `range`; it has no aim, and so no
/// `z`. Where it moves, each beam starts where the scanner is at the time of the beam.
///
/// ```
/// use firsthit::sensor::{Lidar, LidarModel, Sensor};
/// use firsthit::{Pose, Rays};
///
/// let pattern = LidarModel::Vlp16.pattern(10.0, None, 0.0)?;
/// let lidar = Lidar::new(pattern, Pose::IDENTITY)?;
/// assert_eq!(lidar.shape(), [16, 1808]);
/// // The highest beam is the top row.
/// assert!((lidar.ray(0).direction.z - 15_f64.to_radians().sin()).abs() < 1e-15);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Lidar {
    pattern: Pattern,
    /// The pose in the world, or in the coordinates of the body that carries it.
    mount: Pose,
    /// The poses in the world: one for all beams, or one for each.
    poses: Vec<Pose>,
    trajectory: Option<TrajectoryRecord>,
}

summary!(Lidar, "Lidar", |it| "pattern": it.pattern, "mount": it.mount, "moves": it.trajectory.is_some());

/// A return: where it is on its beam, and which beam that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Return {
    /// The position in the world, along the middle of the beam, in scene units.
    pub point: DVec3,
    /// The position in the scanner's frame at the time of the beam, in scene units.
    pub sensor_point: DVec3,
    /// The number of the laser.
    pub ring: i32,
    /// The row of the beam in the scanner's picture, from 0 at the top.
    pub row: i32,
    /// The column of the beam, from 0 on the left.
    pub column: i32,
    /// The time of the beam, in seconds.
    pub time: f64,
}

impl Lidar {
    /// The scanner at a pose, which takes its coordinates to the world's.
    ///
    /// # Errors
    ///
    /// The errors of [`Pose::new`].
    pub fn new(pattern: Pattern, pose: Pose) -> Result<Self> {
        let pose = Pose::new(pose.position, pose.rotation)?;
        Ok(Self { pattern, mount: pose, poses: vec![pose], trajectory: None })
    }

    /// The scanner carried by a body: `mount` takes its coordinates to the body's.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) where a beam is at a time that the
    /// trajectory refuses, and [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub fn carried(pattern: Pattern, mount: Pose, body: &Trajectory) -> Result<Self> {
        let mount = Pose::new(mount.position, mount.rotation)?;
        let times = pattern.times();
        let mut poses = memory::filled(times.len(), mount)?;
        for (pose, &time) in poses.iter_mut().zip(times) {
            *pose = body.at(time)?.then(&mount);
        }
        let trajectory = Some(trajectory_record(body, times)?);
        Ok(Self { pattern, mount, poses, trajectory })
    }

    /// The pattern of beams.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// The pose of the scanner at the time of a pixel's beam: it takes its coordinates to the
    /// world's.
    ///
    /// # Panics
    ///
    /// For a pixel that there is not, where the scanner moves.
    pub fn pose(&self, pixel: usize) -> Pose {
        self.poses[if self.poses.len() == 1 { 0 } else { pixel }]
    }

    /// The return at a distance `range`, in scene units, along the beam of a pixel. Pixels are
    /// counted row by row.
    ///
    /// # Panics
    ///
    /// For a pixel that there is not.
    pub fn return_at(&self, pixel: usize, range: f64) -> Return {
        let [_, columns] = self.shape();
        let pose = self.pose(pixel);
        let direction = self.pattern.direction(pixel);
        // A pattern has at most 2^26 beams, so neither is ever replaced.
        let [row, column] =
            [pixel / columns, pixel % columns].map(|x| i32::try_from(x).unwrap_or(i32::MAX));
        Return {
            point: pose.position + range * (pose.rotation * direction),
            sensor_point: range * direction,
            ring: self.pattern.rings()[pixel],
            row,
            column,
            time: self.pattern.times()[pixel],
        }
    }

    /// Directions in the world, of length one, that fill the cone of a pixel's beam: its middle
    /// first, then along a spiral of equal areas to the edge. `divergence` is the full angle of the
    /// cone in radians.
    ///
    /// The point number j of n is at the angle `divergence / 2 * sqrt(j / (n - 1))` from the
    /// middle, turned by j golden angles (Vogel, "A better way to construct the sunflower head",
    /// Mathematical Biosciences 44, 1979).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a `divergence` below zero or of pi
    /// and more.
    pub fn spread(&self, pixel: usize, divergence: f64, into: &mut [DVec3]) -> Result<()> {
        /// Pi times (3 minus the root of 5).
        const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
        let fine = (0.0..std::f64::consts::PI).contains(&divergence);
        require("divergence", "from 0 to below pi", fine, divergence)?;
        let middle = self.pattern.direction(pixel);
        let rotation = self.pose(pixel).rotation;
        // Any two that are perpendicular to the beam and to each other.
        let across = middle.any_orthonormal_vector();
        let along = middle.cross(across);
        let last = into.len().saturating_sub(1).max(1) as f64;
        for (j, direction) in into.iter_mut().enumerate() {
            let (sine, cosine) = libm::sincos(0.5 * divergence * (j as f64 / last).sqrt());
            let (up, right) = libm::sincos(GOLDEN_ANGLE * j as f64);
            let spread = cosine * middle + sine * (right * across + up * along);
            *direction = rotation * if j == 0 { middle } else { spread };
        }
        Ok(())
    }
}

impl Rays for Lidar {
    fn len(&self) -> usize {
        self.pattern.times().len()
    }

    fn ray(&self, index: usize) -> Ray {
        let pose = self.pose(index);
        Ray::new(pose.position, pose.rotation * self.pattern.direction(index))
    }
}

impl Sensor for Lidar {
    fn shape(&self) -> [usize; 2] {
        self.pattern.shape()
    }

    fn ray_within(&self, pixel: usize, _offset: DVec2) -> Ray {
        self.ray(pixel)
    }

    fn range_and_z(&self, _pixel: usize, t: f64) -> [f64; 2] {
        [t, if t == f64::INFINITY { t } else { f64::NAN }]
    }

    fn has_aim(&self) -> bool {
        false
    }

    fn time(&self, pixel: usize) -> Option<f64> {
        self.pattern.times().get(pixel).copied()
    }

    fn place(&self, pixel: usize) -> (DVec3, Option<DVec3>) {
        (self.pose(pixel).position, None)
    }

    fn record(&self) -> Record {
        let [rows, columns] = self.shape();
        let name = ("pattern".to_owned(), self.pattern.name().to_owned());
        Record::Other(Box::new(SensorRecord {
            kind: "lidar".to_owned(),
            rows: rows as u64,
            columns: columns as u64,
            digest: digest_of(self),
            parameters: self.pattern.parameters().clone(),
            words: BTreeMap::from([name]),
            axes: Some("forwards, left, up".to_owned()),
            pose: Some(rows_of(&self.mount.world_from_body())),
            camera: None,
            trajectory: self.trajectory.clone(),
        }))
    }
}
