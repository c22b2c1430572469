//! Every crossing once: a ray at an edge or corner, and the order of crossings in one place.
//!
//! A ray from `o` is taken for the ray from `o + (e, e^2, e^3)`, for an `e > 0` smaller than every
//! other number. That one meets no edge and no corner, and lies in no triangle's plane: it crosses
//! a closed mesh from outside to inside and back in turn.
//!
//! 1. The side of the edge from `p` to `q` is `det(d, p - o, q - o)`. Where that is zero, its sign
//!    is that of the first of the three numbers `(p - q) x d` that is not zero.
//! 2. Where all three are zero too, the edge is along the ray or has no length: the triangle is not
//!    crossed.
//! 3. Otherwise it is crossed where its sides have one sign.
//! 4. Of two crossings the first is the one with the smaller exact `t = n.R / n.d`. Where these are
//!    equal, the perturbed ones tell, which differ from them by `-(n.(e, e^2, e^3)) / (n.d)`.
//!
//! A crossed triangle is always one that the ray meets where edges belong to both neighbours.
//!
//! Edelsbrunner and Mücke, "Simulation of Simplicity", ACM Transactions on Graphics 9(1), 1990. It
//! departs in what is perturbed: the ray's origin in place of all vertices, so that neighbours
//! agree whatever their indices are.

use std::cmp::Ordering;

use super::exact_sides;
use super::place::Meeting;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::double::{Double, between};
use crate::geometry::exact::{Expansion, Scaled, determinant};

type Vector = [f64; 3];

fn scaled(vector: &Vector) -> Scaled {
    Scaled::new(&vector.map(|high| Double { high, low: 0.0 }))
}

fn unit(axis: usize) -> Scaled {
    let mut vector = [0.0; 3];
    vector[axis] = 1.0;
    scaled(&vector)
}

impl Meeting<f64> {
    /// Whether the perturbed ray crosses the triangle.
    #[cold]
    pub(super) fn is_crossed(&self) -> bool {
        let d = scaled(&self.direction);
        let [u, v, w] = exact_sides(&d, &self.relative());
        let most = u.max(v).max(w);
        let least = u.min(v).min(w);
        if (least < 0.0 && most > 0.0) || (least == 0.0 && most == 0.0) {
            return false;
        }
        let [a, b, c] = &self.corners;
        let is_positive = most > 0.0;
        [(u, c, b), (v, a, c), (w, b, a)].iter().all(|&(side, p, q)| {
            let side = if side == 0.0 { perturbed_side(&d, p, q) } else { side };
            if is_positive { side > 0.0 } else { side < 0.0 }
        })
    }

    /// Whether another triangle has the same corners, in any order.
    pub(crate) fn is_in_place_of(&self, other: &Self) -> bool {
        let is_within = |one: &[Vector; 3], all: &[Vector; 3]| one.iter().all(|p| all.contains(p));
        is_within(&self.corners, &other.corners) && is_within(&other.corners, &self.corners)
    }

    /// The order of this crossing and of another with a crossed triangle of the same ray.
    #[cold]
    pub(crate) fn compare(&self, other: &Self) -> Ordering {
        let d = scaled(&self.direction);
        let start = Scaled::new(&self.relative()[0]);
        let own = Quotients::new(self, &d, start.unit);
        let others = Quotients::new(other, &d, start.unit);
        let compare = |k: usize| {
            Expansion::compare_quotients(
                [&own.numerators[k], &own.denominator],
                [&others.numerators[k], &others.denominator],
            )
        };
        (0..4).map(compare).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    }
}

/// The sign of the first number of `(p - q) x d` that is not zero.
pub(super) fn perturbed_side(d: &Scaled, p: &Vector, q: &Vector) -> f64 {
    let along = Scaled::new(&between(Scalar, p, q));
    (0..3)
        .map(|axis| determinant(&unit(axis), &along, d).high)
        .find(|&number| number != 0.0)
        .unwrap_or(0.0)
}

/// `n.R / n.d`, and `-n.e / n.d` for each axis `e`, as numerators over one denominator; but for a
/// factor that they all have.
struct Quotients {
    numerators: [Expansion; 4],
    denominator: Expansion,
}

impl Quotients {
    fn new(meeting: &Meeting<f64>, d: &Scaled, unit_of_starts: f64) -> Self {
        let [first, second, third] = &meeting.corners;
        let start = Scaled::new(&between(Scalar, first, &meeting.origin));
        let e = Scaled::new(&between(Scalar, second, first));
        let f = Scaled::new(&between(Scalar, third, first));
        let shift = |axis| Expansion::determinant(&e, &f, &unit(axis)).times(-1.0);
        Self {
            numerators: [
                Expansion::determinant(&e, &f, &start).times(start.unit / unit_of_starts),
                shift(0),
                shift(1),
                shift(2),
            ],
            denominator: Expansion::determinant(&e, &f, d),
        }
    }
}
