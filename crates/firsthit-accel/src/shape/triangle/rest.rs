//! Rays that begin at a rounded origin and a rest, as an object that is moved has them.
//!
//! Objects that touch in the world round a ray's origin each in its own way. With the rest, what
//! all of them see is the same ray, so that none passes between them. It decides which triangles
//! are met; where, is computed from the origin alone.
//!
//! # Error bounds
//!
//! A coordinate relative to the origin is off by the rest too: in the bounds of `triangle.rs`, M is
//! larger by 2^53 times the rest. Twice the square of that is nothing beside them: where a side
//! counts as certain, X is more than 20 rests.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use super::{Meeting, Shear};
use crate::geometry::exact_sum::ExactSum;
use crate::geometry::{DVec3, arrays};

impl Shear {
    /// The shear for a ray that begins at its origin and `rest`, which is not more than the origin's
    /// rounding. It decides which triangles are met, not where: that is the origin's.
    #[inline(always)]
    #[doc(hidden)]
    pub fn with_rest(self, rest: DVec3) -> Self {
        Self { rest, ..self }
    }

    /// The largest coordinate that the sides are computed from, as far as their errors go.
    #[inline(always)]
    pub(super) fn largest_with_rest(&self, largest: f64) -> f64 {
        if self.rest == DVec3::ZERO {
            return largest;
        }
        largest + self.rest.abs().max_element() * (2.0 / f64::EPSILON)
    }
}

impl Meeting<f64> {
    /// The signs of the sides as seen from the origin and a `rest`.
    #[cold]
    #[inline(never)]
    pub(super) fn sides_from(&self, rest: DVec3) -> [f64; 3] {
        let [a, b, c] = arrays::map(self.corners, |corner| {
            arrays::from_fn::<_, 3>(|axis| [corner[axis], -self.origin[axis], -rest[axis]])
        });
        let side = |p: &[[f64; 3]; 3], q: &[[f64; 3]; 3]| {
            let mut sum = ExactSum::ZERO;
            for (k, l, m) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                let d = self.direction[k];
                for (one, other) in (0..9).map(|index| (index / 3, index % 3)) {
                    sum.add([d, p[l][one], q[m][other]]);
                    sum.add([-d, p[m][one], q[l][other]]);
                }
            }
            f64::from(sum.sign() as i8)
        };
        [side(&c, &b), side(&a, &c), side(&b, &a)]
    }
}
