//! Neighbouring rays together through the top-level tree.
//!
//! 1. Take the numbers for the slab test of each ray, and the intervals around them (`slabs.rs`).
//! 2. Test the sixteen boxes of a node against these. Put those that any ray may meet onto the
//!    stack, the nearest last.
//! 3. Continue with the last entry of the stack. At a leaf test its box against each ray, and give
//!    out its index with the rays that meet it. The caller may shorten the rays before it asks for
//!    the next.

use super::bvh::{BALL, BOX_ROUNDING, Bvh, FARTHEST_BOX, WalkStack, push_nearest_last};
use super::node::{LEAF, Node};
use super::rays::packet::{RAYS, WorldRays, largest_of, lowest, of, of_mut, vector};
use super::rays::slabs::{Intervals, least, rays_at, slab};
use super::traverse::mesh_packet::FEWEST;
use crate::simd::{Aligned, InLanes, Kernel, LANES, Lanes, WIDE};

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
    /// The intervals around these, and the least `first`.
    around: Intervals,
    earliest: f32,
}

impl Bvh {
    /// The boxes that some rays may meet, each of which has a direction; `None` where the rays do
    /// not go nearly the same way, or come from very far away.
    #[doc(hidden)]
    #[inline(always)]
    pub fn packet_walk<L: Lanes>(
        &self,
        l: L,
        (rays, count): (&WorldRays, usize),
        stack: &mut WalkStack,
    ) -> Option<PacketWalk<'_>> {
        stack.clear();
        let walk = l.call(Begin { bvh: self, rays, count })?;
        if walk.alive != 0 {
            stack.push((ROOT, f64::NEG_INFINITY));
        }
        Some(walk)
    }
}

/// Begins with sixteen rays, as [`Bvh::walk`] with one. It is compiled once for all queries.
struct Begin<'r, 'a> {
    bvh: &'a Bvh,
    rays: &'r WorldRays,
    count: usize,
}

impl<'a> Kernel for Begin<'_, 'a> {
    type Output = Option<PacketWalk<'a>>;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Self::Output {
        let mut walk = PacketWalk {
            bvh: self.bvh,
            inverse: [[0.0; RAYS]; 3],
            ends: [[[0.0; RAYS]; 2]; 3],
            first: [0.0; RAYS],
            depth_of_origin: [0.0; RAYS],
            depth_per_t: [0.0; RAYS],
            alive: 0,
            around: Intervals::ALL,
            earliest: 0.0,
        };
        let passes = [walk.begin_half(l, self.rays, 0)?, walk.begin_half(l, self.rays, 1)?];
        walk.alive = u16::from_le_bytes(passes) & lowest(self.count);
        walk.around = Intervals::around(l, walk.alive, &walk.inverse, &walk.ends);
        walk.earliest = least(l, walk.alive, &walk.first);
        (walk.alive == 0 || walk.is_narrow()).then_some(walk)
    }
}

