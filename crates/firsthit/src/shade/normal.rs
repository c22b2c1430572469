//! The geometric normal as a colour.

use super::Shot;
use crate::geometry::Color;
use crate::scene::Scene;

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form of all shaders")]
pub(super) fn shade((): &(), scene: &Scene, shots: &[Shot], colors: &mut [Color]) {
    for ((ray, hit), color) in shots.iter().zip(colors) {
        *color = 0.5 * scene.normal(ray, hit) + 0.5;
    }
}
