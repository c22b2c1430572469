//! Moreland's map from cool to warm: straight lines in polar coordinates of CIELAB, from each end
//! to white ("Diverging Color Maps for Scientific Visualization", International Symposium on Visual
//! Computing 2009). The numbers are those of the paper.

use crate::geometry::srgb_encode;

/// The distance from black, and the angle from the grey axis, of both ends.
const END: [f64; 2] = [80.0, 1.08];

/// The hues of both ends.
const HUES: [f64; 2] = [-1.1, 0.5];

/// The distance of the middle from black. It is grey.
const MIDDLE: f64 = 88.0;

/// The levels of sRGB of a number from 0 to 1.
pub(super) fn levels(number: f64) -> [u8; 3] {
    let (hue, sign) = if number < 0.5 { (HUES[0], -1.0) } else { (HUES[1], 1.0) };
    // How far from the middle, up to 1.
    let away = (2.0 * number - 1.0).abs();
    let between = |middle: f64, end: f64| middle + away * (end - middle);
    let [distance, saturation] = [between(MIDDLE, END[0]), between(0.0, END[1])];
    // The hue turns on the way, so that the line looks straight.
    let turn = END[1] * (MIDDLE * MIDDLE - END[0] * END[0]).sqrt() / (END[0] * libm::sin(END[1]));
    let hue = between(hue + sign * turn, hue);
    let (off_grey, grey) = libm::sincos(saturation);
    let (b, a) = libm::sincos(hue);
    from_lab([distance * grey, distance * off_grey * a, distance * off_grey * b])
}

/// CIELAB with the white D65 as levels of sRGB.
///
/// White and matrix are those of Lindbloom, rounded to fit each other, so that grey comes out grey.
/// The daylight's matrix has more digits, and would move five of the 256 steps by one level.
fn from_lab([lightness, a, b]: [f64; 3]) -> [u8; 3] {
    let cubed = |root: f64| {
        if root > 6.0 / 29.0 {
            root * root * root
        } else {
            3.0 * (6.0 / 29.0) * (6.0 / 29.0) * (root - 4.0 / 29.0)
        }
    };
    let root = (lightness + 16.0) / 116.0;
    let x = 0.950_47 * cubed(root + a / 500.0);
    let y = cubed(root);
    let z = 1.088_83 * cubed(root - b / 200.0);
    let linear = [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ];
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the curve gives 0 to 1"
    )]
    linear.map(|value| (srgb_encode(value) * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five rows of the table that goes with the paper.
    #[test]
    fn the_map_is_that_of_the_paper() {
        for (number, expected) in [
            (0.0, [59, 76, 192]),
            (0.25, [141, 176, 254]),
            (0.5, [221, 221, 221]),
            (0.75, [244, 154, 123]),
            (1.0, [180, 4, 38]),
        ] {
            let levels = levels(number);
            let off = levels.iter().zip(expected).map(|(a, b)| a.abs_diff(b));
            assert!(off.max() <= Some(1), "{number}: {levels:?}");
        }
    }
}
