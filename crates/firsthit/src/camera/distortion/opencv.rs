//! OpenCV's model: radial, as a quotient of polynomials, tangential and thin prism distortion, and a tilted sensor.
//!
//! With q = x² + y² for a direction (x, y, 1):
//!
//! 1. radial: (x, y) times (1 + k1 q + k2 q² + k3 q³) / (1 + k4 q + k5 q² + k6 q³);
//! 2. tangential: plus (2 p1 x y + p2 (q + 2 x²), p1 (q + 2 y²) + 2 p2 x y);
//! 3. thin prism: plus (s1 q + s2 q², s3 q + s4 q²);
//! 4. tilted sensor: the perspective map of a rotation about x by `tau_x` and then about y by `tau_y`.
//!
//! Brown, "Close-Range Camera Calibration", Photogrammetric Engineering 37(8), 1971; Claus and Fitzgibbon, "A Rational Function Lens
//! Distortion Model for General Cameras", CVPR 2005; Weng, Cohen and Herniou, "Camera Calibration with Distortion Models and Accuracy
//! Evaluation", PAMI 14(10), 1992; Louhichi and others, "Self-calibration of Scheimpflug cameras", Measurement Science and Technology
//! 18(8), 2007.

use super::newton::{Mapped, invert, invert_in_plane};
use super::polynomial::{product, sign_changes};
use super::{Distortion, Limit};
use crate::camera::parameters::parameters;
use crate::camera::quick::{Start, polynomial, square, twice};
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DMat3, DVec2, DVec3, require};

parameters! {
    /// See [`Projection::OpenCv`](crate::Projection::OpenCv). The defaults distort nothing.
    pub struct OpenCv {
        /// Radial, of q.
        k1 = 0.0,
        /// Radial, of q².
        k2 = 0.0,
        /// Tangential.
        p1 = 0.0,
        /// Tangential.
        p2 = 0.0,
        /// Radial, of q³.
        k3 = 0.0,
        /// Radial, of q, in the divisor.
        k4 = 0.0,
        /// Radial, of q², in the divisor.
        k5 = 0.0,
        /// Radial, of q³, in the divisor.
        k6 = 0.0,
        /// Thin prism, across, of q.
        s1 = 0.0,
        /// Thin prism, across, of q².
        s2 = 0.0,
        /// Thin prism, down, of q.
        s3 = 0.0,
        /// Thin prism, down, of q².
        s4 = 0.0,
        /// Tilt of the sensor about x, in radians.
        tau_x = 0.0,
        /// Tilt of the sensor about y, in radians.
        tau_y = 0.0,
    }
}

impl OpenCv {
    fn numerator(&self) -> [f64; 4] {
        [1.0, self.k1, self.k2, self.k3]
    }

    fn divisor(&self) -> [f64; 4] {
        [1.0, self.k4, self.k5, self.k6]
    }

    /// The factor of the radius, and its derivative by q.
    fn radial(&self, q: f64) -> [f64; 2] {
        let polynomial = |[a, b, c, d]: [f64; 4]| {
            let value = a + q * (b + q * (c + q * d));
            [value, b + q * (2.0 * c + q * 3.0 * d)]
        };
        let [above, rise] = polynomial(self.numerator());
        let [below, fall] = polynomial(self.divisor());
        let factor = above / below;
        [factor, (rise - factor * fall) / below]
    }

    /// The radius up to which nothing folds for certain: the derivative of the radial part stretches by more than that of all else
    /// can come to. The first stretches by the factor across and by the slope along the radius, at least; the second by the sum of
    /// its numbers, at most.
    fn certain(&self, undistorted: f64) -> f64 {
        const STEPS: u32 = 64;
        /// Beyond it a polynomial of the third degree has no say.
        const FARTHEST: f64 = 3.0;
        let end = undistorted.min(FARTHEST);
        let firsts = self.p1.abs() + self.p2.abs();
        let (seconds, fourths) = (self.s1.abs() + self.s3.abs(), self.s2.abs() + self.s4.abs());
        let is_certain = |r: f64| {
            let q = r * r;
            let [factor, rate] = self.radial(q);
            let other = 2.0 * r * (6.0 * firsts + 2.0 * seconds + 4.0 * q * fourths);
            // Written so that a NaN fails. Between two steps either may be a little worse.
            factor.min(factor + 2.0 * q * rate) > 1.5 * other
        };
        let radii = (0..=STEPS).map(|k| end * f64::from(k) / f64::from(STEPS));
        let fine = radii.clone().take_while(|&r| is_certain(r)).count();
        // The last radius before the first that is not, and a little less.
        radii.take(fine).last().map_or(0.0, |r| 0.9 * r)
    }

