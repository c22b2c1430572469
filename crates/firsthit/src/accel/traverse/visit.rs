//! The visitor that shows every candidate to a function.

use super::mesh_packet::MeshRay;
use super::query::Visitor;
use crate::accel::filter::Candidates;
use crate::simd::{Lanes, set_bits};

/// Calls a function with each candidate; see [`each`](super::single::each).
pub(super) struct Each<V> {
    pub(super) call: V,
    /// Whether triangles in the place of others are wanted too.
    pub(super) with_copies: bool,
    pub(super) t_max: f64,
    pub(super) limit: f32,
}

impl<V: FnMut(u32, f64) -> f64> Visitor for Each<V> {
    #[inline(always)]
    fn visit<L: Lanes>(&mut self, _: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let leaf = &ray.tree.leaves[leaf as usize];
        for lane in set_bits(candidates.possible) {
            let triangle = ray.tree.triangle(leaf, lane);
            self.t_max = (self.call)(triangle, self.t_max);
            if self.with_copies {
                for &[_, copy] in ray.tree.copies_of(triangle) {
                    self.t_max = (self.call)(copy, self.t_max);
                }
            }
            if self.t_max < 0.0 {
                self.limit = -1.0;
                return;
            }
            self.limit = ray.packet.depth_above(ray.lane, self.t_max);
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}
