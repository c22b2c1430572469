//! Numbers from 0 to 1 that are evenly spread over a pixel's samples: the sequence of Sobol', with
//! Owen's scrambling.
//!
//! 1. A pixel's samples are numbered. The sequence has four coordinates for each (Joe and Kuo,
//!    "Constructing Sobol sequences with better two-dimensional projections", SIAM Journal on
//!    Scientific Computing 30(5), 2008).
//! 2. A shader that needs more takes several sets of four. Each set goes through the sequence in an
//!    order of its own, and each of its coordinates is scrambled on its own. Both are Owen's nested
//!    uniform scrambling, whose permutations are hashes (Burley, "Practical Hash-based Owen
//!    Scrambling", Journal of Computer Graphics Techniques 9(4), 2020).
//! 3. The pixel, the set and the coordinate are hashed. So a number depends on nothing but
//!    these and the sample: not on the order of the work, and not on how many samples there will
//!    be.
//!
//! Of any 2^m samples from a multiple of 2^m on, each interval of 1 / 2^m has one, in each
//! coordinate; and each rectangle of that area has one in the first two.

use super::sobol;
use crate::geometry::DVec2;

/// The numbers of one sample of one pixel, for a shader to draw from.
///
/// ```
/// use firsthit::sampling::Draws;
///
/// // The numbers of sample 3 of pixel 17 are always the same.
/// let mut draws = Draws::new(17, 3);
/// let (first, second) = (draws.two(), draws.two());
/// assert_ne!(first, second);
/// assert_eq!(first, Draws::new(17, 3).two());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws {
    pixel: u64,
    sample: u32,
    set: u32,
}

impl Draws {
    /// The numbers of a sample of a pixel. Pixels are counted row by row, and samples from 0.
    pub const fn new(pixel: u64, sample: u32) -> Self {
        let set = 0;
        Self { pixel, sample, set }
    }

    /// Numbers that are as good as independent of those without `branch`, and of those with
    /// another: for work in which one ray becomes several.
    #[inline(always)]
    pub fn split(self, branch: u64) -> Self {
        let pixel = mixed(self.pixel ^ mixed(branch));
        Self { pixel, ..self }
    }

    /// The numbers of another sample of the pixel.
    #[must_use]
    pub fn of_sample(self, sample: u32) -> Self {
        Self { sample, ..self }
    }

    /// The stream from its set `set` on: numbers after `skipped(k)` do not depend on how many were
    /// drawn before.
    pub fn skipped(self, set: u32) -> Self {
        Self { set, ..self }
    }

    /// The next number, from 0 up to 1.
    pub fn one(&mut self) -> f64 {
        self.next::<1>()[0]
    }

    /// The next two numbers, a point of the unit square.
    #[inline(always)]
    pub fn two(&mut self) -> DVec2 {
        DVec2::from(self.next::<2>())
    }

    /// The next three numbers.
    pub fn three(&mut self) -> [f64; 3] {
        self.next()
    }

    /// The next four numbers.
    pub fn four(&mut self) -> [f64; 4] {
        self.next()
    }

    /// The first `N` coordinates of the next set.
    #[inline(always)]
    fn next<const N: usize>(&mut self) -> [f64; N] {
        let seed = mixed(self.pixel.wrapping_mul(0xd134_2543_de82_ef95) ^ u64::from(self.set));
        self.set = self.set.wrapping_add(1);
        let [low, high] = halves(seed);
        // Nested scrambling acts on the bits from the highest down; as `permuted` goes up, numbers
        // are kept reversed.
        let index = permuted(self.sample.reverse_bits(), low).reverse_bits();
        let mut numbers = [0.0; N];
        for (axis, number) in numbers.iter_mut().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "there are four")]
            let own = high ^ (axis as u32).wrapping_mul(0x9e37_79b9);
            let bits = permuted(reversed_sobol(index, axis), hashed(own)).reverse_bits();
            *number = f64::from(bits) / 4_294_967_296.0;
        }
        numbers
    }
}

/// A number that stands for some numbers, as good as different for others.
#[doc(hidden)]
pub fn key(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let numbers = numbers.into_iter();
    numbers.fold(0, |key, number| mixed(key ^ number.to_bits()))
}

