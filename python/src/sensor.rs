//! Sensors other than cameras.

use std::path::PathBuf;
use std::sync::Arc;

use firsthit::camera::Convention;
use firsthit::image::read_regular;
use firsthit::sensor::{
    Lidar, LidarModel, Lissajous, Pushbroom, Raster, RaySensor, RollingShutter, Rosette,
    Sensor as AnySensor, Spinning,
};
use firsthit::{DVec3, Pose};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{collected, copied};
use crate::camera::Camera;
use crate::errors::{Outcome, Raised};
use crate::run::run;
use crate::sensor_rays::checked_pixels;
use crate::trajectory::Trajectory;

/// The largest trajectory or table that is read, in bytes.
pub(crate) const MOST_BYTES: u64 = 1 << 30;

/// A checked sensor that is no camera.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Sensor {
    any: Arc<dyn AnySensor + Send + Sync>,
    lidar: Option<Arc<Lidar>>,
}

/// The sensor that makes the rays of a picture.
#[derive(FromPyObject)]
pub(crate) enum SensorIn<'py> {
    Camera(Bound<'py, Camera>),
    Sensor(Bound<'py, Sensor>),
}

impl SensorIn<'_> {
    pub(crate) fn sensor(&self) -> &(dyn AnySensor + Send + Sync) {
        match self {
            Self::Camera(camera) => &camera.get().0,
            Self::Sensor(sensor) => &*sensor.get().any,
        }
    }
}

impl Sensor {
    fn made(sensor: impl AnySensor + Send + Sync + 'static) -> Self {
        Self { any: Arc::new(sensor), lidar: None }
    }

    pub(crate) fn lidar_of(&self) -> Outcome<&Lidar> {
        let no_lidar = || Raised::value("expected a lidar");
        self.lidar.as_deref().ok_or_else(no_lidar)
    }
}

/// A pose from the rows of its matrix.
fn pose_of(rows: [[f64; 4]; 4]) -> firsthit::Result<Pose> {
    Pose::from_matrix(&Convention::OpenGl.pose(rows)?)
}

pub(crate) fn vectors(flat: &[f64]) -> Outcome<Vec<DVec3>> {
    let (vectors, _) = flat.as_chunks::<3>();
    collected(vectors.len(), vectors.iter().map(|&v| DVec3::from(v)))
}

#[pymethods]
impl Sensor {
    /// A table of rays: of origins and directions one for all, or one for each.
    #[staticmethod]
    fn table(
        origins: PyReadonlyArray1<'_, f64>,
        directions: PyReadonlyArray1<'_, f64>,
        shape: [usize; 2],
        aim: Option<[f64; 3]>,
    ) -> Outcome<Self> {
        let origins = vectors(origins.as_slice()?)?;
        let directions = vectors(directions.as_slice()?)?;
        let sensor = RaySensor::new(origins, directions, shape)?;
        Ok(Self::made(match aim {
            Some(aim) => sensor.aimed(DVec3::from(aim))?,
            None => sensor,
        }))
    }

    /// A camera whose lines are read out one after the other.
    #[staticmethod]
    fn rolling_shutter(
        camera: &Camera,
        body: &Trajectory,
        start: f64,
        readout: f64,
        direction: &str,
    ) -> Outcome<Self> {
        let shutter = RollingShutter::new(&camera.0, &body.0, start, readout, direction.parse()?);
        Ok(Self::made(shutter?))
    }

    /// A camera of one row, at a time for each row of the picture.
    #[staticmethod]
    fn pushbroom(
        camera: &Camera,
        body: &Trajectory,
        times: PyReadonlyArray1<'_, f64>,
    ) -> Outcome<Self> {
        let times = copied(times.as_slice()?)?;
        Ok(Self::made(Pushbroom::new(&camera.0, &body.0, times)?))
    }

    /// A laser scanner at a pose in the world, or in the coordinates of the body that carries it.
    #[staticmethod]
    fn lidar(
        py: Python<'_>,
        pattern: &Pattern,
        pose: [[f64; 4]; 4],
        body: Option<&Trajectory>,
    ) -> Outcome<Self> {
        let lidar = run(py, 1, |_| {
            let (pattern, pose) = (pattern.0.clone(), pose_of(pose)?);
            match body {
                Some(body) => Lidar::carried(pattern, pose, &body.0),
                None => Lidar::new(pattern, pose),
            }
        })?;
        let lidar = Arc::new(lidar);
        Ok(Self { any: lidar.clone(), lidar: Some(lidar) })
    }

    /// Rows and columns.
    fn shape(&self) -> [usize; 2] {
        self.any.shape()
    }

    /// Whether there is an aim, along which `z` is measured.
    fn has_aim(&self) -> bool {
        self.any.has_aim()
    }

    /// The times of some pixels in seconds, if there are times.
    fn times<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray1<'py, i64>,
    ) -> Outcome<Option<Bound<'py, PyArray1<f64>>>> {
        let times = checked_pixels(&pixels, self.any.len())?.map(|pixel| self.any.time(pixel));
        let times: Option<Vec<f64>> = times.collect();
        Ok(times.map(|times| PyArray1::from_vec(py, times)))
    }

    /// The sensor's positions at the times of some pixels' rays and its aims then, NaN where it has
    /// none: six numbers for each.
    fn places<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray1<'py, i64>,
    ) -> Outcome<Bound<'py, PyArray1<f64>>> {
        let places = checked_pixels(&pixels, self.any.len())?.flat_map(|pixel| {
            let (position, aim) = self.any.place(pixel);
            [position, aim.unwrap_or(DVec3::NAN)].map(|v| v.to_array())
        });
        let places: Vec<[f64; 3]> = places.collect();
        Ok(PyArray1::from_vec(py, places.into_flattened()))
    }

    /// The matrices of a lidar's poses at the times of some pixels, row by row.
    fn poses<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray1<'py, i64>,
    ) -> Outcome<Bound<'py, PyArray1<f64>>> {
        let lidar = self.lidar_of()?;
        let pixels = checked_pixels(&pixels, self.any.len())?;
        let poses = pixels.map(|pixel| matrix_of(&lidar.pose(pixel)));
        let poses: Vec<[[f64; 4]; 4]> = poses.collect();
        let flat = poses.into_flattened().into_flattened();
        Ok(PyArray1::from_vec(py, flat))
    }
}

