//! The cylinder: a cone that does not taper.

use super::{Cone, Crossing, Nearest, Surface};
use crate::error::Result;
use crate::geometry::{Bounds, DVec3, Digest, Ray, Transform, require_positive};

/// A round bar with both lids. Its primitives: 0 the side, 1 the bottom, 2 the top.
///
/// ```
/// use firsthit::{Cylinder, DVec3};
///
/// let bar = Cylinder::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 5.0), 0.1)?;
/// assert_eq!(bar.radius(), 0.1);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// A cone that does not taper is all there is to it.
    cone: Cone,
}

impl Cylinder {
    /// The cylinder around the axis from `bottom` to `top`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a `top` at the `bottom`, a radius
    /// that is not positive, and numbers that are not finite.
    pub fn new(bottom: DVec3, top: DVec3, radius: f64) -> Result<Self> {
        require_positive("radius", radius)?;
        Ok(Self { cone: Cone::new(bottom, top, radius, radius)? })
    }

    /// The lower end of its axis.
    pub fn bottom(&self) -> DVec3 {
        self.cone.bottom()
    }

    /// The upper end of its axis.
    pub fn top(&self) -> DVec3 {
        self.cone.top()
    }

    /// The distance of the side from the axis.
    pub fn radius(&self) -> f64 {
        self.cone.bottom_radius()
    }

    /// The cylinder as a cone.
    #[doc(hidden)]
    pub fn cone(&self) -> &Cone {
        &self.cone
    }
}

impl Surface for Cylinder {
    fn bounds(&self) -> Bounds {
        self.cone.bounds()
    }

    fn support(&self, direction: DVec3) -> f64 {
        self.cone.support(direction)
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        self.cone.intersect(ray)
    }

    fn crossings(&self, ray: &Ray) -> [Option<Crossing>; 2] {
        self.cone.crossings(ray)
    }

    #[inline(always)]
    fn normal(&self, point: DVec3, primitive: i32) -> DVec3 {
        self.cone.normal(point, primitive)
    }

    #[inline(always)]
    fn onto(&self, point: DVec3, primitive: i32) -> DVec3 {
        self.cone.onto(point, primitive)
    }

    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        self.cone.nearest(from, place, visit);
    }

    fn digest(&self, digest: &mut Digest) {
        self.cone.digest(digest);
    }
}

#[cfg(test)]
impl super::conformance::Conforming for Cylinder {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(DVec3::NEG_Z, DVec3::Z, 1.0).unwrap(),
            Self::new(DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, 2.0, 3.0), 0.4).unwrap(),
        ]
    }

    fn distance(&self, point: DVec3) -> f64 {
        super::conformance::Conforming::distance(&self.cone, point)
    }
}
