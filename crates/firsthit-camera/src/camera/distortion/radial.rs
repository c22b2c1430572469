//! Fisheyes: the radius in the image is a function of the angle to the axis alone.
//!
//! The classical projections: equidistant, equisolid angle, stereographic, orthographic (Fleck,
//! "Perspective Projection: the Wrong Imaging Model", University of Iowa TR 95-01, 1995).
//! Polynomials of the angle: Kannala and Brandt, "A Generic Camera Model and Calibration Method for
//! Conventional, Wide-Angle, and Fish-Eye Lenses", PAMI 28(8), 2006, of which this is the part that
//! is the same all around (equation 6). OpenCV's fisheye is that with a first coefficient of one.

use std::f64::consts::{FRAC_PI_2, PI};

use super::newton::invert;
use super::polynomial::{sign_changes, value};
use super::{Distortion, Limit};
use crate::camera::quick::{Known, Pair, Start, negative, polynomial, sincos};
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::{DVec2, DVec3, Domain, settings};

/// A radius for each angle to the axis, in radians, that rises up to the limit.
pub(super) trait RadialModel: Copy + Send + Sync {
    /// As in [`Distortion`].
    const IS_PERSPECTIVE: bool = false;

    /// The angle up to which the radius rises.
    fn largest_angle(&self) -> f64;
    /// The radius of an angle.
    fn radius(&self, angle: f64) -> f64;
    /// The angle of a radius, which is that of an angle up to `largest`.
    fn angle(&self, radius: f64, largest: f64) -> f64;
    /// Sine and cosine of a radius' angle, for one or several at once, and where they are known.
    fn sincos<A: Arithmetic>(&self, of: A, limit: &Limit, radius: A::Number) -> Known<A, 2>;
}

/// The mask of all lanes, for values that are known everywhere.
#[inline(always)]
fn everywhere<A: Arithmetic>(of: A) -> A::Mask {
    of.lt(of.number(0.0), of.number(1.0))
}

impl<M: RadialModel> Distortion for M {
    const IS_UNIT: bool = true;
    const IS_PERSPECTIVE: bool = M::IS_PERSPECTIVE;

    fn limit(&self, farthest: f64) -> Limit {
        let undistorted = self.largest_angle();
        let distorted = self.radius(undistorted);
        let end = farthest.min(0.999 * distorted);
        let factor = |q: f64| {
            let radius = q.sqrt();
            Some(self.angle(radius, undistorted) / radius)
        };
        Limit {
            undistorted,
            distorted,
            outermost: undistorted,
            probed: undistorted,
            start: Start::through(end * end, factor),
        }
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, limit: &Limit, [x, y]: Pair<A>) -> Known<A, 3> {
        let radius = of.sqrt(of.add(of.mul(x, x), of.mul(y, y)));
        let ([sine, cosine], known) = self.sincos(of, limit, radius);
        let share = of.div(sine, radius);
        // The middle and what is beyond the limit are for `unproject`.
        let known =
            known & of.lt(of.number(0.0), radius) & of.lt(radius, of.number(limit.distorted));
        ([of.mul(share, x), of.mul(share, y), cosine], known)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        let aside = direction.truncate();
        let off = libm::hypot(aside.x, aside.y);
        let angle = libm::atan2(off, direction.z);
        // Written so that a NaN fails.
        let is_seen = angle <= limit.undistorted;
        if !is_seen {
            return None;
        }
        if off == 0.0 {
            // On the axis: ahead projects to the centre; behind, and a zero vector, to no point.
            return (direction.z > 0.0).then_some(DVec2::ZERO);
        }
        Some(self.radius(angle) / off * aside)
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let radius = libm::hypot(point.x, point.y);
        if radius == 0.0 {
            return Some(DVec3::Z);
        }
        let is_seen = radius <= limit.distorted;
        if !is_seen {
            return None;
        }
        let angle = self.angle(radius, limit.undistorted);
        let (sine, cosine) = libm::sincos(angle);
        Some((sine / radius * point).extend(cosine))
    }
}

/// Half the field of view in radians.
fn half_fov(fov: f64) -> f64 {
    PI * (fov / 360.0)
}

settings! {
    /// The radius is the angle.
    pub struct Equidistant {
        /// Degrees across the circle beyond which nothing is seen. Without an intrinsic matrix it
        /// touches the picture's longer edges, and is 180 by default.
        fov: f64, Domain::UpTo(360.0), default 360.0;
    }
}

settings! {
    /// The radius is 2 sin(angle / 2): equal solid angles have equal areas.
    pub struct Equisolid {
        /// Degrees across the circle beyond which nothing is seen. Without an intrinsic matrix it
        /// touches the picture's longer edges, and is 180 by default.
        fov: f64, Domain::UpTo(360.0), default 360.0;
    }
}

