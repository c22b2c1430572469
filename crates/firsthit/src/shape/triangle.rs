//! The judge: does this ray meet this triangle? Decided in float64, and the same for neighbours.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics
//! Techniques 2(1), 2013. Space is sheared so that the ray runs along one axis from the origin; the
//! test is then on which side of each edge the origin lies. A vertex goes to the same rounded point
//! for all triangles around it, and the sign of an edge function is exact, so neighbours agree about
//! their edge: a ray cannot pass between them. (Where the paper falls back to double precision on a
//! zero, here the sign is that of the exact difference of products.)

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use super::Crossing;
use crate::geometry::{DVec2, DVec3, Ray, plane_crossing};

/// A ray made ready for triangles.
#[derive(Debug, Clone, Copy)]
pub struct Shear {
    origin: DVec3,
    direction: DVec3,
    /// The axis along which the direction is longest, and the two others.
    axes: [usize; 3],
    slope: DVec2,
    scale: f64,
}

/// Where a ray meets a triangle's plane inside the triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// The ray's parameter; any sign.
    pub t: f64,
    /// The weights of the corners 1 and 2.
    pub barycentric: DVec2,
}

impl TriangleHit {
    /// The hit in the triangle `primitive` of a mesh.
    #[inline(always)]
    pub(crate) fn crossing(self, primitive: i32) -> Crossing {
        Crossing {
            t: self.t,
            primitive,
            barycentric: self.barycentric,
        }
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
            slope: DVec2::new(quotient(d[x], d[z], scale), quotient(d[y], d[z], scale)),
            scale,
        }
    }

    /// The vertex relative to the ray: its distances from the ray across, and along the longest axis.
    #[inline(always)]
    fn sheared(&self, vertex: DVec3) -> (DVec2, f64) {
        let relative = vertex - self.origin;
        let [x, y, z] = self.axes;
        let (x, y, z) = (relative[x], relative[y], relative[z]);
        (DVec2::new(x - self.slope.x * z, y - self.slope.y * z), z)
    }

    /// Where the ray meets the triangle, edges and corners included; `None` past it or along it.
    #[inline(always)]
    pub fn intersect(&self, corners: [DVec3; 3]) -> Option<TriangleHit> {
        self.intersect_from::<false>(corners)
    }

    /// The same where `t` is above zero; else perhaps `None`, which is sooner known.
    #[inline(always)]
    pub(crate) fn intersect_ahead(&self, corners: [DVec3; 3]) -> Option<TriangleHit> {
        self.intersect_from::<true>(corners)
    }

    #[inline(always)]
    fn intersect_from<const AHEAD: bool>(&self, corners: [DVec3; 3]) -> Option<TriangleHit> {
        // Not by `map`, which is not inlined.
        let (a, a_z) = self.sheared(corners[0]);
        let (b, b_z) = self.sheared(corners[1]);
        let (c, c_z) = self.sheared(corners[2]);
        let u = side(c, b);
        let v = side(a, c);
        let w = side(b, a);
        // Written so that a NaN fails.
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        if !inside {
            return None;
        }
        let barycentric = weights(a, b, c);
        // Exactly the corners' place where they have the same one.
        let mean = barycentric.x.mul_add(b_z - a_z, a_z);
        let mean = barycentric.y.mul_add(c_z - a_z, mean);
        let farthest = a_z.abs().max(b_z.abs()).max(c_z.abs());
        let is_far = farthest > FAR * mean.abs();
        let (mean, farthest) = (mean * self.scale, farthest * self.scale.abs());
        if AHEAD && mean < -ROUNDING * farthest {
            return None;
        }
        let t = if is_far {
            self.without_cancellation(corners, mean, farthest)
        } else {
            mean
        };
        // NaN for a triangle along the ray, which has no area across it.
        t.is_finite().then_some(TriangleHit { t, barycentric })
    }
}

/// From here on the corners' places, that much farther away than the hit, leave their mean too few digits.
pub(crate) const FAR: f64 = 1024.0;

/// What the mean is off at most, as a share of the corners' farthest place.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Shear {
    /// Where the ray crosses the triangle's plane, in place of a `mean` that is a small difference of large
    /// numbers. Off the mean by no more than its rounding, which the tree allows for: where the triangle is
    /// seen so nearly edge-on that the plane is crossed somewhere else, the mean stays.
    #[cold]
    fn without_cancellation(&self, corners: [DVec3; 3], mean: f64, farthest: f64) -> f64 {
        let t = plane_crossing(self.origin, self.direction, corners);
        let rounding = ROUNDING * farthest;
        if (t - mean).abs() <= rounding {
            t
        } else {
            mean
        }
    }
}

