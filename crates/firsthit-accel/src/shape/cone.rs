//! The cone: a round body whose radius changes evenly along its axis.

mod inside;

use super::{Crossing, Nearest, Surface, similarity, sines};
use crate::error::Result;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::{
    Bounds, DVec2, DVec3, Digest, Ray, Transform, require, require_finite, unit,
};

/// A round body that tapers along its axis, with its lids: a cone, a cone with its tip cut off, or
/// (see [`Cylinder`](super::Cylinder)) a cylinder. Its primitives: 0 the side, 1 the bottom, 2 the
/// top.
///
/// ```
/// use firsthit::{Cone, DVec3};
///
/// let pointed = Cone::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 2.0), 1.0, 0.0)?;
/// let cup = Cone::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 2.0), 0.7, 1.0)?;
/// assert!(pointed.top_radius() < cup.top_radius());
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    bottom: DVec3,
    top: DVec3,
    axis: DVec3,
    height: f64,
    bottom_radius: f64,
    top_radius: f64,
}

impl Cone {
    /// The cone around the axis from `bottom` to `top`; a `top_radius` of zero gives it a tip.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a `top` at the `bottom`, a negative
    /// radius, two radii of zero, and numbers that are not finite.
    pub fn new(bottom: DVec3, top: DVec3, bottom_radius: f64, top_radius: f64) -> Result<Self> {
        require_finite("bottom", bottom)?;
        require_finite("top", top)?;
        for (name, radius) in [("bottom_radius", bottom_radius), ("top_radius", top_radius)] {
            let fine = radius >= 0.0 && radius.is_finite();
            require(name, "zero or positive, and finite", fine, radius)?;
        }
        let is_wide = bottom_radius != 0.0 || top_radius != 0.0;
        let expected = "positive where top_radius is zero";
        require("bottom_radius", expected, is_wide, bottom_radius)?;
        require("top", "another point than bottom", top != bottom, top)?;
        let axis = unit(top - bottom);
        Ok(Self { bottom, top, axis, height: (top - bottom).dot(axis), bottom_radius, top_radius })
    }

    /// The lower end of its axis.
    pub fn bottom(&self) -> DVec3 {
        self.bottom
    }

    /// The upper end of its axis.
    pub fn top(&self) -> DVec3 {
        self.top
    }

    /// The radius at the bottom.
    pub fn bottom_radius(&self) -> f64 {
        self.bottom_radius
    }

    /// The radius at the top.
    pub fn top_radius(&self) -> f64 {
        self.top_radius
    }

    /// The growth of the radius along the axis.
    #[inline(always)]
    fn slope(&self) -> f64 {
        (self.top_radius - self.bottom_radius) / self.height
    }
}

impl Surface for Cone {
    fn bounds(&self) -> Bounds {
        let sines = sines(self.axis);
        let lid = |center: DVec3, radius: f64| Bounds {
            low: center - radius * sines,
            high: center + radius * sines,
        };
        lid(self.bottom, self.bottom_radius).union(lid(self.top, self.top_radius))
    }

    /// The larger support of the two lids, whose convex hull the cone is.
    fn support(&self, direction: DVec3) -> f64 {
        let across = direction.cross(self.axis).length();
        let lid = |center: DVec3, radius: f64| center.dot(direction) + radius * across;
        lid(self.bottom, self.bottom_radius).max(lid(self.top, self.top_radius))
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        self.first(Scalar, &ray.into()).single()
    }

    fn crossings(&self, ray: &Ray) -> [Option<Crossing>; 2] {
        self.along(Scalar, &ray.into()).crossings(ray)
    }

    #[inline(always)]
    fn normal(&self, point: DVec3, primitive: i32) -> DVec3 {
        match primitive {
            1 => -self.axis,
            2 => self.axis,
            _ => {
                let at = point - self.bottom;
                let across = at - at.dot(self.axis) * self.axis;
                // The tip has no normal: any will do.
                let outwards = if across == DVec3::ZERO {
                    self.axis.any_orthonormal_vector()
                } else {
                    unit(across)
                };
                unit(outwards - self.slope() * self.axis)
            }
        }
    }

    #[inline(always)]
    fn onto(&self, point: DVec3, primitive: i32) -> DVec3 {
        let at = point - self.bottom;
        let z = at.dot(self.axis);
        let across = at - z * self.axis;
        match primitive {
            1 => self.bottom + across.clamp_length_max(self.bottom_radius),
            2 => self.bottom + self.height * self.axis + across.clamp_length_max(self.top_radius),
            _ => {
                let z = z.clamp(0.0, self.height);
                let radius = self.bottom_radius + self.slope() * z;
                let outwards = if across == DVec3::ZERO { DVec3::ZERO } else { unit(across) };
                self.bottom + (z * self.axis + radius * outwards)
            }
        }
    }

