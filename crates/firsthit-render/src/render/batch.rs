//! Pixels that are shaded at a time.

use super::region::RegionRays;
use crate::geometry::{Color, DVec3, Hit, Ray, Rays, Side};
use crate::scene::Scene;
use crate::shade::{Samples, Shade};
use crate::shoot::{Hits, Prefetcher};

/// The number of pixels that are shaded at a time: enough that their shadow rays go together, few
/// enough for slow shaders.
const SHADED: usize = 256;

/// Pixels are shaded in squares of this side: rays from sixteen neighbours on all sides go together
/// better than from a row.
const SQUARE: usize = 4;

/// Pixels that are shaded at a time: some columns of a few rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// The number of its first pixel, counted row by row in a picture of that width.
    first: usize,
    width: usize,
    rows: usize,
    columns: usize,
}

/// The most columns of a block with `rows` rows.
fn most_columns(rows: usize) -> usize {
    SHADED / rows / SQUARE * SQUARE
}

impl Block {
    /// All blocks of a picture of `pixels` pixels, which has that width.
    pub(super) fn all(pixels: usize, width: usize) -> Vec<Self> {
        let mut blocks = Vec::with_capacity(2 * pixels / SHADED + 1);
        for band in (0..pixels).step_by(SQUARE * width) {
            let rows = SQUARE.min((pixels - band) / width);
            let step = most_columns(rows);
            for column in (0..width).step_by(step) {
                blocks.push(Self {
                    first: band + column,
                    width,
                    rows,
                    columns: step.min(width - column),
                });
            }
        }
        blocks
    }

    pub(super) fn len(self) -> usize {
        self.rows * self.columns
    }

    /// The number of the pixel in a row and a column of the block.
    fn pixel(self, [row, column]: [usize; 2]) -> usize {
        self.first + row * self.width + column
    }

    /// Rows and columns of its pixels, square by square.
    fn pixels(self) -> impl Iterator<Item = [usize; 2]> {
        (0..self.columns).step_by(SQUARE).flat_map(move |left| {
            let columns = left..self.columns.min(left + SQUARE);
            (0..self.rows).flat_map(move |row| columns.clone().map(move |column| [row, column]))
        })
    }
}

/// Splits values, one for each pixel of a picture of that width, into those of its
/// [blocks](Block::all), row by row.
pub(super) fn split<T>(values: &mut [T], width: usize) -> Vec<[&mut [T]; SQUARE]> {
    let mut blocks = Vec::with_capacity(2 * values.len() / SHADED + 1);
    for band in values.chunks_mut(SQUARE * width) {
        let rows = band.len() / width;
        let first = blocks.len();
        for (row, values) in band.chunks_mut(width).enumerate() {
            for (k, values) in values.chunks_mut(most_columns(rows)).enumerate() {
                if row == 0 {
                    blocks.push(std::array::from_fn(|_| <&mut [T]>::default()));
                }
                blocks[first + k][row] = values;
            }
        }
    }
    blocks
}

/// A batch of some hundred hits that are shaded at a time, and their colours. It is used again and
/// again.
pub(super) struct Batch {
    rays: Box<[Ray; SHADED]>,
    hits: Box<[Hit; SHADED]>,
    pixels: [u64; SHADED],
    /// The row and the column within the block of each.
    taken: [[usize; 2]; SHADED],
    /// Rays and numbers of all pixels of the block, row by row.
    read: Box<[Ray; SHADED]>,
    numbers: [u64; SHADED],
    colors: [Color; SHADED],
    coverage: [f64; SHADED],
    count: usize,
}

impl Batch {
    pub(super) fn new() -> Self {
        Self {
            rays: Box::new([Ray::new(DVec3::ZERO, DVec3::ZERO); SHADED]),
            hits: Box::new([Hit::MISS; SHADED]),
            pixels: [0; SHADED],
            taken: [[0; 2]; SHADED],
            read: Box::new([Ray::new(DVec3::ZERO, DVec3::ZERO); SHADED]),
            numbers: [0; SHADED],
            colors: [Color::ZERO; SHADED],
            coverage: [0.0; SHADED],
            count: 0,
        }
    }