/// `a / b` by the inverse of `b`, rounded as a division rounds it, which takes longer. (One multiplication and two fused ones:
/// Markstein, "Computation of elementary functions on the IBM RISC System/6000 processor", IBM Journal of Research and
/// Development 34(1), 1990; Brisebarre, Muller and Raina, "Accelerating correctly rounded floating-point division when the
/// divisor is known in advance", IEEE Transactions on Computers 53(8), 2004.) But `+0 / -1` is `+0`, and where `a` or the
/// quotient is so small that what is left over has no digits, the last digit may be another.
#[inline(always)]
fn quotient(a: f64, b: f64, inverse: f64) -> f64 {
    let first = a * inverse;
    let beyond = first.mul_add(b, -a);
    (-beyond).mul_add(inverse, first)
}

/// Two to the power of 500.
const HUGE: f64 = f64::from_bits((1023 + 500) << 52);

/// The weights of `b` and `c` where the origin is inside the triangle; NaN where it has no area.
///
/// The sides' signs are exact, their sizes are not: of a triangle seen nearly edge-on they can be nothing
/// but rounding, and the mean any point of the triangle. These weights are good to their last digits, so
/// the hit is where the ray crosses the triangle of the sheared corners; the tree relies on that.
#[inline(always)]
fn weights(a: DVec2, b: DVec2, c: DVec2) -> DVec2 {
    let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
    // A power of two scales without rounding.
    let scale = if largest < 1e-140 { HUGE } else { 1.0 };
    let (a, b, c) = (scale * a, scale * b, scale * c);
    let (u, v, w) = (precise_side(c, b), precise_side(a, c), precise_side(b, a));
    DVec2::new(v, w) / (u + v + w)
}

/// `p.x * q.y - p.y * q.x` to its last digits. (Kahan's way; its error is one and a half units in the last
/// place: Jeannerod, Louvet and Muller, Mathematics of Computation 82, 2013.)
#[inline(always)]
fn precise_side(p: DVec2, q: DVec2) -> f64 {
    let right = p.y * q.x;
    p.x.mul_add(q.y, -right) - p.y.mul_add(q.x, -right)
}

/// `p.x * q.y - p.y * q.x`, rounded, with the sign of the exact result; of a tiny one only the sign counts.
#[inline(always)]
fn side(p: DVec2, q: DVec2) -> f64 {
    let left = p.x * q.y;
    let right = p.y * q.x;
    let difference = left - right;
    if difference == 0.0 {
        side_of_equals(p, q, left, right)
    } else {
        difference
    }
}

/// Rounding is monotonic, so products that differ after rounding differ the same way before it. When
/// they round to the same number, what rounding took away from each decides; a fused multiply-add
/// gives that exactly.
#[cold]
fn side_of_equals(p: DVec2, q: DVec2, left: f64, right: f64) -> f64 {
    // What rounding took from a product this small may itself be too small for float64.
    if left.abs() < 1e-270 && p.abs().max(q.abs()).max_element() < 1e140 {
        let (p, q) = (p * HUGE, q * HUGE);
        let (left, right) = (p.x * q.y, p.y * q.x);
        return if left == right {
            residuals(p, q, left, right)
        } else {
            left - right
        };
    }
    residuals(p, q, left, right)
}

fn residuals(p: DVec2, q: DVec2, left: f64, right: f64) -> f64 {
    p.x.mul_add(q.y, -left) - p.y.mul_add(q.x, -right)
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
            assert_eq!(
                Shear::new(&ray).intersect(corners).unwrap().t,
                3.0,
                "{ray:?}"
            );
        }
    }

    #[test]
    fn a_quotient_by_the_inverse_is_rounded_as_that_of_a_division() {
        let digits = |k: u64| k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 12;
        let number = |exponent: u64, digits: u64| f64::from_bits(exponent << 52 | digits);
        let ones = (1 << 52) - 1;
        for k in 0..200_000 {
            // From 1 to 2, the hardest of them next to the ends, of any size, and a little below the divisor.
            let near = digits(k) >> (k % 53);
            let any = number(1023 - 300 + k % 600, digits(!k));
            for b in [number(1023, near), number(1023, ones - near)] {
                for a in [
                    any,
                    number(1023, ones - near / 2),
                    b - (k % 9) as f64 * f64::EPSILON,
                ] {
                    for (a, b) in [(a, b), (-a, b), (a, -2.0 * b), (b, b), (0.0, b), (-0.0, b)] {
                        let found = quotient(a, b, 1.0 / b);
                        assert_eq!(found.to_bits(), (a / b).to_bits(), "{a:e} / {b:e}");
                    }
                }
            }
        }
    }

    /// Both products round to 1: only what was rounded away tells the sides apart.
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
