//! Puts the triangles of a mesh in the order of a space-filling curve.
//!
//! 1. Lay a grid over the middles of the triangles' boxes, with cubes for cells. A cell's number
//!    has the bits of its three coordinates in turn: Morton, "A Computer Oriented Geodetic Data
//!    Base and a New Technique in File Sequencing", IBM 1966.
//! 2. Make a key of each triangle: its cell's number, and below that its own index.
//! 3. Sort the keys by the cells' numbers, digit by digit: large ranges by their highest digit and
//!    by all threads, small ones by one thread, from the lowest digit on.
//!
//! Each step keeps the order of what it does not tell apart, so keys end in the order of all their
//! bits, for any number of threads.

use rayon::prelude::*;

use super::binned_sah::Box32;
use super::weld::Sharing;
use crate::accel::space::CHUNK;
use crate::memory;
use crate::parallel;

/// The triangles of a mesh along the curve.
pub(super) struct Curve {
    /// The keys, each a cell's number above a triangle's index.
    keys: Vec<u64>,
    /// The number of bits of the index.
    index_bits: u32,
}

/// The most bits of a cell's number for each axis.
const MOST_BITS: u32 = 16;

impl Curve {
    /// The curve through the triangles' boxes, whose middles are in `around`.
    pub(super) fn new(sharing: &Sharing<'_>, around: Box32) -> Self {
        let count = sharing.triangles.len();
        let index_bits = u32::BITS - u32::try_from(count).unwrap_or(u32::MAX).leading_zeros();
        // If the triangles form a surface, half as many bits as the index has give about one
        // triangle a cell. Three more are for triangles that are not evenly spread.
        let bits = (index_bits / 2 + 3).min((u64::BITS - index_bits) / 3).min(MOST_BITS);
        let grid = Grid::new(around, bits);
        let key = |index: u32| grid.cell(sharing.triangle(index)) << index_bits | u64::from(index);
        let mut keys = memory::room(count);
        (0..u32::try_from(count).unwrap_or(u32::MAX))
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(key)
            .collect_into_vec(&mut keys);
        let mut spare = memory::room(count);
        spare.resize(count, 0);
        sort(&mut keys, &mut spare, [index_bits, 3 * bits], false);
        Self { keys, index_bits }
    }

    /// The keys, in order.
    pub(super) fn keys(&self) -> &[u64] {
        &self.keys
    }

    /// The triangle of a key.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the mask leaves less than 32 bits")]
    pub(super) fn triangle(&self, key: u64) -> u32 {
        (key & ((1 << self.index_bits) - 1)) as u32
    }

    /// The distance of two keys on the curve: the number of the lowest bits of the cells' numbers
    /// that include all that differ. 0 in one cell, and three more for each level of the octree
    /// above.
    #[inline]
    pub(super) fn gap(&self, a: u64, b: u64) -> u32 {
        u64::BITS - ((a ^ b) >> self.index_bits).leading_zeros()
    }
}

/// Cubes of one size.
struct Grid {
    low: [f32; 3],
    scale: f32,
    last: i32,
}

impl Grid {
    fn new(around: Box32, bits: u32) -> Self {
        let (low, high) = (around.low(), around.high());
        let widest = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);
        let scale = (1_u32 << bits) as f32 / widest;
        Self {
            low,
            // All in one place is in one cell.
            scale: if scale.is_finite() { scale } else { 0.0 },
            last: (1 << bits) - 1,
        }
    }

    /// The number of the cell with the middle of a triangle's box.
    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates"
    )]
    fn cell(&self, [a, b, c]: [[f32; 3]; 3]) -> u64 {
        let along = |k: usize| {
            let low = a[k].min(b[k]).min(c[k]);
            let high = a[k].max(b[k]).max(c[k]);
            let place = (0.5 * (low + high) - self.low[k]) * self.scale;
            // By way of i32, for which there is an instruction.
            (place as i32).clamp(0, self.last) as u32
        };
        spread(along(0)) | spread(along(1)) << 1 | spread(along(2)) << 2
    }
}

