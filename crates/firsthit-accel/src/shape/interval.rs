//! A convex solid along a ray: one stretch of the ray is inside.
//!
//! A solid that is the common part of simpler ones is cut out of the ray part by part. The rest
//! is a stretch with two ends, or nothing: so there is no seam between a lid and a side to slip
//! through.

use super::Crossing;
use super::bundle::{CrossingOf, RayOf, crossing, equal, is_finite};
use crate::geometry::Ray;
use crate::geometry::arithmetic::{Arithmetic, Scalar};

/// An end of an interval, where a line enters or leaves, and the part of the surface there: a small
/// whole number.
#[derive(Debug, Clone, Copy)]
pub(super) struct End<N> {
    pub(super) t: N,
    pub(super) primitive: N,
}

impl<N: Copy> End<N> {
    #[inline(always)]
    fn select<A: Arithmetic<Number = N>>(of: A, mask: A::Mask, a: Self, b: Self) -> Self {
        Self { t: of.select(mask, a.t, b.t), primitive: of.select(mask, a.primitive, b.primitive) }
    }
}

/// The stretch inside, where there is one.
#[derive(Clone, Copy)]
pub(super) struct Interval<A: Arithmetic> {
    of: A,
    /// The lanes in which the line is not known to miss the solid; the stretch may be empty there
    /// too.
    is_there: A::Mask,
    enter: End<A::Number>,
    exit: End<A::Number>,
}

impl<A: Arithmetic> Interval<A> {
    /// The whole line.
    #[inline(always)]
    pub(super) fn line(of: A) -> Self {
        let primitive = of.number(f64::from(i32::MAX));
        let is_there = of.lt(of.number(0.0), of.number(1.0));
        let enter = End { t: of.number(f64::NEG_INFINITY), primitive };
        let exit = End { t: of.number(f64::INFINITY), primitive };
        Self::new(of, is_there, [enter, exit])
    }

    /// The interval from one end to the other, in the lanes of the mask.
    #[inline(always)]
    pub(super) fn new(of: A, is_there: A::Mask, [enter, exit]: [End<A::Number>; 2]) -> Self {
        Self { of, is_there, enter, exit }
    }

    /// The rest of the interval from `t` on in the lanes of a mask, `primitive` being the surface
    /// there; on a tie the lower one stays.
    #[inline(always)]
    pub(super) fn from(mut self, mask: A::Mask, t: A::Number, primitive: A::Number) -> Self {
        let Self { of, enter, .. } = self;
        let ties = equal(of, t, enter.t) & of.lt(primitive, enter.primitive);
        let is_later = mask & (of.lt(enter.t, t) | ties);
        self.enter = End::select(of, is_later, End { t, primitive }, enter);
        self
    }

    /// The rest of the interval up to `t`.
    #[inline(always)]
    pub(super) fn until(mut self, mask: A::Mask, t: A::Number, primitive: A::Number) -> Self {
        let Self { of, exit, .. } = self;
        let ties = equal(of, t, exit.t) & of.lt(primitive, exit.primitive);
        let is_sooner = mask & (of.lt(t, exit.t) | ties);
        self.exit = End::select(of, is_sooner, End { t, primitive }, exit);
        self
    }

    /// The rest of the interval between the planes where a coordinate is `low` and `high`, each
    /// with its primitive; the ray has the coordinate `at` at its start and `speed` along. The rest
    /// is empty where the ray runs beside them.
    #[inline(always)]
    pub(super) fn between(
        self,
        [low, high]: [(f64, i32); 2],
        at: A::Number,
        speed: A::Number,
    ) -> Self {
        let of = self.of;
        let zero = of.number(0.0);
        let is_beside = equal(of, speed, zero);
        let planes = [of.number(low.0), of.number(high.0)];
        let is_within = of.le(planes[0], at) & of.le(at, planes[1]);
        let low =
            End { t: of.div(of.sub(planes[0], at), speed), primitive: of.number(f64::from(low.1)) };
        let high = End {
            t: of.div(of.sub(planes[1], at), speed),
            primitive: of.number(f64::from(high.1)),
        };
        let is_upwards = of.lt(zero, speed);
        let near = End::select(of, is_upwards, low, high);
        let far = End::select(of, is_upwards, high, low);
        let left =
            self.from(!is_beside, near.t, near.primitive).until(!is_beside, far.t, far.primitive);
        left.only(!is_beside | is_within)
    }

    /// The interval in the lanes of a mask alone.
    #[inline(always)]
    pub(super) fn only(mut self, mask: A::Mask) -> Self {
        self.is_there = self.is_there & mask;
        self
    }

    /// Whether anything may be inside anywhere.
    #[inline(always)]
    pub(super) fn is_anywhere(&self) -> bool {
        let Self { of, enter, exit, .. } = self;
        of.is_anywhere(self.is_there & !of.lt(exit.t, enter.t))
    }

    /// The length of the interval; negative if it is empty.
    #[inline(always)]
    pub(super) fn length(&self) -> A::Number {
        self.of.sub(self.exit.t, self.enter.t)
    }

    /// One where a mask says so, the other elsewhere.
    #[inline(always)]
    pub(super) fn select(mask: A::Mask, one: Self, other: Self) -> Self {
        let of = one.of;
        Self {
            of,
            is_there: (mask & one.is_there) | (!mask & other.is_there),
            enter: End::select(of, mask, one.enter, other.enter),
            exit: End::select(of, mask, one.exit, other.exit),
        }
    }

    /// Multiplies both ends by `unit`, and drops an empty stretch.
    #[inline(always)]
    pub(super) fn scaled(mut self, unit: A::Number) -> Self {
        let of = self.of;
        self = self.only(!of.lt(self.exit.t, self.enter.t));
        self.enter.t = of.mul(self.enter.t, unit);
        self.exit.t = of.mul(self.exit.t, unit);
        self
    }

    /// Adds `start` to both ends, and drops an empty stretch.
    #[inline(always)]
    pub(super) fn moved(mut self, start: A::Number) -> Self {
        let of = self.of;
        self = self.only(!of.lt(self.exit.t, self.enter.t));
        self.enter.t = of.add(self.enter.t, start);
        self.exit.t = of.add(self.exit.t, start);
        self
    }

    /// The first end that the ray holds. Where both are at the same `t` (the ray touches an edge),
    /// that with the lower primitive.
    #[inline(always)]
    pub(super) fn first(self, ray: &RayOf<A::Number>) -> CrossingOf<A> {
        let Self { of, is_there, enter, exit } = self;
        let is_touched = equal(of, enter.t, exit.t) & of.lt(exit.primitive, enter.primitive);
        let enter = End::select(of, is_touched, exit, enter);
        let is_first = ray.holds(of, enter.t) & is_finite(of, enter.t);
        let is_second = ray.holds(of, exit.t) & is_finite(of, exit.t);
        let End { t, primitive } = End::select(of, is_first, enter, exit);
        CrossingOf { is_met: is_there & (is_first | is_second), t, primitive }
    }
}

impl Interval<Scalar> {
    /// The ends that the ray holds.
    pub(super) fn crossings(self, ray: &Ray) -> [Option<Crossing>; 2] {
        [self.enter, self.exit].map(|end| {
            let is_held = self.is_there && ray.holds(end.t) && end.t.is_finite();
            is_held.then(|| crossing(end.t, end.primitive))
        })
    }
}
