//! Choices with given weights, by inversion of the cumulative distribution: the chosen one is that
//! whose interval of the cumulative sums a number falls into, found by halving (Devroye,
//! "Non-Uniform Random Variate Generation", 1986, chapter III.2). In a grid a row is chosen by the
//! sums of rows, and then a cell by those within the row (Pharr, Jakob and Humphreys, "Physically
//! Based Rendering", 4th edition, 2023, appendix A).

use crate::geometry::DVec2;

/// A choice of one of several, each as often as its weight says.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
pub struct Distribution {
    /// The weights up to each, itself included.
    sums: Vec<f64>,
}

/// A choice: its number, and the place in it, from 0 up to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub struct Choice {
    pub index: usize,
    pub inside: f64,
}

impl Distribution {
    /// `None` unless the weights are finite, none is negative, and some are positive.
    pub fn new(mut weights: Vec<f64>) -> Option<Self> {
        let total = accumulate(&mut weights)?;
        (total > 0.0).then_some(Self { sums: weights })
    }

    /// The choice that a number from 0 to 1 stands for; never one of weight 0.
    pub fn choose(&self, u: f64) -> Choice {
        choose(&self.sums, u)
    }

    /// The probability of choosing an index.
    pub fn share(&self, index: usize) -> f64 {
        weight(&self.sums, index) / last(&self.sums)
    }
}

/// A choice of a cell of a grid: of a row, and then of a cell in it.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
pub struct Distribution2d {
    columns: usize,
    /// The sums of each row's weights up to each cell, row after row.
    sums: Vec<f64>,
    rows: Distribution,
}

/// A cell, and where in it: across and down, from 0 up to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub struct Cell {
    pub column: usize,
    pub row: usize,
    pub inside: DVec2,
}

impl Distribution2d {
    /// Builds the distribution from weights in row-major order. `None` unless they are finite, none
    /// is negative, and some are positive.
    pub fn new(columns: usize, mut weights: Vec<f64>) -> Option<Self> {
        let rows = weights.chunks_exact_mut(columns.max(1));
        let rows = rows.map(accumulate).collect::<Option<Vec<f64>>>()?;
        Some(Self { columns, rows: Distribution::new(rows)?, sums: weights })
    }

    /// The cell that a point of the unit square stands for; never one of weight 0.
    pub fn choose(&self, u: DVec2) -> Cell {
        let row = self.rows.choose(u.y);
        let column = choose(self.row(row.index), u.x);
        Cell { column: column.index, row: row.index, inside: DVec2::new(column.inside, row.inside) }
    }

    /// The probability of choosing a cell.
    pub fn share(&self, column: usize, row: usize) -> f64 {
        let sums = self.row(row);
        let total = last(sums);
        if total > 0.0 { self.rows.share(row) * (weight(sums, column) / total) } else { 0.0 }
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.sums[row * self.columns..(row + 1) * self.columns]
    }
}

/// Puts sums in the place of weights, and returns the last. `None` for weights that make no sense.
fn accumulate(weights: &mut [f64]) -> Option<f64> {
    let mut sum = 0.0;
    for weight in weights {
        if weight.is_nan() || *weight < 0.0 {
            return None;
        }
        sum += *weight;
        *weight = sum;
    }
    sum.is_finite().then_some(sum)
}

fn last(sums: &[f64]) -> f64 {
    sums.last().copied().unwrap_or(0.0)
}

fn before(sums: &[f64], index: usize) -> f64 {
    if index == 0 { 0.0 } else { sums[index - 1] }
}

fn weight(sums: &[f64], index: usize) -> f64 {
    sums[index] - before(sums, index)
}

/// The first whose sum is above the share `u` of all, so one whose sum is above that of the one
/// before.
fn choose(sums: &[f64], u: f64) -> Choice {
    let total = last(sums);
    let place = (u * total).min(total.next_down()).max(0.0);
    let index = sums.partition_point(|&sum| sum <= place);
    let inside = (place - before(sums, index)) / weight(sums, index);
    Choice { index, inside: inside.clamp(0.0, 1.0_f64.next_down()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEIGHTS: [f64; 6] = [0.0, 3.0, 0.0, 0.5, 4.5, 0.0];

    #[test]
    fn each_is_chosen_as_often_as_its_weight_says() {
        let table = Distribution::new(WEIGHTS.to_vec()).unwrap();
        let mut counts = [0.0; 6];
        for k in 0..800 {
            let choice = table.choose((f64::from(k) + 0.5) / 800.0);
            counts[choice.index] += 0.01;
            assert!((0.0..1.0).contains(&choice.inside));
        }
        for (index, (count, weight)) in counts.into_iter().zip(WEIGHTS).enumerate() {
            assert!((count - weight).abs() < 1e-9, "{count} {weight}");
            assert_eq!(table.share(index), weight / 8.0);
        }
    }

    #[test]
    fn what_has_no_weight_is_never_chosen_not_even_at_the_ends() {
        let table = Distribution::new(WEIGHTS.to_vec()).unwrap();
        assert_eq!(table.choose(0.0).index, 1);
        assert_eq!(table.choose(0.375).index, 3);
        assert_eq!((table.choose(1.0).index, table.choose(-0.0).index), (4, 1));
    }

    #[test]
    fn points_of_a_square_become_points_of_its_cells_in_order() {
        let weights = vec![1.0, 0.0, 3.0, 0.0, 0.0, 0.0, 2.0, 2.0, 0.0];
        let table = Distribution2d::new(3, weights.clone()).unwrap();
        let mut counts = [0.0; 9];
        for k in 0..64 * 64 {
            let u = (DVec2::new(f64::from(k % 64), f64::from(k / 64)) + 0.5) / 64.0;
            let Cell { column, row, inside } = table.choose(u);
            counts[3 * row + column] += 8.0 / 4096.0;
            let above: f64 = (0..row)
                .flat_map(|row| (0..3).map(move |column| (column, row)))
                .map(|(column, row)| table.share(column, row))
                .sum();
            let within: f64 = (0..3).map(|column| table.share(column, row)).sum();
            assert!((above + inside.y * within - u.y).abs() < 1e-12);
        }
        for (k, (count, weight)) in counts.into_iter().zip(weights).enumerate() {
            assert!((count - weight).abs() < 1e-9, "{k}: {count} {weight}");
            assert_eq!(table.share(k % 3, k / 3), weight / 8.0);
        }
    }

    #[test]
    fn weights_that_make_no_sense_are_refused() {
        for wrong in [f64::NAN, -1.0, f64::INFINITY] {
            assert_eq!(Distribution::new(vec![1.0, wrong, 1.0]), None);
            assert_eq!(Distribution2d::new(1, vec![1.0, wrong]), None);
        }
        assert_eq!(Distribution::new(vec![0.0; 3]), None);
        assert_eq!(Distribution::new(vec![]), None);
        assert_eq!(Distribution2d::new(0, vec![]), None);
        assert_eq!(Distribution::new(vec![f64::MAX; 2]), None);
    }
}
