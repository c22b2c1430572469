//! The nearest points of a scene.

use firsthit::nearest::{
    NearestSettings, SignSettings, closest_points as find, signed_distances_with,
};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors::Outcome;
use crate::measure::measured;
use crate::run::{FEW, run_sized};
use crate::scene::Scene;

/// Distance, object and primitive, and the coordinates of points and of the weights of corners 1
/// and 2, flat.
type Found<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// The points of the scene that are nearest to each of `points`, C-contiguous of shape (n, 3).
#[pyfunction]
pub(crate) fn closest_points<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: PyReadonlyArray2<'py, f64>,
    wanted: (usize, f64),
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<Found<'py>> {
    let points = points.as_slice()?.as_chunks().0;
    let (count, radius) = wanted;
    let wanted = NearestSettings { count, radius };
    let size = (points.len(), points.len().saturating_mul(count) < FEW);
    let found = run_sized(py, size, threads, report.as_ref(), |watch| {
        find(&scene.0, points, wanted, watch)
    })?;
    Ok((
        PyArray1::from_vec(py, found.distance),
        PyArray1::from_vec(py, found.object),
        PyArray1::from_vec(py, found.primitive),
        PyArray1::from_vec(py, found.point.into_flattened()),
        PyArray1::from_slice(py, bytemuck::cast_slice(&found.barycentric)),
    ))
}

/// The distance of each of `points` from the scene, negative inside.
#[pyfunction]
pub(crate) fn signed_distances<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: PyReadonlyArray2<'py, f64>,
    how: (String, bool),
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let points = points.as_slice()?.as_chunks().0;
    let size = (scene, points.len());
    let (rule, allow_open) = how;
    let settings = SignSettings { rule: rule.parse()?, allow_open, ..SignSettings::default() };
    // The first time it is found out of every mesh whether it is closed.
    let signed = measured(py, size, threads, report.as_ref(), |watch| {
        signed_distances_with(settings, &scene.0, points, watch)
    })?;
    Ok(PyArray1::from_vec(py, signed))
}
