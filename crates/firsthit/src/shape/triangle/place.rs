//! Where a ray crosses the plane of a triangle that it is known to meet.
//!
//! Let `R` go from the ray's origin to corner 0, `E` and `F` from corner 0 to the two others, and `n = E x F`. The ray
//! crosses the plane at `t = n.R / n.d`. Float64 loses digits of that where the ray grazes the plane, and where the
//! corners are far away compared with the hit. So there are three steps, each of which knows when it is not enough:
//!
//! 1. [`Plain`] computes `t`, and from it `r = t d - R`, which leads from corner 0 to the point at `t`. That is no longer than the
//!    triangle is large, however far away the origin is, so it has small errors. In the plane `n.r` is zero; what it is
//!    instead corrects `t`. (A step of iterative refinement: Wilkinson, "Rounding Errors in Algebraic Processes", 1963.)
//! 2. [`Plane`] computes `t` in twice the digits.
//! 3. [`Meeting::exact`] computes `n.R` and `n.d` as if without rounding.
//!
//! So `t` is the float64 nearest to the exact crossing, or one next to that.
//!
//! The error of step 1, in first orders of u = 2^-53; h is the longer of |E| and |F|. `R` is exact, as the sum of two numbers.
//! So `r` is off by 2 u |r| for the `t` that was computed. The point is in the triangle, which makes |r| at most h. Then `n.r` is
//! off by at most
//!
//! - 2 u |n| h because `r` is, and 3 u |n| h by the rounding of the dot product;
//! - u |n| h by the last rounding of `n`, and u |E| |F| h by that of its products;
//! - u |n| h by the rounding of `E` and `F`: as `r = v E + w F`, an error `e` of `E` comes to `e.(F x r) = -v e.n`.
//!
//! That is u h (7 |n| + h^2), and it must be less than u |n.R|: `t` is then off by less than u |t| before its last rounding. The square of
//! the former is below u^2 h^2 (56 |n|^2 + 8 h^4). Then the divisor `n.d` is off by a share of u |R| / h at most, and the correction is
//! a share of 2 u |R| / h of `t`. With |R| up to 2^23 h their product is 2^-6 u.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use crate::geometry::DVec3;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::double::{Double, DoubleVector, between, cross, dot, dot_plain, quotient};
use crate::geometry::exact::{Scaled, determinant};

type Vector<N> = [N; 3];

/// A ray and the corners of a triangle, in one space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting<N> {
    pub(crate) origin: Vector<N>,
    pub(crate) direction: Vector<N>,
    pub(crate) corners: [Vector<N>; 3],
}

/// `t`, and the weights of the corners 1 and 2.
pub(crate) type Place<N> = [N; 3];

