//! Rays for which float64 has no depths near a tree: those that start very far away, and those that
//! begin behind their origins.
//!
//! 1. Bring the ray's start into the tree's space, in twice the digits.
//! 2. Move it along the ray to the point nearest to the tree's middle. Each step is rounded, and
//!    the next makes up for that.
//! 3. Where it does not come to rest, or rounding leaves the place open, give up: every triangle of
//!    the mesh is tested.
//! 4. Drop the ray if that point is not in the sphere around the tree.
//! 5. Else move it back to before the tree, and traverse the tree from there with a ray without an
//!    end. Every triangle that this ray may meet is tested with the ray as it was, as no depth can
//!    be compared with its `t`.
//!
//! # Error bounds
//!
//! A sum of two numbers of twice the digits is off by a share of 2^-100 (`SHARE`) of its terms:
//! they have 106 bits, six of which are for the up to 24 sums. The part of that error across the
//! ray is the blur of the ray that is traversed.

use crate::accel::bvh::BALL;
use crate::accel::space::Space;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{Double, between, product, sum};
use crate::geometry::{DVec3, Ray, arrays};

/// The error of a sum in twice the digits, as a share of its terms.
const SHARE: f64 = f64::from_bits((1023 - 100) << 52);

/// The most steps to the tree: each shortens the rest by 50 bits, and the start is at most 2^1000
/// away.
const STEPS: usize = 24;

/// The approach of a distant ray to a tree.
pub(super) enum Approach {
    /// The ray passes the tree.
    Past,
    /// The ray counts as one that begins near the tree, with its error across its direction, in
    /// units of the tree.
    Near(Ray, f64),
    /// Rounding leaves the ray's place open.
    Somewhere,
}

/// The largest power of two that is not above a positive number; for a subnormal number the
/// smallest normal one.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & (0x7ff << 52))
}

impl Approach {
    /// The approach of a ray; of the whole line that it is on, where it begins behind its origin.
    pub(super) fn new(space: &Space, ray: &Ray) -> Self {
        let start = between(Scalar, &ray.origin.to_array(), &space.origin.to_array());
        let mut place =
            arrays::map(start, |x| Double { high: x.high * space.scale, low: x.low * space.scale });
        // The direction by a power of two, which is exact: its square is around 1.
        let unit = power_of_two_below(ray.direction.abs().max_element());
        let d = ray.direction / unit;
        let squared = d.length_squared();
        let mut error = arrays::map(place, |x| SHARE * x.high.abs());
        let high = |place: &[Double<f64>; 3]| DVec3::from(arrays::map(*place, |x| x.high));
        let mut total = 0.0;
        let mut is_there = false;
        for _ in 0..STEPS {
            let step = -(high(&place).dot(d) / squared);
            total += step;
            for k in 0..3 {
                let way = product(Scalar, step, d[k]);
                let moved = sum(Scalar, place[k].high, way.high);
                place[k] = sum(Scalar, moved.high, moved.low + (place[k].low + way.low));
                error[k] += SHARE * way.high.abs();
            }
            is_there = step.abs() < 0.1 + 1e-12 * high(&place).length();
            if is_there {
                break;
            }
        }
        if !is_there {
            return Self::Somewhere;
        }
        if total < 0.0 && ray.t_min >= 0.0 {
            return Self::Past;
        }
        let nearest = high(&place);
        let error = DVec3::from(error);
        if !(nearest.is_finite() && error.is_finite()) {
            return Self::Somewhere;
        }
        let direction = d / d.abs().max_element();
        // An error along the ray does no harm: the place stays on the ray, and near the tree. Only
        // its part across counts.
        let main = (0..3).find(|&k| direction[k].abs() == 1.0);
        let along = main.map_or(f64::INFINITY, |main| error[main]);
        let across = (0..3).filter(|&k| Some(k) != main);
        let off = across.map(|k| error[k] + along * direction[k].abs());
        let off = off.fold(0.0, f64::max);
        // The tree is in the cube from -1 to 1, and that in a sphere.
        if nearest.length() > BALL + 4.0 * error.max_element() {
            return Self::Past;
        }
        if off > 1e-4 {
            return Self::Somewhere;
        }
        let origin = (nearest - 4.0 * direction) * space.unscale + space.origin;
        Self::Near(Ray::new(origin, ray.direction), off)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::mesh_tree::MeshTree;
    use crate::accel::traverse::each::EachCandidate;
    use crate::accel::traverse::single::Scratch;
    use crate::shape::{Mesh, Positions};
    use crate::simd::{self, InstructionSet};

    /// The number of triangles that a ray asks.
    fn asked(tree: &MeshTree, mesh: &Mesh, ray: &Ray) -> usize {
        let mut count = 0;
        let each = EachCandidate {
            scratch: &mut Scratch::default(),
            at_mesh: (tree, mesh.into()),
            ray,
            off: 0.0,
            with_copies: false,
            visit: &mut |_, t_max| {
                count += 1;
                t_max
            },
        };
        simd::run(InstructionSet::Portable, each);
        count
    }

    /// A sheet of 2 * 60 * 60 triangles from -1 to 1, at a height that no number is.
    #[test]
    fn a_ray_from_far_away_asks_what_it_may_meet() {
        let place = |k: u32| f64::from(k) / 30.0 - 1.0;
        let points = (0..61 * 61).map(|k| [place(k % 61), place(k / 61), 0.1]);
        let cell = |k: u32| {
            let a = k / 60 * 61 + k % 60;
            [[a, a + 1, a + 61], [a + 1, a + 62, a + 61]]
        };
        let triangles = (0..60 * 60).flat_map(cell).collect();
        let mesh = Mesh::new(Positions::Double(points.collect()), triangles).unwrap();
        let tree = MeshTree::build(&mesh);
        for far in [1e10, 1e14, 1e17, 1e22, 1e25, 1e40, 1e90] {
            let axis = Ray::new(DVec3::new(0.31, 0.23, far), DVec3::NEG_Z);
            let way = DVec3::new(1.0, 0.5, -3.0);
            let aimed = Ray::new(-far * way, far * way);
            let away = Ray::new(far * way, far * way);
            let past = Ray::new(DVec3::new(far, 0.0, 0.0), DVec3::new(-1.0, 0.1, 0.2));
            // Steps of which no number of float64 has the length; a hardly slanting one; a square
            // that is infinite.
            let along = |d: DVec3| Ray::new(axis.origin, d);
            let thirds = along(DVec3::new(0.0, 0.0, -3.0));
            let tenths = along(DVec3::new(0.0, 0.0, -0.7));
            let slanting = along(DVec3::new(1e-120, 0.0, -3.0));
            let long = along(DVec3::new(0.0, 0.0, -3e155));
            for ray in [thirds, tenths, slanting, long] {
                let asked = asked(&tree, &mesh, &ray);
                assert!((1..=60).contains(&asked), "{ray:?}: {asked}");
            }
            // From 10^26 on, a ray that is not along an axis is not where twice the digits say.
            let most = if far < 1e26 { 60 } else { usize::MAX };
            for (ray, most) in [(axis, 60), (aimed, most), (away, 0), (past, 0)] {
                let asked = asked(&tree, &mesh, &ray);
                assert!(asked <= most, "{ray:?}: {asked}");
                let is_met = most > 0;
                assert!((asked > 0) == is_met, "{ray:?}: {asked}");
            }
        }
    }
}
