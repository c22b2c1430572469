//! The intrinsic matrix K: from normalised image coordinates to pixels and back.

use super::{Lens, Projection, Viewplane};
use crate::error::Result;
use crate::geometry::{DMat3, DVec2, DVec3, Domain, Settings, require, settings};

settings! {
    /// The intrinsic matrix: `u = fx x + skew y + cx`, `v = fy y + cy`, where x counts to the right
    /// and y downwards.
    ///
    /// Pixels are counted from the picture's upper left corner, so that the centre of the first one
    /// is at (0.5, 0.5), as in COLMAP. For OpenCV, where it is at (0, 0), subtract 0.5 from `cx`
    /// and `cy`.
    ///
    /// ```
    /// use firsthit::DVec2;
    /// use firsthit::camera::PixelMatrix;
    ///
    /// let matrix = PixelMatrix { fx: 500.0, fy: 510.0, cx: 320.0, cy: 240.0, skew: 0.0 };
    /// assert_eq!(matrix.pixel(DVec2::new(0.1, -0.1)), DVec2::new(370.0, 189.0));
    /// ```
    pub struct PixelMatrix {
        /// The focal length in columns.
        fx: f64, Domain::Positive, required 0.0;
        /// The focal length in rows.
        fy: f64, Domain::Positive, required 0.0;
        /// The principal point's column: from the left edge, or as a convention counts them.
        cx: f64, Domain::Number, required 0.0;
        /// The principal point's row: from the upper edge, or as a convention counts them.
        cy: f64, Domain::Number, required 0.0;
        /// The matrix' second number in the first row: columns for each unit of y. Default: 0.
        skew: f64, Domain::Number, default 0.0;
    }
}

impl PixelMatrix {
    /// The pixel coordinates of a point of the normalised image.
    pub fn pixel(&self, point: DVec2) -> DVec2 {
        DVec2::new(self.fx * point.x + self.skew * point.y + self.cx, self.fy * point.y + self.cy)
    }

    /// The point of the normalised image at pixel coordinates.
    pub fn point(&self, pixel: DVec2) -> DVec2 {
        let y = (pixel.y - self.cy) * self.fy.recip();
        let x = (pixel.x - self.cx - self.skew * y) * self.fx.recip();
        DVec2::new(x, y)
    }

    /// The lens of a projection with this matrix, and with other numbers by their names, for a
    /// picture of rows and columns.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for numbers that the projection has not,
    /// and for a matrix that no viewplane has.
    #[doc(hidden)]
    pub fn lens(
        &self,
        projection: Projection,
        others: &[(&str, f64)],
        [rows, columns]: [usize; 2],
    ) -> Result<Lens> {
        if projection == Projection::Perspective && others.is_empty() {
            return Viewplane::from_pixel_matrix(self, rows, columns).map(Lens::Flat);
        }
        let &Self { fx, fy, cx, cy, skew } = self;
        let own = [("fx", fx), ("fy", fy), ("cx", cx), ("cy", cy), ("skew", skew)];
        Lens::named(projection, &[&own, others].concat())
    }

    /// The matrix K.
    pub fn matrix(&self) -> DMat3 {
        DMat3::from_cols(
            DVec3::new(self.fx, 0.0, 0.0),
            DVec3::new(self.skew, self.fy, 0.0),
            DVec3::new(self.cx, self.cy, 1.0),
        )
    }

    /// Reads a matrix K.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a matrix that is not upper triangular
    /// with a last row of (0, 0, 1), and for focal lengths that are not positive.
    pub fn from_matrix(k: DMat3) -> Result<Self> {
        let is_upper = k.x_axis.y == 0.0 && k.x_axis.z == 0.0 && k.y_axis.z == 0.0;
        let is_affine = is_upper && k.z_axis.z == 1.0;
        let expected = "upper triangular, with (0, 0, 1) as its last row";
        require("K", expected, is_affine, k)?;
        let matrix = Self {
            fx: k.x_axis.x,
            fy: k.y_axis.y,
            cx: k.z_axis.x,
            cy: k.z_axis.y,
            skew: k.y_axis.x,
        };
        matrix.check()?;
        Ok(matrix)
    }

    /// The matrix for a part of the picture, which begins at a row and a column.
    pub(super) fn cropped(&self, [row, column]: [usize; 2]) -> Self {
        Self { cx: self.cx - column as f64, cy: self.cy - row as f64, ..*self }
    }

    /// The matrix for the same picture at the given factors times its rows and columns.
    pub(super) fn scaled(&self, [down, across]: [f64; 2]) -> Self {
        Self {
            fx: self.fx * across,
            fy: self.fy * down,
            cx: self.cx * across,
            cy: self.cy * down,
            skew: self.skew * across,
        }
    }
}
