//! OpenCV's model: radial, as a quotient of polynomials, tangential and thin prism distortion, and
//! a tilted sensor.
//!
//! With q = x² + y² for a direction (x, y, 1):
//!
//! 1. radial: (x, y) times (1 + k1 q + k2 q² + k3 q³) / (1 + k4 q + k5 q² + k6 q³);
//! 2. tangential: plus (2 p1 x y + p2 (q + 2 x²), p1 (q + 2 y²) + 2 p2 x y);
//! 3. thin prism: plus (s1 q + s2 q², s3 q + s4 q²);
//! 4. tilted sensor: the perspective map of a rotation about x by `tau_x` and then about y by
//!    `tau_y`.
//!
//! Brown, "Close-Range Camera Calibration", Photogrammetric Engineering 37(8), 1971; Claus and
//! Fitzgibbon, "A Rational Function Lens Distortion Model for General Cameras", CVPR 2005; Weng,
//! Cohen and Herniou, "Camera Calibration with Distortion Models and Accuracy Evaluation", PAMI
//! 14(10), 1992; Louhichi and others, "Self-calibration of Scheimpflug cameras", Measurement
//! Science and Technology 18(8), 2007.

use std::f64::consts::FRAC_PI_2;

use super::brown::Brown;
use super::{Distortion, Limit};
use crate::camera::quick::{Known, Pair};
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::{DMat3, DVec2, DVec3, Domain, settings};

settings! {
    /// See [`Projection::OpenCv`](crate::camera::Projection::OpenCv). The defaults distort nothing.
    pub struct OpenCv {
        /// Radial distortion: the coefficient of r².
        k1: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of r⁴.
        k2: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p1: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p2: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of r⁶.
        k3: f64, Domain::Number, default 0.0;
        /// Radial distortion, in the divisor: the coefficient of r².
        k4: f64, Domain::Number, default 0.0;
        /// Radial distortion, in the divisor: the coefficient of r⁴.
        k5: f64, Domain::Number, default 0.0;
        /// Radial distortion, in the divisor: the coefficient of r⁶.
        k6: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, across: the coefficient of r².
        s1: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, across: the coefficient of r⁴.
        s2: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, down: the coefficient of r².
        s3: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, down: the coefficient of r⁴.
        s4: f64, Domain::Number, default 0.0;
        /// The sensor's tilt about x, in radians.
        tau_x: f64, Domain::Between(-FRAC_PI_2, FRAC_PI_2), default 0.0;
        /// The sensor's tilt about y, in radians.
        tau_y: f64, Domain::Between(-FRAC_PI_2, FRAC_PI_2), default 0.0;
    }
}

impl OpenCv {
    /// All but the tilt.
    fn flat(&self) -> Brown<4> {
        Brown {
            radial: [1.0, self.k1, self.k2, self.k3],
            divisor: [1.0, self.k4, self.k5, self.k6],
            tangential: [self.p1, self.p2],
            prism: [self.s1, self.s2, self.s3, self.s4],
        }
    }

    /// Takes a homogeneous point of the sensor that is not tilted to the one that is.
    fn tilt(&self) -> DMat3 {
        let (sin_x, cos_x) = libm::sincos(self.tau_x);
        let (sin_y, cos_y) = libm::sincos(self.tau_y);
        // Column by column. As in OpenCV, each is the transpose of the usual rotation by its angle.
        let about_x =
            DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cos_x, -sin_x, 0.0, sin_x, cos_x]);
        let about_y =
            DMat3::from_cols_array(&[cos_y, 0.0, sin_y, 0.0, 1.0, 0.0, -sin_y, 0.0, cos_y]);
        let rotation = about_y * about_x;
        let (x, y, z) = (rotation.z_axis.x, rotation.z_axis.y, rotation.z_axis.z);
        let onto_plane = DMat3::from_cols_array(&[z, 0.0, 0.0, 0.0, z, 0.0, -x, -y, 1.0]);
        onto_plane * rotation
    }
}

/// A point through a perspective map; `None` behind it.
fn through(map: &DMat3, point: DVec2) -> Option<DVec2> {
    let mapped = *map * point.extend(1.0);
    (mapped.z > 0.0).then(|| mapped.truncate() / mapped.z)
}

impl Distortion for OpenCv {
    const IS_PERSPECTIVE: bool = true;

    fn is_tilted(&self) -> bool {
        self.tau_x != 0.0 || self.tau_y != 0.0
    }

    fn limit(&self, farthest: f64) -> Limit {
        self.flat().limit(farthest)
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, limit: &Limit, point: Pair<A>) -> Known<A, 3> {
        if self.is_tilted() {
            return ([of.number(0.0); 3], of.lt(point[0], point[0]));
        }
        let ([x, y], known) = self.flat().undistorted(of, limit, point);
        ([x, y, of.number(1.0)], known)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        let in_front = direction.z > 0.0;
        let point = in_front.then(|| direction.truncate() / direction.z)?;
        let distorted = self.flat().distort(limit, point)?;
        if self.is_tilted() { through(&self.tilt(), distorted) } else { Some(distorted) }
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let point = if self.is_tilted() { through(&self.tilt().inverse(), point)? } else { point };
        Some(self.flat().undistort(limit, point)?.extend(1.0))
    }
}
