//! Neighbouring rays together through the top-level tree.
//!
//! 1. Take the numbers for the slab test of each ray, and the least and the largest of them.
//! 2. Test the sixteen boxes of a node against these. Put those that any ray may meet onto the
//!    stack, the nearest last.
//! 3. Continue with the last entry of the stack. At a leaf test its box against each ray, and give
//!    out its index with the rays that meet it. The caller may shorten the rays before it asks for
//!    the next.
//!
//! Each operation of the slab test is monotone in its arguments, rounding included. So a box that
//! the intervals of step 1 miss is missed by every ray, to the bit of its own test.

use super::bvh::{Bvh, Walk, WalkStack, narrowed, push_nearest_last};
use super::node::{LEAF, Node};
use super::rays::packet::RAYS;
use super::traverse::mesh_packet::FEWEST;
use crate::geometry::Ray;
use crate::simd::{Aligned, Kernel, LANES, Lanes};

/// Rays whose directions differ by more along an axis, or whose starts do in units of the tree, do
/// not go together.
const SPREAD: f32 = 0.1;

/// The root's place, which is among no node's children.
const ROOT: u32 = u32::MAX;

/// The place of a node's child, as the stack has it.
#[expect(clippy::cast_possible_truncation, reason = "lanes are few")]
#[inline(always)]
fn place_of(node: u32, lane: usize) -> u32 {
    LANES as u32 * node + lane as u32
}

/// The way of up to sixteen rays through a [`Bvh`].
pub struct PacketWalk<'a> {
    bvh: &'a Bvh,
    // Of each ray, see `Slabs` and `Walk`.
    inverse: [[f32; RAYS]; 3],
    ends: [[[f32; RAYS]; 2]; 3],
    first: [f32; RAYS],
    depth_of_origin: [f64; RAYS],
    depth_per_t: [f64; RAYS],
    /// The rays that pass the tree, a bit each.
    alive: u16,
    /// The least and the largest `inverse` of them, the least of their first ends and the largest
    /// of their last, and the least `first`.
    inverses: [[f32; 2]; 3],
    outermost: [[f32; 2]; 3],
    earliest: f32,
}

impl Bvh {
    /// The boxes that some rays may meet; `None` where the rays do not go nearly the same way.
    #[doc(hidden)]
    pub fn packet_walk<'r>(
        &self,
        rays: impl Iterator<Item = &'r Ray>,
        stack: &mut WalkStack,
    ) -> Option<PacketWalk<'_>> {
        let mut packet = PacketWalk {
            bvh: self,
            inverse: [[0.0; RAYS]; 3],
            ends: [[[0.0; RAYS]; 2]; 3],
            first: [f32::INFINITY; RAYS],
            depth_of_origin: [0.0; RAYS],
            depth_per_t: [0.0; RAYS],
            alive: 0,
            inverses: [[f32::INFINITY, f32::NEG_INFINITY]; 3],
            outermost: [[f32::INFINITY, f32::NEG_INFINITY]; 3],
            earliest: f32::INFINITY,
        };
        for (lane, ray) in rays.enumerate() {
            let walk = self.walk(ray, stack);
            if !stack.is_empty() {
                packet.add(lane % RAYS, &walk);
            }
        }
        stack.clear();
        if packet.alive == 0 {
            return Some(packet);
        }
        stack.push((ROOT, f64::NEG_INFINITY));
        packet.is_narrow().then_some(packet)
    }
}

