//! Splits a range of boxes by the surface area heuristic over bins.
//!
//! 1. Put the boxes into 16 bins along each axis by their middles (8 for small ranges); a bin keeps
//!    their count and union.
//! 2. For each plane between two bins, add up what both sides cost a ray: the surface of the box
//!    around a side, times how many blocks of items it has. A block is as many items as are tested
//!    together.
//! 3. Partition the range at the cheapest plane.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on
//! Interactive Ray Tracing 2007. It departs in the cost, which counts blocks in place of items.

use crate::accel::space::CHUNK;
use crate::geometry::arrays;
use crate::parallel;

/// The most bins. In small ranges, where the work is in the bins and not in the boxes, fewer are
/// enough.
const MOST_BINS: usize = 16;
const FEWER_BINS: usize = 8;
const SMALL: usize = 128;

/// A float32 box. The fourth numbers fill a register; they are not part of the box.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub(super) struct Box32 {
    low: [f32; 4],
    high: [f32; 4],
}

impl PartialEq for Box32 {
    fn eq(&self, other: &Self) -> bool {
        (self.low(), self.high()) == (other.low(), other.high())
    }
}

/// The smaller ones of two times four numbers, none of which is NaN: a comparison is one
/// instruction for all.
#[inline(always)]
pub(super) fn smaller(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    arrays::from_fn(|k| if a[k] < b[k] { a[k] } else { b[k] })
}

#[inline(always)]
pub(super) fn larger(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    arrays::from_fn(|k| if a[k] > b[k] { a[k] } else { b[k] })
}

impl Box32 {
    pub(super) const EMPTY: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    /// The box with these two ends.
    #[inline(always)]
    pub(super) fn new([a, b, c]: [f32; 3], [d, e, f]: [f32; 3]) -> Self {
        Self { low: [a, b, c, 0.0], high: [d, e, f, 0.0] }
    }

    /// The smallest box around points.
    #[inline(always)]
    pub(super) fn of(points: [[f32; 3]; 3]) -> Self {
        let [a, b, c] = arrays::map(points, |[x, y, z]| [x, y, z, 0.0]);
        Self { low: smaller(smaller(a, b), c), high: larger(larger(a, b), c) }
    }

    /// The low end.
    pub(super) fn low(&self) -> [f32; 3] {
        let [x, y, z, _] = self.low;
        [x, y, z]
    }

    /// The high end.
    pub(super) fn high(&self) -> [f32; 3] {
        let [x, y, z, _] = self.high;
        [x, y, z]
    }

    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        Self { low: smaller(self.low, other.low), high: larger(self.high, other.high) }
    }

    /// Half the surface; in float64, as the product of two coordinates of 1e30 is too large for
    /// float32.
    #[inline(always)]
    pub(super) fn half_area(self) -> f64 {
        let [x, y, z] = self.size();
        x * y + y * z + z * x
    }

    pub(super) fn volume(self) -> f64 {
        let [x, y, z] = self.size();
        x * y * z
    }

    #[inline(always)]
    fn size(self) -> [f64; 3] {
        arrays::from_fn(|k| f64::from(self.high[k]) - f64::from(self.low[k]))
    }

    /// Twice the middle: the factor cancels.
    #[inline(always)]
    fn middle(self) -> [f32; 4] {
        arrays::from_fn(|k| self.low[k] + self.high[k])
    }
}

/// A box relative to the local origin, and whose it is.
#[derive(Clone, Copy)]
pub(super) struct Item(Box32);

impl Item {
    #[inline(always)]
    pub(super) fn new(bounds: Box32, index: u32) -> Self {
        // In the unused number of the low end, so that an item is two registers.
        let mut bounds = bounds;
        bounds.low[3] = f32::from_bits(index);
        Self(bounds)
    }

    #[inline(always)]
    pub(super) fn index(&self) -> u32 {
        self.0.low[3].to_bits()
    }
}

/// The box around a range.
pub(super) fn around(items: &[Item]) -> Box32 {
    let one = |items: &[Item]| {
        let boxes = items.iter().map(|item| item.0);
        boxes.fold(Box32::EMPTY, Box32::union)
    };
    in_chunks(items, one, Box32::EMPTY, Box32::union)
}

