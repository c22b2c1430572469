use super::color::Color;
use super::require;
use super::tone_map::ToneMap;
use crate::error::Result;

/// The mapping from linear colours to those of pictures to look at: first brighter or darker, then
/// tone-mapped. The default changes nothing.
///
/// ```
/// use firsthit::{Color, DisplayTransform, ToneMap};
///
/// let brighter = DisplayTransform { exposure: 1.0, tone_map: ToneMap::None };
/// assert_eq!(brighter.apply(Color::new(0.125, 0.25, 4.0)), Color::new(0.25, 0.5, 1.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DisplayTransform {
    /// The exposure in stops, finite: colours are multiplied by 2 to its power.
    pub exposure: f64,
    /// Applied after the exposure.
    pub tone_map: ToneMap,
}

impl DisplayTransform {
    /// The factor of the exposure.
    pub fn gain(self) -> f64 {
        libm::exp2(self.exposure)
    }

    /// The linear colour that is shown for a linear one of any brightness, from 0 to 1.
    pub fn apply(self, color: Color) -> Color {
        self.tone_map.apply(color * self.gain())
    }

    /// Refuses what no picture can be shown with.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for an exposure that is not finite.
    pub fn check(self) -> Result<()> {
        let fine = self.exposure.is_finite();
        require("exposure", "a finite number of stops", fine, self.exposure)
    }
}