    /// Takes the active pixels of a block, by their numbers in the part. Their triangles are on
    /// their way to the caches afterwards. Returns whether there are any.
    pub(super) fn read(
        &mut self,
        (scene, part): (&Scene, &RegionRays<'_>),
        hits: &Hits,
        block: Block,
        goes_on: impl Fn(usize) -> bool,
    ) -> bool {
        self.count = 0;
        for pixel in block.pixels() {
            if goes_on(block.pixel(pixel)) {
                self.taken[self.count] = pixel;
                self.count += 1;
            }
        }
        if self.count == 0 {
            return false;
        }
        for row in 0..block.rows {
            let start = block.pixel([row, 0]);
            let of_row = row * block.columns..(row + 1) * block.columns;
            part.read(start, &mut self.read[of_row.clone()]);
            part.number(start, &mut self.numbers[of_row]);
            let mut prefetcher = Prefetcher::new(scene, hits, start, block.columns);
            (0..block.columns).for_each(|k| prefetcher.advance(k));
        }
        for (k, &[row, column]) in self.taken[..self.count].iter().enumerate() {
            let from = row * block.columns + column;
            self.rays[k] = self.read[from];
            self.pixels[k] = self.numbers[from];
            self.hits[k] = hits.get(block.pixel([row, column]));
        }
        true
    }

    /// The pixels of all, their colours and coverage.
    pub(super) fn shade(
        &mut self,
        (shade, cull): (&dyn Shade, Option<Side>),
        sample: u32,
    ) -> (&[[usize; 2]], &[Color], &[f64]) {
        let count = self.count;
        let samples = Samples {
            rays: &self.rays[..count],
            hits: &self.hits[..count],
            pixels: &self.pixels[..count],
            sample,
            cull,
        };
        let (colors, coverage) = (&mut self.colors[..count], &mut self.coverage[..count]);
        colors.fill(Color::ZERO);
        for (covered, hit) in coverage.iter_mut().zip(samples.hits) {
            *covered = f64::from(u8::from(!hit.is_miss()));
        }
        shade.shade_all(&samples, colors, coverage);
        (&self.taken[..count], colors, coverage)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_have_every_pixel_once() {
        for width in (1..40).chain([63, 64, 65, 255, 256, 257, 300, 1030]) {
            for rows in [1, 2, 3, 4, 5, 7, 8, 11] {
                let mut values: Vec<usize> = (0..rows * width).collect();
                let mut seen = vec![0; values.len()];
                let blocks = Block::all(values.len(), width);
                let parts = split(&mut values, width);
                assert_eq!(blocks.len(), parts.len(), "{rows} x {width}");
                for (block, part) in blocks.iter().zip(parts) {
                    assert!(0 < block.len() && block.len() <= SHADED);
                    let mut count = 0;
                    for pixel in block.pixels() {
                        let [row, column] = pixel;
                        assert_eq!(part[row][column], block.pixel(pixel));
                        seen[part[row][column]] += 1;
                        count += 1;
                    }
                    assert_eq!(count, block.len());
                }
                assert!(seen.iter().all(|&times| times == 1), "{rows} x {width}");
            }
        }
    }

    /// Sixteen pixels after each other are a square.
    #[test]
    fn pixels_go_square_by_square() {
        let blocks = Block::all(8 * 64, 64);
        assert_eq!(blocks.len(), 2);
        let pixels: Vec<[usize; 2]> = blocks[1].pixels().collect();
        for (k, square) in pixels.chunks(16).enumerate() {
            for [row, column] in square {
                assert!(*row < 4 && column / 4 == k);
            }
        }
    }
}
