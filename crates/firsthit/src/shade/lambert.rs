//! Matte surfaces: the light that falls on them, by the cosine of its angle (Lambert, "Photometria", 1760).

use super::Shading;
use crate::geometry::{Color, DVec3, Filtered, Ray, RayFilter, Rays, unit};
use crate::scene::{Light, SurfaceInteraction};
use crate::shoot::Answers;

/// The settings of the Lambert shader. Surfaces are lit on both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambert {
    /// Light from everywhere, which nothing blocks.
    pub ambient: Color,
    /// Whether things cast shadows.
    pub shadows: bool,
}

impl Default for Lambert {
    fn default() -> Self {
        Self {
            ambient: Color::splat(0.25),
            shadows: true,
        }
    }
}

/// All shadow rays towards a light are shot together: those of neighbours go nearly the same way.
pub(super) fn shade(
    settings: &Lambert,
    shading: &Shading<'_>,
    surfaces: &[SurfaceInteraction<'_>],
    colors: &mut [Color],
) {
    let mut lit = Vec::with_capacity(surfaces.len());
    for (k, surface) in surfaces.iter().enumerate() {
        match Lit::new(settings, surface) {
            Ok(point) => lit.push((k, point)),
            Err(color) => colors[k] = color,
        }
    }
    let mut shadow_rays = Vec::with_capacity(lit.len());
    let mut filters = Vec::with_capacity(lit.len());
    let mut arriving = Vec::with_capacity(lit.len());
    for source in shading.scene.lights() {
        shadow_rays.clear();
        filters.clear();
        arriving.clear();
        for (index, (_, point)) in lit.iter().enumerate() {
            if let Some((ray, light)) = arriving_at(point, source) {
                shadow_rays.push(ray);
                filters.push(point.filter);
                arriving.push((index, light));
            }
        }
        let mut shadows = Vec::new();
        if settings.shadows {
            shadows = all_blocked(shading, &Filtered::each(&shadow_rays, &filters));
        }
        for (k, &(index, light)) in arriving.iter().enumerate() {
            if shadows.get(k) != Some(&true) {
                lit[index].1.light += light;
            }
        }
    }
    for (k, point) in lit {
        colors[k] = point.color * point.light;
    }
}

fn all_blocked(shading: &Shading<'_>, rays: &Filtered<'_, Vec<Ray>>) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    let answers = Answers::Any(&mut blocked);
    let traced = shading.engine.trace(shading.scene, rays, answers, &());
    debug_assert!(traced.is_ok(), "nobody stops it");
    blocked
}

/// A point of a surface with its normals on the side that is seen.
struct Lit {
    position: DVec3,
    geometric: DVec3,
    smooth: DVec3,
    /// What its shadow rays do not meet: the surface they leave.
    filter: RayFilter,
    /// The surface's colour.
    color: Color,
    /// The light that is known to arrive.
    light: Color,
}

impl Lit {
    /// A hit as a lit point; or its colour, where no light changes that.
    fn new(settings: &Lambert, surface: &SurfaceInteraction<'_>) -> Result<Self, Color> {
        let color = surface.color();
        if surface.is_unlit() {
            return Err(color);
        }
        let geometric = surface.normal();
        if !geometric.is_finite() {
            return Err(color * settings.ambient);
        }
        let smooth = surface.shading_normal();
        let side = if surface.is_front() { 1.0 } else { -1.0 };
        let (start, filter) = surface.leave(side * geometric);
        Ok(Self {
            position: start.origin,
            geometric: side * geometric,
            smooth: side * smooth,
            filter,
            color,
            light: settings.ambient,
        })
    }
}

/// The ray towards a light, up to where it comes from, and what a white surface gets of it. `None` where the light is on
/// the other side.
fn arriving_at(point: &Lit, source: &Light) -> Option<(Ray, Color)> {
    let (towards, distance, light) = match *source {
        Light::Directional { direction, color } => (-direction, f64::INFINITY, color),
        Light::Point {
            position,
            intensity,
        } => {
            let towards = position - point.position;
            (towards, 1.0, intensity / towards.length_squared())
        }
        Light::Spot {
            position,
            direction,
            intensity,
            inner_angle,
            outer_angle,
        } => {
            let towards = position - point.position;
            let along = unit(-towards).dot(unit(direction));
            let share = within_cone(along, inner_angle, outer_angle);
            (towards, 1.0, share * intensity / towards.length_squared())
        }
    };
    let cosine = unit(towards).dot(point.smooth);
    // Written so that a NaN (the point is where the light is) fails.
    (cosine > 0.0 && towards.dot(point.geometric) > 0.0).then(|| {
        let ray = Ray::new(point.position, towards).up_to(distance);
        (ray, cosine * light)
    })
}

/// How much of a spot's light goes in a direction: the square of the cosine's way from the outer angle to the
/// inner one, as `KHR_lights_punctual` suggests.
fn within_cone(cosine: f64, inner_angle: f64, outer_angle: f64) -> f64 {
    let (inner, outer) = (libm::cos(inner_angle), libm::cos(outer_angle));
    let share = ((cosine - outer) / (inner - outer).max(1e-9)).clamp(0.0, 1.0);
    share * share
}
