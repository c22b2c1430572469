//! The coverage of pixels by lines.
//!
//! Of a pixel whose centre is at a distance d from the middle of a line of width w, the line covers
//! the overlap of a box of one pixel with a box of width w: `(w + 1) / 2 - d`, from 0 to the
//! smaller of 1 and w. Its integral across the line is w, whatever the width. A pixel has the
//! largest coverage of all pieces, which is that of the nearest: so it does not matter into how
//! many pieces a line is cut, nor how often it is drawn, and ends and corners are round.

use std::cmp::Ordering;
use std::ops::Range;

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, single};
use crate::memory::zeroed;
use crate::parallel;
use crate::watch::{Watch, stop_if_asked};

/// The number of pieces that are drawn in a row of pixels before the watch is asked again. With the
/// widest lines that takes a few milliseconds.
const AT_ONCE: usize = 1 << 8;

/// The lines of a picture's edges.
///
/// ```
/// use firsthit::edge::{Edges, Lines, Subject};
/// use firsthit::shoot::Cpu;
/// use firsthit::{Camera, DVec3, Object, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, 45.0, 100, 100)?;
/// let subject = Subject { scene: &scene, camera: &camera, engine: Cpu::shared(), cull: None };
/// let lines = Lines::new(&subject, &Edges::default(), [0..100, 0..100], &())?;
/// let covered: f32 = lines.coverage(0..100, 0..100, &())?.iter().sum();
/// // The sphere is seen as a circle.
/// let radius = 50.0 / 22.5_f32.to_radians().tan() / 24_f32.sqrt();
/// assert!((covered / (std::f32::consts::TAU * radius) - 1.0).abs() < 0.01);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone)]
pub struct Lines {
    /// Sorted from the top to the bottom.
    pieces: Vec<[DVec2; 2]>,
    width: f64,
    /// The height of the highest piece.
    highest: f64,
}

summary!(Lines, "Lines", |it| "pieces": it.pieces.len());

fn top([a, b]: &[DVec2; 2]) -> f64 {
    a.y.min(b.y)
}

/// Orders pieces by all coordinates, so that the order depends on the pieces alone, and not on
/// where the meshes are in memory.
fn order(one: &[DVec2; 2], other: &[DVec2; 2]) -> Ordering {
    let key = |piece: &[DVec2; 2]| [top(piece), piece[0].y, piece[0].x, piece[1].y, piece[1].x];
    let [one, other] = [one, other].map(key);
    let each = one.iter().zip(&other).map(|(a, b)| a.total_cmp(b));
    each.fold(Ordering::Equal, Ordering::then)
}

impl Lines {
    pub(super) fn of(mut pieces: Vec<[DVec2; 2]>, width: f64) -> Self {
        pieces.par_sort_unstable_by(order);
        let heights = pieces.iter().map(|[a, b]| (a.y - b.y).abs());
        Self { highest: heights.fold(0.0, f64::max), pieces, width }
    }

    /// The pieces of the lines, from the top to the bottom, in pixels from the picture's left and
    /// upper edges, as [`Camera::project`](crate::camera::Camera::project) has them.
    pub fn pieces(&self) -> &[[DVec2; 2]] {
        &self.pieces
    }

    /// Pixels whose centres are farther away from a line are not covered.
    fn reach(&self) -> f64 {
        0.5 * (self.width + 1.0)
    }

    /// The coverage of the pixels of some rows and columns, from 0 to 1, row by row. They must be
    /// among those that the lines were made for.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when there is not enough memory, and
    /// [`Error::Interrupted`](crate::error::Error::Interrupted) when `watch` stops it.
    pub fn coverage(
        &self,
        rows: Range<usize>,
        columns: Range<usize>,
        watch: &dyn Watch,
    ) -> Result<Vec<f32>> {
        let mut covered = zeroed(rows.len().saturating_mul(columns.len()))?;
        let lines = covered.chunks_mut(columns.len().max(1));
        parallel::try_each(lines.zip(rows), |(line, row)| {
            let y = row as f64 + 0.5;
            for pieces in self.near(y).chunks(AT_ONCE) {
                stop_if_asked(watch)?;
                for piece in pieces {
                    self.cover(piece, y, columns.start, line);
                }
            }
            Ok(())
        })?;
        Ok(covered)
    }

    /// All pieces that may cover pixels whose centres are at `y`.
    fn near(&self, y: f64) -> &[[DVec2; 2]] {
        let first = y - self.reach() - self.highest;
        let first = self.pieces.partition_point(|piece| top(piece) < first);
        let rest = &self.pieces[first..];
        &rest[..rest.partition_point(|piece| top(piece) <= y + self.reach())]
    }

