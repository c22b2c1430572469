//! The explanation of one ray.

use firsthit::Rays;
use firsthit::explain::{
    ExplainSettings, Explanation, before_viewplane as passed_by, explain as explain_ray,
    explain_pixel,
};
use pyo3::prelude::*;

use crate::errors::Outcome;

use crate::arrays::RayArrays;
use crate::camera::Camera;
use crate::filters::FilterArrays;
use crate::run::{guarded, run};
use crate::scene::Scene;

/// The ray through a pixel: the camera, the row and the column, `t_min` and `t_max`, and what the
/// ray does not meet.
#[derive(FromPyObject)]
pub(crate) struct PixelIn<'py>(PyRef<'py, Camera>, [usize; 2], [f64; 2], Option<FilterArrays<'py>>);

/// The pixel or the ray that is explained.
#[derive(FromPyObject)]
pub(crate) enum Explained<'py> {
    Pixel(PixelIn<'py>),
    /// The first of some.
    Ray(RayArrays<'py>),
}

/// The number of objects between a camera's eye and its viewplane where its rays meet nothing else;
/// 0 where they do.
#[pyfunction]
pub(crate) fn before_viewplane(scene: &Scene, camera: &Camera) -> Outcome<usize> {
    let passed = guarded(|| passed_by(&scene.0, &camera.0))?;
    Ok(if passed.is_all { passed.objects } else { 0 })
}

/// The explanation of a ray: as text, and as JSON.
#[pyfunction]
pub(crate) fn explain<'py>(
    py: Python<'py>,
    scene: &Scene,
    explained: Explained<'py>,
    among: Option<Vec<usize>>,
    behind: usize,
) -> Outcome<(String, String)> {
    let mut settings = ExplainSettings { among, behind, ..ExplainSettings::default() };
    let scene = &scene.0;
    let told = |explanation: &Explanation<'_>| {
        let json = firsthit_cli::explanation::json(explanation);
        (firsthit_cli::explanation::text(explanation, false), json.to_string())
    };
    match explained {
        Explained::Pixel(PixelIn(camera, pixel, [t_min, t_max], filters)) => {
            (settings.t_min, settings.t_max) = (Some(t_min), Some(t_max));
            if let Some(filters) = filters {
                settings.filter = filters.filters(1)?.filter(0);
            }
            let camera = camera.0;
            run(py, 1, |stop| Ok(told(&explain_pixel(scene, &camera, pixel, &settings, stop)?)))
        }
        Explained::Ray(rays) => {
            let ray = {
                let rays = rays.slices(1)?;
                settings.filter = rays.filter(0);
                rays.ray(0)
            };
            run(py, 1, |stop| Ok(told(&explain_ray(scene, &ray, &settings, stop)?)))
        }
    }
}
