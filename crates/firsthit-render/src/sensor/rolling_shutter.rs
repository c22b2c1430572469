//! A camera whose lines are read out one after the other while it moves.

use super::moving::Lines;
use super::{Record, Sensor};
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, DVec3, Ray, Rays, named, require};
use crate::memory;
use crate::trajectory::Trajectory;

named! {
    /// The order in which the lines of a picture are read out.
    pub enum Readout, "readout direction":
    /// The top row first.
    #[default]
    "top_down" => TopDown;
    /// The bottom row first.
    "bottom_up" => BottomUp;
    /// The left column first.
    "left_right" => LeftRight;
    /// The right column first.
    "right_left" => RightLeft;
}

impl Readout {
    /// Whether lines are rows.
    fn is_by_rows(self) -> bool {
        matches!(self, Self::TopDown | Self::BottomUp)
    }

    /// Whether the line with the highest number is read out first.
    fn is_reversed(self) -> bool {
        matches!(self, Self::BottomUp | Self::RightLeft)
    }
}

/// A camera that moves while its lines are read out one after the other.
///
/// The camera's position, aim and up are in the coordinates of the body that the trajectory moves.
/// With n lines (rows, or columns where it is read out sideways), the line that is read out as
/// number k, from 0, is seen at the time `start + (k + 0.5) / n * readout`, all of it at once:
/// where the trajectory is then, the camera is. `range` and `z` are those of that place and aim.
///
/// ```
/// use firsthit::sensor::{Readout, RollingShutter, Sensor};
/// use firsthit::{Camera, DVec3, Pose, Trajectory, View};
///
/// // To the right, at one unit in a second.
/// let [from, to] = [0.0, 1.0].map(|x| Pose { position: DVec3::new(x, 0.0, 0.0), ..Pose::IDENTITY });
/// let drive = Trajectory::new(vec![0.0, 1.0], vec![from, to])?;
/// let camera = Camera::new(View { rows: 10, columns: 10, ..View::default() })?;
/// let sensor = RollingShutter::new(&camera, &drive, 0.0, 1.0, Readout::TopDown)?;
/// assert_eq!(sensor.time(25), Some(0.25));
/// assert_eq!(sensor.line(2).position().x, 0.25);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct RollingShutter {
    lines: Lines,
    start: f64,
    readout: f64,
    direction: Readout,
}

summary!(RollingShutter, "RollingShutter", |it| "camera": it.lines.mounted, "start": it.start, "readout": it.readout,
    "direction": it.direction);

impl RollingShutter {
    /// The camera, carried by a body; `start` is when the first line begins and `readout` how long
    /// all lines take together, in seconds.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a `readout` that is negative or not
    /// finite and for times that the trajectory refuses;
    /// [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub fn new(
        camera: &Camera,
        body: &Trajectory,
        start: f64,
        readout: f64,
        direction: Readout,
    ) -> Result<Self> {
        require("start", "finite", start.is_finite(), start)?;
        let fine = readout >= 0.0 && readout.is_finite();
        require("readout", "finite and not negative", fine, readout)?;
        let count = if direction.is_by_rows() { camera.rows() } else { camera.columns() };
        let mut times = memory::filled(count, 0.0)?;
        for (line, time) in times.iter_mut().enumerate() {
            let number = if direction.is_reversed() { count - 1 - line } else { line };
            *time = start + (number as f64 + 0.5) / count as f64 * readout;
        }
        Ok(Self { lines: Lines::new(camera, body, times)?, start, readout, direction })
    }

    /// The time of each row, or of each column where it is read out sideways, in seconds.
    pub fn times(&self) -> &[f64] {
        &self.lines.times
    }

    /// The camera as it is when a line is seen.
    ///
    /// # Panics
    ///
    /// For a line that there is not.
    pub fn line(&self, line: usize) -> &Camera {
        &self.lines.cameras[line]
    }

    /// The line, the row and the column of a pixel.
    fn place_of(&self, pixel: usize) -> (usize, usize, usize) {
        let columns = self.lines.mounted.columns();
        let (row, column) = (pixel / columns, pixel % columns);
        let line = if self.direction.is_by_rows() { row } else { column };
        (line, row, column)
    }
}

impl Rays for RollingShutter {
    fn len(&self) -> usize {
        self.lines.mounted.pixels()
    }

    fn ray(&self, index: usize) -> Ray {
        let (line, row, column) = self.place_of(index);
        self.lines.cameras[line].ray(row, column)
    }
}

impl Sensor for RollingShutter {
    fn shape(&self) -> [usize; 2] {
        [self.lines.mounted.rows(), self.lines.mounted.columns()]
    }

    fn ray_within(&self, pixel: usize, offset: DVec2) -> Ray {
        let (line, row, column) = self.place_of(pixel);
        self.lines.cameras[line].ray_within(row, column, offset)
    }

    fn through(&self, point: DVec2) -> Option<Box<dyn Sensor>> {
        let lines = self.lines.through(point)?;
        Some(Box::new(Self {
            lines,
            start: self.start,
            readout: self.readout,
            direction: self.direction,
        }))
    }

    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2] {
        let (line, row, column) = self.place_of(pixel);
        let camera = &self.lines.cameras[line];
        [camera.range(row, column, t), camera.z(row, column, t)]
    }

    fn time(&self, pixel: usize) -> Option<f64> {
        let (line, ..) = self.place_of(pixel);
        self.lines.times.get(line).copied()
    }

    fn camera(&self) -> Option<&Camera> {
        self.lines.middle()
    }

    fn place(&self, pixel: usize) -> (DVec3, Option<DVec3>) {
        let (line, ..) = self.place_of(pixel);
        let camera = &self.lines.cameras[line];
        (camera.position(), Some(camera.aim()))
    }

    fn record(&self) -> Record {
        let mut record = self.lines.record("rolling_shutter", self.shape(), self);
        let numbers = [("start", self.start), ("readout", self.readout)];
        record.parameters = numbers.map(|(name, value)| (name.to_owned(), value)).into();
        let word = self.direction.name().to_owned();
        record.words.insert("direction".to_owned(), word);
        Record::Other(Box::new(record))
    }
}
