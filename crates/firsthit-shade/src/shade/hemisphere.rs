//! Light from a sky over a ground, each of one colour, as if nothing were in the way.

use super::depth_cue::{DepthCue, depth_cued};
use super::{Points, Shading, seen_normal};
use crate::geometry::{Color, Domain, unit};

depth_cued! {
    /// The settings of the hemisphere shader.
    pub struct Hemisphere {
        /// The light of the half that is the scene's up.
        above: Color, Domain::Color, default Color::new(1.0, 1.05, 1.15);
        /// The light of the other half.
        below: Color, Domain::Color, default Color::new(0.3, 0.26, 0.22);
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
    DepthCue::from(settings).fade(points, colors);
}
