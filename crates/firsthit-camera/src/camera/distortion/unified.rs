//! The unified camera model and the enhanced one: a sphere or an ellipsoid, seen from a point
//! beside its centre.
//!
//! With d = sqrt(beta (x² + y²) + z²), a direction is seen at (x, y) / (alpha d + (1 - alpha) z).
//! The unified model has a beta of 1.
//!
//! Geyer and Daniilidis, "A Unifying Theory for Central Panoramic Systems and Practical
//! Implications", ECCV 2000; Khomutenko, Garcia and Martinet, "An Enhanced Unified Camera Model",
//! RA-L 1(1), 2016; in the form of Usenko, Demmel and Cremers, "The Double Sphere Camera Model",
//! 3DV 2018.

use super::{Distortion, Limit};
use crate::camera::quick::{Known, Pair, square};
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DVec2, DVec3, Domain, settings};

settings! {
    /// The unified camera model.
    pub struct Ucm {
        /// The weight from 0, a pinhole, to 1.
        alpha: f64, Domain::From(0.0, 1.0), default 0.0;
    }
}

settings! {
    /// The enhanced unified camera model.
    pub struct Eucm {
        /// The weight from 0, a pinhole, to 1.
        alpha: f64, Domain::From(0.0, 1.0), default 0.0;
        /// How much of x² + y² counts. Default: 1.
        beta: f64, Domain::Positive, default 1.0;
    }
}

/// The height z of the direction that is seen at the squared distance `r2` from the middle, where x
/// and y are those of the image; and what is under the square root in it.
#[inline(always)]
pub(super) fn height<A: Arithmetic>(of: A, alpha: f64, r2: A::Number) -> (A::Number, A::Number) {
    let one = of.number(1.0);
    let rest = of.sub(one, of.mul(of.number(2.0 * alpha - 1.0), r2));
    let above = of.sub(one, of.mul(of.number(alpha * alpha), r2));
    let root = of.mul(of.number(alpha), of.sqrt(rest));
    let below = of.add(root, of.number(1.0 - alpha));
    (of.div(above, below), rest)
}

/// The largest z / d behind the camera at which directions are still seen.
pub(super) fn backmost(alpha: f64) -> f64 {
    if alpha <= 0.5 { -alpha / (1.0 - alpha) } else { -(1.0 - alpha) / alpha }
}

impl Distortion for Eucm {
    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, _: &Limit, [x, y]: Pair<A>) -> Known<A, 3> {
        let r2 = of.mul(of.number(self.beta), square(of, x, y));
        let (z, rest) = height(of, self.alpha, r2);
        // Where nothing is left of it, and beyond, nothing is seen.
        ([x, y, z], of.lt(of.number(0.0), rest))
    }

    fn project(&self, _: &Limit, direction: DVec3) -> Option<DVec2> {
        let Self { alpha, beta } = *self;
        let aside = direction.truncate();
        let z = direction.z;
        let d = (beta * aside.length_squared() + z * z).sqrt();
        // Written so that a NaN fails.
        let is_seen = z > backmost(alpha) * d;
        is_seen.then(|| aside / (alpha * d + (1.0 - alpha) * z))
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let (direction, is_seen) = self.directions(Scalar, limit, point.to_array());
        is_seen.then(|| direction.into())
    }
}

impl Ucm {
    fn enhanced(self) -> Eucm {
        Eucm { alpha: self.alpha, beta: 1.0 }
    }
}

impl Distortion for Ucm {
    fn limit(&self, farthest: f64) -> Limit {
        self.enhanced().limit(farthest)
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, limit: &Limit, point: Pair<A>) -> Known<A, 3> {
        self.enhanced().directions(of, limit, point)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        self.enhanced().project(limit, direction)
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        self.enhanced().unproject(limit, point)
    }
}
