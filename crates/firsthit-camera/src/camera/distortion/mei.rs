//! Mei's model: the direction, at length one, is seen from a point `xi` behind the sphere's centre,
//! and then distorted as OpenCV does.
//!
//! Mei and Rives, "Single View Point Omnidirectional Camera Calibration from Planar Grids",
//! ICRA 2007. It is what `cv2.omnidir` has.

use super::opencv::OpenCv;
use super::{Distortion, Limit};
use crate::camera::quick::{Known, Pair, square};
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DVec2, DVec3, Domain, settings};

settings! {
    /// Mei's model.
    pub struct Mei {
        /// The distance of the point of view behind the sphere's centre. Default: 0, a pinhole.
        xi: f64, Domain::NonNegative, default 0.0;
        /// Radial distortion: the coefficient of r².
        k1: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of r⁴.
        k2: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p1: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p2: f64, Domain::Number, default 0.0;
    }
}

impl Mei {
    fn distortion(&self) -> OpenCv {
        let Self { k1, k2, p1, p2, .. } = *self;
        OpenCv { k1, k2, p1, p2, ..OpenCv::default() }
    }
}

impl Distortion for Mei {
    fn limit(&self, farthest: f64) -> Limit {
        self.distortion().limit(farthest)
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, limit: &Limit, point: Pair<A>) -> Known<A, 3> {
        let ([x, y, _], known) = self.distortion().directions(of, limit, point);
        let (direction, is_seen) = self.lifted(of, [x, y]);
        (direction, known & is_seen)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        let length = direction.length();
        // Where the sphere, seen from the point of view, turns its back.
        let backmost = if self.xi > 1.0 { -1.0 / self.xi } else { -self.xi };
        // Written so that a NaN fails.
        let is_seen = direction.z > backmost * length;
        if !is_seen {
            return None;
        }
        let seen = direction.truncate().extend(direction.z + self.xi * length);
        self.distortion().project(limit, seen)
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let point = self.distortion().unproject(limit, point)?;
        let point = point.truncate() / point.z;
        let (direction, is_seen) = self.lifted(Scalar, point.to_array());
        is_seen.then(|| direction.into())
    }
}

impl Mei {
    /// The direction of a point of the undistorted image, by the sphere, and where there is one.
    #[inline(always)]
    fn lifted<A: Arithmetic>(&self, of: A, [x, y]: Pair<A>) -> Known<A, 3> {
        let (one, xi) = (of.number(1.0), of.number(self.xi));
        let r2 = square(of, x, y);
        let rest = of.add(one, of.mul(of.number(1.0 - self.xi * self.xi), r2));
        let factor = of.div(of.add(xi, of.sqrt(rest)), of.add(one, r2));
        let direction = [of.mul(factor, x), of.mul(factor, y), of.sub(factor, xi)];
        (direction, of.lt(of.number(0.0), rest))
    }
}
