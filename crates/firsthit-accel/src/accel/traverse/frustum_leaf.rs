//! A leaf and a packet's frustum: which of the leaf's triangles may the rays meet, and which ray
//! meets which of them?
//!
//! 1. Test the leaf's sixteen triangles against the planes of the frustum, a triangle in each lane.
//! 2. Bound the error of the sides of their edges, for rays inside each triangle and for all rays.
//! 3. Test each triangle that is left against the sixteen rays, a ray in each lane (`edges.rs`).
//! 4. Show each triangle that a ray may meet to the query of the ray.
//!
//! # Error bounds
//!
//! The bounds of `filter.rs` hold, with what `frustum.rs` says that a sheared coordinate is off. A
//! triangle's extent across the rays is measured with the smallest and the largest slope, and that
//! is the extent along any slope between.

use super::frustum::PacketFrustum;
use super::mesh_packet::MeshPacket;
use super::query::MeshQuery;
use crate::accel::bounds::{
    DEPTH, MEAN, PACKET_EXTENT, PACKET_VERTEX, SIDE_BY_ERROR, SIDE_BY_SIZE,
};
use crate::accel::edges::{Sides, depths};
use crate::accel::meshlet::Meshlet;
use crate::accel::rays::packet::RAYS;
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// A leaf as it is seen from the reference.
#[repr(C, align(64))]
pub(super) struct LeafView {
    // For each vertex.
    x: [f32; LANES],
    y: [f32; LANES],
    depth: [f32; LANES],
    // For each triangle: its nearest and farthest depth, and the bound of its sides, for rays
    // inside it and for all rays.
    nearest: [f32; LANES],
    farthest: [f32; LANES],
    bound: [f32; LANES],
    sure: [f32; LANES],
}

impl LeafView {
    pub(super) const NOTHING: Self = Self {
        x: [0.0; LANES],
        y: [0.0; LANES],
        depth: [0.0; LANES],
        nearest: [0.0; LANES],
        farthest: [0.0; LANES],
        bound: [0.0; LANES],
        sure: [0.0; LANES],
    };
}

