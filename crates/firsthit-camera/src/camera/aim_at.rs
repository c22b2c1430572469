//! Cameras made from what they should show.

use super::{Camera, Lens, RayStart, StandardView, View, Viewplane};
use crate::error::{Error, Result};
use crate::geometry::{DVec3, named, require, unit};

named! {
    /// The way across the picture that a perspective camera's field of view is measured along.
    pub enum FovAxis, "fov_axis":
    /// From the lower to the upper edge.
    #[default]
    "vertical" => Vertical;
    /// From the left to the right edge.
    "horizontal" => Horizontal;
    /// From corner to corner.
    "diagonal" => Diagonal;
}

impl Camera {
    /// A perspective camera at `position` with `target` in the middle of the picture, with square
    /// pixels and `fov` degrees between the picture's lower and upper edge. The rays start at
    /// the eye. [`Viewplane::with_fov`] takes other fields of view.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a `target` at `position`, a field of view that
    /// is not between 0 and 180 degrees, and all that [`Camera::new`] refuses.
    pub fn look_at(
        position: DVec3,
        target: DVec3,
        up: DVec3,
        fov: f64,
        rows: usize,
        columns: usize,
    ) -> Result<Self> {
        let expected = "another point than position";
        require("target", expected, target != position, target)?;
        let viewplane = Viewplane::with_fov(fov, FovAxis::Vertical, rows, columns)?;
        Self::new(View {
            position,
            aim: target - position,
            up,
            rows,
            columns,
            lens: Lens::Flat(viewplane),
        })
    }

    /// The camera of `view` moved, without turning it, so that a scene fills the picture. A
    /// perspective camera keeps its field of view; an orthographic one gets a viewplane of the
    /// scene's size, of the same shape. The picture is 1.05 times as large as the scene in one of
    /// its two directions and centres the scene in the other. Rays start at the eye. The eye stays
    /// away from the scene by at least a millionth of its depth, and by 1e-12 of its distance from
    /// the origin: a scene that is narrower than that looks small.
    ///
    /// `support` is the scene's support function: the largest dot product of a direction with a
    /// point of the scene (`Scene::support`). It is called up to 18 times.
    ///
    /// ```
    /// use firsthit::{Camera, DVec3, View};
    ///
    /// // Two points.
    /// let support = |direction: DVec3| direction.x.abs();
    /// let camera = Camera::framing(View::default(), support)?;
    /// assert!(camera.position().abs_diff_eq(DVec3::new(0.0, 0.0, 1.575), 1e-12));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a `support` that is not finite, a lens without a viewplane, and all
    /// that [`Camera::new`] refuses.
    pub fn framing(view: View, support: impl Fn(DVec3) -> f64) -> Result<Self> {
        let camera = Self::new(view)?.starting_at(RayStart::Eye);
        let name = view.lens.projection().name();
        let Some(&viewplane) = camera.lens().viewplane() else {
            let expected = "one with a viewplane, to be framed";
            return Err(Error::argument("projection", expected, name));
        };
        let (position, viewplane) = if viewplane.parallel {
            camera.pose.orthographic(viewplane, &support)?
        } else {
            (camera.pose.perspective(&viewplane, &support)?, viewplane)
        };
        Self::new(View { position, lens: Lens::Flat(viewplane), ..*camera.view() })
    }
}

impl Viewplane {
    /// A perspective camera's viewplane of square pixels at distance one, so large that `fov`
    /// degrees lie between its edges or corners. Rays start at the eye.
    ///
    /// ```
    /// use firsthit::Viewplane;
    /// use firsthit::camera::FovAxis;
    ///
    /// let viewplane = Viewplane::with_fov(90.0, FovAxis::Horizontal, 480, 640)?;
    /// assert!((viewplane.width - 2.0).abs() < 1e-15 && (viewplane.height - 1.5).abs() < 1e-15);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a field of view not between 0 and 180 degrees.
    pub fn with_fov(fov: f64, axis: FovAxis, rows: usize, columns: usize) -> Result<Self> {
        let fine = fov > 0.0 && fov < 180.0;
        require("fov", "between 0 and 180 degrees", fine, fov)?;
        // No rows or columns count as one here: that they are refused is not the viewplane's fault.
        let [rows, columns] = [rows, columns].map(|count| count.max(1) as f64);
        let extent = 2.0 * libm::tan(fov.to_radians() / 2.0);
        let height = match axis {
            FovAxis::Vertical => extent,
            FovAxis::Horizontal => extent * rows / columns,
            FovAxis::Diagonal => extent * rows / (rows * rows + columns * columns).sqrt(),
        };
        Ok(Self {
            width: height * columns / rows,
            height,
            ray_start: RayStart::Eye,
            ..Self::default()
        })
    }
}

impl View {
    /// The view in a standard direction, its own up being the world's.
    pub(super) fn standard(self, standard: StandardView) -> Self {
        let (aim, up) = standard.aim_and_up(self.up);
        Self { aim, up, ..self }
    }

    /// The view, aimed at `target`.
    pub fn aimed_at(self, target: DVec3) -> Self {
        Self { aim: unit(target - self.position), ..self }
    }
}
