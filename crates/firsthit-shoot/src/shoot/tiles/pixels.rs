//! A tile's pixels in lanes of float64: half a block at a time, which is two of its rows.

use crate::accel::{BLOCK, row_and_column};
use crate::geometry::PixelGrid;
use crate::simd::{LANES, Lanes, WIDE};

/// Halves of blocks in a tile.
pub(super) const HALVES: usize = 2 * LANES;

/// The places of a tile's pixels on the viewplane.
pub(super) struct Pixels {
    /// The coordinates to the right, for each column of blocks.
    x: [[f64; WIDE]; BLOCK],
    /// The coordinates upwards, for each half of a row of blocks.
    y: [[f64; WIDE]; 2 * BLOCK],
}

impl Pixels {
    /// The places in the tile that begins in a row and a column of the grid and has `rows` and
    /// `columns`; beyond them the last ones stand again.
    #[inline]
    pub(super) fn new(
        grid: &PixelGrid,
        [row, column]: [usize; 2],
        [rows, columns]: [usize; 2],
    ) -> Self {
        let mut pixels = Self { x: [[0.0; WIDE]; BLOCK], y: [[0.0; WIDE]; 2 * BLOCK] };
        for (block, x) in pixels.x.iter_mut().enumerate() {
            for (lane, x) in x.iter_mut().enumerate() {
                let (_, across) = row_and_column(block, lane);
                *x = grid.x(column + across.min(columns - 1));
            }
        }
        for (half, y) in pixels.y.iter_mut().enumerate() {
            let block = half / 2 * BLOCK;
            for (lane, y) in y.iter_mut().enumerate() {
                let (down, _) = row_and_column(block, half % 2 * WIDE + lane);
                *y = grid.y(row + down.min(rows - 1));
            }
        }
        pixels
    }

    /// The coordinates to the right of the middle, of half a block.
    #[inline(always)]
    pub(super) fn x<L: Lanes>(&self, l: L, half: usize) -> L::Doubles {
        l.load64(&self.x[half / 2 % BLOCK])
    }

    /// Above the middle.
    #[inline(always)]
    pub(super) fn y<L: Lanes>(&self, l: L, half: usize) -> L::Doubles {
        l.load64(&self.y[half / (2 * BLOCK) * 2 % (2 * BLOCK) + half % 2])
    }
}
