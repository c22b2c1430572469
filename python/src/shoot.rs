//! Rays to hits, and what can be asked about them.

use firsthit::channel::{ChannelInput, KINDS, kind, make};
use firsthit::sensor::Sensor;
use firsthit::shoot::{All, AllHits, Answers, Cpu, Engine, HitSlices, trace};
use firsthit::{DVec2, Rays};
use numpy::{PyArray1, PyReadwriteArray1};
use pyo3::prelude::*;

use crate::arrays::{CopiesOut, HitsIn, HitsOut, RayArrays, RaySlices, collected};
use crate::errors::{Outcome, Raised};
use crate::frame::array;
use crate::run::{FEW, guarded, report_done, run_reported, run_sized};
use crate::scene::Scene;
use crate::sensor::SensorIn;

/// The first hits of rays in arrays, written to `out`. Where there is memory in `copies`, the rays
/// are copied there first: what they met belongs to the copy, whatever becomes of the arrays
/// meanwhile and later.
#[pyfunction]
pub(crate) fn shoot<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    mut copies: CopiesOut<'py>,
    threads: usize,
    mut out: HitsOut<'py>,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<()> {
    let (mut out, count) = out.slices()?;
    let rays = rays.slices(count)?;
    let copies = copies.slices(&rays)?;
    let report = report.as_ref();
    let is_little = count < FEW && copies.iter().all(Option::is_none);
    if is_little && !rays.is_filtered() {
        guarded(|| shoot_few(scene, &rays, &mut out))?;
        return report_done(report, count);
    }
    run_sized(py, (count, is_little), threads, report, |watch| {
        let rays = rays.copied(copies);
        Cpu::default().trace(&scene.0, &rays, Answers::First(out), watch)
    })
}

/// Shoots rays by the calling thread alone.
fn shoot_few<R: Rays + ?Sized>(scene: &Scene, rays: &R, out: &mut HitSlices<'_>) {
    for k in 0..rays.len() {
        out.put(k, &Cpu::default().first_hit(&scene.0, &rays.ray(k)));
    }
}

/// The first hits of a sensor's rays through its pixels' centres, written to `out`.
#[pyfunction]
pub(crate) fn shoot_camera<'py>(
    py: Python<'py>,
    scene: &Scene,
    camera: SensorIn<'py>,
    threads: usize,
    mut out: HitsOut<'py>,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<()> {
    let (mut out, count) = out.slices()?;
    let sensor = camera.sensor();
    if count != sensor.len() {
        return Err(Raised::value("expected an element for each pixel"));
    }
    let report = report.as_ref();
    if count < FEW {
        guarded(|| shoot_few(scene, sensor, &mut out))?;
        return report_done(report, count);
    }
    run_reported(py, threads, report, |stop| {
        Cpu::default().trace(&scene.0, sensor, Answers::First(out), stop)
    })
}

/// Offsets, `t`, objects, primitives and pairs of weights, one pair after the other.
type AllOut<'py> = (
    Bound<'py, PyArray1<usize>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray1<f64>>,
);

/// All hits of `count` rays in arrays, or the `nearest` ones of each.
#[pyfunction]
pub(crate) fn shoot_all<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    count: usize,
    nearest: Option<usize>,
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<AllOut<'py>> {
    let rays = rays.slices(count)?;
    let (report, query) = (report.as_ref(), All { nearest });
    let size = (count, count < FEW);
    let AllHits { offsets, hits } =
        run_sized(py, size, threads, report, |watch| trace(&scene.0, &rays, query, watch))?;
    Ok((
        PyArray1::from_vec(py, offsets),
        PyArray1::from_vec(py, hits.t),
        PyArray1::from_vec(py, hits.object),
        PyArray1::from_vec(py, hits.primitive),
        PyArray1::from_vec(py, flat(hits.barycentric)?),
    ))
}

/// Pairs as numbers.
fn flat(pairs: Vec<DVec2>) -> Outcome<Vec<f64>> {
    bytemuck::allocation::try_cast_vec(pairs)
        .or_else(|(_, pairs)| collected(2 * pairs.len(), pairs.iter().flat_map(DVec2::to_array)))
}

/// Whether rays in arrays meet anything, written to `out`.
#[pyfunction]
pub(crate) fn occluded<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    threads: usize,
    mut out: PyReadwriteArray1<'py, bool>,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<()> {
    let out = out.as_slice_mut()?;
    let rays = rays.slices(out.len())?;
    answer(py, scene, &rays, threads, Answers::Any(out), report)
}

/// Counts how many times rays in arrays meet a surface, written to `out`.
#[pyfunction]
pub(crate) fn count<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    threads: usize,
    mut out: PyReadwriteArray1<'py, u32>,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<()> {
    let out = out.as_slice_mut()?;
    let rays = rays.slices(out.len())?;
    answer(py, scene, &rays, threads, Answers::Count(out), report)
}

/// Answers a query; few rays by the calling thread alone.
fn answer(
    py: Python<'_>,
    scene: &Scene,
    rays: &RaySlices<'_>,
    threads: usize,
    answers: Answers<'_>,
    report: Option<Bound<'_, PyAny>>,
) -> Outcome<()> {
    let size = (rays.len(), rays.len() < FEW);
    run_sized(py, size, threads, report.as_ref(), |watch| {
        Cpu::default().trace(&scene.0, rays, answers, watch)
    })
}

/// A channel of the hits of rays, or of a camera's rays.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "rays, hits and how to work, sent by the Python half alone"
)]
pub(crate) fn channel<'py>(
    py: Python<'py>,
    scene: &Scene,
    name: &str,
    rays: Option<RayArrays<'py>>,
    camera: Option<SensorIn<'py>>,
    hits: HitsIn<'py>,
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<Bound<'py, PyAny>> {
    let kind = kind(name)?;
    let hits = hits.hits()?;
    let slices = rays.as_ref().map(|rays| rays.slices(hits.len()));
    let slices = slices.transpose()?;
    let sensor = camera.as_ref().map(SensorIn::sensor);
    let rays: &dyn Rays = match (&slices, sensor) {
        (Some(slices), _) => slices,
        (None, Some(sensor)) => sensor,
        (None, None) => return Err(Raised::value("expected rays or a camera")),
    };
    if rays.len() != hits.len() || kind.needs_samples() || kind.is_edge() {
        return Err(Raised::value("expected as many hits as rays, and no colours"));
    }
    let shots = ChannelInput {
        scene: &scene.0,
        rays,
        hits: &hits,
        sensor: sensor.map(|sensor| sensor as &dyn Sensor),
    };
    let size = (hits.len(), hits.len() < FEW);
    let made = run_sized(py, size, threads, report.as_ref(), |watch| make(&[kind], &shots, watch))?;
    let channel = made.into_iter().next();
    let channel = channel.ok_or_else(|| Raised::value("expected a channel"))?;
    Ok(array(py, channel.data))
}

/// Every channel's name and meaning.
#[pyfunction]
pub(crate) fn channel_names() -> Vec<(&'static str, &'static str)> {
    KINDS.iter().map(|kind| (&*kind.name, kind.about)).collect()
}
