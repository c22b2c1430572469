//! The side of a line or a plane on which a point is: exact, whatever the magnitudes.
//!
//! Float64 decides where an error bound allows it, after Shewchuk, "Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational
//! Geometry 18(3), 1997; else a sum without rounding ([`ExactSum`]).

use std::cmp::Ordering;

use super::DVec3;
use super::arithmetic::Scalar;
use super::double::{Double, between, difference};
use super::exact::{Scaled, determinant};
use super::exact_sum::ExactSum;

/// The error bound in space, as a share of the permanent: more than Shewchuk's 7 + 56 units of
/// 2^-53 for a determinant of differences.
const SHARE_3D: f64 = 4.0 * f64::EPSILON;
/// The error bound in a plane: more than 3 + 16 of those units.
const SHARE_2D: f64 = 2.0 * f64::EPSILON;

/// The least magnitude: from here to [`MOST`], the loss of products that are too small for float64
/// is far less than a share of the permanent.
const LEAST: f64 = 1e-200;
const MOST: f64 = 1e90;

/// The side of the plane through `a`, `b` and `c` on which the point `d` is: greater where the
/// triangle is seen counter-clockwise. Equal if all four are in one plane. All must be finite.
#[doc(hidden)]
pub fn orient_3d([a, b, c, d]: [DVec3; 4]) -> Ordering {
    let (u, v, w) = (b - a, c - a, d - a);
    // Differences that are zero are exact.
    if (0..3).any(|k| u[k] == 0.0 && v[k] == 0.0 && w[k] == 0.0) {
        return Ordering::Equal;
    }
    let products = |k: usize, l: usize| (u[k] * v[l], u[l] * v[k]);
    let [x, y, z] = [products(1, 2), products(2, 0), products(0, 1)];
    let value = (x.0 - x.1) * w.x + (y.0 - y.1) * w.y + (z.0 - z.1) * w.z;
    let permanent = (x.0.abs() + x.1.abs()) * w.x.abs()
        + (y.0.abs() + y.1.abs()) * w.y.abs()
        + (z.0.abs() + z.1.abs()) * w.z.abs();
    let is_moderate = permanent > LEAST && w.abs().max_element() < MOST;
    if is_moderate && value.abs() > SHARE_3D * permanent {
        return sign(value);
    }
    exactly_3d([a, b, c, d])
}

fn exactly_3d([a, b, c, d]: [DVec3; 4]) -> Ordering {
    let mut sum = ExactSum::ZERO;
    if let [Some(u), Some(v), Some(w)] = [b, c, d].map(|point| exact_difference(point, a)) {
        add_determinant(&mut sum, [u, v, w], 1.0);
    } else {
        add_determinant(&mut sum, [b, c, d], 1.0);
        add_determinant(&mut sum, [a, c, d], -1.0);
        add_determinant(&mut sum, [a, b, d], 1.0);
        add_determinant(&mut sum, [a, b, c], -1.0);
    }
    sum.sign()
}

/// `p - q`, if float64 holds it.
fn exact_difference(p: DVec3, q: DVec3) -> Option<DVec3> {
    let is_exact = |k: usize| difference(Scalar, p[k], q[k]).low == 0.0;
    (0..3).all(is_exact).then(|| p - q)
}

/// Adds the determinant of three vectors, times `sign`.
#[doc(hidden)]
pub fn add_determinant(sum: &mut ExactSum, [p, q, r]: [DVec3; 3], sign: f64) {
    for (k, l, m) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        sum.add([sign * p[k], q[l], r[m]]);
        sum.add([-sign * p[k], q[m], r[l]]);
    }
}

