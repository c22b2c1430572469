use super::DVec3;

/// What all rays of a camera with a flat viewplane have in common: a pixel's is known from its row and column
/// alone, and neighbours are close to each other.
///
/// The point of the viewplane for row `i`, counted from the bottom, and column `j` is
/// `toward + (-width / 2 + width / columns * (j + 1/2)) * right + (-height / 2 + height / rows * (i + 1/2)) *
/// upwards`, from `position` on; the ray is the one there, as [`Rays`](super::Rays) gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelGrid {
    /// Pixels down and across.
    pub rows: usize,
    /// See `rows`.
    pub columns: usize,
    /// Where the camera is.
    pub position: DVec3,
    /// From there to the viewplane's middle.
    pub toward: DVec3,
    /// Of length one, along a row.
    pub right: DVec3,
    /// Of length one, up a column.
    pub upwards: DVec3,
    /// The viewplane's size.
    pub width: f64,
    /// See `width`.
    pub height: f64,
    /// The direction of all rays, if they are parallel; else they run from `position` through the viewplane.
    pub parallel: Option<DVec3>,
    /// Whether rays start on the viewplane, not at the camera.
    pub starts_on_viewplane: bool,
}

impl PixelGrid {
    /// How far to the right of the middle a column's centre is.
    #[inline]
    pub fn x(&self, column: usize) -> f64 {
        -self.width / 2.0 + self.width / self.columns as f64 * (column as f64 + 0.5)
    }

    /// How far above the middle a row's centre is; row 0 is the top.
    #[inline]
    pub fn y(&self, row: usize) -> f64 {
        let from_bottom = (self.rows - 1) as f64 - row as f64;
        -self.height / 2.0 + self.height / self.rows as f64 * (from_bottom + 0.5)
    }

    /// The point of the viewplane in the middle of a pixel, relative to `position`.
    #[inline]
    pub fn point(&self, row: usize, column: usize) -> DVec3 {
        self.toward + self.x(column) * self.right + self.y(row) * self.upwards
    }
}
