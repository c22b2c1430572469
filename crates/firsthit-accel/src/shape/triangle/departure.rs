//! Rays that leave a triangle: what is ahead of the point they start at?
//!
//! The point is `P = a + v (b - a) + w (c - a)`, in exact arithmetic on the corners and weights.
//! The ray's origin is P rounded to float64, which may be on the other side of the triangle, or of
//! a neighbour. So a triangle is met where the ray from P itself meets it, at an exact `t > 0`:
//! never the one that is left, for that is met at zero; nor a neighbour that touches it in P.
//!
//! A triangle that has all corners of the one that is left whose weights are not zero holds P: the
//! line meets it there and nowhere ahead, or runs in its plane. At a vertex these are all triangles
//! around it. Elsewhere:
//!
//! 1. Compute the sides as for a ray from the origin, and `t`, in twice the digits if need be.
//!    Where rounding and the distance from the origin to P cannot matter, they decide.
//! 2. Elsewhere compute the sides' and `t`'s signs without rounding, from P.
//! 3. `t` is measured from the rounded origin. Where that is not positive, it is the exact one from
//!    P, rounded.
//!
//! # Error bounds
//!
//! Let no coordinate of P be more than h off the origin's, M be the largest coordinate before the
//! shear and X that across the ray.
//!
//! - h is 13 * 2^-53 of the largest corner's coordinate (see `SurfaceInteraction::position`); `OFF`
//!   allows 16.
//! - A coordinate across the ray is off by 2 h, for slopes are at most 1. So a side is off by 8 h
//!   X + 8 h^2; the test takes twice as much.
//! - Let S be the sum of the sides, which is `n.d` in units of the direction's longest component. A
//!   step of h moves the plane along the ray by `n.h / n.d`: at most h + 32 h X M / S. The test
//!   takes twice as much.

use super::crossed::perturbed_side;
use super::place::Meeting;
use super::{Doubtful, EdgeRule, Shear, TriangleHit};
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{
    Double, DoubleVector, between, cross, difference, dot, product, sum, sum_of_smaller,
};
use crate::geometry::exact::{Expansion, Scaled, determinant, power};
use crate::geometry::{DVec2, DVec3, Ray};

/// The largest distance of the origin from the point, as a share of the largest coordinate of a
/// corner. A point nearer to an edge or a corner is on it.
const OFF: f64 = 8.0 * f64::EPSILON;

/// The point of a triangle that a ray leaves; see [the module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub struct DeparturePoint {
    pub(super) corners: [DVec3; 3],
    /// The weights of the corners 1 and 2: neither is negative, and together they are at most 1.
    /// The first may need two numbers.
    pub(super) weights: [[f64; 2]; 2],
    /// The weights, of the three, that are not zero.
    pub(super) has_weight: [bool; 3],
    /// The point, rounded: where the ray starts.
    pub rounded: DVec3,
    /// The largest error of a coordinate of the rounded point.
    pub off: f64,
}

impl DeparturePoint {
    /// The point with these weights of the corners 1 and 2. A weight that moves it by less than its
    /// rounding is zero: a ray that is aimed at a vertex rounds as much, and leaves that.
    #[inline]
    pub(crate) fn new(corners: [DVec3; 3], barycentric: DVec2) -> Self {
        #[expect(clippy::manual_clamp, reason = "NaN becomes zero; clamp would keep it")]
        let within = |weight: f64| weight.max(0.0).min(1.0);
        let [v, w] = [within(barycentric.x), within(barycentric.y)];
        let both = sum(Scalar, v, w);
        let u = (1.0 - both.high) - both.low;
        let [a, b, c] = corners;
        let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
        let longest = (b - a).abs().max((c - a).abs()).max((c - b).abs());
        let off = OFF * largest + f64::MIN_POSITIVE;
        let mut has_weight = [u, v, w].map(|weight| weight * longest.max_element() > off);
        if has_weight == [false; 3] {
            // The triangle is no larger than that.
            let heaviest = if u >= v.max(w) { 0 } else { 1 + usize::from(w > v) };
            has_weight[heaviest] = true;
        }
        let (weights, rounded) = match has_weight {
            [_, false, false] => ([[0.0; 2]; 2], a),
            [false, true, false] => ([[1.0, 0.0], [0.0; 2]], b),
            [false, false, true] => ([[0.0; 2], [1.0, 0.0]], c),
            [is_in, has_v, has_w] => {
                let w = if has_w { w } else { 0.0 };
                let v = match (is_in, has_v) {
                    (_, false) => [0.0; 2],
                    (true, true) => [v, 0.0],
                    (false, true) => {
                        let Double { high, low } = difference(Scalar, 1.0, w);
                        [high, low]
                    }
                };
                let rounded = a + (v[0] * (b - a) + w * (c - a));
                ([v, [w, 0.0]], rounded)
            }
        };
        Self { corners, weights, has_weight, rounded, off }
    }

