//! The exact test: does this ray meet this triangle, and where? It decides as exact arithmetic on
//! the float64 numbers would.
//!
//! 1. Shear space so that the ray runs along one axis from the origin, and compute the sides of the
//!    three edges: twice the area that the origin and an edge span.
//! 2. Where two sides have different signs and both are larger than their rounding, the ray passes
//!    the triangle.
//! 3. Where all sides have one sign and are larger than their rounding, it meets the triangle.
//! 4. Elsewhere take the sign of each side from a determinant without rounding
//!    (`geometry/exact.rs`). The ray meets the triangle where no two signs differ, and not all are
//!    zero.
//! 5. Compute where (`triangle/place.rs`).
//!
//! Edges and corners are part of a triangle, and neighbours agree about their edge. So no ray
//! passes between them. A query that takes every crossing once has another rule for zeros in step
//! 4: `triangle/crossed.rs`.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics
//! Techniques 2(1), 2013. It departs in step 4: there float64 decides for float32, and the sheared
//! corners are rounded.
//!
//! # Error bounds
//!
//! In units of 2^-53. M is the largest coordinate before the shear, X the largest after it, which
//! is at most 2 M.
//!
//! - A coordinate relative to the origin is off by M, and a slope by 1.
//! - A coordinate across the ray is off by M + 3 M + X.
//! - A side is off by 4 X times that, and by 4 X^2 of its own rounding: less than 32 M X.
//!
//! The test takes 40 M X.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

mod crossed;
mod departure;
mod fan;
mod filter;
mod place;

#[doc(hidden)]
pub use departure::DeparturePoint;
#[doc(hidden)]
pub use fan::Fan;
#[doc(hidden)]
pub use filter::{Begin, MeshFilter};
pub(crate) use place::Meeting;
#[doc(hidden)]
pub use place::{Place, Plain, PlainStart, Plane, Start};

use super::Crossing;
use crate::geometry::arithmetic::{Scalar, quotient_by_inverse};
use crate::geometry::double::{Double, DoubleVector};
use crate::geometry::exact::{Scaled, determinant};
use crate::geometry::fused::mul_add;
use crate::geometry::{DVec2, DVec3, Ray, arrays};

/// A ray made ready for triangles.
#[derive(Debug, Clone, Copy)]
pub struct Shear {
    origin: DVec3,
    direction: DVec3,
    /// The axis along which the direction is longest, and the two others.
    axes: [usize; 3],
    slope: DVec2,
}

/// Whether a ray at an edge or corner meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeRule {
    /// Edges and corners are part of every triangle that has them: between neighbours there is no
    /// gap.
    Closed,
    /// One of two neighbours has each point of an edge, as a ray infinitely little beside it would
    /// see them: on a closed mesh every ray enters as often as it leaves.
    Once,
}

/// The crossing of a ray with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// The ray's parameter; any sign.
    pub t: f64,
    /// The weights of the corners 1 and 2.
    pub barycentric: DVec2,
}

impl TriangleHit {
    #[inline(always)]
    pub(crate) fn new([t, v, w]: Place<f64>) -> Self {
        let barycentric = DVec2::new(v, w);
        Self { t, barycentric }
    }

    /// The hit in the triangle `primitive` of a mesh.
    #[inline(always)]
    #[doc(hidden)]
    pub fn crossing(self, primitive: i32) -> Crossing {
        Crossing { t: self.t, primitive, barycentric: self.barycentric }
    }
}

impl Shear {
    /// Makes `ray` ready. Its direction is not zero.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let longest = d.abs();
        let z = if longest.x >= longest.y && longest.x >= longest.z {
            0
        } else if longest.y >= longest.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let scale = 1.0 / d[z];
        Self {
            origin: ray.origin,
            direction: d,
            axes: [x, y, z],
            slope: DVec2::new(
                quotient_by_inverse(Scalar, d[x], d[z], scale),
                quotient_by_inverse(Scalar, d[y], d[z], scale),
            ),
        }
    }

    /// The vertex relative to the ray: its coordinates across the ray, and the largest coordinate
    /// that they are computed from.
    #[inline(always)]
    fn sheared(&self, vertex: DVec3) -> (DVec2, f64) {
        let relative = vertex - self.origin;
        let [x, y, z] = self.axes;
        let largest = relative.abs().max_element();
        let (x, y, z) = (relative[x], relative[y], relative[z]);
        (DVec2::new(x - self.slope.x * z, y - self.slope.y * z), largest)
    }

    /// The sides of a triangle.
    #[inline(always)]
    fn seen(&self, corners: [DVec3; 3]) -> RoundedSides {
        let (a, a_largest) = self.sheared(corners[0]);
        let (b, b_largest) = self.sheared(corners[1]);
        let (c, c_largest) = self.sheared(corners[2]);
        RoundedSides {
            sides: [area(c, b), area(a, c), area(b, a)],
            largest: a_largest.max(b_largest).max(c_largest),
            across: a.abs().max(b.abs()).max(c.abs()).max_element(),
        }
    }

    /// Intersects the ray with the triangle, edges and corners included; `None` past it or along
    /// it.
    #[inline(always)]
    pub fn intersect(&self, corners: [DVec3; 3]) -> Option<TriangleHit> {
        self.intersect_by(EdgeRule::Closed, corners, Doubtful::settle)
    }

    /// Intersects the ray with the triangle by another rule for edges and corners.
    #[inline(always)]
    pub fn intersect_with(&self, edges: EdgeRule, corners: [DVec3; 3]) -> Option<TriangleHit> {
        self.intersect_by(edges, corners, Doubtful::settle)
    }

    /// Intersects the ray with the triangle, where a kernel brings its own function to `settle`
    /// what float64 cannot decide.
    #[inline(always)]
    #[doc(hidden)]
    pub fn intersect_by(
        &self,
        edges: EdgeRule,
        corners: [DVec3; 3],
        settle: impl FnOnce(Doubtful) -> Option<TriangleHit>,
    ) -> Option<TriangleHit> {
        let seen = self.seen(corners);
        let doubt = seen.doubt();
        let (least, most) = seen.least_and_most();
        if least < -doubt && most > doubt {
            return None;
        }
        let meeting = Meeting::new(self.origin, self.direction, corners);
        let is_met = least > doubt || most < -doubt;
        if is_met && let Some(place) = meeting.plain() {
            return Some(TriangleHit::new(place));
        }
        settle(Doubtful { meeting, is_met, edges })
    }
}