/// The matrix of a pose, row by row.
pub(crate) fn matrix_of(pose: &Pose) -> [[f64; 4]; 4] {
    Convention::OpenGl.matrix(&pose.world_from_body())
}

/// The beams of a laser scanner.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Pattern(firsthit::sensor::Pattern);

/// Azimuths and elevations, directions, times, and the numbers of lasers.
type BeamsOut<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i32>>,
);

#[pymethods]
impl Pattern {
    /// A head that turns. `azimuths` are those of the start and the end, `time` the rate and the
    /// start; `offsets` those of azimuths and firings.
    #[staticmethod]
    fn spinning(
        elevations: Vec<f64>,
        columns: usize,
        azimuths: [f64; 2],
        direction: &str,
        time: [f64; 2],
        offsets: (Vec<f64>, Vec<f64>),
    ) -> Outcome<Self> {
        let made = firsthit::sensor::Pattern::spinning(&Spinning {
            elevations,
            columns,
            azimuth_start: azimuths[0],
            azimuth_end: azimuths[1],
            direction: direction.parse()?,
            rate: time[0],
            start: time[1],
            azimuth_offsets: offsets.0,
            firing_offsets: offsets.1,
        });
        Ok(Self(made?))
    }

    /// The names of the models.
    #[staticmethod]
    fn models() -> &'static [&'static str] {
        LidarModel::NAMES
    }

    /// A model by its name.
    #[staticmethod]
    fn named(name: &str, rate: f64, columns: Option<usize>, start: f64) -> Outcome<Self> {
        let model: LidarModel = name.parse()?;
        Ok(Self(model.pattern(rate, columns, start)?))
    }

    /// Rows and columns of equal angles.
    #[staticmethod]
    fn raster(
        fov: [f64; 2],
        size: [usize; 2],
        is_serpentine: bool,
        time: [f64; 2],
    ) -> Outcome<Self> {
        let made = firsthit::sensor::Pattern::raster(&Raster {
            horizontal_fov: fov[0],
            vertical_fov: fov[1],
            rows: size[0],
            columns: size[1],
            rate: time[0],
            is_serpentine,
            start: time[1],
        });
        Ok(Self(made?))
    }

    /// The rose of two prisms.
    #[staticmethod]
    fn rosette(
        fov: f64,
        frequencies: [f64; 2],
        share: f64,
        points: usize,
        time: [f64; 2],
    ) -> Outcome<Self> {
        let made = firsthit::sensor::Pattern::rosette(&Rosette {
            fov,
            frequencies,
            share,
            points,
            point_rate: time[0],
            start: time[1],
        });
        Ok(Self(made?))
    }

    /// The figure of a mirror that swings.
    #[staticmethod]
    fn lissajous(
        fov: [f64; 2],
        frequencies: [f64; 2],
        phase: f64,
        points: usize,
        time: [f64; 2],
    ) -> Outcome<Self> {
        let made = firsthit::sensor::Pattern::lissajous(&Lissajous {
            horizontal_fov: fov[0],
            vertical_fov: fov[1],
            frequencies,
            phase,
            points,
            point_rate: time[0],
            start: time[1],
        });
        Ok(Self(made?))
    }

    /// Beams in arrays; those of times and rings may be empty.
    #[staticmethod]
    fn table(
        azimuths: PyReadonlyArray1<'_, f64>,
        elevations: PyReadonlyArray1<'_, f64>,
        times: PyReadonlyArray1<'_, f64>,
        rings: PyReadonlyArray1<'_, i32>,
    ) -> Outcome<Self> {
        let made = firsthit::sensor::Pattern::table(
            azimuths.as_slice()?,
            elevations.as_slice()?,
            times.as_slice()?,
            rings.as_slice()?,
        );
        Ok(Self(made?))
    }

    /// Beams in a CSV file.
    #[staticmethod]
    fn read_csv(py: Python<'_>, path: PathBuf) -> Outcome<Self> {
        py.detach(|| {
            let text = read_regular(&path, MOST_BYTES)?;
            Ok(Self(firsthit::sensor::Pattern::read_csv(&text, &path)?))
        })
    }

    /// The source of the pattern: the name of a model or of a kind.
    fn name(&self) -> &str {
        self.0.name()
    }

    /// Rows and columns.
    fn shape(&self) -> [usize; 2] {
        self.0.shape()
    }

    /// All beams, row by row.
    fn beams<'py>(&self, py: Python<'py>) -> Outcome<BeamsOut<'py>> {
        let directions = self.0.directions();
        let flat = directions.iter().flat_map(DVec3::to_array);
        Ok((
            PyArray1::from_slice(py, self.0.azimuths()),
            PyArray1::from_slice(py, self.0.elevations()),
            PyArray1::from_vec(py, collected(3 * directions.len(), flat)?),
            PyArray1::from_slice(py, self.0.times()),
            PyArray1::from_slice(py, self.0.rings()),
        ))
    }
}
