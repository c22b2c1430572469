//! Lanes, instruction sets and shared memory: the only room with `unsafe` code.
//!
//! A kernel is written once, generic over [`Lanes`], in plain safe code. [`run`] compiles it for
//! every instruction set and calls the version that was asked for. `Portable` says in plain Rust
//! what each operation means; the others must do the same to the bit, wherever a result is not only
//! used to rule things out.
//!
//! All that a kernel calls must be `#[inline(always)]`: only what is inlined into the function with
//! the instruction set's features is compiled with them. A closure cannot be marked so, and may not
//! be inlined where it is called several times: around lanes there are macros and functions
//! instead. `.ci/inlined` looks for intrinsics that stand alone.

#![allow(unsafe_code, reason = "intrinsics; see each `SAFETY` line")]
#![allow(
    clippy::inline_always,
    reason = "what is not inlined is not compiled for the instruction set"
)]
#![allow(clippy::wildcard_imports, reason = "a room full of intrinsics")]

#[cfg(test)]
mod any_bits;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod block;
mod in_lanes;
mod lanes;
mod mask;
#[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
mod neon;
mod pages;
#[cfg_attr(
    all(target_arch = "wasm32", target_feature = "simd128"),
    allow(dead_code, reason = "what the lanes of such a module must do")
)]
mod portable;
#[cfg(any(
    target_arch = "x86_64",
    all(target_arch = "aarch64", target_feature = "neon", target_endian = "little")
))]
mod prefetch;
mod set;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128;
mod stack;
mod storage;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use block::{BLOCK_ALIGNMENT, Block};
pub use in_lanes::InLanes;
pub use lanes::{Aligned, LANES, Lanes, WIDE};
pub use mask::set_bits;
pub(crate) use pages::prefer_large_pages;
pub use set::InstructionSet;
pub use stack::with_stack;
pub use storage::Storage;

