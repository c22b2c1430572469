//! The directional albedo of lobes: the share of white light from everywhere that they reflect into
//! one direction, in tables by roughness and cosine.

use std::sync::OnceLock;

use crate::parallel;

/// The number of roughnesses in a table, each larger than the last by one factor.
const ROUGHNESSES: usize = 48;

/// The number of cosines: fourth powers of even steps, since albedos change most where a surface is
/// seen from the side.
const COSINES: usize = 48;

/// The least cosine that is summed for.
const LEAST_COSINE: f64 = 1e-6;

type Row<const N: usize> = [[f64; N]; COSINES];

/// A table of `N` numbers for each roughness and cosine. A row is made when its roughness is first
/// asked for.
pub(super) struct Albedos<const N: usize> {
    rows: [OnceLock<Row<N>>; ROUGHNESSES],
    /// The roughness of the first row. That of the last is 1.
    least: f64,
    /// The numbers for a cosine and a roughness.
    sum: fn(f64, f64) -> [f64; N],
}

/// A table's row of one roughness.
#[derive(Debug, Clone, Copy)]
pub(super) struct AlbedosOfRoughness<const N: usize> {
    rows: [&'static Row<N>; 2],
    /// The weight of the second row, from 0 to 1.
    share: f64,
}

impl<const N: usize> Albedos<N> {
    pub(super) const fn new(least: f64, sum: fn(f64, f64) -> [f64; N]) -> Self {
        Self { rows: [const { OnceLock::new() }; ROUGHNESSES], least, sum }
    }

    pub(super) fn of(&'static self, roughness: f64) -> AlbedosOfRoughness<N> {
        let (row, share) = place(1.0 - libm::log(roughness) / libm::log(self.least), ROUGHNESSES);
        AlbedosOfRoughness { rows: [self.row(row), self.row(row + 1)], share }
    }

    fn row(&'static self, row: usize) -> &'static Row<N> {
        parallel::once(&self.rows[row], || {
            let to_last = 1.0 - step(row, ROUGHNESSES);
            let roughness = libm::pow(self.least, to_last);
            std::array::from_fn(|column| {
                let root = step(column, COSINES);
                let cosine = root * root * root * root;
                (self.sum)(cosine.max(LEAST_COSINE), roughness)
            })
        })
    }
}

impl<const N: usize> AlbedosOfRoughness<N> {
    /// The numbers for a cosine.
    pub(super) fn at(&self, cosine: f64) -> [f64; N] {
        let (column, across) = place(cosine.abs().sqrt().sqrt(), COSINES);
        let [first, second] = self.rows.map(|row| [row[column], row[column + 1]]);
        let between = |[a, b]: [f64; 2], share: f64| a + share * (b - a);
        std::array::from_fn(|k| {
            let along = [first, second].map(|[left, right]| between([left[k], right[k]], across));
            between(along, self.share)
        })
    }
}

/// The share of the way from the first of `count` entries to the last.
fn step(entry: usize, count: usize) -> f64 {
    entry as f64 / (count - 1) as f64
}

/// The entry below a share of the way, not the last, and how far it is to the next.
fn place(share: f64, count: usize) -> (usize, f64) {
    let place = share.clamp(0.0, 1.0) * (count - 1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and count - 2"
    )]
    let entry = place.floor().min((count - 2) as f64) as usize;
    (entry, place - entry as f64)
}

/// The mean over a rectangle of steps from 0 to 1, each at its middle.
pub(super) fn mean<const N: usize>(
    [rows, columns]: [u32; 2],
    of: impl Fn(f64, f64) -> [f64; N],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for row in 0..rows {
        for column in 0..columns {
            let middle = |step: u32, count: u32| (f64::from(step) + 0.5) / f64::from(count);
            let values = of(middle(row, rows), middle(column, columns));
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += value;
            }
        }
    }
    sum.map(|sum| sum / f64::from(rows * columns))
}
