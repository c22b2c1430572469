//! The weights of a point in a triangle, from its place relative to corner 0.
//!
//! 1. The weight of `F` is the share of the triangle's area that the point and `E` span, measured
//!    along the normal.
//! 2. The weight of `E` is what remains of the point along `E`. It is not an area too: in a thin
//!    triangle areas have few digits. So the point of these weights is off by a rounding of the
//!    longer edge, however thin the triangle is.
//! 3. Where rounding has put the point outside, take the nearest point of the nearest edge.

use super::{Vector, minus, plain_cross, plain_dot, splat};
use crate::geometry::arithmetic::Arithmetic;

/// The numbers of a triangle that weights are computed from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges<N> {
    /// `E` and `F`.
    pub(super) vectors: [Vector<N>; 2],
    pub(super) normal: Vector<N>,
    /// One over the normal's square.
    pub(super) of_normal: N,
    /// One over the square of `E`.
    pub(super) of_first: N,
}

impl<N: Copy> Edges<N> {
    /// Prepares two edges and their normal; and returns the edges' squares.
    #[inline(always)]
    pub(super) fn new<A: Arithmetic<Number = N>>(
        a: A,
        vectors: [Vector<N>; 2],
        normal: Vector<N>,
    ) -> (Self, [N; 2]) {
        let squares =
            [plain_dot(a, &vectors[0], &vectors[0]), plain_dot(a, &vectors[1], &vectors[1])];
        let one = a.number(1.0);
        let of_normal = a.div(one, plain_dot(a, &normal, &normal));
        let of_first = a.div(one, squares[0]);
        let edges = Self { vectors, normal, of_normal, of_first };
        (edges, squares)
    }

    /// The weights of the point that `r` leads to from corner 0: none below zero, together at most
    /// one but for a rounding.
    ///
    /// `F`'s weight is a ratio of areas. `E`'s is the rest of `r` along `E`, since areas of thin
    /// triangles have few digits: then the point of these weights is off by a rounding of the
    /// longer edge, however thin the triangle is.
    #[inline(always)]
    pub(super) fn weights<A: Arithmetic<Number = N>>(&self, a: A, r: &Vector<N>) -> [N; 2] {
        let zero = a.number(0.0);
        let [v, w] = self.inside(a, r);
        let is_below = a.lt(v, zero);
        let is_outside = is_below | a.lt(a.number(1.0), a.add(v, w));
        // A zero without a sign.
        let v = a.max(v, zero);
        if a.is_anywhere(is_outside) {
            let [edge_v, edge_w] = self.on_an_edge(a, r, is_below);
            [a.select(is_outside, edge_v, v), a.select(is_outside, edge_w, w)]
        } else {
            [v, w]
        }
    }

    /// The weights without clamping: rounding may make `E`'s less than zero, or the sum more than
    /// one.
    #[inline(always)]
    pub(super) fn inside<A: Arithmetic<Number = N>>(&self, a: A, r: &Vector<N>) -> [N; 2] {
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

    /// The weights of the point nearest to where `r` leads on the edge that starts in corner 0, if
    /// it `is_first`, or else on that between the corners 1 and 2.
    #[inline(always)]
    pub(super) fn on_an_edge<A: Arithmetic<Number = N>>(
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
        [a.select(is_first, zero, v), a.select(is_first, a.max(along_first, zero), a.sub(one, v))]
    }
}

impl Edges<f64> {
    /// The edges in all lanes.
    #[inline(always)]
    pub(super) fn splat<A: Arithmetic>(&self, a: A) -> Edges<A::Number> {
        let [e, f] = &self.vectors;
        Edges {
            vectors: [splat(a, e), splat(a, f)],
            normal: splat(a, &self.normal),
            of_normal: a.number(self.of_normal),
            of_first: a.number(self.of_first),
        }
    }
}
