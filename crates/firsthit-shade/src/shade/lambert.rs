//! Matte surfaces: the light that falls on them, by the cosine of its angle (Lambert,
//! "Photometria", 1760).

use super::depth_cue::{DepthCue, depth_cued};
use super::lit::{HardLighting, Incoming, Lit, Reflection};
use super::{Points, Shading};
use crate::geometry::{Color, Domain};

depth_cued! {
    /// The settings of the Lambert shader. Surfaces are lit on both sides.
    pub struct Lambert {
        /// Light from everywhere, which nothing blocks.
        ambient: Color, Domain::Color, default Color::splat(0.25);
        /// Whether things cast shadows.
        shadows: bool, Domain::Flag, default true;
    }
}

pub(super) fn shade(
    settings: &Lambert,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    let &Lambert { flat, shadows, .. } = settings;
    HardLighting { flat, shadows }.shade(settings, shading, points, colors);
    DepthCue::from(settings).fade(points, colors);
}

impl Reflection for Lambert {
    fn ambient(&self, _point: &Lit) -> Color {
        self.ambient
    }

    #[inline(always)]
    fn reflected(&self, _point: &Lit, light: &Incoming) -> Color {
        light.cosine * light.share * light.light
    }

    fn seen(&self, point: &Lit, sum: Color) -> Color {
        point.color * sum
    }
}
