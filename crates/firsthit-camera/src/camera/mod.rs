//! Pixel to ray: a camera is a pose and a lens, and each lens a file.

#![allow(
    clippy::large_types_passed_by_value,
    reason = "a view is handed on a few times for each camera"
)]

mod aim_at;
mod calibrated;
mod central;
mod colmap;
mod convention;
mod cube_map;
mod cylindrical;
mod description;
pub mod distortion;
mod equirectangular;
mod framing;
mod lens;
mod matrices;
mod octahedral;
mod parameters;
mod pixel_matrix;
mod pose;
mod quick;
mod standard;
mod thin_lens;
mod viewplane;

pub use aim_at::FovAxis;
pub use calibrated::Calibrated;
pub use colmap::{ColmapCamera, ColmapImages, ColmapModel};
pub use convention::{Convention, orthonormalised, rotation, rounded_pose};
pub use cube_map::CubeMap;
pub use cylindrical::Cylindrical;
pub use description::{Aim, Description, Focus, Opening};
pub use equirectangular::Equirectangular;
pub use lens::{Lens, Projection};
pub use octahedral::Octahedral;
pub use pixel_matrix::PixelMatrix;
pub use standard::StandardView;
#[doc(hidden)]
pub use thin_lens::THIN_LENS;
#[doc(hidden)]
pub use viewplane::VIEWPLANE;
pub use viewplane::{RayStart, Viewplane};

use std::ops::Range;

use crate::error::{Error, Result};
use crate::geometry::{DAffine3, DVec2, DVec3, PixelGrid, Ray, Rays, require, unit};
use crate::simd::InstructionSet;
use pose::Pose;

/// The position, orientation, size and lens of a camera. Directions need not be of length one.
///
/// ```
/// use firsthit::{Camera, DVec3, Lens, View, Viewplane};
///
/// let camera = Camera::new(View {
///     position: DVec3::new(0.0, -6.0, 2.0),
///     aim: DVec3::new(0.0, 1.0, -0.2),
///     up: DVec3::Z,
///     rows: 480,
///     columns: 720,
///     lens: Lens::Flat(Viewplane {
///         focal_length: 0.035,
///         width: 0.036,
///         height: 0.024,
///         ..Viewplane::default()
///     }),
/// })?;
/// assert_eq!(camera.pixels(), 345_600);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The camera's position, `x_c`.
    pub position: DVec3,
    /// The direction it looks in, `u_c`.
    pub aim: DVec3,
    /// The direction upwards, `v_up`; need not be perpendicular to `aim`.
    pub up: DVec3,
    /// Pixels down, `M`.
    pub rows: usize,
    /// Pixels across, `N`.
    pub columns: usize,
    /// The lens.
    pub lens: Lens,
}

impl Default for View {
    /// The view from the origin along -z with y up, at 640 x 480 square pixels.
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            aim: DVec3::NEG_Z,
            up: DVec3::Y,
            rows: 480,
            columns: 640,
            lens: Lens::default(),
        }
    }
}

/// A camera anywhere, aimed anywhere: it makes one ray for every pixel, or for any point of one.
///
/// Its frame is right-handed: `right` (`u_x`), `upwards` (`u_y`), backwards (`-aim`). Row 0 is the
/// top row, column 0 the left one, and pixel centres are at +1/2.
///
/// ```
/// use firsthit::{Camera, DVec3};
///
/// // At y = -5, looking at the origin, z upwards, 45 degrees vertically, 480 rows of 640 pixels.
/// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, 45.0, 480, 640)?;
/// assert_eq!(camera.aim(), DVec3::Y);
/// let ray = camera.ray(0, 0);
/// assert!(ray.direction.x < 0.0 && ray.direction.z > 0.0, "the upper left corner");
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    view: View,
    pose: Pose,
}

impl Camera {
    /// The camera that `view` describes.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an `aim` or `up` of length zero, an `up` parallel to `aim` to
    /// working precision, a `focal_length`, `width` or `height` that is not positive, `rows` or
    /// `columns` below one, and any NaN or infinity.
    pub fn new(view: View) -> Result<Self> {
        Self::aimed(view, unit)
    }

    /// Rebuilds a camera from its [`view`](Self::view), bit for bit: the aim has length one already
    /// and is not normalised again.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an `aim` that is not of length one, and all that [`Camera::new`]
    /// refuses.
    pub fn from_view_exact(view: View) -> Result<Self> {
        let is_unit = (view.aim.length() - 1.0).abs() < 1e-12;
        require("aim", "of length one", is_unit, view.aim)?;
        Self::aimed(view, |aim| aim)
    }

    fn aimed(view: View, unit_aim: impl Fn(DVec3) -> DVec3) -> Result<Self> {
        let pose = Pose::new(view.position, view.aim, view.up, unit_aim)?;
        require("rows", "at least 1", view.rows >= 1, view.rows)?;
        require("columns", "at least 1", view.columns >= 1, view.columns)?;
        let mut view = View { aim: pose.aim, ..view };
        view.lens.prepare([view.rows, view.columns])?;
        Ok(Self { view, pose })
    }

