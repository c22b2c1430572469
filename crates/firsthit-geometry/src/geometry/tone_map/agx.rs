use super::rows;
use crate::geometry::{Color, DMat3};

/// Linear Rec. 709 to primaries that are drawn in towards white, so that saturated colours fade
/// where they are bright.
#[rustfmt::skip]
const INSET: DMat3 = rows([
    [0.842_479_062_253_094, 0.078_433_599_999_999_2, 0.079_223_745_147_764_3],
    [0.042_328_242_261_012_3, 0.878_468_636_469_772, 0.079_166_127_460_543_4],
    [0.042_375_654_905_705_1, 0.078_433_6, 0.879_142_973_793_104],
]);

/// The inverse of [`INSET`].
#[rustfmt::skip]
const OUTSET: DMat3 = rows([
    [1.196_879_005_120_17, -0.098_020_881_140_136_8, -0.099_029_744_079_720_5],
    [-0.052_896_851_757_456_2, 1.151_903_129_904_17, -0.098_961_176_844_843_3],
    [-0.052_971_635_514_443_8, -0.098_043_450_117_124_1, 1.151_073_672_641_16],
]);

/// The logarithms to base 2 of what becomes 0 and 1: ten stops below a middle grey of 0.18, and six
/// and a half above it.
const EV: [f64; 2] = [-12.473_93, 4.026_069];

/// The place of middle grey among the stops.
const MIDDLE: f64 = 10.0 / 16.5;

/// The shown value of middle grey.
const SHOWN_MIDDLE: f64 = 0.5;

/// The contrast at middle grey.
const SLOPE: f64 = 2.0;

/// The curve above and below middle grey.
const SHOULDER: Bend = Bend { power: 3.25, scale: 0.541_464_156_278_149_7 };
const TOE: Bend = Bend { power: 3.0, scale: 0.512_277_382_293_071 };

/// The exponent of display-encoded values.
const DISPLAY_GAMMA: f64 = 2.2;

/// AgX with its default contrast: Troy Sobotka, "AgX" (the OpenColorIO configuration, 2022), in the
/// compact form of Benjamin Wrensch, "Minimal AgX Implementation" (2023), but with the sigmoid
/// itself in place of that one's polynomial, which does not reach white.
pub(super) fn agx(color: Color) -> Color {
    let shown = OUTSET * (INSET * color).map(|x| contrast(stops(x)));
    shown.map(|x| libm::pow(x.clamp(0.0, 1.0), DISPLAY_GAMMA))
}

/// The place among the stops, from 0 to 1.
fn stops(linear: f64) -> f64 {
    let [least, most] = EV;
    ((libm::log2(linear) - least) / (most - least)).clamp(0.0, 1.0)
}

/// One side of the sigmoid: a line that bends towards an end.
struct Bend {
    /// The sharpness of the bend.
    power: f64,
    /// The scale with which the line ends where it should, see the test.
    scale: f64,
}

/// Jed Smith's sigmoid, in which both sides of the pivot have their own bend.
fn contrast(x: f64) -> f64 {
    let (Bend { power, scale }, side) = if x >= MIDDLE { (SHOULDER, 1.0) } else { (TOE, -1.0) };
    let along = SLOPE * (x - MIDDLE).abs() / scale;
    let bent = along / libm::pow(1.0 + libm::pow(along, power), 1.0 / power);
    SHOWN_MIDDLE + side * scale * bent
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scale that the sigmoid's authors solve for: the bend goes through (0, 0), or (1, 1).
    fn scale(power: f64, across: f64, up: f64) -> f64 {
        let rise = SLOPE * across;
        let inverse = libm::pow(rise, -power) * (libm::pow(rise / up, power) - 1.0);
        libm::pow(inverse, -1.0 / power)
    }

    #[test]
    fn the_curve_goes_from_black_to_white() {
        let [toe, shoulder] = [
            scale(TOE.power, MIDDLE, SHOWN_MIDDLE),
            scale(SHOULDER.power, 1.0 - MIDDLE, 1.0 - SHOWN_MIDDLE),
        ];
        assert!((toe - TOE.scale).abs() < 1e-15, "{toe:?}");
        assert!((shoulder - SHOULDER.scale).abs() < 1e-15, "{shoulder:?}");
        assert!(contrast(0.0).abs() < 1e-15);
        assert!((contrast(1.0) - 1.0).abs() < 1e-15);
        assert_eq!(contrast(MIDDLE), SHOWN_MIDDLE);
    }

    /// His mean squared error is 4e-6 from a fit to a table of 1024 steps; the largest error is
    /// where it misses white and black.
    #[test]
    fn the_curve_is_that_of_the_published_polynomial() {
        for step in 0..=1000 {
            let x = f64::from(step) / 1000.0;
            let factors = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];
            let polynomial = factors.iter().fold(0.0, |sum, factor| sum * x + factor);
            let error = contrast(x) - polynomial;
            assert!(error.abs() < 0.006, "{x}: {error}");
        }
    }

    #[test]
    fn the_outset_undoes_the_inset() {
        let both = INSET * OUTSET;
        assert!(both.abs_diff_eq(DMat3::IDENTITY, 1e-14), "{both}");
    }
}
