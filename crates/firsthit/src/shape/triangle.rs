//! The judge: does this ray meet this triangle? Decided in float64, and the same for neighbours.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics
//! Techniques 2(1), 2013. Space is sheared so that the ray runs along one axis from the origin; the
//! test is then on which side of each edge the origin lies. A vertex goes to the same rounded point
//! for all triangles around it, and the sign of an edge function is exact, so neighbours agree about
//! their edge: a ray cannot pass between them. (Where the paper falls back to double precision on a
//! zero, here the sign is that of the exact difference of products.)

use crate::geometry::{DVec2, DVec3, Ray};

/// A ray made ready for triangles.
#[derive(Debug, Clone, Copy)]
pub struct Shear {
    origin: DVec3,
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

impl Shear {
    /// Makes `ray` ready. Its direction is not zero.
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
        Self {
            origin: ray.origin,
            axes: [x, y, z],
            slope: DVec2::new(d[x] / d[z], d[y] / d[z]),
            scale: 1.0 / d[z],
        }
    }

    /// The vertex relative to the ray: its distances from the ray across, and its place along it.
    fn sheared(&self, vertex: DVec3) -> (DVec2, f64) {
        let relative = vertex - self.origin;
        let [x, y, z] = self.axes.map(|axis| relative[axis]);
        (
            DVec2::new(x - self.slope.x * z, y - self.slope.y * z),
            z * self.scale,
        )
    }

    /// Where the ray meets the triangle, edges and corners included; `None` past it or along it.
    pub fn intersect(&self, corners: [DVec3; 3]) -> Option<TriangleHit> {
        let [(a, a_t), (b, b_t), (c, c_t)] = corners.map(|corner| self.sheared(corner));
        let u = side(c, b);
        let v = side(a, c);
        let w = side(b, a);
        // Written so that a NaN fails.
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let area = u + v + w;
        if !inside || area == 0.0 {
            return None;
        }
        // The corners' places in the mean, counted from one of them: so that what is level stays level. The
        // tree relies on `t` being within the triangle's own range, which rounding could leave.
        let t = a_t + (v * (b_t - a_t) + w * (c_t - a_t)) / area;
        t.is_finite().then(|| TriangleHit {
            t: t.max(a_t.min(b_t).min(c_t)).min(a_t.max(b_t).max(c_t)),
            barycentric: DVec2::new(v / area, w / area),
        })
    }
}

/// `p.x * q.y - p.y * q.x` with the sign of the exact result.
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
    const TWO_TO_500: f64 = f64::from_bits((1023 + 500) << 52);
    // What rounding took from a product this small may itself be too small for float64.
    if left.abs() < 1e-270 && p.abs().max(q.abs()).max_element() < 1e140 {
        let (p, q) = (p * TWO_TO_500, q * TWO_TO_500);
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
