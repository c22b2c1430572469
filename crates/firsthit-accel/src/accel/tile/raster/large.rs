//! Triangles whose bounding boxes hold more samples: block by block of 4 x 4 pixels, a pixel in
//! each lane.
//!
//! 1. Take the blocks in which the bounding box has samples, and that have a pixel which is not
//!    nearer.
//! 2. Leave out those that are beyond one of the edges, a block in each lane: a linear side is
//!    largest and smallest at corners.
//! 3. Test the sixteen pixels of each block that is left, and put the triangle in where it is
//!    nearer.

use super::{LeafRaster, RasterScratch};
use crate::accel::tile::edge_test::{EdgeTest, beside};
use crate::accel::tile::visibility::{BLOCK, ExactTest};
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// The distance from a block's first pixel to its last, along a row.
pub(super) const EDGE: f32 = BLOCK as f32 - 1.0;

/// The columns of a block's pixels, and of a tile's blocks.
static ACROSS: Aligned<[f32; LANES]> =
    Aligned([0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]);

/// The rows.
static DOWN: Aligned<[f32; LANES]> =
    Aligned([0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0]);

impl<A: ExactTest> LeafRaster<'_, A> {
    /// Tests the triangle in a lane, block by block.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "straight-line lane code; functions would hand on twenty registers"
    )]
    pub(super) fn large<L: Lanes>(&mut self, l: L, lane: usize) {
        let scratch = &*self.scratch;
        let nearest = scratch.nearest[lane];
        let mut blocks =
            scratch.blocks(lane) & l.le(l.splat(nearest), l.load(&self.buffer.farthest));
        if blocks == 0 {
            return;
        }
        // The sides at the blocks' first pixels, a lane for each block, and what is to be added for
        // the others, a lane for each pixel.
        let edges = &scratch.edges;
        let (x, y) = (l.load(&ACROSS.0), l.load(&DOWN.0));
        let four = l.splat(BLOCK as f32);
        let block_x = l.mul_sub(four, x, l.splat(scratch.first_column[lane]));
        let block_y = l.mul_sub(four, y, l.splat(scratch.first_row[lane]));
        macro_rules! first {
            ($k:literal) => {{
                let along = l.mul_add(
                    l.splat(edges.down[$k][lane]),
                    block_y,
                    l.splat(edges.constant[$k][lane]),
                );
                l.mul_add(l.splat(edges.across[$k][lane]), block_x, along)
            }};
        }
        macro_rules! inside {
            ($k:literal) => {{
                let along = l.mul(l.splat(edges.down[$k][lane]), y);
                l.mul_add(l.splat(edges.across[$k][lane]), x, along)
            }};
        }
        macro_rules! end {
            ($k:literal, $choose:ident) => {{
                let end = edges.down[$k][lane].$choose(0.0) + edges.across[$k][lane].$choose(0.0);
                l.splat(EDGE * end)
            }};
        }
        let first = [first!(0), first!(1), first!(2)];
        let bound = l.splat(scratch.bound[lane]);
        let bound_of_ranges = l.splat(scratch.bound_of_ranges[lane]);
        let most = [
            l.add(first[0], end!(0, max)),
            l.add(first[1], end!(1, max)),
            l.add(first[2], end!(2, max)),
        ];
        let least = [
            l.add(first[0], end!(0, min)),
            l.add(first[1], end!(1, min)),
            l.add(first[2], end!(2, min)),
        ];
        blocks &= !beside(l, most, least, bound_of_ranges);
        let inside = [inside!(0), inside!(1), inside!(2)];
        let mut firsts = Aligned([[0.0; LANES]; 3]);
        l.store(first[0], &mut firsts.0[0]);
        l.store(first[1], &mut firsts.0[1]);
        l.store(first[2], &mut firsts.0[2]);
        let depths = [
            l.splat(scratch.depths[0][lane]),
            l.splat(scratch.depths[1][lane]),
            l.splat(scratch.depths[2][lane]),
        ];
        let ends = [l.splat(nearest), l.splat(scratch.farthest[lane])];
        for block in set_bits(blocks) {
            let mut sides = [
                l.add(inside[0], l.splat(firsts.0[0][block])),
                l.add(inside[1], l.splat(firsts.0[1][block])),
                l.add(inside[2], l.splat(firsts.0[2][block])),
            ];
            if let Some(off) = self.displacements {
                let (x, y) = (l.load(&off.across[block]), l.load(&off.down[block]));
                let edges = &self.scratch.edges;
                for (k, side) in sides.iter_mut().enumerate() {
                    let along = l.mul_add(l.splat(edges.down[k][lane]), y, *side);
                    *side = l.mul_add(l.splat(edges.across[k][lane]), x, along);
                }
            }
            let error = self.frustum.depth_error;
            let test = EdgeTest::new(l, sides, bound, depths, ends, error, u16::MAX);
            if let Some(test) = test {
                self.meet_block(l, block, lane, &test);
            }
        }
    }

    #[inline(always)]
    fn meet_block<L: Lanes>(&mut self, l: L, block: usize, lane: usize, test: &EdgeTest<L>) {
        let (low, high) = (l.load(&self.buffer.low[block]), l.load(&self.buffer.high[block]));
        let possible = test.possible
            & l.le(test.low, high)
            & l.le(l.splat(self.frustum.start_depth), test.high);
        if possible == 0 {
            return;
        }
        let wins = possible
            & test.certain
            & l.lt(test.high, low)
            & l.lt(l.splat(self.frustum.start_depth), test.low);
        let triangle = self.triangle(lane);
        if wins != 0 {
            l.store(l.select(wins, test.low, low), &mut self.buffer.low[block]);
            l.store(l.select(wins, test.high, high), &mut self.buffer.high[block]);
            let slots = &mut self.buffer.leaf_lanes[block];
            let slot = l.splat(f32::from_bits(triangle.leaf_lane));
            l.store(l.select(wins, slot, l.load(slots)), slots);
            let objects = &mut self.buffer.objects[block];
            let object = l.splat(f32::from_bits(triangle.object));
            l.store(l.select(wins, object, l.load(objects)), objects);
            self.changed |= 1 << block;
        }
        for pixel in set_bits(possible & !wins) {
            self.decide(l, (block, pixel), triangle);
        }
    }
}

impl RasterScratch {
    /// The blocks in which a triangle's bounding box has samples.
    #[inline(always)]
    fn blocks(&self, lane: usize) -> u16 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small whole numbers"
        )]
        let block = |x: f32| x as usize / BLOCK % BLOCK;
        let below = |first: usize| u16::MAX << first;
        let (left, right) = (block(self.first_column[lane]), block(self.last_column[lane]));
        let (top, bottom) = (block(self.first_row[lane]), block(self.last_row[lane]));
        let columns = (below(left) & !below(right + 1) & 0b1111) * 0b0001_0001_0001_0001;
        columns & below(BLOCK * top) & (u16::MAX >> (BLOCK * (BLOCK - 1 - bottom)))
    }
}
