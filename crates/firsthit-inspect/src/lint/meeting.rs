//! Do two triangles meet in more than what they share? Decided by signs of determinants alone,
//! which are exact.
//!
//! Two triangles meet if an edge of one meets the other. After Guigue and Devillers, "Fast and
//! Robust Triangle-Triangle Overlap Test Using Orientation Predicates", Journal of Graphics Tools
//! 8(1), 2003, with each edge tested by itself:
//!
//! - Without a shared vertex, they meet if one of the six edges meets the other triangle.
//! - With one, what they have in common reaches from it to the opposite edge of one of them, if it
//!   is more than the vertex: so they meet if one of these two edges meets the other triangle.
//! - With two, both are on one side of the shared edge in one plane, or it is all that they have in
//!   common.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use crate::geometry::DVec3;
use crate::geometry::orientation::{orient_2d, orient_3d, projection_axis};

/// A triangle with an area: its corners, and the numbers of their places.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub(super) corners: [DVec3; 3],
    pub(super) places: [u32; 3],
}

/// Whether two triangles meet in more than the vertices and the edge that they share. Not if they
/// share all vertices.
pub(super) fn meet(p: &Face, q: &Face) -> bool {
    let shared = |k: usize| q.places.iter().position(|&place| place == p.places[k]);
    match [0, 1, 2].map(shared) {
        [None, None, None] => meet_anywhere(p, q),
        [Some(l), None, None] => meet_beyond(p, q, [0, l]),
        [None, Some(l), None] => meet_beyond(p, q, [1, l]),
        [None, None, Some(l)] => meet_beyond(p, q, [2, l]),
        [None, Some(l), Some(m)] => are_folded(p, q, [0, 3 - l - m]),
        [Some(l), None, Some(m)] => are_folded(p, q, [1, 3 - l - m]),
        [Some(l), Some(m), None] => are_folded(p, q, [2, 3 - l - m]),
        [Some(_), Some(_), Some(_)] => false,
    }
}

/// The sides of a triangle's plane on which the corners of another are. A corner that they share is
/// in the plane, which would take exact arithmetic to find.
fn sides(of: &Face, corners: &[DVec3; 3], shared: Option<usize>) -> [Ordering; 3] {
    let [a, b, c] = of.corners;
    [0, 1, 2].map(|k| if Some(k) == shared { Equal } else { orient_3d([a, b, c, corners[k]]) })
}

/// Whether all corners but a shared one are on one side.
fn is_apart(sides: [Ordering; 3], shared: Option<usize>) -> bool {
    let mut others = (0..3).filter(|&k| Some(k) != shared).map(|k| sides[k]);
    let first = others.next();
    first.is_some_and(|first| first != Equal && others.all(|side| side == first))
}

/// The sides of each other's planes on which the corners of `p` and of `q` are, if neither is apart
/// from the other's plane. They may share a corner, one of each.
fn crossing_sides(p: &Face, q: &Face, shared: Option<[usize; 2]>) -> Option<[[Ordering; 3]; 2]> {
    let [k, l] = [0, 1].map(|of| shared.map(|shared| shared[of]));
    let of_q = sides(p, &q.corners, l);
    if is_apart(of_q, l) {
        return None;
    }
    let of_p = sides(q, &p.corners, k);
    (!is_apart(of_p, k)).then_some([of_p, of_q])
}

fn meet_anywhere(p: &Face, q: &Face) -> bool {
    crossing_sides(p, q, None).is_some_and(|[of_p, of_q]| {
        (0..3).any(|k| edge_meets(k, p, &of_p, q) || edge_meets(k, q, &of_q, p))
    })
}

/// Whether an edge of one of two triangles goes through the inside of the other.
pub(super) fn cross(p: &Face, q: &Face) -> bool {
    crossing_sides(p, q, None).is_some_and(|[of_p, of_q]| {
        (0..3).any(|k| edge_crosses(k, p, &of_p, q) || edge_crosses(k, q, &of_q, p))
    })
}

/// Triangles with one vertex in common, the corner `k` of `p` and `l` of `q`.
fn meet_beyond(p: &Face, q: &Face, [k, l]: [usize; 2]) -> bool {
    crossing_sides(p, q, Some([k, l])).is_some_and(|[of_p, of_q]| {
        edge_meets((k + 1) % 3, p, &of_p, q) || edge_meets((l + 1) % 3, q, &of_q, p)
    })
}

/// Triangles with an edge in common, opposite to the corner `k` of `p` and `l` of `q`.
fn are_folded(p: &Face, q: &Face, [k, l]: [usize; 2]) -> bool {
    let [a, b] = [p.corners[(k + 1) % 3], p.corners[(k + 2) % 3]];
    let (c, d) = (p.corners[k], q.corners[l]);
    let Some(axis) = projection_axis(&p.corners).filter(|_| orient_3d([a, b, c, d]) == Equal)
    else {
        return false;
    };
    orient_2d([a, b, c], axis) == orient_2d([a, b, d], axis)
}

/// Whether the edge of `p` from the corner `k` on meets `q`; the corners of `p` are on `sides` of
/// the plane of `q`.
fn edge_meets(k: usize, p: &Face, sides: &[Ordering; 3], q: &Face) -> bool {
    let l = (k + 1) % 3;
    let [a, b] = [p.corners[k], p.corners[l]];
    match (sides[k], sides[l]) {
        (Equal, Equal) => edge_meets_in_plane([a, b], q),
        (from, to) if from == to => false,
        _ => {
            let edge = |m: usize| orient_3d([a, b, q.corners[m], q.corners[(m + 1) % 3]]);
            is_inside([0, 1, 2].map(edge))
        }
    }
}

/// Whether the edge of `p` from the corner `k` on goes through the inside of `q`.
fn edge_crosses(k: usize, p: &Face, sides: &[Ordering; 3], q: &Face) -> bool {
    let l = (k + 1) % 3;
    let [a, b] = [p.corners[k], p.corners[l]];
    let edge = |m: usize| orient_3d([a, b, q.corners[m], q.corners[(m + 1) % 3]]);
    let is_parted = sides[k] != Equal && sides[k] == sides[l].reverse();
    is_parted && edge(0) != Equal && edge(1) == edge(0) && edge(2) == edge(0)
}

/// Whether signs are those of what is inside or at the border.
fn is_inside(signs: [Ordering; 3]) -> bool {
    !(signs.contains(&Greater) && signs.contains(&Less))
}

/// Whether an edge in the plane of a triangle meets it.
fn edge_meets_in_plane([a, b]: [DVec3; 2], q: &Face) -> bool {
    let Some(axis) = projection_axis(&q.corners) else {
        return false;
    };
    let sides = |[from, to]: [DVec3; 2], points: [DVec3; 2]| {
        points.map(|point| orient_2d([from, to, point], axis))
    };
    let edges = [0, 1, 2].map(|m| [q.corners[m], q.corners[(m + 1) % 3]]);
    let of_ends = edges.map(|edge| sides(edge, [a, b]));
    if (0..2).any(|end| is_inside(of_ends.map(|of_edge| of_edge[end]))) {
        return true;
    }
    edges.iter().zip(of_ends).any(|(&edge, [of_a, of_b])| {
        let [of_from, of_to] = sides([a, b], edge);
        of_a != of_b && of_from != of_to
    })
}
