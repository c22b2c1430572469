//! Which of many boxes may a ray meet? This room sees boxes, never shapes.
//!
//! A [`Candidates`] only proposes; the shape's own float64 test decides. So the answer does not depend
//! on the tree: [`Everything`] proposes every box, and any other source must lead to the same bits.

mod bins;
mod build;
mod bvh;

pub use bvh::Bvh;

use crate::geometry::Ray;

/// A source of candidates for a ray.
pub trait Candidates {
    /// Calls `visit(index, t_max)` with the index of each box that the ray may meet at a parameter of
    /// at most `t_max`, in any order. `visit` returns the `t_max` to go on with, not larger than before;
    /// any negative number ends the search. So one traversal serves the first hit and any hit.
    fn visit(&self, ray: &Ray, visit: impl FnMut(u32, f64) -> f64);
}

/// Proposes every index below the number: brute force, the judge.
#[derive(Debug, Clone, Copy)]
pub struct Everything(pub u32);

impl Candidates for Everything {
    fn visit(&self, ray: &Ray, mut visit: impl FnMut(u32, f64) -> f64) {
        let mut t_max = ray.t_max;
        for index in 0..self.0 {
            t_max = visit(index, t_max);
            if t_max < 0.0 {
                return;
            }
        }
    }
}
