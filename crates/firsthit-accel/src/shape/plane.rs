//! The infinite plane.

use super::bundle::{CrossingOf, RayOf, dot, is_finite, minus, splat};
use super::{Crossing, Nearest, Surface};
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{
    Bounds, DVec3, Digest, Ray, Transform, require_direction, require_finite, unit,
};

/// The infinite plane through a point.
///
/// ```
/// use firsthit::{DVec3, Object, Plane, Scene};
///
/// let ground = Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?);
/// // It has no end: bounds and default cameras leave it out.
/// assert!(Scene::new(vec![ground])?.bounds().is_empty());
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    point: DVec3,
    normal: DVec3,
}

impl Plane {
    /// The plane through `point`, seen from the front against `normal` (of any length but zero).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a normal of length zero and for
    /// numbers that are not finite.
    pub fn new(point: DVec3, normal: DVec3) -> Result<Self> {
        let normal = require_direction("normal", normal)?;
        // One that was made here before keeps its bits: to make a normal of length one of one that
        // is can change it.
        let is_unit = (normal.length_squared() - 1.0).abs() <= 8.0 * f64::EPSILON;
        let normal = if is_unit { normal } else { unit(normal) };
        Ok(Self { point: require_finite("point", point)?, normal })
    }

    /// A point of it.
    #[inline]
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// The direction that the front faces, of length one.
    #[inline]
    pub fn facing(&self) -> DVec3 {
        self.normal
    }

    /// The crossings of rays with the plane.
    #[inline(always)]
    pub(super) fn first<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> CrossingOf<A> {
        let normal = splat(of, self.normal);
        let height = dot(of, minus(of, splat(of, self.point), ray.origin), normal);
        let t = of.div(height, dot(of, ray.direction, normal));
        CrossingOf {
            // Not where `t` is a NaN (the ray runs in the plane) or an infinity (beside it).
            is_met: ray.holds(of, t) & is_finite(of, t),
            t,
            primitive: of.number(0.0),
        }
    }
}

impl Surface for Plane {
    fn bounds(&self) -> Bounds {
        Bounds::EVERYTHING
    }

    fn support(&self, _direction: DVec3) -> f64 {
        f64::INFINITY
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        self.first(Scalar, &ray.into()).single()
    }

    #[inline(always)]
    fn normal(&self, _point: DVec3, _primitive: i32) -> DVec3 {
        self.normal
    }

    #[inline(always)]
    fn onto(&self, point: DVec3, _primitive: i32) -> DVec3 {
        point - (point - self.point).dot(self.normal) * self.normal
    }

    /// A plane stays one under any transform.
    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        let point = place.point_in_world(self.point);
        let normal = place.normal_in_world(self.normal);
        let height = (from - point).dot(normal);
        visit(Nearest::apart(height * height, from - height * normal, 0));
    }

    fn digest(&self, digest: &mut Digest) {
        digest.vector(self.point);
        digest.vector(self.normal);
    }
}

#[cfg(test)]
impl super::conformance::Conforming for Plane {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(DVec3::ZERO, DVec3::Z).unwrap(),
            Self::new(DVec3::new(1.0, -2.0, 0.5), DVec3::new(1.0, 2.0, -0.5)).unwrap(),
        ]
    }

    fn distance(&self, point: DVec3) -> f64 {
        (point - self.point).dot(self.normal)
    }
}
