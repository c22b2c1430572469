//! The surface area heuristic over bins: where to split a range of boxes.

use rayon::prelude::*;

const BINS: usize = 16;
/// How many boxes one task takes of a large range.
const CHUNK: usize = 65_536;

/// A float32 box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Box32 {
    pub(super) low: [f32; 3],
    pub(super) high: [f32; 3],
}

impl Box32 {
    const EMPTY: Self = Self {
        low: [f32::INFINITY; 3],
        high: [f32::NEG_INFINITY; 3],
    };

    /// The smallest box around points.
    pub(super) fn of([a, b, c]: [[f32; 3]; 3]) -> Self {
        Self {
            low: std::array::from_fn(|k| a[k].min(b[k]).min(c[k])),
            high: std::array::from_fn(|k| a[k].max(b[k]).max(c[k])),
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Half the surface; in float64, for the product of two coordinates of 1e30 is nothing that float32 holds.
    pub(super) fn half_area(self) -> f64 {
        let [x, y, z] = std::array::from_fn(|k| f64::from(self.high[k]) - f64::from(self.low[k]));
        x * y + y * z + z * x
    }

    /// Twice the middle: the factor cancels.
    fn middle(self) -> [f32; 3] {
        std::array::from_fn(|k| self.low[k] + self.high[k])
    }
}

/// A box relative to the local origin, and whose it is.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub(super) bounds: Box32,
    pub(super) index: u32,
}

/// The box around a range.
pub(super) fn around(items: &[Item]) -> Box32 {
    let one = |items: &[Item]| {
        items
            .iter()
            .fold(Box32::EMPTY, |all, item| all.union(item.bounds))
    };
    in_chunks(items, one, Box32::EMPTY, Box32::union)
}

/// A quantity of a range from those of its parts; large ranges by all threads. `combine` does not mind the
/// order, so the result is the same for any number of them.
fn in_chunks<T: Copy + Send + Sync>(
    items: &[Item],
    one: impl Fn(&[Item]) -> T + Send + Sync,
    nothing: T,
    combine: impl Fn(T, T) -> T + Send + Sync,
) -> T {
    if items.len() < CHUNK {
        one(items)
    } else {
        items.par_chunks(CHUNK).map(one).reduce(|| nothing, combine)
    }
}

#[derive(Clone, Copy)]
struct Bin {
    count: u32,
    bounds: Box32,
}

type Bins = [[Bin; BINS]; 3];

impl Bin {
    const EMPTY: Self = Self {
        count: 0,
        bounds: Box32::EMPTY,
    };

    fn merge(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            bounds: self.bounds.union(other.bounds),
        }
    }

    /// What a ray that meets the parent is expected to pay here, but for a common factor.
    fn cost(self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        self.bounds.half_area() * f64::from(self.count)
    }
}

/// How the middles of a range's boxes fall into bins along each axis.
struct Grid {
    low: [f32; 3],
    scale: [f32; 3],
}

impl Grid {
    /// `None` when all middles are at one point.
    fn new(items: &[Item]) -> Option<Self> {
        let one = |items: &[Item]| {
            items.iter().fold(Box32::EMPTY, |all, item| {
                let middle = item.bounds.middle();
                all.union(Box32 {
                    low: middle,
                    high: middle,
                })
            })
        };
        let Box32 { low, high } = in_chunks(items, one, Box32::EMPTY, Box32::union);
        // A scale of zero puts everything into one bin, which leaves nothing to split along that axis.
        let scale = std::array::from_fn(|k| {
            let scale = BINS as f32 / (high[k] - low[k]);
            if scale.is_finite() { scale } else { 0.0 }
        });
        (scale != [0.0; 3]).then_some(Self { low, scale })
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates"
    )]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let place = (item.bounds.middle()[axis] - self.low[axis]) * self.scale[axis];
        (place as usize).min(BINS - 1)
    }

    fn fill(&self, items: &[Item]) -> Bins {
        let one = |items: &[Item]| {
            let mut bins = [[Bin::EMPTY; BINS]; 3];
            for item in items {
                let item_bin = Bin {
                    count: 1,
                    bounds: item.bounds,
                };
                for (axis, bins) in bins.iter_mut().enumerate() {
                    let bin = &mut bins[self.bin(item, axis)];
                    *bin = bin.merge(item_bin);
                }
            }
            bins
        };
        let merge = |a: Bins, b: Bins| {
            std::array::from_fn(|axis| std::array::from_fn(|k| a[axis][k].merge(b[axis][k])))
        };
        in_chunks(items, one, [[Bin::EMPTY; BINS]; 3], merge)
    }
}

/// Reorders a range so that it falls into the two parts of least expected cost, and returns where the second
/// one starts; `None` when no plane separates the middles.
pub(super) fn split(items: &mut [Item]) -> Option<usize> {
    let grid = Grid::new(items)?;
    let (axis, plane) = cheapest(&grid.fill(items))?;
    let middle = partition(items, |item| grid.bin(item, axis) < plane);
    (middle > 0 && middle < items.len()).then_some(middle)
}

/// The axis, and the first bin of the right side, with the lowest expected cost; on a tie the first.
fn cheapest(bins: &Bins) -> Option<(usize, usize)> {
    let mut best = (f64::INFINITY, None);
    for (axis, bins) in bins.iter().enumerate() {
        let mut rights = [Bin::EMPTY; BINS];
        for k in (1..BINS).rev() {
            rights[k] = bins[k].merge(rights.get(k + 1).copied().unwrap_or(Bin::EMPTY));
        }
        let mut left = Bin::EMPTY;
        for k in 1..BINS {
            left = left.merge(bins[k - 1]);
            let cost = left.cost() + rights[k].cost();
            if left.count > 0 && rights[k].count > 0 && cost < best.0 {
                best = (cost, Some((axis, k)));
            }
        }
    }
    best.1
}

fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> usize {
    let (mut low, mut high) = (0, items.len());
    while low < high {
        if is_left(&items[low]) {
            low += 1;
        } else {
            high -= 1;
            items.swap(low, high);
        }
    }
    low
}
