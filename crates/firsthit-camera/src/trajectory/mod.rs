//! Poses over time: where a moving body is, also between the times at which its pose is given.
//!
//! A [`Trajectory`] is a list of times and poses, and a way to go from one to the next. Times are
//! seconds, positions scene units. It is read from text ([`TrajectoryFormat`]) and written as text.
//!
//! ```
//! use std::path::Path;
//!
//! use firsthit::trajectory::{BodyAxes, Interpolation, TrajectoryFormat};
//!
//! let text = "# timestamp tx ty tz qx qy qz qw\n\
//!     0.0 0 0 0 0 0 0 1\n\
//!     0.1 1 0 0 0 0 0 1\n";
//! let trajectory = TrajectoryFormat::Tum.read(text.as_bytes(), Path::new("groundtruth.txt"))?;
//! let trajectory = trajectory.interpolated(Interpolation::Se3)?;
//! let pose = trajectory.at(0.05)?;
//! assert_eq!(pose.position.x, 0.5);
//! // The body is a camera of OpenCV's axes: it looks along z.
//! let camera = pose.camera(BodyAxes::RightDownForwards);
//! # Ok::<(), firsthit::Error>(())
//! ```
//!
//! The same trajectory and time give the same bits on every machine.

mod axes;
mod kinds;
mod pose;
mod read;
mod rotation;
mod screw;
mod spline;
mod write;

pub use axes::BodyAxes;
pub use kinds::{Extrapolation, Interpolation};
pub use pose::Pose;
pub use read::{TrajectoryFormat, read_csv, read_kitti, read_kitti_times, read_ros, read_tum};

use crate::error::{Error, Result};
use crate::geometry::summary::{Count, summary};
use crate::geometry::{DVec3, require};
use crate::memory;
use rotation::{exp, log, unit_rotation};

/// Poses at increasing times, and what is between them.
///
/// ```
/// use firsthit::trajectory::Extrapolation;
/// use firsthit::{DVec3, Pose, Trajectory};
///
/// let [here, there] = [0.0, 4.0].map(|x| Pose { position: DVec3::new(x, 0.0, 0.0), ..Pose::IDENTITY });
/// let trajectory = Trajectory::new(vec![10.0, 12.0], vec![here, there])?;
/// assert_eq!(trajectory.at(11.0)?.position, DVec3::new(2.0, 0.0, 0.0));
/// assert!(trajectory.at(13.0).is_err());
/// assert_eq!(trajectory.extrapolated(Extrapolation::Hold).at(13.0)?, there);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Trajectory {
    times: Vec<f64>,
    poses: Vec<Pose>,
    interpolation: Interpolation,
    extrapolation: Extrapolation,
    /// Velocity and angular velocity (in the body's axes) at each pose, for splines; else nothing.
    rates: Vec<[DVec3; 2]>,
}

summary!(Trajectory, "Trajectory", |it| "poses": Count(it.poses.len(), "poses"), "start": it.start(), "end": it.end(),
    "interpolation": it.interpolation, "extrapolation": it.extrapolation);

/// The largest rates of a spline, times the duration of a stretch: lengths and angles whose sums
/// and squares are finite.
const LARGEST_RATES: [f64; 2] = [1e250, 1e100];

impl Trajectory {
    /// The trajectory through `poses`, the body being at `poses[k]` at `times[k]` seconds. It is
    /// linear between them and refuses other times.
    ///
    /// Rotations are brought to length one, and to the sign that is nearer to the one before: both
    /// signs are the same rotation.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`], with the index from 0, for times that are not finite, are beyond 10^150
    /// or do not increase, and for what [`Pose::new`] refuses; also for no poses and for another
    /// number of times than of poses.
    pub fn new(times: Vec<f64>, mut poses: Vec<Pose>) -> Result<Self> {
        require("poses", "at least one", !poses.is_empty(), poses.len())?;
        if times.len() != poses.len() {
            let got = format!("{} for {} poses", times.len(), poses.len());
            return Err(Error::argument("times", "as many as poses", got));
        }
        check_times(&times)?;
        let mut before = poses[0].rotation;
        for (index, pose) in poses.iter_mut().enumerate() {
            if !pose::is_in_range(pose.position) {
                let got = format!("{} at index {index}", pose.position);
                return Err(Error::argument("positions", "finite, within 1e150", got));
            }
            let Some(unit) = unit_rotation(pose.rotation) else {
                let expected = "quaternions of length one, within 0.001";
                let got = format!("{} at index {index}", pose.rotation);
                return Err(Error::argument("rotations", expected, got));
            };
            pose.rotation = if before.dot(unit) < 0.0 { -unit } else { unit };
            before = pose.rotation;
        }
        Ok(Self {
            times,
            poses,
            interpolation: Interpolation::default(),
            extrapolation: Extrapolation::default(),
            rates: Vec::new(),
        })
    }

    /// The trajectory with another interpolation between its poses.
    ///
    /// # Errors
    ///
    /// For a spline, [`Error::Argument`] where poses are so far apart in so little time that its
    /// rates leave float64, and [`Error::Limit`] when memory is short.
    pub fn interpolated(mut self, interpolation: Interpolation) -> Result<Self> {
        self.interpolation = interpolation;
        self.rates = Vec::new();
        // Two poses are a straight line, and one is a place.
        if interpolation == Interpolation::Spline && self.poses.len() > 2 {
            self.rates = self.spline_rates()?;
        }
        Ok(self)
    }

    /// The trajectory with another extrapolation beyond its poses.
    pub fn extrapolated(mut self, extrapolation: Extrapolation) -> Self {
        self.extrapolation = extrapolation;
        self
    }

