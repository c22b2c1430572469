//! The plane of a section: the side of a point, where an edge crosses it, and its own coordinates.

use std::cmp::Ordering;

use crate::error::Result;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{
    Double, between, difference, dot_plain, product, quotient, sum, sum_of_smaller,
};
use crate::geometry::exact_sum::ExactSum;
use crate::geometry::{
    DVec2, DVec3, Ray, moderation, require, require_direction, require_finite, unit,
};

/// A plane with coordinates of its own.
///
/// The frame is right-handed: `u`, `v` and `normal` have length one and are at right angles. `u` is
/// the world axis that has the smallest component along the normal (of equal ones the first),
/// projected to the plane, and `v` is `normal x u`. So on a plane of constant z with the normal +z
/// they are x and y.
///
/// ```
/// use firsthit::DVec3;
/// use firsthit::section::SectionPlane;
///
/// let plane = SectionPlane::new(DVec3::new(1.0, 2.0, 3.0), DVec3::Z)?;
/// assert_eq!((plane.u(), plane.v()), (DVec3::X, DVec3::Y));
/// assert_eq!(plane.coordinates(DVec3::new(4.0, 6.0, 3.0)).to_array(), [3.0, 4.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionPlane {
    origin: DVec3,
    /// The normal as it was given, which decides.
    given: DVec3,
    /// The normal at a moderate length.
    direction: DVec3,
    normal: DVec3,
    u: DVec3,
    v: DVec3,
}

impl SectionPlane {
    /// The plane through `origin` at right angles to `normal`, in world space. The normal may have
    /// any length but zero.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for numbers that are not finite, a normal
    /// that is zero, and an origin beyond 10^150.
    pub fn new(origin: DVec3, normal: DVec3) -> Result<Self> {
        let origin = require_finite("origin", origin)?;
        let is_near = origin.abs().max_element() <= Ray::FARTHEST;
        require("origin", "at coordinates up to 1e150", is_near, origin)?;
        let given = require_direction("normal", normal)?;
        let normal = unit(given);
        let size = normal.abs();
        let axes = [(size.x, DVec3::X), (size.y, DVec3::Y), (size.z, DVec3::Z)];
        let less = |a: (f64, DVec3), b: (f64, DVec3)| if b.0 < a.0 { b } else { a };
        let (_, axis) = axes.into_iter().reduce(less).unwrap_or(axes[0]);
        let u = unit(axis - normal * normal.dot(axis));
        Ok(Self {
            origin,
            given,
            direction: moderation(given) * given,
            normal,
            u,
            v: unit(normal.cross(u)),
        })
    }

    /// The point that it goes through, where its own coordinates are zero.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The normal, of length one.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The direction of its first coordinate, of length one.
    pub fn u(&self) -> DVec3 {
        self.u
    }

    /// The direction of its second coordinate, of length one.
    pub fn v(&self) -> DVec3 {
        self.v
    }

    /// A point of the plane in its own coordinates, in scene units.
    pub fn coordinates(&self, point: DVec3) -> DVec2 {
        let offset = point - self.origin;
        DVec2::new(self.u.dot(offset), self.v.dot(offset))
    }

    /// The side of the plane on which a finite point is, without rounding: greater is where the
    /// normal points.
    ///
    /// Float64 tells, or where rounding could matter a sum without any.
    pub(super) fn side(&self, point: DVec3) -> Ordering {
        let (n, offset) = (self.given, point - self.origin);
        let on_plane = |axis: usize| n[axis] == 0.0 || offset[axis] == 0.0;
        if (0..3).all(on_plane) {
            return Ordering::Equal;
        }
        let distance = n.dot(offset);
        // Five roundings of 2^-53 at most, and products that are too small for float64.
        let error = n.abs().dot(offset.abs()) * (8.0 * f64::EPSILON) + f64::MIN_POSITIVE;
        if distance > error {
            return Ordering::Greater;
        }
        if distance < -error {
            return Ordering::Less;
        }
        let mut exact = ExactSum::ZERO;
        for axis in 0..3 {
            exact.add_two(n[axis], point[axis]);
            exact.add_two(-n[axis], self.origin[axis]);
        }
        exact.sign()
    }

    /// The crossing of the plane with the edge between two points on different sides, in nearly
    /// twice the digits before it is rounded. The bits are equal for either order of the points
    /// only if the caller has put them in order.
    pub(super) fn crossing(&self, [a, b]: [DVec3; 2]) -> DVec3 {
        match (self.side(a), self.side(b)) {
            (Ordering::Equal, _) => return a,
            (_, Ordering::Equal) => return b,
            _ => {}
        }
        let [from_a, from_b] = [a, b].map(|point| self.distance(point));
        // From the nearer end on: then the other is not reached.
        let (near, far, distance) =
            if from_a.high <= from_b.high { (a, b, from_a) } else { (b, a, from_b) };
        let whole = added(from_a, from_b);
        if whole.high <= 0.0 {
            return near;
        }
        let share = quotient(Scalar, distance, whole);
        let along = |axis: usize| {
            let way = times(share, difference(Scalar, far[axis], near[axis]));
            let place = sum(Scalar, near[axis], way.high);
            place.high + (place.low + way.low)
        };
        DVec3::new(along(0), along(1), along(2))
    }

    /// The distance from the plane, without a sign, in units of the normal.
    fn distance(&self, point: DVec3) -> Double<f64> {
        let offset = between(Scalar, &point.to_array(), &self.origin.to_array());
        let Double { high, low } = dot_plain(Scalar, &offset, &self.direction.to_array());
        if high < 0.0 { Double { high: -high, low: -low } } else { Double { high, low } }
    }
}

