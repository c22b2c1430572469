//! Pixel to ray. A file per camera model, and one for the cameras that are made from a target.

mod aim_at;
mod description;
mod framing;
mod matrices;
mod orthographic;
mod perspective;
mod standard;

use std::str::FromStr;

pub use description::{Aim, Description, Lens};
pub use standard::StandardView;

use crate::error::{Error, Result};
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, Rays, unit};

/// Makes [`Projection`] and everything that depends on the list of camera models. A model is a file
/// with `ray(camera, point)`, the ray through a point of the viewplane (given relative to the camera's
/// position), `reach(camera, point)`, what to add to `t` for the range and then to multiply for z, and
/// `grid(camera)`, what the rays have in common if they all go through a flat viewplane, else `None`.
macro_rules! cameras {
    ($($(#[$doc:meta])* $name:literal => $variant:ident, $model:ident;)*) => {
        /// How the viewplane makes rays.
        ///
        /// ```
        /// use firsthit::{Camera, DVec3, Projection, View};
        ///
        /// let projection: Projection = "orthographic".parse()?;
        /// let camera = Camera::new(View { projection, ..View::default() })?;
        /// assert_eq!(camera.ray(0, 0).direction, DVec3::NEG_Z);
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
        pub enum Projection {
            $($(#[$doc])* $variant,)*
        }

        impl Projection {
            /// Every projection's name.
            pub const NAMES: &[&'static str] = &[$($name),*];

            /// Its name, as in files and on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            fn ray(self, camera: &Camera, point: DVec3) -> Ray {
                match self { $(Self::$variant => $model::ray(camera, point),)* }
            }

            fn reach(self, camera: &Camera, point: DVec3) -> Reach {
                match self { $(Self::$variant => $model::reach(camera, point),)* }
            }

            fn grid(self, camera: &Camera) -> Option<PixelGrid> {
                match self { $(Self::$variant => $model::grid(camera),)* }
            }
        }

        impl FromStr for Projection {
            type Err = Error;

            fn from_str(name: &str) -> Result<Self> {
                match name {
                    $($name => Ok(Self::$variant),)*
                    _ => Err(Error::argument("projection", concat!("one of" $(, " ", $name)*), name)),
                }
            }
        }
    };
}

cameras! {
    /// All rays pass through the camera's position.
    #[default]
    "perspective" => Perspective, perspective;
    /// All rays are parallel to the aim.
    "orthographic" => Orthographic, orthographic;
}

/// Where a camera's rays start.
///
/// ```
/// use firsthit::{Camera, DVec3, RayStart, View};
///
/// let camera = Camera::new(View { focal_length: 2.0, ..View::default() })?;
/// assert_eq!(camera.ray(240, 320).origin.z, -2.0);
/// assert_eq!(camera.starting_at(RayStart::Eye).ray(240, 320).origin, DVec3::ZERO);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum RayStart {
    /// On the viewplane: what lies between the camera and the viewplane is not seen.
    #[default]
    Viewplane,
    /// At the camera's position; for parallel rays, on the plane through it.
    Eye,
}

impl RayStart {
    /// Its name, as in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viewplane => "viewplane",
            Self::Eye => "eye",
        }
    }
}

/// What turns a ray's `t` into the other two distances: `range = t + offset`, `z = range * cosine`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Reach {
    offset: f64,
    cosine: f64,
}

/// What a camera is made from. Lengths are in scene units, directions need not be of length one.
///
/// ```
/// use firsthit::{Camera, DVec3, View};
///
/// let camera = Camera::new(View {
///     position: DVec3::new(0.0, -6.0, 2.0),
///     aim: DVec3::new(0.0, 1.0, -0.2),
///     up: DVec3::Z,
///     focal_length: 0.035,
///     width: 0.036,
///     height: 0.024,
///     rows: 480,
///     columns: 720,
///     ..View::default()
/// })?;
/// assert_eq!(camera.pixels(), 345_600);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where the camera is, `x_c`.
    pub position: DVec3,
    /// The direction it looks in, `u_c`.
    pub aim: DVec3,
    /// Which way is up, `v_up`; need not be perpendicular to `aim`.
    pub up: DVec3,
    /// The distance from the camera to the viewplane, `z_p`.
    pub focal_length: f64,
    /// The viewplane's width, `w`.
    pub width: f64,
    /// The viewplane's height, `h`.
    pub height: f64,
    /// Pixels down, `M`.
    pub rows: usize,
    /// Pixels across, `N`.
    pub columns: usize,
    /// How the viewplane makes rays.
    pub projection: Projection,
    /// Where they start.
    pub ray_start: RayStart,
}

impl Default for View {
    /// At the origin, looking along -z with y up, at 640 x 480 square pixels.
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            aim: DVec3::NEG_Z,
            up: DVec3::Y,
            focal_length: 1.0,
            width: 4.0 / 3.0,
            height: 1.0,
            rows: 480,
            columns: 640,
            projection: Projection::Perspective,
            ray_start: RayStart::Viewplane,
        }
    }
}

/// A camera anywhere, aimed anywhere: it makes one ray for every pixel, or for any point of one.
///
/// Its frame is right-handed: `right` (`u_x`), `upwards` (`u_y`), backwards (`-aim`). Row 0 is the top
/// row, column 0 the left one, and pixel centres are at +1/2.
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
    right: DVec3,
    upwards: DVec3,
}

impl Camera {
    /// The camera that `view` describes.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an `aim` or `up` of length zero, an `up` parallel to `aim` to working
    /// precision, a `focal_length`, `width` or `height` that is not positive, `rows` or `columns` below
    /// one, and any NaN or infinity.
    pub fn new(view: View) -> Result<Self> {
        Self::aimed(view, unit)
    }

