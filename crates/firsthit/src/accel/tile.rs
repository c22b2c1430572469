//! A camera's tile, 16 by 16 pixels, through a [`MeshTree`]: what its rays have in common is done once.
//!
//! Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005, for the frustum
//! through the tree; Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", Graphics
//! Hardware 1997, for triangles in a tile: a side of an edge is linear in the pixel's place, so it is set up once
//! for a triangle, for sixteen triangles at once, and then costs an addition. It departs from both in that
//! float32 only rules out: every value here has a bound (see `frame.rs`), and what lies within it is put to an
//! [`Arbiter`].

use super::frame::Frame;
use super::mesh_tree::MeshTree;
use super::visit::Visit;
use super::walk::{Scratch, Stack};
use super::wide::{LEAF, Node};
use crate::simd::{Aligned, LANES, Lanes};

/// Pixels across and down a tile.
pub(crate) const TILE: usize = BLOCK * BLOCK;

/// Pixels across and down a block, of which a tile has as many across and down: blocks of a tile and pixels of a block
/// have a lane each, from the left to the right and then down.
pub(crate) const BLOCK: usize = 4;

const _: () = assert!(BLOCK * BLOCK == LANES);

/// A triangle in one of the objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Winner {
    pub(crate) object: u32,
    /// In the tree of the object's mesh: a leaf's index times sixteen, and the triangle's lane.
    pub(crate) slot: u32,
}

impl Winner {
    /// Nobody.
    pub(crate) const NONE: Self = Self {
        object: u32::MAX,
        slot: u32::MAX,
    };
}

/// Who decides in float64.
pub(crate) trait Arbiter {
    /// Which of `old` and `new` the ray of a pixel meets first, and at which depth; `None` when it does not
    /// meet `new`. `old` is met, unless it is nobody.
    fn settle<L: Lanes>(
        &mut self,
        l: L,
        row: usize,
        column: usize,
        old: Winner,
        new: Winner,
    ) -> Option<(Winner, f64)>;
}

/// The block of a tile's pixel, and its lane there.
pub(crate) const fn place(row: usize, column: usize) -> (usize, usize) {
    let block = row / BLOCK * BLOCK + column / BLOCK;
    (block, row % BLOCK * BLOCK + column % BLOCK)
}

/// The row and the column of a pixel in its tile.
pub(crate) const fn pixel(block: usize, lane: usize) -> (usize, usize) {
    let row = block / BLOCK * BLOCK + lane / BLOCK;
    (row % TILE, (block % BLOCK * BLOCK + lane % BLOCK) % TILE)
}

/// The first hits of a tile's pixels so far, block by block. Depths are in units of the viewplane's.
#[repr(C, align(64))]
pub(crate) struct Tile {
    /// Depths between which the hit is; above all depths where there is none yet.
    pub(super) low: [[f32; LANES]; LANES],
    pub(super) high: [[f32; LANES]; LANES],
    /// The largest `high` of each block.
    pub(super) farthest: [f32; LANES],
    pub(super) slots: [[f32; LANES]; LANES],
    pub(super) objects: [[f32; LANES]; LANES],
    pub(super) rows: usize,
    pub(super) columns: usize,
}

impl Tile {
    /// Nothing met yet. Tiles at the border of a picture have fewer rows and columns.
    pub(crate) fn new(rows: usize, columns: usize) -> Self {
        let nobody = f32::from_bits(u32::MAX);
        let mut tile = Self {
            low: [[f32::INFINITY; LANES]; LANES],
            high: [[f32::INFINITY; LANES]; LANES],
            farthest: [f32::INFINITY; LANES],
            slots: [[nobody; LANES]; LANES],
            objects: [[nobody; LANES]; LANES],
            rows,
            columns,
        };
        if (rows, columns) != (TILE, TILE) {
            tile.cut();
        }
        tile
    }

