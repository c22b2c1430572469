//! The passage of a ray by a box, in exact arithmetic.
//!
//! Along each axis the line of the ray is between both sides of the box from one parameter to
//! another. The line meets the box where no axis is left before another is entered. Parameters are
//! quotients; they are compared by products, which are summed without rounding.

use std::cmp::Ordering;

use crate::geometry::exact_sum::ExactSum;
use crate::geometry::{Bounds, Ray};

/// The passage of a ray by a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Passage {
    /// The line does not meet it.
    Missed,
    /// The line meets it only where `t <= t_min`.
    BehindStart,
    /// The line meets it only where `t > t_max`, or later.
    BeyondEnd,
    /// The line meets it only behind the hit.
    BehindHit,
    /// The ray meets it before the hit, or there.
    Met,
}

/// A parameter where the line crosses a plane at right angles to an axis:
/// `(plane - origin) / step`.
#[derive(Clone, Copy)]
struct Crossed {
    plane: f64,
    origin: f64,
    step: f64,
}

impl Crossed {
    /// The order of this parameter to another one. Planes are finite.
    fn compare(self, other: Self) -> Ordering {
        // (p - o) / s  against  (q - r) / u: both times |s u|.
        let (mine, theirs) = (other.step.abs(), self.step.abs());
        let mut sum = ExactSum::ZERO;
        let mut add = |of: Self, sign: f64, factor: f64| {
            let sign = sign * of.step.signum();
            sum.add_two(sign * of.plane, factor);
            sum.add_two(-sign * of.origin, factor);
        };
        add(self, 1.0, mine);
        add(other, -1.0, theirs);
        sum.sign()
    }

    /// The order of this parameter to a number, also an infinite one.
    fn compare_to(self, t: f64) -> Ordering {
        if t == f64::INFINITY {
            return Ordering::Less;
        }
        if t == f64::NEG_INFINITY {
            return Ordering::Greater;
        }
        self.compare(Self { plane: t, origin: 0.0, step: 1.0 })
    }
}

/// The passage of `ray`, which is valid and meets something at `hit`, or at infinity nothing, by a
/// box that is not empty.
pub(super) fn passage(ray: &Ray, bounds: &Bounds, hit: f64) -> Passage {
    let (mut enters, mut leaves) = (Vec::with_capacity(3), Vec::with_capacity(3));
    for axis in 0..3 {
        let (origin, step) = (ray.origin[axis], ray.direction[axis]);
        let (low, high) = (bounds.low[axis], bounds.high[axis]);
        if step == 0.0 {
            if origin < low || origin > high {
                return Passage::Missed;
            }
            continue;
        }
        let (near, far) = if step > 0.0 { (low, high) } else { (high, low) };
        let crossed = |plane: f64| {
            let is_there = plane.is_finite();
            is_there.then_some(Crossed { plane, origin, step })
        };
        enters.extend(crossed(near));
        leaves.extend(crossed(far));
    }
    let is_after = |t: f64| enters.iter().any(|enter| enter.compare_to(t).is_gt());
    let is_missed = |enter: &Crossed| leaves.iter().any(|&leave| enter.compare(leave).is_gt());
    if enters.iter().any(is_missed) {
        Passage::Missed
    } else if leaves.iter().any(|leave| leave.compare_to(ray.t_min).is_le()) {
        Passage::BehindStart
    } else if is_after(ray.t_max) {
        Passage::BeyondEnd
    } else if is_after(hit) {
        Passage::BehindHit
    } else {
        Passage::Met
    }
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::Zero;

    use super::*;
    use crate::geometry::DVec3;

    fn exact(x: f64) -> BigRational {
        BigRational::from_float(x).unwrap()
    }

    /// The reference: clips the ray's range with quotients of rational numbers.
    fn judge(ray: &Ray, bounds: &Bounds, hit: f64) -> Passage {
        let (mut begin, mut end): (Option<BigRational>, Option<BigRational>) = (None, None);
        for axis in 0..3 {
            let (o, d) = (exact(ray.origin[axis]), exact(ray.direction[axis]));
            let (low, high) = (exact(bounds.low[axis]), exact(bounds.high[axis]));
            if d.is_zero() {
                if o < low || o > high {
                    return Passage::Missed;
                }
                continue;
            }
            let (a, b) = ((low - &o) / &d, (high - &o) / &d);
            let (first, last) = if a < b { (a, b) } else { (b, a) };
            begin = Some(begin.map_or(first.clone(), |known| known.max(first)));
            end = Some(end.map_or(last.clone(), |known| known.min(last)));
        }
        let (begin, end) = (begin.unwrap(), end.unwrap());
        let is_after = |t: f64| t < f64::INFINITY && begin > exact(t);
        if begin > end {
            Passage::Missed
        } else if ray.t_min > f64::NEG_INFINITY && end <= exact(ray.t_min) {
            Passage::BehindStart
        } else if is_after(ray.t_max) {
            Passage::BeyondEnd
        } else if is_after(hit) {
            Passage::BehindHit
        } else {
            Passage::Met
        }
    }

    // Few values, so that rays go through edges and corners, along sides, and start and end on
    // them.
    const PLACES: &[f64] = &[-1.0, 0.0, 0.1, 0.3, 1.0, 1.0 + f64::EPSILON, 1e17, 5e-324];
    const STEPS: &[f64] = &[-1.0, 0.0, 0.0, 0.1, 0.3, 1.0, 1e100, 1e-200];
    const ENDS: &[f64] = &[-1.0, 0.0, 0.1, 1.0, 3.0, 10.0, f64::INFINITY];

    #[test]
    fn boxes_are_passed_as_in_rational_arithmetic() {
        let mut state = 3_u64;
        let mut pick = |values: &[f64]| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            values[usize::try_from(state >> 33).unwrap() % values.len()]
        };
        let mut counts = [0; 5];
        for _ in 0..20_000 {
            let mut point = || DVec3::new(pick(PLACES), pick(PLACES), pick(PLACES));
            let (a, b, origin) = (point(), point(), point());
            let direction = DVec3::new(pick(STEPS), pick(STEPS), pick(STEPS));
            let (t_min, t_max) = (pick(&[f64::NEG_INFINITY, -1.0, 0.0, 0.1]), pick(ENDS));
            let ray = Ray::new(origin, direction).beyond(t_min).up_to(t_max);
            let (bounds, hit) = (Bounds::of([a, b]), pick(ENDS));
            if !ray.is_valid() {
                continue;
            }
            let found = passage(&ray, &bounds, hit);
            assert_eq!(found, judge(&ray, &bounds, hit), "{ray:?} {bounds:?} {hit}");
            counts[found as usize] += 1;
        }
        assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
    }
}
