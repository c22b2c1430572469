//! Tests that all instruction sets agree, whatever the bits of the numbers.
#![expect(
    clippy::cast_possible_truncation,
    reason = "numbers at random, of which any part will do"
)]

use super::*;

/// The results for two rows of float32 and two of float64.
struct Results<'a> {
    singles: [&'a [f32; LANES]; 2],
    doubles: [&'a [f64; WIDE]; 2],
    mask: u16,
    places: &'a [u8; LANES],
}

/// The bits of a number; of a NaN the sign and the other bits may be any, so all NaNs are one.
fn bits(x: f32) -> u64 {
    u64::from(if x.is_nan() { f32::NAN } else { x }.to_bits())
}

fn bits64(x: f64) -> u64 {
    if x.is_nan() { f64::NAN } else { x }.to_bits()
}

impl Kernel for Results<'_> {
    type Output = Vec<u64>;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Vec<u64> {
        let mut out = Vec::new();
        let [a, b] = self.singles.map(|x| l.load(x));
        let singles = [
            l.add(a, b),
            l.sub(a, b),
            l.mul(a, b),
            l.div(a, b),
            l.min(a, b),
            l.max(a, b),
            l.abs(a),
            l.floor(a),
            l.ceil(a),
            l.permute(a, self.places),
            l.permute_by(a, b),
            l.select(self.mask, a, b),
        ];
        for single in singles {
            let mut lanes = [0.0; LANES];
            l.store(single, &mut lanes);
            out.extend(lanes.map(bits));
        }
        let mut front = [0.0; LANES];
        l.compress(self.mask, a, &mut front);
        let front = &front[..self.mask.count_ones() as usize];
        out.extend(front.iter().copied().map(bits));
        let masks =
            [l.lt(a, b), l.le(a, b), l.le(a, a), l.same(a, b), l.same(a, a), l.same_sixteen(a, b)];
        out.extend(masks.map(u64::from));
        self.doubles(l, &mut out);
        out
    }
}

impl Results<'_> {
    #[inline(always)]
    fn doubles<L: Lanes>(&self, l: L, out: &mut Vec<u64>) {
        let [a, b] = self.doubles.map(|x| l.load64(x));
        let c = l.load_widened(&self.singles[0].as_chunks().0[1]);
        let [low, high] = l.interleave64(a, b);
        let [mask, _] = self.mask.to_le_bytes();
        let doubles = [
            l.add64(a, b),
            l.sub64(a, b),
            l.mul64(a, b),
            l.div64(a, b),
            l.sqrt64(a),
            l.abs64(a),
            l.max64(a, b),
            l.fused_mul_add64(a, b, c),
            l.fused_mul_sub64(a, b, c),
            l.fused_neg_mul_add64(a, b, c),
            // The part that rounding took from the product, or the sum of both.
            l.fused_mul_sub64(a, b, l.mul64(a, b)),
            l.fused_neg_mul_add64(a, b, b),
            l.select64(mask, a, b),
            low,
            high,
            c,
        ];
        for double in doubles {
            let mut lanes = [0.0; WIDE];
            l.store64(double, &mut lanes);
            out.extend(lanes.map(bits64));
        }
        let mut narrow = [0.0; WIDE];
        l.store_narrowed(a, &mut narrow);
        out.extend(narrow.map(bits));
        out.extend([l.lt64(a, b), l.le64(a, b), l.le64(a, a)].map(u64::from));
    }
}

/// Marsaglia's xorshift, "Xorshift RNGs", Journal of Statistical Software 8(14), 2003.
struct Xorshift(u64);

impl Xorshift {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Any bits, a special number, or one of few digits and a usual size.
    fn double(&mut self) -> f64 {
        let bits = self.next();
        match self.next() >> 62 {
            0 => f64::from_bits(bits),
            1 => {
                const SPECIAL: [f64; 8] =
                    [0.0, 1.0, f64::INFINITY, f64::NAN, f64::MIN_POSITIVE, f64::MAX, 5e-324, 0.5];
                let sign = if bits & 8 == 0 { 1.0 } else { -1.0 };
                sign * SPECIAL[bits as usize % 8]
            }
            2 => (bits % 64) as f64 / 4.0 - 8.0,
            _ => 1.0 + (bits >> 12) as f64 / 3.0,
        }
    }

    /// A float32 as above; some differ from each other in the last bits alone.
    fn single(&mut self) -> f32 {
        let bits = (self.next() >> 32) as u32;
        match self.next() >> 62 {
            0 => f32::from_bits(bits),
            1 => f32::from_bits(1.5_f32.to_bits() ^ bits >> 27),
            _ => self.double() as f32,
        }
    }
}

#[test]
fn any_bits_give_the_same_on_all_instruction_sets() {
    let mut numbers = Xorshift(1);
    for round in 0..2000 {
        let singles = [(); 2].map(|()| std::array::from_fn(|_| numbers.single()));
        let doubles = [(); 2].map(|()| std::array::from_fn(|_| numbers.double()));
        let places = std::array::from_fn(|_| (numbers.next() >> 60) as u8);
        let mask = (numbers.next() >> 48) as u16;
        let results = |set| {
            let results = Results {
                singles: singles.each_ref(),
                doubles: doubles.each_ref(),
                mask,
                places: &places,
            };
            run(set, results)
        };
        let plain = results(InstructionSet::Portable);
        for set in InstructionSet::available() {
            assert_eq!(results(set), plain, "{set:?}, round {round}: {singles:?} {doubles:?}");
        }
    }
}

/// The largest and the smallest lane.
struct Extremes<'a>(&'a [f32; LANES]);

impl Kernel for Extremes<'_> {
    type Output = [f32; 2];

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> [f32; 2] {
        let x = l.load(self.0);
        [l.largest(x), l.smallest(x)]
    }
}

#[test]
fn extremes_are_found_in_every_lane() {
    for set in InstructionSet::available() {
        for lane in 0..LANES {
            let mut x = [-1.0; LANES];
            x[lane] = f32::INFINITY;
            x[(lane + 5) % LANES] = -1.5;
            let found = run(set, Extremes(&x));
            assert_eq!(found, [f32::INFINITY, -1.5], "{set:?}, lane {lane}");
        }
    }
}