    /// The view that the camera was made from, `aim` at length one.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The lens.
    pub fn lens(&self) -> &Lens {
        &self.view.lens
    }

    /// The camera's position.
    pub fn position(&self) -> DVec3 {
        self.pose.position
    }

    /// The aim, of length one.
    pub fn aim(&self) -> DVec3 {
        self.pose.aim
    }

    /// The direction to the right in the picture (`u_x`), of length one.
    pub fn right(&self) -> DVec3 {
        self.pose.right
    }

    /// Upwards in the picture (`u_y`), of length one.
    pub fn upwards(&self) -> DVec3 {
        self.pose.upwards
    }

    /// Pixels down.
    pub fn rows(&self) -> usize {
        self.view.rows
    }

    /// Pixels across.
    pub fn columns(&self) -> usize {
        self.view.columns
    }

    fn size(&self) -> [usize; 2] {
        [self.view.rows, self.view.columns]
    }

    /// The number of pixels; `usize::MAX` if they are more.
    pub fn pixels(&self) -> usize {
        self.view.rows.saturating_mul(self.view.columns)
    }

    /// The camera with its rays starting elsewhere. Without a viewplane they start at the eye in
    /// any case.
    pub fn starting_at(mut self, ray_start: RayStart) -> Self {
        if let Lens::Flat(viewplane) = &mut self.view.lens {
            viewplane.ray_start = ray_start;
        }
        self
    }

