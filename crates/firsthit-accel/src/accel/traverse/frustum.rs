//! The planes around the rays of a packet, and which boxes are within them.
//!
//! 1. Count points from a reference, which has x and y of the first ray's start, and the depth of
//!    the rearmost start. The depth is along the axis on which all directions are longest. It is
//!    not negative where a ray may meet something.
//! 2. Follow every ray back to the depth 0. At a depth d it is at `at_zero + d * slope`, along x
//!    and along y; it starts at its `start_depth`.
//! 3. Make four planes of the smallest and the largest `at_zero` and slope along x and along y.
//! 4. Make two more planes, nearly parallel, along a direction across which the rays are much the
//!    same. Neighbours often lie in a plane: the pixels of a row, and what a row sees, seen from a
//!    light. The direction is taken from the first and the last ray.
//! 5. Move all planes outwards by a margin for rounding.
//! 6. Keep a box if for each plane the corner that is farthest inside is inside.
//!
//! Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", ACM Transactions on Graphics
//! 24(3), 2005. It departs in the planes of step 4.
//!
//! # Error bounds
//!
//! In units of `U`, beside the blurs of the rays' starts (see `bounds.rs`). W is the largest of
//! three numbers: how far a ray at the depth 0 is from the reference along x, and along y, and the
//! depth at which it starts.
//!
//! **At the depth 0** a ray is off by at most 9 W:
//!
//! - 4 W: two differences along x (or y), where its start is up to 2 W from the reference;
//! - 2 W: two differences along the depth;
//! - 3 W: the slope, which is at most 1, its product and its difference.
//!
//! **A sheared coordinate** X of a vertex at the depth D that is P from the reference is off by the
//! sum of these:
//!
//! - P + D: the differences with the reference;
//! - P + W: the difference with the ray at the depth 0;
//! - 2 D + X: the slope, its product and its difference;
//! - 9 W: the ray at the depth 0.
//!
//! P is at most X + W + D. Where a ray passes a triangle, X is at most the triangle's extent
//! (sheared, along x or y). In all that is 5 D (`PACKET_VERTEX`), 3 X (`PACKET_EXTENT`) and 12 W
//! (`PACKET_START` allows 20).
//!
//! **Against the four planes** all of this is in units of the reach. Starts differ by less than 2
//! along each axis, so at the depth 0 a ray is less than 4 from the reference. The test is off by
//! the sum of these:
//!
//! - 16: a ray at the depth 0, by two differences along each of two axes, 8, the slope and its
//!   product, 4, and its difference, 4;
//! - 4: the margin, added to that;
//! - 6: a vertex, by two differences, the slope, its product and its difference of up to 2.
//!
//! These are 26; `PACKET_PLANES` allows 40.
//!
//! **Against the two others** the parts along x and y add up. Rays are within `between` at the
//! depth 0, and each end moves outwards by the `spread` for a depth of 1:
//!
//! - 32: a ray at the depth 0, twice the 16 above; 16: the products and the sum along the normal;
//!   8: the margin;
//! - 20: a vertex, by three differences, three products, two sums and a share of the spread.
//!
//! These are 76; `PACKET_NORMAL` allows 160. Slopes are off by 9 in all; `PACKET_SPREAD` allows 16.

use super::mesh_packet::{FEWEST, MeshPacket};
use crate::accel::bounds::{
    BLURS, DEPTH, PACKET_NORMAL, PACKET_PLANES, PACKET_SPREAD, PACKET_START,
};
use crate::accel::node::Node;
use crate::accel::rays::packet::RAYS;
use crate::simd::{Aligned, Lanes};

/// The space that the rays of a packet are in.
pub(super) struct PacketFrustum {
    /// The rays of the packet that are in the frustum, a bit each.
    pub(super) rays: u16,
    /// The order of the axes, as `TreeRay::axes`.
    pub(super) axes: [usize; 3],
    pub(super) forwards: f32,
    /// Along those axes.
    pub(super) reference: [f32; 3],
    /// The smallest and the largest of `at_zero`, less and more for rounding, and of the slopes,
    /// along x and along y.
    pub(super) at_zero_bounds: [[f32; 2]; 2],
    pub(super) slope_bounds: [[f32; 2]; 2],
    /// The place of each ray at the depth 0, along x and along y.
    pub(super) at_zero: [Aligned<[f32; RAYS]>; 2],
    /// The depth at which each ray starts.
    pub(super) start_depth: Aligned<[f32; RAYS]>,
    /// The distance by which the planes are moved outwards.
    pub(super) margin: f32,
    /// The error of a sheared coordinate, at any depth.
    pub(super) error: f32,
    /// The error of a depth, at any depth.
    pub(super) depth_error: f32,
    /// The normal of the two planes of step 4: its parts along x and y, at most 1, and minus its
    /// part along the depth.
    pub(super) normal: [f32; 2],
    pub(super) tilt: f32,
    /// The smallest and the largest place of a ray along the normal at the depth 0, and how far
    /// that moves for a depth of 1, beside the tilt, at most.
    pub(super) between: [f32; 2],
    pub(super) spread: f32,
}

