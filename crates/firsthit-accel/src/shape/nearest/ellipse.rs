//! The nearest points of ellipses and ellipsoids: what circles and spheres become where a transform
//! stretches.
//!
//! 1. Find the principal axes: the eigenvectors of a symmetric matrix, by Jacobi's rotations.
//! 2. In the frame of the axes the nearest point is where a function of one variable has its
//!    largest root, which two numbers are known to enclose: halve the interval until no float64 is
//!    between its ends.
//!
//! Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid" (Geometric
//! Tools, 2013). It departs in the variable, which is counted from the pole below the root, so that
//! no digits are lost near it.

use crate::geometry::DVec3;

/// The axes of an ellipsoid, or of an ellipse, which has a length of zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Principal {
    /// The directions, of length one, perpendicular.
    pub(crate) directions: [DVec3; 3],
    pub(crate) lengths: [f64; 3],
}

impl Principal {
    /// The axes of the points `x f + y g + z h` with a vector (x, y, z) of length one.
    pub(crate) fn new(spanned_by: [DVec3; 3]) -> Self {
        // One-sided: turn two of the vectors in their plane until all are perpendicular. The
        // ellipsoid stays the same.
        let mut axes = spanned_by;
        for _ in 0..SWEEPS {
            let mut is_done = true;
            for (k, l) in [(0, 1), (1, 2), (2, 0)] {
                let (p, q) = (axes[k], axes[l]);
                let (pp, qq, pq) = (p.length_squared(), q.length_squared(), p.dot(q));
                if pq.abs() <= f64::EPSILON * (pp * qq).sqrt() {
                    continue;
                }
                is_done = false;
                let slope = (qq - pp) / (2.0 * pq);
                let tan =
                    1.0_f64.copysign(slope) / (slope.abs() + slope.mul_add(slope, 1.0).sqrt());
                let cos = 1.0 / tan.mul_add(tan, 1.0).sqrt();
                let sin = cos * tan;
                (axes[k], axes[l]) = (cos * p - sin * q, sin * p + cos * q);
            }
            if is_done {
                break;
            }
        }
        let lengths = axes.map(DVec3::length);
        let mut directions = [0, 1, 2].map(|k| axes[k] / lengths[k]);
        for k in 0..3 {
            if lengths[k] == 0.0 {
                directions[k] = directions[(k + 1) % 3].cross(directions[(k + 2) % 3]);
            }
        }
        Self { directions, lengths }
    }

    /// The coordinates of a vector along the axes.
    pub(crate) fn coordinates(&self, vector: DVec3) -> [f64; 3] {
        self.directions.map(|axis| axis.dot(vector))
    }

    /// The vector with these coordinates along the axes.
    pub(crate) fn vector(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        let [f, g, h] = self.directions;
        x * f + y * g + z * h
    }
}

/// Jacobi's rotations converge quadratically: a few sweeps do, and these are many.
const SWEEPS: usize = 32;

/// The point nearest to `point` of the ellipsoid with these half axes along those of its frame,
/// none of them zero.
pub(crate) fn onto_ellipse<const N: usize>(axes: [f64; N], point: [f64; N]) -> [f64; N] {
    // In the quadrant where nothing is negative. Of the shortest axes, the one along which the
    // point is farthest.
    let y = point.map(f64::abs);
    let is_better =
        |k: usize, best: usize| axes[k] < axes[best] || (axes[k] == axes[best] && y[k] > y[best]);
    let least = (1..N).fold(0, |best, k| if is_better(k, best) { k } else { best });
    let ratios = axes.map(|axis| (axis / axes[least]) * (axis / axes[least]));
    let root = root(axes, ratios, y, least);
    let mut nearest = [0.0; N];
    let mut rest = 1.0;
    for k in 0..N {
        if y[k] > 0.0 {
            nearest[k] = ratios[k] * y[k] / (root + (ratios[k] - 1.0));
            rest -= (nearest[k] / axes[k]) * (nearest[k] / axes[k]);
        }
    }
    if y[least] == 0.0 && root == 0.0 {
        // Inside, and in the plane of symmetry: as near on both sides.
        nearest[least] = axes[least] * rest.max(0.0).sqrt();
    }
    let mut signed = nearest;
    for k in 0..N {
        signed[k] = nearest[k].min(axes[k]).copysign(point[k]);
    }
    signed
}

