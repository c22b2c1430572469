//! The operations on lanes that every instruction set has for kernels.

use bytemuck::Pod;

use super::Kernel;

/// Methods that are one expression each, a line for each.
macro_rules! inlined {
    ($(fn $name:ident($this:ident $(, $argument:ident: $type:ty)*) -> $out:ty = $value:expr;)+) => {
        $(
            #[inline(always)]
            fn $name($this $(, $argument: $type)*) -> $out {
                $value
            }
        )+
    };
}

pub(super) use inlined;

/// The number of float32 lanes: the width of a node and of a leaf.
pub const LANES: usize = 16;
/// The number of float64 lanes.
pub const WIDE: usize = 8;

/// Aligned to a cache line, so that no access to a register's worth needs two.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct Aligned<T>(pub T);

/// Sixteen float32 numbers, or eight float64 ones, at once.
///
/// A value of the type proves that the machine has the instructions. Masks have lane 0 in bit 0.
/// The meaning of each operation is written down in `portable.rs`.
pub trait Lanes: Copy + Send + Sync {
    /// Whether kernels for many rays are compiled with these lanes. Without them each ray goes
    /// alone, and has the same answer.
    const HAS_PACKETS: bool = true;
    /// Sixteen float32.
    type Floats: Copy;
    /// Eight float64.
    type Doubles: Copy;

    /// Calls a kernel that several kernels share. It is not inlined, so that it is compiled once.
    fn call<K: Kernel>(self, kernel: K) -> K::Output;

