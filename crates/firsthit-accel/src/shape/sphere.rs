//! The sphere.

use super::bundle::{
    CrossingOf, RayOf, dot, has_minus, larger, minus, negative, plus, smaller, splat, squared,
    times,
};
use super::interval::{End, Interval};
use super::nearest::{Nearest, Principal, onto_ellipse, similarity};
use super::{Crossing, Surface};
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{
    Bounds, DVec3, Digest, Ray, Transform, require_finite, require_positive, unit,
};

/// All points at `radius` from `center`.
///
/// ```
/// use firsthit::{DVec3, Sphere};
///
/// let sphere = Sphere::new(DVec3::new(0.0, 0.0, 1.0), 2.0)?;
/// assert_eq!((sphere.center(), sphere.radius()), (DVec3::Z, 2.0));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Sphere {
    /// The sphere around `center`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a radius that is not positive and for
    /// numbers that are not finite.
    pub fn new(center: DVec3, radius: f64) -> Result<Self> {
        Ok(Self {
            center: require_finite("center", center)?,
            radius: require_positive("radius", radius)?,
        })
    }

    /// The centre.
    #[inline]
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The radius.
    #[inline]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The stretch of rays inside.
    ///
    /// Stable roots: Haines, Günther and Akenine-Möller, "Precision Improvements for Ray/Sphere
    /// Intersection", Ray Tracing Gems (2019), chapter 7.
    #[inline(always)]
    fn inside<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> Interval<A> {
        let from_center = minus(of, ray.origin, splat(of, self.center));
        let radius_squared = of.number(self.radius * self.radius);
        let a = squared(of, ray.direction);
        let b = negative(of, dot(of, from_center, ray.direction));
        let c = of.sub(squared(of, from_center), radius_squared);
        // From the line's closest point, not from b * b - a * c, which far away is all rounding.
        let closest = plus(of, from_center, times(of, of.div(b, a), ray.direction));
        let discriminant = of.sub(radius_squared, squared(of, closest));
        let is_there = !of.lt(discriminant, of.number(0.0));
        if !of.is_anywhere(is_there) {
            return Interval::line(of).only(is_there);
        }
        let root = of.sqrt(of.mul(a, discriminant));
        let q = of.select(has_minus(of, b), of.sub(b, root), of.add(b, root));
        let (t0, t1) = (of.div(c, q), of.div(q, a));
        let primitive = of.number(0.0);
        let enter = End { t: smaller(of, t0, t1), primitive };
        let exit = End { t: larger(of, t0, t1), primitive };
        Interval::new(of, is_there, [enter, exit])
    }

    /// The first crossings of rays with the sphere.
    #[inline(always)]
    pub(super) fn first<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> CrossingOf<A> {
        self.inside(of, ray).first(ray)
    }
}

impl Surface for Sphere {
    fn bounds(&self) -> Bounds {
        Bounds { low: self.center - self.radius, high: self.center + self.radius }
    }

    fn support(&self, direction: DVec3) -> f64 {
        self.center.dot(direction) + self.radius * direction.length()
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        self.first(Scalar, &ray.into()).single()
    }

    fn crossings(&self, ray: &Ray) -> [Option<Crossing>; 2] {
        self.inside(Scalar, &ray.into()).crossings(ray)
    }

    #[inline(always)]
    fn normal(&self, point: DVec3, _primitive: i32) -> DVec3 {
        unit(point - self.center)
    }

    #[inline(always)]
    fn onto(&self, point: DVec3, _primitive: i32) -> DVec3 {
        self.center + self.radius * unit(point - self.center)
    }

    /// Measures to the ellipsoid that the transform makes, where it stretches.
    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        let center = place.point_in_world(self.center);
        let away = from - center;
        let map = &place.world_from_object().matrix3;
        if let Some(scale) = similarity(map) {
            let (radius, length) = (scale * self.radius, away.length());
            // From the middle all points are equally far.
            let outwards = if length == 0.0 { DVec3::X } else { unit(away) };
            let height = length - radius;
            return visit(Nearest::apart(height * height, center + radius * outwards, 0));
        }
        let columns = [map.x_axis, map.y_axis, map.z_axis];
        let ellipsoid = Principal::new(columns.map(|column| self.radius * column));
        let nearest = onto_ellipse(ellipsoid.lengths, ellipsoid.coordinates(away));
        visit(Nearest::at(center + ellipsoid.vector(nearest), from, 0));
    }

    fn digest(&self, digest: &mut Digest) {
        digest.vector(self.center);
        digest.numbers(&[self.radius]);
    }
}

#[cfg(test)]
impl super::conformance::Conforming for Sphere {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(DVec3::ZERO, 1.0).unwrap(),
            Self::new(DVec3::new(-3.0, 0.5, 2.0), 0.7).unwrap(),
        ]
    }

    fn distance(&self, point: DVec3) -> f64 {
        (point - self.center).length() - self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The classic formula loses all digits here: b * b and a * c agree in their first 20.
    #[test]
    fn a_ray_from_ten_million_radii_away_finds_the_nearest_point() {
        let sphere = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let ray = Ray::new(DVec3::new(-1e7, 0.6, 0.0), DVec3::X);
        let t = sphere.intersect(&ray).unwrap().t;
        assert!((t - (1e7 - 0.8)).abs() < 4e-9, "{t}");
    }
}
