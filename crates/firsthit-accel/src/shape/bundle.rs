//! Rays side by side, or one alone: how shapes that are no meshes are intersected is written once
//! for both, so that both come to the same bits.

use super::{Crossing, Shape};
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DMat3, DVec3, Ray};

/// A vector, or one in each lane.
#[doc(hidden)]
pub type Vector<N> = [N; 3];

/// A ray, or one in each lane.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct RayOf<N> {
    pub origin: Vector<N>,
    pub direction: Vector<N>,
    pub t_min: N,
    pub t_max: N,
}

impl From<&Ray> for RayOf<f64> {
    #[inline(always)]
    fn from(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            t_min: ray.t_min,
            t_max: ray.t_max,
        }
    }
}

/// A [`Crossing`], or one in each lane, where there is one.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct CrossingOf<A: Arithmetic> {
    pub is_met: A::Mask,
    pub t: A::Number,
    /// A small whole number.
    pub primitive: A::Number,
}

impl CrossingOf<Scalar> {
    #[inline(always)]
    pub(super) fn single(self) -> Option<Crossing> {
        self.is_met.then(|| crossing(self.t, self.primitive))
    }
}

/// The crossing at `t` with a primitive, which is a whole number.
#[inline(always)]
#[doc(hidden)]
pub fn crossing(t: f64, primitive: f64) -> Crossing {
    #[expect(clippy::cast_possible_truncation, reason = "it is a small whole number")]
    Crossing::at(t, primitive as i32)
}

impl<N: Copy> RayOf<N> {
    /// The lanes in which `t` is between the ray's ends.
    #[inline(always)]
    pub fn holds<A: Arithmetic<Number = N>>(&self, of: A, t: N) -> A::Mask {
        of.lt(self.t_min, t) & of.le(t, self.t_max)
    }

    /// [`Ray::is_valid`].
    #[inline(always)]
    pub fn is_valid<A: Arithmetic<Number = N>>(&self, of: A) -> A::Mask {
        let zero = of.number(0.0);
        let [x, y, z] = self.origin;
        let [u, v, w] = self.direction;
        let far = of.number(Ray::FARTHEST);
        let is_near = of.le(abs(of, x), far) & of.le(abs(of, y), far) & of.le(abs(of, z), far);
        let is_finite = is_finite(of, u) & is_finite(of, v) & is_finite(of, w);
        let is_zero = equal(of, u, zero) & equal(of, v, zero) & equal(of, w, zero);
        let is_ahead = of.lt(zero, self.t_max) | of.lt(self.t_min, zero);
        is_near & is_finite & !is_zero & is_ahead & of.lt(self.t_min, self.t_max)
    }

    /// The points at `t`.
    #[inline(always)]
    pub fn at<A: Arithmetic<Number = N>>(&self, of: A, t: N) -> Vector<N> {
        plus(of, self.origin, times(of, t, self.direction))
    }
}

// Vectors, operation for operation as `DVec3` has them. (No closures: what they do is not inlined
// into kernels.)

#[inline(always)]
#[doc(hidden)]
pub fn splat<A: Arithmetic>(of: A, v: DVec3) -> Vector<A::Number> {
    [of.number(v.x), of.number(v.y), of.number(v.z)]
}

#[inline(always)]
pub(crate) fn dot<A: Arithmetic>(of: A, a: Vector<A::Number>, b: Vector<A::Number>) -> A::Number {
    let [x, y, z] = product(of, a, b);
    of.add(of.add(x, y), z)
}

#[inline(always)]
#[doc(hidden)]
pub fn squared<A: Arithmetic>(of: A, a: Vector<A::Number>) -> A::Number {
    dot(of, a, a)
}

/// Component by component.
#[inline(always)]
pub(crate) fn product<A: Arithmetic>(
    of: A,
    a: Vector<A::Number>,
    b: Vector<A::Number>,
) -> Vector<A::Number> {
    [of.mul(a[0], b[0]), of.mul(a[1], b[1]), of.mul(a[2], b[2])]
}

#[inline(always)]
#[doc(hidden)]
pub fn plus<A: Arithmetic>(of: A, a: Vector<A::Number>, b: Vector<A::Number>) -> Vector<A::Number> {
    [of.add(a[0], b[0]), of.add(a[1], b[1]), of.add(a[2], b[2])]
}

#[inline(always)]
#[doc(hidden)]
pub fn minus<A: Arithmetic>(
    of: A,
    a: Vector<A::Number>,
    b: Vector<A::Number>,
) -> Vector<A::Number> {
    [of.sub(a[0], b[0]), of.sub(a[1], b[1]), of.sub(a[2], b[2])]
}

#[inline(always)]
#[doc(hidden)]
pub fn times<A: Arithmetic>(of: A, factor: A::Number, v: Vector<A::Number>) -> Vector<A::Number> {
    product(of, [factor; 3], v)
}

/// A matrix times a vector.
#[inline(always)]
#[doc(hidden)]
pub fn turned<A: Arithmetic>(of: A, by: &DMat3, v: Vector<A::Number>) -> Vector<A::Number> {
    let x = times(of, v[0], splat(of, by.x_axis));
    let y = times(of, v[1], splat(of, by.y_axis));
    let z = times(of, v[2], splat(of, by.z_axis));
    plus(of, plus(of, x, y), z)
}

// Numbers.

/// `-x`, of zero too.
#[inline(always)]
pub(crate) fn negative<A: Arithmetic>(of: A, x: A::Number) -> A::Number {
    of.mul(of.number(-1.0), x)
}

