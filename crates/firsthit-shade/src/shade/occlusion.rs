//! Ambient occlusion: how much of the sky a point sees (Zhukov, Iones and Kronin, "An Ambient Light
//! Illumination Model", Rendering Techniques '98), by the cosine of its directions.

use super::rows::ShadingPoints;
use super::shadow::ShadowRays;
use super::{Points, Shading, seen_normal};
use crate::geometry::rows::{ROW, Vectors};
use crate::geometry::{Color, Domain, Ray, settings};
use crate::sampling::{TangentFrame, warp};
use crate::simd::{self, Kernel, Lanes};

settings! {
    /// The settings of ambient occlusion.
    pub struct AmbientOcclusion {
        /// The distance up to which things hide the sky, in scene units.
        reach: f64, Domain::PositiveOrInfinite, default f64::INFINITY;
    }
}

/// One direction for each sample, cosine-weighted: white if it reaches the sky, black if something
/// within `reach` is in the way.
pub(super) fn shade(
    settings: &AmbientOcclusion,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    let set = shading.engine.instruction_set();
    let mut rays = ShadowRays::with_capacity(colors.len());
    for first in (0..points.surfaces.len()).step_by(ROW) {
        let surfaces = &points.surfaces[first..points.surfaces.len().min(first + ROW)];
        let (mut places, mut normals) = (ShadingPoints::NONE, Vectors::ZERO);
        for (surface, &draws) in surfaces.iter().zip(&points.draws[first..]) {
            let k = places.push(surface.position(), draws);
            normals.set(k, seen_normal(surface, true));
        }
        let towards = simd::run_here(set, DrawSky(&places, &normals));
        for (k, surface) in surfaces.iter().enumerate() {
            let direction = towards.get(k);
            // Not where there is no normal.
            if direction.is_finite() {
                let ray = Ray::new(places.position.get(k), direction);
                let ray = (ray.up_to(settings.reach), surface.departure());
                rays.push(ray, first + k, Color::ONE);
            }
        }
    }
    colors.fill(Color::ZERO);
    rays.add_to(colors, shading, true);
}

/// A cosine-weighted direction around the normal at each point.
struct DrawSky<'a>(&'a ShadingPoints, &'a Vectors);

impl Kernel for DrawSky<'_> {
    type Output = Vectors;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Vectors {
        let Self(places, normals) = self;
        let u = places.draw(None);
        let mut towards = Vectors::ZERO;
        for k in 0..places.len() {
            let local = warp::cosine_hemisphere(u.get(k));
            towards.set(k, TangentFrame::around(normals.get(k)).world(local));
        }
        towards
    }
}