    /// A corner of the triangle that the point is made from.
    pub fn first_corner(&self) -> u32 {
        match self.has_weight {
            [true, ..] => 0,
            [_, true, _] => 1,
            _ => 2,
        }
    }

    /// Whether the point is a corner or on an edge.
    #[inline(always)]
    pub fn is_at_edge(&self) -> bool {
        self.has_weight != [true; 3]
    }

    /// Whether a triangle has all corners that the point is made from, so that it holds the point.
    #[inline(always)]
    pub fn is_held_by(&self, corners: &[DVec3; 3]) -> bool {
        let [p, q, r] = corners;
        let [a, b, c] = &self.corners;
        let [has_a, has_b, has_c] = self.has_weight;
        let has = |own: &DVec3| p == own || q == own || r == own;
        (!has_a || has(a)) && (!has_b || has(b)) && (!has_c || has(c))
    }

    /// The point's weights of the corners 1 and 2 of a triangle that [holds](Self::is_held_by) it.
    pub fn weights_in(&self, corners: [DVec3; 3]) -> DVec2 {
        let [[v, _], [w, _]] = self.weights;
        let own = [1.0 - v - w, v, w];
        let mut weights = [0.0; 3];
        for (corner, weight) in self.corners.iter().zip(own) {
            if let Some(k) = corners.iter().position(|other| other == corner) {
                weights[k] += weight;
            }
        }
        DVec2::new(weights[1], weights[2])
    }

    /// Intersects a ray from the point with a triangle ahead of it. The ray's origin is the rounded
    /// point.
    #[inline(always)]
    pub(super) fn intersect(
        &self,
        ray: &Ray,
        shear: &Shear,
        edges: EdgeRule,
        corners: [DVec3; 3],
    ) -> Option<TriangleHit> {
        if self.is_held_by(&corners) || self.is_in_level_plane(&corners) {
            return None;
        }
        let seen = shear.seen(corners);
        let doubt = seen.doubt() + 16.0 * self.off * (seen.across + self.off);
        let (least, most) = seen.least_and_most();
        if least < -doubt && most > doubt {
            return None;
        }
        let meeting = Meeting::new(ray.origin, ray.direction, corners);
        let is_met = least > doubt || most < -doubt;
        let doubtful = Doubtful { meeting, is_met: true, edges };
        if is_met {
            let longest = ray.direction.abs().max_element();
            let steep = seen.across * seen.largest / seen.sum().abs();
            let moved = 64.0 * self.off * (1.0 + steep);
            // Near the plane plain float64 does not know the last digit of `t`: twice the digits
            // do, long before exact arithmetic.
            let hit = match meeting.plain() {
                Some(place) => Some(TriangleHit::new(place)),
                None => doubtful.settle(),
            };
            // Written so that a NaN settles nothing.
            if let Some(hit) = hit {
                let depth = hit.t * longest;
                if depth > moved {
                    return Some(hit);
                }
                if depth < -moved {
                    return None;
                }
            }
        }
        self.settle(doubtful, corners)
    }

    /// Decides in exact arithmetic.
    #[cold]
    #[inline(never)]
    fn settle(&self, doubtful: Doubtful, corners: [DVec3; 3]) -> Option<TriangleHit> {
        let Doubtful { meeting, edges, .. } = doubtful;
        let direction = DVec3::from(meeting.direction);
        if self.is_plainly_ahead_of(direction, corners) || self.is_in_plane(corners) {
            return None;
        }
        let exact = Exact::new(self, direction, corners)?;
        if !exact.meets(edges, &meeting) {
            return None;
        }
        let t = exact.t().filter(|&t| t > 0.0)?;
        let hit = doubtful.settle()?;
        let t = if hit.t > 0.0 { hit.t } else { t };
        Some(TriangleHit { t, ..hit })
    }
}