    /// Draws a piece into a row of pixels, which begins at a column and whose centres are at `y`.
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

/// Rounded down; 0 for negative numbers.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
fn whole(x: f64) -> usize {
    x.floor() as usize
}

/// The distance from a point to a line segment.
fn distance(point: DVec2, &[a, b]: &[DVec2; 2]) -> f64 {
    let along = b - a;
    let share = (point - a).dot(along) / along.length_squared();
    // The share is NaN for a segment without length.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    (point - (a + share * along)).length()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    use super::*;
    use crate::error::Error;

    fn sum(pieces: Vec<[DVec2; 2]>, width: f64) -> f64 {
        let drawing = Lines::of(pieces, width);
        let covered = drawing.coverage(0..60, 0..60, &()).unwrap();
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
            // A slanted line meets the pixels at all distances: its sum is the integral but for
            // what a grid makes of kinks, which have slopes of 1 and are crossed at 20 places.
            let line =
                |x1: f64| vec![[DVec2::new(10.0, 10.0), DVec2::new(x1, 10.0 + 0.7 * (x1 - 10.0))]];
            let longer = sum(line(50.0), width) - sum(line(30.0), width);
            let length = 20.0 * 1.49_f64.sqrt();
            assert!((longer / (length * width) - 1.0).abs() < 0.01, "{width} {longer}");
        }
    }

    #[test]
    fn lines_that_are_drawn_twice_or_in_pieces_are_the_same() {
        let [a, b] = [DVec2::new(10.0, 12.5), DVec2::new(42.0, 44.5)];
        let whole = Lines::of(vec![[a, b]], 2.5).coverage(0..60, 0..60, &()).unwrap();
        let at = |k: u32| a + f64::from(k) / 64.0 * (b - a);
        let pieces = (0..64).flat_map(|k| [[at(k), at(k + 1)]; 2]).collect();
        let pieces = Lines::of(pieces, 2.5).coverage(0..60, 0..60, &()).unwrap();
        for (one, other) in whole.iter().zip(&pieces) {
            assert!((one - other).abs() < 1e-6);
        }
    }

    #[test]
    fn a_part_is_that_part_of_the_whole() {
        let [a, b] = [DVec2::new(-5.0, 3.5), DVec2::new(70.0, 44.5)];
        let drawing = Lines::of(vec![[a, b]], 1.5);
        let whole = drawing.coverage(0..60, 0..60, &()).unwrap();
        let part = drawing.coverage(7..31, 13..60, &()).unwrap();
        assert!(part.iter().any(|&covered| covered > 0.9));
        for (k, covered) in part.iter().enumerate() {
            assert_eq!(*covered, whole[(7 + k / 47) * 60 + 13 + k % 47]);
        }
    }

    /// Ties in height, and ties in all but one coordinate.
    #[test]
    fn pieces_have_one_order_however_they_were_found() {
        let ends = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(DVec2::from);
        let pieces = ends.iter().flat_map(|&a| ends.map(|b| [a, b]));
        let mut pieces: Vec<[DVec2; 2]> = pieces.collect();
        let one = Lines::of(pieces.clone(), 1.0);
        pieces.reverse();
        let other = Lines::of(pieces, 1.0);
        assert_eq!(one.pieces(), other.pieces());
    }

    /// Stops after a number of questions.
    struct StopsAfter(AtomicUsize);

    impl Watch for StopsAfter {
        fn is_stopped(&self) -> bool {
            let stop = |left: usize| left.checked_sub(1);
            self.0.fetch_update(Relaxed, Relaxed, stop).is_err()
        }
    }

    #[test]
    fn wide_lines_are_interrupted_within_a_row() {
        let line = |k: i32| {
            let x = f64::from(k) / 64.0;
            [DVec2::new(x, 0.5), DVec2::new(x + 0.4, 0.5)]
        };
        let pieces: Vec<_> = (0..2000).map(line).collect();
        let drawing = Lines::of(pieces, 1000.0);
        // A row asks once for every 256 pieces.
        for (asked, is_interrupted) in [(0, true), (7, true), (8, false)] {
            let watch = StopsAfter(AtomicUsize::new(asked));
            let made = drawing.coverage(0..1, 0..40, &watch);
            assert_eq!(matches!(made, Err(Error::Interrupted)), is_interrupted);
        }
    }

    #[test]
    fn a_point_is_round() {
        let point = DVec2::splat(20.5);
        let drawing = Lines::of(vec![[point, point]], 3.0);
        let covered = drawing.coverage(18..23, 18..23, &()).unwrap();
        let row = |k: usize| &covered[5 * k..5 * k + 5];
        let slant = 2.0 - 2.0_f32.sqrt();
        assert_eq!(row(2), [0.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(row(1), [0.0, slant, 1.0, slant, 0.0]);
    }
}
