//! A picture's rays that tiles do not serve, in squares of the picture: so those of a packet are
//! neighbours on all sides, and what rays have brought into the cache the next ones need.

use super::batch::{BATCH, are_enough, each_chunk, fill_batch};
use super::hits::{HitSlices, Hits};
use crate::accel::InstructionSet;
use crate::error::Result;
use crate::geometry::{DVec2, Ray, Rays};
use crate::scene::Scene;
use crate::watch::Watch;

/// Rows of a square, which is a batch of rays, where there are many squares down the picture.
const TALL: usize = 16;

/// Rows and columns of a block: the rays of a packet.
const BLOCK: usize = 4;

/// The first hits of the rays of a picture, row by row.
pub(super) fn trace_picture(
    set: InstructionSet,
    scene: &Scene,
    rays: &dyn Rays,
    columns: usize,
    hits: HitSlices<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    let tall = if are_enough(hits.t.len() / columns / TALL) { TALL } else { BLOCK };
    let wide = columns.min(BATCH / tall);
    each_chunk(hits, tall * columns, watch, |band, mut out| {
        let mut found = Hits {
            t: vec![0.0; tall * wide],
            object: vec![0; tall * wide],
            primitive: vec![0; tall * wide],
            barycentric: vec![DVec2::ZERO; tall * wide],
        };
        let rows = out.t.len() / columns;
        for left in (0..columns).step_by(wide) {
            let square = Square {
                rays,
                first: band * tall * columns + left,
                stride: columns,
                size: [rows, wide.min(columns - left)],
            };
            let (slices, _) = found.slices().split_at(square.len());
            fill_batch(set, scene, &square, 0, slices);
            for index in 0..square.len() {
                let [row, column] = square.place(index);
                out.put(row * columns + left + column, &found.get(index));
            }
        }
    })
}

/// The rays of a square, block by block.
struct Square<'a> {
    /// The rays of the picture.
    rays: &'a dyn Rays,
    /// The number of the square's first ray.
    first: usize,
    /// The number of rays from row to row.
    stride: usize,
    size: [usize; 2],
}

impl Square<'_> {
    /// The row and the column of a ray. Blocks at the edges are smaller.
    fn place(&self, index: usize) -> [usize; 2] {
        let [rows, columns] = self.size;
        let (strip, in_strip) = (index / (BLOCK * columns), index % (BLOCK * columns));
        let tall = BLOCK.min(rows - BLOCK * strip);
        let (block, in_block) = (in_strip / (BLOCK * tall), in_strip % (BLOCK * tall));
        let wide = BLOCK.min(columns - BLOCK * block);
        [BLOCK * strip + in_block / wide, BLOCK * block + in_block % wide]
    }
}

impl Rays for Square<'_> {
    fn len(&self) -> usize {
        self.size[0] * self.size[1]
    }

    fn ray(&self, index: usize) -> Ray {
        let [row, column] = self.place(index);
        self.rays.ray(self.first + row * self.stride + column)
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        let mut rest = rays;
        let mut index = first;
        while !rest.is_empty() {
            let [row, column] = self.place(index);
            // To the end of the block's row.
            let end = (column / BLOCK * BLOCK + BLOCK).min(self.size[1]);
            let (of_row, after) = rest.split_at_mut(rest.len().min(end - column));
            self.rays.read(self.first + row * self.stride + column, of_row);
            (index, rest) = (index + of_row.len(), after);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_of_any_size_has_each_pixel_once() {
        for (rows, columns) in [(16, 64), (16, 7), (5, 64), (3, 2), (1, 1), (4, 4)] {
            let rays: &[Ray] = &[];
            let square = Square { rays: &rays, first: 0, stride: columns, size: [rows, columns] };
            let mut places: Vec<_> = (0..square.len()).map(|index| square.place(index)).collect();
            assert_eq!(places[..2.min(columns)], [[0, 0], [0, 1]][..2.min(columns)]);
            places.sort_unstable();
            let all = (0..rows).flat_map(|row| (0..columns).map(move |column| [row, column]));
            assert!(places.into_iter().eq(all));
        }
    }
}