impl PacketFrustum {
    /// `None` when the directions of the rays are not longest along one axis, with one sign, or
    /// rounding is too large.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "one derivation, each line of which needs those before"
    )]
    pub(super) fn new<L: Lanes>(l: L, packet: &MeshPacket<'_>) -> Option<Self> {
        let (packet, rays) = (packet.packet, packet.open);
        if rays.count_ones() < FEWEST {
            return None;
        }
        let first = rays.trailing_zeros() as usize % RAYS;
        let axes = packet.common_axes(rays)?;
        let forwards = packet.forwards[first];
        let signs = l.load(&packet.forwards);
        if rays & !l.same(signs, l.splat(forwards)) != 0 {
            return None;
        }
        let (least, most) = (f32::NEG_INFINITY, f32::INFINITY);
        // The smallest and the largest among the rays'.
        macro_rules! ends {
            ($values:expr) => {{
                let values = $values;
                [
                    l.smallest(l.select(rays, values, l.splat(most))),
                    l.largest(l.select(rays, values, l.splat(least))),
                ]
            }};
        }
        let [x, y, z] = &packet.start;
        let (zx, zy, zz) = (l.load(&x[0]), l.load(&y[0]), l.load(&z[0]));
        let [rear, _] = ends!(l.mul(signs, zz));
        let reference = [x[0][first], y[0][first], forwards * rear];
        let [_, largest] = ends!(l.max(l.max(l.abs(zx), l.abs(zy)), l.abs(zz)));
        let [_, blur] = ends!(l.load(&packet.blur));
        let margin = PACKET_PLANES * (1.0 + largest) + 4.0 * blur;
        // Written so that a NaN fails.
        let is_fine = margin < 1e-2;
        if !is_fine {
            return None;
        }
        macro_rules! from_reference {
            ($high:expr, $part:expr, $k:literal) => {
                l.add(l.sub($high, l.splat(reference[$k])), l.load(&$part[1]))
            };
        }
        let start_depth = l.mul(signs, from_reference!(zz, z, 2));
        let (sx, sy) = (l.load(&packet.slope[0]), l.load(&packet.slope[1]));
        let ax = l.neg_mul_add(sx, start_depth, from_reference!(zx, x, 0));
        let ay = l.neg_mul_add(sy, start_depth, from_reference!(zy, y, 1));
        let (at_zero_bounds, slope_bounds) = ([ends!(ax), ends!(ay)], [ends!(sx), ends!(sy)]);
        let [_, width] = ends!(l.max(l.max(l.abs(ax), l.abs(ay)), l.abs(start_depth)));
        let mut at_zero = [Aligned([0.0; RAYS]); 2];
        l.store(ax, &mut at_zero[0].0);
        l.store(ay, &mut at_zero[1].0);
        let last = rays.ilog2() as usize % RAYS;
        let (mut apart, mut turned) = ([0.0; 2], [0.0; 2]);
        for k in 0..2 {
            apart[k] = at_zero[k].0[last] - at_zero[k].0[first];
            turned[k] = packet.slope[k][last] - packet.slope[k][first];
        }
        let normal = normal(apart, turned);
        macro_rules! along_normal {
            ($x:expr, $y:expr) => {
                l.mul_add($y, l.splat(normal[1]), l.mul($x, l.splat(normal[0])))
            };
        }
        let between = ends!(along_normal!(ax, ay));
        let [low, high] = ends!(along_normal!(sx, sy));
        let tilt = 0.5 * (low + high);
        let mut out = Self {
            rays,
            axes,
            forwards,
            reference,
            at_zero_bounds: [wider(at_zero_bounds[0], margin), wider(at_zero_bounds[1], margin)],
            slope_bounds,
            at_zero,
            start_depth: Aligned([0.0; RAYS]),
            margin,
            error: PACKET_START * width + BLURS * blur,
            depth_error: DEPTH * width + BLURS * blur,
            normal,
            tilt,
            between: wider(between, PACKET_NORMAL * margin),
            spread: 0.5 * (high - low) + PACKET_SPREAD,
        };
        l.store(start_depth, &mut out.start_depth.0);
        Some(out)
    }

    /// The depth from the reference beyond which nothing matters to any ray.
    #[inline(always)]
    pub(super) fn limit<L: Lanes>(&self, l: L, limits: &[f32; RAYS]) -> f32 {
        let limits = l.load(limits);
        let matters = l.le(l.splat(0.0), limits);
        let depths = l.add(limits, l.load(&self.start_depth.0));
        self.margin + l.largest(l.select(matters, depths, l.splat(-2.0 - 3.0 * self.margin)))
    }

    /// The boxes of a node that the rays may meet at depths up to `limit`, and the depths from
    /// which on.
    #[inline(always)]
    pub(super) fn boxes<L: Lanes>(&self, l: L, node: &Node, limit: f32) -> (u16, L::Floats) {
        let [x, y, z] = self.axes;
        macro_rules! plane {
            ($axis:ident, $k:literal, $side:expr) => {
                l.sub(l.load(&node.planes[(2 * $axis + $side) % 6]), l.splat(self.reference[$k]))
            };
        }
        let is_back = usize::from(self.forwards < 0.0);
        let sign = l.splat(self.forwards);
        let near = l.mul(plane!(z, 2, is_back), sign);
        let far = l.mul(plane!(z, 2, 1 - is_back), sign);
        let mut met = l.le(near, l.splat(limit)) & l.le(l.splat(-self.margin), far);
        // Only the part of each box that is between the rearmost start and the limit.
        let near = l.max(near, l.splat(-self.margin));
        let far = l.min(far, l.splat(limit));
        let (low_x, high_x) = (plane!(x, 0, 0), plane!(x, 0, 1));
        let (low_y, high_y) = (plane!(y, 1, 0), plane!(y, 1, 1));
        // Of each box the corner that is farthest towards a plane's inside.
        macro_rules! inside {
            ($k:literal, $low:ident, $high:ident) => {{
                let [start, end] = self.at_zero_bounds[$k];
                let [least, most] = self.slope_bounds[$k];
                let depth = if least > 0.0 { near } else { far };
                met &= l.le(l.splat(start), l.neg_mul_add(l.splat(least), depth, $high));
                let depth = if most > 0.0 { far } else { near };
                met &= l.le(l.neg_mul_add(l.splat(most), depth, $low), l.splat(end));
            }};
        }
        inside!(0, low_x, high_x);
        inside!(1, low_y, high_y);
        let [normal_x, normal_y] = self.normal;
        macro_rules! ordered {
            ($factor:expr, $low:ident, $high:ident) => {
                if $factor > 0.0 { ($low, $high) } else { ($high, $low) }
            };
        }
        let (less_x, more_x) = ordered!(normal_x, low_x, high_x);
        let (less_y, more_y) = ordered!(normal_y, low_y, high_y);
        let (less_z, more_z) = ordered!(-self.tilt, near, far);
        let wide = l.mul(l.splat(self.spread), l.max(far, l.splat(0.0)));
        macro_rules! along {
            ($x:ident, $y:ident, $z:ident) => {
                l.mul_add(
                    l.splat(normal_x),
                    $x,
                    l.neg_mul_add(l.splat(self.tilt), $z, l.mul(l.splat(normal_y), $y)),
                )
            };
        }
        let most = l.add(along!(more_x, more_y, more_z), wide);
        let least = l.sub(along!(less_x, less_y, less_z), wide);
        let [low, high] = self.between;
        met &= l.le(l.splat(low), most) & l.le(least, l.splat(high));
        (met, l.max(near, l.splat(0.0)))
    }
}

/// An interval that is wider at both ends.
#[inline(always)]
fn wider([low, high]: [f32; 2], by: f32) -> [f32; 2] {
    [low - by, high + by]
}

/// The normal across the depth of the plane that the rays are in, from the difference in start and
/// in slope between the first and the last of them. One part is 1 or -1; both are 0 where there is
/// no difference.
#[inline(always)]
fn normal([x, y]: [f32; 2], [along_x, along_y]: [f32; 2]) -> [f32; 2] {
    let (size, change) = (x.abs().max(y.abs()), along_x.abs().max(along_y.abs()));
    let (x, y, size) = if change > size { (along_x, along_y, change) } else { (x, y, size) };
    if size > 0.0 { [y / size, -x / size] } else { [0.0; 2] }
}
