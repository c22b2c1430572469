//! The visibility buffer of a tile: for each pixel the triangle that is nearest so far, and between
//! which depths.
//!
//! It has a pixel's triangle, and not where or how it is met: that is computed once, when the tile
//! is complete (`shoot/tiles/resolve.rs`).
//!
//! Burns and Hunt, "The Visibility Buffer: A Cache-Friendly Approach to Deferred Shading", Journal
//! of Computer Graphics Techniques 2(2), 2013. It departs in that a depth is an interval.

use crate::simd::{LANES, Lanes};

/// Pixels across and down a tile.
#[doc(hidden)]
pub const TILE: usize = BLOCK * BLOCK;

/// Pixels across and down a block, and blocks across and down a tile. The blocks of a tile have a
/// lane each, and so have the pixels of a block: row by row, from the left to the right.
#[doc(hidden)]
pub const BLOCK: usize = 4;

const _: () = assert!(BLOCK * BLOCK == LANES);

/// A triangle of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[doc(hidden)]
pub struct TriangleId {
    pub object: u32,
    /// The number in the tree of the object's mesh: a leaf's index times sixteen, and the
    /// triangle's lane.
    pub leaf_lane: u32,
}

impl TriangleId {
    /// No triangle.
    pub const NONE: Self = Self { object: u32::MAX, leaf_lane: u32::MAX };
}

/// The displacements of a tile's rays from its grid, in pixels, for lenses whose rays go through no
/// flat grid. Block by block.
#[derive(Debug)]
#[repr(C, align(64))]
#[doc(hidden)]
pub struct Displacements {
    /// The displacement to the right.
    pub across: [[f32; LANES]; LANES],
    pub down: [[f32; LANES]; LANES],
    /// The largest along either axis, or more.
    pub most: f32,
}

impl Displacements {
    pub const NONE: Self =
        Self { across: [[0.0; LANES]; LANES], down: [[0.0; LANES]; LANES], most: 0.0 };

    /// The rounding error of the displacements, in pixels, or far more.
    pub const REST: f64 = 1e-6;
}

/// The exact test, for pixels that float32 cannot decide.
#[doc(hidden)]
pub trait ExactTest {
    /// The nearer of the triangles `old` and `new` for the ray of a pixel, and its depth; `None`
    /// when the ray does not meet `new`, or not before `old`. The ray meets `old`, if there is one.
    fn nearer<L: Lanes>(
        &mut self,
        l: L,
        row: usize,
        column: usize,
        old: TriangleId,
        new: TriangleId,
    ) -> Option<(TriangleId, f64)>;
}

/// The block of a tile's pixel, and its lane there.
#[doc(hidden)]
pub const fn block_and_lane(row: usize, column: usize) -> (usize, usize) {
    let block = row / BLOCK * BLOCK + column / BLOCK;
    (block, row % BLOCK * BLOCK + column % BLOCK)
}

/// The row and the column of a pixel in its tile.
#[doc(hidden)]
pub const fn row_and_column(block: usize, lane: usize) -> (usize, usize) {
    let row = block / BLOCK * BLOCK + lane / BLOCK;
    (row % TILE, (block % BLOCK * BLOCK + lane % BLOCK) % TILE)
}

/// See [the module](self). Block by block; a depth of 1 is on the viewplane.
#[repr(C, align(64))]
#[doc(hidden)]
pub struct VisibilityBuffer {
    /// Depths between which the nearest hit is; infinite where there is none yet.
    pub(super) low: [[f32; LANES]; LANES],
    pub(super) high: [[f32; LANES]; LANES],
    /// The largest `high` of each block.
    pub(super) farthest: [f32; LANES],
    pub(super) leaf_lanes: [[f32; LANES]; LANES],
    pub(super) objects: [[f32; LANES]; LANES],
    pub(super) rows: usize,
    pub(super) columns: usize,
}

impl VisibilityBuffer {
    /// An empty buffer. Tiles at the border of a picture have fewer rows and columns.
    pub fn new(rows: usize, columns: usize) -> Self {
        let none = f32::from_bits(u32::MAX);
        let mut buffer = Self {
            low: [[f32::INFINITY; LANES]; LANES],
            high: [[f32::INFINITY; LANES]; LANES],
            farthest: [f32::INFINITY; LANES],
            leaf_lanes: [[none; LANES]; LANES],
            objects: [[none; LANES]; LANES],
            rows,
            columns,
        };
        if (rows, columns) != (TILE, TILE) {
            buffer.cut();
        }
        buffer
    }

    /// Puts pixels outside the picture in front of everything.
    fn cut(&mut self) {
        for (block, high) in self.high.iter_mut().enumerate() {
            for (lane, high) in high.iter_mut().enumerate() {
                let (row, column) = row_and_column(block, lane);
                if row >= self.rows || column >= self.columns {
                    *high = f32::NEG_INFINITY;
                }
            }
            self.farthest[block] = high.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// The nearest triangle of the pixel in a lane of a block.
    pub(super) fn triangle(&self, block: usize, lane: usize) -> TriangleId {
        TriangleId {
            object: self.objects[block][lane].to_bits(),
            leaf_lane: self.leaf_lanes[block][lane].to_bits(),
        }
    }

    /// The triangles of a block as bits: their leaves and lanes, and their objects.
    pub fn block(&self, block: usize) -> (&[f32; LANES], &[f32; LANES]) {
        (&self.leaf_lanes[block], &self.objects[block])
    }

    #[inline(always)]
    pub(super) fn set(
        &mut self,
        block: usize,
        lane: usize,
        triangle: TriangleId,
        low: f32,
        high: f32,
    ) {
        self.low[block][lane] = low;
        self.high[block][lane] = high;
        self.leaf_lanes[block][lane] = f32::from_bits(triangle.leaf_lane);
        self.objects[block][lane] = f32::from_bits(triangle.object);
    }

    #[inline(always)]
    pub(super) fn update_block<L: Lanes>(&mut self, l: L, block: usize) {
        self.farthest[block] = l.largest(l.load(&self.high[block]));
    }

    /// The depth beyond which nothing matters to any pixel.
    #[inline(always)]
    pub fn limit<L: Lanes>(&self, l: L) -> f32 {
        l.largest(l.load(&self.farthest))
    }
}
