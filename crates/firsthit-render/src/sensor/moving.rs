//! Cameras that move from line to line, and what files say about trajectories.

use std::collections::BTreeMap;

use super::camera_record;
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::{DAffine3, DVec2, Digest, Rays};
use crate::image::{SensorRecord, TimedPose, TrajectoryRecord};
use crate::memory;
use crate::trajectory::Trajectory;

/// The number of poses of a trajectory that a record shows.
const SAMPLED: usize = 9;

/// The camera of each line of a picture, at the line's time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lines {
    /// The camera in the coordinates of the body that carries it.
    pub(super) mounted: Camera,
    /// The cameras in the world, line by line.
    pub(super) cameras: Vec<Camera>,
    /// The times in seconds, line by line.
    pub(super) times: Vec<f64>,
    trajectory: TrajectoryRecord,
}

impl Lines {
    /// The camera carried by a body, at some times.
    pub(super) fn new(mounted: &Camera, body: &Trajectory, times: Vec<f64>) -> Result<Self> {
        let mut cameras = memory::filled(times.len(), *mounted)?;
        for (camera, &time) in cameras.iter_mut().zip(&times) {
            *camera = mounted.moved(&body.at(time)?.world_from_body())?;
        }
        Ok(Self { mounted: *mounted, cameras, trajectory: trajectory_record(body, &times)?, times })
    }

    /// The lines as they are from a point of the camera's lens, if it has an aperture.
    pub(super) fn through(&self, point: DVec2) -> Option<Self> {
        let cameras = self.cameras.iter().map(|camera| camera.through(point));
        Some(Self {
            mounted: self.mounted.through(point)?,
            cameras: cameras.collect::<Option<_>>()?,
            times: self.times.clone(),
            trajectory: self.trajectory.clone(),
        })
    }

    /// The camera of the middle line.
    pub(super) fn middle(&self) -> Option<&Camera> {
        self.cameras.get(self.cameras.len() / 2)
    }

    /// The record in files of a sensor of these lines.
    pub(super) fn record(
        &self,
        kind: &str,
        [rows, columns]: [usize; 2],
        rays: &dyn Rays,
    ) -> SensorRecord {
        SensorRecord {
            kind: kind.to_owned(),
            rows: rows as u64,
            columns: columns as u64,
            digest: digest_of(rays),
            parameters: BTreeMap::new(),
            words: BTreeMap::new(),
            axes: Some("right, up, backwards".to_owned()),
            pose: Some(rows_of(&self.mounted.world_from_camera())),
            camera: Some(camera_record(&self.mounted)),
            trajectory: Some(self.trajectory.clone()),
        }
    }
}

/// A digest of the origins and directions of all rays.
pub(super) fn digest_of(rays: &dyn Rays) -> String {
    /// The number of rays that are hashed at once: kilobytes are hashed several times as fast as
    /// single vectors.
    const SOME: usize = 1024;
    let mut digest = Digest::default();
    digest.count(rays.len());
    let mut numbers = Vec::with_capacity(6 * SOME.min(rays.len()));
    for first in (0..rays.len()).step_by(SOME) {
        numbers.clear();
        for index in first..rays.len().min(first + SOME) {
            let ray = rays.ray(index);
            numbers.extend(ray.origin.to_array());
            numbers.extend(ray.direction.to_array());
        }
        digest.numbers(&numbers);
    }
    digest.name()
}

/// A matrix row by row.
pub(super) fn rows_of(pose: &DAffine3) -> [[f64; 4]; 4] {
    let row = |k: usize| {
        let [x, y, z] = pose.matrix3.row(k).to_array();
        [x, y, z, pose.translation[k]]
    };
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

/// The record in files of a trajectory, of which these times were asked.
pub(super) fn trajectory_record(body: &Trajectory, times: &[f64]) -> Result<TrajectoryRecord> {
    let mut digest = Digest::default();
    digest.count(body.times().len());
    digest.numbers(body.times());
    for pose in body.poses() {
        digest.vector(pose.position);
        digest.numbers(&pose.rotation.to_array());
    }
    let first = times.iter().copied().fold(f64::INFINITY, f64::min);
    let last = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut sampled = Vec::with_capacity(SAMPLED);
    let count = if first < last { SAMPLED } else { 1 };
    for k in 0..count {
        // The ends are taken as they are: rounding may leave the trajectory's times.
        let share = k as f64 / (count - 1).max(1) as f64;
        let time = if k + 1 == count { last } else { first + share * (last - first) };
        sampled
            .push(TimedPose { time, world_from_body: rows_of(&body.at(time)?.world_from_body()) });
    }
    Ok(TrajectoryRecord {
        digest: digest.name(),
        poses: body.poses().len() as u64,
        start: body.start(),
        end: body.end(),
        interpolation: body.interpolation().name().to_owned(),
        extrapolation: body.extrapolation().name().to_owned(),
        sampled,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{DVec3, Ray};

    #[test]
    fn a_digest_of_many_rays_is_that_of_their_vectors_one_by_one() {
        for count in [0, 1, 1024, 2500] {
            let rays: Vec<Ray> = (0..count)
                .map(|k| Ray::new(DVec3::splat(f64::from(k)), DVec3::new(1.0, f64::from(k), 0.5)))
                .collect();
            let mut expected = Digest::default();
            expected.count(rays.len());
            for ray in &rays {
                expected.vector(ray.origin);
                expected.vector(ray.direction);
            }
            assert_eq!(digest_of(&rays), expected.name(), "{count}");
        }
    }
}