    /// The motion of the body with other names for its axes: from the axes `from` to the axes `to`.
    ///
    /// ```
    /// use firsthit::trajectory::BodyAxes;
    /// use firsthit::{DVec3, Pose, Trajectory};
    ///
    /// let camera = Trajectory::new(vec![0.0], vec![Pose::IDENTITY])?;
    /// let car = camera.in_axes(BodyAxes::RightUpBackwards, BodyAxes::ForwardsLeftUp);
    /// assert_eq!(car.at(0.0)?.rotation * DVec3::X, DVec3::NEG_Z);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn in_axes(mut self, from: BodyAxes, to: BodyAxes) -> Self {
        if from == to {
            return self;
        }
        let turn = from.body_from_camera() * to.body_from_camera().conjugate();
        for pose in &mut self.poses {
            let rotation = pose.rotation * turn;
            pose.rotation = unit_rotation(rotation).unwrap_or(rotation);
        }
        // Angular velocities are in the body's axes.
        for [_, turning] in &mut self.rates {
            *turning = turn.conjugate() * *turning;
        }
        self
    }

    /// The times of the poses in seconds, strictly increasing.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The poses, at least one. Rotations have length one, and signs that go together.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// The time of the first pose.
    pub fn start(&self) -> f64 {
        self.times[0]
    }

    /// The time of the last pose.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// The interpolation from one pose to the next.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The extrapolation beyond the poses.
    pub fn extrapolation(&self) -> Extrapolation {
        self.extrapolation
    }

    /// The pose of the body at `time`, in seconds. At the time of a pose it is that pose, bit for
    /// bit.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a time that is no number, and for one before the first or after the
    /// last pose unless the trajectory [holds](Extrapolation::Hold) those.
    pub fn at(&self, time: f64) -> Result<Pose> {
        let (start, end) = (self.start(), self.end());
        let is_inside = start <= time && time <= end;
        if time.is_nan() || !(is_inside || self.extrapolation == Extrapolation::Hold) {
            let expected = "within the times of the trajectory";
            let got = format!("{time}, which is not from {start} to {end}");
            return Err(Error::argument("time", expected, got));
        }
        let next = self.times.partition_point(|&knot| knot <= time);
        let Some(before) = next.checked_sub(1) else {
            return Ok(self.poses[0]);
        };
        if next == self.times.len() || self.times[before] == time {
            return Ok(self.poses[before]);
        }
        Ok(self.between(before, time))
    }

    /// The pose after the knot `k` and before the next.
    fn between(&self, k: usize, time: f64) -> Pose {
        let duration = self.times[k + 1] - self.times[k];
        let s = (time - self.times[k]) / duration;
        let [from, to] = [self.poses[k], self.poses[k + 1]];
        let whole = to.position - from.position;
        if let (Some(first), Some(last)) = (self.rates.get(k), self.rates.get(k + 1)) {
            let ends = [0, 1].map(|kind| [first[kind], last[kind]].map(|rate| duration * rate));
            let rotation = spline::cubic_turn(s, [from.rotation, to.rotation], ends[1]);
            return Pose {
                position: from.position + spline::cubic(s, whole, ends[0]),
                rotation: rotation / rotation.length(),
            };
        }
        let turn = log(to.rotation * from.rotation.conjugate());
        let moved = match self.interpolation {
            Interpolation::Se3 => screw::screw(s, whole, turn),
            Interpolation::Linear | Interpolation::Spline => s * whole,
        };
        // Slerp (Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985) by the
        // rotation vector, which does not divide by the sine of the angle.
        let rotation = exp(s * turn) * from.rotation;
        Pose { position: from.position + moved, rotation: rotation / rotation.length() }
    }

    fn spline_rates(&self) -> Result<Vec<[DVec3; 2]>> {
        let count = self.poses.len();
        let mut means = memory::filled(count - 1, DVec3::ZERO)?;
        let mut turns = memory::filled(count - 1, DVec3::ZERO)?;
        for (k, pair) in self.poses.windows(2).enumerate() {
            let duration = self.times[k + 1] - self.times[k];
            means[k] = (pair[1].position - pair[0].position) / duration;
            turns[k] = log(pair[0].rotation.conjugate() * pair[1].rotation) / duration;
        }
        let velocities = spline::natural_rates(&self.times, &means)?;
        let turns = spline::natural_rates(&self.times, &turns)?;
        let mut rates = memory::filled(count, [DVec3::ZERO; 2])?;
        for (k, rate) in rates.iter_mut().enumerate() {
            *rate = [velocities[k], turns[k]];
            let around = &self.times[k.saturating_sub(1)..(k + 2).min(count)];
            let longest = around[around.len() - 1] - around[0];
            // So that a NaN fails.
            let is_fine = |kind: usize| {
                let moved = (longest * rate[kind]).abs().to_array();
                moved.iter().all(|&x| x <= LARGEST_RATES[kind])
            };
            if !(is_fine(0) && is_fine(1)) {
                let expected = "far enough apart for a spline";
                let got = format!("{} at index {k}", self.times[k]);
                return Err(Error::argument("times", expected, got));
            }
        }
        Ok(rates)
    }
}

/// Checks that times are finite and increase.
fn check_times(times: &[f64]) -> Result<()> {
    let mut before = f64::NEG_INFINITY;
    for (index, &time) in times.iter().enumerate() {
        // So that a NaN fails.
        let is_fine = time.abs() <= pose::FARTHEST;
        if !is_fine {
            let got = format!("{time} at index {index}");
            return Err(Error::argument("times", "finite, within 1e150", got));
        }
        if time <= before {
            let got = format!("{time} at index {index} after {before}");
            return Err(Error::argument("times", "strictly increasing", got));
        }
        before = time;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
