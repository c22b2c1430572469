//! `a * b + c` rounded once, where no instruction does that.
//!
//! Without such an instruction `f64::mul_add` is a long computation in integers. Here it is one in
//! float64: Boldo and Melquiond, "Emulation of a FMA and correctly rounded sums: proved algorithms
//! using rounding to odd", IEEE Transactions on Computers 57(4), 2008, figure 2:
//!
//! 1. The product as the sum of two numbers (Dekker 1971; see `product`).
//! 2. The sum of `c` and the product, as three numbers (Knuth's exact sum, twice).
//! 3. The two small ones of the three are added, and rounded *to odd*: where that is not exact, to
//!    the neighbour whose last bit is set. Such a number is never halfway between two of fewer
//!    digits, so that the last sum is rounded as the exact one is.
//!
//! It holds while no part of the product is too small for float64 and none overflows; `emulated`
//! checks that.

#[cfg(any(test, target_arch = "wasm32"))]
use super::arithmetic::{Arithmetic, Scalar};
#[cfg(any(test, target_arch = "wasm32"))]
use super::double::{Double, sum};

/// `a * b + c`, rounded once.
#[cfg(not(target_arch = "wasm32"))]
#[expect(clippy::inline_always, reason = "inlined into a kernel, it is the kernel's instruction")]
#[inline(always)]
#[doc(hidden)]
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    a.mul_add(b, c)
}

/// `a * b + c`, rounded once. WebAssembly has no instruction for it.
#[cfg(target_arch = "wasm32")]
#[inline(never)]
#[doc(hidden)]
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    emulated(Scalar, a, b, c).unwrap_or_else(|| a.mul_add(b, c))
}

/// The operations that the emulation needs besides arithmetic.
#[cfg(any(test, target_arch = "wasm32"))]
#[doc(hidden)]
pub trait RoundToOdd: Arithmetic {
    /// `x` without its sign.
    fn abs(self, x: Self::Number) -> Self::Number;
    /// The sum of two numbers rounded to odd. `rounded` is the sum rounded to nearest, and `rest`
    /// the sum less that.
    fn to_odd(self, rounded: Self::Number, rest: Self::Number) -> Self::Number;
}

#[cfg(any(test, target_arch = "wasm32"))]
impl RoundToOdd for Scalar {
    #[inline]
    fn abs(self, x: f64) -> f64 {
        x.abs()
    }
    #[inline]
    fn to_odd(self, rounded: f64, rest: f64) -> f64 {
        let bits = rounded.to_bits();
        if rest == 0.0 || bits & 1 == 1 {
            return rounded;
        }
        // The other neighbour of the exact sum: away from zero where the rest has the sum's sign.
        let is_outwards = rest.is_sign_negative() == rounded.is_sign_negative();
        f64::from_bits(if is_outwards { bits + 1 } else { bits - 1 })
    }
}

/// Larger operands are left to others: their products and halves may overflow.
#[cfg(any(test, target_arch = "wasm32"))]
const MOST: f64 = f64::from_bits((1023 + 500) << 52);

/// The last digit of a larger product is 106 places lower, above the last place of float64.
#[cfg(any(test, target_arch = "wasm32"))]
const LEAST: f64 = f64::from_bits((1023 - 900) << 52);

/// `a * b + c`, rounded once, in every lane; `None` where some lane's numbers are too large or too
/// small for that.
#[cfg(any(test, target_arch = "wasm32"))]
#[inline]
#[doc(hidden)]
pub fn emulated<A: RoundToOdd>(
    of: A,
    a: A::Number,
    b: A::Number,
    c: A::Number,
) -> Option<A::Number> {
    let product = product(of, a, b);
    let zero = of.number(0.0);
    let [of_a, of_b, of_c] = [of.abs(a), of.abs(b), of.abs(c)];
    // A product with zero is exact. Where something is NaN, so is the result, whatever is found
    // here.
    let is_nonzero = of.lt(zero, of_a) & of.lt(zero, of_b);
    let size = of.select(is_nonzero, of.abs(product.high), of.number(1.0));
    let largest = of.max(of.max(of_a, of_b), of_c);
    let is_safe = of.lt(of.number(LEAST), size) & of.lt(largest, of.number(MOST));
    if !of.is_everywhere(is_safe) {
        return None;
    }
    let small = sum(of, c, product.low);
    let large = sum(of, product.high, small.high);
    let rest = sum(of, small.low, large.low);
    let rest = of.to_odd(rest.high, rest.low);
    let fused = of.add(large.high, rest);
    // Zeros come with the signs that they have in a product and a sum.
    let plain = of.add(product.high, c);
    Some(of.select(of.lt(zero, of.abs(fused)), fused, plain))
}

/// `a * b`, exactly, from the products of halves of 26 digits: Dekker, "A Floating-Point Technique
/// for Extending the Available Precision", Numerische Mathematik 18, 1971.
#[cfg(any(test, target_arch = "wasm32"))]
#[inline]
fn product<A: Arithmetic>(of: A, a: A::Number, b: A::Number) -> Double<A::Number> {
    let high = of.mul(a, b);
    let ([a_high, a_low], [b_high, b_low]) = (halves(of, a), halves(of, b));
    let rest = of.sub(of.mul(a_high, b_high), high);
    let rest = of.add(rest, of.mul(a_high, b_low));
    let rest = of.add(rest, of.mul(a_low, b_high));
    let low = of.add(rest, of.mul(a_low, b_low));
    Double { high, low }
}

