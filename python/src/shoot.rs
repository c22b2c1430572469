//! Rays to hits, and what can be asked about them.

use firsthit::channel::{KINDS, Shots, kind};
use firsthit::shoot::{Trees, any_hit, first_hit, occluded_all, shoot_all_to};
use firsthit::{Color, DVec3, Hit, Rays};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{HitsIn, HitsOut, RayArrays};
use crate::camera::Camera;
use crate::errors::raise;
use crate::frame::array;
use crate::run::run;
use crate::scene::Scene;

/// Fewer rays than this are done at once: making threads would take longer.
const FEW: usize = 512;

/// The first hits of rays in arrays, written to `out`.
#[pyfunction]
pub(crate) fn shoot<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    threads: usize,
    mut out: HitsOut<'py>,
) -> PyResult<()> {
    let rays = rays.slices()?;
    let mut out = out.slices(rays.len())?;
    if rays.len() < FEW {
        for k in 0..rays.len() {
            out.put(k, &first_hit::<Trees>(&scene.0, &rays.ray(k)));
        }
        return Ok(());
    }
    run(py, threads, |stop| shoot_all_to(&scene.0, &rays, out, stop))
}

/// The first hits of a camera's rays through its pixels' centres, written to `out`.
#[pyfunction]
pub(crate) fn shoot_camera<'py>(
    py: Python<'py>,
    scene: &Scene,
    camera: &Camera,
    threads: usize,
    mut out: HitsOut<'py>,
) -> PyResult<()> {
    let out = out.slices(camera.0.len())?;
    run(py, threads, |stop| {
        shoot_all_to(&scene.0, &camera.0, out, stop)
    })
}

/// Whether rays in arrays meet anything.
#[pyfunction]
pub(crate) fn occluded<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    threads: usize,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let rays = rays.slices()?;
    let found = if rays.len() < FEW {
        (0..rays.len())
            .map(|k| any_hit(&scene.0, &rays.ray(k)))
            .collect()
    } else {
        run(py, threads, |stop| occluded_all(&scene.0, &rays, stop))?
    };
    Ok(PyArray1::from_vec(py, found))
}

/// A channel of the hits of rays, or of a camera's rays.
#[pyfunction]
pub(crate) fn channel<'py>(
    py: Python<'py>,
    scene: &Scene,
    name: &str,
    rays: Option<RayArrays<'py>>,
    camera: Option<&Camera>,
    hits: HitsIn<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let kind = kind(name).map_err(|error| raise(py, &error))?;
    let hits = hits.hits()?;
    let slices = rays.as_ref().map(RayArrays::slices).transpose()?;
    let camera = camera.map(|camera| &camera.0);
    let rays: &dyn Rays = match (&slices, camera) {
        (Some(slices), _) => slices,
        (None, Some(camera)) => camera,
        (None, None) => return Err(PyValueError::new_err("expected rays or a camera")),
    };
    if rays.len() != hits.len() || kind.needs_shade() {
        return Err(PyValueError::new_err(
            "expected as many hits as rays, and no colours",
        ));
    }
    let shots = Shots {
        scene: &scene.0,
        rays,
        hits: &hits,
        camera,
    };
    let black = |_: f64, _: DVec3, _: DVec3, _: &Hit| Color::ZERO;
    let made = run(py, 0, |stop| kind.make(&shots, &black, stop))?;
    Ok(array(py, made.data))
}

/// Every channel's name and meaning.
#[pyfunction]
pub(crate) fn channel_names() -> Vec<(&'static str, &'static str)> {
    KINDS.iter().map(|kind| (kind.name, kind.about)).collect()
}
