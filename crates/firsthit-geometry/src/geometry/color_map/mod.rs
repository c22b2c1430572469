//! Colour maps: a colour for each number from 0 to 1.

mod cool_warm;

use std::sync::OnceLock;

use super::{Color, named, srgb_decode_level};
use crate::parallel;

named! {
    /// A colour map, from the colour of 0 to that of 1 in 256 steps. But for `turbo` and
    /// `spectral`, equal differences of numbers look equally large, and lighter ones are larger, or
    /// farther from the middle.
    pub enum ColorMap, "color map":
    /// Violet, green, yellow (van der Walt and Smith, 2015).
    #[default]
    "viridis" => Viridis;
    /// Blue to yellow, for all kinds of colour vision (Nunez, Anderton and Renslow, 2018).
    "cividis" => Cividis;
    /// Blue, violet, orange, yellow (van der Walt and Smith, 2015).
    "plasma" => Plasma;
    /// Black, violet, red, yellow, white (van der Walt and Smith, 2015).
    "inferno" => Inferno;
    /// Black, violet, pink, white (van der Walt and Smith, 2015).
    "magma" => Magma;
    /// A rainbow without bands (Mikhailov, 2019).
    "turbo" => Turbo;
    /// Blue to red with a grey middle, for numbers around one that counts (Moreland, "Diverging
    /// Color Maps for Scientific Visualization", 2009).
    "coolwarm" => CoolWarm;
    /// Red, yellow, blue (Brewer, 2003).
    "spectral" => Spectral;
    /// White to dark blue (Brewer, 2003).
    "blues" => Blues;
    /// Black to white.
    "grey" => Grey;
}

/// The number of steps of a map.
const STEPS: usize = 256;

type Table = Box<[Color; STEPS]>;

static TABLES: [OnceLock<Table>; ColorMap::ALL.len()] =
    [const { OnceLock::new() }; ColorMap::ALL.len()];

impl ColorMap {
    /// The linear colour of a number from 0 to 1. Others, also NaN, count as the nearest of these.
    ///
    /// ```
    /// use firsthit::geometry::{ColorMap, srgb_encode};
    ///
    /// let yellow = ColorMap::Viridis.color(1.0);
    /// assert_eq!((srgb_encode(yellow.x) * 255.0).round(), 253.0);
    /// ```
    pub fn color(self, number: f64) -> Color {
        let table = parallel::once(&TABLES[self as usize], || {
            Box::new(std::array::from_fn(|step| {
                Color::from(self.levels(step).map(srgb_decode_level))
            }))
        });
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "`as` saturates, and makes 0 of NaN"
        )]
        let step = (number * (STEPS - 1) as f64).round() as usize;
        table[step.min(STEPS - 1)]
    }

    /// The colour of a step from 0 to 255, as sRGB levels of red, green and blue. Steps above are
    /// the last one.
    pub fn levels(self, step: usize) -> [u8; 3] {
        let step = step.min(STEPS - 1);
        let gradient = match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Cividis => colorous::CIVIDIS,
            Self::Plasma => colorous::PLASMA,
            Self::Inferno => colorous::INFERNO,
            Self::Magma => colorous::MAGMA,
            Self::Turbo => colorous::TURBO,
            Self::Spectral => colorous::SPECTRAL,
            Self::Blues => colorous::BLUES,
            Self::CoolWarm => return cool_warm::levels(step as f64 / (STEPS - 1) as f64),
            Self::Grey => return [u8::try_from(step).unwrap_or(u8::MAX); 3],
        };
        let color = gradient.eval_rational(step, STEPS);
        [color.r, color.g, color.b]
    }
}

/// The place of a number in a range: 0 at the low end, 1 at the high end; 0 if both are equal.
#[doc(hidden)]
pub fn fraction(number: f64, [low, high]: [f64; 2]) -> f64 {
    if low == high {
        return 0.0;
    }
    // Halves, because the difference of two float64 may be infinite.
    (number / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_begin_and_end_with_the_colours_that_they_are_known_by() {
        let ends = |map: ColorMap| [map.levels(0), map.levels(255)];
        assert_eq!(ends(ColorMap::Viridis), [[68, 1, 84], [253, 231, 37]]);
        assert_eq!(ends(ColorMap::Grey), [[0; 3], [255; 3]]);
        assert_eq!(ends(ColorMap::Magma)[0], [0, 0, 4]);
        assert!(ends(ColorMap::Spectral)[0][0] > ends(ColorMap::Spectral)[0][2]);
    }

    #[test]
    fn a_fraction_is_finite_for_all_finite_ends() {
        assert_eq!(fraction(2.0, [-1.0, 3.0]), 0.75);
        assert_eq!(fraction(f64::MAX, [-f64::MAX, f64::MAX]), 1.0);
        assert_eq!(fraction(7.0, [7.0, 7.0]), 0.0);
    }

    #[test]
    fn numbers_outside_count_as_the_ends() {
        for map in ColorMap::ALL {
            assert_eq!(map.color(-3.0), map.color(0.0));
            assert_eq!(map.color(f64::NAN), map.color(0.0));
            assert_eq!(map.color(f64::INFINITY), map.color(1.0));
            assert_ne!(map.color(0.0), map.color(1.0));
        }
    }
}
