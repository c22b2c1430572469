//! The object's colour as it is.

use crate::geometry::{Color, Hit, Ray};
use crate::scene::Scene;

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form of all shaders")]
pub(super) fn shade((): &(), scene: &Scene, _ray: &Ray, hit: &Hit) -> Color {
    scene.color(hit).unwrap_or(Color::ZERO)
}
