//! The buffer for the hits of tiles: a square of 4 x 4 tiles, small enough for the first cache.
//!
//! From there they go to memory in long rows, which it takes far faster; of large pictures past the
//! caches, in whole cache lines only: a line written in two parts costs more than five whole ones.
//! The rest of a row's last line waits for the square to the right.

use std::ops::Range;

use bytemuck::Pod;

use crate::accel::{BLOCK, TILE};
use crate::geometry::{DVec2, Hit, arrays};
use crate::shoot::hits::HitSlices;
use crate::simd::{LANES, Lanes, WIDE, set_bits};

/// Pixels across and down a square of tiles.
pub(super) const SIDE: usize = 4 * TILE;

/// See [the module](self). In front of a row stands what the square to the left has kept of its
/// last line.
#[derive(Debug)]
pub(super) struct Square {
    t: InPhase<f64>,
    object: InPhase<i32>,
    primitive: InPhase<i32>,
    barycentric: InPhase<DVec2>,
}

/// The size of a cache line, in bytes.
const LINE: usize = 64;

/// Elements that may be kept: a line of the smallest.
const KEPT: usize = LINE / size_of::<i32>();

impl Square {
    /// The distance from one row to the next.
    pub(super) const STRIDE: usize = KEPT + SIDE;

    /// The index of a pixel's hit.
    pub(super) const fn index_of(row: usize, column: usize) -> usize {
        row * Self::STRIDE + KEPT + column
    }
}

impl Default for Square {
    fn default() -> Self {
        Self {
            t: InPhase::new(0.0),
            object: InPhase::new(0),
            primitive: InPhase::new(0),
            barycentric: InPhase::new(DVec2::ZERO),
        }
    }
}

impl Square {
    pub(super) fn out(&mut self) -> HitSlices<'_> {
        HitSlices {
            t: self.t.slice(),
            object: self.object.slice(),
            primitive: self.primitive.slice(),
            barycentric: self.barycentric.slice(),
        }
    }
}

/// The values of a square, beginning [`PHASE`] bytes behind the start of a cache line.
///
/// Large arrays do so, for allocators put 16 bytes of their own in front of whole pages. Where both
/// do, lines are lines in the square too; where not, each is read from two, which makes pictures a
/// tenth slower.
#[derive(Debug)]
struct InPhase<T> {
    values: Vec<T>,
    first: usize,
}

/// See [`InPhase`].
const PHASE: usize = 16;

impl<T: Copy> InPhase<T> {
    const COUNT: usize = SIDE * Square::STRIDE;

    fn new(value: T) -> Self {
        let per_line = LINE / size_of::<T>();
        let values = vec![value; Self::COUNT + per_line];
        let is_in_phase = |first: &usize| (&raw const values[*first]).addr() % LINE == PHASE;
        let first = (0..per_line).find(is_in_phase).unwrap_or(0);
        Self { values, first }
    }

    fn slice(&mut self) -> &mut [T] {
        &mut self.values[self.first..][..Self::COUNT]
    }
}

impl HitSlices<'_> {
    /// Writes those of a whole block to a square, from an index on, half of them in a register.
    #[inline(always)]
    pub(super) fn put_block<L: Lanes>(
        &mut self,
        l: L,
        at: usize,
        objects: &[i32; LANES],
        primitives: &[i32; LANES],
        halves: [[L::Doubles; 3]; 2],
    ) {
        for (half, [t, v, w]) in halves.into_iter().enumerate() {
            let mut ts = [0.0; WIDE];
            l.store64(t, &mut ts);
            for (row, weights) in l.interleave64(v, w).into_iter().enumerate() {
                let at = at + (2 * half + row) * Square::STRIDE;
                let lane = (2 * half + row) * BLOCK;
                arrays::copy::<_, BLOCK>(&ts[row * BLOCK..], &mut self.t[at..]);
                arrays::copy::<_, BLOCK>(&objects[lane..], &mut self.object[at..]);
                arrays::copy::<_, BLOCK>(&primitives[lane..], &mut self.primitive[at..]);
                let pairs: &mut [f64] = bytemuck::cast_slice_mut(&mut self.barycentric[at..]);
                let pairs = pairs.first_chunk_mut().expect("a row's pairs are eight numbers");
                l.store64(weights, pairs);
            }
        }
    }

    /// Takes a square's hits, whose first column is `left`, into a band as wide as `columns`; past
    /// the caches if there are many. Squares come from the left to the right.
    #[inline(always)]
    pub(super) fn take<L: Lanes>(
        &mut self,
        l: L,
        square: &mut Square,
        left: usize,
        columns: usize,
        is_large: bool,
    ) {
        let right = (left + SIDE).min(columns);
        let hits = square.out();
        macro_rules! copy {
            ($field:ident, $row:ident) => {
                let to = &mut self.$field[$row * columns..][..columns];
                let from = &mut hits.$field[$row * Square::STRIDE..][..Square::STRIDE];
                if is_large {
                    stream(l, from, to, left..right);
                } else {
                    to[left..right].copy_from_slice(&from[KEPT..][..right - left]);
                }
            };
        }
        for row in 0..self.t.len() / columns {
            copy!(t, row);
            copy!(object, row);
            copy!(primitive, row);
            copy!(barycentric, row);
        }
    }
}

