//! The triangles of a leaf into a tile's visibility buffer: which pixels meet which triangles, and
//! where are these nearest?
//!
//! 1. Bring the leaf's vertices into the tile's coordinates (`frustum.rs`), and find the samples in
//!    each triangle's bounding box.
//! 2. Set up the sides of all sixteen triangles' edges, a triangle in each lane. A side is linear
//!    in the sample's place.
//! 3. Test the samples of triangles that have up to 2 x 2 of them, still a triangle in each lane
//!    (`raster/small.rs`).
//! 4. Test larger triangles block by block of 4 x 4 pixels, a pixel in each lane
//!    (`raster/large.rs`).
//! 5. Where the edge test and the depths leave open which triangle a pixel meets first, ask the
//!    [`ExactTest`].
//!
//! Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", Graphics
//! Hardware 1997. It departs in that every number has an error bound (see `frustum.rs`), and the
//! exact test decides what lies within it.

mod large;
mod small;

use super::edge_test::all_beside;
use super::frustum::{HALF, TileFrustum};
use super::visibility::{Displacements, ExactTest, TriangleId, VisibilityBuffer, row_and_column};
use crate::accel::bounds::ROUNDED_DEPTH;
use crate::accel::meshlet::Meshlet;
use crate::simd::{LANES, Lanes, set_bits};
use large::EDGE;
use small::Parts;

/// A leaf and a tile.
pub(super) struct LeafRaster<'a, A> {
    pub(super) frustum: &'a TileFrustum,
    /// The displacements of the rays from the grid, if they are off it.
    pub(super) displacements: Option<&'a Displacements>,
    pub(super) leaf: &'a Meshlet,
    /// The lanes of the leaf that have a triangle, a bit each.
    pub(super) filled: u16,
    /// The index of the leaf's first triangle, to be prefetched.
    pub(super) first: Option<&'a u32>,
    pub(super) object: u32,
    pub(super) leaf_lane: u32,
    pub(super) buffer: &'a mut VisibilityBuffer,
    pub(super) exact: &'a mut A,
    pub(super) scratch: &'a mut RasterScratch,
    /// The blocks with a new hit.
    pub(super) changed: u16,
}

/// Sides of the three edges for sixteen triangles, each linear in the place of a sample relative to
/// the triangle's first: `constant + column * across + row * down`.
#[repr(C, align(64))]
#[derive(Debug, Default)]
struct Edges {
    constant: [[f32; LANES]; 3],
    across: [[f32; LANES]; 3],
    down: [[f32; LANES]; 3],
}

/// The leaf's triangles in arrays, to take single ones from. Entries that a leaf does not write are
/// those of an earlier leaf.
#[repr(C, align(64))]
#[derive(Debug, Default)]
pub(super) struct RasterScratch {
    edges: Edges,
    bound: [f32; LANES],
    /// The bounds for ranges of samples, which may be off the grid.
    bound_of_ranges: [f32; LANES],
    /// The corners' depths.
    depths: [[f32; LANES]; 3],
    nearest: [f32; LANES],
    farthest: [f32; LANES],
    first_column: [f32; LANES],
    last_column: [f32; LANES],
    first_row: [f32; LANES],
    last_row: [f32; LANES],
}

