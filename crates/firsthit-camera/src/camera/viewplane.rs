//! A flat viewplane: perspective where rays run through the camera's position, orthographic where
//! they are parallel.

use super::lens::{Model, Projection, Reach};
use super::parameters::Parameters;
use super::pixel_matrix::PixelMatrix;
use super::pose::Pose;
use super::thin_lens::{THIN_LENS, check_thin_lens};
use crate::error::Result;
use crate::geometry::{
    DMat3, DVec2, DVec3, Domain, PixelGrid, Ray, Setting, Settings, named, require, setting_list,
};

/// A flat viewplane in front of the camera. Lengths are in scene units. Unless rays start at the
/// eye, what is nearer than the viewplane is not seen; `explain::before_viewplane` tells of what.
///
/// ```
/// use firsthit::{Camera, DVec3, Lens, View, Viewplane};
///
/// // Parallel rays, ten units from the lower to the upper edge.
/// let viewplane = Viewplane { width: 16.0, height: 10.0, parallel: true, ..Viewplane::default() };
/// let camera = Camera::new(View { lens: Lens::Flat(viewplane), ..View::default() })?;
/// assert_eq!(camera.ray(0, 0).direction, DVec3::NEG_Z);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewplane {
    /// The distance from the camera, `z_p`.
    pub focal_length: f64,
    /// The width, `w`.
    pub width: f64,
    /// The height, `h`.
    pub height: f64,
    /// Whether all rays are parallel to the aim; else they run through the camera's position.
    pub parallel: bool,
    /// The start of rays.
    pub ray_start: RayStart,
    /// The vector from where the aim meets the viewplane to its middle: to the right and upwards,
    /// along the viewplane.
    pub shift: DVec2,
    /// The turn of the viewplane out of the right angle to the aim, in degrees, as of a camera's
    /// back by Scheimpflug's rule: first about `upwards`, by `tilt.x`, which brings its right edge
    /// nearer; then about its own horizontal, by `tilt.y`, which brings its upper edge nearer.
    pub tilt: DVec2,
    /// The shift of a column to the right for each unit upwards.
    pub skew: f64,
    /// The diameter of the lens, for the colours of pictures with several samples; 0 is a pinhole.
    /// See [`Camera::thin_lens`](super::Camera::thin_lens).
    pub aperture: f64,
    /// The distance along the aim from the camera to the plane in focus, which is parallel to the
    /// viewplane. 0 by default, as of a pinhole.
    pub focus: f64,
}

impl Default for Viewplane {
    /// A viewplane of 4/3 by 1, at distance one; rays run through the camera's position and start
    /// on the viewplane.
    fn default() -> Self {
        Self {
            focal_length: 1.0,
            width: 4.0 / 3.0,
            height: 1.0,
            parallel: false,
            ray_start: RayStart::Viewplane,
            shift: DVec2::ZERO,
            tilt: DVec2::ZERO,
            skew: 0.0,
            aperture: 0.0,
            focus: 0.0,
        }
    }
}

/// A viewplane's numbers: its size and place, its shift, its tilt, and its skew.
pub const VIEWPLANE: &[Setting; 8] = setting_list! {
    /// The distance from the camera to the viewplane.
    focal_length: Domain::Positive, default;
    /// The viewplane's width.
    width: Domain::Positive, default;
    /// The viewplane's height.
    height: Domain::Positive, default;
    /// From where the aim meets the viewplane to its middle, to the right. Default: 0.
    shift_x: Domain::Number, default;
    /// From where the aim meets the viewplane to its middle, upwards. Default: 0.
    shift_y: Domain::Number, default;
    /// Degrees by which the viewplane is turned about its vertical, its right edge nearer. Default:
    /// 0.
    tilt_x: Domain::Between(-90.0, 90.0), default;
    /// Degrees by which the viewplane is turned about its horizontal, its upper edge nearer.
    /// Default: 0.
    tilt_y: Domain::Between(-90.0, 90.0), default;
    /// How far to the right a column leans for each unit upwards. Default: 0.
    skew: Domain::Number, default;
};

impl Parameters for Viewplane {
    fn each(&mut self, visit: &mut dyn FnMut(&'static Setting, &mut f64)) {
        let numbers = [
            &mut self.focal_length,
            &mut self.width,
            &mut self.height,
            &mut self.shift.x,
            &mut self.shift.y,
            &mut self.tilt.x,
            &mut self.tilt.y,
            &mut self.skew,
            &mut self.aperture,
            &mut self.focus,
        ];
        for (setting, number) in VIEWPLANE.iter().chain(THIN_LENS).zip(numbers) {
            visit(setting, number);
        }
    }

    /// Cameras without a lens do not speak of one.
    fn is_silent(&self, name: &str) -> bool {
        matches!(name, "aperture" | "focus") && self.aperture == 0.0 && self.focus == 0.0
    }
}

impl Projection {
    /// Whether its rays go through a flat viewplane.
    #[doc(hidden)]
    pub fn has_viewplane(self) -> bool {
        matches!(self, Self::Perspective | Self::Orthographic)
    }

