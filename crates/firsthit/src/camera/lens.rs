//! How a camera makes rays: a file per lens.

use super::equirectangular::Equirectangular;
use super::pose::Pose;
use super::viewplane::Viewplane;
use crate::error::Result;
use crate::geometry::{DVec2, PixelGrid, Ray, named};

/// What every lens can do, for a camera of a pose and with so many rows and columns of pixels.
pub(super) trait Model {
    /// Checks its numbers.
    fn check(&self) -> Result<()> {
        Ok(())
    }
    /// The ray through a point of a pixel, its direction of length one. `offset` runs from 0 to 1 rightwards and upwards.
    fn ray(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2], offset: DVec2) -> Ray;
    /// What turns the `t` of the ray through a pixel's centre into the other two distances.
    fn reach(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2]) -> Reach;
    /// What the rays through that point of all pixels have in common, if they all go through a flat viewplane.
    fn grid(&self, _: &Pose, _size: [usize; 2], _offset: DVec2) -> Option<PixelGrid> {
        None
    }
}

/// What turns a ray's `t` into the other two distances: `range = t + offset`, `z = range * cosine`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    pub(super) offset: f64,
    pub(super) cosine: f64,
}

/// Makes [`Lens`]: a lens is a file with a [`Model`], and a row.
macro_rules! lenses {
    ($($(#[$doc:meta])* $variant:ident($model:ident);)*) => {
        /// What a camera sees through, with the numbers that go with it.
        ///
        /// ```
        /// use firsthit::camera::Equirectangular;
        /// use firsthit::{Camera, DVec3, Lens, View};
        ///
        /// let lens = Lens::Equirectangular(Equirectangular {});
        /// let panorama = Camera::new(View { rows: 180, columns: 360, lens, ..View::default() })?;
        /// // Half a degree right of the aim and above it.
        /// assert!(panorama.ray(89, 180).direction.abs_diff_eq(DVec3::NEG_Z, 0.02));
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Lens {
            $($(#[$doc])* $variant($model),)*
        }

        impl Lens {
            pub(super) fn model(&self) -> &dyn Model {
                match self { $(Self::$variant(lens) => lens,)* }
            }
        }
    };
}

lenses! {
    /// A flat viewplane.
    Flat(Viewplane);
    /// The whole sphere around the camera.
    Equirectangular(Equirectangular);
}

impl Lens {
    /// Its viewplane, if it has one.
    pub fn viewplane(&self) -> Option<&Viewplane> {
        match self {
            Self::Flat(viewplane) => Some(viewplane),
            Self::Equirectangular(_) => None,
        }
    }

    /// What it is called, in files and on the command line.
    pub fn projection(&self) -> Projection {
        match self {
            Self::Flat(viewplane) if viewplane.parallel => Projection::Orthographic,
            Self::Flat(_) => Projection::Perspective,
            Self::Equirectangular(_) => Projection::Equirectangular,
        }
    }
}

named! {
    /// The projections by name, as in files and on the command line.
    ///
    /// ```
    /// use firsthit::Projection;
    ///
    /// assert_eq!("orthographic".parse::<Projection>()?, Projection::Orthographic);
    /// assert_eq!(Projection::default().name(), "perspective");
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum Projection, "projection":
    /// All rays pass through the camera's position and a flat viewplane.
    #[default]
    "perspective" => Perspective;
    /// All rays are parallel to the aim.
    "orthographic" => Orthographic;
    /// All directions: columns are degrees of longitude, rows degrees of latitude.
    "equirectangular" => Equirectangular;
}

impl Default for Lens {
    /// A perspective one, at a size of 4/3 by 1 and at distance one.
    fn default() -> Self {
        Self::Flat(Viewplane::default())
    }
}