    /// What is outside the picture is in front of everything.
    fn cut(&mut self) {
        for (block, high) in self.high.iter_mut().enumerate() {
            for (lane, high) in high.iter_mut().enumerate() {
                let (row, column) = pixel(block, lane);
                if row >= self.rows || column >= self.columns {
                    *high = f32::NEG_INFINITY;
                }
            }
            self.farthest[block] = high.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// Who won the pixel of a lane in a block.
    pub(super) fn winner(&self, block: usize, lane: usize) -> Winner {
        Winner {
            object: self.objects[block][lane].to_bits(),
            slot: self.slots[block][lane].to_bits(),
        }
    }

    /// The winners' slots, and their objects, of a block; as bits.
    pub(crate) fn block(&self, block: usize) -> (&[f32; LANES], &[f32; LANES]) {
        (&self.slots[block], &self.objects[block])
    }

    #[inline(always)]
    pub(super) fn set(&mut self, block: usize, lane: usize, winner: Winner, low: f32, high: f32) {
        self.low[block][lane] = low;
        self.high[block][lane] = high;
        self.slots[block][lane] = f32::from_bits(winner.slot);
        self.objects[block][lane] = f32::from_bits(winner.object);
    }

    #[inline(always)]
    fn update_block<L: Lanes>(&mut self, l: L, block: usize) {
        self.farthest[block] = l.largest(l.load(&self.high[block]));
    }

    /// The depth beyond which nothing matters to any pixel.
    #[inline(always)]
    pub(crate) fn limit<L: Lanes>(&self, l: L) -> f32 {
        l.largest(l.load(&self.farthest))
    }
}

/// Finds for each pixel of `tile` which triangle of a mesh it meets first, if that is before what it meets so far.
#[inline(always)]
pub(crate) fn fill<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    tree: &MeshTree,
    frame: &Frame,
    object: u32,
    tile: &mut Tile,
    arbiter: &mut impl Arbiter,
) {
    let Scratch { stack, known, .. } = scratch;
    stack.clear();
    let mut index = 0_u32;
    let mut entry = 0.0_f32;
    let mut limit = tile.limit(l);
    loop {
        if index & LEAF == 0 {
            let node = &tree.nodes[index as usize];
            open(l, tree, node, frame, limit, stack);
        } else {
            let leaf = &tree.leaves[(index & !LEAF) as usize];
            let slot = (index & !LEAF) * 16;
            let mut visit = Visit {
                frame,
                leaf,
                first: tree.order.get(leaf.first as usize),
                object,
                slot,
                tile,
                arbiter,
                known,
                changed: 0,
            };
            visit.run(l, entry, limit);
            let mut changed = visit.changed;
            if changed != 0 {
                while changed != 0 {
                    tile.update_block(l, changed.trailing_zeros() as usize % LANES);
                    changed &= changed - 1;
                }
                limit = tile.limit(l);
            }
        }
        let Some(next) = stack.pop_within(limit) else {
            return;
        };
        (entry, index) = next;
    }
}

/// Puts the children that the frustum may meet onto the stack, the nearest on top.
#[inline(always)]
fn open<L: Lanes>(
    l: L,
    tree: &MeshTree,
    node: &Node,
    frame: &Frame,
    limit: f32,
    stack: &mut Stack,
) {
    let (mut met, nearest) = frame.boxes(l, node, limit);
    let mut entries = Aligned([0.0; LANES]);
    l.store(nearest, &mut entries.0);
    let base = stack.len();
    while met != 0 {
        let child = met.trailing_zeros() as usize;
        met &= met - 1;
        let index = node.children[child];
        if index & LEAF == 0 {
            l.prefetch(&tree.nodes[index as usize]);
        } else {
            l.prefetch(&tree.leaves[(index & !LEAF) as usize]);
        }
        let key = u64::from(entries.0[child].to_bits()) << 32 | u64::from(index);
        stack.insert(base, key);
    }
}
