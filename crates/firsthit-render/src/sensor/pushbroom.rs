//! A line of pixels that is swept over a scene.

use super::moving::Lines;
use super::{Record, Sensor};
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, DVec3, Ray, Rays, require};
use crate::trajectory::Trajectory;

/// A camera of one row of pixels that moves, and sees a row of the picture at each of some times: a
/// line scanner, or the camera of a satellite or an aeroplane.
///
/// The camera's position, aim and up are in the coordinates of the body that the trajectory moves.
/// Row k of the picture is what the camera sees at `times[k]`, all of it at once. `range` and `z`
/// are those of its place and aim at that time.
///
/// ```
/// use firsthit::sensor::Pushbroom;
/// use firsthit::{Camera, DVec3, Pose, Rays, Trajectory, View};
///
/// // It looks down, and flies to the north.
/// let [from, to] = [0.0, 100.0].map(|y| Pose { position: DVec3::new(0.0, y, 500.0), ..Pose::IDENTITY });
/// let flight = Trajectory::new(vec![0.0, 2.0], vec![from, to])?;
/// let line = Camera::new(View { rows: 1, columns: 1000, ..View::default() })?;
/// let sensor = Pushbroom::new(&line, &flight, (0..=200).map(|k| 0.01 * f64::from(k)).collect())?;
/// assert_eq!(sensor.ray(100_000).origin.y, 50.0);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Pushbroom {
    lines: Lines,
}

summary!(Pushbroom, "Pushbroom", |it| "camera": it.lines.mounted, "rows": it.lines.times.len());

impl Pushbroom {
    /// The camera, carried by a body, at a time in seconds for each row of the picture.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a camera of several rows, for no
    /// times, and for those that the trajectory refuses;
    /// [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub fn new(camera: &Camera, body: &Trajectory, times: Vec<f64>) -> Result<Self> {
        let rows = camera.rows();
        require("camera", "one of a single row of pixels", rows == 1, rows)?;
        require("times", "at least one", !times.is_empty(), times.len())?;
        let lines = Lines::new(camera, body, times)?;
        Ok(Self { lines })
    }

    /// The time of each row, in seconds.
    pub fn times(&self) -> &[f64] {
        &self.lines.times
    }

    fn columns(&self) -> usize {
        self.lines.mounted.columns()
    }
}

impl Rays for Pushbroom {
    fn len(&self) -> usize {
        self.lines.times.len().saturating_mul(self.columns())
    }

    fn ray(&self, index: usize) -> Ray {
        self.lines.cameras[index / self.columns()].ray(0, index % self.columns())
    }
}

impl Sensor for Pushbroom {
    fn shape(&self) -> [usize; 2] {
        [self.lines.times.len(), self.columns()]
    }

    fn ray_within(&self, pixel: usize, offset: DVec2) -> Ray {
        let (row, column) = (pixel / self.columns(), pixel % self.columns());
        self.lines.cameras[row].ray_within(0, column, offset)
    }

    fn through(&self, point: DVec2) -> Option<Box<dyn Sensor>> {
        let lines = self.lines.through(point)?;
        Some(Box::new(Self { lines }))
    }

    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2] {
        let (row, column) = (pixel / self.columns(), pixel % self.columns());
        let camera = &self.lines.cameras[row];
        [camera.range(0, column, t), camera.z(0, column, t)]
    }

    fn time(&self, pixel: usize) -> Option<f64> {
        self.lines.times.get(pixel / self.columns()).copied()
    }

    fn camera(&self) -> Option<&Camera> {
        self.lines.middle()
    }

    fn place(&self, pixel: usize) -> (DVec3, Option<DVec3>) {
        let camera = &self.lines.cameras[pixel / self.columns()];
        (camera.position(), Some(camera.aim()))
    }

    fn record(&self) -> Record {
        let mut record = self.lines.record("pushbroom", self.shape(), self);
        let (first, last) = (self.times()[0], self.times()[self.times().len() - 1]);
        let numbers = [("first_time", first), ("last_time", last)];
        record.parameters = numbers.map(|(name, value)| (name.to_owned(), value)).into();
        Record::Other(Box::new(record))
    }
}
