//! The geometric normal as a colour.

use super::Shading;
use crate::geometry::Color;
use crate::scene::SurfaceInteraction;

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form of all shaders")]
pub(super) fn shade(
    (): &(),
    _: &Shading<'_>,
    surfaces: &[SurfaceInteraction<'_>],
    colors: &mut [Color],
) {
    for (surface, color) in surfaces.iter().zip(colors) {
        *color = 0.5 * surface.normal() + 0.5;
    }
}
