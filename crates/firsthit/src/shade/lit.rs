//! Surfaces in the light of lights, which a shadow ray each tells from shadow. How a surface answers light is the shader's.

use super::shadow::ShadowRays;
use super::{Points, Shading};
use crate::geometry::{Color, DVec2, DVec3, Ray, unit};
use crate::scene::{Light, LightSample, PreparedLight, SurfaceInteraction, softened};

/// How a surface answers light.
pub(super) trait Reflection {
    /// What the surface shows without any of the lights.
    fn ambient(&self, point: &Lit<'_>) -> Color;

    /// What it shows of light from one direction.
    fn reflected(&self, point: &Lit<'_>, light: &Incoming) -> Color;

    /// What is seen, where these have that sum.
    fn seen(&self, _point: &Lit<'_>, sum: Color) -> Color {
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
        let lit: Vec<Result<Lit<'_>, Color>> = (points.surfaces.iter())
            .map(|surface| Lit::new(surface, self.flat))
            .collect();
        let ambient = |point: &Lit<'_>| reflection.ambient(point);
        let mut sums: Vec<Color> = (lit.iter())
            .map(|point| point.as_ref().map_or(Color::ZERO, ambient))
            .collect();
        let mut shadow_rays = ShadowRays::with_capacity(lit.len());
        for light in shading.scene.lights() {
            let source = Source::new(light);
            for (k, point) in lit.iter().enumerate() {
                let Ok(point) = point else { continue };
                if let Some((ray, incoming)) = point.incoming(&source) {
                    let brought = reflection.reflected(point, &incoming);
                    shadow_rays.push((ray, point.surface.departure()), k, brought);
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

/// A light, which counts as its middle where it has a size.
struct Source {
    light: PreparedLight,
    /// What is the same for all points, if that is everything: its sample, and the direction towards it.
    everywhere: Option<(LightSample, DVec3)>,
}

impl Source {
    fn new(light: &Light) -> Self {
        let light = light.prepared();
        let everywhere = light.everywhere(MIDDLE);
        Self {
            light,
            everywhere: everywhere.map(|sample| (sample, unit(sample.towards))),
        }
    }

    /// Its light at a point, and the direction towards it.
    #[inline]
    fn at(&self, point: DVec3) -> Option<(LightSample, DVec3)> {
        self.everywhere.or_else(|| {
            let sample = self.light.sample(point, MIDDLE)?;
            Some((sample, unit(sample.towards)))
        })
    }
}

/// The middle of a light.
const MIDDLE: DVec2 = DVec2::splat(0.5);

/// A point of a surface with its normals on the side that is seen; NaN where it has none.
pub(super) struct Lit<'a> {
    surface: &'a SurfaceInteraction<'a>,
    /// The colour of the surface.
    pub(super) color: Color,
    /// The normal to shade with.
    pub(super) normal: DVec3,
    position: DVec3,
    geometric: DVec3,
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

impl<'a> Lit<'a> {
    /// A hit as a lit point; or its colour, where no light changes that.
    fn new(surface: &'a SurfaceInteraction<'a>, flat: bool) -> Result<Self, Color> {
        let color = surface.color();
        if surface.is_unlit() {
            return Err(color);
        }
        let side = surface.side();
        let geometric = side * surface.normal();
        let normal = if flat {
            geometric
        } else {
            side * surface.shading_normal()
        };
        Ok(Self {
            surface,
            color,
            normal,
            position: surface.position(),
            geometric,
        })
    }

    /// The way back along the ray, of length one.
    pub(super) fn viewer(&self) -> DVec3 {
        -unit(self.surface.ray().direction)
    }

    /// The ray towards a light, up to where it comes from, and what is at its end. `None` where the light is on
    /// the other side.
    #[inline]
    fn incoming(&self, source: &Source) -> Option<(Ray, Incoming)> {
        let (arriving, towards) = source.at(self.position)?;
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
