//! Tone maps: linear colours of any brightness to those that a screen shows. A file per operator.

mod aces;
mod agx;
mod neutral;

use super::color::Color;
use super::{DMat3, named};

named! {
    /// The operator that maps linear colours of any brightness to those that a screen shows, from 0
    /// to 1.
    ///
    /// ```
    /// use firsthit::{Color, ToneMap};
    ///
    /// let neutral: ToneMap = "neutral".parse()?;
    /// assert!(neutral.apply(Color::splat(100.0)).max_element() < 1.0);
    /// assert_eq!(ToneMap::default().apply(Color::splat(100.0)), Color::ONE);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum ToneMap, "tone_map":
    /// Clips values above 1 to 1, and keeps all others: white stays white.
    #[default]
    "none" => None;
    /// Khronos PBR Neutral: keeps the colours of materials, and compresses highlights alone.
    "neutral" => Neutral;
    /// Troy Sobotka's AgX: highlights lose their colour gradually, as on film.
    "agx" => Agx;
    /// Stephen Hill's fit of the ACES reference rendering and sRGB output transforms: more
    /// contrast.
    "aces" => Aces;
}

/// A brightness that every operator shows as it shows infinity, and whose square does not overflow.
const BRIGHTEST: f64 = 1e100;

impl ToneMap {
    /// The linear colour that is shown for a linear one: each component from 0 to 1. Negative
    /// components and NaN count as 0.
    pub fn apply(self, color: Color) -> Color {
        let color = color.to_array().map(bounded).into();
        let shown = match self {
            Self::None => color,
            Self::Neutral => neutral::neutral(color),
            Self::Agx => agx::agx(color),
            Self::Aces => aces::aces(color),
        };
        shown.clamp(Color::ZERO, Color::ONE)
    }
}

/// A component without its sign, and finite; NaN becomes 0.
fn bounded(component: f64) -> f64 {
    if component > 0.0 { component.min(BRIGHTEST) } else { 0.0 }
}

/// The matrix of these rows, as the literature prints it.
const fn rows([x, y, z]: [[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&[[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]])
}
