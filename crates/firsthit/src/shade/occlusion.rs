//! Ambient occlusion: how much of the sky a point sees (Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", Rendering
//! Techniques '98), by the cosine of its directions.

use super::shadow::ShadowRays;
use super::{Points, Shading};
use crate::geometry::{Color, DVec2, DVec3, Domain, Ray, settings};
use crate::sampling::{Draws, TangentFrame, warp};
use crate::scene::SurfaceInteraction;

settings! {
    /// The settings of ambient occlusion.
    pub struct AmbientOcclusion {
        /// How far away things hide the sky, in scene units.
        reach: f64, Domain::PositiveOrInfinite, default f64::INFINITY;
    }
}

/// White where the sky is seen, black where it is hidden: a direction for each sample, as often as its cosine is large.
pub(super) fn shade(
    settings: &AmbientOcclusion,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    let mut rays = ShadowRays::with_capacity(colors.len());
    for (k, (surface, draws)) in points.surfaces.iter().zip(&points.draws).enumerate() {
        if let Some(ray) = sky_ray(surface, *draws, settings.reach) {
            rays.push(ray, k, Color::ONE);
        }
    }
    colors.fill(Color::ZERO);
    rays.add_to(colors, shading, true);
}

/// A ray from a surface to the sky, on the side that is seen; `None` where there is no normal.
fn sky_ray(
    surface: &SurfaceInteraction<'_>,
    mut draws: Draws,
    reach: f64,
) -> Option<(Ray, crate::geometry::RayFilter)> {
    let normal = surface.side() * surface.normal();
    let u: DVec2 = draws.two();
    let towards: DVec3 = TangentFrame::around(normal).world(warp::cosine_hemisphere(u));
    towards.is_finite().then(|| {
        let (ray, filter) = surface.leave(towards);
        (ray.up_to(reach), filter)
    })
}
