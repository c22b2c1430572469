//! Computes the crossing of a ray with the plane of a triangle that it is known to meet: `t`, and
//! the weights of the corners 1 and 2.
//!
//! Let `R` go from the ray's origin to corner 0, `E` and `F` from corner 0 to the two others, and
//! `n = E x F`. The ray crosses the plane at `t = n.R / n.d`.
//!
//! 1. [`Plain`] computes that in float64, and corrects it once.
//! 2. Where a bound says that this is not enough, [`Plane`] computes it in twice the digits.
//! 3. Where that is not enough either, [`Meeting::exact`] computes `n.R` and `n.d` without
//!    rounding.
//!
//! In each step the weights come from the point at `t`, relative to corner 0 (`weights.rs`). `t` is
//! the float64 nearest to the exact crossing, or one next to that.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

mod double;
mod plain;
mod weights;

#[doc(hidden)]
pub use double::{Plane, Start};
#[doc(hidden)]
pub use plain::{Plain, PlainStart};

use std::cmp::Ordering;

use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::double::{Double, DoubleVector, between, cross, quotient};
use crate::geometry::exact::{Expansion, Scaled, determinant, power};
use crate::geometry::{DVec3, arrays};
use double::left_over;
use weights::Edges;

type Vector<N> = [N; 3];

/// A ray and the corners of a triangle, in one space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting<N> {
    pub(crate) origin: Vector<N>,
    pub(crate) direction: Vector<N>,
    pub(crate) corners: [Vector<N>; 3],
}

/// `t`, and the weights of the corners 1 and 2.
#[doc(hidden)]
pub type Place<N> = [N; 3];

/// The dot product in plain float64.
#[inline(always)]
fn plain_dot<A: Arithmetic>(a: A, p: &Vector<A::Number>, q: &Vector<A::Number>) -> A::Number {
    let first = a.mul(p[0], q[0]);
    a.fused_mul_add(p[2], q[2], a.fused_mul_add(p[1], q[1], first))
}

/// The cross product in plain float64.
#[inline(always)]
fn plain_cross<A: Arithmetic>(
    a: A,
    p: &Vector<A::Number>,
    q: &Vector<A::Number>,
) -> Vector<A::Number> {
    [
        a.fused_mul_sub(p[1], q[2], a.mul(p[2], q[1])),
        a.fused_mul_sub(p[2], q[0], a.mul(p[0], q[2])),
        a.fused_mul_sub(p[0], q[1], a.mul(p[1], q[0])),
    ]
}

#[inline(always)]
fn minus<A: Arithmetic>(a: A, p: &Vector<A::Number>, q: &Vector<A::Number>) -> Vector<A::Number> {
    [a.sub(p[0], q[0]), a.sub(p[1], q[1]), a.sub(p[2], q[2])]
}

/// Numbers of twice the digits, rounded to float64.
#[inline(always)]
fn high<N: Copy>(v: &DoubleVector<N>) -> Vector<N> {
    [v[0].high, v[1].high, v[2].high]
}

/// The vector in all lanes.
#[inline(always)]
fn splat<A: Arithmetic>(a: A, v: &Vector<f64>) -> Vector<A::Number> {
    [a.number(v[0]), a.number(v[1]), a.number(v[2])]
}

#[inline(always)]
fn splat_double<A: Arithmetic>(a: A, v: &DoubleVector<f64>) -> DoubleVector<A::Number> {
    macro_rules! part {
        ($k:literal) => {
            Double { high: a.number(v[$k].high), low: a.number(v[$k].low) }
        };
    }
    [part!(0), part!(1), part!(2)]
}

/// Rounds a quotient: `high` becomes the float64 nearest to the `exact` numerator over its
/// denominator, and the even one where it lies halfway between two. Only next to halfway are twice
/// the digits not enough to tell.
#[inline(always)]
fn rounded_to_nearest(t: Double<f64>, exact: impl FnOnce() -> [Expansion; 2]) -> Double<f64> {
    let other = if t.low < 0.0 { t.high.next_down() } else { t.high.next_up() };
    let half = 0.5 * (other - t.high);
    let is_halfway = (t.low - half).abs() <= power(-30) * half.abs();
    if !is_halfway || t.high == 0.0 {
        return t;
    }
    let [numerator, denominator] = exact();
    let [middle, one] = [vec![t.high, half], vec![1.0]].map(Expansion::of);
    let order = Expansion::compare_quotients([&numerator, &denominator], [&middle, &one]);
    let is_low = match order {
        Ordering::Less => true,
        Ordering::Greater => false,
        Ordering::Equal => t.high.min(other).to_bits() % 2 == 0,
    };
    let high = if is_low { t.high.min(other) } else { t.high.max(other) };
    Double { high, low: (t.high - high) + t.low }
}

impl Meeting<f64> {
    #[inline(always)]
    pub(crate) fn new(origin: DVec3, direction: DVec3, corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        Self {
            origin: origin.to_array(),
            direction: direction.to_array(),
            corners: [a.to_array(), b.to_array(), c.to_array()],
        }
    }

    /// The place, if plain float64 is enough.
    #[inline(always)]
    pub(crate) fn plain(&self) -> Option<Place<f64>> {
        let triangle = Plain::new(Scalar, &self.corners);
        let (is_enough, start) = triangle.seen_from(Scalar, &self.origin);
        is_enough.then(|| triangle.place(Scalar, &start, &self.direction))
    }

