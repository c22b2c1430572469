//! Direct light with hard shadows: for each point and each light, one shadow ray tells whether the
//! point is lit. The shader says how a surface reflects light. Points go row by row, as in
//! `matte.rs`.

use super::rows::Arriving;
use super::shadow::ShadowRays;
use super::{Points, Shading, seen_normal};
use crate::geometry::rows::{ROW, Vectors};
use crate::geometry::{Color, DVec2, DVec3, unit};
use crate::scene::{LightSample, PreparedLight, SurfaceInteraction, terminator_factor};
use crate::simd::{self, Kernel, Lanes};

/// The reflection model of a surface. Functions that are not inlined are not compiled to lanes.
pub(super) trait Reflection {
    /// The colour of the surface without any of the lights.
    fn ambient(&self, point: &Lit) -> Color;

    /// The reflected light from one direction.
    fn reflected(&self, point: &Lit, light: &Incoming) -> Color;

    /// The colour that is seen, given the sum of the others.
    fn seen(&self, _point: &Lit, sum: Color) -> Color {
        sum
    }
}

/// The use of lights by shaders with hard shadows.
#[derive(Debug, Clone, Copy)]
pub(super) struct HardLighting {
    /// Whether faces have their own normals, in place of smooth ones.
    pub(super) flat: bool,
    /// Whether things cast shadows.
    pub(super) shadows: bool,
}

impl HardLighting {
    /// Colours all points.
    pub(super) fn shade(
        self,
        reflection: &impl Reflection,
        shading: &Shading<'_>,
        points: &Points<'_>,
        colors: &mut [Color],
    ) {
        let set = shading.engine.instruction_set();
        let mut sums = vec![Color::ZERO; points.surfaces.len()];
        let mut rows: Vec<LitRow> = Vec::with_capacity(sums.len().div_ceil(ROW));
        for (k, surface) in points.surfaces.iter().enumerate() {
            if surface.is_unlit() {
                colors[k] = surface.color();
                continue;
            }
            let point = Lit::new(surface, self.flat);
            sums[k] = reflection.ambient(&point);
            if rows.last().is_none_or(|row| row.count == ROW) {
                rows.push(LitRow::EMPTY);
            }
            if let Some(row) = rows.last_mut() {
                row.push(k, &point);
            }
        }
        let mut rays = ShadowRays::with_capacity(sums.len());
        for light in shading.scene.lights() {
            let light = light.prepared();
            let everywhere = light.everywhere(MIDDLE).map(Everywhere::new);
            for row in &rows {
                let arriving = match &everywhere {
                    Some(source) => simd::run_here(set, Reflect(row, source, reflection)),
                    None => simd::run_here(set, Reflect(row, &light, reflection)),
                };
                row.push_rays(&arriving, &points.surfaces, &mut rays);
            }
            rays.add_to(&mut sums, shading, self.shadows);
        }
        for row in &rows {
            for (k, &point) in row.numbers[..row.count].iter().enumerate() {
                colors[point] = reflection.seen(&row.get(k), sums[point]);
            }
        }
    }
}

/// A source of light, which counts as its middle where it has a size.
trait IncidentLight {
    /// The source's light at a point, and the direction towards it.
    fn at(&self, point: DVec3) -> Option<(LightSample, DVec3)>;
}

impl IncidentLight for PreparedLight {
    #[inline(always)]
    fn at(&self, point: DVec3) -> Option<(LightSample, DVec3)> {
        let sample = self.sample(point, MIDDLE)?;
        Some((sample, unit(sample.towards)))
    }
}

/// A light that is the same for all points.
struct Everywhere(LightSample, DVec3);

impl Everywhere {
    fn new(sample: LightSample) -> Self {
        Self(sample, unit(sample.towards))
    }
}

impl IncidentLight for Everywhere {
    #[inline(always)]
    fn at(&self, _point: DVec3) -> Option<(LightSample, DVec3)> {
        Some((self.0, self.1))
    }
}

/// The middle of a light.
const MIDDLE: DVec2 = DVec2::splat(0.5);

/// A point of a surface with its normals on the side that is seen; NaN where it has none.
pub(super) struct Lit {
    /// The colour of the surface.
    pub(super) color: Color,
    /// The normal to shade with.
    pub(super) normal: DVec3,
    position: DVec3,
    geometric: DVec3,
    /// The direction of the ray that sees the point.
    direction: DVec3,
}