impl<A: ExactTest> LeafRaster<'_, A> {
    /// Puts the leaf's triangles into the buffer where they are nearest. All of the leaf is at
    /// depths from `entry` on.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "straight-line lane code; functions would hand on twenty registers"
    )]
    pub(super) fn run<L: Lanes>(&mut self, l: L, entry: f32, limit: f32) {
        let frustum = self.frustum;
        let [x, y, z] = frustum.transformed(l, self.leaf);
        let [a, b, c] = &self.leaf.corners;
        let (az, bz, cz) = (l.permute(z, a), l.permute(z, b), l.permute(z, c));
        let (error, absolute) = (frustum.error(self.leaf), frustum.absolute(self.leaf));
        let blur = l.splat(frustum.depth_error);
        let nearest = l.sub(l.min(l.min(az, bz), cz), blur);
        let farthest = l.add(l.max(l.max(az, bz), cz), blur);
        let mut alive = self.filled
            & l.le(nearest, l.splat(limit))
            & l.le(l.splat(frustum.start_depth), farthest);

        // Which samples the triangle's bounding box holds.
        let last = |count: usize| l.splat(count as f32 - 1.0);
        let (last_column, last_row) = (last(self.buffer.columns), last(self.buffer.rows));
        let mut columns = [l.splat(0.0), last_column];
        let mut rows = [l.splat(0.0), last_row];
        let is_behind = frustum.is_perspective && entry <= 4.0 * frustum.depth_error;
        if !is_behind {
            let (px, py, pad) = if frustum.is_perspective {
                let inverse = l.div(l.splat(1.0), z);
                let pad = (error + 30.0 * frustum.depth_error) / entry + frustum.share;
                (l.mul(x, inverse), l.mul(y, inverse), pad)
            } else {
                (x, y, error)
            };
            let pad = 1.1 * pad + 1e-4;
            let (less, more) = (l.splat(HALF - pad), l.splat(HALF + pad));
            let (pa, pb, pc) = (l.permute(px, a), l.permute(px, b), l.permute(px, c));
            let (qa, qb, qc) = (l.permute(py, a), l.permute(py, b), l.permute(py, c));
            columns[0] = l.max(columns[0], l.ceil(l.add(l.min(l.min(pa, pb), pc), less)));
            columns[1] = l.min(columns[1], l.floor(l.add(l.max(l.max(pa, pb), pc), more)));
            rows[0] = l.max(rows[0], l.ceil(l.add(l.min(l.min(qa, qb), qc), less)));
            rows[1] = l.min(rows[1], l.floor(l.add(l.max(l.max(qa, qb), qc), more)));
            alive &= l.le(columns[0], columns[1]) & l.le(rows[0], rows[1]);
        }
        if alive == 0 {
            return;
        }
        // The answer needs the triangle's index in the mesh.
        if let Some(first) = self.first {
            l.prefetch(first);
        }

        // The corners relative to the first of those samples.
        let one = l.splat(1.0);
        let half = l.splat(HALF);
        let first_x = l.sub(columns[0], half);
        let first_y = l.sub(rows[0], half);
        let (ah, bh, ch) = if frustum.is_perspective { (az, bz, cz) } else { (one, one, one) };
        let ax = l.neg_mul_add(first_x, ah, l.permute(x, a));
        let bx = l.neg_mul_add(first_x, bh, l.permute(x, b));
        let cx = l.neg_mul_add(first_x, ch, l.permute(x, c));
        let ay = l.neg_mul_add(first_y, ah, l.permute(y, a));
        let by = l.neg_mul_add(first_y, bh, l.permute(y, b));
        let cy = l.neg_mul_add(first_y, ch, l.permute(y, c));
        let width = l.sub(columns[1], columns[0]);
        let height = l.sub(rows[1], rows[0]);
        let x = l.max(l.max(l.abs(ax), l.abs(bx)), l.abs(cx));
        let y = l.max(l.max(l.abs(ay), l.abs(by)), l.abs(cy));
        let h = l.max(l.max(l.abs(ah), l.abs(bh)), l.abs(ch));
        // The bound of the sides at samples up to that many pixels from the triangle's first
        // sample.
        macro_rules! bound_within {
            ($across:expr, $down:expr) => {{
                let size = l.mul_add(l.add($across, $down), h, l.add(x, y));
                let share = l.mul_add(l.splat(frustum.relative), size, l.splat(absolute));
                l.mul(share, size)
            }};
        }
        let most = l.splat(self.displacements.map_or(0.0, |off| off.most));
        let bound = bound_within!(l.add(width, most), l.add(height, most));
        let constants = [
            l.mul_sub(cx, by, l.mul(cy, bx)),
            l.mul_sub(ax, cy, l.mul(ay, cx)),
            l.mul_sub(bx, ay, l.mul(by, ax)),
        ];
        let across = [
            l.mul_sub(cy, bh, l.mul(ch, by)),
            l.mul_sub(ay, ch, l.mul(ah, cy)),
            l.mul_sub(by, ah, l.mul(bh, ay)),
        ];
        let down = [
            l.mul_sub(ch, bx, l.mul(cx, bh)),
            l.mul_sub(ah, cx, l.mul(ax, ch)),
            l.mul_sub(bh, ax, l.mul(bx, ah)),
        ];
        // A sample that is off the grid has other sides than the grid's point.
        macro_rules! bound_of_ranges {
            ($bound:expr) => {{
                let slope = |k: usize| l.add(l.abs(across[k]), l.abs(down[k]));
                let steepest = l.max(l.max(slope(0), slope(1)), slope(2));
                l.mul_add(most, steepest, $bound)
            }};
        }
        l.store(columns[0], &mut self.scratch.first_column);
        l.store(rows[0], &mut self.scratch.first_row);
        l.store(nearest, &mut self.scratch.nearest);
        l.store(farthest, &mut self.scratch.farthest);

        let small = alive & l.le(width, one) & l.le(height, one);
        if small != 0 {
            let parts = Parts {
                constants,
                across,
                down,
                bound,
                depths: [az, bz, cz],
                nearest,
                farthest,
                width,
                height,
            };
            self.small(l, &parts, small);
        }
        let mut large = alive & !small;
        if large != 0 {
            let bound = bound_of_ranges!(bound);
            large &= !all_beside(l, [constants, across, down], [width, height], bound);
        }
        if large != 0 {
            // Blocks begin before the triangle and end behind it.
            let edge = l.add(l.splat(EDGE), most);
            let bound = bound_within!(l.add(width, edge), l.add(height, edge));
            for k in 0..3 {
                l.store(constants[k], &mut self.scratch.edges.constant[k]);
                l.store(across[k], &mut self.scratch.edges.across[k]);
                l.store(down[k], &mut self.scratch.edges.down[k]);
            }
            l.store(az, &mut self.scratch.depths[0]);
            l.store(bz, &mut self.scratch.depths[1]);
            l.store(cz, &mut self.scratch.depths[2]);
            l.store(bound, &mut self.scratch.bound);
            l.store(bound_of_ranges!(bound), &mut self.scratch.bound_of_ranges);
            l.store(columns[1], &mut self.scratch.last_column);
            l.store(rows[1], &mut self.scratch.last_row);
        }
        for lane in set_bits(large) {
            self.large(l, lane);
        }
    }

    #[inline(always)]
    fn triangle(&self, lane: usize) -> TriangleId {
        #[expect(clippy::cast_possible_truncation, reason = "one of sixteen")]
        let lane = lane as u32;
        TriangleId { object: self.object, leaf_lane: self.leaf_lane + lane }
    }

    /// Step 5, for the pixel of a lane in a block.
    #[cold]
    #[inline(never)]
    fn decide<L: Lanes>(&mut self, l: L, (block, lane): (usize, usize), new: TriangleId) {
        let old = self.buffer.triangle(block, lane);
        let (row, column) = row_and_column(block, lane);
        let Some((triangle, depth)) = self.exact.nearer(l, row, column, old, new) else {
            return;
        };
        #[expect(clippy::cast_possible_truncation, reason = "the rounding is allowed for")]
        let depth = depth as f32;
        let error = self.frustum.depth_error + depth.abs() * ROUNDED_DEPTH;
        self.buffer.set(block, lane, triangle, depth - error, depth + error);
        self.changed |= 1 << block;
    }
}
