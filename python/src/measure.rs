//! Measures the inside of objects.

use firsthit::measure::{
    Grouping, Rule, Towards, inside_with, path_lengths_with, rules_with, thickness_along,
};
use firsthit::watch::Watch;
use firsthit::{DVec3, Result};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::RayArrays;
use crate::errors::Outcome;
use crate::run::{FEW, Report, run, run_sized};
use crate::scene::Scene;

/// Triangles times points that take about a tenth of a second at most, also where a mesh is asked
/// for the first time whether it is closed.
const LITTLE: u64 = 1 << 21;

fn by(is_by_object: bool) -> Grouping {
    if is_by_object { Grouping::Object } else { Grouping::Union }
}

/// Does what takes little in the calling thread alone.
pub(crate) fn measured<T: Send>(
    py: Python<'_>,
    (scene, count): (&Scene, usize),
    threads: usize,
    report: Report<'_, '_>,
    work: impl FnOnce(&dyn Watch) -> Result<T> + Send,
) -> Outcome<T> {
    let triangles = scene.0.triangles().saturating_mul(count as u64);
    let size = (count, count < FEW && triangles < LITTLE);
    run_sized(py, size, threads, report, work)
}

/// Whether points are inside, of each those in any object or those in each.
#[pyfunction]
pub(crate) fn inside<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: PyReadonlyArray2<'py, f64>,
    how: (bool, String),
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<Bound<'py, PyArray1<bool>>> {
    let points = points.as_slice()?;
    let points: &[DVec3] = bytemuck::cast_slice(points.as_chunks::<3>().0);
    let (is_by_object, rule) = how;
    let (size, rule) = ((scene, points.len()), rule.parse()?);
    let found = measured(py, size, threads, report.as_ref(), |watch| {
        inside_with(rule, &scene.0, points, by(is_by_object), watch)
    })?;
    Ok(PyArray1::from_vec(py, found.is_inside))
}

/// The lengths of `count` rays in objects, of each that in any or those in each.
#[pyfunction]
pub(crate) fn path_lengths<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    count: usize,
    how: (bool, String),
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let (is_by_object, rule) = how;
    let (rays, rule) = (rays.slices(count)?, rule.parse()?);
    let lengths = measured(py, (scene, count), threads, report.as_ref(), |watch| {
        path_lengths_with(rule, &scene.0, &rays, by(is_by_object), watch)
    })?;
    Ok(PyArray1::from_vec(py, lengths))
}

/// The `t` at which `count` rays that leave surfaces come out of the objects that they alone meet.
#[pyfunction]
pub(crate) fn thickness<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    count: usize,
    how: (bool, String),
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let (is_inwards, rule) = how;
    let (rays, rule) = (rays.slices(count)?, rule.parse()?);
    let towards = if is_inwards { Towards::Inside } else { Towards::Given };
    let t = measured(py, (scene, count), threads, report.as_ref(), |watch| {
        thickness_along(rule, &scene.0, &rays, towards, watch)
    })?;
    Ok(PyArray1::from_vec(py, t))
}

/// The rule that tells whether a point is inside, of each object.
#[pyfunction]
pub(crate) fn rules(py: Python<'_>, scene: &Scene, rule: &str) -> Outcome<Vec<&'static str>> {
    let rule = rule.parse()?;
    let rules = run(py, 1, |_| rules_with(rule, &scene.0))?;
    Ok(rules.into_iter().map(Rule::name).collect())
}
