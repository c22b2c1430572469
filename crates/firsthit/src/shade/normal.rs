//! The geometric normal as a colour.

use crate::geometry::{Color, Hit, Ray};
use crate::scene::Scene;

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form of all shaders")]
pub(super) fn shade((): &(), scene: &Scene, ray: &Ray, hit: &Hit) -> Color {
    0.5 * scene.normal(ray, hit) + 0.5
}
