//! Matte surfaces: the light that falls on them, by the cosine of its angle (Lambert,
//! "Photometria", 1760).

use super::depth_cue::{self, DepthCue};
use super::lit::{HardLighting, Incoming, Lit, Reflection};
use super::{Points, Shading};
use crate::geometry::{Color, Domain, settings};

settings! {
    /// The settings of the Lambert shader. Surfaces are lit on both sides.
    pub struct Lambert {
        /// Light from everywhere, which nothing blocks.
        ambient: Color, Domain::Color, default Color::splat(0.25);
        /// Whether things cast shadows.
        shadows: bool, Domain::Flag, default true;
        /// Whether faces have their own normals, in place of smooth ones.
        flat: bool, Domain::Flag, default false;
        /// The distance at which colours begin to fade, in scene units.
        depth_near: f64, Domain::NonNegative, default 0.0;
        /// The distance at which they are all `depth_color`; by default nowhere.
        depth_far: f64, Domain::PositiveOrInfinite, default f64::INFINITY;
        /// The colour that distant surfaces fade to; by default the default background.
        depth_color: Color, Domain::Color, default depth_cue::COLOR;
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
    let cue = DepthCue {
        near: settings.depth_near,
        far: settings.depth_far,
        color: settings.depth_color,
    };
    cue.fade(points, colors);
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