/// Light at a point, from one direction.
pub(super) struct Incoming {
    /// The direction that it comes from, of length one.
    pub(super) towards: DVec3,
    /// The cosine to the normal.
    pub(super) cosine: f64,
    /// The factor on light near the shadow terminator, from 0 to 1; see [`terminator_factor`].
    pub(super) share: f64,
    /// The irradiance over pi of a surface that faces the light.
    pub(super) light: Color,
}

impl Lit {
    #[inline]
    fn new(surface: &SurfaceInteraction<'_>, flat: bool) -> Self {
        Self {
            color: surface.color(),
            normal: seen_normal(surface, flat),
            position: surface.position(),
            geometric: seen_normal(surface, true),
            direction: surface.ray().direction,
        }
    }

    /// The way back along the ray, of length one.
    #[inline]
    pub(super) fn viewer(&self) -> DVec3 {
        -unit(self.direction)
    }

    /// Light of a sample at this point, and whether it comes from the side that is seen. `towards`
    /// is its direction, of length one.
    #[inline(always)]
    fn incoming(&self, sample: &LightSample, towards: DVec3) -> (Incoming, bool) {
        let cosine = towards.dot(self.normal);
        let flat = sample.towards.dot(self.geometric);
        let between = self.normal.dot(self.geometric);
        let share = if self.normal == self.geometric {
            1.0
        } else {
            terminator_factor(cosine, towards.dot(self.geometric), between)
        };
        let incoming = Incoming { towards, cosine, share, light: sample.light };
        // Not where a number is NaN: the point is where the light is, or the triangle has no area.
        (incoming, cosine > 0.0 && flat > 0.0)
    }
}

/// Points side by side.
struct LitRow {
    count: usize,
    /// The number of each point among all.
    numbers: [usize; ROW],
    color: Vectors,
    normal: Vectors,
    position: Vectors,
    geometric: Vectors,
    direction: Vectors,
}

impl LitRow {
    const EMPTY: Self = Self {
        count: 0,
        numbers: [0; ROW],
        color: Vectors::ZERO,
        normal: Vectors::ZERO,
        position: Vectors::ZERO,
        geometric: Vectors::ZERO,
        direction: Vectors::ZERO,
    };

    #[inline]
    fn push(&mut self, number: usize, point: &Lit) {
        let k = self.count;
        self.numbers[k] = number;
        self.color.set(k, point.color);
        self.normal.set(k, point.normal);
        self.position.set(k, point.position);
        self.geometric.set(k, point.geometric);
        self.direction.set(k, point.direction);
        self.count += 1;
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Lit {
        Lit {
            color: self.color.get(k),
            normal: self.normal.get(k),
            position: self.position.get(k),
            geometric: self.geometric.get(k),
            direction: self.direction.get(k),
        }
    }

    fn push_rays(
        &self,
        arriving: &Arriving,
        surfaces: &[SurfaceInteraction<'_>],
        rays: &mut ShadowRays,
    ) {
        for (k, &point) in self.numbers[..self.count].iter().enumerate() {
            let light = arriving.light.get(k);
            if light != Color::ZERO {
                let ray = arriving.ray(k, self.position.get(k));
                rays.push((ray, surfaces[point].departure()), point, light);
            }
        }
    }
}

/// Computes the light that the surfaces at some points reflect.
struct Reflect<'a, S, R>(&'a LitRow, &'a S, &'a R);

impl<S: IncidentLight, R: Reflection> Kernel for Reflect<'_, S, R> {
    type Output = Arriving;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Arriving {
        let Self(row, source, reflection) = self;
        let mut arriving = Arriving::NONE;
        for k in 0..row.count.min(ROW) {
            let point = row.get(k);
            let Some((sample, towards)) = source.at(point.position) else {
                continue;
            };
            let (incoming, is_lit) = point.incoming(&sample, towards);
            let light = if is_lit { reflection.reflected(&point, &incoming) } else { Color::ZERO };
            arriving.towards.set(k, sample.towards);
            arriving.end.set(k, sample.ray_end(point.position));
            arriving.light.set(k, light);
        }
        arriving
    }
}
