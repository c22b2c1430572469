//! The object's colour as it is.

use super::Shot;
use crate::geometry::Color;
use crate::scene::Scene;

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form of all shaders")]
pub(super) fn shade((): &(), scene: &Scene, shots: &[Shot], colors: &mut [Color]) {
    for ((_, hit), color) in shots.iter().zip(colors) {
        *color = scene.color(hit).unwrap_or(Color::ZERO);
    }
}
