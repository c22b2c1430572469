//! Triangles whose bounding boxes hold up to 2 x 2 samples: a triangle in each lane.

use super::LeafRaster;
use crate::accel::tile::edge_test::EdgeTest;
use crate::accel::tile::visibility::{ExactTest, TILE, block_and_lane};
use crate::simd::{Aligned, LANES, Lanes, set_bits};

/// A leaf's triangles in lanes.
pub(super) struct Parts<L: Lanes> {
    pub(super) constants: [L::Floats; 3],
    pub(super) across: [L::Floats; 3],
    pub(super) down: [L::Floats; 3],
    pub(super) bound: L::Floats,
    pub(super) depths: [L::Floats; 3],
    pub(super) nearest: L::Floats,
    pub(super) farthest: L::Floats,
    pub(super) width: L::Floats,
    pub(super) height: L::Floats,
}

impl<A: ExactTest> LeafRaster<'_, A> {
    /// Tests the samples of the triangles in the lanes `small`.
    #[inline(always)]
    pub(super) fn small<L: Lanes>(&mut self, l: L, parts: &Parts<L>, small: u16) {
        for down in 0..2_u8 {
            for across in 0..2_u8 {
                let (row, column) = (l.splat(f32::from(down)), l.splat(f32::from(across)));
                let here = small & l.le(column, parts.width) & l.le(row, parts.height);
                if here == 0 {
                    continue;
                }
                let [column, row] = self.samples(l, here, [column, row], [across, down]);
                macro_rules! side {
                    ($k:literal) => {{
                        let along = l.mul_add(parts.across[$k], column, parts.constants[$k]);
                        l.mul_add(parts.down[$k], row, along)
                    }};
                }
                let test = EdgeTest::new(
                    l,
                    [side!(0), side!(1), side!(2)],
                    parts.bound,
                    parts.depths,
                    [parts.nearest, parts.farthest],
                    self.frustum.depth_error,
                    here,
                );
                let Some(test) = test else {
                    continue;
                };
                let mut lows = Aligned([0.0; LANES]);
                let mut highs = lows;
                l.store(test.low, &mut lows.0);
                l.store(test.high, &mut highs.0);
                let mut possible = test.possible;
                while possible != 0 {
                    let lane = possible.trailing_zeros() as usize;
                    possible &= possible - 1;
                    let at = self.pixel(lane, [across, down]);
                    let is_certain = test.certain >> lane & 1 == 1;
                    let depths = (lows.0[lane], highs.0[lane]);
                    self.meet(l, at, lane, depths, is_certain);
                }
            }
        }
    }

    /// The columns and rows of samples where they are: off the grid, if it is known by how much.
    #[inline(always)]
    fn samples<L: Lanes>(
        &self,
        l: L,
        here: u16,
        [column, row]: [L::Floats; 2],
        offset: [u8; 2],
    ) -> [L::Floats; 2] {
        let Some(off) = self.displacements else {
            return [column, row];
        };
        let (mut x, mut y) = (Aligned([0.0; LANES]), Aligned([0.0; LANES]));
        for lane in set_bits(here) {
            let (block, pixel) = self.pixel(lane, offset);
            x.0[lane] = off.across[block][pixel];
            y.0[lane] = off.down[block][pixel];
        }
        [l.add(column, l.load(&x.0)), l.add(row, l.load(&y.0))]
    }

    /// The block and the lane of a sample of the triangle in a lane, so far across and down from
    /// its first.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small whole numbers"
    )]
    fn pixel(&self, lane: usize, [across, down]: [u8; 2]) -> (usize, usize) {
        block_and_lane(
            (self.scratch.first_row[lane] as usize + usize::from(down)) % TILE,
            (self.scratch.first_column[lane] as usize + usize::from(across)) % TILE,
        )
    }

    /// Puts a triangle into the buffer where it is nearest, for the pixel of a lane in a block.
    #[inline(always)]
    fn meet<L: Lanes>(
        &mut self,
        l: L,
        (block, pixel): (usize, usize),
        lane: usize,
        (low, high): (f32, f32),
        is_certain: bool,
    ) {
        let start = self.frustum.start_depth;
        if low > self.buffer.high[block][pixel] || high < start {
            return;
        }
        let triangle = self.triangle(lane);
        if is_certain && high < self.buffer.low[block][pixel] && low > start {
            self.buffer.set(block, pixel, triangle, low, high);
            self.changed |= 1 << block;
        } else {
            self.decide(l, (block, pixel), triangle);
        }
    }
}
