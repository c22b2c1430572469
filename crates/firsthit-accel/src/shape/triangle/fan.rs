//! Rays that leave an edge or a corner of an open mesh: do they go into one of the triangles around
//! it?
//!
//! In a face the ray's direction tells: against the normal it goes through the face. At an edge or
//! a corner there are several faces, and a ray that leaves one of them may be under another, which
//! it meets nowhere but at its start. A ray from a little above would be stopped by that. So is
//! this one:
//!
//! 1. Seen from the point P, each triangle around it is an arc on the sphere of directions, from
//!    one of its edges to the other. At an edge it is half a circle, taken as two arcs.
//! 2. Take the shortest way from the ray's direction to the arc of the triangle T that is left. It
//!    comes to one of the two sides of T, and each arc that it crosses on the way is a change of
//!    sides.
//! 3. So it is known on which side of the whole surface the ray continues. On the side where it
//!    starts it is free.
//! 4. On the other side it is stopped, if it could have started from any of the triangles: if it is
//!    in front of one of them. A ray that goes against all of them is meant to go through, as in a
//!    face. (One in front of all of them is free, and both are told apart first.)
//!
//! The signs of determinants decide, without rounding. Where one is zero, the way ends a little
//! beside the end of T's arc, and then the direction is moved a little to the side where the ray
//! starts.
//!
//! Plain float64 is sure of all signs for most rays (`fan/plain.rs`).
//!
//! At the mesh's boundary the arcs do not close, and the answer is that of the shortest way.

mod plain;

use super::DeparturePoint;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{Double, DoubleVector, between};
use crate::geometry::exact::{Scaled, determinant};
use crate::geometry::{DVec3, Side, arrays};

/// The most triangles around a corner among which the one that stops a ray is searched.
const MANY: usize = 64;

/// A part of a triangle as seen from the point, from one direction to another, counter-clockwise in
/// front of the triangle.
struct Arc {
    ends: [DoubleVector<f64>; 2],
}

/// The triangles that hold a point.
#[doc(hidden)]
pub struct Fan {
    /// The numbers of the triangles and their corners.
    pub triangles: Vec<(u32, [DVec3; 3])>,
    /// Whether no two triangles of the mesh go along an edge in one direction, and every edge has a
    /// length.
    pub is_of_one_way: bool,
}

impl DeparturePoint {
    /// The triangle that stops a ray at its start, the one with the lowest number, of the `fan`
    /// around the point. The ray starts on a side of the triangle that it leaves.
    pub fn stopped_by(&self, direction: DVec3, side: Side, fan: &Fan) -> Option<u32> {
        let outwards = if side == Side::Front { 1.0 } else { -1.0 };
        if let Some(found) = self.plainly_stopped_by(direction, outwards, fan) {
            return found;
        }
        if self.is_plainly_free(outwards * direction, fan) {
            return None;
        }
        self.exactly_stopped_by(direction, outwards, fan)
    }

    /// The triangle that stops a ray, by exact signs.
    #[cold]
    #[inline(never)]
    fn exactly_stopped_by(&self, direction: DVec3, outwards: f64, fan: &Fan) -> Option<u32> {
        let d = plain(direction);
        let height = |arc: &Arc| outwards * sign(&arc.ends[0], &arc.ends[1], &d);
        let around = &fan.triangles;
        let is_other = |(_, corners): &&(u32, [DVec3; 3])| !self.has_corners_of(corners);
        let own = self.arcs(self.corners);
        let mut others = Vec::with_capacity(2 * around.len());
        let mut heights = Vec::with_capacity(2 * around.len());
        for &(_, corners) in around.iter().filter(is_other) {
            for arc in self.arcs(corners).into_iter().flatten() {
                heights.push(height(&arc));
                others.push(arc);
            }
        }
        let own_height = height(own[0].as_ref()?);
        let own: Vec<&Arc> = own.iter().flatten().collect();
        let is_any_above = heights.iter().any(|&height| height > 0.0);
        let is_above_all = own_height > 0.0 && heights.iter().all(|&height| height > 0.0);
        if (own_height < 0.0 && !is_any_above) || (is_above_all && self.face_one_way(fan)) {
            return None;
        }
        let level = heights.iter().zip(&others);
        let level = level.filter(|(height, _)| **height == 0.0);
        let mut level = level.map(|(_, arc)| arc).chain(own.iter().copied());
        if level.any(|arc| arc.has(&d, direction)) {
            return None;
        }
        let [from, to] = &own[0].ends;
        let way = ShortestArc {
            direction: &d,
            ends: [from, to],
            upwards: &plain(outwards * around_one(from).cross(around_one(to))),
        };
        let crossed = others.iter().filter(|arc| way.crosses(arc)).count();
        let is_under_own = own_height < 0.0;
        let is_inside = is_under_own != (crossed % 2 == 1);
        if !is_inside || (is_under_own && !self.face_one_way(fan)) {
            return None;
        }
        let is_under = |&&(_, corners): &&(u32, [DVec3; 3])| {
            let [arc, _] = self.arcs(corners);
            arc.is_some_and(|arc| height(&arc) < 0.0)
        };
        let number = |&(number, _): &(u32, _)| number;
        let under = around.iter().filter(is_under).map(number).min();
        under.or_else(|| around.iter().map(number).min())
    }

