//! The field-of-view model: the radius in the image is about proportional to the angle, as of a
//! wide-angle lens of few parameters.
//!
//! A direction at the angle a to the axis is seen at the radius atan(2 tan(omega / 2) tan(a)) /
//! omega.
//!
//! Devernay and Faugeras, "Straight Lines Have to Be Straight", Machine Vision and Applications
//! 13(1), 2001 (equation 13).

use std::f64::consts::{FRAC_PI_2, PI};

use super::Limit;
use super::radial::RadialModel;
use crate::camera::quick::{Known, Pair, sincos, square};
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{Domain, settings};

settings! {
    /// The field-of-view model, which sees what is in front.
    pub struct Fov {
        /// The field of view of an ideal fisheye, in radians; the sign does not matter. Default: 0,
        /// a pinhole.
        omega: f64, Domain::Between(-PI, PI), default 0.0;
    }
}

impl Fov {
    /// `2 tan(omega / 2)`.
    fn stretch(self) -> f64 {
        2.0 * libm::tan(0.5 * self.omega)
    }

    /// Whether it is a pinhole to the last digit, for which the formulas would come to 0 / 0.
    fn is_pinhole(self) -> bool {
        self.omega.abs() < 1e-100
    }

    /// Numbers in the ratio of sine and cosine of a radius' angle, of which neither is large.
    #[inline(always)]
    fn ratio<A: Arithmetic>(self, of: A, radius: A::Number) -> Pair<A> {
        if self.is_pinhole() {
            return [radius, of.number(1.0)];
        }
        let [sine, cosine] = sincos(of, of.mul(of.number(self.omega), radius));
        let cosine = of.mul(of.number(self.stretch() / self.omega), cosine);
        [of.mul(of.number(self.omega.recip()), sine), cosine]
    }
}

impl RadialModel for Fov {
    const IS_PERSPECTIVE: bool = true;

    fn largest_angle(&self) -> f64 {
        FRAC_PI_2
    }

    fn radius(&self, angle: f64) -> f64 {
        let (sine, cosine) = libm::sincos(angle);
        if self.is_pinhole() {
            return sine / cosine;
        }
        libm::atan2(self.stretch().abs() * sine, cosine) / self.omega.abs()
    }

    fn angle(&self, radius: f64, largest: f64) -> f64 {
        let [sine, cosine] = self.ratio(Scalar, radius);
        libm::atan2(sine, cosine).min(largest)
    }

    #[inline(always)]
    fn sincos<A: Arithmetic>(&self, of: A, _: &Limit, radius: A::Number) -> Known<A, 2> {
        let [sine, cosine] = self.ratio(of, radius);
        let length = of.sqrt(square(of, sine, cosine));
        let inverse = of.div(of.number(1.0), length);
        let known = of.lt(inverse, of.number(f64::INFINITY)) & of.lt(of.number(0.0), inverse);
        ([of.mul(sine, inverse), of.mul(cosine, inverse)], known)
    }
}
