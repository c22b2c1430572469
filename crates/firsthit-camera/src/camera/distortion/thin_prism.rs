//! Fisheyes that are not the same all around: tangential and thin prism distortion of an image
//! whose radius is the angle, or a polynomial of it.
//!
//! [`ThinPrismFisheye`] is the model of COLMAP (Schönberger and Frahm, "Structure-from-Motion
//! Revisited", CVPR 2016) and of ETH3D (Schöps and others, "A Multi-View Stereo Benchmark with
//! High-Resolution Images and Multi-Camera Videos", CVPR 2017). The direction at the angle a to the
//! axis is put at the radius a, and that point (x, y) is distorted as by [`OpenCv`](super::OpenCv).
//! With q = a²:
//!
//! 1. radial: (x, y) times 1 + k1 q + k2 q² + k3 q³ + k4 q⁴;
//! 2. tangential: plus (2 p1 x y + p2 (q + 2 x²), p1 (q + 2 y²) + 2 p2 x y);
//! 3. thin prism: plus (sx1 q, sy1 q).
//!
//! [`RadTanThinPrismFisheye`] is the model of the cameras of Project Aria (Engel and others,
//! "Project Aria: A New Tool for Egocentric Multi-Modal AI Research", 2023). Its parts come one
//! after the other. The direction at the angle a is put at the radius a (1 + k0 a² + ... + k5 a¹²).
//! With q = x² + y² of that point (x, y):
//!
//! 1. tangential: plus (p0 (q + 2 x²) + 2 p1 x y, 2 p0 x y + p1 (q + 2 y²));
//! 2. thin prism: plus (s0 q + s1 q², s2 q + s3 q²).

use std::f64::consts::PI;

use super::brown::Brown;
use super::radial::{AngleSeries, Equidistant};
use super::{Distortion, Limit};
use crate::camera::quick::{Known, Pair};
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::{DVec2, DVec3, Domain, settings};

settings! {
    /// An equidistant fisheye with OpenCV's distortion, of which the radial part has a term more.
    pub struct ThinPrismFisheye {
        /// Radial distortion: the coefficient of a².
        k1: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of a⁴.
        k2: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p1: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p2: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of a⁶.
        k3: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of a⁸.
        k4: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, across: the coefficient of a².
        sx1: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, down: the coefficient of a².
        sy1: f64, Domain::Number, default 0.0;
    }
}

settings! {
    /// A polynomial of the angle, and then tangential and thin prism distortion.
    pub struct RadTanThinPrismFisheye {
        /// Radial distortion: the coefficient of the angle's third power.
        k0: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of the angle's fifth power.
        k1: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of the angle's seventh power.
        k2: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of the angle's ninth power.
        k3: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of the angle's eleventh power.
        k4: f64, Domain::Number, default 0.0;
        /// Radial distortion: the coefficient of the angle's thirteenth power.
        k5: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p0: f64, Domain::Number, default 0.0;
        /// Tangential distortion.
        p1: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, across: the coefficient of r².
        s0: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, across: the coefficient of r⁴.
        s1: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, down: the coefficient of r².
        s2: f64, Domain::Number, default 0.0;
        /// Thin prism distortion, down: the coefficient of r⁴.
        s3: f64, Domain::Number, default 0.0;
    }
}

/// Every direction, at a radius that is its angle.
const EQUIDISTANT: Equidistant = Equidistant { fov: 360.0 };

/// The limit of that.
fn all_around() -> Limit {
    Limit { undistorted: PI, distorted: PI, outermost: PI, probed: PI, ..Limit::default() }
}

impl ThinPrismFisheye {
    /// The distortion of the equidistant image.
    fn plane(&self) -> Brown<5> {
        Brown {
            radial: [1.0, self.k1, self.k2, self.k3, self.k4],
            divisor: [1.0, 0.0, 0.0, 0.0],
            tangential: [self.p1, self.p2],
            prism: [self.sx1, 0.0, self.sy1, 0.0],
        }
    }
}

impl Distortion for ThinPrismFisheye {
    const IS_UNIT: bool = true;

    fn limit(&self, farthest: f64) -> Limit {
        let plane = self.plane();
        let limit = plane.limit(farthest);
        if limit.undistorted < PI {
            return limit;
        }
        // The image ends where the angle does: a start beyond is of no use.
        let edge = PI * plane.radial(PI * PI)[0];
        plane.limit(farthest.min(edge))
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, limit: &Limit, point: Pair<A>) -> Known<A, 3> {
        let (point, known) = self.plane().undistorted(of, limit, point);
        let (direction, is_seen) = EQUIDISTANT.directions(of, &all_around(), point);
        (direction, known & is_seen)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        let point = EQUIDISTANT.project(&all_around(), direction)?;
        self.plane().distort(limit, point)
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let point = self.plane().undistort(limit, point)?;
        EQUIDISTANT.unproject(&all_around(), point)
    }
}

impl RadTanThinPrismFisheye {
    fn polynomial(&self) -> AngleSeries {
        let Self { k0, k1, k2, k3, k4, k5, .. } = *self;
        AngleSeries([1.0, k0, k1, k2, k3, k4, k5])
    }

    /// The distortion of the polynomial's image. Its tangential numbers are OpenCV's in the other
    /// order.
    fn plane(&self) -> Brown<1> {
        Brown {
            radial: [1.0],
            divisor: [1.0, 0.0, 0.0, 0.0],
            tangential: [self.p1, self.p0],
            prism: [self.s0, self.s1, self.s2, self.s3],
        }
    }
}

/// The limit of the second stage, which distorts the polynomial's image. It has no fold of its own
/// by radius; how far it was probed is kept in the limit of the lens.
fn of_plane(limit: &Limit) -> Limit {
    Limit { probed: limit.probed, ..Limit::default() }
}

impl Distortion for RadTanThinPrismFisheye {
    const IS_UNIT: bool = true;

    fn limit(&self, farthest: f64) -> Limit {
        let limit = self.polynomial().limit(farthest);
        let probed = self.plane().limit(farthest).probed;
        Limit { probed, ..limit }
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, limit: &Limit, point: Pair<A>) -> Known<A, 3> {
        let (point, known) = self.plane().undistorted(of, &of_plane(limit), point);
        let (direction, is_seen) = self.polynomial().directions(of, limit, point);
        (direction, known & is_seen)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        let point = self.polynomial().project(limit, direction)?;
        self.plane().distort(&of_plane(limit), point)
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let point = self.plane().undistort(&of_plane(limit), point)?;
        self.polynomial().unproject(limit, point)
    }
}