impl PacketWalk<'_> {
    /// Begins with eight rays, as [`Bvh::walk`] does with one; returns those that pass the tree, or
    /// `None` where one comes from too far away.
    #[inline(always)]
    fn begin_half<L: Lanes>(&mut self, l: L, rays: &WorldRays, half: usize) -> Option<u8> {
        let number = |x: f64| l.splat64(x);
        let (zero, space) = (number(0.0), &self.bvh.space);
        let (origin, mut d) = (vector(l, &rays.origin, half), vector(l, &rays.direction, half));
        let length = largest_of(l, &d);
        let (mut moved, mut start) = ([zero; 3], [zero; 3]);
        let (mut dot, mut squares) = (zero, zero);
        for axis in 0..3 {
            moved[axis] = l.sub64(origin[axis], number(space.origin[axis]));
            start[axis] = l.mul64(moved[axis], number(space.scale));
            d[axis] = l.div64(d[axis], length);
            dot = l.add64(dot, l.mul64(start[axis], d[axis]));
            squares = l.add64(squares, l.mul64(d[axis], d[axis]));
        }
        let depth_of_origin = l.div64(dot, squares);
        let reach = l.add64(largest_of(l, &moved), number(self.bvh.extent));
        let margin = l.mul64(reach, number(self.bvh.slack * space.scale));
        if l.lt64(number(FARTHEST_BOX), margin) != 0 {
            return None;
        }
        let (mut nearest, mut squares) = ([zero; 3], zero);
        for axis in 0..3 {
            nearest[axis] = l.sub64(start[axis], l.mul64(depth_of_origin, d[axis]));
            squares = l.add64(squares, l.mul64(nearest[axis], nearest[axis]));
        }
        let reach = l.add64(number(self.bvh.extent * space.scale), margin);
        let reach = l.mul64(number(BALL), reach);
        let rounding = l.mul64(number(BOX_ROUNDING), largest_of(l, &nearest));
        let margin = l.add64(margin, rounding);
        for axis in 0..3 {
            let (over, [first, last]) = slab(InLanes(l), nearest[axis], d[axis], margin);
            l.store_narrowed(over, of_mut(&mut self.inverse[axis], half));
            l.store_narrowed(first, of_mut(&mut self.ends[axis][0], half));
            l.store_narrowed(last, of_mut(&mut self.ends[axis][1], half));
        }
        let depth_per_t = l.mul64(length, number(space.scale));
        let depth_per_t = l.max64(depth_per_t, number(f64::MIN_POSITIVE));
        let t_min = l.load64(of(&rays.t_min, half));
        let before = l.select64(l.lt64(t_min, zero), t_min, zero);
        let first = l.add64(l.mul64(before, depth_per_t), depth_of_origin);
        l.store_narrowed(l.sub64(first, narrowing(l, first)), of_mut(&mut self.first, half));
        l.store64(depth_per_t, of_mut(&mut self.depth_per_t, half));
        l.store64(depth_of_origin, of_mut(&mut self.depth_of_origin, half));
        let is_empty = self.bvh.nodes.is_empty();
        Some(if is_empty { 0 } else { l.le64(squares, l.mul64(reach, reach)) })
    }

    /// Whether the intervals around the rays are of use. Along an axis a ray goes `1 / inverse` for
    /// each unit of depth, and starts at `-end / inverse`.
    fn is_narrow(&self) -> bool {
        let along = |axis: usize| {
            let ([low, high], [first, last]) = (self.around.inverse[axis], self.around.ends[axis]);
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

    /// Which rays may meet a child's box, each up to its own depth.
    #[inline(always)]
    fn rays<L: Lanes>(&self, l: L, node: &Node, child: usize, last: &[f32; RAYS]) -> u16 {
        let depths = (l.load(&self.first), l.load(last));
        rays_at(l, (node, child), (&self.inverse, &self.ends), depths) & self.alive
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
        let mut last = Aligned([0.0; RAYS]);
        let mut open = [0; RAYS / WIDE];
        for (half, open) in open.iter_mut().enumerate() {
            let limit = l.load64(of(limits, half));
            let depth = l.mul64(limit, l.load64(of(&walk.depth_per_t, half)));
            let depth = l.add64(depth, l.load64(of(&walk.depth_of_origin, half)));
            l.store_narrowed(l.add64(depth, narrowing(l, depth)), of_mut(&mut last.0, half));
            *open = l.le64(l.splat64(0.0), limit);
        }
        let open = u16::from_le_bytes(open) & walk.alive;
        let depths = l.select(open, l.load(&last.0), l.splat(f32::NEG_INFINITY));
        l.store(depths, &mut last.0);
        let latest = l.largest(depths);
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
            let node = &walk.bvh.nodes[child as usize];
            let (met, entries) = walk.around.boxes(l, node, [walk.earliest, latest]);
            let mut depths = [0.0; LANES];
            l.store(entries, &mut depths);
            push_nearest_last(stack, met, &depths, |k| place_of(child, k));
        }
    }
}

/// More than a number changes when it is narrowed to float32.
#[inline(always)]
fn narrowing<L: Lanes>(l: L, x: L::Doubles) -> L::Doubles {
    let share = l.mul64(l.abs64(x), l.splat64(f64::from(f32::EPSILON)));
    l.add64(share, l.splat64(f64::from(f32::MIN_POSITIVE)))
}
