//! Models of lenses: from directions to a normalised image, and back; a file per model.
//!
//! Directions have x to the right, y down and z ahead. The normalised image has x to the right and y down; near its middle it is
//! x / z and y / z, but for the models of which the paper says otherwise. Where a model folds over, so that a point of the image would
//! have several directions, it ends: the directions beyond are nowhere in the picture, and what is beyond in the picture sees nothing.

mod double_sphere;
mod mei;
mod newton;
mod opencv;
mod polynomial;
mod radial;
mod unified;

pub use double_sphere::DoubleSphere;
pub use mei::Mei;
pub use opencv::OpenCv;
pub use radial::{
    Equidistant, Equisolid, KannalaBrandt, OpenCvFisheye, OrthographicFisheye, Stereographic,
};
pub use unified::{Eucm, Ucm};

use super::parameters::Parameters;
use crate::error::Result;
use crate::geometry::{DVec2, DVec3};

/// How far a model goes before it folds over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The largest undistorted radius, or angle to the axis.
    undistorted: f64,
    /// What the image's radius is there.
    pub(super) distorted: f64,
    /// Where a model is not the same all around: the undistorted radius beyond which every point is past the fold.
    outermost: f64,
}

impl Default for Limit {
    fn default() -> Self {
        Self {
            undistorted: f64::INFINITY,
            distorted: f64::INFINITY,
            outermost: f64::INFINITY,
        }
    }
}

/// A model of a lens.
pub(super) trait Distortion: Parameters + Copy + Send + Sync {
    /// Checks its parameters, which are finite, and finds out where it folds over.
    fn limit(&self) -> Result<Limit> {
        Ok(Limit::default())
    }
    /// The point of the image at which a direction is seen.
    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2>;
    /// The direction, of any length, that is seen at a point of the image.
    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3>;
}