/// Two to the power of `exponent`.
#[expect(clippy::cast_sign_loss, reason = "small exponents")]
const fn power(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[inline(always)]
fn plain_dot<A: Arithmetic>(a: A, p: &Vector<A::Number>, q: &Vector<A::Number>) -> A::Number {
    let first = a.mul(p[0], q[0]);
    a.fused_mul_add(p[2], q[2], a.fused_mul_add(p[1], q[1], first))
}

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

#[inline(always)]
fn high<N: Copy>(v: &DoubleVector<N>) -> Vector<N> {
    [v[0].high, v[1].high, v[2].high]
}

/// What the weights of a point in a triangle are computed from.
#[derive(Debug, Clone, Copy)]
struct Edges<N> {
    /// `E` and `F`.
    vectors: [Vector<N>; 2],
    normal: Vector<N>,
    /// One over the normal's square.
    of_normal: N,
    /// One over the square of `E`.
    of_first: N,
}

impl<N: Copy> Edges<N> {
    /// Those of two edges and their normal; and the edges' squares.
    #[inline(always)]
    fn new<A: Arithmetic<Number = N>>(
        a: A,
        vectors: [Vector<N>; 2],
        normal: Vector<N>,
    ) -> (Self, [N; 2]) {
        let squares = [
            plain_dot(a, &vectors[0], &vectors[0]),
            plain_dot(a, &vectors[1], &vectors[1]),
        ];
        let one = a.number(1.0);
        let of_normal = a.div(one, plain_dot(a, &normal, &normal));
        let of_first = a.div(one, squares[0]);
        let edges = Self {
            vectors,
            normal,
            of_normal,
            of_first,
        };
        (edges, squares)
    }

    /// The weights of the point that `r` leads to from corner 0: none below zero, together at most one but for a rounding.
    ///
    /// That of `F` is an area's share. In a thin triangle the areas have few digits, so that of `E` is what remains of `r` along `E`:
    /// then the point of these weights is off by a rounding of the longer edge, however thin the triangle is.
    #[inline(always)]
    fn weights<A: Arithmetic<Number = N>>(&self, a: A, r: &Vector<N>) -> [N; 2] {
        let zero = a.number(0.0);
        let [v, w] = self.inside(a, r);
        let is_below = a.lt(v, zero);
        let is_outside = is_below | a.lt(a.number(1.0), a.add(v, w));
        // A zero without a sign.
        let v = a.max(v, zero);
        if a.is_anywhere(is_outside) {
            let [edge_v, edge_w] = self.on_an_edge(a, r, is_below);
            [
                a.select(is_outside, edge_v, v),
                a.select(is_outside, edge_w, w),
            ]
        } else {
            [v, w]
        }
    }

    /// The same; rounding may make that of `E` less than zero, or the sum more than one.
    #[inline(always)]
    fn inside<A: Arithmetic<Number = N>>(&self, a: A, r: &Vector<N>) -> [N; 2] {
        let [e, f] = &self.vectors;
        let zero = a.number(0.0);
        // Turned about `n`, so that what `r` is off the plane does not count.
        let turned = plain_cross(a, &self.normal, r);
        let w = a.mul(plain_dot(a, &turned, e), a.sub(zero, self.of_normal));
        let w = a.max(w, zero);
        let rest = [
            a.fused_neg_mul_add(w, f[0], r[0]),
            a.fused_neg_mul_add(w, f[1], r[1]),
            a.fused_neg_mul_add(w, f[2], r[2]),
        ];
        [a.mul(plain_dot(a, &rest, e), self.of_first), w]
    }

    /// The weights of the point nearest to where `r` leads on the edge that starts in corner 0, if it `is_first`, or else on that
    /// between the corners 1 and 2.
    #[inline(always)]
    fn on_an_edge<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        r: &Vector<N>,
        is_first: A::Mask,
    ) -> [N; 2] {
        let [e, f] = &self.vectors;
        let (zero, one) = (a.number(0.0), a.number(1.0));
        let along_first = a.div(plain_dot(a, r, f), plain_dot(a, f, f));
        let g = minus(a, f, e);
        let along = a.div(plain_dot(a, &minus(a, r, e), &g), plain_dot(a, &g, &g));
        let v = a.max(a.sub(one, a.max(along, zero)), zero);
        let is_first = is_first & a.lt(along_first, one);
        [
            a.select(is_first, zero, v),
            a.select(is_first, a.max(along_first, zero), a.sub(one, v)),
        ]
    }
}

/// A triangle in plain float64.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plain<N> {
    first: Vector<N>,
    edges: Edges<N>,
    /// The normal's square.
    squared: N,
    /// The longer edge's square.
    size: N,
    /// The square of what `above` must be more than, see the derivation.
    error: N,
}

impl<N: Copy> Plain<N> {
    #[inline(always)]
    pub(crate) fn new<A: Arithmetic<Number = N>>(a: A, corners: &[Vector<N>; 3]) -> Self {
        let [first, second, third] = corners;
        let (e, f) = (minus(a, second, first), minus(a, third, first));
        let normal = plain_cross(a, &e, &f);
        let squared = plain_dot(a, &normal, &normal);
        let of_first = plain_dot(a, &e, &e);
        let size = a.max(of_first, plain_dot(a, &f, &f));
        // What is derived above, and an eighth more for all that is not of the first order.
        let of_size = a.mul(a.mul(a.number(9.0), size), size);
        let error = a.mul(size, a.fused_mul_add(a.number(63.0), squared, of_size));
        // Both inverses by one division.
        let inverse = a.div(a.number(1.0), a.mul(squared, of_first));
        let edges = Edges {
            vectors: [e, f],
            normal,
            of_normal: a.mul(inverse, of_first),
            of_first: a.mul(inverse, squared),
        };
        Self {
            first: *first,
            edges,
            squared,
            size,
            error,
        }
    }

