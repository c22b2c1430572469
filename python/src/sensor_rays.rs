//! The rays of sensors, cameras among them, as arrays.

use firsthit::Ray;
use firsthit::render::Sample;
use firsthit::watch::Watch as _;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::collected;
use crate::errors::{Outcome, Raised};
use crate::run::{FEW, run};
use crate::sensor::SensorIn;

/// Origins and directions.
type RayArraysOut<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// The rays of some rows of a sensor, through the point that a sample of each pixel is at; the
/// first is the centre.
#[pyfunction]
pub(crate) fn rays_of_rows<'py>(
    py: Python<'py>,
    sensor: SensorIn<'py>,
    rows: (usize, usize),
    sample: u32,
) -> Outcome<RayArraysOut<'py>> {
    let sensor = sensor.sensor();
    let [all_rows, columns] = sensor.shape();
    let last_row = rows.1.min(all_rows);
    let (first, last) = (rows.0.saturating_mul(columns), last_row.saturating_mul(columns));
    let sample = Sample::new(sensor, sample);
    ray_arrays(py, last.saturating_sub(first), |index| sample.ray(first + index))
}

/// The rays through the centres of some pixels of a sensor, counted row by row.
#[pyfunction]
pub(crate) fn rays_of_pixels<'py>(
    py: Python<'py>,
    sensor: SensorIn<'py>,
    pixels: PyReadonlyArray1<'py, i64>,
) -> Outcome<RayArraysOut<'py>> {
    let sensor = sensor.sensor();
    let pixels: Vec<usize> = checked_pixels(&pixels, sensor.len())?.collect();
    ray_arrays(py, pixels.len(), |k| sensor.ray(pixels[k]))
}

/// `range` or `z` of the hits at `t` of some pixels of a sensor, counted row by row.
#[pyfunction]
pub(crate) fn distances_of_pixels<'py>(
    py: Python<'py>,
    sensor: SensorIn<'py>,
    is_range: bool,
    pixels: PyReadonlyArray1<'py, i64>,
    t: PyReadonlyArray1<'py, f64>,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let (sensor, t) = (sensor.sensor(), t.as_slice()?);
    let pixels = checked_pixels(&pixels, sensor.len())?;
    let distance = |(pixel, &t): (usize, &f64)| {
        let [range, z] = sensor.range_and_z(pixel, t);
        if is_range { range } else { z }
    };
    Ok(PyArray1::from_vec(py, pixels.zip(t).map(distance).collect()))
}

/// Checks the numbers of pixels against a sensor of `count` pixels.
pub(crate) fn checked_pixels(
    pixels: &PyReadonlyArray1<'_, i64>,
    count: usize,
) -> Outcome<impl ExactSizeIterator<Item = usize>> {
    let pixels = pixels.as_slice()?;
    let checked = pixels.iter().map(|&pixel| usize::try_from(pixel));
    let checked: Result<Vec<usize>, _> = checked.collect();
    let checked = checked.ok().filter(|pixels| {
        let largest = pixels.iter().max();
        largest.is_none_or(|&largest| largest < count)
    });
    let outside = || Raised::value("expected pixels of the camera");
    Ok(checked.ok_or_else(outside)?.into_iter())
}

/// The two arrays of `count` rays, which are made in pieces by all threads; few by the calling
/// thread alone.
fn ray_arrays(
    py: Python<'_>,
    count: usize,
    ray: impl Fn(usize) -> Ray + Sync,
) -> Outcome<RayArraysOut<'_>> {
    /// Rays that are made between two looks at whether to stop.
    const PIECE: usize = 1 << 14;
    let zeros = || collected(count, std::iter::repeat_n([0.0; 3], count));
    let (mut origins, mut directions) = (zeros()?, zeros()?);
    let make = |first: usize, origins: &mut [[f64; 3]], directions: &mut [[f64; 3]]| {
        let ends = origins.iter_mut().zip(directions);
        for (index, (origin, direction)) in (first..).zip(ends) {
            let ray = ray(index);
            (*origin, *direction) = (ray.origin.to_array(), ray.direction.to_array());
        }
    };
    if count < FEW {
        make(0, &mut origins, &mut directions);
    } else {
        run(py, 0, |stop| {
            let origins = origins.par_chunks_mut(PIECE);
            let pieces = origins.zip(directions.par_chunks_mut(PIECE)).enumerate();
            pieces.for_each(|(k, (origins, directions))| {
                // The caller that asked to stop raises the interruption.
                if !stop.is_stopped() {
                    make(k * PIECE, origins, directions);
                }
            });
            Ok(())
        })?;
    }
    let array =
        |values: Vec<[f64; 3]>| PyArray1::from_vec(py, values.into_flattened()).reshape([count, 3]);
    Ok((array(origins)?, array(directions)?))
}