/// The sum of two numbers of the same sign, off by a few 2^-106 of itself.
fn added(x: Double<f64>, y: Double<f64>) -> Double<f64> {
    let Double { high, low } = sum(Scalar, x.high, y.high);
    sum_of_smaller(Scalar, high, low + (x.low + y.low))
}

/// The product, off by a few 2^-106 of itself.
fn times(x: Double<f64>, y: Double<f64>) -> Double<f64> {
    let Double { high, low } = product(Scalar, x.high, y.high);
    sum_of_smaller(Scalar, high, low + (x.high * y.low + x.low * y.high))
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::Signed;

    use super::*;

    type Exact = [BigRational; 3];

    fn exact(v: DVec3) -> Exact {
        v.to_array().map(|x| BigRational::from_float(x).unwrap())
    }

    fn distance(plane: &SectionPlane, point: DVec3) -> BigRational {
        let [p, o, n] = [point, plane.origin, plane.given].map(exact);
        (0..3).fold(p[0].clone() * BigRational::from_integer(0.into()), |sum, k| {
            sum + &n[k] * (&p[k] - &o[k])
        })
    }

    /// Numbers that are round, tiny, huge, or a little beside round ones.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let x = f64::from(i32::try_from(state >> 60).unwrap() - 8);
            match state >> 55 & 31 {
                0 => x * 1e-160,
                1 => x * 1e140,
                2 => x * 1e-310,
                3..10 => x.next_up(),
                10..14 => x / 3.0,
                _ => x,
            }
        }
    }

    #[test]
    fn sides_are_those_of_rational_arithmetic() {
        let mut number = numbers(3);
        let mut vector = || DVec3::new(number(), number(), number());
        let mut counts = [0; 3];
        for k in 0..20_000 {
            let (origin, normal, mut point) = (vector(), vector(), vector());
            // Half of them nearly in the plane.
            if k % 2 == 0 {
                point = origin + normal.cross(point);
            }
            let Ok(plane) = SectionPlane::new(origin, normal) else {
                assert_eq!(normal, DVec3::ZERO);
                continue;
            };
            let judge = distance(&plane, point).cmp(&BigRational::from_integer(0.into()));
            assert_eq!(plane.side(point), judge, "{plane:?} {point:?}");
            counts[usize::try_from(judge as i8 + 1).unwrap()] += 1;
        }
        assert!(counts.iter().all(|&count| count > 500), "{counts:?}");
    }

    /// Along each axis at most one step of float64 from the exact crossing.
    #[test]
    fn crossings_are_next_to_the_nearest_float64() {
        let mut numbers = numbers(5);
        let mut number =
            move || 0.01 * numbers().clamp(-99.0, 99.0) + 0.7 * numbers().clamp(-9.0, 9.0);
        let mut vector = || DVec3::new(number(), number(), number());
        let mut crossed = 0;
        for _ in 0..5000 {
            let (origin, normal, a, b) = (vector(), vector(), vector(), vector());
            let Ok(plane) = SectionPlane::new(origin, normal) else {
                continue;
            };
            let [from_a, from_b] = [a, b].map(|point| distance(&plane, point));
            if plane.side(a) == plane.side(b) || (from_a.is_positive() == from_b.is_positive()) {
                continue;
            }
            crossed += 1;
            let share = &from_a / (&from_a - &from_b);
            let crossing = plane.crossing([a, b]);
            for (k, (p, q)) in exact(a).iter().zip(&exact(b)).enumerate() {
                let place = p + &share * (q - p);
                let [low, high] = [crossing[k].next_down(), crossing[k].next_up()]
                    .map(|x| BigRational::from_float(x).unwrap());
                assert!(low <= place && place <= high, "{plane:?} {a:?} {b:?}");
            }
        }
        assert!(crossed > 1000);
    }

    #[test]
    fn frames_are_right_handed_and_follow_the_axes() {
        let mut number = numbers(9);
        for k in 0..300 {
            let normal = match k {
                0 => DVec3::X,
                1 => DVec3::NEG_Y,
                2 => DVec3::splat(1e-300),
                3 => DVec3::new(1e300, 1e300, -1e300),
                _ => DVec3::new(number(), number(), number()),
            };
            let Ok(plane) = SectionPlane::new(DVec3::ZERO, normal) else {
                continue;
            };
            let (u, v, n) = (plane.u, plane.v, plane.normal);
            assert!((u.cross(v) - n).length() < 1e-14, "{plane:?}");
            for (a, b) in [(u, v), (v, n), (n, u)] {
                assert!(a.dot(b).abs() < 1e-15 && (a.length() - 1.0).abs() < 1e-15);
            }
            assert!(n.dot(unit(normal)) > 1.0 - 1e-14);
        }
        let of = |normal| SectionPlane::new(DVec3::ZERO, normal).unwrap();
        assert_eq!((of(DVec3::X).u, of(DVec3::X).v), (DVec3::Y, DVec3::Z));
        assert_eq!((of(DVec3::Y).u, of(DVec3::Y).v), (DVec3::X, DVec3::NEG_Z));
    }

    #[test]
    fn what_is_no_plane_is_refused() {
        let refused = |origin, normal| SectionPlane::new(origin, normal).unwrap_err().to_string();
        assert!(refused(DVec3::ZERO, DVec3::ZERO).starts_with("normal must be"));
        assert!(refused(DVec3::ZERO, DVec3::NAN).starts_with("normal must be"));
        assert!(refused(DVec3::INFINITY, DVec3::X).starts_with("origin must be finite"));
        assert!(refused(DVec3::X * 1e200, DVec3::X).contains("up to 1e150"));
    }
}
