//! Sixteen short rays from a small place, in all directions, together through the tree of a mesh:
//! ambient occlusion shoots them. For queries that need no order.
//!
//! 1. Put a box around the segments of all rays; give up when it is as wide as half the mesh.
//! 2. At a node, test its sixteen boxes against that box, then each one that is left against the
//!    sixteen rays; a child goes onto the stack with a mask of the rays that meet it.
//! 3. At a leaf, or at a node that only one ray meets, continue ray by ray.
//! 4. Give up when nodes have few rays in common.
//!
//! Wald, Slusallek, Benthin and Wagner, "Interactive Rendering with Coherent Ray Tracing", Computer
//! Graphics Forum 20(3), 2001, for the masks. It departs in step 1, which rules out most children
//! of a wide node for all rays at once, whatever their directions.

use super::deferred::Deferred;
use super::mesh_packet::{FEWEST, MeshPacket};
use super::query::{MeshQuery, Sink, queries};
use super::stack::Stack;
use crate::accel::bounds::{FAR, SEGMENT};
use crate::accel::filter::filter;
use crate::accel::node::{LEAF, Node};
use crate::accel::rays::packet::{Packet, RAYS};
use crate::simd::{Lanes, set_bits};

/// The number of nodes and leaves visited between two checks that rays have them in common.
const TRIAL: u32 = 32;
/// The least mean number of rays for each node or leaf with which the packet continues.
const COMMON: u32 = 3;
/// A depth at which a ray has left the tree, which is in the cube from -1 to 1.
const OUTSIDE: f32 = 10.0;
const _: () = assert!(FAR + 2.0 <= OUTSIDE as f64);

/// Answers the open rays of a packet, but for those whose start float32 does not resolve. Returns
/// `false` when it gave up; any ray may then be open still.
#[inline(always)]
pub(super) fn masked<'a, L: Lanes, Q: MeshQuery>(
    l: L,
    stack: &mut Stack,
    (number, packet): (usize, &mut MeshPacket<'a>),
    (deferred, sink): (&mut Deferred<'a>, &mut (impl Sink<Q::Found> + ?Sized)),
) -> bool {
    let all = packet.packet;
    let rays = packet.open & l.lt(l.load(&all.blur), l.splat(1e-2));
    if rays.count_ones() < FEWEST {
        return false;
    }
    let around = SegmentBounds::new(l, all, rays);
    if around.is_wide(packet) {
        return false;
    }
    let mut queries: [Q; RAYS] = queries(&all.t_max_high);
    let mut alive = rays;
    let (mut visits, mut visitors) = (0, 0);
    let mut is_done = true;
    stack.clear();
    stack.push(key(rays, 0));
    while alive != 0
        && let Some(next) = stack.pop()
    {
        let (here, index) = parts(next);
        let here = here & alive;
        if here == 0 {
            continue;
        }
        visits += 1;
        visitors += here.count_ones();
        if visits % TRIAL == 0 && visitors < COMMON * visits {
            is_done = false;
            break;
        }
        if index & LEAF == 0 {
            let node = &packet.tree.nodes[index as usize];
            let base = stack.len();
            around.open(l, all, node, here, stack);
            for &key in stack.entries_from(base) {
                let (_, next) = parts(key);
                let tree = packet.tree;
                l.prefetch_either(next & LEAF != 0, next & !LEAF, &tree.nodes, &tree.leaves);
            }
        } else {
            alive &= !visit(l, packet, index & !LEAF, here, &mut queries);
        }
    }
    deferred.finish_packet(l, (number, packet), (rays, is_done), &queries, sink);
    is_done
}

/// Shows a leaf to the rays `here`; returns which of them have their answer.
#[inline(always)]
fn visit<L: Lanes, Q: MeshQuery>(
    l: L,
    packet: &MeshPacket<'_>,
    index: u32,
    here: u16,
    queries: &mut [Q; RAYS],
) -> u16 {
    let tree = packet.tree;
    let leaf = &tree.leaves[index as usize];
    let mut answered = 0;
    for lane in set_bits(here) {
        let query = &mut queries[lane];
        let ray = packet.packet.tree_ray(lane);
        if let Some(mut candidates) = filter(l, &ray, leaf, query.limit()) {
            candidates.possible = tree.present(index, candidates.possible);
            query.visit(l, &packet.ray(lane), index, &candidates);
            answered |= u16::from(query.limit() < 0.0) << lane;
        }
    }
    answered
}

/// Rays, and a node or a leaf that they meet, as a stack holds them.
#[inline(always)]
fn key(rays: u16, index: u32) -> u64 {
    u64::from(rays) << 32 | u64::from(index)
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "what `key` put together")]
fn parts(key: u64) -> (u16, u32) {
    ((key >> 32) as u16, key as u32)
}

