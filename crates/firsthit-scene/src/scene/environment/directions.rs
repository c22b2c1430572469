//! Directions as points of a latitude-longitude picture, and tables to draw them from.
//!
//! In an environment's own frame +y is up, the picture's middle looks along +x, and to the right of
//! it is +z: the guideline of glTF's makers (KhronosGroup/glTF, pull request 1761).

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use crate::geometry::{DVec2, DVec3, unit};
use crate::sampling::distribution::{Cell, Distribution2d};

/// The place of a direction of any length in the picture: from 0 at the left to 1 at the right, and
/// from 0 at the top to 1 at the bottom. NaN for no direction.
pub(super) fn place_of(direction: DVec3) -> DVec2 {
    let DVec3 { x, y, z } = unit(direction);
    if y.is_nan() {
        return DVec2::NAN;
    }
    let across = 0.5 + libm::atan2(z, x) / TAU;
    // Not by the arc cosine of y, which loses half of the digits at the poles.
    let down = libm::atan2((x * x + z * z).sqrt(), y) * FRAC_1_PI;
    DVec2::new(across, down)
}

/// The direction, of length one, of a share of the way around and of its height, the cosine of its
/// angle from straight up.
fn direction_of(across: f64, height: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * (across - 0.5));
    let level = (1.0 - height * height).max(0.0).sqrt();
    DVec3::new(level * cos, height, level * sin)
}

/// The least contrast, the luminance's standard deviation over its mean, at which directions are
/// drawn by luminance. Below, the directions that surfaces choose are as good.
const LEAST_CONTRAST: f64 = 0.5;

/// The least factor on a cell's luminance in the table: surfaces find what is dim by themselves.
const SHARE_OF_DIM: f64 = 1.0 / 16.0;

/// A grid of directions, drawn more often where it is bright. Within a cell they are even by solid
/// angle.
///
/// A direction is drawn for its light above the mean, and all for a small share of it: surfaces
/// find the rest by directions of their own choice (Karlík and others, "MIS Compensation:
/// Optimizing Sampling Techniques in Multiple Importance Sampling", ACM Transactions on Graphics
/// 38(6), 2019).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DirectionTable {
    columns: usize,
    /// The cosines of the angles from straight up at which rows begin, and at which the last one
    /// ends.
    heights: Vec<f64>,
    cells: Distribution2d,
}

impl DirectionTable {
    /// Builds the table from mean luminances, row by row from the top. `None` where they vary too
    /// little.
    pub(super) fn new(columns: usize, mut luminances: Vec<f64>) -> Option<Self> {
        let rows = luminances.len() / columns.max(1);
        let height = |row: usize| libm::cos(PI * row as f64 / rows as f64);
        let heights: Vec<f64> = (0..=rows).map(height).collect();
        // The area of a zone is in proportion to its height (Archimedes).
        let share = |row: usize| 0.5 * (heights[row] - heights[row + 1]) / columns as f64;
        let (mut mean, mut squares) = (0.0, 0.0);
        for (row, line) in luminances.chunks_exact(columns.max(1)).enumerate() {
            mean += share(row) * line.iter().sum::<f64>();
            squares += share(row) * line.iter().map(|value| value * value).sum::<f64>();
        }
        let variance = squares - mean * mean;
        let least = (LEAST_CONTRAST * mean) * (LEAST_CONTRAST * mean);
        if variance.is_nan() || variance <= least {
            return None;
        }
        for (row, line) in luminances.chunks_exact_mut(columns).enumerate() {
            for value in line {
                *value = share(row) * (*value - mean).max(SHARE_OF_DIM * *value);
            }
        }
        let cells = Distribution2d::new(columns, luminances)?;
        Some(Self { columns, heights, cells })
    }

    /// The direction that a point of the unit square stands for, of length one, and how dense such
    /// are, per steradian.
    pub(super) fn draw(&self, u: DVec2) -> (DVec3, f64) {
        let Cell { column, row, inside } = self.cells.choose(u);
        let across = (column as f64 + inside.x) / self.columns as f64;
        let [top, bottom] = [self.heights[row], self.heights[row + 1]];
        let direction = direction_of(across, top + inside.y * (bottom - top));
        (direction, self.pdf_in(column, row))
    }

