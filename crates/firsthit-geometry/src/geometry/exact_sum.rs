//! Sums of products of float64 numbers without any rounding, whatever their magnitudes.
//!
//! A float64 is an integer of 53 bits times a power of two, and a product of three is one of 159
//! bits. Each product is added to a fixed-point number whose lowest bit is that of the smallest
//! product and whose highest bit is beyond any sum: Kulisch and Miranker, "The Arithmetic of the
//! Digital Computer: A New Approach", SIAM Review 28(1), 1986. Positive and negative products are
//! kept apart, so that a sign that changes does not ripple through all words.

use std::cmp::Ordering;

/// The lowest bit is 2 to the power of minus this.
const LOWEST: i32 = 3 * 1074;

/// Products reach from 2^-3222 up to 2^3072. The bits that are left hold the carries of 2^106 of
/// them.
const WORDS: usize = 100;

/// A sum of products without rounding.
#[derive(Debug, Clone)]
#[doc(hidden)]
pub struct ExactSum {
    positive: [u64; WORDS],
    negative: [u64; WORDS],
}

impl ExactSum {
    /// Zero.
    pub const ZERO: Self = Self { positive: [0; WORDS], negative: [0; WORDS] };

    /// Adds the product of three finite numbers.
    pub fn add(&mut self, factors: [f64; 3]) {
        let [(x, x_exponent), (y, y_exponent), (z, z_exponent)] = factors.map(parts);
        if x == 0 || y == 0 || z == 0 {
            return;
        }
        let xy = u128::from(x) * u128::from(y);
        let low = (xy & u128::from(u64::MAX)) * u128::from(z);
        let high = (xy >> 64) * u128::from(z) + (low >> 64);
        let digits = [word(low), word(high), word(high >> 64), 0];
        let is_negative = factors.iter().filter(|x| x.is_sign_negative()).count() % 2 == 1;
        let words = if is_negative { &mut self.negative } else { &mut self.positive };
        let exponent = x_exponent + y_exponent + z_exponent + LOWEST;
        add(words, digits, usize::try_from(exponent).unwrap_or(0));
    }

    /// Adds the product of two finite numbers.
    pub fn add_two(&mut self, x: f64, y: f64) {
        self.add([x, y, 1.0]);
    }

    /// Whether the sum is less than, equal to or greater than zero.
    pub fn sign(&self) -> Ordering {
        let from_the_top = self.positive.iter().rev();
        from_the_top.cmp(self.negative.iter().rev())
    }
}

/// The integer and the exponent that a finite number's magnitude is made of.
fn parts(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    match i32::try_from(bits >> 52 & 0x7ff).unwrap_or(0) {
        0 => (fraction, -1074),
        exponent => (fraction | 1 << 52, exponent - 1075),
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the low bits are meant")]
fn word(bits: u128) -> u64 {
    bits as u64
}

/// Adds `digits`, the lowest first, times two to the power of `shift`.
fn add(words: &mut [u64; WORDS], digits: [u64; 4], shift: usize) {
    let (first, bits) = (shift / 64, shift % 64);
    let (mut below, mut carry) = (0, false);
    for (k, digit) in digits.into_iter().enumerate() {
        // In two steps: a shift by 64 bits is none.
        let shifted = digit << bits | below >> 1 >> (63 - bits);
        below = digit;
        let (sum, over) = words[first + k].overflowing_add(shifted);
        let (sum, over_again) = sum.overflowing_add(u64::from(carry));
        words[first + k] = sum;
        carry = over || over_again;
    }
    for word in &mut words[first + digits.len()..] {
        if !carry {
            return;
        }
        (*word, carry) = word.overflowing_add(1);
    }
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::Signed;

    use super::*;

    fn exact(x: f64) -> BigRational {
        BigRational::from_float(x).unwrap()
    }

    #[test]
    fn signs_are_those_of_rational_arithmetic_at_every_magnitude() {
        let mut state = 7_u64;
        let mut number = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let x = f64::from_bits(state ^ state >> 31);
            if x.is_finite() { x } else { 1.0 }
        };
        for _ in 0..3000 {
            let mut sum = ExactSum::ZERO;
            let mut judge = exact(0.0);
            let products: Vec<[f64; 3]> = (0..4).map(|_| [(); 3].map(|()| number())).collect();
            for &[x, y, z] in &products {
                sum.add([x, y, z]);
                judge += exact(x) * exact(y) * exact(z);
            }
            assert_eq!(sum.sign(), judge.cmp(&exact(0.0)), "{products:?}");
            // Nothing is left when all is taken away again, and then a trifle decides.
            for &[x, y, z] in &products {
                sum.add([-x, y, z]);
            }
            assert_eq!(sum.sign(), Ordering::Equal);
            let trifle = f64::from_bits(1).copysign(number());
            sum.add([trifle; 3]);
            assert_eq!(sum.sign() == Ordering::Less, exact(trifle).is_negative());
        }
    }

    #[test]
    fn carries_ripple() {
        let mut sum = ExactSum::ZERO;
        for k in 0..100_000 {
            sum.add([f64::MAX, f64::MAX, f64::MAX]);
            sum.add_two(-f64::from(k), f64::MIN_POSITIVE);
        }
        for _ in 0..100_000 {
            sum.add([-f64::MAX, f64::MAX, f64::MAX]);
        }
        assert_eq!(sum.sign(), Ordering::Less);
        sum.add_two(4_999_950_000.0, f64::MIN_POSITIVE);
        assert_eq!(sum.sign(), Ordering::Equal);
    }
}