/// The box around the segments of a packet's rays, from their starts to where nothing matters any
/// more.
struct SegmentBounds {
    low: [f32; 3],
    high: [f32; 3],
}

impl SegmentBounds {
    #[inline(always)]
    fn new<L: Lanes>(l: L, packet: &Packet, rays: u16) -> Self {
        let mut out = Self { low: [0.0; 3], high: [0.0; 3] };
        let (zero, one, half) = (l.splat(0.0), l.splat(1.0), l.splat(0.5));
        let limit = l.max(l.min(l.load(&packet.t_max_high), l.splat(OUTSIDE)), zero);
        for axis in 0..3 {
            let inverse = l.load(&packet.inverse[axis]);
            let [first, last] = &packet.ends[axis];
            let (first, last) = (l.load(first), l.load(last));
            let direction = l.div(one, inverse);
            // Each end is minus the start over the direction, one moved forwards and one backwards
            // by the margin.
            let start = l.mul(l.mul(l.add(first, last), half), l.sub(zero, direction));
            let margin = l.mul(l.sub(last, first), direction);
            // Rounding in units of `U OUTSIDE`: the start 5, the slope at the end 2, product and
            // sum 3, the last difference 2. `SEGMENT` allows 16.
            let margin = l.mul_add(l.abs(margin), half, l.splat(SEGMENT * OUTSIDE));
            let end = l.mul_add(direction, limit, start);
            let low = l.sub(l.min(start, end), margin);
            let high = l.add(l.max(start, end), margin);
            out.low[axis] = l.smallest(l.select(rays, low, l.splat(f32::INFINITY)));
            out.high[axis] = l.largest(l.select(rays, high, l.splat(f32::NEG_INFINITY)));
        }
        out
    }

    /// Whether it is as wide as half the mesh, so that it would rule out little.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "about so much")]
    fn is_wide(&self, packet: &MeshPacket<'_>) -> bool {
        let size = packet.mesh.bounds().size().max_element();
        let half = (0.5 * size * packet.tree.space.scale) as f32;
        (0..3).any(|axis| self.high[axis] - self.low[axis] > half)
    }

