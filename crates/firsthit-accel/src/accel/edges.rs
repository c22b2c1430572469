//! The edge test in float32: on which sides of a triangle's edges does a ray pass, and at which
//! depth is the triangle met?
//!
//! A [side](Sides) is twice the area of the triangle between the ray and an edge, seen along the
//! ray. It has an error below the `bound` that every user derives for its coordinates:
//!
//! - One side below `-bound` and another above `bound`: the exact test rejects the triangle.
//! - All three beyond `bound` with one sign: the exact test accepts it. Its depth is the mean of
//!   the corners' depths with the sides as weights.
//! - Anything between is for the exact test.
//!
//! In the lanes are triangles (one ray) or rays (one triangle).

use crate::simd::Lanes;

/// The sides of the edges b-c, c-a and a-b on which rays pass.
pub(super) struct Sides<L: Lanes>(pub(super) [L::Floats; 3]);

impl<L: Lanes> Sides<L> {
    /// Computes the sides from the corners, relative to the ray, across its direction.
    #[inline(always)]
    pub(super) fn new(
        l: L,
        [ax, ay]: [L::Floats; 2],
        [bx, by]: [L::Floats; 2],
        [cx, cy]: [L::Floats; 2],
    ) -> Self {
        Self([
            l.mul_sub(cx, by, l.mul(cy, bx)),
            l.mul_sub(ax, cy, l.mul(ay, cx)),
            l.mul_sub(bx, ay, l.mul(by, ax)),
        ])
    }

    /// The lanes that are outside for certain.
    #[inline(always)]
    pub(super) fn outside(&self, l: L, bound: L::Floats) -> u16 {
        let [u, v, w] = self.0;
        let (least, most) = (l.min(l.min(u, v), w), l.max(l.max(u, v), w));
        l.lt(bound, l.min(l.sub(l.splat(0.0), least), most))
    }

    /// The lanes that are inside for certain.
    #[inline(always)]
    pub(super) fn inside(&self, l: L, bound: L::Floats) -> u16 {
        let [u, v, w] = self.0;
        let (least, most) = (l.min(l.min(u, v), w), l.max(l.max(u, v), w));
        l.lt(bound, l.max(least, l.sub(l.splat(0.0), most)))
    }

    /// The depth where the triangle is met, from the depths of its corners; and the size of one
    /// over the sides' sum, of which the depth's error is a multiple.
    #[inline(always)]
    pub(super) fn depth(&self, l: L, [az, bz, cz]: [L::Floats; 3]) -> [L::Floats; 2] {
        let [u, v, w] = self.0;
        let over = l.div(l.splat(1.0), l.add(l.add(u, v), w));
        let depth = l.mul_add(u, az, l.mul_add(v, bz, l.mul(w, cz)));
        [l.mul(depth, over), l.abs(over)]
    }
}

/// The depths between which triangles are met: within their corners' depths, and where `certain`
/// also within `error` of `depth`.
#[inline(always)]
pub(super) fn depths<L: Lanes>(
    l: L,
    certain: u16,
    [depth, error]: [L::Floats; 2],
    [nearest, farthest]: [L::Floats; 2],
) -> [L::Floats; 2] {
    [
        l.select(certain, l.max(l.sub(depth, error), nearest), nearest),
        l.select(certain, l.min(l.add(depth, error), farthest), farthest),
    ]
}
