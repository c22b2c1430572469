//! Light from a sky over a ground, each of one colour, as if nothing were in the way.

use super::depth_cue::{self, DepthCue};
use super::{Points, Shading, seen_normal};
use crate::geometry::{Color, Domain, settings, unit};

settings! {
    /// The settings of the hemisphere shader.
    pub struct Hemisphere {
        /// The light of the half that is the scene's up.
        above: Color, Domain::Color, default Color::new(1.0, 1.05, 1.15);
        /// The light of the other half.
        below: Color, Domain::Color, default Color::new(0.3, 0.26, 0.22);
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

/// Shades matte surfaces in two even hemispheres of light: the upper one's share is (1 + c) / 2,
/// where c is the cosine of the normal and the scene's up.
pub(super) fn shade(
    settings: &Hemisphere,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    let up = unit(shading.scene.up());
    for (surface, color) in points.surfaces.iter().zip(&mut *colors) {
        *color = surface.color();
        if surface.is_unlit() {
            continue;
        }
        let height = seen_normal(surface, settings.flat).dot(up);
        // A triangle without an area has no normal: it stands upright.
        let height = if height.is_nan() { 0.0 } else { height };
        *color *= settings.below.lerp(settings.above, height.midpoint(1.0));
    }
    let cue = DepthCue {
        near: settings.depth_near,
        far: settings.depth_far,
        color: settings.depth_color,
    };
    cue.fade(points, colors);
}