    /// The triangle as it is seen from an origin, and where float64 is enough.
    #[inline(always)]
    pub(crate) fn seen_from<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        origin: &Vector<N>,
    ) -> (A::Mask, PlainStart<N>) {
        let start = between(a, &self.first, origin);
        let high = high(&start);
        let above = plain_dot(a, &self.edges.normal, &high);
        let is_enough = a.lt(self.error, a.mul(above, above));
        let far = plain_dot(a, &high, &high);
        let is_near = a.lt(far, a.mul(a.number(power(46)), self.size));
        // Nothing overflows, and nothing that counts is too small for float64.
        let in_range = a.lt(a.number(1e-120), self.squared) & a.lt(self.size, a.number(1e60));
        (is_enough & is_near & in_range, PlainStart { start, above })
    }

    /// The place along a direction.
    #[inline(always)]
    pub(crate) fn place<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        from: &PlainStart<N>,
        d: &Vector<N>,
    ) -> Place<N> {
        let PlainStart { start, above } = from;
        let inverse = a.div(a.number(1.0), plain_dot(a, &self.edges.normal, d));
        let guess = a.mul(*above, inverse);
        macro_rules! vector {
            ($k:ident => $value:expr) => {
                [
                    {
                        let $k = 0;
                        $value
                    },
                    {
                        let $k = 1;
                        $value
                    },
                    {
                        let $k = 2;
                        $value
                    },
                ]
            };
        }
        let r = vector!(k => a.sub(a.fused_mul_sub(guess, d[k], start[k].high), start[k].low));
        let correction = a.mul(plain_dot(a, &self.edges.normal, &r), inverse);
        let t = a.sub(guess, correction);
        let r = vector!(k => a.fused_neg_mul_add(correction, d[k], r[k]));
        let [v, w] = self.edges.weights(a, &r);
        [t, v, w]
    }
}

/// Where a triangle is from an origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlainStart<N> {
    /// From the origin to corner 0.
    start: DoubleVector<N>,
    /// The origin's distance from the plane times the length of the normal: `n.R`.
    above: N,
}

/// A triangle's plane, in twice the digits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane<N> {
    first: Vector<N>,
    edges: Edges<N>,
    normal: DoubleVector<N>,
    /// The edges' squares.
    squares: [N; 2],
}

impl<N: Copy> Plane<N> {
    #[inline(always)]
    pub(crate) fn new<A: Arithmetic<Number = N>>(a: A, corners: &[Vector<N>; 3]) -> Self {
        let [first, second, third] = corners;
        let (e, f) = (between(a, second, first), between(a, third, first));
        let normal = cross(a, &e, &f);
        let (edges, squares) = Edges::new(a, [high(&e), high(&f)], high(&normal));
        Self {
            first: *first,
            edges,
            normal,
            squares,
        }
    }

    /// The plane as it is seen from an origin, and where that is enough.
    #[inline(always)]
    pub(crate) fn seen_from<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        origin: &Vector<N>,
    ) -> (A::Mask, Start<N>) {
        let start = between(a, &self.first, origin);
        let above = dot(a, &self.normal, &start);
        let reach = plain_dot(a, &high(&start), &high(&start));
        let [e, f] = self.squares;
        let bound = a.mul(a.mul(a.mul(e, f), a.number(SURE)), reach);
        let is_enough = a.lt(bound, a.mul(above.high, above.high))
            & in_range(a, e)
            & in_range(a, f)
            & in_range(a, reach);
        (is_enough, Start { start, above })
    }

    /// The place along a direction, and where that is enough.
    #[inline(always)]
    pub(crate) fn place<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        from: &Start<N>,
        d: &Vector<N>,
    ) -> (A::Mask, Place<N>) {
        let (is_enough, t) = self.t(a, from, d);
        let r = left_over(a, t, d, &from.start);
        let [v, w] = self.edges.weights(a, &r);
        (is_enough, [t.high, v, w])
    }

    #[inline(always)]
    fn t<A: Arithmetic<Number = N>>(
        &self,
        a: A,
        from: &Start<N>,
        d: &Vector<N>,
    ) -> (A::Mask, Double<N>) {
        let slope = dot_plain(a, &self.normal, d);
        let t = quotient(a, from.above, slope);
        let length = plain_dot(a, d, d);
        let [e, f] = self.squares;
        let bound = a.mul(a.mul(a.mul(e, f), a.number(SURE)), length);
        let is_enough = a.lt(bound, a.mul(slope.high, slope.high)) & in_range(a, length);
        (is_enough, t)
    }
}

/// Where a plane is from an origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start<N> {
    /// From the origin to corner 0.
    start: DoubleVector<N>,
    /// The origin's distance from the plane times the length of the normal: `n.R`.
    above: Double<N>,
}

impl Edges<f64> {
    /// The same in all lanes.
    #[inline(always)]
    fn splat<A: Arithmetic>(&self, a: A) -> Edges<A::Number> {
        let [e, f] = &self.vectors;
        Edges {
            vectors: [splat(a, e), splat(a, f)],
            normal: splat(a, &self.normal),
            of_normal: a.number(self.of_normal),
            of_first: a.number(self.of_first),
        }
    }
}