impl DeparturePoint {
    /// Whether the triangle that is left and another lie in one plane across an axis, as the layers
    /// of drawings do. Such a triangle is met at zero or not at all.
    #[inline(always)]
    fn is_in_level_plane(&self, corners: &[DVec3; 3]) -> bool {
        let [a, b, c] = self.corners;
        let [p, q, r] = *corners;
        let is_level = a.cmpeq(b) & a.cmpeq(c);
        (is_level & a.cmpeq(p) & a.cmpeq(q) & a.cmpeq(r)).any()
    }

    /// Whether twice the digits say that a ray from the point goes away from a triangle's plane.
    /// This is some fifty times as fast as [`Exact`].
    ///
    /// With e and f the edges from the first corner and r the vector from the point to that, `t` is
    /// `(e x f).r / (e x f).d`. Every part of r is off by some 2^-102 of what it is computed from,
    /// and the dot product by as much of `6 |e| |f| |r|`; 2^-95 are taken.
    fn is_plainly_ahead_of(&self, direction: DVec3, corners: [DVec3; 3]) -> bool {
        let [first, second, third] = corners.map(|corner| corner.to_array());
        let [a, b, c] = self.corners.map(|corner| corner.to_array());
        let from = |p: &[f64; 3], q: &[f64; 3]| between(Scalar, p, q);
        let (mut r, along_b, along_c) = (from(&first, &a), from(&b, &a), from(&c, &a));
        let [v, w] = self.weights.map(|[high, low]| Double { high, low });
        let mut size: f64 = 0.0;
        for k in 0..3 {
            let parts = [r[k], times(along_b[k], v), times(along_c[k], w)];
            size = size.max(parts.iter().map(|part| part.high.abs()).sum());
            r[k] = less(less(parts[0], parts[1]), parts[2]);
        }
        let (e, f) = (from(&second, &first), from(&third, &first));
        let largest = |v: &DoubleVector<f64>| high(v).abs().max_element();
        let area = largest(&e) * largest(&f);
        let normal = cross(Scalar, &e, &f);
        let (slope, height) = (high(&normal).dot(direction), dot(Scalar, &normal, &r).high);
        let off_slope = 64.0 * f64::EPSILON * area * direction.abs().max_element();
        let off_height = power(-95) * area * size;
        let is_moderate = area > 1e-90 && size > 1e-90 && off_slope > 1e-200;
        // Written so that a NaN settles nothing.
        is_moderate
            && slope.abs() > off_slope
            && height.abs() > off_height
            && (slope > 0.0) != (height > 0.0)
    }

    /// Whether the triangle that is left lies in the plane of another, and the point with it. This
    /// is some fifty times as fast as [`Exact`].
    fn is_in_plane(&self, corners: [DVec3; 3]) -> bool {
        let mut others = self.corners.iter().filter(|&own| !corners.contains(own));
        let Some(first) = others.next() else {
            return true;
        };
        let [a, b, c] = corners.map(|corner| corner.to_array());
        let from_a = |corner: &[f64; 3]| Scaled::new(&between(Scalar, corner, &a));
        let edges = [from_a(&b), from_a(&c)];
        std::iter::once(first).chain(others).all(|corner| {
            let relative = from_a(&corner.to_array());
            determinant(&relative, &edges[0], &edges[1]).high == 0.0
        })
    }
}

/// `x * y`, off by a few 2^-106 of itself.
fn times(x: Double<f64>, y: Double<f64>) -> Double<f64> {
    let Double { high, low } = product(Scalar, x.high, y.high);
    sum_of_smaller(Scalar, high, low + (x.high * y.low + x.low * y.high))
}

/// `x - y`, off by a few 2^-106 of both.
fn less(x: Double<f64>, y: Double<f64>) -> Double<f64> {
    let Double { high, low } = difference(Scalar, x.high, y.high);
    sum_of_smaller(Scalar, high, low + (x.low - y.low))
}

fn high(v: &DoubleVector<f64>) -> DVec3 {
    DVec3::from(v.map(|part| part.high))
}

/// A vector without rounding.
type ExactVector = [Expansion; 3];

