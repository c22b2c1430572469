//! Matte surfaces: the light that falls on them, by the cosine of its angle (Lambert, "Photometria", 1760).

use super::Shading;
use crate::geometry::{Color, DVec3, Ray, unit};
use crate::scene::{Light, SurfaceInteraction};
use crate::shoot::{Any, trace_with};

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
    let mut arriving = Vec::with_capacity(lit.len());
    for source in shading.scene.lights() {
        shadow_rays.clear();
        arriving.clear();
        for (index, (_, point)) in lit.iter().enumerate() {
            if let Some((ray, light)) = arriving_at(point, source) {
                shadow_rays.push(ray);
                arriving.push((index, light));
            }
        }
        let mut shadows = Vec::new();
        if settings.shadows {
            shadows = all_blocked(shading, &shadow_rays);
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

fn all_blocked(shading: &Shading<'_>, rays: &[Ray]) -> Vec<bool> {
    let (engine, scene) = (shading.engine, shading.scene);
    let one = |ray| engine.any_hit(scene, ray);
    if let [ray] = rays {
        return vec![one(ray)];
    }
    match trace_with(engine, scene, rays, Any, &()) {
        Ok(blocked) => blocked,
        Err(_) => rays.iter().map(one).collect(),
    }
}

/// A point of a surface with its normals on the side that is seen.
struct Lit {
    position: DVec3,
    geometric: DVec3,
    smooth: DVec3,
    /// Where its shadow rays start.
    start: DVec3,
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
        let (ray, hit) = (surface.ray(), surface.hit());
        let (position, geometric) = (ray.at(hit.t), side * geometric);
        Ok(Self {
            position,
            geometric,
            smooth: side * smooth,
            start: off_the_surface(ray, position, geometric),
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
        let ray = Ray::new(point.start, towards).up_to(distance);
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

/// Where shadow rays start: off the surface by more than the rounding of the point on it, so that they do
/// not meet the surface they start from. (The idea is that of Wächter and Binder, "A Fast and Robust
/// Method for Avoiding Self-Intersection", Ray Tracing Gems (2019), chapter 6.)
fn off_the_surface(ray: &Ray, position: DVec3, normal: DVec3) -> DVec3 {
    // The point carries the rounding of the largest coordinate on the way to it. In float64 a millionth of
    // a millionth of it is both far above that and far below anything to be seen.
    let largest = position.abs().max(ray.origin.abs()).max_element();
    position + 1e-12 * largest.max(1e-300) * normal
}
