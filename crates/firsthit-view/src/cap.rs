//! The faces that a section plane cuts through solids.
//!
//! A ray that begins on the plane begins inside an object if it crosses that object's closed surface an odd number of times (see
//! [`firsthit::measure`]). It then sees the cut face, which has the object's colour and stripes.

use firsthit::geometry::{DVec3, Hit, Ray};
use firsthit::measure::{Rule, rules};
use firsthit::shade::{Recipe, Samples};
use firsthit::shoot::{All, trace};
use firsthit::{Color, Result, Scene, Shade};

use crate::cut::CutPlane;

/// The light that a cut face has from all sides; the rest of its light comes from the camera.
const AMBIENT: f64 = 0.25;
/// What the darker stripes are multiplied by.
const STRIPE: f64 = 0.8;
/// How many stripes a scene's diagonal is long, dark ones and light ones.
const STRIPES: f64 = 80.0;

/// A shader, and the cut faces before it.
pub(crate) struct CappedShade<'a> {
    shade: &'a dyn Shade,
    scene: &'a Scene,
    plane: CutPlane,
    rules: Vec<Rule>,
    /// Across the stripes, so long that each is one wide.
    across: DVec3,
}

impl<'a> CappedShade<'a> {
    /// # Errors
    ///
    /// Those of [`rules`].
    pub(crate) fn new(shade: &'a dyn Shade, scene: &'a Scene, plane: CutPlane) -> Result<Self> {
        let [right, upwards] = plane.axes();
        let bounds = scene.bounds();
        let diagonal = (bounds.high - bounds.low).length();
        Ok(Self {
            shade,
            scene,
            plane,
            rules: rules(scene)?,
            across: (right + upwards) * (STRIPES / diagonal),
        })
    }

    /// The colour of the face that is cut where the ray begins, if one is.
    fn face(&self, ray: &Ray, crossed: impl Iterator<Item = i32>) -> Option<Color> {
        let object = odd(crossed.filter(|&object| {
            usize::try_from(object).is_ok_and(|k| self.rules.get(k) == Some(&Rule::Parity))
        }))?;
        let object = self.scene.objects().get(usize::try_from(object).ok()?)?;
        let direction = ray.direction;
        let cosine = self.plane.normal().dot(direction).abs() / direction.length();
        let place = self.across.dot(ray.at(ray.t_min));
        let is_dark = place.floor().rem_euclid(2.0) == 1.0;
        let stripe = if is_dark { STRIPE } else { 1.0 };
        Some(stripe * (AMBIENT + (1.0 - AMBIENT) * cosine) * object.color())
    }
}

/// The first object that is there an odd number of times.
fn odd(objects: impl Iterator<Item = i32>) -> Option<i32> {
    let mut objects: Vec<i32> = objects.collect();
    objects.sort_unstable();
    let runs = objects.chunk_by(|a, b| a == b);
    runs.filter(|run| run.len() % 2 == 1)
        .map(|run| run[0])
        .next()
}

impl Shade for CappedShade<'_> {
    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color {
        self.shade.shade(t, p, u_r, o)
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], coverage: &mut [f64]) {
        self.shade.shade_all(samples, colors, coverage);
        let seen = samples.rays.iter().zip(samples.hits).enumerate();
        let begun = seen.filter(|(_, (ray, hit))| ray.t_min > 0.0 && !hit.is_miss());
        let (numbers, rays): (Vec<usize>, Vec<Ray>) =
            begun.map(|(number, (ray, _))| (number, *ray)).unzip();
        // Without memory for what a few hundred rays meet, the inside is seen.
        let Ok(all) = trace(self.scene, &rays[..], All::default(), &()) else {
            return;
        };
        for (k, (&number, ray)) in numbers.iter().zip(&rays).enumerate() {
            let crossed = &all.hits.object[all.offsets[k]..all.offsets[k + 1]];
            if let Some(color) = self.face(ray, crossed.iter().copied()) {
                (colors[number], coverage[number]) = (color, 1.0);
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

    fn recipe(&self) -> Option<Recipe> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_that_is_crossed_an_odd_number_of_times_is_one_to_be_inside_of() {
        assert_eq!(odd([].into_iter()), None);
        assert_eq!(odd([4, 2, 4].into_iter()), Some(2));
        assert_eq!(odd([4, 4].into_iter()), None);
        assert_eq!(odd([7, 4, 4, 4].into_iter()), Some(4));
    }
}
