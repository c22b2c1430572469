//! The pixel that a ray goes through.

use super::{ExplainSettings, Explanation, explain};
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::geometry::Ray;
use crate::scene::Scene;
use crate::watch::Watch;

/// A pixel of a camera, and the ray through its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Pixel {
    /// From the left, from 0.
    pub column: usize,
    /// From the top, from 0.
    pub row: usize,
    /// How many pixels there are across.
    pub columns: usize,
    /// How many there are down.
    pub rows: usize,
    /// The hit's distance from the camera's position, along the ray; infinity before it is known, and for a miss.
    pub range: f64,
    /// The hit's distance from the camera's position, along the camera's aim; infinity before it is known, and for a miss.
    pub z: f64,
}

impl Pixel {
    /// The pixel of a camera in a column from the left and a row from the top, both from 0.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for one outside of the picture.
    pub fn new(camera: &Camera, column: usize, row: usize) -> Result<Self> {
        let (columns, rows) = (camera.columns(), camera.rows());
        if column >= columns || row >= rows {
            let (last, lowest) = (columns - 1, rows - 1);
            let got = format!(
                "{column},{row}; there are {columns} x {rows}, from 0,0 to {last},{lowest}"
            );
            return Err(Error::argument("pixel", "one of the picture", got));
        }
        Ok(Self {
            column,
            row,
            columns,
            rows,
            range: f64::INFINITY,
            z: f64::INFINITY,
        })
    }

    /// The story of the ray through the pixel's centre, from `t_min` to `t_max`. The camera is the one that the pixel is of.
    ///
    /// ```
    /// use firsthit::explain::{ExplainSettings, Pixel};
    /// use firsthit::{Camera, DVec3, Object, Scene, Sphere};
    ///
    /// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
    /// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, 45.0, 3, 3)?;
    /// let pixel = Pixel::new(&camera, 1, 1)?;
    /// let limits = (0.0, f64::INFINITY);
    /// let story = pixel.explain(&scene, (&camera, limits), &ExplainSettings::default(), &())?;
    /// assert_eq!(story.pixel.map(|pixel| pixel.range), Some(4.0));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`explain`].
    pub fn explain<'a>(
        mut self,
        scene: &'a Scene,
        (camera, (t_min, t_max)): (&Camera, (f64, f64)),
        settings: &ExplainSettings,
        watch: &dyn Watch,
    ) -> Result<Explanation<'a>> {
        let ray: Ray = camera.ray(self.row, self.column);
        let mut story = explain(scene, &ray.beyond(t_min).up_to(t_max), settings, watch)?;
        if let Some(hit) = &story.hit {
            self.range = camera.range(self.row, self.column, hit.hit.t);
            self.z = camera.z(self.row, self.column, hit.hit.t);
        }
        story.pixel = Some(self);
        Ok(story)
    }
}