    /// The probability density of drawing this direction, per steradian.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let place = place_of(direction);
        let rows = self.heights.len() - 1;
        if place.is_nan() {
            return 0.0;
        }
        self.pdf_in(cell_at(place.x, self.columns), cell_at(place.y, rows))
    }

    fn pdf_in(&self, column: usize, row: usize) -> f64 {
        let height = self.heights[row] - self.heights[row + 1];
        let solid_angle = TAU / self.columns as f64 * height;
        self.cells.share(column, row) / solid_angle
    }
}

/// The cell of a row of `count` that a share of the way is in.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and count - 1"
)]
fn cell_at(share: f64, count: usize) -> usize {
    (share * count as f64).clamp(0.0, (count - 1) as f64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Draws;

    /// A bright spot, a wide glow, and a black patch in which nothing may be drawn.
    fn luminances() -> Vec<f64> {
        let of_cell = |k: usize| match (k / 16, k % 16) {
            (2, 5) => 500.0,
            (0..4, _) => 1.0 + (k % 7) as f64,
            (6, 3..9) => 0.0,
            _ => 0.25,
        };
        (0..16 * 8).map(of_cell).collect()
    }

    #[test]
    fn directions_and_places_belong_to_each_other() {
        for (direction, place) in [
            (DVec3::X, [0.5, 0.5]),
            (DVec3::Z, [0.75, 0.5]),
            (DVec3::new(0.0, 0.0, -2.0), [0.25, 0.5]),
            (3.0 * DVec3::Y, [0.5, 0.0]),
            (DVec3::new(0.0, -1.0, 0.0), [0.5, 1.0]),
        ] {
            assert_eq!(place_of(direction).to_array(), place, "{direction}");
        }
        for k in 0..100 {
            let u = Draws::new(3, k).two();
            let direction = direction_of(u.x, 1.0 - 2.0 * u.y);
            assert!((direction.length() - 1.0).abs() < 1e-14);
            assert!((place_of(direction).x - u.x).abs() < 1e-12);
            assert!((libm::cos(PI * place_of(direction).y) - direction.y).abs() < 1e-12);
        }
        assert!(place_of(DVec3::ZERO).is_nan() && place_of(DVec3::NAN).is_nan());
    }

    #[test]
    fn the_density_of_what_is_drawn_is_what_is_said_and_integrates_to_one() {
        let table = DirectionTable::new(16, luminances()).unwrap();
        let count = 1 << 12;
        for k in 0..count {
            let (direction, pdf) = table.draw(Draws::new(7, k).two());
            assert!(pdf > 0.0);
            assert!((table.pdf(direction) / pdf - 1.0).abs() < 1e-9);
        }
        // By the middles of finer cells that are even by solid angle.
        let mut sum = 0.0;
        for row in 0..8 {
            for k in 0..64 * 32 {
                let inside = (f64::from(k / 64) + 0.5) / 32.0;
                let (top, bottom) = (table.heights[row], table.heights[row + 1]);
                let across = (f64::from(k % 64) + 0.5) / 64.0;
                let direction = direction_of(across, top + inside * (bottom - top));
                sum += table.pdf(direction) * TAU * (top - bottom) / (64.0 * 32.0);
            }
        }
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }

    /// The mean of 1 / pdf over drawn directions is the solid angle of all that is not black.
    #[test]
    fn what_is_drawn_covers_all_that_shines() {
        let table = DirectionTable::new(16, luminances()).unwrap();
        let count = 1 << 16;
        let inverse = (0..count).map(|k| 1.0 / table.draw(Draws::new(1, k).two()).1);
        let covered = inverse.sum::<f64>() / f64::from(count);
        let black = 6.0 / 16.0 * 0.5 * (table.heights[6] - table.heights[7]);
        let expected = 4.0 * PI * (1.0 - black);
        assert!((covered / expected - 1.0).abs() < 0.01, "{covered} {expected}");
    }

    #[test]
    fn what_hardly_varies_is_left_to_surfaces() {
        assert_eq!(DirectionTable::new(4, vec![3.0; 8]), None);
        assert_eq!(DirectionTable::new(4, vec![0.0; 8]), None);
        let gentle = (0..8).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
        assert_eq!(DirectionTable::new(4, gentle), None);
        assert_eq!(DirectionTable::new(1, vec![f64::NAN; 2]), None);
    }
}
