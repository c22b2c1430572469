//! The pixel that a ray goes through.

use super::{ExplainSettings, Explanation, explain};
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::watch::Watch;

/// The pixel of a camera that an explained ray goes through; see [`explain_pixel`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Pixel {
    /// The row, from the top, from 0.
    pub row: usize,
    /// The column, from the left, from 0.
    pub column: usize,
    /// The number of pixels down.
    pub rows: usize,
    /// The number of pixels across.
    pub columns: usize,
    /// The hit's distance from the camera's position, along the ray; infinity for a miss.
    pub range: f64,
    /// The hit's distance from the camera's position, along the camera's aim; infinity for a miss.
    pub z: f64,
}

/// Explains the ray through the centre of a camera's pixel, as [`explain`] does a ray. The pixel is
/// its row from the top and its column from the left, both from 0.
///
/// ```
/// use firsthit::explain::{ExplainSettings, explain_pixel};
/// use firsthit::{Camera, DVec3, Object, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, 45.0, 3, 3)?;
/// let explanation = explain_pixel(&scene, &camera, [1, 1], &ExplainSettings::default(), &())?;
/// assert_eq!(explanation.pixel.map(|pixel| pixel.range), Some(4.0));
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for a pixel outside of the picture, and those of [`explain`].
pub fn explain_pixel<'a>(
    scene: &'a Scene,
    camera: &Camera,
    [row, column]: [usize; 2],
    settings: &ExplainSettings,
    watch: &dyn Watch,
) -> Result<Explanation<'a>> {
    let (columns, rows) = (camera.columns(), camera.rows());
    if column >= columns || row >= rows {
        let (lowest, last) = (rows - 1, columns - 1);
        let got = format!(
            "{row},{column}; there are {rows} rows and {columns} columns, from 0,0 to {lowest},{last}"
        );
        return Err(Error::argument("pixel", "one of the picture", got));
    }
    let mut explanation = explain(scene, &camera.ray(row, column), settings, watch)?;
    let t = explanation.hit.as_ref().map(|hit| hit.hit.t);
    let of_hit = |distance: &dyn Fn(f64) -> f64| t.map_or(f64::INFINITY, distance);
    explanation.pixel = Some(Pixel {
        row,
        column,
        rows,
        columns,
        range: of_hit(&|t| camera.range(row, column, t)),
        z: of_hit(&|t| camera.z(row, column, t)),
    });
    Ok(explanation)
}