impl PacketWalk<'_> {
    /// Takes in a ray that passes the tree.
    fn add(&mut self, lane: usize, walk: &Walk<'_>) {
        let slabs = &walk.slabs;
        for axis in 0..3 {
            let (inverse, [first, last]) = (slabs.inverse[axis], slabs.ends[axis]);
            self.inverse[axis][lane] = inverse;
            self.ends[axis][0][lane] = first;
            self.ends[axis][1][lane] = last;
            let [low, high] = self.inverses[axis];
            self.inverses[axis] = [low.min(inverse), high.max(inverse)];
            let [low, high] = self.outermost[axis];
            self.outermost[axis] = [low.min(first), high.max(last)];
        }
        self.first[lane] = walk.first;
        self.earliest = self.earliest.min(walk.first);
        self.depth_of_origin[lane] = walk.depth_of_origin;
        self.depth_per_t[lane] = walk.depth_per_t;
        self.alive |= 1 << lane;
    }

    /// Whether the intervals around the rays are of use. Along an axis a ray goes `1 / inverse` for
    /// each unit of depth, and starts at `-end / inverse`.
    fn is_narrow(&self) -> bool {
        let along = |axis: usize| {
            let [low, high] = self.inverses[axis];
            let [first, last] = self.outermost[axis];
            // Of the same sign, and close enough that the differences of slabs are worth something.
            let ratio = low / high;
            (0.5..2.0).contains(&ratio)
                && (1.0 / low - 1.0 / high).abs() < SPREAD
                && (last - first) / low.abs().max(high.abs()) < SPREAD
        };
        self.alive.count_ones() >= FEWEST && (0..3).all(along)
    }

    /// The next box that rays may meet at a parameter of at most their limit, roughly the nearest
    /// first, and these rays, a bit each. A ray whose limit is below zero meets nothing. No limit
    /// is larger than in the call before, and `stack` is the same.
    #[inline(always)]
    pub fn next<L: Lanes>(
        &self,
        l: L,
        limits: &[f64; RAYS],
        stack: &mut WalkStack,
    ) -> Option<(u32, u16)> {
        let walk = self;
        l.call(Next { walk, limits, stack })
    }

    /// Which of a node's boxes any ray may meet up to the depth `latest`, and from which depths on.
    #[inline(always)]
    fn boxes<L: Lanes>(&self, l: L, node: &Node, latest: f32) -> (u16, L::Floats) {
        let (mut entry, mut exit) = (l.splat(self.earliest), l.splat(latest));
        for axis in 0..3 {
            let [low, high] = self.inverses[axis];
            let is_back = usize::from(low.is_sign_negative());
            let [first, last] = self.outermost[axis];
            let (low, high) = (l.splat(low), l.splat(high));
            let (first, last) = (l.splat(first), l.splat(last));
            let near = l.load(&node.planes[2 * axis + is_back]);
            let far = l.load(&node.planes[2 * axis + (is_back ^ 1)]);
            let enters = l.min(l.mul_add(near, low, first), l.mul_add(near, high, first));
            let leaves = l.max(l.mul_add(far, low, last), l.mul_add(far, high, last));
            (entry, exit) = (l.max(entry, enters), l.min(exit, leaves));
        }
        (l.le(entry, exit), entry)
    }

    /// Which rays may meet a child's box, each up to its own depth.
    #[inline(always)]
    fn rays<L: Lanes>(&self, l: L, node: &Node, child: usize, last: &[f32; RAYS]) -> u16 {
        let (mut entry, mut exit) = (l.load(&self.first), l.load(last));
        for axis in 0..3 {
            let is_back = usize::from(self.inverses[axis][0].is_sign_negative());
            let plane = |side: usize| node.planes[2 * axis + side][child];
            let inverse = l.load(&self.inverse[axis]);
            let [first, last] = &self.ends[axis];
            let (near, far) = (l.splat(plane(is_back)), l.splat(plane(is_back ^ 1)));
            entry = l.max(entry, l.mul_add(near, inverse, l.load(first)));
            exit = l.min(exit, l.mul_add(far, inverse, l.load(last)));
        }
        l.le(entry, exit) & self.alive
    }
}

/// [`PacketWalk::next`] as a kernel, compiled once for all queries.
struct Next<'r, 'a> {
    walk: &'r PacketWalk<'a>,
    limits: &'r [f64; RAYS],
    stack: &'r mut WalkStack,
}

impl Kernel for Next<'_, '_> {
    type Output = Option<(u32, u16)>;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Self::Output {
        let Self { walk, limits, stack } = self;
        let mut last = Aligned([f32::NEG_INFINITY; RAYS]);
        let mut latest = f32::NEG_INFINITY;
        for (lane, &limit) in limits.iter().enumerate() {
            if limit >= 0.0 && walk.alive >> lane & 1 == 1 {
                let depth = limit * walk.depth_per_t[lane] + walk.depth_of_origin[lane];
                last.0[lane] = narrowed(depth).next_up();
                latest = latest.max(last.0[lane]);
            }
        }
        loop {
            let (place, entry) = stack.pop()?;
            // Hits since it was put there may have made it too far.
            if entry > f64::from(latest) {
                continue;
            }
            let (parent, lane) = (place as usize / LANES, place as usize % LANES);
            let mut child = 0;
            if place != ROOT {
                let node = &walk.bvh.nodes[parent];
                child = node.children[lane];
                if child & LEAF != 0 {
                    let met = walk.rays(l, node, lane, &last.0);
                    if met != 0 {
                        return Some((child & !LEAF, met));
                    }
                    continue;
                }
            }
            let (met, entries) = walk.boxes(l, &walk.bvh.nodes[child as usize], latest);
            let mut depths = [0.0; LANES];
            l.store(entries, &mut depths);
            push_nearest_last(stack, met, &depths, |k| place_of(child, k));
        }
    }
}
