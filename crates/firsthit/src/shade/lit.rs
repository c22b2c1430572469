//! Surfaces in the light of lights, which a shadow ray each tells from shadow. How a surface answers light is the shader's.

use super::shadow::ShadowRays;
use super::{Points, Shading, seen_normal};
use crate::geometry::{Color, DVec2, DVec3, Ray, RayFilter, unit};
use crate::scene::{Light, SurfaceInteraction, softened};

/// How a surface answers light.
pub(super) trait Reflection {
    /// What the surface shows without any of the lights.
    fn ambient(&self, point: &Lit) -> Color;

    /// What it shows of light from one direction.
    fn reflected(&self, point: &Lit, light: &Incoming) -> Color;

    /// What is seen, where these have that sum.
    fn seen(&self, _point: &Lit, sum: Color) -> Color {
        sum
    }
}

/// What shaders with lights have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lighting {
    /// Whether faces have their own normals, in place of smooth ones.
    pub(super) flat: bool,
    /// Whether things cast shadows.
    pub(super) shadows: bool,
}

impl Lighting {
    /// Colours all points.
    pub(super) fn shade(
        self,
        reflection: &impl Reflection,
        shading: &Shading<'_>,
        points: &Points<'_>,
        colors: &mut [Color],
    ) {
        let lit: Vec<Result<Lit, Color>> = (points.surfaces.iter())
            .map(|surface| Lit::new(surface, self.flat))
            .collect();
        let ambient = |point: &Lit| reflection.ambient(point);
        let mut sums: Vec<Color> = (lit.iter())
            .map(|point| point.as_ref().map_or(Color::ZERO, ambient))
            .collect();
        let mut shadow_rays = ShadowRays::with_capacity(lit.len());
        for source in shading.scene.lights() {
            for (k, point) in lit.iter().enumerate() {
                let Ok(point) = point else { continue };
                if let Some((ray, incoming)) = point.incoming(source) {
                    let brought = reflection.reflected(point, &incoming);
                    shadow_rays.push((ray, point.filter), k, brought);
                }
            }
            shadow_rays.add_to(&mut sums, shading, self.shadows);
        }
        for ((color, point), sum) in colors.iter_mut().zip(lit).zip(sums) {
            *color = match point {
                Ok(point) => reflection.seen(&point, sum),
                Err(color) => color,
            };
        }
    }
}

/// A point of a surface with its normals on the side that is seen; NaN where it has none.
pub(super) struct Lit {
    /// The colour of the surface.
    pub(super) color: Color,
    /// The normal to shade with.
    pub(super) normal: DVec3,
    /// The way back along the ray, of length one.
    pub(super) viewer: DVec3,
    position: DVec3,
    geometric: DVec3,
    /// What its shadow rays do not meet: the surface they leave.
    filter: RayFilter,
}

/// Light at a point, from one direction.
pub(super) struct Incoming {
    /// The direction that it comes from, of length one.
    pub(super) towards: DVec3,
    /// The cosine to the normal.
    pub(super) cosine: f64,
    /// How much of it counts near the edge of the light, from 0 to 1.
    pub(super) share: f64,
    /// What a white, matte surface takes that faces it.
    pub(super) light: Color,
}

impl Lit {
    /// A hit as a lit point; or its colour, where no light changes that.
    fn new(surface: &SurfaceInteraction<'_>, flat: bool) -> Result<Self, Color> {
        let color = surface.color();
        if surface.is_unlit() {
            return Err(color);
        }
        let geometric = surface.side() * surface.normal();
        let (start, filter) = surface.leave(geometric);
        Ok(Self {
            color,
            normal: seen_normal(surface, flat),
            viewer: -unit(surface.ray().direction),
            position: start.origin,
            geometric,
            filter,
        })
    }

    /// The ray towards a light, up to where it comes from, and what is at its end. `None` where the light is on
    /// the other side. A light with a size counts as its middle.
    fn incoming(&self, source: &Light) -> Option<(Ray, Incoming)> {
        let arriving = source.sample(self.position, DVec2::splat(0.5))?;
        let towards = unit(arriving.towards);
        let cosine = towards.dot(self.normal);
        let flat = arriving.towards.dot(self.geometric);
        // Written so that a NaN (the point is where the light is, or a triangle without an area) fails.
        (cosine > 0.0 && flat > 0.0).then(|| {
            let share = if self.normal == self.geometric {
                1.0
            } else {
                let between = self.normal.dot(self.geometric);
                softened(cosine, towards.dot(self.geometric), between)
            };
            let ray =
                Ray::new(self.position, arriving.towards).up_to(arriving.ray_end(self.position));
            let incoming = Incoming {
                towards,
                cosine,
                share,
                light: arriving.light,
            };
            (ray, incoming)
        })
    }
}
