//! Light for many points side by side; see [`geometry::rows`](crate::geometry::rows).

use crate::geometry::rows::{Points2, ROW, Scalars, Vectors};
use crate::geometry::{Color, DVec2, DVec3, Ray};
use crate::sampling::Draws;
use crate::scene::{Environment, Hemispheres, Light, LightSample, Sun};

/// Points to shade, and the random numbers of each.
pub(super) struct ShadingPoints {
    count: usize,
    pub(super) position: Vectors,
    draws: [Draws; ROW],
}

impl ShadingPoints {
    pub(super) const NONE: Self =
        Self { count: 0, position: Vectors::ZERO, draws: [Draws::new(0, 0); ROW] };

    /// Adds one to a row that is not full, and returns its number.
    #[inline]
    pub(super) fn push(&mut self, position: DVec3, draws: Draws) -> usize {
        let k = self.count;
        self.position.set(k, position);
        self.draws[k] = draws;
        self.count += 1;
        k
    }

    pub(super) fn is_full(&self) -> bool {
        self.count == ROW
    }

    /// The number of points. The minimum tells the compiler that they are at most [`ROW`].
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.count.min(ROW)
    }

    /// The random numbers of one point, from a stream.
    pub(super) fn draws(&self, k: usize, stream: u64) -> Draws {
        self.draws[k].split(stream)
    }

    /// Two random numbers for each point, from a stream or else from its own.
    #[inline(always)]
    pub(super) fn draw(&self, stream: Option<u64>) -> Points2 {
        let mut u = Points2::ZERO;
        for k in 0..self.len() {
            let mut draws = match stream {
                Some(stream) => self.draws[k].split(stream),
                None => self.draws[k],
            };
            u.set(k, draws.two());
        }
        u
    }

    /// A sample of a light for each point, with the random numbers of the light's stream.
    #[inline(always)]
    pub(super) fn draw_light<S: DrawnLight>(&self, light: &S, stream: u64) -> LightSamples {
        let u = self.draw(Some(stream));
        let mut samples = LightSamples::NONE;
        for k in 0..self.len() {
            let at = self.position.get(k);
            if let Some(sample) = light.sample(at, u.get(k)) {
                samples.set(k, &sample, at);
            }
        }
        samples
    }
}

/// A row of [`LightSample`], one for each point.
pub(super) struct LightSamples {
    pub(super) towards: Vectors,
    /// The `t_max` of a ray to the light.
    pub(super) end: Scalars,
    /// Black for no sample.
    pub(super) light: Vectors,
    /// Infinity for a light without a size.
    pub(super) pdf: Scalars,
}

impl LightSamples {
    pub(super) const NONE: Self = Self {
        towards: Vectors::ZERO,
        end: Scalars::all(0.0),
        light: Vectors::ZERO,
        pdf: Scalars::all(f64::INFINITY),
    };

    /// Sets the sample that was drawn for a point.
    #[inline(always)]
    pub(super) fn set(&mut self, k: usize, sample: &LightSample, at: DVec3) {
        self.towards.set(k, sample.towards);
        self.end.set(k, sample.ray_end(at));
        self.light.set(k, sample.light);
        self.pdf.set(k, sample.pdf.unwrap_or(f64::INFINITY));
    }
}

/// A row of directions, one for each point, with the `t_max` of a ray that way, and the light that
/// it brings if nothing blocks it; black for no ray.
pub(super) struct Arriving {
    pub(super) towards: Vectors,
    pub(super) end: Scalars,
    pub(super) light: Vectors,
}

impl Arriving {
    pub(super) const NONE: Self =
        Self { towards: Vectors::ZERO, end: Scalars::all(f64::INFINITY), light: Vectors::ZERO };

    /// The ray of a point.
    #[inline(always)]
    pub(super) fn ray(&self, k: usize, origin: DVec3) -> Ray {
        Ray::new(origin, self.towards.get(k)).up_to(self.end.get(k))
    }
}

/// A light to draw from.
pub(super) trait DrawnLight {
    /// See [`Light::sample`].
    fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample>;
}

impl DrawnLight for Sun {
    #[inline(always)]
    fn sample(&self, _at: DVec3, u: DVec2) -> Option<LightSample> {
        Some(Sun::sample(self, u))
    }
}

impl DrawnLight for Light {
    #[inline(always)]
    fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample> {
        Light::sample(self, at, u)
    }
}

/// Light from all around.
pub(super) trait Sky {
    /// See [`Environment::radiance`].
    fn radiance(&self, direction: DVec3) -> Color;
    /// See [`Environment::pdf`].
    fn pdf(&self, direction: DVec3) -> f64;
}

impl Sky for Hemispheres {
    #[inline(always)]
    fn radiance(&self, direction: DVec3) -> Color {
        Hemispheres::radiance(self, direction)
    }

    #[inline(always)]
    fn pdf(&self, _direction: DVec3) -> f64 {
        0.0
    }
}

impl Sky for Environment {
    #[inline(always)]
    fn radiance(&self, direction: DVec3) -> Color {
        Environment::radiance(self, direction)
    }

    #[inline(always)]
    fn pdf(&self, direction: DVec3) -> f64 {
        Environment::pdf(self, direction)
    }
}
