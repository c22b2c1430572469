//! The box along the axes.

use super::bundle::{CrossingOf, RayOf};
use super::interval::Interval;
use super::{Crossing, Nearest, Surface, nearest_on_lone_triangle};
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{Bounds, DVec3, Digest, Ray, Transform, require, require_finite};

/// A box, its sides along the axes. Its primitives are its faces: 0 to 5 for -x, +x, -y, +y, -z,
/// +z.
///
/// ```
/// use firsthit::{Cuboid, DVec3};
///
/// let cuboid = Cuboid::new(DVec3::ZERO, DVec3::new(3.0, 2.0, 1.0))?;
/// assert_eq!(cuboid.high(), DVec3::new(3.0, 2.0, 1.0));
/// assert!(Cuboid::new(DVec3::ONE, DVec3::ZERO).is_err());
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    bounds: Bounds,
}

impl Cuboid {
    /// The box between two corners.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) when `high` is not above `low` along
    /// every axis, and for numbers that are not finite.
    pub fn new(low: DVec3, high: DVec3) -> Result<Self> {
        require_finite("low", low)?;
        require_finite("high", high)?;
        let both = format!("{high} (low is {low})");
        require("high", "above low along every axis", low.cmplt(high).all(), both)?;
        Ok(Self { bounds: Bounds { low, high } })
    }

    /// The lowest corner.
    pub fn low(&self) -> DVec3 {
        self.bounds.low
    }

    /// The highest corner.
    pub fn high(&self) -> DVec3 {
        self.bounds.high
    }

    /// The stretch of rays inside.
    #[inline(always)]
    fn inside<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> Interval<A> {
        let Bounds { low, high } = self.bounds;
        let RayOf { origin, direction, .. } = ray;
        let x = [(low.x, 0), (high.x, 1)];
        let y = [(low.y, 2), (high.y, 3)];
        let z = [(low.z, 4), (high.z, 5)];
        Interval::line(of)
            .between(x, origin[0], direction[0])
            .between(y, origin[1], direction[1])
            .between(z, origin[2], direction[2])
            .moved(of.number(0.0))
    }

    /// The first crossings of rays with the cuboid.
    #[inline(always)]
    pub(super) fn first<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> CrossingOf<A> {
        self.inside(of, ray).first(ray)
    }
}

impl Surface for Cuboid {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn support(&self, direction: DVec3) -> f64 {
        let Bounds { low, high } = self.bounds;
        (low * direction).max(high * direction).element_sum()
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        self.first(Scalar, &ray.into()).single()
    }

    fn crossings(&self, ray: &Ray) -> [Option<Crossing>; 2] {
        self.inside(Scalar, &ray.into()).crossings(ray)
    }

    #[inline(always)]
    fn normal(&self, _point: DVec3, primitive: i32) -> DVec3 {
        let faces = [DVec3::NEG_X, DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_Z, DVec3::Z];
        usize::try_from(primitive)
            .ok()
            .and_then(|face| faces.get(face))
            .copied()
            .unwrap_or(DVec3::NAN)
    }

    #[inline(always)]
    fn onto(&self, mut point: DVec3, primitive: i32) -> DVec3 {
        let Bounds { low, high } = self.bounds;
        if let Ok(face) = usize::try_from(primitive)
            && face < 6
        {
            point[face / 2] = [low, high][face % 2][face / 2];
        }
        point.clamp(low, high)
    }

    /// A face that a transform takes elsewhere is two triangles.
    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        let Bounds { low, high } = self.bounds;
        for (face, primitive) in (0..6_usize).zip(0..) {
            let (axis, level) = (face / 2, [low, high][face % 2][face / 2]);
            if place.is_identity() {
                let mut point = from.clamp(low, high);
                point[axis] = level;
                visit(Nearest::at(point, from, primitive));
                continue;
            }
            let [across, up] = [(axis + 1) % 3, (axis + 2) % 3];
            let corner = |x: DVec3, y: DVec3| {
                let mut corner = DVec3::splat(level);
                (corner[across], corner[up]) = (x[across], y[up]);
                place.point_in_world(corner)
            };
            let around = [(low, low), (high, low), (high, high), (low, high)];
            let [a, b, c, d] = around.map(|(x, y)| corner(x, y));
            let first = nearest_on_lone_triangle(from, [a, b, c], primitive);
            let nearest = first.or(nearest_on_lone_triangle(from, [a, c, d], primitive));
            visit(Nearest::apart(nearest.squared, nearest.point, primitive));
        }
    }

    fn digest(&self, digest: &mut Digest) {
        digest.vector(self.bounds.low);
        digest.vector(self.bounds.high);
    }
}

#[cfg(test)]
impl super::conformance::Conforming for Cuboid {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(-DVec3::ONE, DVec3::ONE).unwrap(),
            Self::new(DVec3::new(0.25, -3.0, 1.0), DVec3::new(0.5, 4.0, 1.1)).unwrap(),
        ]
    }

    fn distance(&self, point: DVec3) -> f64 {
        let beyond = (self.bounds.low - point).max(point - self.bounds.high);
        beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_at_an_edge_meets_the_lower_face() {
        let cuboid = Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap();
        for (origin, direction, expected) in [
            ([-2.0, -2.0, 0.5], [1.0, 1.0, 0.0], (1.0, 0)),
            ([3.0; 3], [-1.0; 3], (2.0, 1)),
            // It enters through face 2 and leaves through face 1, at the same point.
            ([0.0, -2.0, 0.0], [1.0, 1.0, 0.0], (1.0, 1)),
        ] {
            let ray = Ray::new(origin.into(), direction.into());
            let hit = cuboid.intersect(&ray).unwrap();
            assert_eq!((hit.t, hit.primitive), expected);
        }
    }
}