    /// Whether it is a panorama. Cameras with one stand in the middle of a scene.
    #[doc(hidden)]
    pub fn is_panorama(self) -> bool {
        matches!(self, Self::Equirectangular | Self::Cylindrical | Self::CubeMap | Self::Octahedral)
    }
}

named! {
    /// The start of a camera's rays.
    ///
    /// ```
    /// use firsthit::{Camera, DVec3, Lens, RayStart, View, Viewplane};
    ///
    /// let lens = Lens::Flat(Viewplane { focal_length: 2.0, ..Viewplane::default() });
    /// let camera = Camera::new(View { lens, ..View::default() })?;
    /// assert_eq!(camera.ray(240, 320).origin.z, -2.0);
    /// assert_eq!(camera.starting_at(RayStart::Eye).ray(240, 320).origin, DVec3::ZERO);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum RayStart, "ray_start":
    /// Rays start on the viewplane: objects between the camera and the viewplane are not seen.
    #[default]
    "viewplane" => Viewplane;
    /// Rays start at the camera's position; parallel ones on the plane through it.
    "eye" => Eye;
}

/// A viewplane in space: from the camera to its middle, and its axes.
struct Placed {
    middle: DVec3,
    right: DVec3,
    upwards: DVec3,
}

impl Viewplane {
    /// The viewplane of a pinhole camera whose intrinsic matrix is known, at distance one. Rays
    /// start at the eye.
    ///
    /// ```
    /// use firsthit::camera::PixelMatrix;
    /// use firsthit::{Camera, DVec3, Lens, View, Viewplane};
    ///
    /// let matrix = PixelMatrix { fx: 500.0, fy: 500.0, cx: 300.0, cy: 250.0, skew: 0.0 };
    /// let lens = Lens::Flat(Viewplane::from_pixel_matrix(&matrix, 480, 640)?);
    /// let camera = Camera::new(View { lens, ..View::default() })?;
    /// let ahead = camera.project(DVec3::new(0.0, 0.0, -7.0)).unwrap();
    /// assert!((ahead.x - 300.0).abs() < 1e-9 && (ahead.y - 250.0).abs() < 1e-9);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for focal lengths that are not positive,
    /// and numbers that are not finite.
    pub fn from_pixel_matrix(matrix: &PixelMatrix, rows: usize, columns: usize) -> Result<Self> {
        matrix.check()?;
        let PixelMatrix { fx, fy, cx, cy, skew } = *matrix;
        let (across, down) = (columns.max(1) as f64, rows.max(1) as f64);
        let (skew, up) = (skew / fx, (cy - 0.5 * down) / fy);
        Ok(Self {
            focal_length: 1.0,
            width: across / fx,
            height: down / fy,
            ray_start: RayStart::Eye,
            shift: DVec2::new((0.5 * across - cx) / fx + skew * up, up),
            skew,
            ..Self::default()
        })
    }

    /// Refuses what is no thin lens.
    fn check_lens(&self) -> Result<()> {
        let aperture = self.aperture;
        check_thin_lens(aperture, self.focus)?;
        if aperture == 0.0 {
            return Ok(());
        }
        let expected = "zero for parallel rays, which come through no lens";
        require("aperture", expected, !self.parallel, aperture)?;
        let expected = "zero for a tilted viewplane: what is in focus would be tilted too";
        let is_upright = self.tilt == DVec2::ZERO;
        require("aperture", expected, is_upright, aperture)
    }

    /// The viewplane as it is from another point of the lens, so much to the right and upwards of
    /// the camera's position: what is in focus is seen at the same places. It is a pinhole's.
    ///
    /// Let the point at `s p` be in focus, where `p` is the viewplane's and `s` the same for all of
    /// them. From the point `l` of the lens it is in the direction of `p - l / s`.
    pub(super) fn seen_from(&self, point: DVec2) -> Self {
        Self {
            shift: self.shift - point * (self.focal_length / self.focus),
            aperture: 0.0,
            focus: 0.0,
            ..*self
        }
    }

    /// Whether the aim meets its middle at a right angle, and its columns are at right angles to
    /// its rows.
    pub(super) fn is_centred(&self) -> bool {
        (self.shift, self.tilt, self.skew) == (DVec2::ZERO, DVec2::ZERO, 0.0)
    }

    /// The intrinsic matrix with these numbers of rows and columns; `None` where rays are parallel
    /// or the viewplane is tilted.
    pub(super) fn pixel_matrix(&self, [rows, columns]: [usize; 2]) -> Option<PixelMatrix> {
        if self.parallel || self.tilt != DVec2::ZERO {
            return None;
        }
        let (across, down) = (columns as f64, rows as f64);
        let (fx, fy) =
            (self.focal_length * across / self.width, self.focal_length * down / self.height);
        let shift = self.shift / self.focal_length;
        Some(PixelMatrix {
            fx,
            fy,
            cx: 0.5 * across - fx * (shift.x - self.skew * shift.y),
            cy: 0.5 * down + fy * shift.y,
            skew: fx * self.skew,
        })
    }

