//! Determinants of three vectors, whose signs are exact; sums and products without rounding.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it has the kernel's fused multiply-add"
)]

use std::cmp::Ordering;

use super::arithmetic::Scalar;
use super::arrays;
use super::double::{Double, DoubleVector, product, sum};

/// A vector brought to a length around 1.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Scaled {
    pub vector: DoubleVector<f64>,
    /// The divisor, a power of two.
    pub unit: f64,
}

impl Scaled {
    #[inline(always)]
    pub fn new(vector: &DoubleVector<f64>) -> Self {
        let longer = |largest: f64, part: &Double<f64>| largest.max(part.high.abs());
        let largest = vector.iter().fold(f64::MIN_POSITIVE, longer);
        let unit = f64::from_bits(largest.to_bits() & (0x7ff << 52));
        let vector =
            arrays::map(*vector, |part| Double { high: part.high / unit, low: part.low / unit });
        Self { vector, unit }
    }
}

/// Two to the power of `exponent`.
#[expect(clippy::cast_sign_loss, reason = "small exponents")]
#[doc(hidden)]
pub const fn power(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The number of a determinant's terms: six products of three numbers in two parts, each product in
/// four.
const TERMS: usize = 6 * 8 * 4;

/// The determinant of three vectors times 2^900, in twice the digits. Its sign is exact, and it is
/// zero only where it is zero.
#[inline(always)]
#[doc(hidden)]
pub fn determinant(p: &Scaled, q: &Scaled, r: &Scaled) -> Double<f64> {
    let mut terms = [0.0; TERMS];
    // Products of three numbers around 2^300 have rests that float64 can hold.
    let count = fill_with_terms(&mut terms, [p, q, r], power(300));
    total(&mut terms[..count])
}

/// Fills `terms` with numbers whose sum is the determinant of three vectors, each times `scale`,
/// without rounding. Returns how many there are.
#[inline(always)]
fn fill_with_terms(terms: &mut [f64; TERMS], [p, q, r]: [&Scaled; 3], scale: f64) -> usize {
    const ORDERS: [([usize; 3], f64); 6] = [
        ([0, 1, 2], 1.0),
        ([1, 2, 0], 1.0),
        ([2, 0, 1], 1.0),
        ([2, 1, 0], -1.0),
        ([1, 0, 2], -1.0),
        ([0, 2, 1], -1.0),
    ];
    let mut count = 0;
    // Most vectors have no second parts, and most products no rest.
    let mut put = |x: f64| {
        terms[count % TERMS] = x;
        count += usize::from(x != 0.0);
    };
    for ([k, l, m], sign) in ORDERS {
        let parts =
            |v: &Scaled, axis: usize| [v.vector[axis].high * scale, v.vector[axis].low * scale];
        for x in parts(p, k) {
            for y in parts(q, l) {
                if x == 0.0 || y == 0.0 {
                    continue;
                }
                let two = product(Scalar, sign * x, y);
                for z in parts(r, m) {
                    for xy in [two.high, two.low] {
                        let three = product(Scalar, xy, z);
                        put(three.high);
                        put(three.low);
                    }
                }
            }
        }
    }
    count.min(TERMS)
}

/// The sum of numbers in twice the digits. Its sign is exact, and it is zero only where the sum is
/// zero.
///
/// Adding them up makes of them, without rounding, the sum and what each addition lost, which are
/// far smaller numbers with the same total; and so on until these cannot matter any more: Ogita,
/// Rump and Oishi, "Accurate sum and dot product", SIAM Journal on Scientific Computing 26(6),
/// 2005.
#[inline(always)]
fn total(terms: &mut [f64]) -> Double<f64> {
    let Some(last) = terms.len().checked_sub(1) else {
        return Double { high: 0.0, low: 0.0 };
    };
    // A few times; of a sum that is zero until all are zero.
    loop {
        for k in 1..terms.len() {
            let two = sum(Scalar, terms[k], terms[k - 1]);
            (terms[k], terms[k - 1]) = (two.high, two.low);
        }
        let (lost, total) = (&terms[..last], terms[last]);
        let most: f64 = lost.iter().map(|x| x.abs()).sum();
        let is_enough = most <= total.abs() * ENOUGH;
        if is_enough || most.is_nan() {
            return sum(Scalar, total, lost.iter().sum());
        }
    }
}

/// A number without rounding, as a sum of numbers.
#[derive(Debug)]
#[doc(hidden)]
pub struct Expansion(Vec<f64>);

impl Expansion {
    /// The sum of `terms`.
    pub fn of(mut terms: Vec<f64>) -> Self {
        // Far fewer, with the same sum.
        total(&mut terms);
        terms.retain(|&x| x != 0.0);
        Self(terms)
    }

    /// The sum of two.
    pub fn plus(&self, other: &Self) -> Self {
        Self::of(self.0.iter().chain(&other.0).copied().collect())
    }

    /// The difference of two.
    pub fn minus(&self, other: &Self) -> Self {
        let minus = other.0.iter().map(|x| -x);
        Self::of(self.0.iter().copied().chain(minus).collect())
    }

    /// The product of two, where no part of it is too small for float64.
    pub fn product(&self, other: &Self) -> Self {
        let mut terms = Vec::with_capacity(2 * self.0.len() * other.0.len());
        for &x in &self.0 {
            for &y in &other.0 {
                let two = product(Scalar, x, y);
                terms.extend([two.high, two.low]);
            }
        }
        Self::of(terms)
    }

    /// The determinant of three vectors.
    pub fn determinant(p: &Scaled, q: &Scaled, r: &Scaled) -> Self {
        let mut terms = [0.0; TERMS];
        // So that products of two determinants stay in float64's range, with their rests.
        let count = fill_with_terms(&mut terms, [p, q, r], power(100));
        Self::of(terms[..count].to_vec())
    }

    /// The expansion times a power of two.
    pub fn times(mut self, power: f64) -> Self {
        for term in &mut self.0 {
            *term *= power;
        }
        self
    }

    /// Whether `self / denominator` is less than, equal to or greater than another such quotient.
    pub fn compare_quotients(
        [numerator, denominator]: [&Self; 2],
        [other, by]: [&Self; 2],
    ) -> Ordering {
        let mut terms = Vec::new();
        for (x, y, sign) in [(numerator, by, 1.0), (other, denominator, -1.0)] {
            for &x in &x.0 {
                for &y in &y.0 {
                    let two = product(Scalar, sign * x, y);
                    terms.extend([two.high, two.low]);
                }
            }
        }
        let difference = total(&mut terms).high;
        let signed = denominator.sign() * by.sign() * difference;
        signed.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
    }

    /// The nearest float64, or next to it, with the exact sign.
    pub fn value(&self) -> f64 {
        total(&mut self.0.clone()).high
    }

    /// -1, 0 or 1.
    pub fn sign(&self) -> f64 {
        let value = self.value();
        if value == 0.0 { 0.0 } else { value.signum() }
    }
}

/// Two to the power of -40.
const ENOUGH: f64 = power(-40);

#[cfg(test)]
mod tests {
    use super::super::double::difference;
    use super::*;

    fn plain([x, y, z]: [f64; 3]) -> Scaled {
        Scaled::new(&[x, y, z].map(|high| Double { high, low: 0.0 }))
    }

    #[test]
    fn the_sign_is_that_of_a_tiny_rest() {
        let e = f64::EPSILON;
        let p = plain([1.0, 1.0 + e, 0.0]);
        let q = plain([1.0 - e, 1.0, 0.0]);
        let r = plain([0.0, 0.0, 1e-300]);
        let det = |p: &Scaled, q: &Scaled, r: &Scaled| determinant(p, q, r).high;
        // 1 - (1 - e^2).
        assert!(det(&p, &q, &r) > 0.0 && det(&q, &p, &r) < 0.0);
        assert_eq!(det(&p, &p, &r), 0.0);
        assert_eq!(det(&p, &q, &plain([0.0; 3])), 0.0);
        // Of second parts alone.
        let thin = [difference(Scalar, 1.0, 1e-40); 3];
        let line = plain([1.0; 3]);
        assert_eq!(det(&Scaled::new(&thin), &line, &q), 0.0);
        let bent = [thin[0], thin[1], difference(Scalar, 1.0, 2e-40)];
        assert!(det(&Scaled::new(&bent), &line, &q) != 0.0);
    }
}