/// The steps of `SplitMix64` (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number
/// Generators", OOPSLA 2014), with Stafford's constants.
#[inline(always)]
fn mixed(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[inline(always)]
fn halves(x: u64) -> [u32; 2] {
    #[expect(clippy::cast_possible_truncation, reason = "the lower half is wanted")]
    [x as u32, (x >> 32) as u32]
}

/// A permutation of 32 bits that spreads every bit over all (Mueller, "lowbias32").
#[inline(always)]
fn hashed(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// A permutation in which each bit depends on the seed and on the bits below it alone: Owen's
/// scrambling of reversed numbers. The form is that of Laine and Karras ("Stratified Sampling for
/// Stochastic Transparency", EGSR 2011), with constants by Vegdahl.
#[inline(always)]
fn permuted(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// A coordinate of the sequence, its bits reversed.
#[inline(always)]
fn reversed_sobol(index: u32, axis: usize) -> u32 {
    // The first is the index with its bits reversed.
    let Some(table) = axis.checked_sub(1).map(|axis| &TABLES[axis]) else {
        return index;
    };
    let [a, b, c, d] = index.to_le_bytes().map(usize::from);
    table[0][a] ^ table[1][b] ^ table[2][c] ^ table[3][d]
}

/// The contribution of each byte of an index to the coordinates 1, 2 and 3.
static TABLES: [[[u32; 256]; 4]; 3] = [
    // x + 1.
    table(&sobol::SECOND),
    // x^2 + x + 1.
    table(&sobol::directions(2, 0b1, [1, 3, 0])),
    // x^3 + x + 1.
    table(&sobol::directions(3, 0b01, [1, 3, 1])),
];

/// The contribution of each byte of an index to a coordinate, its bits reversed.
const fn table(directions: &[u32; 32]) -> [[u32; 256]; 4] {
    let mut table = [[0; 256]; 4];
    let mut byte = 0;
    while byte < 4 {
        let mut value = 0;
        while value < 256 {
            let mut bit = 0;
            while bit < 8 {
                if value >> bit & 1 == 1 {
                    table[byte][value] ^= directions[8 * byte + bit].reverse_bits();
                }
                bit += 1;
            }
            value += 1;
        }
        byte += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "cells are counted"
    )]

    use super::*;

    fn sets(pixel: u64, set: u32, count: u32) -> Vec<[f64; 4]> {
        let each = |sample| Draws::new(pixel, sample).skipped(set).four();
        (0..count).map(each).collect()
    }

    /// Joe and Kuo's table begins so: 0, 1/2, 3/4, 1/4, ... in the coordinates 0 to 3, in the order
    /// of indices.
    #[test]
    fn the_sequence_is_that_of_joe_and_kuo() {
        let point = |index: u32| {
            let axes = [0, 1, 2, 3];
            axes.map(|axis| f64::from(reversed_sobol(index, axis).reverse_bits()) / 4_294_967_296.0)
        };
        assert_eq!(point(0), [0.0; 4]);
        assert_eq!(point(1), [0.5; 4]);
        // In Gray code's order, which they list, index 3 is the third point, and 2 the fourth.
        assert_eq!(point(3), [0.75, 0.25, 0.25, 0.25]);
        assert_eq!(point(2), [0.25, 0.75, 0.75, 0.75]);
        assert_eq!(point(6), [0.375, 0.375, 0.625, 0.875]);
        assert_eq!(point(7), [0.875, 0.875, 0.125, 0.375]);
    }

    #[test]
    fn each_coordinate_is_stratified_in_every_block_of_a_power_of_two() {
        for (pixel, set) in [(0, 0), (1, 0), (99, 7), (u64::MAX, 3)] {
            let points = sets(pixel, set, 256);
            for m in 0..=8 {
                for block in points.chunks(1 << m) {
                    for axis in 0..4 {
                        let mut cells: Vec<u32> = (block.iter())
                            .map(|point| (point[axis] * f64::from(1 << m)) as u32)
                            .collect();
                        cells.sort_unstable();
                        assert_eq!(cells, (0..1 << m).collect::<Vec<_>>());
                    }
                }
            }
        }
    }

    #[test]
    fn rectangles_of_the_first_two_coordinates_have_a_point_each() {
        let points = sets(5, 2, 64);
        for m in 0..=6_u32 {
            for across in 0..=m {
                for block in points.chunks(1 << m) {
                    let sides = [across, m - across].map(|k| f64::from(1_u32 << k));
                    let cell = |point: &[f64; 4]| {
                        [(point[0] * sides[0]) as u32, (point[1] * sides[1]) as u32]
                    };
                    let mut cells: Vec<[u32; 2]> = block.iter().map(cell).collect();
                    cells.sort_unstable();
                    cells.dedup();
                    assert_eq!(cells.len(), 1 << m);
                }
            }
        }
    }

    /// The mean of products of two coordinates that do not depend on each other is 1/4: of sets,
    /// pixels and branches.
    #[test]
    fn sets_pixels_and_branches_do_not_depend_on_each_other() {
        const COUNT: u32 = 1 << 14;
        let mean = |of: &dyn Fn(u32) -> (f64, f64)| {
            let product = |k| {
                let (x, y) = of(k);
                x * y
            };
            (0..COUNT).map(product).sum::<f64>() / f64::from(COUNT)
        };
        // Six standard errors of independent numbers.
        let close = 6.0 * (7.0_f64 / 144.0).sqrt() / f64::from(COUNT).sqrt();
        let between_sets = mean(&|k| {
            let mut draws = Draws::new(3, k);
            (draws.one(), draws.one())
        });
        let between_pixels = mean(&|k| {
            let pixel = u64::from(k / 16);
            (Draws::new(pixel, k % 16).one(), Draws::new(pixel + 1, k % 16).one())
        });
        let between_branches = mean(&|k| {
            let draws = Draws::new(u64::from(k), 0);
            (draws.split(0).one(), draws.split(1).one())
        });
        for mean in [between_sets, between_pixels, between_branches] {
            assert!((mean - 0.25).abs() < close, "{mean}");
        }
    }

    /// The mean square error of f(x, y) = 1 where x + y < 1, with 64 samples over many pixels, has
    /// a root far below that of chance.
    #[test]
    fn an_edge_is_integrated_better_than_by_chance() {
        let error = |pixel| {
            let inside = (0..64).filter(|&k| Draws::new(pixel, k).two().element_sum() < 1.0);
            let off = inside.count() as f64 / 64.0 - 0.5;
            off * off
        };
        let squares: f64 = (0..512).map(error).sum();
        let error = (squares / 512.0).sqrt();
        // By chance it is sqrt(1/4 / 64) = 0.0625.
        assert!(error < 0.03, "{error}");
    }
}
