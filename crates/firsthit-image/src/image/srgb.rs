use std::sync::OnceLock;

use crate::geometry::srgb_encode;
use crate::parallel;

/// The curve, made at its first use in about a millisecond.
pub(super) fn srgb() -> &'static SrgbBytes {
    static SRGB: OnceLock<SrgbBytes> = OnceLock::new();
    parallel::once(&SRGB, SrgbBytes::new)
}

/// The number of parts of the curve: more than the bytes per unit of light where it is steepest,
/// 12.92 * 255, so that no two steps fall into one part.
const PARTS: u16 = 4096;

/// The byte of each linear value, as `(srgb_encode(linear) * 255).round()`, without the power: that
/// takes 0.2 s for 1024 x 1024 pixels, where the whole PNG takes 0.015 s (AMD EPYC, one thread).
pub(super) struct SrgbBytes {
    /// `steps[b]` is the smallest linear value whose byte is above `b`.
    steps: [f64; 256],
    /// The byte at the start of each of the equal parts of 0 to 1; the last is 1 itself.
    first: Vec<u8>,
}

impl SrgbBytes {
    fn new() -> Self {
        let byte = |linear| unit_byte(srgb_encode(linear));
        let parts = f64::from(PARTS);
        Self {
            steps: std::array::from_fn(|b| match u8::try_from(b + 1) {
                Ok(above) => first_bits(|bits| byte(f64::from_bits(bits)) >= above),
                Err(_) => f64::INFINITY,
            }),
            first: (0..=PARTS).map(|k| byte(f64::from(k) / parts)).collect(),
        }
    }

    pub(super) fn byte(&self, linear: f64) -> u8 {
        // Written so that a NaN becomes 0.
        let linear = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to PARTS"
        )]
        let part = (linear * f64::from(PARTS)) as usize;
        let first = self.first[part];
        first + u8::from(linear >= self.steps[usize::from(first)])
    }
}

/// The bytes of a premultiplied colour, as PNG stores them: those of the colour divided by alpha,
/// and alpha, which has no curve.
pub(super) fn unpremultiplied(
    [r, g, b, alpha]: [f64; 4],
    bytes: impl Fn([f64; 3]) -> [u8; 3],
) -> [u8; 4] {
    if alpha > 0.0 {
        let [r, g, b] = bytes([r, g, b].map(|level| level / alpha));
        [r, g, b, unit_byte(alpha)]
    } else {
        [0; 4]
    }
}

/// A number from 0 to 1 as a byte, rounded to nearest.
pub(super) fn unit_byte(unit: f64) -> u8 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` saturates, which is what is wanted here; NaN becomes 0"
    )]
    {
        (unit * 255.0).round() as u8
    }
}

/// The smallest float64 between 0 and 1 that is `above`, by bisection of the bits: they are in
/// order.
fn first_bits(above: impl Fn(u64) -> bool) -> f64 {
    let (mut low, mut high) = (0, 1.0_f64.to_bits());
    while low < high {
        let middle = low.midpoint(high);
        if above(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    f64::from_bits(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula(linear: f64) -> u8 {
        unit_byte(srgb_encode(linear))
    }

    #[test]
    fn bytes_are_those_of_the_formula() {
        for k in 0..=1_000_000 {
            // Fractions that are no multiples of the table's parts, and some outside 0 to 1.
            let linear = f64::from(k) / 999_983.0 * 1.2 - 0.1;
            assert_eq!(srgb().byte(linear), formula(linear), "{linear}");
        }
        let outside = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, 5e-324, 1e308];
        for linear in outside {
            assert_eq!(srgb().byte(linear), formula(linear), "{linear}");
        }
    }

    /// The float32 on either side of every step, where a table would go wrong.
    #[test]
    fn bytes_are_those_of_the_formula_around_every_step() {
        for step in &srgb().steps[..255] {
            #[expect(clippy::cast_possible_truncation, reason = "the nearest float32 is wanted")]
            let near = *step as f32;
            for linear in [near.next_down(), near, near.next_up()] {
                let linear = f64::from(linear);
                assert_eq!(srgb().byte(linear), formula(linear), "{linear}");
            }
        }
    }

    #[test]
    fn no_part_of_the_table_holds_two_steps() {
        for pair in srgb().first.windows(2) {
            assert!(pair[1] - pair[0] <= 1);
        }
    }
}