    fn splat(self, x: f32) -> Self::Floats;
    fn load(self, from: &[f32; LANES]) -> Self::Floats;
    fn store(self, x: Self::Floats, to: &mut [f32; LANES]);
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn div(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// `b` where either is NaN.
    fn min(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// `b` where either is NaN.
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn abs(self, a: Self::Floats) -> Self::Floats;
    fn floor(self, a: Self::Floats) -> Self::Floats;
    fn ceil(self, a: Self::Floats) -> Self::Floats;
    /// `a * b + c`, fused or not.
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// `c - a * b`, fused or not.
    fn neg_mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// `a * b - c`, fused or not.
    fn mul_sub(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// Lane k is lane `places[k]` of `table`; a place is below [`LANES`].
    #[inline(always)]
    fn permute(self, table: Self::Floats, places: &[u8; LANES]) -> Self::Floats {
        self.permute_by(table, self.load_places(places))
    }
    /// Lane k is a lane of `table`: the one that the last four bits of lane k of `places` number.
    fn permute_by(self, table: Self::Floats, places: Self::Floats) -> Self::Floats;
    /// Places for [`Lanes::permute_by`].
    fn load_places(self, from: &[u8; LANES]) -> Self::Floats;
    /// The lanes with `a < b`; not those where either is NaN.
    fn lt(self, a: Self::Floats, b: Self::Floats) -> u16;
    /// The lanes with `a <= b`; not those where either is NaN.
    fn le(self, a: Self::Floats, b: Self::Floats) -> u16;
    /// The lanes with equal bits.
    fn same(self, a: Self::Floats, b: Self::Floats) -> u16;
    /// The lanes whose bits but for the last four are equal.
    fn same_sixteen(self, a: Self::Floats, b: Self::Floats) -> u16;
    /// `a` where the mask is set, else `b`.
    fn select(self, mask: u16, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// The largest lane; none is NaN.
    fn largest(self, a: Self::Floats) -> f32;
    /// The smallest lane; none is NaN.
    fn smallest(self, a: Self::Floats) -> f32;
    /// Finds the smallest number of each of sixteen rows; none is negative or NaN. Lane k has the
    /// bits of row k's smallest, with the last four replaced by 15 less its lane in the row.
    /// Numbers that differ only in those bits tie, and the highest lane wins.
    fn smallest_of_each(self, of: [&[f32; LANES]; LANES]) -> Self::Floats;
    /// Writes the lanes where the mask is set side by side to the front of `to`, and anything
    /// behind them.
    fn compress(self, mask: u16, a: Self::Floats, to: &mut [f32; LANES]);

    /// Eight float32 in float64.
    fn load_widened(self, from: &[f32; WIDE]) -> Self::Doubles;

    /// Eight float64, rounded to the nearest float32.
    fn store_narrowed(self, x: Self::Doubles, to: &mut [f32; WIDE]);

    /// Sixteen float64, rounded to the nearest float32.
    #[inline(always)]
    fn narrow(self, first: Self::Doubles, second: Self::Doubles) -> Self::Floats {
        let mut both = [[0.0; WIDE]; 2];
        self.store_narrowed(first, &mut both[0]);
        self.store_narrowed(second, &mut both[1]);
        self.load(bytemuck::cast_ref(&both))
    }

    /// Sixteen float32 in float64.
    #[inline(always)]
    fn widen(self, x: Self::Floats) -> [Self::Doubles; 2] {
        let mut both = [[0.0; WIDE]; 2];
        self.store(x, bytemuck::cast_mut(&mut both));
        [self.load_widened(&both[0]), self.load_widened(&both[1])]
    }

    fn splat64(self, x: f64) -> Self::Doubles;
    fn load64(self, from: &[f64; WIDE]) -> Self::Doubles;
    fn store64(self, x: Self::Doubles, to: &mut [f64; WIDE]);
    fn add64(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn sub64(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn mul64(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn div64(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn sqrt64(self, a: Self::Doubles) -> Self::Doubles;
    fn abs64(self, a: Self::Doubles) -> Self::Doubles;
    /// `b` where either is NaN.
    fn max64(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    /// `a * b - c`, rounded once.
    fn fused_mul_sub64(self, a: Self::Doubles, b: Self::Doubles, c: Self::Doubles)
    -> Self::Doubles;
    /// `a * b + c`, rounded once.
    fn fused_mul_add64(self, a: Self::Doubles, b: Self::Doubles, c: Self::Doubles)
    -> Self::Doubles;
    /// `c - a * b`, rounded once.
    fn fused_neg_mul_add64(
        self,
        a: Self::Doubles,
        b: Self::Doubles,
        c: Self::Doubles,
    ) -> Self::Doubles;
    /// The lanes with `a < b`; not those where either is NaN.
    fn lt64(self, a: Self::Doubles, b: Self::Doubles) -> u8;
    /// The lanes with `a <= b`; not those where either is NaN.
    fn le64(self, a: Self::Doubles, b: Self::Doubles) -> u8;

    /// `a` where the mask is set, else `b`.
    fn select64(self, mask: u8, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    /// The lanes of both in turns: `a` 0, `b` 0, `a` 1, `b` 1 and so on.
    fn interleave64(self, a: Self::Doubles, b: Self::Doubles) -> [Self::Doubles; 2];
    /// Eight rows of eight to eight columns.
    #[inline(always)]
    fn transpose64(self, mut rows: [Self::Doubles; WIDE]) -> [Self::Doubles; WIDE] {
        // A number's place is its row's three bits and its column's: each round turns them by one.
        for _ in 0..3 {
            let old = rows;
            for k in 0..WIDE / 2 {
                [rows[2 * k], rows[2 * k + 1]] = self.interleave64(old[k], old[k + WIDE / 2]);
            }
        }
        rows
    }

    /// Prefetches `what`, which is read soon.
    fn prefetch<T>(self, what: &T);
    /// Prefetches one of `whats`, or one of `others`, without a branch, which would be hard to
    /// predict. An index out of range does no harm.
    fn prefetch_either<T, U>(self, is_other: bool, index: u32, whats: &[T], others: &[U]);
    /// Copies numbers past the caches, to memory that is not read soon. Call [`Lanes::end_streams`]
    /// before another thread reads them.
    fn stream<T: Pod>(self, from: &[T], to: &mut [T]);
    /// Makes what was streamed visible to other threads.
    fn end_streams(self);
}