    /// Measures in the half-plane through the axis and the point, where the side and the lids are
    /// segments.
    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        let Some(scale) = similarity(&place.world_from_object().matrix3) else {
            return;
        };
        let bottom = place.point_in_world(self.bottom);
        let axis = unit(place.point_in_world(self.top) - bottom);
        let height = scale * self.height;
        let [bottom_radius, top_radius] = [self.bottom_radius, self.top_radius].map(|r| scale * r);
        let at = from - bottom;
        let z = at.dot(axis);
        let across = at - z * axis;
        let r = across.length();
        // On the axis all directions are equally far.
        let outwards = if r == 0.0 { axis.any_orthonormal_vector() } else { unit(across) };
        let mut show = |to: DVec2, primitive| {
            let squared = (to - DVec2::new(r, z)).length_squared();
            let point = bottom + (to.y * axis + to.x * outwards);
            visit(Nearest::apart(squared, point, primitive));
        };
        let (low, high) = (DVec2::new(bottom_radius, 0.0), DVec2::new(top_radius, height));
        let side = high - low;
        let share = (DVec2::new(r, z) - low).dot(side) / side.length_squared();
        show(low + share.clamp(0.0, 1.0) * side, 0);
        for (lid, primitive) in [(low, 1), (high, 2)] {
            // A tip is part of the side.
            if lid.x > 0.0 {
                show(DVec2::new(r.min(lid.x), lid.y), primitive);
            }
        }
    }

    fn digest(&self, digest: &mut Digest) {
        digest.vector(self.bottom);
        digest.vector(self.top);
        digest.numbers(&[self.bottom_radius, self.top_radius]);
    }
}

#[cfg(test)]
impl super::conformance::Conforming for Cone {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap(),
            Self::new(DVec3::new(0.0, 1.0, 0.0), DVec3::new(2.0, 2.0, -1.0), 0.2, 0.9).unwrap(),
            Self::new(DVec3::ZERO, DVec3::new(0.1, 0.0, 0.0), 3.0, 2.0).unwrap(),
        ]
    }

    /// The distance in the half-plane through the axis, where the cone is a polygon with three
    /// sides that count.
    fn distance(&self, point: DVec3) -> f64 {
        let at = point - self.bottom;
        let z = at.dot(self.axis);
        let r = (at - z * self.axis).length();
        let to = |(r0, z0): (f64, f64), (r1, z1): (f64, f64)| {
            let along = ((r - r0) * (r1 - r0) + (z - z0) * (z1 - z0))
                / ((r1 - r0) * (r1 - r0) + (z1 - z0) * (z1 - z0));
            let along = if along.is_nan() { 0.0 } else { along.clamp(0.0, 1.0) };
            (r - r0 - along * (r1 - r0)).hypot(z - z0 - along * (z1 - z0))
        };
        let (bottom, top) = ((self.bottom_radius, 0.0), (self.top_radius, self.height));
        let distance = to(bottom, top).min(to((0.0, 0.0), bottom)).min(to((0.0, self.height), top));
        let inside = z > 0.0 && z < self.height && r < self.bottom_radius + self.slope() * z;
        if inside { -distance } else { distance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first crossing of a ray with a cone, and its primitive.
    fn met(cone: &Cone, origin: DVec3, direction: DVec3) -> Option<(f64, i32)> {
        let hit = cone.intersect(&Ray::new(origin, direction))?;
        Some((hit.t, hit.primitive))
    }

    #[test]
    fn a_ray_from_the_tip_leaves_through_the_lid() {
        let cone = Cone::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap();
        for direction in [DVec3::NEG_Z, DVec3::new(0.1, 0.05, -1.0)] {
            assert_eq!(met(&cone, DVec3::Z, direction), Some((2.0, 1)));
        }
    }

    #[test]
    fn the_tip_is_part_of_the_side() {
        let cone = Cone::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap();
        let met = met(&cone, 3.0 * DVec3::Z, DVec3::NEG_Z);
        assert_eq!(met, Some((2.0, 0)));
    }

    #[test]
    fn a_wire_is_as_thick_as_it_is() {
        for radius in [1e-4, 1e-8, 1e-12] {
            let wire = Cone::new(DVec3::ZERO, 100.0 * DVec3::Z, radius, radius).unwrap();
            // The ray passes the axis at `gap`, 300 away from its start and 70 from the bottom.
            let at = |gap: f64| Ray::new(DVec3::new(-300.0, gap, 70.0), DVec3::X);
            assert!(wire.intersect(&at(1.001 * radius)).is_none(), "{radius}");
            let hit = wire.intersect(&at(0.6 * radius)).unwrap();
            let t = 300.0 - 0.8 * radius;
            assert!((hit.t - t).abs() <= 2.0 * t * f64::EPSILON, "{radius} {}", hit.t);
        }
    }

    #[test]
    fn the_mirror_image_beyond_the_tip_is_not_there() {
        let cone = Cone::new(DVec3::ZERO, DVec3::Z, 1.0, 0.0).unwrap();
        for (x, z, direction, expected) in [
            (-5.0, 1.5, DVec3::X, None),
            (-5.0, 0.5, DVec3::X, Some((4.5, 0))),
            (0.25, 5.0, DVec3::NEG_Z, Some((4.25, 0))),
            (0.25, -5.0, DVec3::Z, Some((5.0, 1))),
        ] {
            assert_eq!(met(&cone, DVec3::new(x, 0.0, z), direction), expected);
        }
    }
}
