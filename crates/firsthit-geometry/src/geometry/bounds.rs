use super::{DAffine3, DVec3, Ray, arrays};

/// An axis-aligned box, both corners part of it.
///
/// ```
/// use firsthit::{Bounds, DVec3};
///
/// let bounds = Bounds::of([DVec3::ZERO, DVec3::new(4.0, -2.0, 1.0)]);
/// assert_eq!(bounds.size(), DVec3::new(4.0, 2.0, 1.0));
/// assert_eq!(bounds.centre(), DVec3::new(2.0, -1.0, 0.5));
/// assert!(bounds.contains(DVec3::X));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub low: DVec3,
    /// The corner with the largest coordinates.
    pub high: DVec3,
}

impl Bounds {
    /// The box that holds nothing, and leaves any other as it is in a union.
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
    /// All of space.
    pub const EVERYTHING: Self = Self { low: DVec3::NEG_INFINITY, high: DVec3::INFINITY };

    /// The smallest box around `points`.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| Self {
            low: bounds.low.min(point),
            high: bounds.high.max(point),
        })
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Whether nothing is inside.
    pub fn is_empty(&self) -> bool {
        !self.low.cmple(self.high).all()
    }

    /// Whether all corners are at finite coordinates (an infinite plane's box is not).
    pub fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Whether a ray may pass within `margin` of the box, from its origin, or where it begins if
    /// that is before, up to its end. False only for a certain miss.
    #[inline]
    #[doc(hidden)]
    pub fn may_be_met(&self, ray: &Ray, margin: f64) -> bool {
        let inverse = ray.direction.recip();
        let low = (self.low - margin - ray.origin) * inverse;
        let high = (self.high + margin - ray.origin) * inverse;
        let (mut enters, mut leaves) = (ray.t_min.min(0.0), ray.t_max);
        for (a, b) in low.to_array().into_iter().zip(high.to_array()) {
            // A ray along a face gives NaN: this axis says nothing then.
            if !a.is_nan() && !b.is_nan() {
                enters = enters.max(a.min(b));
                leaves = leaves.min(a.max(b));
            }
        }
        // Beside the box, along an axis in which it does not go, it enters at infinity.
        enters <= leaves + 1e-12 * leaves.abs() && enters < f64::INFINITY
    }

    /// Whether `point` is inside or on the border.
    pub fn contains(&self, point: DVec3) -> bool {
        self.low.cmple(point).all() && point.cmple(self.high).all()
    }

    /// The middle.
    #[inline]
    pub fn centre(&self) -> DVec3 {
        0.5 * self.low + 0.5 * self.high
    }

    /// The lengths of the sides; zero when empty.
    #[inline]
    pub fn size(&self) -> DVec3 {
        (self.high - self.low).max(DVec3::ZERO)
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        arrays::from_fn(|k| {
            let pick = |axis: usize| {
                if k >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] }
            };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// A box around the transformed box; empty stays empty, and infinite becomes everything.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        if self.is_empty() {
            Self::EMPTY
        } else if self.is_finite() {
            Self::of(arrays::map(self.corners(), |corner| transform.transform_point3(corner)))
        } else {
            Self::EVERYTHING
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays to points of the box may meet it, along its faces too; those that go by do not.
    #[test]
    fn no_ray_that_meets_a_box_is_left_out() {
        let bounds = Bounds::of([DVec3::new(-1.0, 0.0, 2.0), DVec3::new(3.0, 0.5, 2.0)]);
        let mut misses = 0;
        for k in 0..1000_u32 {
            // Steps by square roots of primes are spread evenly.
            let step = |axis: usize| [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0][axis].sqrt();
            let u = |axis: usize| (f64::from(k) * step(axis)).fract();
            let target = bounds.low + DVec3::new(u(0), u(1), u(2)) * bounds.size();
            let origin = 6.0 * DVec3::new(u(3), u(4), u(5)) - 2.0;
            let there = Ray::new(origin, target - origin);
            assert!(bounds.may_be_met(&there, 0.0));
            let along = DVec3::new(bounds.low.x, origin.y, bounds.low.z);
            let along = Ray::new(along, DVec3::new(0.0, 0.25 - along.y, 0.0));
            assert!(bounds.may_be_met(&along, 0.0));
            let back = Ray::new(origin, origin - target);
            misses += u32::from(!bounds.may_be_met(&back, 0.0));
            // It begins behind its origin, and so far that it meets the box; or it ends too early.
            let begins = Ray { t_min: -1.5, ..back };
            assert!(bounds.may_be_met(&begins, 0.0));
            let gap = bounds.low.max(origin.min(bounds.high)) - origin;
            let least = gap.length() / there.direction.length();
            assert!(least == 0.0 || !bounds.may_be_met(&there.up_to(0.5 * least), 0.0));
        }
        assert!(misses > 900, "{misses}");
        let beside = Ray::new(DVec3::new(0.0, 1.0, 0.0), DVec3::Z);
        assert!(!bounds.may_be_met(&beside, 0.4) && bounds.may_be_met(&beside, 0.6));
        let ray = Ray::new(DVec3::ONE, DVec3::X);
        assert!(Bounds::EVERYTHING.may_be_met(&ray, 0.0));
    }
}