settings! {
    /// The radius is 2 tan(angle / 2): angles between curves are as they are seen.
    pub struct Stereographic {
        /// Degrees across the circle beyond which nothing is seen. Without an intrinsic matrix it
        /// touches the picture's longer edges, and is 180 by default.
        fov: f64, Domain::Between(0.0, 360.0), default 350.0;
    }
}

settings! {
    /// The radius is sin(angle).
    pub struct OrthographicFisheye {
        /// Degrees across the circle beyond which nothing is seen. Without an intrinsic matrix it
        /// touches the picture's longer edges, and is 180 by default.
        fov: f64, Domain::UpTo(180.0), default 180.0;
    }
}

impl RadialModel for Equidistant {
    fn largest_angle(&self) -> f64 {
        half_fov(self.fov)
    }

    fn radius(&self, angle: f64) -> f64 {
        angle
    }

    fn angle(&self, radius: f64, _: f64) -> f64 {
        radius
    }

    #[inline(always)]
    fn sincos<A: Arithmetic>(&self, of: A, _: &Limit, radius: A::Number) -> Known<A, 2> {
        (sincos(of, radius), everywhere(of))
    }
}

impl RadialModel for Equisolid {
    fn largest_angle(&self) -> f64 {
        half_fov(self.fov)
    }

    fn radius(&self, angle: f64) -> f64 {
        2.0 * libm::sin(0.5 * angle)
    }

    fn angle(&self, radius: f64, _: f64) -> f64 {
        2.0 * libm::asin((0.5 * radius).min(1.0))
    }

    #[inline(always)]
    fn sincos<A: Arithmetic>(&self, of: A, _: &Limit, radius: A::Number) -> Known<A, 2> {
        // By the half angle, whose sine is half the radius.
        let one = of.number(1.0);
        let half = of.mul(of.number(0.5), radius);
        let square = of.mul(half, half);
        let cosine = of.sqrt(of.sub(one, square));
        let sine = of.mul(radius, cosine);
        ([sine, of.sub(one, of.add(square, square))], everywhere(of))
    }
}

impl RadialModel for Stereographic {
    fn largest_angle(&self) -> f64 {
        half_fov(self.fov)
    }

    fn radius(&self, angle: f64) -> f64 {
        2.0 * libm::tan(0.5 * angle)
    }

    fn angle(&self, radius: f64, _: f64) -> f64 {
        2.0 * libm::atan(0.5 * radius)
    }

    #[inline(always)]
    fn sincos<A: Arithmetic>(&self, of: A, _: &Limit, radius: A::Number) -> Known<A, 2> {
        // By the half angle, whose tangent is half the radius.
        let one = of.number(1.0);
        let half = of.mul(of.number(0.5), radius);
        let square = of.mul(half, half);
        let inverse = of.div(one, of.add(one, square));
        let cosine = of.mul(of.sub(one, square), inverse);
        ([of.mul(radius, inverse), cosine], everywhere(of))
    }
}

impl RadialModel for OrthographicFisheye {
    fn largest_angle(&self) -> f64 {
        half_fov(self.fov)
    }

    fn radius(&self, angle: f64) -> f64 {
        libm::sin(angle)
    }

    fn angle(&self, radius: f64, _: f64) -> f64 {
        libm::asin(radius.min(1.0))
    }

    #[inline(always)]
    fn sincos<A: Arithmetic>(&self, of: A, _: &Limit, radius: A::Number) -> Known<A, 2> {
        let one = of.number(1.0);
        // (1 - r)(1 + r) keeps the digits that 1 - r² loses near the edge.
        let square = of.mul(of.sub(one, radius), of.add(one, radius));
        ([radius, of.sqrt(square)], everywhere(of))
    }
}

settings! {
    /// The radius is k1 a + k2 a³ + k3 a⁵ + k4 a⁷ + k5 a⁹ for an angle a.
    pub struct KannalaBrandt {
        /// The coefficient of the angle: the slope of the radius on the axis. Default: 1.
        k1: f64, Domain::Positive, default 1.0;
        /// The coefficient of the angle's third power.
        k2: f64, Domain::Number, default 0.0;
        /// The coefficient of the angle's fifth power.
        k3: f64, Domain::Number, default 0.0;
        /// The coefficient of the angle's seventh power.
        k4: f64, Domain::Number, default 0.0;
        /// The coefficient of the angle's ninth power.
        k5: f64, Domain::Number, default 0.0;
    }
}

