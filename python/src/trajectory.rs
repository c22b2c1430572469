//! Trajectories, which carry sensors.

use std::path::PathBuf;

use firsthit::image::{read_regular, write_whole};
use firsthit::trajectory::{BodyAxes, TrajectoryFormat, read_kitti, read_kitti_times};
use firsthit::{DAffine3, DMat3, DQuat, DVec3, Error, Pose};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{collected, copied};
use crate::errors::{Outcome, Raised};
use crate::sensor::{MOST_BYTES, matrix_of, vectors};

/// A trajectory.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Trajectory(pub(crate) firsthit::Trajectory);

/// Times, positions and rotations, flat, and what is between and beyond poses.
type TrajectoryOut<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    [&'static str; 2],
);

#[pymethods]
impl Trajectory {
    /// Poses at times: positions, and quaternions (x, y, z, w), flat.
    #[new]
    fn new(
        py: Python<'_>,
        times: PyReadonlyArray1<'_, f64>,
        positions: PyReadonlyArray1<'_, f64>,
        rotations: PyReadonlyArray1<'_, f64>,
        interpolation: &str,
        extrapolation: &str,
    ) -> Outcome<Self> {
        let times = copied(times.as_slice()?)?;
        let positions = vectors(positions.as_slice()?)?;
        let (rotations, _) = rotations.as_slice()?.as_chunks::<4>();
        if rotations.len() != positions.len() {
            return Err(Raised::value("expected a rotation for each position"));
        }
        let poses = positions
            .iter()
            .zip(rotations)
            .map(|(&position, &turn)| Pose { position, rotation: DQuat::from_array(turn) });
        let poses = collected(rotations.len(), poses)?;
        py.detach(|| {
            let trajectory = firsthit::Trajectory::new(times, poses)?;
            let trajectory = trajectory.interpolated(interpolation.parse()?)?;
            Ok(Self(trajectory.extrapolated(extrapolation.parse()?)))
        })
    }

    /// The quaternions (x, y, z, w) of rigid matrices of 3 rows of 4, flat.
    #[staticmethod]
    fn rotations<'py>(
        py: Python<'py>,
        matrices: PyReadonlyArray1<'py, f64>,
    ) -> Outcome<Bound<'py, PyArray1<f64>>> {
        let (matrices, _) = matrices.as_slice()?.as_chunks::<12>();
        let mut rotations = Vec::with_capacity(4 * matrices.len());
        for (index, m) in matrices.iter().enumerate() {
            let column = |k: usize| DVec3::new(m[k], m[4 + k], m[8 + k]);
            let rotation = DMat3::from_cols(column(0), column(1), column(2));
            let pose = DAffine3::from_mat3_translation(rotation, column(3));
            let pose = Pose::from_matrix(&pose)
                .map_err(|error| Raised::value(format!("matrices: at index {index}: {error}")))?;
            rotations.extend(pose.rotation.to_array());
        }
        Ok(PyArray1::from_vec(py, rotations))
    }

    /// A trajectory from a file; `times` is KITTI's file of them.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        kind: &str,
        times: Option<PathBuf>,
        interpolation: &str,
        extrapolation: &str,
    ) -> Outcome<Self> {
        py.detach(|| {
            let format: TrajectoryFormat = kind.parse()?;
            let text = read_regular(&path, MOST_BYTES)?;
            let trajectory = match times {
                Some(times) if format == TrajectoryFormat::Kitti => {
                    let seconds = read_kitti_times(&read_regular(&times, MOST_BYTES)?, &times)?;
                    read_kitti(&text, &path, Some(&seconds))?
                }
                Some(_) => {
                    let expected = "left out: only KITTI has them in a file of their own";
                    return Err(Error::argument("times", expected, format.name()).into());
                }
                None => format.read(&text, &path)?,
            };
            let trajectory = trajectory.interpolated(interpolation.parse()?)?;
            Ok(Self(trajectory.extrapolated(extrapolation.parse()?)))
        })
    }

    /// Writes it as CSV or as TUM does.
    fn write(&self, py: Python<'_>, path: PathBuf, kind: &str) -> Outcome<()> {
        py.detach(|| {
            let format: TrajectoryFormat = kind.parse()?;
            Ok(match format {
                TrajectoryFormat::Csv => write_whole(&path, &(), |out| self.0.write_csv(out)),
                TrajectoryFormat::Tum => write_whole(&path, &(), |out| self.0.write_tum(out)),
                _ => Err(Error::argument("format", "csv or tum", format.name())),
            }?)
        })
    }

    /// The poses and settings that it is made from.
    fn parts<'py>(&self, py: Python<'py>) -> TrajectoryOut<'py> {
        let poses = self.0.poses();
        let positions = poses.iter().flat_map(|pose| pose.position.to_array());
        let rotations = poses.iter().flat_map(|pose| pose.rotation.to_array());
        (
            PyArray1::from_slice(py, self.0.times()),
            PyArray1::from_iter(py, positions),
            PyArray1::from_iter(py, rotations),
            [self.0.interpolation().name(), self.0.extrapolation().name()],
        )
    }

    /// The matrices at some times, row by row.
    fn at<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'py, f64>,
    ) -> Outcome<Bound<'py, PyArray1<f64>>> {
        let times = times.as_slice()?;
        let matrices = times.iter().map(|&time| Ok(matrix_of(&self.0.at(time)?)));
        let matrices: firsthit::Result<Vec<[[f64; 4]; 4]>> = matrices.collect();
        let matrices = matrices?;
        let flat = matrices.into_flattened().into_flattened();
        Ok(PyArray1::from_vec(py, flat))
    }

    /// The motion of the body with other axes.
    fn in_axes(&self, given: &str, wanted: &str) -> Outcome<Self> {
        Ok(Self(self.0.clone().in_axes(given.parse()?, wanted.parse()?)))
    }
}

/// The matrix that takes coordinates of one kind of axes to those of another, row by row.
#[pyfunction]
pub(crate) fn axes_from(wanted: &str, given: &str) -> Outcome<[[f64; 4]; 4]> {
    let [wanted, given]: [BodyAxes; 2] = [wanted.parse()?, given.parse()?];
    let turn = wanted.body_from_camera() * given.body_from_camera().conjugate();
    let pose = Pose::new(DVec3::ZERO, turn)?;
    // Axes go to axes: what is not -1, 0 or 1 is rounding.
    Ok(matrix_of(&pose).map(|row| row.map(f64::round)))
}