impl Plane<f64> {
    /// The same in all lanes.
    #[inline(always)]
    pub(crate) fn splat<A: Arithmetic>(&self, a: A) -> Plane<A::Number> {
        Plane {
            first: splat(a, &self.first),
            edges: self.edges.splat(a),
            normal: splat_double(a, &self.normal),
            squares: [a.number(self.squares[0]), a.number(self.squares[1])],
        }
    }
}

impl Plain<f64> {
    /// The same in all lanes.
    #[inline(always)]
    pub(crate) fn splat<A: Arithmetic>(&self, a: A) -> Plain<A::Number> {
        Plain {
            first: splat(a, &self.first),
            edges: self.edges.splat(a),
            squared: a.number(self.squared),
            size: a.number(self.size),
            error: a.number(self.error),
        }
    }
}

impl PlainStart<f64> {
    /// The same in all lanes.
    #[inline(always)]
    pub(crate) fn splat<A: Arithmetic>(&self, a: A) -> PlainStart<A::Number> {
        PlainStart {
            start: splat_double(a, &self.start),
            above: a.number(self.above),
        }
    }
}

impl Start<f64> {
    /// The same in all lanes.
    #[inline(always)]
    pub(crate) fn splat<A: Arithmetic>(&self, a: A) -> Start<A::Number> {
        Start {
            start: splat_double(a, &self.start),
            above: Double {
                high: a.number(self.above.high),
                low: a.number(self.above.low),
            },
        }
    }
}

#[inline(always)]
fn splat<A: Arithmetic>(a: A, v: &Vector<f64>) -> Vector<A::Number> {
    [a.number(v[0]), a.number(v[1]), a.number(v[2])]
}

#[inline(always)]
fn splat_double<A: Arithmetic>(a: A, v: &DoubleVector<f64>) -> DoubleVector<A::Number> {
    macro_rules! part {
        ($k:literal) => {
            Double {
                high: a.number(v[$k].high),
                low: a.number(v[$k].low),
            }
        };
    }
    [part!(0), part!(1), part!(2)]
}

/// The square of what a dot product must be of the lengths, so that it is off by 2^-57 of itself at most: it is off by less than
/// 2^-98 of the lengths.
const SURE: f64 = power(-82);

/// Where a square is neither so large nor so small that products of these vectors leave the range of float64.
#[inline(always)]
fn in_range<A: Arithmetic>(a: A, squared: A::Number) -> A::Mask {
    a.lt(a.number(1e-40), squared) & a.lt(squared, a.number(1e40))
}

/// `t d - start`.
#[inline(always)]
fn left_over<A: Arithmetic>(
    a: A,
    t: Double<A::Number>,
    d: &Vector<A::Number>,
    start: &DoubleVector<A::Number>,
) -> Vector<A::Number> {
    macro_rules! along {
        ($k:literal) => {
            a.add(
                a.fused_mul_sub(t.high, d[$k], start[$k].high),
                a.fused_mul_sub(t.low, d[$k], start[$k].low),
            )
        };
    }
    [along!(0), along!(1), along!(2)]
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
        let plane = Plane::new(Scalar, &self.corners);
        let (of_start, start) = plane.seen_from(Scalar, &self.origin);
        let (of_slope, t) = plane.t(Scalar, &start, &self.direction);
        // Both are off by 2^-57 of themselves (see `SURE`), so `t` is by an eighth of a unit in the last place at most. The rest must stay
        // away from a half by more: by a sixth, where 1.5 times it still rounds to nothing.
        let is_nearest = t.high + 1.5 * t.low == t.high;
        if of_start && of_slope && is_nearest {
            return t.high;
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

    /// The place as if without rounding; `None` where the ray is along the plane.
    #[inline(always)]
    pub(crate) fn exact(&self) -> Option<Place<f64>> {
        let [first, second, third] = &self.corners;
        let d = self.direction.map(|high| Double { high, low: 0.0 });
        let d = Scaled::new(&d);
        let start = Scaled::new(&between(Scalar, first, &self.origin));
        let e = Scaled::new(&between(Scalar, second, first));
        let f = Scaled::new(&between(Scalar, third, first));
        let slope = determinant(&e, &f, &d);
        if slope.high == 0.0 {
            return None;
        }
        let t = quotient(Scalar, determinant(&e, &f, &start), slope);
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
