//! A shader at work.

use super::{Ground, Points, Recipe, Samples, Shade, Shader, blend};
use crate::geometry::{Color, DVec3, Digest, Hit, Ray};
use crate::sampling::Draws;
use crate::scene::{Background, Environment, Scene, compute_geometry};
use crate::shoot::Engine;

/// A [`Shader`] at work: with the scene that it looks at, and what misses see.
///
/// ```
/// use firsthit::{Background, Color, DVec3, Hit, Scene, Shade, Shader, Shading};
///
/// let scene = Scene::new(vec![])?;
/// let white = Background::Uniform(Color::ONE);
/// let shading = Shading { background: white, ..Shader::default().on(&scene) };
/// let color = shading.shade(f64::INFINITY, DVec3::ZERO, DVec3::X, &Hit::MISS);
/// assert_eq!(color, Color::ONE);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Shading<'a> {
    /// The scene that was hit.
    pub scene: &'a Scene,
    /// The shader that colours hits.
    pub shader: Shader,
    /// The direction upwards for the viewer, of any length but zero: the camera's, or the scene's.
    pub upwards: DVec3,
    /// The background of misses, unless that is the scene's environment.
    pub background: Background,
    /// Whether misses see the scene's environment where cameras see it; they see the background
    /// otherwise.
    pub sees_environment: bool,
    /// The ground that shadows fall on.
    pub ground: Option<Ground>,
    /// The engine for the shader's own rays, such as those towards lights.
    pub engine: &'a dyn Engine,
}

impl Shading<'_> {
    /// The colour of a miss.
    pub(super) fn seen_behind(&self, direction: DVec3) -> Color {
        match self.environment_behind() {
            Some(environment) => environment.radiance(direction),
            None => self.background.color(direction),
        }
    }

    /// The environment, where misses see it.
    fn environment_behind(&self) -> Option<&Environment> {
        (self.scene.environment())
            .filter(|environment| self.sees_environment && environment.is_seen)
    }

    /// Colours of rays by what they met, as if that were opaque, and of misses.
    pub(super) fn shade_hits(
        &self,
        (rays, hits, draws): (&[Ray], &[Hit], &[Draws]),
        colors: &mut [Color],
        coverage: &mut [f64],
    ) {
        let mut met = Vec::with_capacity(rays.len());
        let mut points = Points {
            surfaces: Vec::with_capacity(rays.len()),
            draws: Vec::with_capacity(rays.len()),
        };
        for (k, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            if let Some(surface) = self.scene.interaction(ray, hit) {
                met.push(k);
                points.surfaces.push(surface);
                points.draws.push(draws[k]);
            } else {
                colors[k] = self.seen_behind(ray.direction);
            }
        }
        if self.shader.takes_geometry() {
            compute_geometry(self.engine.instruction_set(), &points.surfaces);
        }
        let mut found = vec![Color::ZERO; met.len()];
        let mut covered = vec![1.0; met.len()];
        (self.shader).color(self, &points, &mut found, &mut covered);
        for ((k, color), covered) in met.into_iter().zip(found).zip(covered) {
            colors[k] = color;
            coverage[k] = covered;
        }
        if let Some(ground) = &self.ground {
            ground.shade(self, (rays, hits, draws), colors, coverage);
        }
    }
}

impl Shade for Shading<'_> {
    fn is_transparent(&self) -> bool {
        self.background == Background::Transparent && self.environment_behind().is_none()
    }

    fn is_random(&self) -> bool {
        self.shader.is_random() || self.ground.is_some()
    }

    fn has_negative_noise(&self) -> bool {
        self.ground.is_some()
    }

    fn recipe(&self) -> Option<Recipe> {
        let mut digest = Digest::default();
        digest.word("firsthit shading 5");
        digest.word(self.shader.name());
        for (_, value) in self.shader.settings() {
            value.digest(&mut digest);
        }
        self.scene.digest_light(&mut digest);
        self.background.digest(&mut digest);
        digest.vector(self.upwards);
        digest.vector(self.scene.up());
        digest.word(match (self.scene.environment(), self.environment_behind()) {
            (None, _) => "no environment",
            (_, Some(_)) => "seen",
            (_, None) => "unseen",
        });
        if let Some(Ground { point, up }) = self.ground {
            digest.word("ground");
            digest.vector(point);
            digest.vector(up);
        }
        self.scene.digest_coloring(&mut digest);
        Some(Recipe {
            shader: self.shader.name(),
            settings: self.shader.settings(),
            digest: digest.name(),
        })
    }

    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color {
        let hit = Hit { t, ..*o };
        let samples = Samples {
            rays: &[Ray::new(p, u_r)],
            hits: &[hit],
            pixels: &[0],
            sample: 0,
            cull: None,
        };
        let mut color = [Color::ZERO];
        self.shade_all(&samples, &mut color, &mut [0.0]);
        color[0]
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], coverage: &mut [f64]) {
        let draws: Vec<Draws> = (0..samples.rays.len()).map(|k| samples.draws(k)).collect();
        self.shade_hits((samples.rays, samples.hits, &draws), colors, coverage);
        if self.scene.has_translucent() && !self.shader.sees_through() {
            blend::compose(self, samples, colors, coverage);
        }
    }
}
