//! Any hit: does a ray meet anything?
//!
//! 1. Drop a candidate that is before `t_min`, by its depths.
//! 2. A candidate that is certain to be met, and certainly between `t_min` and `t_max`, ends the
//!    traversal.
//! 3. For any other candidate the exact test decides.

use super::mesh_packet::MeshRay;
use super::query::{MeshQuery, Visitor};
use crate::accel::filter::Candidates;
use crate::accel::meshlet::Meshlet;
use crate::shape::Crossing;
use crate::simd::{Kernel, Lanes, set_bits};

/// The state of an any-hit query: see [the module](self). It is one number, so making a
/// packet's sixteen queries only copies the packet's limits.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct Any {
    limit: f32,
}

/// The limit of a ray that has met something. No query begins with it.
const FOUND: f32 = -2.0;
/// A limit below this is raised to it, so that none is taken for [`FOUND`]. A ray with a negative
/// limit meets nothing.
const NOTHING: f32 = -1.0;

impl MeshQuery for Any {
    type Found = bool;
    const IN_PACKETS_FILTERED: bool = true;
    const NONE: Self::Found = false;

    #[inline(always)]
    fn new(limit: f32) -> Self {
        Self { limit: limit.max(NOTHING) }
    }

    #[inline(always)]
    fn visit_one<L: Lanes>(
        &mut self,
        l: L,
        ray: &MeshRay<'_>,
        (leaf, lane): (u32, usize),
        (low, high): (f32, f32),
        is_certain: bool,
    ) {
        if ray.limits.begin_after(high) {
            return;
        }
        let one = MeetsOneOf { ray, leaf: &ray.tree.leaves[leaf as usize], triangles: 1 << lane };
        if is_certain && ray.limits.hold(low, high) || l.call(one) {
            self.limit = FOUND;
        }
    }

    #[inline(always)]
    fn see<L: Lanes>(&mut self, _: L, _: &MeshRay<'_>, _: Crossing) {
        self.limit = FOUND;
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: L, _: &MeshRay<'_>) -> Self::Found {
        self.limit == FOUND
    }

    #[inline(always)]
    fn of_crossing(crossing: Option<Crossing>) -> Self::Found {
        crossing.is_some()
    }
}

impl Visitor for Any {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, l: L, ray: &MeshRay<'_>, leaf: u32, candidates: &Candidates<L>) {
        let limits = &ray.limits;
        let inside = l.lt(l.splat(limits.t_min_high), candidates.low)
            & l.lt(candidates.high, l.splat(limits.t_max_low));
        let possible = candidates.possible & l.le(l.splat(limits.t_min_low), candidates.high);
        debug_assert!(self.limit != FOUND, "an answer is never taken back");
        if possible == 0 {
            return;
        }
        let some = MeetsOneOf { ray, leaf: &ray.tree.leaves[leaf as usize], triangles: possible };
        if possible & candidates.certain & inside != 0 || l.call(some) {
            self.limit = FOUND;
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}

/// Whether a ray meets one of some triangles of a leaf, by the exact test. A function of its own:
/// it is rarely called, and inlined it would take registers from the traversal.
struct MeetsOneOf<'a> {
    ray: &'a MeshRay<'a>,
    leaf: &'a Meshlet,
    triangles: u16,
}

impl Kernel for MeetsOneOf<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> bool {
        let Self { ray, leaf, triangles } = self;
        for lane in set_bits(triangles) {
            if ray.intersect(l, Any::EDGES, leaf, lane).is_some() {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::accel::mesh_tree::MeshTree;
    use crate::accel::rays::packet::{Packet, RAYS};
    use crate::accel::traverse::dispatch::{Traversal, TraversalMemory};
    use crate::accel::traverse::mesh_packet::MeshPacket;
    use crate::accel::traverse::query::Sink;
    use crate::accel::traverse::single::traverse;
    use crate::accel::traverse::stack::Stack;
    use crate::geometry::{DVec3, Ray};
    use crate::shape::{Mesh, Positions};
    use crate::simd::{self, InstructionSet};

    /// The answers of a packet; none is given twice.
    pub(in super::super) struct Answers(pub(in super::super) [Option<bool>; RAYS]);

    impl Sink<bool> for Answers {
        fn put(&mut self, _: usize, lane: usize, found: bool) {
            assert_eq!(self.0[lane].replace(found), None);
        }
    }

    /// Rays towards a mesh, and the depths at which they end.
    struct Ending<'a>(&'a MeshTree, &'a Mesh, [f32; RAYS]);

    impl Kernel for Ending<'_> {
        type Output = ();

        #[inline(always)]
        fn run<L: Lanes>(self, l: L) {
            let Self(tree, mesh, limits) = self;
            // First neighbours, which go together; then rays from all sides, which do not.
            for spread in [0.001, 3.0] {
                let mut packet = Packet::default();
                for lane in 0..RAYS {
                    let [x, y] = [lane % 4, lane / 4].map(|k| spread * (k as f64 - 1.4));
                    let start = DVec3::new(x, y, 3.0);
                    packet.put(lane, &Ray::new(start, DVec3::new(0.1, 0.2, 0.0) - start));
                }
                packet.prepare(l, tree, RAYS);
                packet.t_max_high = limits;
                let at_mesh = MeshPacket::new(tree, mesh, &packet);
                let mut answers = Answers([None; RAYS]);
                let (mut memory, mut one) = (TraversalMemory::default(), at_mesh);
                let mut traversal = Traversal::new(&mut memory);
                traversal.try_together::<L, Any>(l, (0, &mut one), &mut answers);
                traversal.finish::<L, Any>(l, &[one], &mut answers);
                for (lane, &limit) in limits.iter().enumerate() {
                    let is_met = limit > 100.0;
                    assert_eq!(answers.0[lane], Some(is_met), "{limit} {spread}");
                    let ray = at_mesh.ray(lane);
                    let mut query = Any::new(limit);
                    traverse(l, &mut Stack::new(), &ray, &mut query);
                    assert_eq!(query.finish(l, &ray), is_met, "{limit}");
                }
            }
        }
    }

    /// No limit that a ray may begin with is taken for an answer.
    #[test]
    fn a_ray_that_ends_before_all_meets_nothing() {
        let corners = [[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]];
        let mesh = Mesh::new(Positions::Double(corners.to_vec().into()), vec![[0, 1, 2]]).unwrap();
        let tree = MeshTree::build(&mesh);
        let infinity = f32::INFINITY;
        let mut limits = [infinity; RAYS];
        let before = [FOUND, NOTHING, -infinity, -3.0, -1.5, -0.5, -0.0, f32::MIN, f32::NAN];
        limits[..before.len()].copy_from_slice(&before);
        for set in InstructionSet::available() {
            simd::run(set, Ending(&tree, &mesh, limits));
        }
    }
}