/// The root, counted from the pole of the shortest axis; zero where there is none above it.
fn root<const N: usize>(axes: [f64; N], ratios: [f64; N], y: [f64; N], least: usize) -> f64 {
    let value = |root: f64| {
        let mut sum = -1.0;
        for k in 0..N {
            if y[k] > 0.0 {
                let share = ratios[k] * (y[k] / axes[k]) / (root + (ratios[k] - 1.0));
                sum += share * share;
            }
        }
        sum
    };
    let mut low = y[least] / axes[least];
    // Not at the pole itself.
    if low == 0.0 && (value(0.0) < 0.0 || y.iter().all(|&y| y == 0.0)) {
        return 0.0;
    }
    let far: f64 = (0..N).map(|k| ratios[k] * (y[k] / axes[k])).map(|x| x * x).sum();
    let mut high = far.sqrt().max(low).next_up();
    loop {
        let middle = 0.5 * low + 0.5 * high;
        if middle <= low || middle >= high {
            return middle;
        }
        let at = value(middle);
        if at > 0.0 {
            low = middle;
        } else if at < 0.0 {
            high = middle;
        } else {
            return middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The nearest point is on the ellipsoid, and the way to it runs along the gradient; no point
    /// nearby is nearer.
    #[test]
    fn the_way_to_the_nearest_point_is_a_normal() {
        let mut state = 3_u64;
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for k in 0..3000 {
            let axes = [1.0, 1.0 + unit().abs(), [0.5, 1e-3, 1.0][k % 3]];
            let mut point = [2.0 * unit(), 2.0 * unit(), 2.0 * unit()];
            point[k / 3 % 3] *= [0.0, 1e-9, 1.0][k / 9 % 3];
            let found = onto_ellipse(axes, point);
            let on: f64 = (0..3).map(|k| found[k] / axes[k]).map(|x| x * x).sum();
            assert!((on - 1.0).abs() < 1e-12, "{axes:?} {point:?} {found:?} {on}");
            let way = DVec3::from(point) - DVec3::from(found);
            let gradient: [f64; 3] = [0, 1, 2].map(|k| found[k] / axes[k] / axes[k]);
            let gradient = DVec3::from(gradient).normalize();
            let off = way.cross(gradient).length();
            assert!(off < 1e-9, "{axes:?} {point:?} {found:?} {off}");
            for _ in 0..20 {
                let v = DVec3::new(unit(), unit(), unit()).normalize();
                let other = DVec3::from(axes) * v;
                let distance = (other - DVec3::from(point)).length();
                assert!(distance >= way.length() - 1e-12, "{axes:?} {point:?}");
            }
        }
    }

    #[test]
    fn the_middle_is_nearest_to_the_end_of_the_shortest_axis() {
        assert_eq!(onto_ellipse([3.0, 2.0, 5.0], [0.0; 3]), [0.0, 2.0, 0.0]);
        assert_eq!(onto_ellipse([3.0, 2.0], [3.5, 0.0]), [3.0, 0.0]);
    }

    #[test]
    fn principal_axes_are_perpendicular_and_keep_the_ellipsoid() {
        let spanned =
            [DVec3::new(1.0, 2.0, 0.5), DVec3::new(-0.3, 1.0, 4.0), DVec3::new(0.2, 0.1, -0.6)];
        let principal = Principal::new(spanned);
        let [f, g, h] = principal.directions;
        assert!(f.dot(g).abs() + g.dot(h).abs() + h.dot(f).abs() < 1e-14);
        // The support of the ellipsoid along any direction is the length of its products with what
        // spans it.
        for direction in [DVec3::X, DVec3::ONE, DVec3::new(0.3, -2.0, 1.0)] {
            let of = |vectors: [DVec3; 3]| DVec3::from(vectors.map(|v| v.dot(direction))).length();
            let [x, y, z] = principal.lengths;
            assert!((of(spanned) - of([x * f, y * g, z * h])).abs() < 1e-13);
        }
    }
}
