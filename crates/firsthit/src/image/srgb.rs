use std::sync::LazyLock;

use super::colormap::unit_byte;
use crate::geometry::srgb_encode;

/// The curve, made at its first use in about a millisecond.
pub(super) static SRGB: LazyLock<SrgbBytes> = LazyLock::new(SrgbBytes::new);

/// More than the bytes per unit of light where the curve is steepest, 12.92 * 255: so that no two steps
/// fall into the same part.
const PARTS: u16 = 4096;

/// The byte of each linear value, as `(srgb_encode(linear) * 255).round()`, without the power: that
/// is 20 times slower.
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

/// The smallest float64 between 0 and 1 that is `above`, by bisection of the bits: they are in order.
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