    /// The point of the picture at which a point of the world is seen: columns from the picture's
    /// left edge and rows from its upper edge, so that the centre of the first pixel is (0.5, 0.5).
    /// Points that are seen beyond the edges have places there. `None` where the lens sees no such
    /// direction, as behind a pinhole. Occlusion does not matter.
    ///
    /// ```
    /// use firsthit::{Camera, DVec3, View};
    ///
    /// let camera = Camera::new(View::default())?;
    /// let ray = camera.ray(100, 200);
    /// let pixel = camera.project(ray.at(3.0)).unwrap();
    /// assert!((pixel.x - 200.5).abs() < 1e-9 && (pixel.y - 100.5).abs() < 1e-9);
    /// assert_eq!(camera.project(DVec3::Z), None);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let relative = point - self.pose.position;
        let seen = DVec3::new(
            relative.dot(self.pose.right),
            -relative.dot(self.pose.upwards),
            relative.dot(self.pose.aim),
        );
        self.view.lens.model().project(self.size(), seen)
    }

    /// The camera of a part of the picture: `rows` and `columns` are those of this camera. Its rays
    /// are this camera's, but for rounding.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an empty part or one beyond the picture, and for a projection
    /// without an intrinsic matrix, other than an orthographic one.
    pub fn crop(&self, rows: Range<usize>, columns: Range<usize>) -> Result<Self> {
        let fits = |part: &Range<usize>, all| part.start < part.end && part.end <= all;
        let is_part = fits(&rows, self.rows()) && fits(&columns, self.columns());
        let got = format!("rows {rows:?} and columns {columns:?}");
        require("crop", "a part of the picture that is not empty", is_part, got)?;
        let (first, size) = ([rows.start, columns.start], [rows.len(), columns.len()]);
        let Some(lens) = self.view.lens.cropped(self.size(), first, size) else {
            let expected = "one with an intrinsic matrix, to be cropped; or render a region";
            let name = self.view.lens.projection().name();
            return Err(Error::argument("projection", expected, name));
        };
        Self::from_view_exact(View { rows: size[0], columns: size[1], lens, ..self.view })
    }

    /// The camera of the same picture with other numbers of pixels, as by binning them. An
    /// intrinsic matrix follows.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for no rows or columns.
    pub fn resize(&self, rows: usize, columns: usize) -> Result<Self> {
        let factors = [rows as f64 / self.rows() as f64, columns as f64 / self.columns() as f64];
        Self::from_view_exact(View {
            rows,
            columns,
            lens: self.view.lens.scaled(factors),
            ..self.view
        })
    }

    /// The camera, moved with the body that carries it: `world_from_body` takes the coordinates in
    /// which this camera's position, aim and up are to others. A camera that is not turned keeps
    /// its bits, but for the position.
    ///
    /// ```
    /// use firsthit::{Camera, DAffine3, DVec3, View};
    ///
    /// let camera = Camera::new(View::default())?;
    /// let moved = camera.moved(&DAffine3::from_translation(DVec3::X))?;
    /// assert_eq!(moved.position(), DVec3::X);
    /// assert_eq!(moved.aim(), camera.aim());
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a matrix that is no rigid motion to 1e-4, and for a position that is
    /// then not finite.
    pub fn moved(&self, world_from_body: &DAffine3) -> Result<Self> {
        let turn = &world_from_body.matrix3;
        convention::require_rotation(turn, || format!("{turn:?}"))?;
        let aim = *turn * self.view.aim;
        let view = View {
            position: world_from_body.transform_point3(self.view.position),
            aim,
            up: *turn * self.view.up,
            ..self.view
        };
        if (aim.length() - 1.0).abs() < 1e-12 {
            Self::from_view_exact(view)
        } else {
            Self::new(view)
        }
    }

    /// The ray through the centre of the pixel in array row `row` (0 is the top) and `column`, its
    /// direction of length one. There are [`Camera::rows`] rows and [`Camera::columns`] columns;
    /// what is beyond them continues the viewplane.
    pub fn ray(&self, row: usize, column: usize) -> Ray {
        self.ray_within(row, column, PixelGrid::CENTRE)
    }

    /// The ray through a point of a pixel: `offset` runs from 0 to 1 rightwards and upwards, the
    /// centre being at (0.5, 0.5).
    pub fn ray_within(&self, row: usize, column: usize, offset: DVec2) -> Ray {
        let lens = self.view.lens.model();
        lens.ray(&self.pose, self.size(), [row, column], offset)
    }

    /// Fills the slices with x, y and z of the directions of the rays through a point of the pixels
    /// of one row, from a column on: what [`ray_within`](Self::ray_within) gives, sooner than one
    /// by one.
    pub fn directions_within(
        &self,
        row: usize,
        column: usize,
        offset: DVec2,
        directions: [&mut [f64]; 3],
    ) {
        let lens = self.view.lens.model();
        // They are the same with any; who chooses a wrong one is told so where rays are traced.
        let set = InstructionSet::current().unwrap_or(InstructionSet::Portable);
        lens.directions(set, &self.pose, self.size(), [row, column], offset, directions);
    }

    /// Fills `rays` with those through a point of the pixels of one row, from a column on: what
    /// [`ray_within`](Self::ray_within) gives, sooner than one by one.
    pub fn row_within(&self, row: usize, column: usize, offset: DVec2, rays: &mut [Ray]) {
        const AT_ONCE: usize = 64;
        if self.view.lens.viewplane().is_some() {
            for (column, ray) in (column..).zip(rays) {
                *ray = self.ray_within(row, column, offset);
            }
            return;
        }
        let mut lanes = [[0.0; AT_ONCE]; 3];
        for (rays, column) in rays.chunks_mut(AT_ONCE).zip((column..).step_by(AT_ONCE)) {
            let [x, y, z] = &mut lanes;
            let count = rays.len();
            let directions = [&mut x[..count], &mut y[..count], &mut z[..count]];
            self.directions_within(row, column, offset, directions);
            for (k, ray) in rays.iter_mut().enumerate() {
                let direction = DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k]);
                *ray = Ray::new(self.position(), direction);
            }
        }
    }

    /// The grid of the rays through that point of every pixel, if they all go through a flat
    /// viewplane.
    pub fn grid_within(&self, offset: DVec2) -> Option<PixelGrid> {
        self.view.lens.model().grid(&self.pose, self.size(), offset)
    }

    /// The distance from `position` along the pixel's ray to its parameter `t`.
    pub fn range(&self, row: usize, column: usize, t: f64) -> f64 {
        self.range_and_z([row, column], t)[0]
    }

    /// The component along `aim` of (hit - `position`), for the hit at `t` on the pixel's ray;
    /// infinity for a miss.
    pub fn z(&self, row: usize, column: usize, t: f64) -> f64 {
        self.range_and_z([row, column], t)[1]
    }

    fn range_and_z(&self, pixel: [usize; 2], t: f64) -> [f64; 2] {
        let reach = self.view.lens.model().reach(&self.pose, self.size(), pixel);
        let range = t + reach.offset;
        // A miss is infinitely far away in front, also where a panorama looks back.
        let z = if t == f64::INFINITY { t } else { range * reach.cosine };
        [range, z]
    }
}

/// The rays through the pixels' centres, row by row from the top.
impl Rays for Camera {
    fn len(&self) -> usize {
        self.pixels()
    }

    fn ray(&self, index: usize) -> Ray {
        Camera::ray(self, index / self.columns(), index % self.columns())
    }

    fn grid(&self) -> Option<PixelGrid> {
        self.grid_within(PixelGrid::CENTRE)
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        if let Some(grid) = self.grid() {
            return grid.read(first, rays);
        }
        let columns = self.columns();
        let (mut row, mut column) = (first / columns, first % columns);
        let mut rest = rays;
        while !rest.is_empty() {
            let (of_row, after) = rest.split_at_mut(rest.len().min(columns - column));
            self.row_within(row, column, PixelGrid::CENTRE, of_row);
            (row, column, rest) = (row + 1, 0, after);
        }
    }

    fn read_directions(&self, first: usize, directions: [&mut [f64]; 3]) {
        let (row, column) = (first / self.columns(), first % self.columns());
        self.directions_within(row, column, PixelGrid::CENTRE, directions);
    }

    fn picture(&self) -> Option<[usize; 2]> {
        let is_flat = self.view.lens.viewplane().is_some();
        (!is_flat).then(|| self.size())
    }
}