/// A computation with lanes.
pub trait Kernel {
    /// The result.
    type Output;
    /// Computes it; `#[inline(always)]` in every implementation.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Runs `kernel` with an instruction set, or with the next lower one that this machine has. 128 KiB
/// of the caller's stack are enough.
#[inline]
pub fn run<K>(set: InstructionSet, kernel: K) -> K::Output
where
    K: Kernel<Output: Send> + Send,
{
    with_stack(|| run_here(set, kernel))
}

/// Runs a kernel on the caller's stack, for one whose frame is small even where it is not
/// optimised.
#[inline]
pub fn run_here<K: Kernel>(set: InstructionSet, kernel: K) -> K::Output {
    match set {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx512 => avx512::run(kernel),
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => avx2::run(kernel),
        #[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
        InstructionSet::Neon => neon::run(kernel),
        // A module with these runs nowhere without them. A copy of all kernels in plain Rust would
        // double it, for the same bits.
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        _ => simd128::run(kernel),
        #[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
        _ => portable::run(kernel),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [f32; LANES] =
        [1.0, -2.0, 3.5, 0.0, -0.0, 8.0, -16.0, 0.25, 5.0, 6.0, -7.0, 9.0, 2.0, 2.5, -2.5, 100.0];
    const B: [f32; LANES] =
        [2.0, -2.0, 0.5, -0.0, 0.0, -8.0, 4.0, 0.5, 5.0, -1.0, 7.0, 3.0, 1.0, 4.0, -0.5, 10.0];
    const PLACES: [u8; LANES] = [3, 0, 15, 8, 7, 1, 1, 2, 14, 13, 12, 9, 4, 5, 6, 10];

    /// The results of every operation, as bits, one after the other. The numbers are small, so that
    /// fused and separate operations agree.
    struct Everything {
        a: [f32; LANES],
        b: [f32; LANES],
    }

    impl Kernel for Everything {
        type Output = Vec<u64>;

        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> Vec<u64> {
            let mut out = Vec::new();
            let (a, b) = (l.load(&self.a), l.load(&self.b));
            let mask = l.lt(a, b);
            let singles = [
                l.add(a, b),
                l.sub(a, b),
                l.mul(a, b),
                l.div(a, l.splat(3.0)),
                l.min(a, b),
                l.max(a, b),
                l.abs(a),
                l.floor(a),
                l.ceil(a),
                l.mul_add(a, b, l.splat(2.0)),
                l.neg_mul_add(a, b, l.splat(2.0)),
                l.mul_sub(a, b, l.splat(2.0)),
                l.permute(a, &PLACES),
                l.select(mask, a, b),
            ];
            for single in singles {
                let mut lanes = [0.0; LANES];
                l.store(single, &mut lanes);
                out.extend(lanes.map(|x| u64::from(x.to_bits())));
            }
            let mut front = [0.0; LANES];
            l.compress(mask, a, &mut front);
            let front = &front[..mask.count_ones() as usize];
            out.extend(front.iter().map(|x| u64::from(x.to_bits())));
            self.smallest(l, &mut out);
            self.by_bits(l, &mut out);
            out.extend([mask, l.le(a, b), l.same(a, b)].map(u64::from));
            out.extend([l.largest(a), l.smallest(a)].map(|x| u64::from(x.to_bits())));
            self.doubles(l, &mut out);
            out
        }
    }

    impl Everything {
        /// Tests the smallest of rows whose smallest stand in different lanes, differ in the lowest
        /// bits, or are all infinite.
        #[inline(always)]
        fn smallest<L: Lanes>(&self, l: L, out: &mut Vec<u64>) {
            let mut rows = [self.a.map(|x| x.abs() + 20.0); LANES];
            for (k, row) in rows.iter_mut().enumerate() {
                let more = [9, 10][k % 2];
                let smallest = f32::from_bits((1.0 + k as f32).to_bits() | 5);
                row[(7 * k + 3) % LANES] = smallest;
                // As small for a key, or a little more than that.
                row[(3 * k + 1) % LANES] = f32::from_bits(smallest.to_bits() + more);
            }
            rows[6] = [f32::INFINITY; LANES];
            let mut keys = [0.0; LANES];
            l.store(l.smallest_of_each(rows.each_ref()), &mut keys);
            for (key, row) in keys.iter().zip(&rows) {
                let (lane, smallest) =
                    (LANES - 1 - key.to_bits() as usize % LANES, key.to_bits() & !15);
                assert_eq!(row[lane].to_bits() & !15, smallest);
                assert!(row.iter().all(|x| x.to_bits() & !15 >= smallest));
                assert!(row[lane + 1..].iter().all(|x| x.to_bits() & !15 > smallest));
            }
            out.extend(keys.map(|x| u64::from(x.to_bits())));
        }

        /// Numbers whose last bits are places, and others that differ from them in the last four
        /// bits or above.
        #[inline(always)]
        fn by_bits<L: Lanes>(&self, l: L, out: &mut Vec<u64>) {
            let slots = PLACES.map(|place| f32::from_bits(0x8765_4320 | u32::from(place)));
            let others: [f32; LANES] = std::array::from_fn(|k| match k % 3 {
                0 => f32::from_bits(slots[k].to_bits() ^ 9),
                1 => f32::from_bits(slots[k].to_bits() ^ 16),
                _ => f32::from_bits(slots[k].to_bits() ^ 0x8000_0000),
            });
            let a = l.load(&self.a);
            for places in [l.load_places(&PLACES), l.load(&slots)] {
                let mut lanes = [0.0; LANES];
                l.store(l.permute_by(a, places), &mut lanes);
                out.extend(lanes.map(|x| u64::from(x.to_bits())));
            }
            let same = l.same_sixteen(l.load(&slots), l.load(&others));
            assert_eq!(same, 0b1001_0010_0100_1001);
            out.push(u64::from(same));
        }

        #[inline(always)]
        fn doubles<L: Lanes>(&self, l: L, out: &mut Vec<u64>) {
            let half = |x: &[f32; LANES]| l.load_widened(&x.as_chunks().0[0]);
            let (a, b) = (half(&self.a), half(&self.b));
            let mask = l.lt64(a, b);
            let [low, high] = l.interleave64(a, b);
            let doubles = [
                l.add64(a, b),
                l.sub64(a, b),
                l.mul64(a, b),
                l.div64(a, l.splat64(3.0)),
                l.sqrt64(l.abs64(a)),
                l.max64(a, b),
                // The product needs more digits than there are.
                l.fused_mul_sub64(l.splat64(1.1), l.splat64(1.3), l.splat64(1.1 * 1.3)),
                l.fused_mul_add64(l.splat64(1.1), l.splat64(-1.3), l.splat64(1.1 * 1.3)),
                l.fused_neg_mul_add64(l.splat64(1.1), l.splat64(1.3), l.splat64(1.1 * 1.3)),
                l.fused_mul_add64(a, b, l.splat64(0.1)),
                l.fused_neg_mul_add64(a, b, l.splat64(0.1)),
                l.select64(mask, a, b),
                low,
                high,
            ];
            for double in doubles {
                let mut lanes = [0.0; WIDE];
                l.store64(double, &mut lanes);
                out.extend(lanes.map(f64::to_bits));
            }
            let mut narrow = [0.0; WIDE];
            l.store_narrowed(l.div64(a, l.splat64(3.0)), &mut narrow);
            out.extend(narrow.map(|x| u64::from(x.to_bits())));
            let mut both = [0.0; LANES];
            l.store(l.narrow(l.div64(a, l.splat64(3.0)), b), &mut both);
            out.extend(both.map(|x| u64::from(x.to_bits())));
            let columns = l.transpose64([a, b, low, high, a, b, high, low]);
            for double in columns.into_iter().chain(l.widen(l.load(&self.b))) {
                let mut lanes = [0.0; WIDE];
                l.store64(double, &mut lanes);
                out.extend(lanes.map(f64::to_bits));
            }
            out.extend([mask, l.le64(a, b)].map(u64::from));
        }
    }

    #[test]
    fn all_instruction_sets_do_what_plain_rust_does() {
        let nan = |k: usize, x: f32| if k % 5 == 2 { f32::NAN } else { x };
        let with_nan = std::array::from_fn(|k| nan(k, A[k]));
        for (a, b) in [(A, B), (B, A)] {
            let plain = run(InstructionSet::Portable, Everything { a, b });
            for set in InstructionSet::available() {
                assert_eq!(run(set, Everything { a, b }), plain, "{set:?}");
            }
        }
        // Of NaN only what comparisons, minima and maxima make of it is promised.
        let plain = run(InstructionSet::Portable, Comparisons(with_nan));
        for set in InstructionSet::available() {
            assert_eq!(run(set, Comparisons(with_nan)), plain, "{set:?}");
        }
    }

    /// Masks of numbers some of which are NaN.
    struct Comparisons([f32; LANES]);

    impl Kernel for Comparisons {
        type Output = [u16; 6];

        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> [u16; 6] {
            let (a, b) = (l.load(&self.0), l.load(&B));
            [
                l.lt(a, b),
                l.le(a, b),
                l.same(l.min(a, b), b),
                l.same(l.max(a, b), b),
                l.lt(l.min(b, a), b),
                l.le(b, l.max(b, a)),
            ]
        }
    }

    /// The copies have all alignments and lengths.
    #[test]
    fn streams_copy() {
        struct Copy<'a>(&'a [i32], &'a mut [i32]);
        impl Kernel for Copy<'_> {
            type Output = ();

            #[inline(always)]
            fn run<L: Lanes>(self, l: L) {
                l.stream(self.0, self.1);
                l.end_streams();
            }
        }
        let from: Vec<i32> = (0..200).collect();
        for set in InstructionSet::available() {
            for start in 0..20 {
                for length in [0, 1, 15, 16, 17, 40, 100] {
                    let mut to = vec![-1; 200];
                    run(set, Copy(&from[..length], &mut to[start..start + length]));
                    assert_eq!(to[start..start + length], from[..length], "{set:?}");
                    assert!(to[..start].iter().all(|&x| x == -1));
                    assert!(to[start + length..].iter().all(|&x| x == -1));
                }
            }
        }
    }
}