settings! {
    /// The radius is a (1 + k1 a² + k2 a⁴ + k3 a⁶ + k4 a⁸) for an angle a, as in `cv2.fisheye`.
    pub struct OpenCvFisheye {
        /// The coefficient of the angle's third power.
        k1: f64, Domain::Number, default 0.0;
        /// The coefficient of the angle's fifth power.
        k2: f64, Domain::Number, default 0.0;
        /// The coefficient of the angle's seventh power.
        k3: f64, Domain::Number, default 0.0;
        /// The coefficient of the angle's ninth power.
        k4: f64, Domain::Number, default 0.0;
        /// Degrees across the circle beyond which nothing is seen. Default: 360.
        fov: f64, Domain::UpTo(360.0), default 360.0;
    }
}

/// The radius is a polynomial in odd powers of the angle, with these coefficients: a part of
/// another model, which names them.
#[derive(Debug, Clone, Copy)]
pub(super) struct AngleSeries(pub(super) [f64; 7]);

/// A polynomial in `N` odd powers of the angle.
trait AnglePolynomial<const N: usize>: Copy + Send + Sync {
    /// The coefficients of the odd powers.
    fn odd(&self) -> [f64; N];
    /// The angle beyond which nothing is seen in any case.
    fn edge(&self) -> f64 {
        PI
    }
}

impl AnglePolynomial<5> for KannalaBrandt {
    fn odd(&self) -> [f64; 5] {
        [self.k1, self.k2, self.k3, self.k4, self.k5]
    }
}

impl AnglePolynomial<5> for OpenCvFisheye {
    fn odd(&self) -> [f64; 5] {
        [1.0, self.k1, self.k2, self.k3, self.k4]
    }

    fn edge(&self) -> f64 {
        half_fov(self.fov)
    }
}

impl AnglePolynomial<7> for AngleSeries {
    fn odd(&self) -> [f64; 7] {
        self.0
    }
}

/// The coefficients of the slope, by even powers of the angle.
#[inline(always)]
fn slope_of<const N: usize>(odd: &[f64; N]) -> [f64; N] {
    let mut slope = *odd;
    for (k, coefficient) in slope.iter_mut().enumerate() {
        *coefficient *= (2 * k + 1) as f64;
    }
    slope
}

/// The radius of an angle, and its slope.
fn radius_and_slope<const N: usize>(odd: &[f64; N], angle: f64) -> [f64; 2] {
    let q = angle * angle;
    [angle * value(odd, q), value(&slope_of(odd), q)]
}

/// The angle up to which the radius rises; pi at most.
fn largest_angle<const N: usize>(odd: &[f64; N]) -> f64 {
    let folds = sign_changes(&slope_of(odd));
    folds.first().map_or(PI, |q| q.sqrt()).min(PI)
}

/// Newton's method from the prepared start; known where it has settled on this side of the fold.
#[inline(always)]
fn angle_by_newton<A: Arithmetic, const N: usize>(
    of: A,
    odd: &[f64; N],
    limit: &Limit,
    radius: A::Number,
) -> Known<A, 2> {
    const MOST_STEPS: usize = 8;
    /// A step of this share leaves less than rounding.
    const SETTLED: f64 = 1e-10;
    let slope_of_odd = slope_of(odd);
    let mut angle = of.mul(radius, limit.start.at(of, of.mul(radius, radius)));
    let mut settled = of.lt(angle, angle);
    for _ in 0..MOST_STEPS {
        let q = of.mul(angle, angle);
        let there = of.mul(angle, polynomial(of, odd, q));
        let slope = polynomial(of, &slope_of_odd, q);
        let step = of.div(of.sub(there, radius), slope);
        let next = of.sub(angle, step);
        let allowed = of.mul(of.number(SETTLED), next);
        let settles = of.lt(of.max(step, negative(of, step)), allowed)
            & of.lt(of.number(0.0), slope)
            & of.lt(next, of.number(limit.undistorted));
        // A settled angle stays, whatever its neighbours do.
        angle = of.select(settled, angle, next);
        settled = settled | settles;
        if of.is_everywhere(settled) {
            break;
        }
    }
    (sincos(of, angle), settled)
}

macro_rules! polynomial_models {
    ($($model:ty),*) => {$(
        impl RadialModel for $model {
            fn largest_angle(&self) -> f64 {
                largest_angle(&self.odd()).min(self.edge())
            }

            fn radius(&self, angle: f64) -> f64 {
                radius_and_slope(&self.odd(), angle)[0]
            }

            fn angle(&self, radius: f64, largest: f64) -> f64 {
                let odd = self.odd();
                let start = (radius / odd[0]).min(FRAC_PI_2);
                invert(radius, [0.0, largest], start, |angle| radius_and_slope(&odd, angle))
            }

            #[inline(always)]
            fn sincos<A: Arithmetic>(&self, of: A, limit: &Limit, r: A::Number) -> Known<A, 2> {
                angle_by_newton(of, &self.odd(), limit, r)
            }
        }
    )*};
}
polynomial_models!(KannalaBrandt, OpenCvFisheye, AngleSeries);
