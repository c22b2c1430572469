//! How much of each pixel lines cover.
//!
//! A line of width w covers, of a pixel whose centre is at a distance d from its middle, what a box of one pixel has in common with a
//! box of width w: `(w + 1) / 2 - d`, from 0 to the smaller of 1 and w. Across a line that comes to w, whatever the width. It falls with
//! the distance, so the largest coverage is that of the nearest piece: into how many pieces a line is cut does not matter, nor
//! how often it is drawn, and ends and corners are round.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::{DVec2, single};
use crate::memory::zeroed;

/// Pieces of lines, from the top to the bottom.
#[derive(Debug, Clone)]
pub(super) struct Drawing {
    pieces: Vec<[DVec2; 2]>,
    width: f64,
    /// No piece is higher.
    highest: f64,
}

fn top([a, b]: &[DVec2; 2]) -> f64 {
    a.y.min(b.y)
}

impl Drawing {
    pub(super) fn new(mut pieces: Vec<[DVec2; 2]>, width: f64) -> Self {
        pieces.par_sort_unstable_by(|a, b| top(a).total_cmp(&top(b)));
        let heights = pieces.iter().map(|[a, b]| (a.y - b.y).abs());
        Self {
            highest: heights.fold(0.0, f64::max),
            pieces,
            width,
        }
    }

    pub(super) fn pieces(&self) -> &[[DVec2; 2]] {
        &self.pieces
    }

    /// No pixel whose centre is farther away from a line is covered.
    fn reach(&self) -> f64 {
        0.5 * (self.width + 1.0)
    }

    /// The coverage of the pixels of some rows and columns, row by row.
    pub(super) fn coverage(&self, rows: Range<usize>, columns: Range<usize>) -> Result<Vec<f32>> {
        let mut covered = zeroed(rows.len().saturating_mul(columns.len()))?;
        let lines = covered.par_chunks_mut(columns.len().max(1));
        lines.zip(rows).for_each(|(line, row)| {
            let y = row as f64 + 0.5;
            let first = y - self.reach() - self.highest;
            let first = self.pieces.partition_point(|piece| top(piece) < first);
            let near = self.pieces[first..].iter();
            for piece in near.take_while(|piece| top(piece) <= y + self.reach()) {
                self.cover(piece, y, columns.start, line);
            }
        });
        Ok(covered)
    }

    /// Adds a piece to a row of pixels from a column on, whose centres are at `y`.
    fn cover(&self, piece: &[DVec2; 2], y: f64, column: usize, line: &mut [f32]) {
        let reach = self.reach();
        let [low, high] = [piece[0].x.min(piece[1].x), piece[0].x.max(piece[1].x)];
        let first = whole(low - reach - 0.5).max(column);
        let last = whole(high + reach + 0.5).min(column + line.len());
        for k in first..last {
            let centre = DVec2::new(k as f64 + 0.5, y);
            let covered = reach - distance(centre, piece);
            let covered = single(covered.clamp(0.0, self.width.min(1.0)));
            let pixel = &mut line[k - column];
            *pixel = pixel.max(covered);
        }
    }
}

/// The whole number below, 0 for negative ones.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it saturates"
)]
fn whole(x: f64) -> usize {
    x.floor() as usize
}

/// How far a point is from a stretch of a line.
fn distance(point: DVec2, &[a, b]: &[DVec2; 2]) -> f64 {
    let along = b - a;
    let share = (point - a).dot(along) / along.length_squared();
    // Of a point, which has no length, the share is NaN.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    (point - (a + share * along)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(pieces: Vec<[DVec2; 2]>, width: f64) -> f64 {
        let drawing = Drawing::new(pieces, width);
        let covered = drawing.coverage(0..60, 0..60).unwrap();
        covered.iter().map(|&x| f64::from(x)).sum()
    }

    /// Away from their ends, rows of a level or upright line add up to the width.
    #[test]
    fn the_sum_of_coverage_is_length_times_width() {
        for width in [0.2, 0.7, 1.0, 1.5, 4.3] {
            for y in [30.0, 30.2, 30.5] {
                let line = |x0: f64, x1: f64| vec![[DVec2::new(x0, y), DVec2::new(x1, y)]];
                // The ends are the same, so the difference is that of the lengths.
                let longer = sum(line(10.0, 50.0), width) - sum(line(10.0, 30.0), width);
                assert!((longer - 20.0 * width).abs() < 1e-4, "{width} {y} {longer}");
            }
            // A slanted line meets the pixels at all distances: its sum is the integral but for what a grid makes of kinks, which
            // have slopes of 1 and are crossed at 20 places.
            let line = |x1: f64| {
                vec![[
                    DVec2::new(10.0, 10.0),
                    DVec2::new(x1, 10.0 + 0.7 * (x1 - 10.0)),
                ]]
            };
            let longer = sum(line(50.0), width) - sum(line(30.0), width);
            let length = 20.0 * 1.49_f64.sqrt();
            assert!(
                (longer / (length * width) - 1.0).abs() < 0.01,
                "{width} {longer}"
            );
        }
    }

    #[test]
    fn lines_that_are_drawn_twice_or_in_pieces_are_the_same() {
        let [a, b] = [DVec2::new(10.0, 12.5), DVec2::new(42.0, 44.5)];
        let whole = Drawing::new(vec![[a, b]], 2.5)
            .coverage(0..60, 0..60)
            .unwrap();
        let at = |k: u32| a + f64::from(k) / 64.0 * (b - a);
        let pieces = (0..64).flat_map(|k| [[at(k), at(k + 1)]; 2]).collect();
        let pieces = Drawing::new(pieces, 2.5).coverage(0..60, 0..60).unwrap();
        for (one, other) in whole.iter().zip(&pieces) {
            assert!((one - other).abs() < 1e-6);
        }
    }

    #[test]
    fn a_part_is_that_part_of_the_whole() {
        let [a, b] = [DVec2::new(-5.0, 3.5), DVec2::new(70.0, 44.5)];
        let drawing = Drawing::new(vec![[a, b]], 1.5);
        let whole = drawing.coverage(0..60, 0..60).unwrap();
        let part = drawing.coverage(7..31, 13..60).unwrap();
        assert!(part.iter().any(|&covered| covered > 0.9));
        for (k, covered) in part.iter().enumerate() {
            assert_eq!(*covered, whole[(7 + k / 47) * 60 + 13 + k % 47]);
        }
    }

    #[test]
    fn a_point_is_round() {
        let point = DVec2::splat(20.5);
        let drawing = Drawing::new(vec![[point, point]], 3.0);
        let covered = drawing.coverage(18..23, 18..23).unwrap();
        let row = |k: usize| &covered[5 * k..5 * k + 5];
        let slant = 2.0 - 2.0_f32.sqrt();
        assert_eq!(row(2), [0.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(row(1), [0.0, slant, 1.0, slant, 0.0]);
    }
}
