//! A leaf and a beam: which of its triangles may it meet, and which of them is met by which rays?
//!
//! The verdicts are those of `filter.rs`, with rays in the lanes.

use super::super::goal::Question;
use super::super::meshlet::Meshlet;
use super::super::packet::RAYS;
use super::super::ray::U;
use super::super::search::Search;
use super::space::Beam;
use crate::simd::{Aligned, LANES, Lanes};

/// A leaf from the reference.
#[repr(C, align(64))]
pub(super) struct Seen {
    // For each vertex.
    x: [f32; LANES],
    y: [f32; LANES],
    depth: [f32; LANES],
    // For each triangle: its depths, and what a side of its edges is off for rays inside it, and for all.
    nearest: [f32; LANES],
    farthest: [f32; LANES],
    bound: [f32; LANES],
    sure: [f32; LANES],
}

impl Seen {
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

impl Beam {
    /// Which of a leaf's triangles the beam may meet at depths up to `limit`.
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
        seen: &mut Seen,
    ) -> u16 {
        let [x, y, z] = self.axes;
        macro_rules! relative {
            ($axis:ident, $k:literal) => {
                l.sub(
                    l.load(&leaf.vertices[$axis % 3]),
                    l.splat(self.reference[$k]),
                )
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
                (
                    l.min(l.min(first, second), third),
                    l.max(l.max(first, second), third),
                )
            }};
        }
        let (nearest, farthest) = ends!(depth);
        let mut met = leaf.filled & l.le(nearest, l.splat(limit));
        met &= l.le(l.splat(-self.margin), farthest);
        macro_rules! inside {
            ($k:literal, $place:ident) => {{
                let [start, end] = self.starts[$k];
                let [low, high] = self.slopes[$k];
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
        // How far the triangles extend, sheared along any of the slopes, and how far a corner is from any ray.
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
        l.store(x, &mut seen.x);
        l.store(y, &mut seen.y);
        l.store(depth, &mut seen.depth);
        l.store(nearest, &mut seen.nearest);
        l.store(farthest, &mut seen.farthest);
        // As in `filter.rs`.
        let deep = l.max(l.abs(nearest), l.abs(farthest));
        macro_rules! bound {
            ($size:expr) => {{
                let size = $size;
                let fixed = l.mul_add(size, l.splat(3.5 * U), l.splat(self.error));
                let error = l.mul_add(deep, l.splat(5.5 * U), fixed);
                let size = l.mul_add(error, l.splat(4.2), l.mul(size, l.splat(1.01)));
                let share = l.mul_add(error, l.splat(4.3), l.mul(size, l.splat(9.2 * U)));
                l.mul(share, size)
            }};
        }
        l.store(bound!(l.max(size_x, size_y)), &mut seen.bound);
        l.store(bound!(l.max(away_x, away_y)), &mut seen.sure);
        met
    }

    /// A triangle and all rays; whether a limit has changed.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "straight-line lane code; functions would hand on twenty registers"
    )]
    pub(super) fn meet<L: Lanes, Q: Question>(
        &self,
        l: L,
        search: &Search<'_>,
        (index, triangle): (u32, usize),
        seen: &Seen,
        limits: &mut [f32; RAYS],
        questions: &mut [Q; RAYS],
    ) -> bool {
        let leaf = &search.tree.leaves[index as usize];
        let slopes = &search.packet.slope;
        let slope = [l.load(&slopes[0]), l.load(&slopes[1])];
        let start = [l.load(&self.start[0].0), l.load(&self.start[1].0)];
        macro_rules! corner {
            ($k:literal) => {{
                let vertex = leaf.vertex(triangle, $k);
                let depth = l.splat(seen.depth[vertex]);
                [
                    l.neg_mul_add(slope[0], depth, l.sub(l.splat(seen.x[vertex]), start[0])),
                    l.neg_mul_add(slope[1], depth, l.sub(l.splat(seen.y[vertex]), start[1])),
                    depth,
                ]
            }};
        }
        let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (corner!(0), corner!(1), corner!(2));
        let u = l.mul_sub(cx, by, l.mul(cy, bx));
        let v = l.mul_sub(ax, cy, l.mul(ay, cx));
        let w = l.mul_sub(bx, ay, l.mul(by, ax));
        let (least, most) = (l.min(l.min(u, v), w), l.max(l.max(u, v), w));
        let (minus, plus) = (
            l.splat(-seen.bound[triangle]),
            l.splat(seen.bound[triangle]),
        );
        let outside = l.lt(least, minus) & l.lt(plus, most);
        if self.rays & !outside == 0 {
            return false;
        }
        let limit = l.load(limits);
        let behind = l.load(&self.behind.0);
        let (nearest, farthest) = (seen.nearest[triangle], seen.farthest[triangle]);
        let slack = nearest.abs().max(farthest.abs()) * (24.0 * U) + self.depth_error;
        let spread = 2.1 * (farthest - nearest);
        let nearest = l.sub(l.splat(nearest - slack), behind);
        let farthest = l.sub(l.splat(farthest + slack), behind);
        let sure = seen.sure[triangle];
        let certain = l.lt(l.splat(sure), least) | l.lt(most, l.splat(-sure));
        let over = l.div(l.splat(1.0), l.add(l.add(u, v), w));
        let depth = l.mul_add(u, az, l.mul_add(v, bz, l.mul(w, cz)));
        let depth = l.sub(l.mul(depth, over), behind);
        let weights = l.mul(l.splat(seen.bound[triangle] * spread), l.abs(over));
        let around = l.add(weights, l.splat(slack));
        let low = l.select(certain, l.max(l.sub(depth, around), nearest), nearest);
        let high = l.select(certain, l.min(l.add(depth, around), farthest), farthest);
        let mut possible = self.rays & !outside & l.le(l.splat(0.0), limit);
        possible &= l.le(low, limit) & l.le(l.splat(0.0), high);
        if possible == 0 {
            return false;
        }
        let mut lows = Aligned([0.0; LANES]);
        let mut highs = lows;
        l.store(low, &mut lows.0);
        l.store(high, &mut highs.0);
        let mut is_less = false;
        while possible != 0 {
            let lane = possible.trailing_zeros() as usize % RAYS;
            possible &= possible - 1;
            let is_certain = certain >> lane & 1 == 1;
            let question = &mut questions[lane];
            let depths = (lows.0[lane], highs.0[lane]);
            question.meet_one(
                l,
                &search.place(lane),
                (index, triangle),
                depths,
                is_certain,
            );
            is_less |= question.limit() < limits[lane];
            limits[lane] = question.limit();
        }
        is_less
    }
}
