//! The story of one ray.

use firsthit::Rays;
use firsthit::explain::{ExplainSettings, Pixel, explain as tell};
use pyo3::prelude::*;

use crate::arrays::RayArrays;
use crate::camera::Camera;
use crate::run::run;
use crate::scene::Scene;

/// A pixel: its camera, its column and its row.
type PixelIn<'py> = (PyRef<'py, Camera>, usize, usize);

/// The story of the first of some rays, or of the ray through a pixel with the limits and filters of that one: as text, and as JSON.
#[pyfunction]
pub(crate) fn explain<'py>(
    py: Python<'py>,
    scene: &Scene,
    rays: RayArrays<'py>,
    pixel: Option<PixelIn<'py>>,
    among: Option<Vec<usize>>,
    behind: usize,
) -> PyResult<(String, String)> {
    let (ray, filter) = {
        let rays = rays.slices(1)?;
        (rays.ray(0), rays.filter(0))
    };
    let settings = ExplainSettings {
        filter,
        among,
        behind,
    };
    let pixel = pixel.map(|(camera, column, row)| (camera.0, column, row));
    let scene = &scene.0;
    run(py, 1, |stop| {
        let story = match pixel {
            Some((camera, column, row)) => {
                let limits = (ray.t_min, ray.t_max);
                let pixel = Pixel::new(&camera, column, row)?;
                pixel.explain(scene, (&camera, limits), &settings, stop)?
            }
            None => tell(scene, &ray, &settings, stop)?,
        };
        let json = firsthit_cli::story::json(&story);
        Ok((firsthit_cli::story::text(&story, false), json.to_string()))
    })
}
