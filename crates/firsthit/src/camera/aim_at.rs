//! Cameras made from what they should show.

use super::{Camera, Projection, RayStart, View, require};
use crate::error::Result;
use crate::geometry::{Bounds, DVec3, unit};

impl Camera {
    /// A perspective camera at `position` with `target` in the middle of the picture, with square
    /// pixels and `vertical_fov_degrees` between the picture's lower and upper edge. The rays start at
    /// the eye.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) for a `target` at `position`, a field of view that
    /// is not between 0 and 180 degrees, and all that [`Camera::new`] refuses.
    pub fn look_at(
        position: DVec3,
        target: DVec3,
        up: DVec3,
        vertical_fov_degrees: f64,
        rows: usize,
        columns: usize,
    ) -> Result<Self> {
        require(
            "target",
            "another point than position",
            target != position,
            target,
        )?;
        let height = 2.0 * half_height(vertical_fov_degrees)?;
        let width = width_of_square_pixels(height, rows, columns);
        let ray_start = RayStart::Eye;
        let aim = target - position;
        Self::new(View {
            position,
            aim,
            up,
            width,
            height,
            rows,
            columns,
            ray_start,
            ..View::default()
        })
    }

    /// The camera of `view` moved back along its aim, and for parallel rays with its viewplane sized,
    /// until all of `bounds` is in the picture with a margin of a twentieth. Its rays start at the eye.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) for bounds that are not finite, and all that
    /// [`Camera::new`] refuses.
    pub fn framing(view: View, bounds: Bounds) -> Result<Self> {
        let finite = bounds.is_finite() && !bounds.is_empty();
        require(
            "bounds",
            "finite, to be framed",
            finite,
            format!("{bounds:?}"),
        )?;
        let camera = Self::new(View {
            ray_start: RayStart::Eye,
            ..view
        })?;
        let centre = bounds.centre();
        let corners = bounds.corners().map(|corner| {
            let corner = corner - centre;
            (
                corner.dot(camera.right).abs(),
                corner.dot(camera.upwards).abs(),
                corner.dot(camera.aim()),
            )
        });
        // A single point still needs some distance, well above the rounding of where it is.
        let smallest = 1e-12 * centre.abs().max_element().max(1e-30);
        let radius = (0.5 * bounds.size().length()).max(smallest);
        let largest = |f: &dyn Fn((f64, f64, f64)) -> f64| {
            corners.map(f).into_iter().fold(smallest, f64::max)
        };
        let margin = 1.05;
        let View {
            width,
            height,
            focal_length,
            ..
        } = *camera.view();
        match view.projection {
            Projection::Perspective => {
                // A corner at depth d + z is inside when x / (d + z) is at most width / 2 / focal_length.
                let (slope_x, slope_y) = (0.5 * width / focal_length, 0.5 * height / focal_length);
                let back =
                    largest(&|(x, y, z)| (margin * x / slope_x).max(margin * y / slope_y) - z);
                let position = centre - camera.aim() * back.max(margin * radius);
                Self::new(View {
                    position,
                    ..*camera.view()
                })
            }
            Projection::Orthographic => {
                let aspect = width / height;
                let height = 2.0 * margin * largest(&|(x, y, _)| y.max(x / aspect));
                let position = centre - camera.aim() * (2.0 * radius);
                Self::new(View {
                    position,
                    height,
                    width: height * aspect,
                    ..*camera.view()
                })
            }
        }
    }
}

impl View {
    /// The same view with a viewplane of square pixels at distance one, so high that
    /// `vertical_fov_degrees` lie between its lower and upper edge.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) for a field of view not between 0 and 180 degrees.
    pub fn with_vertical_fov(self, vertical_fov_degrees: f64) -> Result<Self> {
        let height = 2.0 * half_height(vertical_fov_degrees)?;
        let width = width_of_square_pixels(height, self.rows, self.columns);
        Ok(Self {
            focal_length: 1.0,
            width,
            height,
            ..self
        })
    }

    /// The same view, aimed at `target`.
    pub fn aimed_at(self, target: DVec3) -> Self {
        Self {
            aim: unit(target - self.position),
            ..self
        }
    }
}

/// Half the height of the viewplane at distance one.
fn half_height(vertical_fov_degrees: f64) -> Result<f64> {
    let fine = vertical_fov_degrees > 0.0 && vertical_fov_degrees < 180.0;
    let expected = "between 0 and 180 degrees";
    require("vertical_fov_degrees", expected, fine, vertical_fov_degrees)?;
    Ok(libm::tan(vertical_fov_degrees.to_radians() / 2.0))
}

/// The viewplane's width. No rows or columns count as one here: that they are refused is not its fault.
fn width_of_square_pixels(height: f64, rows: usize, columns: usize) -> f64 {
    height * columns.max(1) as f64 / rows.max(1) as f64
}
