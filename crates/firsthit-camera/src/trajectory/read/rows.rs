//! The poses of a text, checked one by one, so that an error names its line.

use std::path::Path;

use super::super::Trajectory;
use super::super::pose::Pose;
use super::super::rotation::unit_rotation;
use super::text::{Field, wrong};
use crate::error::{Place, Result};
use crate::geometry::{DQuat, DVec3};
use crate::memory;

/// The poses of a trajectory that have been read.
#[derive(Debug, Default)]
pub(super) struct Rows {
    times: Vec<f64>,
    poses: Vec<Pose>,
}

impl Rows {
    /// The number of poses.
    pub(super) fn len(&self) -> usize {
        self.poses.len()
    }

    /// Adds the pose in fields of `x y z qx qy qz qw`, at a time that stands in `at`.
    pub(super) fn add(&mut self, time: f64, at: Field<'_>, pose: &[Field<'_>; 7]) -> Result<()> {
        if let Some(before) = self.times.last().filter(|&&before| time <= before) {
            let what = format!("time {time} s is not after {before} s, that of the pose before");
            return Err(at.error(what));
        }
        let mut numbers = [0.0; 7];
        for (number, field) in numbers.iter_mut().zip(pose) {
            *number = field.number()?;
        }
        let [x, y, z, qx, qy, qz, qw] = numbers;
        let rotation = DQuat::from_xyzw(qx, qy, qz, qw);
        let Some(unit) = unit_rotation(rotation) else {
            let length = rotation.length();
            let what = format!("the quaternion has the length {length}, not 1 within 0.001");
            let [_, _, _, qx, ..] = pose;
            return Err(qx.error(what));
        };
        self.push(time, DVec3::new(x, y, z), unit)
    }

    /// Adds a pose that has been checked.
    pub(super) fn push(&mut self, time: f64, position: DVec3, rotation: DQuat) -> Result<()> {
        let full = |_| memory::no_room_for("poses of a trajectory");
        self.times.try_reserve(1).map_err(full)?;
        self.poses.try_reserve(1).map_err(full)?;
        self.times.push(time);
        self.poses.push(Pose { position, rotation });
        Ok(())
    }

    /// The trajectory, if there is a pose.
    pub(super) fn finish(self, path: &Path) -> Result<Trajectory> {
        if self.poses.is_empty() {
            return Err(wrong(path, Place::File, "there are no poses in it"));
        }
        Trajectory::new(self.times, self.poses)
    }
}