    /// Puts a node's children onto the stack, each with those of the rays `here` that meet its box.
    #[inline(always)]
    fn open<L: Lanes>(&self, l: L, packet: &Packet, node: &Node, here: u16, stack: &mut Stack) {
        if here.is_power_of_two() {
            let lane = here.trailing_zeros() as usize % RAYS;
            let (met, _) = packet.tree_ray(lane).boxes(l, node, packet.t_max_high[lane]);
            for child in set_bits(met) {
                stack.push(key(here, node.children[child]));
            }
            return;
        }
        let mut met = u16::MAX;
        for axis in 0..3 {
            let [low, high] = [&node.planes[2 * axis], &node.planes[2 * axis + 1]];
            met &= l.le(l.load(low), l.splat(self.high[axis]));
            met &= l.le(l.splat(self.low[axis]), l.load(high));
        }
        let limits = l.load(&packet.t_max_high);
        for child in set_bits(met) {
            let rays = here & packet.meets(l, node, child, limits);
            stack.push_if(rays != 0, key(rays, node.children[child]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::mesh_tree::MeshTree;
    use crate::accel::traverse::any::Any;
    use crate::accel::traverse::any::tests::Answers;
    use crate::geometry::{DVec3, Ray};
    use crate::shape::triangle::{EdgeRule, Shear};
    use crate::shape::{Mesh, Positions};
    use crate::simd::{self, InstructionSet, Kernel};

    /// Sixteen rays that start around a point, in directions of all octants, up to a reach.
    struct Sixteen<'a> {
        mesh: &'a Mesh,
        tree: &'a MeshTree,
        middle: DVec3,
        reach: f64,
    }

    /// Whether they were answered together, which are open still, and how far their segments are
    /// outside the box.
    struct Outcome {
        is_done: bool,
        open: u16,
        outside: f64,
    }

    struct Nowhere;
    impl<A> Sink<A> for Nowhere {
        fn put(&mut self, _: usize, _: usize, _: A) {}
    }

    impl Sixteen<'_> {
        fn ray(&self, lane: usize) -> Ray {
            let sign = |bit: usize| [1.0, -1.0][lane >> bit & 1];
            let share = 0.1 + lane as f64 / 20.0;
            let direction = DVec3::new(sign(0), share * sign(1), (1.0 - share) * sign(2));
            let direction = if lane == 5 { DVec3::NEG_Y } else { direction };
            let start = self.middle + 0.01 * DVec3::new(direction.y, direction.z, direction.x);
            Ray::new(start, direction.normalize()).up_to(self.reach * share)
        }
    }

    impl Kernel for Sixteen<'_> {
        type Output = Outcome;

        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> Outcome {
            let mut packet = Packet::default();
            for lane in 0..RAYS {
                packet.put(lane, &self.ray(lane));
            }
            packet.prepare(l, self.tree, RAYS);
            let around = SegmentBounds::new(l, &packet, u16::MAX);
            let mut outside = f64::NEG_INFINITY;
            for lane in 0..RAYS {
                let ray = self.ray(lane);
                for end in [ray.origin, ray.at(ray.t_max.min(1.0))] {
                    let place = (end - self.tree.space.origin) * self.tree.space.scale;
                    for axis in 0..3 {
                        let below = f64::from(around.low[axis]) - place[axis];
                        let above = place[axis] - f64::from(around.high[axis]);
                        outside = outside.max(below).max(above);
                    }
                }
            }
            let mut packet = MeshPacket::new(self.tree, self.mesh, &packet);
            let mut stack = Stack::new();
            let is_done = masked::<L, Any>(
                l,
                &mut stack,
                (0, &mut packet),
                (&mut Deferred::new(), &mut Nowhere),
            );
            Outcome { is_done, open: packet.open, outside }
        }
    }

    #[test]
    fn short_rays_go_together_and_long_ones_do_not() {
        let mesh = Mesh::sheet(41, |x, y| [x / 20.0 - 1.0, y / 20.0 - 1.0, 0.0]);
        let tree = MeshTree::build(&mesh);
        for set in InstructionSet::available() {
            for (reach, goes) in [(0.3, true), (1e-6, true), (3.0, false), (f64::INFINITY, false)] {
                let sixteen = Sixteen {
                    mesh: &mesh,
                    tree: &tree,
                    middle: DVec3::new(0.2, -0.1, 0.005),
                    reach,
                };
                let outcome = simd::run(set, sixteen);
                assert_eq!(outcome.is_done, goes, "{set:?} {reach}");
                assert_eq!(outcome.open, if goes { 0 } else { u16::MAX });
                assert!(outcome.outside < 0.0, "{set:?} {reach}: {}", outcome.outside);
            }
        }
    }

    /// Short rays, each in a place of its own, among loose triangles.
    struct Parting<'a>(&'a Mesh, &'a MeshTree);

    impl Kernel for Parting<'_> {
        type Output = [usize; 2];

        /// The number of rays that have their answer, and the number still open when the packet
        /// gave up.
        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> [usize; 2] {
            let Self(mesh, tree) = self;
            let mut packet = Packet::default();
            let ray = |lane: usize| {
                let turn = lane as f64 * 0.4;
                let (sin, cos) = libm::sincos(turn);
                let outwards = DVec3::new(cos, sin, 0.3 * sin * cos);
                let along = DVec3::new(-sin, cos, 0.5);
                Ray::new(0.38 * outwards, along).up_to(0.08)
            };
            for lane in 0..RAYS {
                packet.put(lane, &ray(lane));
            }
            packet.prepare(l, tree, RAYS);
            let mut packet = MeshPacket::new(tree, mesh, &packet);
            let mut answers = Answers([None; RAYS]);
            let is_done = masked::<L, Any>(
                l,
                &mut Stack::new(),
                (0, &mut packet),
                (&mut Deferred::new(), &mut answers),
            );
            assert!(!is_done || packet.open == 0);
            for (lane, answer) in answers.0.iter().enumerate() {
                let is_open = packet.open >> lane & 1 == 1;
                assert_eq!(answer.is_none(), is_open);
                if answer.is_some() {
                    let shear = Shear::new(&ray(lane));
                    let hits = (0..mesh.triangles().len())
                        .filter_map(|k| mesh.intersect_triangle(k, EdgeRule::Closed, &shear));
                    let is_met = hits.into_iter().any(|hit| ray(lane).holds(hit.t));
                    assert_eq!(*answer, Some(is_met));
                }
            }
            let answered = answers.0.iter().flatten().count();
            [answered, RAYS - answered]
        }
    }

    #[test]
    fn what_was_found_before_giving_up_is_kept() {
        let mut state = 1_u64;
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut point = || DVec3::new(unit(), unit(), unit());
        let mut has_both = false;
        for size in [0.02, 0.04, 0.08, 0.16] {
            let corners: Vec<[f64; 3]> = (0..12_000)
                .flat_map(|_| {
                    let middle = point();
                    [middle, middle + size * point(), middle + size * point()].map(|p| p.to_array())
                })
                .collect();
            let triangles = (0..12_000).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
            let mesh = Mesh::new(Positions::Double(corners.into()), triangles).unwrap();
            let tree = MeshTree::build(&mesh);
            for set in InstructionSet::available() {
                let [answered, open] = simd::run(set, Parting(&mesh, &tree));
                has_both |= answered > 0 && open > 0;
            }
        }
        assert!(has_both, "no packet gave up half done");
    }
}