    /// The viewplane of a part of the picture, which begins at a row and a column.
    pub(super) fn cropped(
        &self,
        [rows, columns]: [usize; 2],
        [row, column]: [usize; 2],
        [down, across]: [usize; 2],
    ) -> Self {
        let size = DVec2::new(self.width / columns as f64, self.height / rows as f64);
        // From the middle of the whole to the middle of the part, in pixels.
        let x = column as f64 + 0.5 * across as f64 - 0.5 * columns as f64;
        let y = 0.5 * rows as f64 - (row as f64 + 0.5 * down as f64);
        let up = y * size.y;
        Self {
            width: size.x * across as f64,
            height: size.y * down as f64,
            shift: self.shift + DVec2::new(x * size.x + self.skew * up, up),
            ..*self
        }
    }

    /// The place of the viewplane, for a camera with this frame.
    fn placed(&self, [right, upwards, aim]: [DVec3; 3]) -> Placed {
        let ahead = self.focal_length * aim;
        if self.is_centred() {
            return Placed { middle: ahead, right, upwards };
        }
        let (sin_x, cos_x) = libm::sincos(self.tilt.x.to_radians());
        let (sin_y, cos_y) = libm::sincos(self.tilt.y.to_radians());
        // Each edge comes nearer, so each axis turns against the aim.
        let across = cos_x * right - sin_x * aim;
        let behind = sin_x * right + cos_x * aim;
        let up = cos_y * upwards - sin_y * behind;
        Placed {
            middle: ahead + self.shift.x * across + self.shift.y * up,
            right: across,
            upwards: up + self.skew * across,
        }
    }

    fn pixels(&self, pose: &Pose, [rows, columns]: [usize; 2], offset: DVec2) -> PixelGrid {
        let placed = self.placed([pose.right, pose.upwards, pose.aim]);
        let ahead = self.focal_length * pose.aim;
        // Parallel rays that start at the camera start on the plane through it.
        let (position, toward) = if self.parallel {
            (pose.position + (placed.middle - ahead), ahead)
        } else {
            (pose.position, placed.middle)
        };
        PixelGrid {
            rows,
            columns,
            first: [0, 0],
            whole: [rows, columns],
            position,
            toward,
            right: placed.right,
            upwards: placed.upwards,
            width: self.width,
            height: self.height,
            parallel: self.parallel.then_some(pose.aim),
            starts_on_viewplane: self.ray_start == RayStart::Viewplane,
            offset,
        }
    }
}

impl Model for Viewplane {
    fn prepare(&mut self, _: [usize; 2]) -> Result<()> {
        let fine = !self.parallel || self.tilt == DVec2::ZERO;
        require("tilt", "zero for parallel rays", fine, self.tilt)?;
        self.check_lens()
    }

    #[inline]
    fn ray(&self, pose: &Pose, size: [usize; 2], [row, column]: [usize; 2], offset: DVec2) -> Ray {
        self.pixels(pose, size, offset).ray(row, column)
    }

    fn project(&self, [rows, columns]: [usize; 2], point: DVec3) -> Option<DVec2> {
        let Placed { middle, right, upwards } = self.placed([DVec3::X, DVec3::NEG_Y, DVec3::Z]);
        let axes = DMat3::from_cols(right, upwards, middle);
        let seen = if self.parallel {
            let from_middle = point - (middle - self.focal_length * DVec3::Z);
            DMat3::from_cols(right, upwards, DVec3::Z).inverse() * from_middle
        } else {
            let seen = axes.inverse() * point;
            let is_ahead = seen.z > 0.0;
            if !is_ahead {
                return None;
            }
            seen / seen.z
        };
        let pixel = DVec2::new(
            (0.5 + seen.x / self.width) * columns as f64,
            (0.5 - seen.y / self.height) * rows as f64,
        );
        pixel.is_finite().then_some(pixel)
    }

    fn reach(&self, pose: &Pose, size: [usize; 2], [row, column]: [usize; 2]) -> Reach {
        let grid = self.pixels(pose, size, PixelGrid::CENTRE);
        let (distance, cosine) = if self.parallel {
            (self.focal_length, 1.0)
        } else {
            let point = grid.point(row, column);
            let distance = point.length();
            let ahead =
                if self.tilt == DVec2::ZERO { self.focal_length } else { point.dot(pose.aim) };
            (distance, ahead / distance)
        };
        let offset = if grid.starts_on_viewplane { distance } else { 0.0 };
        Reach { offset, cosine }
    }

    fn grid(&self, pose: &Pose, size: [usize; 2], offset: DVec2) -> Option<PixelGrid> {
        Some(self.pixels(pose, size, offset))
    }
}