impl PacketFrustum {
    /// The triangles of a leaf that the rays may meet at depths up to `limit`, a bit each.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "straight-line lane code; functions would hand on twenty registers"
    )]
    pub(super) fn triangles<L: Lanes>(
        &self,
        l: L,
        leaf: &Meshlet,
        limit: f32,
        view: &mut LeafView,
    ) -> u16 {
        let [x, y, z] = self.axes;
        macro_rules! relative {
            ($axis:ident, $k:literal) => {
                l.sub(l.load(&leaf.vertices[$axis % 3]), l.splat(self.reference[$k]))
            };
        }
        let depth = l.mul(relative!(z, 2), l.splat(self.forwards));
        let (x, y) = (relative!(x, 0), relative!(y, 1));
        let [a, b, c] = &leaf.corners;
        // The smallest and the largest of the triangles' corners.
        macro_rules! ends {
            ($values:expr) => {{
                let values = $values;
                let (first, second) = (l.permute(values, a), l.permute(values, b));
                let third = l.permute(values, c);
                (l.min(l.min(first, second), third), l.max(l.max(first, second), third))
            }};
        }
        let (nearest, farthest) = ends!(depth);
        let mut met = leaf.filled & l.le(nearest, l.splat(limit));
        met &= l.le(l.splat(-self.margin), farthest);
        macro_rules! inside {
            ($k:literal, $place:ident) => {{
                let [start, end] = self.at_zero_bounds[$k];
                let [low, high] = self.slope_bounds[$k];
                let (least, most) = ends!(l.neg_mul_add(l.splat(low), depth, $place));
                let (other, last) = ends!(l.neg_mul_add(l.splat(high), depth, $place));
                met &= l.le(l.splat(start), most) & l.le(other, l.splat(end));
                let wide = l.sub(farthest, nearest);
                let size = l.mul_add(l.splat(high - low), wide, l.sub(most, least));
                let right = l.sub(l.max(most, last), l.splat(start));
                let left = l.sub(l.splat(end), l.min(least, other));
                (size, l.max(left, right))
            }};
        }
        // How far the triangles extend across any of the rays, and how far their corners are from
        // any ray.
        let ((size_x, away_x), (size_y, away_y)) = (inside!(0, x), inside!(1, y));
        let [normal_x, normal_y] = self.normal;
        let along = l.neg_mul_add(
            l.splat(self.tilt),
            depth,
            l.mul_add(l.splat(normal_x), x, l.mul(l.splat(normal_y), y)),
        );
        let (least, most) = ends!(along);
        let wide = l.mul(l.splat(self.spread), l.max(farthest, l.splat(0.0)));
        let [low, high] = self.between;
        met &= l.le(l.splat(low), l.add(most, wide)) & l.le(l.sub(least, wide), l.splat(high));
        if met == 0 {
            return 0;
        }
        l.store(x, &mut view.x);
        l.store(y, &mut view.y);
        l.store(depth, &mut view.depth);
        l.store(nearest, &mut view.nearest);
        l.store(farthest, &mut view.farthest);
        let deep = l.max(l.abs(nearest), l.abs(farthest));
        macro_rules! bound {
            ($size:expr) => {{
                let size = $size;
                let fixed = l.mul_add(size, l.splat(PACKET_EXTENT), l.splat(self.error));
                let error = l.mul_add(deep, l.splat(PACKET_VERTEX), fixed);
                let size = l.mul_add(error, l.splat(4.2), l.mul(size, l.splat(1.01)));
                let share =
                    l.mul_add(error, l.splat(SIDE_BY_ERROR), l.mul(size, l.splat(SIDE_BY_SIZE)));
                l.mul(share, size)
            }};
        }
        l.store(bound!(l.max(size_x, size_y)), &mut view.bound);
        l.store(bound!(l.max(away_x, away_y)), &mut view.sure);
        met
    }

    /// Tests a triangle against all rays; returns whether a ray's limit has changed.
    #[inline(always)]
    pub(super) fn visit<L: Lanes, Q: MeshQuery>(
        &self,
        l: L,
        packet: &MeshPacket<'_>,
        (index, triangle): (u32, usize),
        view: &LeafView,
        limits: &mut [f32; RAYS],
        queries: &mut [Q; RAYS],
    ) -> bool {
        let leaf = &packet.tree.leaves[index as usize];
        let slopes = &packet.packet.slope;
        let slope = [l.load(&slopes[0]), l.load(&slopes[1])];
        let at_zero = [l.load(&self.at_zero[0].0), l.load(&self.at_zero[1].0)];
        macro_rules! corner {
            ($k:literal) => {{
                let vertex = leaf.vertex(triangle, $k);
                let depth = l.splat(view.depth[vertex]);
                [
                    l.neg_mul_add(slope[0], depth, l.sub(l.splat(view.x[vertex]), at_zero[0])),
                    l.neg_mul_add(slope[1], depth, l.sub(l.splat(view.y[vertex]), at_zero[1])),
                    depth,
                ]
            }};
        }
        let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (corner!(0), corner!(1), corner!(2));
        let sides = Sides::new(l, [ax, ay], [bx, by], [cx, cy]);
        let outside = sides.outside(l, l.splat(view.bound[triangle]));
        if self.rays & !outside == 0 {
            return false;
        }
        let limit = l.load(limits);
        let start_depth = l.load(&self.start_depth.0);
        let (nearest, farthest) = (view.nearest[triangle], view.farthest[triangle]);
        let slack = nearest.abs().max(farthest.abs()) * DEPTH + self.depth_error;
        let spread = MEAN * (farthest - nearest);
        let nearest = l.sub(l.splat(nearest - slack), start_depth);
        let farthest = l.sub(l.splat(farthest + slack), start_depth);
        let certain = sides.inside(l, l.splat(view.sure[triangle]));
        let [depth, over] = sides.depth(l, [az, bz, cz]);
        let depth = l.sub(depth, start_depth);
        let weights = l.mul(l.splat(view.bound[triangle] * spread), over);
        let error = l.add(weights, l.splat(slack));
        let [low, high] = depths(l, certain, [depth, error], [nearest, farthest]);
        let mut possible = self.rays & !outside & l.le(l.splat(0.0), limit);
        possible &= l.le(low, limit) & l.le(l.splat(0.0), high);
        if possible == 0 {
            return false;
        }
        let mut lows = Aligned([0.0; LANES]);
        let mut highs = lows;
        l.store(low, &mut lows.0);
        l.store(high, &mut highs.0);
        let mut has_changed = false;
        for lane in set_bits(possible) {
            let is_certain = certain >> lane & 1 == 1;
            let query = &mut queries[lane];
            let depths = (lows.0[lane], highs.0[lane]);
            let triangle = (index, triangle);
            query.visit_one(l, &packet.ray(lane), triangle, depths, is_certain);
            has_changed |= query.limit() < limits[lane];
            limits[lane] = query.limit();
        }
        has_changed
    }
}