/// A quantity of a range from those of its parts; of a large range by all threads. The order must
/// not matter to `combine`, so that the result is the same for any number of threads.
fn in_chunks<T: Copy + Send + Sync>(
    items: &[Item],
    one: impl Fn(&[Item]) -> T + Send + Sync,
    nothing: T,
    combine: impl Fn(T, T) -> T + Send + Sync,
) -> T {
    if items.len() < CHUNK {
        one(items)
    } else {
        let parts = parallel::map(items.chunks(CHUNK), one);
        parts.into_iter().fold(nothing, combine)
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Box32,
    count: u32,
}

type Bins<const N: usize> = [[Bin; N]; 3];

impl Bin {
    const EMPTY: Self = Self { bounds: Box32::EMPTY, count: 0 };

    #[inline(always)]
    fn merge(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// The expected cost of a ray that meets the parent, but for a factor that all bins share.
    #[inline(always)]
    fn cost(self, Block(bits): Block) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let blocks = (self.count + (1 << bits) - 1) >> bits;
        self.bounds.half_area() * f64::from(blocks)
    }
}

/// The number of items that are tested together, at the cost of one: two to the power of this.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block(pub(super) u32);

/// The map from the middles of a range's boxes to `N` bins along each axis.
struct Grid<const N: usize> {
    low: [f32; 4],
    scale: [f32; 4],
}

impl<const N: usize> Grid<N> {
    /// `None` when all middles are at one point.
    fn new(items: &[Item]) -> Option<Self> {
        let one = |items: &[Item]| {
            items.iter().fold(Box32::EMPTY, |all, item| {
                let middle = item.0.middle();
                all.union(Box32 { low: middle, high: middle })
            })
        };
        let Box32 { low, high } = in_chunks(items, one, Box32::EMPTY, Box32::union);
        // A scale of zero puts everything into one bin, which leaves nothing to split along that
        // axis.
        let scale = arrays::from_fn(|k| {
            let scale = N as f32 / (high[k] - low[k]);
            if k < 3 && scale.is_finite() { scale } else { 0.0 }
        });
        (scale != [0.0; 4]).then_some(Self { low, scale })
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates"
    )]
    #[inline(always)]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let position = (item.0.middle()[axis] - self.low[axis]) * self.scale[axis];
        // By way of i32, for which there is an instruction; it is not below 0 nor above the number
        // of bins.
        (position as i32 as usize).min(N - 1)
    }

    fn fill(&self, items: &[Item]) -> Bins<N> {
        let one = |items: &[Item]| {
            let mut bins = [[Bin::EMPTY; N]; 3];
            for item in items {
                for (axis, bins) in bins.iter_mut().enumerate() {
                    let bin = &mut bins[self.bin(item, axis)];
                    bin.bounds = bin.bounds.union(item.0);
                    bin.count += 1;
                }
            }
            bins
        };
        let merge = |mut all: Bins<N>, more: Bins<N>| {
            for (all, more) in all.iter_mut().zip(more) {
                for (bin, other) in all.iter_mut().zip(more) {
                    *bin = bin.merge(other);
                }
            }
            all
        };
        in_chunks(items, one, [[Bin::EMPTY; N]; 3], merge)
    }

    fn split(items: &mut [Item], block: Block) -> Option<Split> {
        let grid = Self::new(items)?;
        let cut = cheapest(&grid.fill(items), block)?;
        let Cut { axis, plane, .. } = cut;
        let (low, scale, plane) = (grid.low[axis], grid.scale[axis], plane as f32);
        // As `bin` does.
        let is_left = |Item(item): &Item| (item.low[axis] + item.high[axis] - low) * scale < plane;
        let middle = partition(items, is_left);
        (middle > 0 && middle < items.len()).then_some(Split {
            middle,
            left: cut.left,
            right: cut.right,
        })
    }
}

/// The start of a range's second part, and the boxes around both parts.
pub(super) struct Split {
    pub(super) middle: usize,
    pub(super) left: Box32,
    pub(super) right: Box32,
}

/// Reorders a range so that it falls into the two parts of least expected cost; `None` when no
/// plane separates the middles.
pub(super) fn split(items: &mut [Item], block: Block) -> Option<Split> {
    if items.len() < SMALL {
        Grid::<FEWER_BINS>::split(items, block)
    } else {
        Grid::<MOST_BINS>::split(items, block)
    }
}

/// An axis, the first bin of its right side, and the boxes of both sides.
struct Cut {
    axis: usize,
    plane: usize,
    left: Box32,
    right: Box32,
}

/// The cut with the lowest expected cost; on a tie the first.
fn cheapest<const N: usize>(bins: &Bins<N>, block: Block) -> Option<Cut> {
    let mut best = (f64::INFINITY, None);
    for (axis, bins) in bins.iter().enumerate() {
        let mut rights = [Bin::EMPTY; N];
        let mut right = Bin::EMPTY;
        for k in (1..N).rev() {
            right = right.merge(bins[k]);
            rights[k] = right;
        }
        let mut left = Bin::EMPTY;
        for plane in 1..N {
            left = left.merge(bins[plane - 1]);
            let right = rights[plane];
            let cost = left.cost(block) + right.cost(block);
            if left.count > 0 && right.count > 0 && cost < best.0 {
                let (left, right) = (left.bounds, right.bounds);
                best = (cost, Some(Cut { axis, plane, left, right }));
            }
        }
    }
    best.1
}

/// Puts those that are left in front; returns their number. Without a branch: what is left cannot
/// be foretold.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> usize {
    let mut left = 0;
    for k in 0..items.len() {
        let goes_left = is_left(&items[k]);
        items.swap(left, k);
        left += usize::from(goes_left);
    }
    left
}