/// A triangle as a ray sees it.
struct RoundedSides {
    /// The sides of its edges, rounded.
    sides: [f64; 3],
    /// The largest coordinate before the shear, and across the ray.
    largest: f64,
    across: f64,
}

impl RoundedSides {
    /// An upper bound on the error of the sides: see the error bounds above; and more where
    /// products are subnormal.
    #[inline(always)]
    fn doubt(&self) -> f64 {
        20.0 * f64::EPSILON * self.largest * self.across + f64::MIN_POSITIVE
    }

    #[inline(always)]
    fn least_and_most(&self) -> (f64, f64) {
        let [u, v, w] = self.sides;
        (u.min(v).min(w), u.max(v).max(w))
    }

    #[inline(always)]
    fn sum(&self) -> f64 {
        let [u, v, w] = self.sides;
        u + v + w
    }
}

/// Computes the crossing of a ray with a triangle that it is known to meet; see
/// [`Shear::intersect_by`].
#[inline(always)]
pub(crate) fn locate(
    ray: &Ray,
    corners: [DVec3; 3],
    settle: impl FnOnce(Doubtful) -> Option<TriangleHit>,
) -> Option<TriangleHit> {
    let meeting = Meeting::new(ray.origin, ray.direction, corners);
    match meeting.plain() {
        Some(place) => Some(TriangleHit::new(place)),
        None => settle(Doubtful { meeting, is_met: true, edges: EdgeRule::Closed }),
    }
}

/// Whether two `t` are so close that they do not tell which of the exact ones is smaller: each is
/// within a unit in the last place of its exact one.
#[inline(always)]
#[doc(hidden)]
pub fn are_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 4.0 * f64::EPSILON * a.abs().min(b.abs())
}

/// A `t` that is larger than every one that is close to this.
#[inline(always)]
#[doc(hidden)]
pub fn clear_of(t: f64) -> f64 {
    t + 8.0 * f64::EPSILON * t.abs()
}

/// A ray and a triangle that plain float64 is not enough for.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Doubtful {
    meeting: Meeting<f64>,
    /// Whether the ray is known to meet the triangle, and only where it does is left to be
    /// computed.
    is_met: bool,
    edges: EdgeRule,
}

impl Doubtful {
    /// Whether the triangle's plane is surely not met between two `t`; rays from a mesh's vertex
    /// come to many such triangles.
    #[inline(always)]
    pub(crate) fn is_outside(&self, t_min: f64, t_max: f64) -> bool {
        self.meeting.is_outside(t_min, t_max)
    }

    /// Decides by exact arithmetic.
    #[inline(never)]
    pub fn settle(self) -> Option<TriangleHit> {
        self.settle_inlined()
    }

    /// [`settle`](Self::settle), inlined into a kernel.
    #[inline(always)]
    pub(crate) fn settle_inlined(self) -> Option<TriangleHit> {
        let meeting = &self.meeting;
        let plain = if self.is_met {
            None
        } else if self.meets() {
            meeting.plain()
        } else {
            return None;
        };
        let place = match plain.or_else(|| meeting.double()) {
            Some(place) => place,
            None => meeting.exact()?,
        };
        // Not where numbers leave the range of float64.
        let is_fine = place[0].is_finite();
        is_fine.then(|| TriangleHit::new(place))
    }