    /// Whether it is more than radial.
    fn is_lopsided(&self) -> bool {
        [self.p1, self.p2, self.s1, self.s2, self.s3, self.s4] != [0.0; 6]
    }

    fn is_tilted(&self) -> bool {
        self.tau_x != 0.0 || self.tau_y != 0.0
    }

    /// The distorted point of (x, y), before the tilt; `None` past the fold.
    fn distorted(&self, limit: &Limit, point: DVec2) -> Option<Mapped> {
        let DVec2 { x, y } = point;
        let q = x * x + y * y;
        // Written so that a NaN fails.
        let is_inside = q <= limit.outermost * limit.outermost;
        if !is_inside {
            return None;
        }
        let (value, [by_xx, by_xy, by_yx, by_yy]) = self.mapped(Scalar, [x, y]);
        let mapped = Mapped {
            value: value.into(),
            by_x: DVec2::new(by_xx, by_yx),
            by_y: DVec2::new(by_xy, by_yy),
        };
        (mapped.determinant() > 0.0).then_some(mapped)
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

/// A polynomial's value and slope.
#[inline(always)]
fn cubic<A: Arithmetic>(of: A, [a, b, c, d]: [f64; 4], q: A::Number) -> [A::Number; 2] {
    [
        polynomial(of, &[a, b, c, d], q),
        polynomial(of, &[b, 2.0 * c, 3.0 * d], q),
    ]
}

/// What a thin prism moves a point by, and the derivative of that by x, divided by x.
#[inline(always)]
fn prism<A: Arithmetic>(of: A, first: f64, second: f64, q: A::Number) -> [A::Number; 2] {
    [
        of.mul(q, of.add(of.number(first), of.mul(of.number(second), q))),
        of.add(of.number(2.0 * first), of.mul(of.number(4.0 * second), q)),
    ]
}

/// A point through a perspective map; `None` behind it.
fn through(map: &DMat3, point: DVec2) -> Option<DVec2> {
    let mapped = *map * point.extend(1.0);
    (mapped.z > 0.0).then(|| mapped.truncate() / mapped.z)
}

impl Distortion for OpenCv {
    fn limit(&self, farthest: f64) -> Result<Limit> {
        const RIGHT_ANGLE: f64 = std::f64::consts::FRAC_PI_2;
        for (name, tilt) in [("tau_x", self.tau_x), ("tau_y", self.tau_y)] {
            require(
                name,
                "between -pi/2 and pi/2",
                tilt.abs() < RIGHT_ANGLE,
                tilt,
            )?;
        }
        // The radius r times the factor n / d has the slope ((n + 2 q n') d - 2 q n d') / d².
        let slope_of = |c: [f64; 4]| [0.0, 2.0 * c[1], 4.0 * c[2], 6.0 * c[3]];
        let (n, d) = (self.numerator(), self.divisor());
        let (n_slope, d_slope) = (slope_of(n), slope_of(d));
        let sum = [0, 1, 2, 3].map(|k| n[k] + n_slope[k]);
        let rises = product(&sum, &d);
        let falls = product(&n, &d_slope);
        let slope: Vec<f64> = rises.iter().zip(&falls).map(|(a, b)| a - b).collect();
        let mut folds = sign_changes(&slope);
        let poles = sign_changes(&d);
        let pole = poles.first().copied().unwrap_or(f64::INFINITY);
        folds.retain(|&q| q < pole);
        let first = folds.first().copied().unwrap_or(pole);
        let undistorted = first.sqrt();
        // Beyond the first fold of a radial distortion everything is upside down, until the next one.
        let second = folds.get(1).copied().unwrap_or(pole);
        let is_lopsided = self.is_lopsided();
        let outermost = if !is_lopsided {
            undistorted
        } else if second.is_finite() {
            first.midpoint(second).sqrt()
        } else {
            f64::INFINITY
        };
        let certain = if is_lopsided {
            self.certain(undistorted)
        } else {
            undistorted
        };
        let distorted = if first < pole {
            undistorted * self.radial(first)[0]
        } else {
            f64::INFINITY
        };
        let limit = Limit {
            undistorted,
            distorted,
            outermost,
            certain,
            ..Limit::default()
        };
        let end = farthest.min(0.999 * distorted);
        let factor = |q: f64| {
            let radius = q.sqrt();
            Some(self.undistorted_radius(&limit, radius)? / radius)
        };
        Ok(Limit {
            start: Start::through(end * end, factor),
            ..limit
        })
    }

    /// Newton's method from the prepared start; known where it has settled on this side of the fold.
    #[inline(always)]
    fn directions<A: Arithmetic>(
        &self,
        of: A,
        limit: &Limit,
        [u, v]: [A::Number; 2],
    ) -> ([A::Number; 3], A::Mask) {
        /// From a start as near as usual, two lead to the last digit.
        const MOST_STEPS: usize = 8;
        /// A step of this share leaves its square, which is less than rounding.
        const SETTLED: f64 = 1e-8;
        if self.is_tilted() {
            return ([of.number(0.0); 3], of.lt(u, u));
        }
        let factor = limit.start.at(of, square(of, u, v));
        let (mut x, mut y) = (of.mul(factor, u), of.mul(factor, v));
        if self.is_lopsided() {
            // Once more without what is not radial, as far as it is known by now.
            let [across, down] = self.uneven(of, [x, y]);
            let (u, v) = (of.sub(u, across), of.sub(v, down));
            let factor = limit.start.at(of, square(of, u, v));
            (x, y) = (of.mul(factor, u), of.mul(factor, v));
        }
        let most = of.number(limit.certain * limit.certain);
        let mut settled = of.lt(x, x);
        for _ in 0..MOST_STEPS {
            let (there, jacobian) = self.mapped(of, [x, y]);
            let residual = [of.sub(there[0], u), of.sub(there[1], v)];
            let [xx, xy, yx, yy] = jacobian;
            let determinant = of.sub(of.mul(xx, yy), of.mul(xy, yx));
            let inverse = of.div(of.number(1.0), determinant);
            let across = of.sub(of.mul(residual[0], yy), of.mul(xy, residual[1]));
            let down = of.sub(of.mul(xx, residual[1]), of.mul(yx, residual[0]));
            let step = [of.mul(across, inverse), of.mul(down, inverse)];
            let (next_x, next_y) = (of.sub(x, step[0]), of.sub(y, step[1]));
            let allowed = of.add(
                of.number(f64::MIN_POSITIVE),
                of.mul(of.number(SETTLED * SETTLED), square(of, next_x, next_y)),
            );
            let settles = of.lt(square(of, step[0], step[1]), allowed)
                & of.lt(of.number(0.0), determinant)
                & of.lt(square(of, next_x, next_y), most);
            // What has settled stays, whatever its neighbours do.
            x = of.select(settled, x, next_x);
            y = of.select(settled, y, next_y);
            settled = settled | settles;
            if of.is_everywhere(settled) {
                break;
            }
        }
        ([x, y, of.number(1.0)], settled)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        let in_front = direction.z > 0.0;
        let point = in_front.then(|| direction.truncate() / direction.z)?;
        let mapped = self.distorted(limit, point)?;
        if !self.is_before_fold(limit, point) {
            return None;
        }
        if self.is_tilted() {
            through(&self.tilt(), mapped.value)
        } else {
            Some(mapped.value)
        }
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let point = if self.is_tilted() {
            through(&self.tilt().inverse(), point)?
        } else {
            point
        };
        let radius = point.length();
        let is_lopsided = self.is_lopsided();
        if radius == 0.0 && !is_lopsided {
            return Some(DVec3::Z);
        }
        let start = if radius < limit.distorted {
            self.undistorted_radius(limit, radius)
        } else if is_lopsided {
            Some(0.98 * limit.undistorted)
        } else {
            None
        };
        let start = if radius == 0.0 {
            DVec2::ZERO
        } else {
            start? / radius * point
        };
        if !is_lopsided {
            return Some(start.extend(1.0));
        }
        let start = self.before_fold(limit, start)?;
        let found = invert_in_plane(point, start, |at| self.distorted(limit, at))?;
        self.is_before_fold(limit, found).then(|| found.extend(1.0))
    }
}

impl OpenCv {
    /// The distorted point of (x, y), before the tilt, and its derivative: of x by x and y, of y by x and y.
    #[inline(always)]
    fn mapped<A: Arithmetic>(
        &self,
        of: A,
        [x, y]: [A::Number; 2],
    ) -> ([A::Number; 2], [A::Number; 4]) {
        let (xx, yy, xy) = (of.mul(x, x), of.mul(y, y), of.mul(x, y));
        let q = of.add(xx, yy);
        let [mut factor, mut rate] = cubic(of, self.numerator(), q);
        if [self.k4, self.k5, self.k6] != [0.0; 3] {
            let [below, fall] = cubic(of, self.divisor(), q);
            let inverse = of.div(of.number(1.0), below);
            factor = of.mul(factor, inverse);
            rate = of.mul(of.sub(rate, of.mul(factor, fall)), inverse);
        }
        let double_rate = of.add(rate, rate);
        let (mut there_x, mut there_y) = (of.mul(x, factor), of.mul(y, factor));
        let mut by_xx = of.add(factor, of.mul(xx, double_rate));
        let mut by_yy = of.add(factor, of.mul(yy, double_rate));
        let mut by_xy = of.mul(xy, double_rate);
        let mut by_yx = by_xy;
        if (self.p1, self.p2) != (0.0, 0.0) {
            let (p1, p2) = (of.number(self.p1), of.number(self.p2));
            let (p1x, p1y) = (of.mul(p1, x), of.mul(p1, y));
            let (p2x, p2y) = (of.mul(p2, x), of.mul(p2, y));
            there_x = of.add(
                there_x,
                of.add(
                    of.mul(twice(of, p1), xy),
                    of.mul(p2, of.add(q, twice(of, xx))),
                ),
            );
            there_y = of.add(
                there_y,
                of.add(
                    of.mul(twice(of, p2), xy),
                    of.mul(p1, of.add(q, twice(of, yy))),
                ),
            );
            by_xx = of.add(by_xx, of.add(twice(of, p1y), of.mul(of.number(6.0), p2x)));
            by_yy = of.add(by_yy, of.add(twice(of, p2x), of.mul(of.number(6.0), p1y)));
            let both = twice(of, of.add(p1x, p2y));
            by_xy = of.add(by_xy, both);
            by_yx = of.add(by_yx, both);
        }
        let Self { s1, s2, s3, s4, .. } = *self;
        if [s1, s2, s3, s4] != [0.0; 4] {
            let ([across, across_rate], [down, down_rate]) =
                (prism(of, s1, s2, q), prism(of, s3, s4, q));
            there_x = of.add(there_x, across);
            there_y = of.add(there_y, down);
            by_xx = of.add(by_xx, of.mul(across_rate, x));
            by_xy = of.add(by_xy, of.mul(across_rate, y));
            by_yx = of.add(by_yx, of.mul(down_rate, x));
            by_yy = of.add(by_yy, of.mul(down_rate, y));
        }
        ([there_x, there_y], [by_xx, by_xy, by_yx, by_yy])
    }

    /// What tangential and thin prism distortion move a point by.
    #[inline(always)]
    fn uneven<A: Arithmetic>(&self, of: A, [x, y]: [A::Number; 2]) -> [A::Number; 2] {
        let (xx, yy, xy) = (of.mul(x, x), of.mul(y, y), of.mul(x, y));
        let q = of.add(xx, yy);
        let (p1, p2) = (of.number(self.p1), of.number(self.p2));
        let of_x = of.mul(p2, of.add(q, twice(of, xx)));
        let of_y = of.mul(p1, of.add(q, twice(of, yy)));
        let across = of.add(of.mul(twice(of, p1), xy), of_x);
        let down = of.add(of.mul(twice(of, p2), xy), of_y);
        let [prism_across, _] = prism(of, self.s1, self.s2, q);
        let [prism_down, _] = prism(of, self.s3, self.s4, q);
        [of.add(across, prism_across), of.add(down, prism_down)]
    }

    /// The radius before radial distortion of one after it, which is within the limit.
    fn undistorted_radius(&self, limit: &Limit, radius: f64) -> Option<f64> {
        let radial = |r: f64| {
            let q = r * r;
            let [factor, rate] = self.radial(q);
            [r * factor, factor + 2.0 * q * rate]
        };
        let mut high = limit.undistorted;
        if high == f64::INFINITY {
            high = radius.max(1.0);
            // A divisor may keep the radius below some value for ever.
            while radial(high)[0] < radius {
                high *= 2.0;
                if high > 1e100 {
                    return None;
                }
            }
        }
        Some(invert(radius, [0.0, high], radius, radial))
    }

    /// Whether there is no fold on the way from the middle to a point: past it there may be other places that are not turned over.
    fn is_before_fold(&self, limit: &Limit, point: DVec2) -> bool {
        const LOOKS: u32 = 16;
        // Written so that a NaN is looked at.
        let is_certain = point.length() <= limit.certain;
        is_certain
            || (1..=LOOKS).all(|k| {
                let on_the_way = f64::from(k) / f64::from(LOOKS) * point;
                self.distorted(limit, on_the_way).is_some()
            })
    }

    /// The point, or the first on the way to the middle that is on this side of the fold.
    fn before_fold(&self, limit: &Limit, start: DVec2) -> Option<DVec2> {
        let shares = (0..20).map(|k| 1.0 - 0.05 * f64::from(k));
        let mut points = shares.map(|share| share * start).chain([DVec2::ZERO]);
        points.find(|&point| self.distorted(limit, point).is_some())
    }
}
