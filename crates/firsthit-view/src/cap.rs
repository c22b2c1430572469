//! The faces that a section plane cuts through solids.
//!
//! A ray that begins on the plane begins inside an object if it crosses that object's closed surface an odd number of times (see
//! [`firsthit::measure`]). Of the objects that it begins inside of it sees the cut face of the innermost: the one that it leaves first.

use std::sync::Mutex;

use firsthit::geometry::{DVec3, Hit, Ray};
use firsthit::measure::{Rule, rules};
use firsthit::shade::Samples;
use firsthit::shoot::{All, trace};
use firsthit::{Color, Error, Result, Scene, Shade};

use crate::cut::CutPlane;
use crate::viewer::lock;

/// The light that a cut face has from all sides; the rest of its light comes from the camera.
const AMBIENT: f64 = 0.25;
/// What the darker stripes are multiplied by.
const STRIPE: f64 = 0.8;
/// How many stripes a scene's diagonal is long, dark ones and light ones.
const STRIPES: f64 = 80.0;

/// A scene that is cut by a plane, and which of its objects are solid.
pub(crate) struct CutSolids<'a> {
    scene: &'a Scene,
    rules: Vec<Rule>,
}

impl<'a> CutSolids<'a> {
    /// # Errors
    ///
    /// Those of [`rules`].
    pub(crate) fn new(scene: &'a Scene) -> Result<Self> {
        let rules = rules(scene)?;
        Ok(Self { scene, rules })
    }

    /// For each of some rays that begin on the plane, the object whose cut face it sees, if it sees one.
    ///
    /// # Errors
    ///
    /// Those of [`trace`].
    pub(crate) fn faces(&self, rays: &[Ray]) -> Result<Vec<Option<usize>>> {
        let all = trace(self.scene, rays, All::default(), &())?;
        let ends = all.offsets.windows(2);
        Ok(ends
            .map(|ends| self.innermost(&all.hits.object[ends[0]..ends[1]]))
            .collect())
    }

    /// The innermost solid around a ray's start, from the objects that the ray crosses, in their order.
    fn innermost(&self, crossed: &[i32]) -> Option<usize> {
        let object = first_odd(crossed, |object| {
            let number = usize::try_from(object).ok();
            number.and_then(|number| self.rules.get(number)) == Some(&Rule::Parity)
        })?;
        usize::try_from(object).ok()
    }
}

/// The first number of a list that is wanted and occurs an odd number of times.
fn first_odd(list: &[i32], is_wanted: impl Fn(i32) -> bool) -> Option<i32> {
    let mut sorted: Vec<i32> = list.iter().copied().filter(|&one| is_wanted(one)).collect();
    sorted.sort_unstable();
    let runs = sorted.chunk_by(|a, b| a == b);
    let odd: Vec<i32> = runs
        .filter(|run| run.len() % 2 == 1)
        .map(|run| run[0])
        .collect();
    list.iter()
        .copied()
        .find(|one| odd.binary_search(one).is_ok())
}

/// A shader, and the cut faces before it: each has its object's colour, and stripes.
pub(crate) struct CappedShade<'a> {
    shade: &'a dyn Shade,
    solids: CutSolids<'a>,
    plane: CutPlane,
    /// Across the stripes, so long that each is one wide.
    across: DVec3,
    /// Why some cut faces are missing, if any are.
    failure: Mutex<Option<Error>>,
}

impl<'a> CappedShade<'a> {
    /// # Errors
    ///
    /// Those of [`CutSolids::new`].
    pub(crate) fn new(shade: &'a dyn Shade, scene: &'a Scene, plane: CutPlane) -> Result<Self> {
        let [right, upwards] = plane.axes();
        let bounds = scene.bounds();
        let diagonal = (bounds.high - bounds.low).length();
        Ok(Self {
            shade,
            solids: CutSolids::new(scene)?,
            plane,
            across: (right + upwards) * (STRIPES / diagonal),
            failure: Mutex::new(None),
        })
    }

    /// # Errors
    ///
    /// Those of [`trace`], where cut faces are missing since it failed: a shader cannot say so by itself.
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
        light * self.solids.scene.objects()[object].color()
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
        let faces = match self.solids.faces(&rays) {
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

#[cfg(test)]
mod tests {
    use super::first_odd;

    #[test]
    fn an_object_that_is_crossed_an_odd_number_of_times_is_one_to_be_inside_of() {
        let of = |list: &[i32]| first_odd(list, |object| object != 9);
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[4, 2, 4]), Some(2));
        assert_eq!(of(&[4, 4]), None);
        assert_eq!(of(&[9, 7, 4, 4, 4]), Some(7), "the innermost");
        assert_eq!(of(&[4, 7, 9, 7, 7]), Some(4));
    }
}
