//! A convex solid along a ray: one stretch of the ray is inside.
//!
//! A solid that is the common part of simpler ones is cut out of the ray part by part. What remains is
//! a stretch with two ends, or nothing: so there is no seam between a lid and a side to slip through.

use super::Crossing;
use crate::geometry::Ray;

/// The stretch inside, each end with the part of the surface where it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    enter: Crossing,
    exit: Crossing,
}

impl Interval {
    /// The whole line.
    pub(super) fn line() -> Self {
        let end = |t| Crossing::at(t, i32::MAX);
        Self {
            enter: end(f64::NEG_INFINITY),
            exit: end(f64::INFINITY),
        }
    }

    /// What is left from `t` on, `primitive` being the surface there; on a tie the lower one stays.
    pub(super) fn from(mut self, t: f64, primitive: i32) -> Self {
        if t > self.enter.t || (t == self.enter.t && primitive < self.enter.primitive) {
            self.enter = Crossing::at(t, primitive);
        }
        self
    }

    /// What is left up to `t`.
    pub(super) fn until(mut self, t: f64, primitive: i32) -> Self {
        if t < self.exit.t || (t == self.exit.t && primitive < self.exit.primitive) {
            self.exit = Crossing::at(t, primitive);
        }
        self
    }

    /// What is left between the planes where a coordinate is `low` and `high`; the ray has the
    /// coordinate `at` at its start and `speed` along. `None` when it runs beside them.
    pub(super) fn between(self, [low, high]: [(f64, i32); 2], at: f64, speed: f64) -> Option<Self> {
        if speed == 0.0 {
            return (low.0 <= at && at <= high.0).then_some(self);
        }
        let [low_t, high_t] = [low, high].map(|(plane, _)| (plane - at) / speed);
        let (near, far) = if speed > 0.0 {
            ((low_t, low.1), (high_t, high.1))
        } else {
            ((high_t, high.1), (low_t, low.1))
        };
        Some(self.from(near.0, near.1).until(far.0, far.1))
    }

    pub(super) fn is_empty(&self) -> bool {
        self.enter.t > self.exit.t
    }

    /// How much of the ray is inside; negative for nothing.
    pub(super) fn length(&self) -> f64 {
        self.exit.t - self.enter.t
    }

    /// Both ends, the interval's zero being at the ray's parameter `start`.
    pub(super) fn ends(self, start: f64) -> Option<[Crossing; 2]> {
        let moved = |end: Crossing| Crossing {
            t: end.t + start,
            ..end
        };
        (!self.is_empty()).then(|| [self.enter, self.exit].map(moved))
    }

    /// The first end that `ray` holds, the interval's zero being at the ray's parameter `start`; where
    /// both ends are at the same `t` (the ray touches an edge), the one with the lower primitive.
    pub(super) fn first(self, start: f64, ray: &Ray) -> Option<Crossing> {
        let [enter, exit] = self.ends(start)?;
        let touches = enter.t == exit.t && exit.primitive < enter.primitive;
        let ends = if touches { [exit; 2] } else { [enter, exit] };
        ends.into_iter()
            .find(|end| ray.holds(end.t) && end.t.is_finite())
    }
}

/// Those of a solid's ends that `ray` holds.
pub(super) fn held(ends: Option<[Crossing; 2]>, ray: &Ray) -> [Option<Crossing>; 2] {
    let ends = ends.map_or([None; 2], |ends| ends.map(Some));
    ends.map(|end| end.filter(|end| ray.holds(end.t) && end.t.is_finite()))
}
