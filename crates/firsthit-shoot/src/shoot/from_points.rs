//! A ray from each of some points, whose crossings tell what is around the point.

use crate::geometry::{DVec3, Ray, Rays};

/// Along no axis, no diagonal and no plane of frequent models, so that few rays meet edges or go
/// along faces; with few digits, so that determinants are mostly certain in float64.
const DIRECTION: DVec3 = DVec3::new(0.4375, 0.625, 0.65625);

/// See [the module](self).
pub(crate) struct FromPoints<'a, P>(pub(crate) &'a [P]);

impl<P: Copy + Into<DVec3> + Sync> Rays for FromPoints<'_, P> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn ray(&self, index: usize) -> Ray {
        Ray::new(self.0[index].into(), DIRECTION)
    }
}
