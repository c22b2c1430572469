//! The disc: a plane within a circle.

use super::bundle::{CrossingOf, RayOf, minus, splat, squared};
use super::nearest::{Nearest, Principal, onto_ellipse, similarity};
use super::plane::Plane;
use super::{Crossing, Surface, sines};
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{Bounds, DVec3, Digest, Ray, Transform, require_positive};

/// The part of a plane within `radius` of `center`.
///
/// ```
/// use firsthit::{DVec3, Disc};
///
/// let disc = Disc::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0), 2.0)?;
/// assert_eq!(disc.facing(), DVec3::Z);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    plane: Plane,
    center: DVec3,
    radius: f64,
}

impl Disc {
    /// The disc around `center`, seen from the front against `normal` (of any length but zero).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a normal of length zero, a radius
    /// that is not positive, and numbers that are not finite.
    pub fn new(center: DVec3, normal: DVec3, radius: f64) -> Result<Self> {
        Ok(Self {
            plane: Plane::new(center, normal)?,
            center,
            radius: require_positive("radius", radius)?,
        })
    }

    /// The centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The direction that the front faces, of length one.
    pub fn facing(&self) -> DVec3 {
        self.plane.facing()
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Disc {
    /// The crossings of rays with the disc.
    #[inline(always)]
    pub(super) fn first<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> CrossingOf<A> {
        let crossing = self.plane.first(of, ray);
        let from_center = minus(of, ray.at(of, crossing.t), splat(of, self.center));
        let radius_squared = of.number(self.radius * self.radius);
        let is_inside = of.le(squared(of, from_center), radius_squared);
        CrossingOf { is_met: crossing.is_met & is_inside, ..crossing }
    }
}

impl Surface for Disc {
    fn bounds(&self) -> Bounds {
        let reach = self.radius * sines(self.plane.normal(self.center, 0));
        Bounds { low: self.center - reach, high: self.center + reach }
    }

    fn support(&self, direction: DVec3) -> f64 {
        let across = direction.cross(self.facing()).length();
        self.center.dot(direction) + self.radius * across
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        self.first(Scalar, &ray.into()).single()
    }

    #[inline(always)]
    fn normal(&self, point: DVec3, primitive: i32) -> DVec3 {
        self.plane.normal(point, primitive)
    }

    #[inline(always)]
    fn onto(&self, point: DVec3, primitive: i32) -> DVec3 {
        self.plane.onto(point, primitive)
    }

    /// Measures to the ellipse that the transform makes, where it stretches.
    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        let center = place.point_in_world(self.center);
        let normal = place.normal_in_world(self.facing());
        let away = from - center;
        let height = away.dot(normal);
        let across = away - height * normal;
        let map = &place.world_from_object().matrix3;
        let rim = if let Some(scale) = similarity(map) {
            let (radius, length) = (scale * self.radius, across.length());
            (length > radius).then(|| radius / length * across)
        } else {
            let (x, y) = self.facing().any_orthonormal_pair();
            let spanned = [x, y, DVec3::ZERO].map(|v| *map * (self.radius * v));
            let Principal { directions: [x, y, _], lengths: [a, b, _] } = Principal::new(spanned);
            let at = [x.dot(across), y.dot(across)];
            let is_beyond = (at[0] / a) * (at[0] / a) + (at[1] / b) * (at[1] / b) > 1.0;
            is_beyond.then(|| {
                let [s, t] = onto_ellipse([a, b], at);
                s * x + t * y
            })
        };
        visit(match rim {
            None => Nearest::apart(height * height, from - height * normal, 0),
            Some(rim) => {
                let squared = height * height + (across - rim).length_squared();
                Nearest::apart(squared, center + rim, 0)
            }
        });
    }

    fn digest(&self, digest: &mut Digest) {
        self.plane.digest(digest);
        digest.vector(self.center);
        digest.numbers(&[self.radius]);
    }
}

#[cfg(test)]
impl super::conformance::Conforming for Disc {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap(),
            Self::new(DVec3::new(1.0, 0.0, -1.0), DVec3::new(3.0, -1.0, 2.0), 2.0).unwrap(),
        ]
    }

    fn distance(&self, point: DVec3) -> f64 {
        let normal = self.plane.normal(point, 0);
        let height = (point - self.center).dot(normal);
        let outside = ((point - self.center - height * normal).length() - self.radius).max(0.0);
        height.hypot(outside)
    }
}
