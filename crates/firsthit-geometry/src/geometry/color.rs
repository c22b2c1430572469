use std::sync::OnceLock;

use super::DVec3;
use crate::parallel;

/// A linear colour: red, green, blue with Rec. 709 primaries, 1 being a white surface in full
/// light.
///
/// ```
/// use firsthit::Color;
///
/// let red = Color::new(0.75, 0.25, 0.25);
/// assert_eq!(0.5 * red + Color::splat(0.125), Color::new(0.5, 0.25, 0.25));
/// ```
pub type Color = DVec3;

/// The luminance of a linear colour: how bright it looks, white being 1 (Rec. 709).
#[inline]
pub fn luminance(color: Color) -> f64 {
    color.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// The sRGB value (0 to 1) of a linear one, by the curve of IEC 61966-2-1. Values outside 0 to 1
/// are clamped, NaN becomes 0.
pub fn srgb_encode(linear: f64) -> f64 {
    // Not `clamp`, which keeps a NaN.
    let linear = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

/// The linear value of an sRGB one (0 to 1), the inverse of [`srgb_encode`].
pub fn srgb_decode(encoded: f64) -> f64 {
    let encoded = if encoded > 0.0 { encoded.min(1.0) } else { 0.0 };
    if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

/// The linear value of an 8-bit level of sRGB.
#[doc(hidden)]
pub fn srgb_decode_level(level: u8) -> f64 {
    static TABLE: OnceLock<[f64; 256]> = OnceLock::new();
    let table = parallel::once(&TABLE, || {
        let mut levels = 0_u8..=255;
        std::array::from_fn(|_| srgb_decode(f64::from(levels.next().unwrap_or(255)) / 255.0))
    });
    table[usize::from(level)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The curve's two branches meet within 4e-8 of each other (IEC 61966-2-1 rounds its
    /// constants).
    #[test]
    fn srgb_decodes_what_it_encodes() {
        for k in 0..=1000 {
            let linear = f64::from(k) / 1000.0;
            assert!((srgb_decode(srgb_encode(linear)) - linear).abs() < 1e-7, "{linear}");
        }
        assert_eq!(srgb_encode(f64::NAN), 0.0);
        assert_eq!(srgb_encode(7.0), srgb_encode(1.0));
    }

    #[test]
    fn levels_are_decoded_as_their_shares_of_255() {
        for level in 0..=255 {
            let share = f64::from(level) / 255.0;
            assert_eq!(srgb_decode_level(level), srgb_decode(share), "{level}");
        }
    }

    /// The middle grey that everybody knows: byte 188 is half the light.
    #[test]
    fn half_the_light_is_byte_188() {
        assert_eq!((srgb_encode(0.5) * 255.0).round(), 188.0);
    }
}