    /// Whether plain float64 says that a ray goes against all of the triangles, or is in front of
    /// all and they face one way.
    fn is_plainly_free(&self, direction: DVec3, fan: &Fan) -> bool {
        let mut heights = fan.triangles.iter().map(|(_, corners)| {
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
        !is_above || self.face_one_way(fan)
    }

    /// Whether a triangle has the same corners as the one that is left, in any order.
    fn has_corners_of(&self, corners: &[DVec3; 3]) -> bool {
        let [p, q, r] = corners;
        let mut own = self.corners.iter();
        own.all(|own| p == own || q == own || r == own)
    }

    /// Whether neighbours face one way: no two triangles have an edge at the point in one
    /// direction. Not with too many triangles.
    fn face_one_way(&self, fan: &Fan) -> bool {
        let around = &fan.triangles;
        if around.len() > MANY {
            return false;
        }
        if fan.is_of_one_way {
            return true;
        }
        let is_here = |corner: DVec3| {
            let mut own = self.corners.iter().zip(self.has_weight);
            own.any(|(own, has_weight)| has_weight && *own == corner)
        };
        let edges = |k: usize| {
            let (_, corners) = around[k];
            (0..3).map(move |k| (corners[k], corners[(k + 1) % 3]))
        };
        let is_again = |k: usize| {
            let mut here = edges(k).filter(|&(p, q)| is_here(p) || is_here(q));
            here.any(|edge| (0..k).any(|l| edges(l).any(|other| other == edge)))
        };
        !(1..around.len()).any(is_again)
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
            let ends = [*from, *to];
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
    fn has(&self, d: &DoubleVector<f64>, direction: DVec3) -> bool {
        let [from, to] = &self.ends;
        if sign(from, to, d) != 0.0 {
            return false;
        }
        let (from, to) = (around_one(from), around_one(to));
        let normal = from.cross(to);
        normal.dot(from.cross(direction)) >= 0.0 && normal.dot(direction.cross(to)) >= 0.0
    }
}

/// The shortest way from a direction to a point of an arc that is next to its beginning.
struct ShortestArc<'a> {
    direction: &'a DoubleVector<f64>,
    ends: [&'a DoubleVector<f64>; 2],
    /// The direction of the perturbation of `direction`.
    upwards: &'a DoubleVector<f64>,
}

impl ShortestArc<'_> {
    fn crosses(&self, arc: &Arc) -> bool {
        let [from, to] = &arc.ends;
        let p = self.side(from);
        if p == 0.0 || p * self.side(to) >= 0.0 {
            return false;
        }
        let [begin, next] = self.ends;
        let start = not_zero(&[self.direction, self.upwards].map(|of| move || sign(from, to, of)));
        p * start < 0.0
            && start * not_zero(&[begin, next].map(|of| move || sign(from, to, of))) < 0.0
    }

    /// The side of the way on which a direction is.
    fn side(&self, of: &DoubleVector<f64>) -> f64 {
        let [begin, next] = self.ends;
        let [d, up] = [self.direction, self.upwards];
        not_zero(
            &[(d, begin), (d, next), (up, begin), (up, next)].map(|(p, q)| move || sign(p, q, of)),
        )
    }
}

/// The first that is not zero, if any is not; those after it are not computed.
fn not_zero<const N: usize>(signs: &[impl Fn() -> f64; N]) -> f64 {
    let mut signs = signs.iter().map(|sign| sign());
    signs.find(|&sign| sign != 0.0).unwrap_or(0.0)
}

/// The sign of a determinant: in float64 where that is sure of it.
fn sign(p: &DoubleVector<f64>, q: &DoubleVector<f64>, r: &DoubleVector<f64>) -> f64 {
    let (a, b, c) = (high(p), high(q), high(r));
    let value = a.dot(b.cross(c));
    // Each of six products is rounded at most eight times, and so are its factors.
    let [x, y, z] = c.abs().to_array();
    let [u, v, w] = b.abs().to_array();
    let size = a.abs().dot(DVec3::new(v * z + w * y, w * x + u * z, u * y + v * x));
    // Within these nothing that is too small for float64 matters.
    let is_moderate = size > 1e-200 && a.abs().max_element() < 1e90;
    if is_moderate && value.abs() > 16.0 * f64::EPSILON * size {
        return value.signum();
    }
    // Neighbours share an edge, which exact arithmetic would take long for.
    if are_along(p, q) || are_along(q, r) || are_along(p, r) {
        return 0.0;
    }
    let value = determinant(&Scaled::new(p), &Scaled::new(q), &Scaled::new(r)).high;
    if value == 0.0 { 0.0 } else { value.signum() }
}

/// Whether two vectors are the same, or opposite.
fn are_along(p: &DoubleVector<f64>, q: &DoubleVector<f64>) -> bool {
    let low = |v: &DoubleVector<f64>| DVec3::new(v[0].low, v[1].low, v[2].low);
    let (one, other) = ((high(p), low(p)), (high(q), low(q)));
    one == other || one == (-other.0, -other.1)
}

fn plain(v: DVec3) -> DoubleVector<f64> {
    arrays::map(v.to_array(), |high| Double { high, low: 0.0 })
}

fn high(v: &DoubleVector<f64>) -> DVec3 {
    DVec3::new(v[0].high, v[1].high, v[2].high)
}

/// The vector scaled to a length around 1, so that no product is too small.
fn around_one(v: &DoubleVector<f64>) -> DVec3 {
    high(&Scaled::new(v).vector)
}

fn minus(x: Double<f64>) -> Double<f64> {
    Double { high: -x.high, low: -x.low }
}
