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
//!    goes against all of them is meant to go through, as in a face. (One in front of all of them is free, and both are told apart first.)
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
        if self.is_plainly_free(outwards * direction, around) {
            return None;
        }
        let d = scaled(direction);
        let height = |arc: &Arc| outwards * sign(&arc.ends[0], &arc.ends[1], &d);
        let is_other =
            |(_, corners): &&Around| !self.corners.iter().all(|own| corners.contains(own));
        let own = self.arcs(self.corners);
        let others = around.iter().filter(is_other);
        let others: Vec<Arc> = others
            .flat_map(|&(_, corners)| self.arcs(corners))
            .flatten()
            .collect();
        let own_height = height(own[0].as_ref()?);
        let heights: Vec<f64> = others.iter().map(height).collect();
        let own: Vec<&Arc> = own.iter().flatten().collect();
        let is_any_above = heights.iter().any(|&height| height > 0.0);
        let is_above_all = own_height > 0.0 && heights.iter().all(|&height| height > 0.0);
        if (own_height < 0.0 && !is_any_above) || (is_above_all && self.face_one_way(around)) {
            return None;
        }
        let mut all = own.iter().copied().chain(&others);
        if all.any(|arc| arc.has(&d, direction)) {
            return None;
        }
        let [from, to] = &own[0].ends;
        let way = Way {
            direction: &d,
            ends: [from, to],
            upwards: &scaled(outwards * high(from).cross(high(to))),
        };
        let crossed = others.iter().filter(|arc| way.crosses(arc)).count();
        let is_under_own = own_height < 0.0;
        let is_inside = is_under_own != (crossed % 2 == 1);
        if !is_inside || (is_under_own && !self.face_one_way(around)) {
            return None;
        }
        let is_under = |&&(_, corners): &&Around| {
            let [arc, _] = self.arcs(corners);
            arc.is_some_and(|arc| height(&arc) < 0.0)
        };
        let number = |&(number, _): &Around| number;
        let under = around.iter().filter(is_under).map(number).min();
        under.or_else(|| around.iter().map(number).min())
    }

    /// Whether plain float64 says that a ray goes against all of the triangles, or is in front of all and they face one way. Most do.
    fn is_plainly_free(&self, direction: DVec3, around: &[Around]) -> bool {
        let mut heights = around.iter().map(|(_, corners)| {
            let [a, b, c] = *corners;
            let (e, f) = (b - a, c - a);
            let height = e.cross(f).dot(direction);
            let largest = e.abs().max_element() * f.abs().max_element();
            let unsure = 64.0 * f64::EPSILON * largest * direction.abs().max_element();
            (height.abs() > unsure + f64::MIN_POSITIVE).then_some(height > 0.0)
        });
        let Some(Some(is_above)) = heights.next() else {
            return false;
        };
        if !heights.all(|other| other == Some(is_above)) {
            return false;
        }
        !is_above || self.face_one_way(around)
    }

    /// Whether neighbours face the same side: no two triangles have an edge at the point in one direction. Of too many nobody asks.
    fn face_one_way(&self, around: &[Around]) -> bool {
        let is_here = |corner: DVec3| {
            let mut own = self.corners.iter().zip(self.has_weight);
            own.any(|(own, has_weight)| has_weight && *own == corner)
        };
        let edges = |k: usize| {
            let (_, corners) = around[k];
            let edges = (0..3).map(move |k| (corners[k], corners[(k + 1) % 3]));
            edges.filter(|&(p, q)| is_here(p) || is_here(q))
        };
        let is_again =
            |k: usize| edges(k).any(|edge| (0..k).any(|l| edges(l).any(|other| other == edge)));
        around.len() <= MANY && !(1..around.len()).any(is_again)
    }

    /// A triangle that holds the point, as seen from there.
    fn arcs(&self, corners: [DVec3; 3]) -> [Option<Arc>; 2] {
        let own = self.corners.iter().zip(self.has_weight);
        let mut own = own.filter_map(|(corner, has_weight)| has_weight.then_some(corner));
        let place = |corner| corners.iter().position(|other| other == corner);
        let Some(first) = own.next().and_then(place) else {
            return [None, None];
        };
        let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
        let arc = |from: &DoubleVector<f64>, to: &DoubleVector<f64>| {
            let ends = [from, to].map(Scaled::new);
            Some(Arc { ends })
        };
        let from_a = |corner: DVec3| between(Scalar, &corner.to_array(), &a.to_array());
        match own.next().and_then(place) {
            None => [arc(&from_a(b), &from_a(c)), None],
            // It has no area.
            Some(second) if second == first => [None, None],
            Some(second) => {
                // From the edge's one end over the third corner to its other end.
                let third = corners[3 - first - second];
                let edge = from_a(corners[second]);
                let (over, back) = (from_a(third), edge.map(minus));
                if third == c {
                    [arc(&edge, &over), arc(&over, &back)]
                } else {
                    [arc(&over, &edge), arc(&back, &over)]
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

/// The sign of a determinant: in float64 where that is sure of it.
fn sign(p: &Scaled, q: &Scaled, r: &Scaled) -> f64 {
    let (a, b, c) = (high(p), high(q), high(r));
    let value = a.dot(b.cross(c));
    // Each of six products is rounded at most eight times, and so are its factors.
    let [x, y, z] = c.abs().to_array();
    let [u, v, w] = b.abs().to_array();
    let size = a
        .abs()
        .dot(DVec3::new(v * z + w * y, w * x + u * z, u * y + v * x));
    let value = if value.abs() > 16.0 * f64::EPSILON * size {
        value
    } else {
        determinant(p, q, r).high
    };
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