    /// Whether the ray meets the triangle.
    #[inline(always)]
    fn meets(&self) -> bool {
        let corners = self.meeting.relative();
        if !corners.iter().flatten().all(|part| part.high.is_finite()) {
            return false;
        }
        let d = arrays::map(self.meeting.direction, |high| Double { high, low: 0.0 });
        let sides = if let Some([a, b, c]) = along_axis(&d, &corners) {
            [side(c, b), side(a, c), side(b, a)]
        } else {
            exact_sides(&Scaled::new(&d), &corners)
        };
        let [u, v, w] = sides;
        if self.edges == EdgeRule::Once && (u == 0.0 || v == 0.0 || w == 0.0) {
            return self.meeting.is_crossed();
        }
        let is_front = u >= 0.0 && v >= 0.0 && w >= 0.0;
        let is_back = u <= 0.0 && v <= 0.0 && w <= 0.0;
        // Not both: a ray in the triangle's plane, or a triangle without area.
        is_front != is_back
    }
}

/// Numbers with the exact signs of the sides of a triangle's edges, its corners given relative to
/// the ray's origin.
#[inline(always)]
fn exact_sides(d: &Scaled, corners: &[DoubleVector<f64>; 3]) -> [f64; 3] {
    let [a, b, c] = corners;
    let [a, b, c] = [Scaled::new(a), Scaled::new(b), Scaled::new(c)];
    let side = |p, q| determinant(d, p, q).high;
    [side(&c, &b), side(&a, &c), side(&b, &a)]
}

/// The corners across a ray along an axis, if float64 has them without rounding. Such rays are
/// frequent: they are those of grids.
#[inline(always)]
fn along_axis(d: &DoubleVector<f64>, corners: &[DoubleVector<f64>; 3]) -> Option<[DVec2; 3]> {
    let zeros = arrays::map(*d, |part| part.high == 0.0);
    let [x, y] = match zeros {
        [true, true, _] => [0, 1],
        [true, _, true] => [0, 2],
        [_, true, true] => [1, 2],
        _ => return None,
    };
    let is_exact = |corner: &DoubleVector<f64>| corner[x].low == 0.0 && corner[y].low == 0.0;
    let across = |corner: &DoubleVector<f64>| DVec2::new(corner[x].high, corner[y].high);
    let [a, b, c] = corners;
    (is_exact(a) && is_exact(b) && is_exact(c)).then(|| [across(a), across(b), across(c)])
}

/// Two to the power of 500.
const HUGE: f64 = f64::from_bits((1023 + 500) << 52);

/// `p.x * q.y - p.y * q.x`, rounded.
#[inline(always)]
fn area(p: DVec2, q: DVec2) -> f64 {
    p.x * q.y - p.y * q.x
}

/// A number with the sign that `p.x * q.y - p.y * q.x` has exactly.
#[inline(always)]
fn side(p: DVec2, q: DVec2) -> f64 {
    let left = p.x * q.y;
    let right = p.y * q.x;
    let difference = left - right;
    if difference == 0.0 { side_of_equals(p, q, left, right) } else { difference }
}

/// [`side`] where both products round to the same number. The part that rounding took from each
/// then decides, and a fused multiply-add gives that exactly. (Products that differ after rounding
/// differ in the same way before it, since rounding is monotonic.)
#[cold]
fn side_of_equals(p: DVec2, q: DVec2, left: f64, right: f64) -> f64 {
    // The part that rounding took from a product this small may itself be too small for float64.
    if left.abs() < 1e-270 && p.abs().max(q.abs()).max_element() < 1e140 {
        let (p, q) = (p * HUGE, q * HUGE);
        let (left, right) = (p.x * q.y, p.y * q.x);
        return if left == right { residuals(p, q, left, right) } else { left - right };
    }
    residuals(p, q, left, right)
}

fn residuals(p: DVec2, q: DVec2, left: f64, right: f64) -> f64 {
    mul_add(p.x, q.y, -left) - mul_add(p.y, q.x, -right)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights that do not quite sum to one must not tilt a level triangle.
    #[test]
    fn t_is_exact_where_the_triangle_is_level() {
        let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.3, 1.0, 0.0]].map(DVec3::from);
        for k in 0..1000 {
            let x = f64::from(k) * 1e-3 - 0.5;
            let ray = Ray::new(DVec3::new(x * 0.7, -0.7 + 0.1 * x, 3.0), DVec3::NEG_Z);
            assert_eq!(Shear::new(&ray).intersect(corners).unwrap().t, 3.0, "{ray:?}");
        }
    }

    /// The products both round to 1: only what was rounded away tells the sides apart.
    #[test]
    fn the_sign_of_an_edge_is_exact_where_products_round_to_the_same() {
        let e = f64::EPSILON;
        let (p, q) = (DVec2::new(1.0 + e, 1.0), DVec2::new(1.0, 1.0 - e));
        assert_eq!(p.x * q.y, p.y * q.x);
        assert!(side(p, q) < 0.0 && side(q, p) > 0.0);
        let tiny = 1e-160;
        assert!(side(p * tiny, q * tiny) < 0.0 && side(q * tiny, p * tiny) > 0.0);
        assert_eq!(side(p, p), 0.0);
    }
}
