//! Rays that leave an edge or a corner of an open mesh: do they go into one of the triangles around it?
//!
//! In a face the ray's direction tells: against the normal it goes through the face. At an edge or a corner there are several faces, and a
//! ray that leaves one of them may be under another, which it meets nowhere but at its start. A ray from a little above would be stopped
//! by that. So is this one:
//!
//! 1. Seen from the point P, each triangle around it is an arc on the sphere of directions, from one of its edges to the other. At an
//!    edge it is half a circle, taken as two arcs.
//! 2. Take the shortest way from the ray's direction to the arc of the triangle T that is left. It comes to one of the two sides of T, and
//!    each arc that it crosses on the way is a change of sides.
//! 3. So it is known on which side of the whole surface the ray goes on. On the side where it starts it is free.
//! 4. On the other side it is stopped, if it could have started from any of the triangles: if it is in front of one of them. A ray that
//!    goes against all of them is meant to go through, as in a face.
//!
//! The signs of determinants decide, without rounding. Where one is zero, the way ends a little beside the end of T's arc, and then the
//! direction is moved a little to the side where the ray starts.
//!
//! At the mesh's boundary the arcs do not close, and the answer is that of the shortest way.

use super::DeparturePoint;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{Double, DoubleVector, between};
use crate::geometry::exact::{Scaled, determinant};
use crate::geometry::{DVec3, Side};

/// With more triangles around a corner nobody asks which of them the ray is in front of.
const MANY: usize = 64;

/// A part of a triangle as seen from the point, from one direction to another, counter-clockwise in front of the triangle.
struct Arc {
    ends: [Scaled; 2],
}

/// A triangle that holds the point: its number and its corners.
pub(crate) type Around = (u32, [DVec3; 3]);

impl DeparturePoint {
    /// The triangle that stops a ray at its start, the one with the lowest number, of those `around` the point. The ray starts on a side of
    /// the triangle that it leaves.
    pub(crate) fn stopped_by(
        &self,
        direction: DVec3,
        side: Side,
        around: &[Around],
    ) -> Option<u32> {
        let outwards = if side == Side::Front { 1.0 } else { -1.0 };
        let own = self.arcs(self.corners);
        let [from, to] = &own.first()?.ends;
        let is_other =
            |(_, corners): &&Around| !self.corners.iter().all(|own| corners.contains(own));
        let others: Vec<Arc> = (around.iter().filter(is_other))
            .flat_map(|&(_, corners)| self.arcs(corners))
            .collect();
        let d = scaled(direction);
        let normal = outwards * high(from).cross(high(to));
        let way = Way {
            direction: &d,
            ends: [from, to],
            upwards: &scaled(normal),
        };
        if own.iter().chain(&others).any(|arc| arc.has(&d, direction)) {
            return None;
        }
        let height = outwards * sign(from, to, &d);
        let is_under_own = height < 0.0;
        let crossed = others.iter().filter(|arc| way.crosses(arc)).count();
        let is_inside = is_under_own != (crossed % 2 == 1);
        let is_above = |arc: &Arc| outwards * sign(&arc.ends[0], &arc.ends[1], &d) > 0.0;
        let could_start =
            || others.len() <= MANY && face_one_way(&own, &others) && others.iter().any(is_above);
        if !is_inside || (is_under_own && !could_start()) {
            return None;
        }
        let is_under = |&&(_, corners): &&Around| {
            let arcs = self.arcs(corners);
            arcs.first()
                .is_some_and(|arc| outwards * sign(&arc.ends[0], &arc.ends[1], &d) < 0.0)
        };
        let number = |&(number, _): &Around| number;
        let under = around.iter().filter(is_under).map(number).min();
        under.or_else(|| around.iter().map(number).min())
    }