    /// Rebuilds a camera from its [`view`](Self::view), bit for bit: the aim has length one already and is not normalised again.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an `aim` that is not of length one, and all that [`Camera::new`] refuses.
    pub fn again(view: View) -> Result<Self> {
        let is_unit = (view.aim.length() - 1.0).abs() < 1e-12;
        require("aim", "of length one", is_unit, view.aim)?;
        Self::aimed(view, |aim| aim)
    }

    fn aimed(view: View, unit_aim: impl Fn(DVec3) -> DVec3) -> Result<Self> {
        require(
            "position",
            "finite",
            view.position.is_finite(),
            view.position,
        )?;
        for (name, direction) in [("aim", view.aim), ("up", view.up)] {
            let fine = direction.is_finite() && direction != DVec3::ZERO;
            require(name, "a finite direction, not zero", fine, direction)?;
        }
        for (name, length) in [
            ("focal_length", view.focal_length),
            ("width", view.width),
            ("height", view.height),
        ] {
            require(
                name,
                "positive and finite",
                length > 0.0 && length.is_finite(),
                length,
            )?;
        }
        require("rows", "at least 1", view.rows >= 1, view.rows)?;
        require("columns", "at least 1", view.columns >= 1, view.columns)?;

        let aim = unit_aim(view.aim);
        let across = aim.cross(unit(view.up));
        // Below this the cross product is nothing but the rounding of its factors.
        let apart = across.length() > 4.0 * f64::EPSILON;
        let both = format!("{} (aim is {})", view.up, view.aim);
        require("up", "in another direction than aim", apart, both)?;
        // Where `up` is close to `aim`, what is left of the product is not perpendicular to them.
        let right = unit(across - across.dot(aim) * aim);
        // u_y = u_z x u_x with u_z = -u_c.
        Ok(Self {
            view: View { aim, ..view },
            right,
            upwards: (-aim).cross(right),
        })
    }

    /// What the camera was made from, `aim` at length one.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Where the camera is.
    pub fn position(&self) -> DVec3 {
        self.view.position
    }

    /// Where it looks, of length one.
    pub fn aim(&self) -> DVec3 {
        self.view.aim
    }

    /// To the right in the picture (`u_x`), of length one.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// Upwards in the picture (`u_y`), of length one.
    pub fn upwards(&self) -> DVec3 {
        self.upwards
    }

    /// Pixels down.
    pub fn rows(&self) -> usize {
        self.view.rows
    }

    /// Pixels across.
    pub fn columns(&self) -> usize {
        self.view.columns
    }

    /// How many pixels there are; `usize::MAX` if they are more.
    pub fn pixels(&self) -> usize {
        self.view.rows.saturating_mul(self.view.columns)
    }

    /// The same camera with its rays starting elsewhere.
    pub fn starting_at(self, ray_start: RayStart) -> Self {
        Self {
            view: View {
                ray_start,
                ..self.view
            },
            ..self
        }
    }

    /// The ray through the centre of the pixel in array row `row` (0 is the top) and `column`, its
    /// direction of length one. There are [`Camera::rows`] rows and [`Camera::columns`] columns; what is
    /// beyond them continues the viewplane.
    pub fn ray(&self, row: usize, column: usize) -> Ray {
        self.ray_within(row, column, DVec2::splat(0.5))
    }

    /// The ray through a point of a pixel: `offset` runs from 0 to 1 rightwards and upwards, the
    /// centre being at (0.5, 0.5).
    pub fn ray_within(&self, row: usize, column: usize, offset: DVec2) -> Ray {
        self.view
            .projection
            .ray(self, self.viewplane_point(row, column, offset))
    }

    /// The distance from `position` along the pixel's ray to its parameter `t`.
    pub fn range(&self, row: usize, column: usize, t: f64) -> f64 {
        t + self.reach(row, column).offset
    }

    /// The component along `aim` of (hit - `position`), for the hit at `t` on the pixel's ray.
    pub fn z(&self, row: usize, column: usize, t: f64) -> f64 {
        let reach = self.reach(row, column);
        (t + reach.offset) * reach.cosine
    }

    /// The rays through a flat viewplane, parallel ones or those from a point.
    fn pixel_grid(&self, parallel: Option<DVec3>) -> PixelGrid {
        PixelGrid {
            rows: self.view.rows,
            columns: self.view.columns,
            position: self.view.position,
            toward: self.view.focal_length * self.view.aim,
            right: self.right,
            upwards: self.upwards,
            width: self.view.width,
            height: self.view.height,
            parallel,
            starts_on_viewplane: self.view.ray_start == RayStart::Viewplane,
        }
    }

    fn reach(&self, row: usize, column: usize) -> Reach {
        let point = self.viewplane_point(row, column, DVec2::splat(0.5));
        self.view.projection.reach(self, point)
    }

    /// A point of the viewplane, relative to `position`: far from the world's origin the pixel's place
    /// would drown in the rounding of world coordinates.
    fn viewplane_point(&self, row: usize, column: usize, offset: DVec2) -> DVec3 {
        let View {
            width,
            height,
            rows,
            columns,
            focal_length,
            aim,
            ..
        } = self.view;
        // The one place where rows are flipped: the formula counts them from the bottom.
        let i = (rows - 1) as f64 - row as f64;
        let j = column as f64;
        let x = -width / 2.0 + width / columns as f64 * (j + offset.x);
        let y = -height / 2.0 + height / rows as f64 * (i + offset.y);
        focal_length * aim + x * self.right + y * self.upwards
    }
}

fn require(
    name: &'static str,
    expected: &'static str,
    fine: bool,
    got: impl std::fmt::Display,
) -> Result<()> {
    if fine {
        Ok(())
    } else {
        Err(Error::argument(name, expected, got))
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
        self.view.projection.grid(self)
    }
}