/// Takes a square's row to `columns` of a picture's, past the caches: the whole lines, with what
/// was kept before; what is left of the last one is kept.
#[inline(always)]
fn stream<L: Lanes, T: Pod>(l: L, from: &mut [T], to: &mut [T], columns: Range<usize>) {
    let Range { start, end } = columns;
    let beyond = |column: usize| (&raw const to[column]).addr() % LINE / size_of::<T>();
    let before = if start == 0 { 0 } else { beyond(start) };
    let after = if end == to.len() { 0 } else { beyond(end) };
    let last = KEPT + end - start;
    let lines = &from[KEPT - before..last - after];
    l.stream(lines, &mut to[start - before..end - after]);
    from.copy_within(last - after..last, KEPT - after);
}

/// The hits of a block, on their way to memory: there, a few bytes at a time would be slow.
#[repr(align(64))]
pub(super) struct BlockOfHits {
    t: [[f64; WIDE]; 2],
    pub(super) object: [i32; LANES],
    pub(super) primitive: [i32; LANES],
    barycentric: [[DVec2; BLOCK]; BLOCK],
}

impl BlockOfHits {
    pub(super) const MISSES: Self = Self {
        t: [[Hit::MISS.t; WIDE]; 2],
        object: [Hit::MISS.object; LANES],
        primitive: [Hit::MISS.primitive; LANES],
        barycentric: [[DVec2::NAN; BLOCK]; BLOCK],
    };

    /// The hit of the pixel in a lane.
    pub(super) fn put(&mut self, lane: usize, hit: &Hit) {
        let lane = lane % LANES;
        self.t.as_flattened_mut()[lane] = hit.t;
        self.object[lane] = hit.object;
        self.primitive[lane] = hit.primitive;
        self.barycentric.as_flattened_mut()[lane] = hit.barycentric;
    }

    /// Takes eight hits where the mask says so.
    #[inline(always)]
    pub(super) fn put_half<L: Lanes>(
        &mut self,
        l: L,
        half: usize,
        mask: u8,
        [t, v, w]: [L::Doubles; 3],
    ) {
        let half = half % 2;
        let old = l.load64(&self.t[half]);
        l.store64(l.select64(mask, t, old), &mut self.t[half]);
        let [low, high] = l.interleave64(v, w);
        let rows: &mut [[f64; WIDE]; BLOCK] = bytemuck::cast_mut(&mut self.barycentric);
        if mask == u8::MAX {
            l.store64(low, &mut rows[2 * half]);
            l.store64(high, &mut rows[2 * half + 1]);
            return;
        }
        let mut both = [[0.0; WIDE]; 2];
        l.store64(low, &mut both[0]);
        l.store64(high, &mut both[1]);
        for k in set_bits(mask.into()) {
            for k in [2 * k, 2 * k + 1] {
                rows[2 * half + k / WIDE][k % WIDE] = both[k / WIDE][k % WIDE];
            }
        }
    }

    /// Writes the hits of some rows and columns to a square, from an index on.
    #[inline(always)]
    pub(super) fn write(&self, at: usize, [rows, columns]: [usize; 2], out: &mut HitSlices<'_>) {
        let t: &[f64; LANES] = bytemuck::cast_ref(&self.t);
        for row in 0..rows {
            let (at, lane) = (at + row * Square::STRIDE, row * BLOCK);
            if columns == BLOCK {
                arrays::copy::<_, BLOCK>(&t[lane..], &mut out.t[at..]);
                arrays::copy::<_, BLOCK>(&self.object[lane..], &mut out.object[at..]);
                arrays::copy::<_, BLOCK>(&self.primitive[lane..], &mut out.primitive[at..]);
                arrays::copy::<_, BLOCK>(&self.barycentric[row], &mut out.barycentric[at..]);
            } else {
                out.t[at..][..columns].copy_from_slice(&t[lane..][..columns]);
                out.object[at..][..columns].copy_from_slice(&self.object[lane..][..columns]);
                out.primitive[at..][..columns].copy_from_slice(&self.primitive[lane..][..columns]);
                out.barycentric[at..][..columns].copy_from_slice(&self.barycentric[row][..columns]);
            }
        }
    }
}