/// Whether a direction is along a triangle's normal, greater, or against it. Equal if it is in the
/// triangle's plane, or that has no area. All must be finite.
#[doc(hidden)]
pub fn along_normal([a, b, c]: [DVec3; 3], direction: DVec3) -> Ordering {
    let (e, f) = (b - a, c - a);
    let along = e.cross(f).dot(direction);
    // Each product of three numbers is rounded at most seven times, and there are six.
    let largest = |v: DVec3| v.abs().max_element();
    let area = largest(e) * largest(f);
    let doubt = 32.0 * f64::EPSILON * area * largest(direction);
    // Smaller areas have subnormal products, which lose more.
    if area > 1e-290 && along.abs() > doubt + f64::MIN_POSITIVE {
        return sign(along);
    }
    let [a, b, c] = [a, b, c].map(|corner| corner.to_array());
    let e = Scaled::new(&between(Scalar, &b, &a));
    let f = Scaled::new(&between(Scalar, &c, &a));
    let d = direction.to_array().map(|high| Double { high, low: 0.0 });
    let exactly = determinant(&e, &f, &Scaled::new(&d)).high;
    exactly.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// The side of the line from `a` to `b` on which the point `c` is, seen along an axis: greater
/// where the three go counter-clockwise, seen from the axis's positive side. Equal if they are on a
/// line. All must be finite.
#[doc(hidden)]
pub fn orient_2d([a, b, c]: [DVec3; 3], axis: usize) -> Ordering {
    let (k, l) = ((axis + 1) % 3, (axis + 2) % 3);
    let (u, v) = (b - a, c - a);
    // Differences that are zero are exact.
    if (u[k] == 0.0 || v[l] == 0.0) && (u[l] == 0.0 || v[k] == 0.0) {
        return Ordering::Equal;
    }
    let (left, right) = (u[k] * v[l], u[l] * v[k]);
    let (value, size) = (left - right, left.abs() + right.abs());
    if size > LEAST && value.abs() > SHARE_2D * size && size < f64::INFINITY {
        return sign(value);
    }
    let mut sum = ExactSum::ZERO;
    for (p, q, sign) in [(b, c, 1.0), (a, c, -1.0), (b, a, -1.0)] {
        sum.add_two(sign * p[k], q[l]);
        sum.add_two(-sign * p[l], q[k]);
    }
    sum.sign()
}

/// An axis along which a triangle is seen with an area; `None` if it has none.
#[doc(hidden)]
pub fn projection_axis(triangle: &[DVec3; 3]) -> Option<usize> {
    (0..3).find(|&axis| orient_2d(*triangle, axis) != Ordering::Equal)
}

fn sign(value: f64) -> Ordering {
    if value > 0.0 { Ordering::Greater } else { Ordering::Less }
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;

    type Exact = [BigRational; 3];

    fn zero() -> BigRational {
        BigRational::from_integer(0.into())
    }

    fn exact(v: DVec3) -> Exact {
        v.to_array().map(|x| BigRational::from_float(x).unwrap())
    }

    fn minus(p: DVec3, q: DVec3) -> Exact {
        let (p, q) = (exact(p), exact(q));
        std::array::from_fn(|k| &p[k] - &q[k])
    }

    /// Points in general and in special positions: round, tiny, huge, a bit beside a plane.
    fn points() -> impl FnMut(u32) -> DVec3 {
        let mut state = 11_u64;
        let mut number = move |kind: u32| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let x = f64::from(u32::try_from(state >> 62).unwrap()) - 1.0;
            let y = 0.1 * f64::from(u32::try_from(state >> 40 & 7).unwrap());
            match kind {
                0 => x,
                1 => x + y,
                2 => x * 1e-170,
                3 => (x + y) * 1e130,
                _ => f64::from_bits((x + y).to_bits() + (state >> 30 & 1)),
            }
        };
        move |kind| DVec3::new(number(kind), number(kind), number(kind))
    }

    #[test]
    fn sides_of_planes_are_those_of_rational_arithmetic() {
        let mut point = points();
        let mut counts = [0; 3];
        for k in 0..20_000 {
            let [a, b, c, mut d] = [(); 4].map(|()| point(k % 5));
            if k % 3 == 0 {
                // In the plane, but for rounding.
                d = a + 0.3 * (b - a) + 0.6 * (c - a);
            }
            let [u, v, w] = [b, c, d].map(|p| minus(p, a));
            let minor = |k: usize, l: usize| &u[k] * &v[l] - &u[l] * &v[k];
            let judge = minor(1, 2) * &w[0] + minor(2, 0) * &w[1] + minor(0, 1) * &w[2];
            let judge = judge.cmp(&zero());
            assert_eq!(orient_3d([a, b, c, d]), judge, "{a} {b} {c} {d}");
            assert_eq!(orient_3d([b, a, c, d]), judge.reverse());
            assert_eq!(exactly_3d([a, b, c, d]), judge);
            counts[usize::try_from(judge as i8 + 1).unwrap()] += 1;
        }
        assert!(counts.iter().all(|&count| count > 1000), "{counts:?}");
    }

    #[test]
    fn directions_along_normals_are_those_of_rational_arithmetic() {
        let mut point = points();
        let mut counts = [0; 3];
        for k in 0..20_000 {
            let [a, b, c, mut d] = [(); 4].map(|()| point(k % 2));
            if k % 3 == 0 {
                d = 0.3 * (b - a) + 0.6 * (c - a);
            }
            let [u, v, w] = [minus(b, a), minus(c, a), exact(d)];
            let minor = |k: usize, l: usize| &u[k] * &v[l] - &u[l] * &v[k];
            let judge = minor(1, 2) * &w[0] + minor(2, 0) * &w[1] + minor(0, 1) * &w[2];
            let judge = judge.cmp(&zero());
            assert_eq!(along_normal([a, b, c], d), judge, "{a} {b} {c} {d}");
            counts[usize::try_from(judge as i8 + 1).unwrap()] += 1;
        }
        assert!(counts.iter().all(|&count| count > 1000), "{counts:?}");
    }

    #[test]
    fn sides_of_lines_are_those_of_rational_arithmetic() {
        let mut point = points();
        let mut counts = [0; 3];
        for k in 0..20_000 {
            let [a, b, mut c] = [(); 3].map(|()| point(k % 5));
            if k % 3 == 0 {
                c = a + 0.3 * (b - a);
            }
            for axis in 0..3 {
                let (k, l) = ((axis + 1) % 3, (axis + 2) % 3);
                let (u, v) = (minus(b, a), minus(c, a));
                let judge = (&u[k] * &v[l] - &u[l] * &v[k]).cmp(&zero());
                assert_eq!(orient_2d([a, b, c], axis), judge, "{a} {b} {c}");
                counts[usize::try_from(judge as i8 + 1).unwrap()] += 1;
            }
        }
        assert!(counts.iter().all(|&count| count > 1000), "{counts:?}");
    }
}
