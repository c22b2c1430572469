//! The faces that a section plane cuts through solids.
//!
//! Of the objects that a ray begins inside of on the plane, it sees the cut face of the innermost:
//! the one that it leaves first (see [`firsthit::measure::innermost`]).

use std::sync::Mutex;

use firsthit::geometry::{DVec3, Hit, Ray};
use firsthit::measure::innermost;
use firsthit::shade::Samples;
use firsthit::{Color, Error, Result, Scene, Shade};

use crate::cut::CutPlane;
use crate::viewer::lock;

/// The light that a cut face has from all sides; the rest of its light comes from the camera.
const AMBIENT: f64 = 0.25;
/// The factor on the darker stripes.
const STRIPE: f64 = 0.8;
/// The number of stripes along a scene's diagonal, dark ones and light ones.
const STRIPES: f64 = 80.0;

/// A shader, and the cut faces before it, with stripes.
pub(crate) struct CappedShade<'a> {
    shade: &'a dyn Shade,
    scene: &'a Scene,
    plane: CutPlane,
    /// The colour of all cut faces; `None`: each has its object's.
    color: Option<Color>,
    /// Across the stripes, so long that each is one wide.
    across: DVec3,
    /// The error behind missing cut faces, if any are.
    failure: Mutex<Option<Error>>,
}

impl<'a> CappedShade<'a> {
    pub(crate) fn new(
        shade: &'a dyn Shade,
        scene: &'a Scene,
        (plane, color): (CutPlane, Option<Color>),
    ) -> Self {
        let [right, upwards] = plane.axes();
        let bounds = scene.bounds();
        let diagonal = (bounds.high - bounds.low).length();
        Self {
            shade,
            scene,
            plane,
            color,
            across: (right + upwards) * (STRIPES / diagonal),
            failure: Mutex::new(None),
        }
    }

    /// # Errors
    ///
    /// The errors of [`innermost`], where cut faces are missing since it failed: a shader cannot
    /// say so by itself.
    pub(crate) fn check(&self) -> Result<()> {
        lock(&self.failure).take().map_or(Ok(()), Err)
    }

    /// The colour of an object's cut face where a ray begins.
    fn color(&self, object: usize, ray: &Ray) -> Color {
        let direction = ray.direction;
        let cosine = self.plane.normal().dot(direction).abs() / direction.length();
        let place = self.across.dot(ray.at(ray.t_min));
        let is_dark = place.floor().rem_euclid(2.0) == 1.0;
        let stripe = if is_dark { STRIPE } else { 1.0 };
        let light = stripe * (AMBIENT + (1.0 - AMBIENT) * cosine);
        light * self.color.unwrap_or_else(|| self.scene.objects()[object].color())
    }
}

impl Shade for CappedShade<'_> {
    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color {
        self.shade.shade(t, p, u_r, o)
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], coverage: &mut [f64]) {
        self.shade.shade_all(samples, colors, coverage);
        let seen = samples.rays.iter().zip(samples.hits).enumerate();
        let begun = seen.filter(|(_, (ray, hit))| CutPlane::is_begin(ray) && !hit.is_miss());
        let (numbers, rays): (Vec<usize>, Vec<Ray>) =
            begun.map(|(number, (ray, _))| (number, *ray)).unzip();
        let faces = match innermost(self.scene, &rays, &()) {
            Ok(faces) => faces,
            Err(error) => {
                *lock(&self.failure) = Some(error);
                return;
            }
        };
        for ((number, ray), face) in numbers.into_iter().zip(&rays).zip(faces) {
            if let Some(object) = face {
                (colors[number], coverage[number]) = (self.color(object, ray), 1.0);
            }
        }
    }

    fn is_transparent(&self) -> bool {
        self.shade.is_transparent()
    }

    fn is_random(&self) -> bool {
        self.shade.is_random()
    }

    fn has_negative_noise(&self) -> bool {
        self.shade.has_negative_noise()
    }
}