/// A triangle as seen from the point, without rounding. Lengths are in units of a power of two, and
/// so is the direction.
struct Exact {
    /// The vectors from the point to the corners.
    relative: [ExactVector; 3],
    direction: ExactVector,
    /// The first corner to the two others.
    edges: [ExactVector; 2],
    /// A unit of `t`, in units of the two.
    unit_of_t: f64,
}

/// The power of two below a number. Numbers are divided by it and multiplied by 2^150: a product of
/// five then neither overflows nor loses its low digits.
fn unit_of(largest: f64) -> f64 {
    f64::from_bits(largest.max(f64::MIN_POSITIVE).to_bits() & (0x7ff << 52))
}

impl Exact {
    /// `None` where a number is not finite.
    fn new(point: &DeparturePoint, direction: DVec3, corners: [DVec3; 3]) -> Option<Self> {
        let all = point.corners.iter().chain(&corners);
        let largest = all.fold(0.0, |largest: f64, corner| largest.max(corner.abs().max_element()));
        let longest = direction.abs().max_element();
        let is_finite = corners.iter().chain(&point.corners).all(|corner| corner.is_finite());
        if !(is_finite && direction.is_finite()) {
            return None;
        }
        let [unit, of_direction] = [unit_of(largest), unit_of(longest)];
        let scaled = |x: f64, unit: f64| x / unit * power(150);
        let [v, w] = point.weights.map(|weight| Expansion::of(weight.to_vec()));
        let start = [0, 1, 2].map(|axis| {
            let [a, b, c] = point.corners.map(|corner| scaled(corner[axis], unit));
            let along_b = v.product(&Expansion::of(vec![b, -a]));
            let along_c = w.product(&Expansion::of(vec![c, -a]));
            Expansion::of(vec![a]).plus(&along_b).plus(&along_c)
        });
        let relative = corners.map(|corner| {
            [0, 1, 2]
                .map(|axis| Expansion::of(vec![scaled(corner[axis], unit)]).minus(&start[axis]))
        });
        let [a, b, c] = corners;
        let edges = [b, c].map(|corner| {
            [0, 1, 2]
                .map(|axis| Expansion::of(vec![scaled(corner[axis], unit), -scaled(a[axis], unit)]))
        });
        let direction =
            [0, 1, 2].map(|axis| Expansion::of(vec![scaled(direction[axis], of_direction)]));
        Some(Self { relative, direction, edges, unit_of_t: unit / of_direction })
    }

    /// Whether the line meets the triangle.
    fn meets(&self, rule: EdgeRule, meeting: &Meeting<f64>) -> bool {
        let [a, b, c] = &self.relative;
        let side = |p, q| exact_determinant(&self.direction, p, q).sign();
        let mut sides = [side(c, b), side(a, c), side(b, a)];
        if rule == EdgeRule::Once && sides.contains(&0.0) {
            if sides == [0.0; 3] {
                return false;
            }
            let d = Scaled::new(&meeting.direction.map(|high| Double { high, low: 0.0 }));
            let [a, b, c] = &meeting.corners;
            for (side, [p, q]) in sides.iter_mut().zip([[c, b], [a, c], [b, a]]) {
                if *side == 0.0 {
                    *side = perturbed_side(&d, p, q);
                }
            }
            return sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0);
        }
        let is_front = sides.iter().all(|&side| side >= 0.0);
        let is_back = sides.iter().all(|&side| side <= 0.0);
        is_front != is_back
    }

    /// The `t` of the line's crossing with the triangle's plane, with the exact sign; `None` where
    /// the line is along the plane.
    fn t(&self) -> Option<f64> {
        let [e, f] = &self.edges;
        let slope = exact_determinant(e, f, &self.direction);
        let height = exact_determinant(e, f, &self.relative[0]);
        let sign = height.sign() * slope.sign();
        if slope.sign() == 0.0 {
            return None;
        }
        let size = (height.value() / slope.value()).abs() * self.unit_of_t;
        // Not rounded to zero.
        Some(sign * size.max(f64::MIN_POSITIVE))
    }
}

fn exact_determinant(p: &ExactVector, q: &ExactVector, r: &ExactVector) -> Expansion {
    let minor = |k: usize, l: usize| q[k].product(&r[l]).minus(&q[l].product(&r[k]));
    let parts =
        [p[0].product(&minor(1, 2)), p[1].product(&minor(2, 0)), p[2].product(&minor(0, 1))];
    parts[0].plus(&parts[1]).plus(&parts[2])
}
