//! The point of a triangle that is nearest to a point.
//!
//! 1. Is the point above the inside of the triangle? It is where it is on the inner side of all
//!    three edges: the signs of three products of the normal tell. Where rounding could matter,
//!    they are computed in twice the digits.
//! 2. If so, the distance is the height above the plane. Where the triangle is thin, or the point
//!    near the plane, the height is computed in twice the digits.
//! 3. Else it is the smallest of the distances to the edges; of equal ones that to the first
//!    (`segment.rs`).
//!
//! The regions are those of Ericson, "Real-Time Collision Detection" (2005), 5.1.5. It departs in
//! that the numbers have bounds, so that the nearest feature is the exact one, and in that all
//! edges are asked: neighbours agree about theirs.
//!
//! # Error bounds
//!
//! In units of 2^-53.
//!
//! - A normal is off by 6 products of its edges' lengths: 2 for the edges, 1 for each product and 1
//!   for the difference, along each axis. Its product with that of an edge and the way to its end
//!   (off as much) is off by 14 times the product of the four lengths; `SIDE` is twice that.
//! - The height is off by 3 times the way to the corner, and by the normal's tilt times that way.
//!   Step 2 takes float64 where the way times the edges' lengths is at most 4 times their triple
//!   product: then the height is off by less than 40 times itself, and mostly by less than 4.
//! - In twice the digits the normal is off by 2^-102 of the product of its edges' lengths. The
//!   height is off by as much of the way to the corner, divided by the sine between the edges; by
//!   less than 2^-90 of the way. Where the sine may be less than 2^-10 (`NARROW`) the triple
//!   product comes from a determinant without rounding.
//! - A triangle that is thinner than 2^-50 of its longest edge (`THIN`) has no inside: its edges
//!   are at most that far away.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use super::Nearest;
use super::segment::{apart, nearest_on_segment};
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{DoubleVector, cross, dot};
use crate::geometry::exact::{Scaled, determinant, power};
use crate::geometry::{DVec2, DVec3};

/// See the error bounds.
const SIDE: f64 = 14.0 * f64::EPSILON;

/// The square of 2^-50.
const THIN: f64 = 1.0 / (1_u128 << 100) as f64;

/// The square of 2^-10.
const NARROW: f64 = 1.0 / (1_u64 << 20) as f64;

/// The bits of a float64 that hold its exponent.
const EXPONENT: u64 = 0x7ff << 52;

/// The height of a point above a triangle.
struct Height {
    squared: f64,
    /// The weights of corners 1 and 2 of the foot.
    weights: DVec2,
}

/// The point of the triangle `primitive` that is nearest to `from`.
#[inline(always)]
#[doc(hidden)]
pub fn nearest_on_triangle(from: DVec3, corners: [DVec3; 3], primitive: i32) -> Nearest {
    let largest = corners.map(|corner| (corner - from).abs());
    let largest = largest[0].max(largest[1]).max(largest[2]);
    let largest = largest.max_element();
    // Beyond, products of six lengths would leave float64; a power of two brings them back.
    if (largest > 1e-40 && largest < 1e40) || largest == 0.0 {
        return moderate(from, corners, primitive);
    }
    let scale = 1.0 / f64::from_bits(largest.max(f64::MIN_POSITIVE).to_bits() & EXPONENT);
    let scaled = moderate(scale * from, corners.map(|corner| scale * corner), primitive);
    Nearest {
        squared: scaled.squared / scale / scale,
        point: place(corners, scaled.barycentric),
        ..scaled
    }
}

/// [`nearest_on_triangle`], compiled once for all callers that are no kernels: inlined, it is 70 kB
/// of code.
#[inline(never)]
pub(crate) fn nearest_on_lone_triangle(
    from: DVec3,
    corners: [DVec3; 3],
    primitive: i32,
) -> Nearest {
    nearest_on_triangle(from, corners, primitive)
}

#[inline(always)]
fn moderate(from: DVec3, corners: [DVec3; 3], primitive: i32) -> Nearest {
    let found = |squared, weights| Nearest {
        squared,
        point: place(corners, weights),
        primitive,
        barycentric: weights,
    };
    if let Some(Height { squared, weights }) = height(from, corners) {
        return found(squared, weights);
    }
    let [a, b, c] = corners;
    let first = nearest_on_segment(from, a, b);
    let mut nearest = (first.squared, DVec2::new(first.share, 0.0));
    let second = nearest_on_segment(from, b, c);
    if second.squared < nearest.0 {
        nearest = (second.squared, DVec2::new(1.0 - second.share, second.share));
    }
    let third = nearest_on_segment(from, c, a);
    if third.squared < nearest.0 {
        nearest = (third.squared, DVec2::new(0.0, 1.0 - third.share));
    }
    found(nearest.0, nearest.1)
}