#[inline(always)]
pub(crate) fn abs<A: Arithmetic>(of: A, x: A::Number) -> A::Number {
    of.max(negative(of, x), x)
}

#[inline(always)]
pub(crate) fn equal<A: Arithmetic>(of: A, a: A::Number, b: A::Number) -> A::Mask {
    of.le(a, b) & of.le(b, a)
}

#[inline(always)]
pub(crate) fn is_finite<A: Arithmetic>(of: A, x: A::Number) -> A::Mask {
    of.le(abs(of, x), of.number(f64::MAX))
}

/// The lanes in which the sign is that of -1, which zero can have too.
#[inline(always)]
pub(super) fn has_minus<A: Arithmetic>(of: A, x: A::Number) -> A::Mask {
    let zero = of.number(0.0);
    let is_below = of.lt(x, zero);
    let is_zero = equal(of, x, zero);
    if of.is_anywhere(is_zero) {
        is_below | (is_zero & of.lt(of.div(of.number(1.0), x), zero))
    } else {
        is_below
    }
}

/// The smaller one; the other where one is NaN.
#[inline(always)]
pub(super) fn smaller<A: Arithmetic>(of: A, a: A::Number, b: A::Number) -> A::Number {
    of.select(of.lt(a, b) | !of.le(b, b), a, b)
}

/// The larger one; the other where one is NaN.
#[inline(always)]
pub(super) fn larger<A: Arithmetic>(of: A, a: A::Number, b: A::Number) -> A::Number {
    of.select(of.lt(b, a) | !of.le(b, b), a, b)
}

impl Shape {
    /// [`Surface::intersect`](super::Surface::intersect) of rays side by side; `None` for a mesh.
    #[doc(hidden)]
    #[inline(always)]
    pub fn first_of_bundle<A: Arithmetic>(
        &self,
        of: A,
        ray: &RayOf<A::Number>,
    ) -> Option<CrossingOf<A>> {
        Some(match self {
            Self::Mesh(_) => return None,
            Self::Sphere(sphere) => sphere.first(of, ray),
            Self::Plane(plane) => plane.first(of, ray),
            Self::Disc(disc) => disc.first(of, ray),
            Self::Box(cuboid) => cuboid.first(of, ray),
            Self::Cylinder(cylinder) => cylinder.cone().first(of, ray),
            Self::Cone(cone) => cone.first(of, ray),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::arithmetic::{PairOfMasks, Pairs};
    use crate::shape::Surface;

    fn side_by_side(one: &Ray, other: &Ray) -> RayOf<[f64; 2]> {
        let vector = |a: DVec3, b: DVec3| [[a.x, b.x], [a.y, b.y], [a.z, b.z]];
        RayOf {
            origin: vector(one.origin, other.origin),
            direction: vector(one.direction, other.direction),
            t_min: [one.t_min, other.t_min],
            t_max: [one.t_max, other.t_max],
        }
    }

    /// Rays from all around, from within, from far away and along the axes, some of them with ends.
    fn rays() -> Vec<Ray> {
        let step = |k: u32, axis: usize| {
            let roots = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0];
            (f64::from(k) * roots[axis].sqrt()).fract() - 0.5
        };
        let vector = |k, axis| DVec3::new(step(k, axis), step(k, axis + 1), step(k, axis + 2));
        let each = |k: u32| {
            let origin = [1.0, 8.0, 300.0, 1e7][k as usize % 4] * vector(k, 0);
            let way = 3.0 * vector(k, 3) - origin;
            let axis = DVec3::AXES[k as usize % 3];
            let ray = match k % 7 {
                0 => Ray::new(origin, axis),
                1 => Ray::new(origin * (DVec3::ONE - axis), -axis),
                2 => Ray::new(origin, way * (DVec3::ONE - axis)),
                // Past or through what is in the middle.
                3 => Ray::new(axis, axis - origin),
                _ => Ray::new(origin, way),
            };
            match k % 5 {
                0 => ray.up_to(1.0),
                1 => ray.beyond(0.9),
                2 => ray.beyond(-2.0),
                _ => ray,
            }
        };
        (0..4000).map(each).filter(Ray::is_valid).collect()
    }

    #[test]
    fn rays_side_by_side_meet_what_each_meets_alone() {
        let (rays, mut met) = (rays(), 0);
        for shape in Shape::examples() {
            for (k, one) in rays.iter().enumerate() {
                // Pairs that have something in common, and such that have nothing.
                let other = &rays[[k + 4, 7 * k + 3][k % 2] % rays.len()];
                let ray = side_by_side(one, other);
                let of = Pairs(Scalar);
                let PairOfMasks(valid) = ray.is_valid(of);
                assert_eq!(valid, [true; 2]);
                let Some(found) = shape.first_of_bundle(of, &ray) else {
                    continue;
                };
                for (lane, ray) in [one, other].into_iter().enumerate() {
                    let expected = shape.intersect(ray).map(|it| (it.t.to_bits(), it.primitive));
                    let found = found.is_met.0[lane].then(|| {
                        let it = crossing(found.t[lane], found.primitive[lane]);
                        (it.t.to_bits(), it.primitive)
                    });
                    assert_eq!(found, expected, "{shape:?} {ray:?}");
                    met += usize::from(found.is_some());
                }
            }
        }
        assert!(met > 10_000, "{met}");
    }
}