    /// A triangle that holds the point, as seen from there.
    fn arcs(&self, corners: [DVec3; 3]) -> Vec<Arc> {
        let own = self.corners.iter().zip(self.has_weight);
        let mut own = own.filter_map(|(corner, has_weight)| has_weight.then_some(corner));
        let place = |corner| corners.iter().position(|other| other == corner);
        let Some(first) = own.next().and_then(place) else {
            return Vec::new();
        };
        let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
        let arc = |ends: [DoubleVector<f64>; 2]| Arc {
            ends: ends.map(|end| Scaled::new(&end)),
        };
        let from_a = |corner: DVec3| between(Scalar, &corner.to_array(), &a.to_array());
        match own.next().and_then(place) {
            None => vec![arc([from_a(b), from_a(c)])],
            // It has no area.
            Some(second) if second == first => Vec::new(),
            Some(second) => {
                // From the edge's one end over the third corner to its other end.
                let third = corners[3 - first - second];
                let edge = from_a(corners[second]);
                let (over, back) = (from_a(third), edge.map(minus));
                if third == c {
                    vec![arc([edge, over]), arc([over, back])]
                } else {
                    vec![arc([over, edge]), arc([back, over])]
                }
            }
        }
    }
}

impl Arc {
    /// Whether a direction is on it.
    fn has(&self, d: &Scaled, direction: DVec3) -> bool {
        let [from, to] = &self.ends;
        if sign(from, to, d) != 0.0 {
            return false;
        }
        let (from, to) = (high(from), high(to));
        let normal = from.cross(to);
        normal.dot(from.cross(direction)) >= 0.0 && normal.dot(direction.cross(to)) >= 0.0
    }
}

/// The shortest way from a direction to a point of an arc that is next to its beginning.
struct Way<'a> {
    direction: &'a Scaled,
    ends: [&'a Scaled; 2],
    /// Where the direction is moved a little.
    upwards: &'a Scaled,
}

impl Way<'_> {
    fn crosses(&self, arc: &Arc) -> bool {
        let [from, to] = &arc.ends;
        let [p, q] = [self.side(from), self.side(to)];
        let [begin, next] = self.ends;
        let start = not_zero([sign(from, to, self.direction), sign(from, to, self.upwards)]);
        let end = not_zero([sign(from, to, begin), sign(from, to, next)]);
        p * q < 0.0 && start * end < 0.0 && p * start < 0.0
    }

    /// On which side of the way a direction is.
    fn side(&self, of: &Scaled) -> f64 {
        let [begin, next] = self.ends;
        let [d, up] = [self.direction, self.upwards];
        not_zero(
            [sign(d, begin, of), sign(d, next, of)]
                .into_iter()
                .chain([sign(up, begin, of), sign(up, next, of)]),
        )
    }
}

/// The first that is not zero, if any is not.
fn not_zero(signs: impl IntoIterator<Item = f64>) -> f64 {
    signs.into_iter().find(|&sign| sign != 0.0).unwrap_or(0.0)
}

/// Whether neighbours face the same side: no two arcs begin, or end, in one direction.
fn face_one_way(own: &[Arc], others: &[Arc]) -> bool {
    let all: Vec<&Arc> = own.iter().chain(others).collect();
    let is_twice = |k: usize| {
        (0..k).any(|l| {
            let of_both = |end: usize| {
                high(&all[k].ends[end]) * all[k].ends[end].unit
                    == high(&all[l].ends[end]) * all[l].ends[end].unit
            };
            of_both(0) || of_both(1)
        })
    };
    !(1..all.len()).any(is_twice)
}

/// The sign of a determinant, or a number with it.
fn sign(p: &Scaled, q: &Scaled, r: &Scaled) -> f64 {
    let value = determinant(p, q, r).high;
    if value == 0.0 { 0.0 } else { value.signum() }
}

fn scaled(v: DVec3) -> Scaled {
    Scaled::new(&v.to_array().map(|high| Double { high, low: 0.0 }))
}

fn high(v: &Scaled) -> DVec3 {
    DVec3::from(v.vector.map(|part| part.high))
}

fn minus(x: Double<f64>) -> Double<f64> {
    Double {
        high: -x.high,
        low: -x.low,
    }
}