/// The lowest 16 bits of a number, with two zeros between each and the next.
#[inline]
fn spread(x: u32) -> u64 {
    let x = u64::from(x & 0xffff);
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// The length from which on a range is sorted by all threads.
const LARGE: usize = 2 * CHUNK;
/// Below this a comparison sort is faster than counting digits.
const SMALL: usize = 512;
/// The most bits of a radix sort's digit: the places of its values stay in the first cache.
const DIGIT: u32 = 11;

/// Sorts keys that are in the order of their bits below `low` by the `bits` from there on. They end
/// in `spare` or where they were.
fn sort(keys: &mut [u64], spare: &mut [u64], [low, bits]: [u32; 2], into_spare: bool) {
    if keys.len() < LARGE || bits == 0 {
        return sort_small(keys, spare, [low, bits], into_spare);
    }
    let below = bits.saturating_sub(DIGIT);
    let lengths = by_highest(keys, spare, [low + below, bits - below]);
    let (mut keys, mut spare) = (keys, spare);
    let mut parts = Vec::new();
    for length in lengths {
        let (of_keys, more) = keys.split_at_mut(length);
        let (of_spare, other) = spare.split_at_mut(length);
        (keys, spare) = (more, other);
        if length > 0 {
            parts.push((of_spare, of_keys));
        }
    }
    let part =
        |(keys, spare): (&mut [u64], &mut [u64])| sort(keys, spare, [low, below], !into_spare);
    parallel::each(parts, part);
}

/// Sorts `from` by a digit into `to`; returns how many keys have each value of it.
fn by_highest(from: &[u64], to: &mut [u64], [shift, bits]: [u32; 2]) -> Vec<usize> {
    let values = 1 << bits;
    let chunk = CHUNK.max(from.len().div_ceil(64));
    let counts = parallel::map(from.chunks(chunk), |keys| {
        let mut counts = vec![0_usize; values];
        for &key in keys {
            counts[digit(key, shift, bits)] += 1;
        }
        counts
    });
    // Of each chunk, the places for its keys with each value.
    let mut places: Vec<Vec<&mut [u64]>> = Vec::new();
    places.resize_with(counts.len(), || Vec::with_capacity(values));
    let mut to = to;
    for value in 0..values {
        for (places, counts) in places.iter_mut().zip(&counts) {
            let (own, others) = to.split_at_mut(counts[value]);
            places.push(own);
            to = others;
        }
    }
    let chunks = from.chunks(chunk).zip(places);
    parallel::each(chunks, |(keys, mut places): (_, Vec<_>)| {
        for &key in keys {
            let place = &mut places[digit(key, shift, bits)];
            if let Some((first, others)) = std::mem::take(place).split_first_mut() {
                *first = key;
                *place = others;
            }
        }
    });
    let all = |value: usize| counts.iter().map(|counts| counts[value]).sum();
    (0..values).map(all).collect()
}

fn sort_small(keys: &mut [u64], spare: &mut [u64], [low, bits]: [u32; 2], into_spare: bool) {
    if keys.len() < SMALL || bits == 0 {
        // In the order of all their bits is in that of the higher ones.
        keys.sort_unstable();
        if into_spare {
            spare.copy_from_slice(keys);
        }
        return;
    }
    // As many as leave them where they are to be.
    let mut digits = bits.div_ceil(DIGIT);
    digits += u32::from((digits % 2 == 1) != into_spare);
    let width = bits.div_ceil(digits);
    let (mut from, mut to) = (keys, spare);
    for pass in 0..digits {
        let shift = low + pass * width;
        let mut places = [0_u32; 1 << DIGIT];
        for &key in &*from {
            places[digit(key, shift, width)] += 1;
        }
        let mut next = 0;
        for place in &mut places[..1 << width] {
            next += std::mem::replace(place, next);
        }
        for &key in &*from {
            let place = &mut places[digit(key, shift, width)];
            to[*place as usize] = key;
            *place += 1;
        }
        (from, to) = (to, from);
    }
}

/// The `bits` bits of a key from `shift` on.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the mask leaves a few bits")]
fn digit(key: u64, shift: u32, bits: u32) -> usize {
    (key >> shift) as usize & ((1 << bits) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread() {
        for x in 0..1 << 16 {
            let expected = (0..16).fold(0, |all, bit| all | u64::from(x >> bit & 1) << (3 * bit));
            assert_eq!(spread(x), expected);
        }
    }

    /// All in a few cells, in the same, evenly spread; few and many.
    #[test]
    fn keys_are_sorted() {
        for (count, cells) in [(0, 1), (1, 1), (600, 1 << 9), (70_000, 1 << 20), (300_000, 3)] {
            for bits in [0, 1, 11, 12, 25, 40] {
                for into_spare in [false, true] {
                    let cell = |k: u64| k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
                    let key = |k: u64| ((cell(k) % cells) % (1 << bits)) << 20 | k;
                    let mut keys: Vec<u64> = (0..count).map(key).collect();
                    let mut spare = vec![0; keys.len()];
                    let mut sorted = keys.clone();
                    sorted.sort_unstable();
                    sort(&mut keys, &mut spare, [20, bits], into_spare);
                    assert!(if into_spare { spare } else { keys } == sorted);
                }
            }
        }
    }
}