/// The point with these weights of corners 1 and 2.
#[inline(always)]
fn place([a, b, c]: [DVec3; 3], weights: DVec2) -> DVec3 {
    let first = 1.0 - weights.x - weights.y;
    // A corner is itself, and an edge's point is not moved off it by the third corner.
    if weights.y == 0.0 {
        return if weights.x == 1.0 { b } else { a + weights.x * (b - a) };
    }
    if weights.x == 0.0 {
        return if weights.y == 1.0 { c } else { a + weights.y * (c - a) };
    }
    if first == 0.0 {
        return b + weights.y * (c - b);
    }
    a + (weights.x * (b - a) + weights.y * (c - a))
}

/// The height above the inside of the triangle; `None` for a point that is not above it.
#[inline(always)]
fn height(from: DVec3, [a, b, c]: [DVec3; 3]) -> Option<Height> {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let (to_a, to_b, to_c) = (a - from, b - from, c - from);
    let normal = ab.cross(-ca);
    let [u, v, w] = [to_b.cross(bc), to_c.cross(ca), to_a.cross(ab)].map(|side| normal.dot(side));
    let size = (ab.length_squared() * ca.length_squared()).sqrt();
    let off = |way: DVec3, edge: DVec3| {
        SIDE * size * (way.length_squared() * edge.length_squared()).sqrt()
    };
    let [of_u, of_v, of_w] = [off(to_b, bc), off(to_c, ca), off(to_a, ab)];
    if u < -of_u || v < -of_v || w < -of_w {
        return None;
    }
    let way = to_a.dot(normal);
    let squared = way * way / normal.length_squared();
    let is_sure = u > of_u && v > of_v && w > of_w;
    // Not divided by the sum of the sides: beside a short edge the third has few digits.
    let sure = is_sure.then(|| clamped(v / normal.length_squared(), w / normal.length_squared()));
    if let Some(weights) = sure.filter(|_| 4.0 * way.abs() >= size * to_a.length()) {
        return Some(Height { squared, weights });
    }
    // A thin triangle's weights have few digits in float64.
    let is_wide = 16.0 * normal.length_squared() >= size * size;
    height_exactly(from, [a, b, c], sure.filter(|_| is_wide))
}

/// Weights that are not negative, and leave none that is for corner 0.
#[inline(always)]
fn clamped(v: f64, w: f64) -> DVec2 {
    let v = v.min(1.0);
    DVec2::new(v, w.min(1.0 - v))
}

/// The height in double-double. The weights may be there already.
#[inline(always)]
fn height_exactly(from: DVec3, [a, b, c]: [DVec3; 3], sure: Option<DVec2>) -> Option<Height> {
    let [ab, bc, ca] = [apart(b, a), apart(c, b), apart(a, c)];
    let normal = cross(Scalar, &ca, &ab);
    let length = DVec3::from(normal.map(|x| x.high)).length_squared();
    let longest = [b - a, c - b, a - c].map(DVec3::length_squared);
    let longest = longest[0].max(longest[1]).max(longest[2]);
    // Not where it is NaN.
    let has_inside = length > THIN * longest * longest;
    if !has_inside {
        return None;
    }
    let weights = match sure {
        Some(weights) => weights,
        None => weights_exactly(from, [(b, &bc), (c, &ca), (a, &ab)], &normal)?,
    };
    let to_a = apart(a, from);
    let way = if length > NARROW * longest * longest {
        dot(Scalar, &to_a, &normal).high
    } else {
        let [p, q, r] = [to_a, apart(b, from), apart(c, from)].map(|way| Scaled::new(&way));
        // It comes times 2^900.
        determinant(&p, &q, &r).high / power(900) * p.unit * q.unit * r.unit
    };
    let distance = way / length.sqrt();
    Some(Height { squared: distance * distance, weights })
}

/// The weights of corners 1 and 2, from the edges opposite the corners, each with the corner that
/// it begins at; `None` for a point that is not above the triangle.
#[inline(always)]
fn weights_exactly(
    from: DVec3,
    edges: [(DVec3, &DoubleVector<f64>); 3],
    normal: &DoubleVector<f64>,
) -> Option<DVec2> {
    let side = |(end, edge)| dot(Scalar, normal, &cross(Scalar, &apart(end, from), edge)).high;
    let [u, v, w] = edges.map(side);
    let is_above = u >= 0.0 && v >= 0.0 && w >= 0.0;
    let sum = u + v + w;
    is_above.then(|| clamped(v / sum, w / sum))
}