/// Two numbers of 26 digits and their signs whose sum is `x` (Veltkamp).
#[cfg(any(test, target_arch = "wasm32"))]
#[inline]
fn halves<A: Arithmetic>(of: A, x: A::Number) -> [A::Number; 2] {
    /// 2^27 + 1.
    const SPLITTER: f64 = 134_217_729.0;
    let scaled = of.mul(x, of.number(SPLITTER));
    let high = of.sub(scaled, of.sub(scaled, x));
    [high, of.sub(x, high)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn power_of_two(exponent: i32) -> f64 {
        f64::from_bits(u64::try_from(1023 + exponent).unwrap() << 52)
    }

    /// The emulation is what the platform says; says whether it was within its range.
    fn check(a: f64, b: f64, c: f64) -> bool {
        let expected = a.mul_add(b, c);
        let Some(found) = emulated(Scalar, a, b, c) else {
            return false;
        };
        let is_same = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
        assert!(is_same, "{a:e} * {b:e} + {c:e} = {expected:e}, not {found:e}");
        true
    }

    /// Sums that are hard to round: of the product and a number that nearly cancels it, lies as far
    /// from it as float64 has digits, or leaves half a unit.
    fn check_around(a: f64, b: f64, near: i64) -> usize {
        let product = a * b;
        let rest = a.mul_add(b, -product);
        let beside = |x: f64| f64::from_bits(x.to_bits().wrapping_add_signed(near));
        let mut sums = vec![0.0, beside(0.0), beside(1.0), f64::MIN_POSITIVE, beside(5e-324)];
        for of in [product, rest, a, b] {
            for power in
                [-108, -107, -106, -55, -54, -53, -52, -2, -1, 0, 1, 2, 51, 52, 53, 54, 55, 106]
            {
                sums.push(beside(of * power_of_two(power)));
            }
        }
        let both = sums.iter().flat_map(|&c| [c, -c]);
        both.filter(|&c| check(a, b, c)).count()
    }

    #[test]
    fn hard_sums_are_rounded_as_the_platform_rounds_them() {
        let digits = |k: u64| k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 12;
        let mut checked = 0;
        for k in 0..4000_u64 {
            // Few digits, so that there are ties, and many.
            let number = |k: u64| {
                let kept = !0 << (k % 53);
                let exponent = 1023 - 30 + k * 7 % 61;
                f64::from_bits(exponent << 52 | digits(k) & kept)
            };
            let (a, b) = (number(k), -number(3 * k + 1));
            let near = [0, 0, 1, -1, 2, 3][usize::try_from(k % 6).unwrap()];
            checked += check_around(a, b, near);
        }
        assert!(checked > 500_000, "{checked}");
    }

    #[test]
    fn numbers_at_the_ends_are_right_or_left_to_others() {
        let sizes = [
            0.0,
            5e-324,
            1e-320,
            f64::MIN_POSITIVE,
            LEAST,
            1e-160,
            1e-140,
            1e-10,
            1.0,
            3.0,
            1e140,
            MOST,
        ];
        let ends =
            [1e160, f64::MAX, f64::INFINITY, f64::NAN, 0.5 * MOST, 1.0 - f64::EPSILON, 2.0 * LEAST];
        let numbers = sizes.into_iter().chain(ends).flat_map(|x| [x, -x]);
        let numbers: Vec<f64> = numbers.collect();
        let mut inside = 0;
        for &a in &numbers {
            for &b in &numbers {
                for &c in &numbers {
                    inside += usize::from(check(a, b, c));
                }
                check_around(a, b, 1);
            }
        }
        assert!(inside > 10_000, "{inside}");
        assert_eq!(emulated(Scalar, 1e-170, 1e-170, 1.0), None);
        assert_eq!(emulated(Scalar, 1.0, 1.0, f64::INFINITY), None);
        assert_eq!(emulated(Scalar, 1e200, 1e200, 1.0), None);
    }

    proptest! {
        #[test]
        fn any_numbers_are_right_or_left_to_others(a: u64, b: u64, c: u64) {
            let [a, b, c] = [a, b, c].map(f64::from_bits);
            check(a, b, c);
        }

        #[test]
        fn any_product_and_what_is_near_it_is_right(
            (a, b) in (-60..60, 0..1_u64 << 52, -60..60, 0..1_u64 << 52).prop_map(|(p, a, q, b)| {
                let number = |power: i32, digits| power_of_two(power) * f64::from_bits(1023 << 52 | digits);
                (number(p, a), number(q, b))
            }),
            near in -3..=3_i64,
        ) {
            prop_assert!(check_around(a, b, near) > 100);
        }

        #[test]
        fn the_halves_are_the_number(x in -1e150..1e150) {
            let [high, low] = halves(Scalar, x);
            prop_assert_eq!(high + low, x);
            prop_assert_eq!(high.to_bits() << 38, 0);
        }
    }
}