    /// Whether the plane is met at no `t_min < t <= t_max`, for sure; where a corner is the origin,
    /// it is met at zero.
    ///
    /// With e, f and R the edges from the first corner and the vector from the origin to that, `t`
    /// is `n.R / n.d`. Of `n.R` every product of three numbers is rounded at most eight times, and
    /// there are six, at most `|e| |f| |R|` each, with the largest components. So it is off by 24
    /// epsilons of that at most, `n.d` likewise; 64 are taken, and more where products are
    /// subnormal. A `t` that is returned is next to the exact one: `clear_of` leaves room for that.
    #[inline(always)]
    pub(crate) fn is_outside(&self, t_min: f64, t_max: f64) -> bool {
        if t_min >= 0.0 && self.corners.contains(&self.origin) {
            return true;
        }
        let (origin, d) = (DVec3::from(self.origin), DVec3::from(self.direction));
        let [a, b, c] = arrays::map(self.corners, DVec3::from);
        let (e, f, r) = (b - a, c - a, a - origin);
        let n = e.cross(f);
        let largest = |v: DVec3| v.abs().max_element();
        let unsure = 64.0 * f64::EPSILON * largest(e) * largest(f);
        let off = |v: DVec3| unsure * largest(v) + 1e-300;
        let slope = n.dot(d);
        let height = n.dot(r) * slope.signum();
        let (least, most) = (slope.abs() - off(d), slope.abs() + off(d));
        let [last, first] = [super::clear_of(t_max), -super::clear_of(-t_min)];
        let is_after = height - off(r) > (last * least).max(last * most);
        let is_before = height + off(r) < (first * least).min(first * most);
        // Written so that a NaN settles nothing.
        least > 0.0 && unsure > 1e-150 && (is_after || is_before)
    }

    /// The place in twice the digits, if that is enough.
    #[inline(always)]
    pub(crate) fn double(&self) -> Option<Place<f64>> {
        let plane = Plane::new(Scalar, &self.corners);
        let (of_start, start) = plane.seen_from(Scalar, &self.origin);
        let (of_place, place) = plane.place(Scalar, &start, &self.direction);
        (of_start & of_place).then_some(place)
    }

    /// The float64 nearest to the exact `t`; NaN where the ray is along the plane.
    #[inline(always)]
    pub(crate) fn nearest_t(&self) -> f64 {
        let sight = Plane::new(Scalar, &self.corners).sight(&self.origin, &self.direction);
        if let Some(t) = sight.and_then(|sight| sight.nearest()) {
            return t;
        }
        self.exact().map_or(f64::NAN, |[t, _, _]| t)
    }

    /// The vectors from the origin to the corners, without rounding.
    #[inline(always)]
    pub(crate) fn relative(&self) -> [DoubleVector<f64>; 3] {
        let [a, b, c] = &self.corners;
        [
            between(Scalar, a, &self.origin),
            between(Scalar, b, &self.origin),
            between(Scalar, c, &self.origin),
        ]
    }

    /// The place as if without rounding, with the `t` that is nearest to the exact one; `None`
    /// where the ray is along the plane.
    #[inline(always)]
    pub(crate) fn exact(&self) -> Option<Place<f64>> {
        let [first, second, third] = &self.corners;
        let d = arrays::map(self.direction, |high| Double { high, low: 0.0 });
        let d = Scaled::new(&d);
        let start = Scaled::new(&between(Scalar, first, &self.origin));
        let e = Scaled::new(&between(Scalar, second, first));
        let f = Scaled::new(&between(Scalar, third, first));
        let slope = determinant(&e, &f, &d);
        if slope.high == 0.0 {
            return None;
        }
        let t = quotient(Scalar, determinant(&e, &f, &start), slope);
        let t = rounded_to_nearest(t, || [&start, &d].map(|v| Expansion::determinant(&e, &f, v)));
        let r = left_over(Scalar, t, &high(&d.vector), &start.vector);
        let n = high(&cross(Scalar, &e.vector, &f.vector));
        let (edges, _) = Edges::new(Scalar, [high(&e.vector), high(&f.vector)], n);
        // Each vector in a unit of its own, so that no square is too small for float64.
        let [v, w] = edges.inside(Scalar, &r);
        let (v, w) = (v * start.unit / e.unit, w * start.unit / f.unit);
        let [v, w] = if v < 0.0 || v + w > 1.0 {
            let unit = e.unit.max(f.unit);
            let [e, f] = [(0, e.unit), (1, f.unit)]
                .map(|(k, of_edge)| edges.vectors[k].map(|x| x * (of_edge / unit)));
            let (edges, _) = Edges::new(Scalar, [e, f], n);
            edges.on_an_edge(Scalar, &r.map(|x| x * (start.unit / unit)), v < 0.0)
        } else {
            [v.max(0.0), w]
        };
        Some([t.high * start.unit / d.unit, v, w])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between -1 and 1.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    #[test]
    fn twice_the_digits_tell_the_nearest_t_of_nearly_all_rays_and_never_another() {
        let mut next = numbers();
        let mut known = 0;
        for k in 0..4000 {
            let mut point = || DVec3::new(next(), next(), next());
            let [a, b, c] = [point(), point(), point()];
            let far = [0.0, 5e5][k % 2];
            // Some start next to the plane, and some go nearly along it.
            let (height, slope) = ([1.0, 1e-6][k / 2 % 2], [1.0, 1e-6][k / 4 % 2]);
            let origin = a + 0.3 * (b - a) + height * point();
            let direction = b - c + slope * point();
            let meeting = Meeting::new(origin + far, direction, [a + far, b + far, c + far]);
            let plane = Plane::new(Scalar, &meeting.corners);
            let sight = plane.sight(&meeting.origin, &meeting.direction);
            if let Some(t) = sight.and_then(|sight| sight.nearest()) {
                assert_eq!(Some(t), meeting.exact().map(|[t, _, _]| t), "{meeting:?}");
                known += 1;
            }
        }
        assert!(known > 3990, "{known}");
    }
}
