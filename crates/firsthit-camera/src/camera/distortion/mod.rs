//! Models of lenses: from directions to a normalised image, and back; a file per model.
//!
//! Directions have x to the right, y down and z ahead. The normalised image has x to the right and
//! y down; near its middle it is x / z and y / z, but for the models of which the paper says
//! otherwise. Where a model folds over, so that a point of the image would have several directions,
//! it ends: the directions beyond are nowhere in the picture, and what is beyond in the picture
//! sees nothing.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it is compiled for the kernel's instruction set"
)]

mod brown;
mod double_sphere;
mod fov;
mod mei;
mod newton;
mod opencv;
mod polynomial;
mod radial;
mod thin_prism;
mod unified;

pub use double_sphere::DoubleSphere;
pub use fov::Fov;
pub use mei::Mei;
pub use opencv::OpenCv;
pub use radial::{
    Equidistant, Equisolid, KannalaBrandt, OpenCvFisheye, OrthographicFisheye, Stereographic,
};
pub use thin_prism::{RadTanThinPrismFisheye, ThinPrismFisheye};
pub use unified::{Eucm, Ucm};

use super::quick::{Known, Pair, Start};
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::{DVec2, DVec3};

/// The limit of a model, where it folds over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The largest undistorted radius, or angle to the axis.
    undistorted: f64,
    /// The radius in the image at the limit.
    pub(super) distorted: f64,
    /// The undistorted radius beyond which every point is past the fold, where a model is not
    /// radially symmetric.
    outermost: f64,
    /// The undistorted radius up to which no fold was found: up to there every solution that is not
    /// turned over is taken for the one, without a look at the way to it.
    probed: f64,
    /// About what the radius is multiplied by to be undistorted, or to be an angle, as a function
    /// of its square.
    start: Start,
}

impl Default for Limit {
    fn default() -> Self {
        Self {
            undistorted: f64::INFINITY,
            distorted: f64::INFINITY,
            outermost: f64::INFINITY,
            probed: f64::INFINITY,
            start: Start::default(),
        }
    }
}

/// A model of a lens.
pub(super) trait Distortion: Copy + Send + Sync {
    /// Whether its directions have length one, but for rounding.
    const IS_UNIT: bool = false;

    /// Whether it is a perspective camera's, all of whose directions are less than a right angle
    /// off the axis: it may have a thin lens.
    const IS_PERSPECTIVE: bool = false;

    /// Whether the sensor is tilted, so that what is in focus would be too.
    fn is_tilted(&self) -> bool {
        false
    }
    /// Finds out where it folds over.
    ///
    /// `farthest` is how far from the middle the image's points are that will be asked for, about:
    /// a start for these is prepared.
    fn limit(&self, _farthest: f64) -> Limit {
        Limit::default()
    }
    /// [`unproject`](Self::unproject) for a single point or several at once, and where it is known.
    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, _limit: &Limit, _point: Pair<A>) -> Known<A, 3> {
        let nothing = of.number(0.0);
        ([nothing; 3], of.lt(nothing, nothing))
    }
    /// The point of the image at which a direction is seen.
    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2>;
    /// The direction, of any length, that is seen at a point of the image.
    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3>;
}
