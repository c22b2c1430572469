//! Finds the triangle that stops a ray at its start, by plain float64 where that is sure of every
//! sign.
//!
//! A sign is that of a product `(p x q).r`. Each of its six products of three numbers is rounded at
//! most eight times, and so are its factors: it is off by 24 epsilons of the largest such product.
//! 64 are taken.

use super::{DeparturePoint, Fan};
use crate::geometry::DVec3;

/// Fans of more triangles are rare. They have a bit each.
const FEW: usize = 16;

/// A vector with its largest component.
#[derive(Clone, Copy)]
struct Measured {
    vector: DVec3,
    largest: f64,
}

/// The vectors from the point to the other corners of a triangle.
struct PlainArc {
    corners: [DVec3; 2],
    ends: [Measured; 2],
    normal: Measured,
}

/// The sign of a product, if it is sure.
#[inline(always)]
fn is_positive(p: &Measured, q: &Measured) -> Option<bool> {
    let value = p.vector.dot(q.vector);
    let unsure = 64.0 * f64::EPSILON * p.largest * q.largest;
    // Products of two that are too small for float64 do not matter beside this.
    (unsure > 1e-180 && value.abs() > unsure).then_some(value > 0.0)
}

impl Measured {
    #[inline(always)]
    fn new(vector: DVec3) -> Self {
        let largest = vector.abs().max_element();
        Self { vector, largest }
    }

    /// Itself, if products with it stay in the range of float64.
    #[inline(always)]
    fn moderate(self) -> Option<Self> {
        (self.largest < 1e90).then_some(self)
    }

    /// The cross product; its size is that of what it is computed from. `None` for vectors of which
    /// float64 may not hold all products.
    #[inline(always)]
    fn cross(&self, other: &Self) -> Option<Self> {
        let is_moderate = self.largest < 1e90 && other.largest < 1e90;
        is_moderate.then(|| Self {
            vector: self.vector.cross(other.vector),
            largest: self.largest * other.largest,
        })
    }
}

impl PlainArc {
    /// The arc of a triangle that has the corner `point`.
    #[inline(always)]
    fn new(point: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<Self> {
        let corners = if *a == point {
            [*b, *c]
        } else if *b == point {
            [*c, *a]
        } else {
            [*a, *b]
        };
        let ends = [Measured::new(corners[0] - point), Measured::new(corners[1] - point)];
        let normal = ends[0].cross(&ends[1])?;
        Some(Self { corners, ends, normal })
    }
}

/// The shortest way from a direction to the beginning of an arc, or next to it.
struct PlainWay<'a> {
    own: &'a PlainArc,
    /// The direction times each of the arc's ends.
    sides: [Measured; 2],
}

impl PlainWay<'_> {
    /// The side of the way on which an end of an arc is.
    #[inline(always)]
    fn side(&self, arc: &PlainArc, end: usize) -> Option<bool> {
        let first = is_positive(&self.sides[0], &arc.ends[end]);
        if first.is_none() && arc.corners[end] == self.own.corners[0] {
            return is_positive(&self.sides[1], &arc.ends[end]);
        }
        first
    }

    /// Whether it crosses an arc, on one side of whose plane it starts.
    #[inline(always)]
    fn crosses(&self, arc: &PlainArc, start: bool) -> Option<bool> {
        let from = self.side(arc, 0)?;
        if from == self.side(arc, 1)? || from == start {
            return Some(false);
        }
        let mut end = is_positive(&arc.normal, &self.own.ends[0]);
        if end.is_none() && arc.corners.contains(&self.own.corners[0]) {
            end = is_positive(&arc.normal, &self.own.ends[1]);
        }
        Some(start != end?)
    }
}

