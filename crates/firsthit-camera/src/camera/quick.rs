//! Arithmetic for many rays of a lens, written once for a single number and for lanes of them.
//!
//! No fused multiply-add: where the processor has none it would take longer than all the rest.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it is compiled for the kernel's instruction set"
)]

use crate::geometry::arithmetic::Arithmetic;

/// Two numbers of a ray, or of several.
pub(super) type Pair<A> = [<A as Arithmetic>::Number; 2];

/// Numbers of a ray, or of several, and where they are known.
pub(super) type Known<A, const N: usize> =
    ([<A as Arithmetic>::Number; N], <A as Arithmetic>::Mask);

/// A polynomial's value; coefficients begin with the constant.
///
/// Even and odd powers in two sums that do not wait for each other (Estrin, "Organization of
/// Computer Systems: the Fixed Plus Variable Structure Computer", Western Joint Computer Conference
/// 1960, for the first step).
#[inline(always)]
pub(super) fn polynomial<A: Arithmetic>(of: A, coefficients: &[f64], x: A::Number) -> A::Number {
    let square = of.mul(x, x);
    let (mut even, mut odd) = (of.number(0.0), of.number(0.0));
    for (k, &coefficient) in coefficients.iter().enumerate().rev() {
        let sum = if k % 2 == 0 { &mut even } else { &mut odd };
        *sum = of.add(of.mul(*sum, square), of.number(coefficient));
    }
    of.add(even, of.mul(odd, x))
}

/// `-x`.
#[inline(always)]
pub(super) fn negative<A: Arithmetic>(of: A, x: A::Number) -> A::Number {
    of.sub(of.number(0.0), x)
}

/// `x² + y²`.
#[inline(always)]
pub(super) fn square<A: Arithmetic>(of: A, x: A::Number, y: A::Number) -> A::Number {
    of.add(of.mul(x, x), of.mul(y, y))
}

/// `2 x`.
#[inline(always)]
pub(super) fn twice<A: Arithmetic>(of: A, x: A::Number) -> A::Number {
    of.add(x, x)
}

/// Sine and cosine of an angle from -pi to pi, to about a unit in the last place.
///
/// The angle is brought to pi / 4 by a multiple of pi / 2, whose first part has 33 bits, so that
/// the product is exact; then Taylor's series, whose next terms are below half a unit.
#[inline(always)]
pub(super) fn sincos<A: Arithmetic>(of: A, angle: A::Number) -> Pair<A> {
    /// Adding it rounds to a whole number.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    /// pi / 2 in two parts.
    const PARTS: [f64; 2] =
        [f64::from_bits(0x3ff9_21fb_5440_0000), f64::from_bits(0x3dd0_b461_1a62_6331)];
    const SINE: [f64; 8] = [
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5_040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 1_307_674_368_000.0,
        1.0 / 355_687_428_096_000.0,
    ];
    const COSINE: [f64; 7] = [
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 20_922_789_888_000.0,
    ];
    let quarters = of.mul(angle, of.number(std::f64::consts::FRAC_2_PI));
    let quarters = of.sub(of.add(quarters, of.number(ROUND)), of.number(ROUND));
    let rest = of.sub(angle, of.mul(quarters, of.number(PARTS[0])));
    let rest = of.sub(rest, of.mul(quarters, of.number(PARTS[1])));
    let square = of.mul(rest, rest);
    let cube = of.mul(rest, square);
    let sine = of.add(rest, of.mul(cube, polynomial(of, &SINE, square)));
    let fourth = of.mul(square, square);
    let half = of.mul(of.number(0.5), square);
    let cosine =
        of.add(of.sub(of.number(1.0), half), of.mul(fourth, polynomial(of, &COSINE, square)));
    // Of -2 to 2 quarters.
    let is_first = of.lt(of.number(0.5), quarters) & of.lt(quarters, of.number(1.5));
    let is_minus_first = of.lt(quarters, of.number(-0.5)) & of.lt(of.number(-1.5), quarters);
    let is_second = of.lt(of.number(1.5), quarters) | of.lt(quarters, of.number(-1.5));
    let of_sine = of.select(is_second, negative(of, sine), sine);
    let of_sine = of.select(is_first, cosine, of_sine);
    let of_sine = of.select(is_minus_first, negative(of, cosine), of_sine);
    let of_cosine = of.select(is_second, negative(of, cosine), cosine);
    let of_cosine = of.select(is_first, negative(of, sine), of_cosine);
    let of_cosine = of.select(is_minus_first, sine, of_cosine);
    [of_sine, of_cosine]
}

/// A polynomial through eight points of a function: a start for Newton's method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
    /// The middle of the interval, and one divided by half its length.
    middle: f64,
    scale: f64,
    /// The coefficients in the place in the interval, from -1 to 1.
    coefficients: [f64; NODES],
}

const NODES: usize = 8;

impl Default for Start {
    /// One everywhere.
    fn default() -> Self {
        let mut coefficients = [0.0; NODES];
        coefficients[0] = 1.0;
        Self { middle: 0.0, scale: 0.0, coefficients }
    }
}

impl Start {
    /// Through the values of `f` at Chebyshev's points of the interval from 0 to `end`. Where `f`
    /// has no value, one.
    pub(super) fn through(end: f64, f: impl Fn(f64) -> Option<f64>) -> Self {
        let is_sound = end > 0.0 && end.is_finite();
        if !is_sound {
            return Self::default();
        }
        let nodes: [f64; NODES] = std::array::from_fn(|k| {
            -libm::cos(std::f64::consts::PI * (k as f64 + 0.5) / NODES as f64)
        });
        let mut differences = nodes.map(|node| f(end * (0.5 + 0.5 * node)).unwrap_or(1.0));
        // Divided differences, then Newton's form multiplied out from the inside.
        for order in 1..NODES {
            for k in (order..NODES).rev() {
                let apart = nodes[k] - nodes[k - order];
                differences[k] = (differences[k] - differences[k - 1]) / apart;
            }
        }
        let mut coefficients = [0.0; NODES];
        for k in (0..NODES).rev() {
            for power in (1..NODES).rev() {
                coefficients[power] = coefficients[power - 1] - nodes[k] * coefficients[power];
            }
            coefficients[0] = differences[k] - nodes[k] * coefficients[0];
        }
        Self { middle: 0.5 * end, scale: 2.0 / end, coefficients }
    }

    #[inline(always)]
    pub(super) fn at<A: Arithmetic>(&self, of: A, x: A::Number) -> A::Number {
        let from_middle = of.sub(x, of.number(self.middle));
        let place = of.mul(from_middle, of.number(self.scale));
        polynomial(of, &self.coefficients, place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::arithmetic::Scalar;

    #[test]
    fn sines_are_good_to_a_unit_in_the_last_place() {
        for k in -4000..=4000 {
            let angle = std::f64::consts::PI * f64::from(k) / 4000.0;
            let [sine, cosine] = sincos(Scalar, angle);
            let (expected_sine, expected_cosine) = libm::sincos(angle);
            assert!((sine - expected_sine).abs() < 3e-16, "{angle}: {sine}");
            assert!((cosine - expected_cosine).abs() < 3e-16, "{angle}: {cosine}");
        }
    }

    #[test]
    fn a_start_is_near_a_smooth_function() {
        let start = Start::through(2.0, |x| Some(1.0 / (1.0 + 0.3 * x)));
        for k in 0..=20 {
            let x = 0.1 * f64::from(k);
            assert!((start.at(Scalar, x) - 1.0 / (1.0 + 0.3 * x)).abs() < 1e-5, "{x}");
        }
    }
}
