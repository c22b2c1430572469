use super::{DVec2, DVec3, Ray, unit};

/// The rays of a camera with a flat viewplane, one for each pixel: all of them follow from a row
/// and a column, and neighbours are close to each other.
///
/// The point of the viewplane for row `i`, counted from the bottom, and column `j` is
/// `toward + (-width / 2 + width / columns * (j + x)) * right + (-height / 2 + height / rows * (i + y)) * upwards`,
/// from `position` on, where (x, y) is the `offset`. This is the one formula for pixels: cameras,
/// tiles and what fits a grid to an array of rays all use it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelGrid {
    /// Pixels down and across.
    pub rows: usize,
    /// See `rows`.
    pub columns: usize,
    /// The row and the column of the first pixel in the viewplane: a grid may be a part of that.
    pub first: [usize; 2],
    /// Pixels down and across the whole viewplane.
    pub whole: [usize; 2],
    /// The camera's position.
    pub position: DVec3,
    /// The vector from there to the viewplane's middle.
    pub toward: DVec3,
    /// The direction along a row, of length one.
    pub right: DVec3,
    /// The direction up a column, of length one.
    pub upwards: DVec3,
    /// The viewplane's size.
    pub width: f64,
    /// See `width`.
    pub height: f64,
    /// The direction of all rays, if they are parallel; else they run from `position` through the
    /// viewplane.
    pub parallel: Option<DVec3>,
    /// Whether rays start on the viewplane, not at the camera.
    pub starts_on_viewplane: bool,
    /// The point of each pixel that its ray goes through, from 0 to 1 rightwards and upwards.
    pub offset: DVec2,
}

impl PixelGrid {
    /// The offset of pixels' centres.
    pub const CENTRE: DVec2 = DVec2::splat(0.5);

    /// The width and the height of a pixel on the viewplane.
    #[inline]
    pub fn size(&self) -> [f64; 2] {
        [self.width / self.whole[1] as f64, self.height / self.whole[0] as f64]
    }

    /// The part of the grid from a pixel on, with these numbers of rows and columns.
    pub fn part(&self, [row, column]: [usize; 2], [rows, columns]: [usize; 2]) -> Self {
        Self { rows, columns, first: [self.first[0] + row, self.first[1] + column], ..*self }
    }

    /// The distance of a column's rays to the right of the middle.
    #[inline]
    pub fn x(&self, column: usize) -> f64 {
        -self.width / 2.0 + self.size()[0] * ((self.first[1] + column) as f64 + self.offset.x)
    }

    /// The distance of a row's rays above the middle; row 0 is the top.
    #[inline]
    pub fn y(&self, row: usize) -> f64 {
        // The one place where rows are flipped: the formula counts them from the bottom.
        let from_bottom = (self.whole[0] - 1) as f64 - (self.first[0] + row) as f64;
        -self.height / 2.0 + self.size()[1] * (from_bottom + self.offset.y)
    }

    /// The point of the viewplane that the ray of a pixel goes through, relative to `position`: far
    /// from the world's origin it would drown in the rounding of world coordinates.
    #[inline]
    pub fn point(&self, row: usize, column: usize) -> DVec3 {
        self.toward + self.x(column) * self.right + self.y(row) * self.upwards
    }

    /// The ray of a pixel, its direction of length one.
    #[inline]
    pub fn ray(&self, row: usize, column: usize) -> Ray {
        self.through(self.point(row, column))
    }

    /// The ray through a point of the viewplane, relative to `position`.
    #[inline]
    fn through(&self, point: DVec3) -> Ray {
        let (start, direction) = match self.parallel {
            Some(direction) if self.starts_on_viewplane => (point, direction),
            Some(direction) => (point - self.toward, direction),
            None if self.starts_on_viewplane => (point, unit(point)),
            None => return Ray::new(self.position, unit(point)),
        };
        Ray::new(self.position + start, direction)
    }

    /// Fills `rays` with those from the pixel `first` on, pixels counted row by row: the same as
    /// [`ray`](Self::ray) gives, sooner than one by one.
    pub fn read(&self, first: usize, rays: &mut [Ray]) {
        let [width, _] = self.size();
        let (mut row, mut column) = (first / self.columns, first % self.columns);
        let mut rest = rays;
        while !rest.is_empty() {
            let (of_row, after) = rest.split_at_mut(rest.len().min(self.columns - column));
            // Operation for operation what `point` does.
            let up = self.y(row) * self.upwards;
            for (k, ray) in (self.first[1] + column..).zip(of_row) {
                let x = -self.width / 2.0 + width * (k as f64 + self.offset.x);
                *ray = self.through(self.toward + x * self.right + up);
            }
            (row, column, rest) = (row + 1, 0, after);
        }
    }
}