impl DeparturePoint {
    /// [`stopped_by`](DeparturePoint::stopped_by) at a corner; `None` where a sign is not sure.
    #[expect(clippy::option_option, reason = "what stops it, if that is sure")]
    pub(super) fn plainly_stopped_by(
        &self,
        direction: DVec3,
        outwards: f64,
        fan: &Fan,
    ) -> Option<Option<u32>> {
        let point = match self.has_weight {
            [true, false, false] => self.corners[0],
            [false, true, false] => self.corners[1],
            [false, false, true] => self.corners[2],
            _ => return None,
        };
        let around = &fan.triangles;
        if around.len() > FEW {
            return None;
        }
        let direction = Measured::new(direction).moderate()?;
        let is_front = outwards > 0.0;
        let own = PlainArc::new(point, &self.corners)?;
        let is_own_above = is_positive(&own.normal, &direction)? == is_front;
        let (mut is_any_above, mut are_all_above) = (is_own_above, is_own_above);
        let [mut lowest, mut lowest_under] = [u32::MAX; 2];
        // Which have other corners than the one that is left, a bit each.
        let mut others = 0_u32;
        for (k, (number, corners)) in around.iter().enumerate() {
            let arc = PlainArc::new(point, corners)?;
            let is_above = is_positive(&arc.normal, &direction)? == is_front;
            if !self.has_corners_of(corners) {
                others |= 1 << k;
                is_any_above |= is_above;
                are_all_above &= is_above;
            }
            lowest = lowest.min(*number);
            if !is_above {
                lowest_under = lowest_under.min(*number);
            }
        }
        if !is_any_above || (are_all_above && self.face_one_way(fan)) {
            return Some(None);
        }
        let way = PlainWay {
            own: &own,
            sides: [direction.cross(&own.ends[0])?, direction.cross(&own.ends[1])?],
        };
        let mut is_inside = !is_own_above;
        for (k, (_, corners)) in around.iter().enumerate() {
            if others >> k & 1 == 0 {
                continue;
            }
            let arc = PlainArc::new(point, corners)?;
            let start = is_positive(&arc.normal, &direction)?;
            is_inside ^= way.crosses(&arc, start)?;
        }
        if !is_inside || (!is_own_above && !self.face_one_way(fan)) {
            return Some(None);
        }
        let stopping = if lowest_under == u32::MAX { lowest } else { lowest_under };
        Some((stopping != u32::MAX).then_some(stopping))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::geometry::DVec2;

    /// Numbers from -1 to 1, some of them of few digits, so that signs are zero at times.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 7_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let x = (state >> 12) as f64 / (1_u64 << 51) as f64 - 1.0;
            if (state >> 40).is_multiple_of(4) { (4.0 * x).round() / 4.0 } else { x }
        }
    }

    #[test]
    fn most_rays_leave_a_vertex_by_plain_float64_and_as_exact_signs_have_it() {
        let mut next = numbers();
        let mut point = || DVec3::new(next(), next(), next());
        let (mut plain, mut stopped, mut all) = (0, 0, 0);
        for round in 0_u32..4000 {
            let tip = point();
            let count = 2 + round % 7;
            let mut rim: Vec<DVec3> = (0..count)
                .map(|k| {
                    let (sin, cos) = libm::sincos(f64::from(k) * TAU / f64::from(count));
                    let round = DVec3::new(cos, sin, 0.0);
                    tip + if round.x == 0.0 { point() } else { round + 0.7 * point() }
                })
                .collect();
            if round % 3 == 0 {
                rim.push(rim[0]);
            }
            let mut triangles: Vec<(u32, [DVec3; 3])> =
                (0..).zip(rim.windows(2)).map(|(k, two)| (k, [tip, two[0], two[1]])).collect();
            let count = u32::try_from(triangles.len()).unwrap();
            for (k, (_, corners)) in triangles.iter_mut().enumerate() {
                corners.rotate_left(k % 3);
                if round % 5 == 1 && k % 2 == 1 {
                    corners.swap(0, 1);
                }
            }
            if round % 4 == 1 {
                let [a, b, c] = triangles[0].1;
                triangles.push((count, [b, a, c]));
            }
            let left = triangles[round as usize % triangles.len()].1;
            let weights = [0, 1, 2].map(|k| f64::from(u8::from(left[k] == tip)));
            let departure = DeparturePoint::new(left, DVec2::new(weights[1], weights[2]));
            let fan = Fan { triangles, is_of_one_way: false };
            for k in 0..4 {
                let direction = if k == 3 { rim[0] - tip } else { point() };
                let outwards = [1.0, -1.0][k % 2];
                let exactly = departure.exactly_stopped_by(direction, outwards, &fan);
                let plainly = departure.plainly_stopped_by(direction, outwards, &fan);
                assert_eq!(plainly.unwrap_or(exactly), exactly, "{round} {k}");
                all += 1;
                plain += u32::from(plainly.is_some());
                stopped += u32::from(exactly.is_some());
            }
        }
        // One of four is along an edge, which no float64 tells.
        assert!(plain > all * 6 / 10 && stopped > all / 20, "{plain} {stopped} {all}");
    }
}
