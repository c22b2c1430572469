//! Measures the length of rays inside of objects.

use crate::error::Result;
use crate::geometry::{Ray, Rays, moderation};
use crate::memory;
use crate::scene::Scene;
use crate::shoot::Cpu;
use crate::solid::{FillRule, Grouping, Met, Rule, Solids};
use crate::watch::Watch;

/// The length of each ray inside the scene's objects, between its `t_min` and its `t_max`, in scene
/// units; by all threads of the current rayon pool. With [`Grouping::Object`] each ray has one
/// length for each object, with [`Grouping::Union`] a stretch in several objects counts once.
///
/// 1. Find all crossings beyond `t_min`, also those beyond `t_max`.
/// 2. How often a closed object goes around the start follows from them, and whether the ray starts
///    inside an open mesh from its winding number there.
/// 3. Each crossing takes the ray into an object or out of it, once more or less around. Add up
///    what is inside, within the limits.
///
/// Of an open mesh the length is NaN where the crossings do not fit together: after the last one, a
/// ray would still be inside. So it is for a ray that starts inside and leaves through a hole. A
/// ray that starts outside an object and does not cross it has the length 0 in it; so has every ray
/// in a plane or a disc, and in everything one that is not [valid](Ray::is_valid).
///
/// ```
/// use firsthit::measure::{Grouping, path_lengths};
/// use firsthit::{DVec3, Object, Ray, Scene, Sphere};
///
/// let ball = |radius| Sphere::new(DVec3::ZERO, radius).map(Object::new);
/// let scene = Scene::new(vec![ball(1.0)?, ball(2.0)?])?;
/// // Of any length: t is half the way.
/// let ray = Ray::new(DVec3::new(0.0, 0.0, 9.0), DVec3::new(0.0, 0.0, -2.0));
/// assert_eq!(path_lengths(&scene, &[ray], Grouping::Object, &())?, [2.0, 4.0]);
/// assert_eq!(path_lengths(&scene, &[ray], Grouping::Union, &())?, [4.0]);
/// assert_eq!(path_lengths(&scene, &[ray.up_to(4.5)], Grouping::Union, &())?, [2.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Limit`](crate::error::Error::Limit) when the lengths do not fit into memory,
/// [`Error::Interrupted`](crate::error::Error::Interrupted) when `watch` stops it.
pub fn path_lengths<R: Rays>(
    scene: &Scene,
    rays: &R,
    by: Grouping,
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    path_lengths_with(FillRule::default(), scene, rays, by, watch)
}

/// [`path_lengths`] by a rule of the caller's choice.
///
/// # Errors
///
/// The errors of [`path_lengths`].
pub fn path_lengths_with<R: Rays>(
    rule: FillRule,
    scene: &Scene,
    rays: &R,
    by: Grouping,
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    let solids = Solids::new(scene, rule)?;
    let count = rays.len().saturating_mul(by.width(scene));
    let mut lengths = memory::filled(count, 0.0)?;
    let walk = || Walk::new(scene.objects().len());
    solids.sweep(
        (&Cpu::default(), rays),
        (by, &mut lengths),
        watch,
        walk,
        |walk, ray, met, row| {
            if !ray.is_valid() {
                return Ok(());
            }
            let depth = walk.start(&solids, ray, met, watch)?;
            match by {
                Grouping::Object => walk.add_each(&solids, (ray, &RayLength::new(ray)), met, row),
                Grouping::Union => {
                    walk.add_union(&solids, (ray, &RayLength::new(ray)), met, (depth, &mut row[0]));
                }
            }
            Ok(())
        },
    )?;
    Ok(lengths)
}

/// A ray on its way through the objects.
struct Walk {
    /// The winding number of each object around the place; of an open one, 1 where it is inside.
    /// Zero for all between two rays.
    turns: Vec<i32>,
    /// The parameter at which the ray entered each object that it is in.
    since: Vec<f64>,
}

impl Walk {
    fn new(objects: usize) -> Result<Self> {
        Ok(Self { turns: memory::filled(objects, 0)?, since: memory::filled(objects, 0.0)? })
    }

    /// Finds out in which objects a ray starts; returns in how many.
    fn start(
        &mut self,
        solids: &Solids<'_>,
        ray: &Ray,
        met: &Met<'_>,
        watch: &dyn Watch,
    ) -> Result<usize> {
        let mut depth = solids.wind(ray, met, &mut self.turns);
        for object in met.objects() {
            self.since[object] = ray.t_min;
        }
        for &object in &solids.open {
            // Infinitely far away is outside.
            let is_in =
                ray.t_min.is_finite() && solids.is_in_open(object, ray.at(ray.t_min), watch)?;
            if is_in {
                self.turns[object] = 1;
                depth += 1;
            }
            self.since[object] = ray.t_min;
        }
        Ok(depth)
    }

    /// Adds the length in each object to its own sum.
    fn add_each(
        &mut self,
        solids: &Solids<'_>,
        (ray, lengths): (&Ray, &RayLength),
        met: &Met<'_>,
        sums: &mut [f64],
    ) {
        for crossed in met.crossings() {
            let object = crossed.object;
            if solids.rules[object] == Rule::Nothing {
                continue;
            }
            let before = self.turns[object];
            let behind = solids.behind(ray, crossed, before);
            self.turns[object] = behind;
            if before == 0 {
                self.since[object] = crossed.t;
            } else if behind == 0 {
                sums[object] += lengths.length(self.since[object], crossed.t);
            }
        }
        for &object in &solids.open {
            if std::mem::take(&mut self.turns[object]) != 0 {
                sums[object] = f64::NAN;
            }
        }
    }

    /// Adds the length in any object; the ray starts in `depth` of them.
    fn add_union(
        &mut self,
        solids: &Solids<'_>,
        (ray, lengths): (&Ray, &RayLength),
        met: &Met<'_>,
        (mut depth, sum): (usize, &mut f64),
    ) {
        let mut since = lengths.t_min;
        for crossed in met.crossings() {
            if solids.rules[crossed.object] == Rule::Nothing {
                continue;
            }
            let before = self.turns[crossed.object];
            let behind = solids.behind(ray, crossed, before);
            self.turns[crossed.object] = behind;
            if before == 0 {
                if depth == 0 {
                    since = crossed.t;
                }
                depth += 1;
            } else if behind == 0 {
                depth -= 1;
                if depth == 0 {
                    *sum += lengths.length(since, crossed.t);
                }
            }
        }
        for &object in &solids.open {
            if std::mem::take(&mut self.turns[object]) != 0 {
                *sum = f64::NAN;
            }
        }
    }
}

/// The conversion from a ray's parameters to lengths.
struct RayLength {
    t_min: f64,
    t_max: f64,
    /// The direction's length, times a power of two that brings its square into range.
    length: f64,
    scale: f64,
}

impl RayLength {
    fn new(ray: &Ray) -> Self {
        let scale = moderation(ray.direction);
        Self { t_min: ray.t_min, t_max: ray.t_max, length: (scale * ray.direction).length(), scale }
    }

    /// The length of what lies between two parameters and before the ray's end.
    fn length(&self, enter: f64, exit: f64) -> f64 {
        let stretch = exit.min(self.t_max) - enter;
        stretch.max(0.0) / self.scale * self.length
    }
}
