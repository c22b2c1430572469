//! How much of a ray is inside?

use super::sweep::{Met, Solids};
use super::{By, Rule};
use crate::error::Result;
use crate::geometry::{Ray, Rays, moderation};
use crate::memory;
use crate::scene::Scene;
use crate::watch::Watch;

/// The length of each ray inside the scene's objects, between its `t_min` and its `t_max`, in scene units; by all threads of the current
/// rayon pool. With [`By::Object`] each ray has one length for each object, with [`By::Union`] a stretch in several objects counts once.
///
/// 1. Find all crossings beyond `t_min`, also those beyond `t_max`.
/// 2. The ray starts inside a closed object if it has an odd number of crossings with it, and inside an open mesh if the winding number
///    says so.
/// 3. Each crossing leads in or out, in turn. Add up what is between, within the limits.
///
/// Of an open mesh the length is NaN where the crossings do not fit together: after the last one, a ray would still be inside. So it is
/// for a ray that starts inside and leaves through a hole. A ray that starts outside an object and does not cross it has the length 0
/// in it; so has every ray in a plane or a disc, and in everything one that is not [valid](Ray::is_valid).
///
/// ```
/// use firsthit::measure::{By, path_lengths};
/// use firsthit::{DVec3, Object, Ray, Scene, Sphere};
///
/// let ball = |radius| Sphere::new(DVec3::ZERO, radius).map(Object::new);
/// let scene = Scene::new(vec![ball(1.0)?, ball(2.0)?])?;
/// // Of any length: t is half the way.
/// let ray = Ray::new(DVec3::new(0.0, 0.0, 9.0), DVec3::new(0.0, 0.0, -2.0));
/// assert_eq!(path_lengths(&scene, &[ray], By::Object, &())?, [2.0, 4.0]);
/// assert_eq!(path_lengths(&scene, &[ray], By::Union, &())?, [4.0]);
/// assert_eq!(path_lengths(&scene, &[ray.up_to(4.5)], By::Union, &())?, [2.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Limit`](crate::Error::Limit) when the lengths do not fit into memory,
/// [`Error::Interrupted`](crate::Error::Interrupted) when `watch` stops it.
pub fn path_lengths<R: Rays>(
    scene: &Scene,
    rays: &R,
    by: By,
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    let solids = Solids::new(scene)?;
    let count = rays.len().saturating_mul(by.width(scene));
    let mut lengths = memory::filled(count, 0.0)?;
    let walk = || Walk::new(scene.objects().len());
    solids.sweep(
        rays,
        (by, &mut lengths),
        watch,
        walk,
        |walk, ray, met, row| {
            if !ray.is_valid() {
                return Ok(());
            }
            let depth = walk.start(&solids, ray, met, watch)?;
            match by {
                By::Object => walk.add_each(&solids, &Way::new(ray), met, row),
                By::Union => walk.add_union(&solids, &Way::new(ray), met, (depth, &mut row[0])),
            }
            Ok(())
        },
    )?;
    Ok(lengths)
}

/// A ray on its way through the objects.
struct Walk {
    /// Which objects it is in. In none between two rays.
    is_in: Vec<bool>,
    /// Where it entered those.
    since: Vec<f64>,
}

impl Walk {
    fn new(objects: usize) -> Result<Self> {
        Ok(Self {
            is_in: memory::filled(objects, false)?,
            since: memory::filled(objects, 0.0)?,
        })
    }

    /// Finds out in which objects a ray starts; returns in how many.
    fn start(
        &mut self,
        solids: &Solids<'_>,
        ray: &Ray,
        met: &Met<'_>,
        watch: &dyn Watch,
    ) -> Result<usize> {
        let mut depth = 0;
        for object in met.objects() {
            if solids.rules[object] == Rule::Parity {
                depth = self.turn(object, depth);
                self.since[object] = ray.t_min;
            }
        }
        for &object in &solids.open {
            // Infinitely far away is outside.
            let is_in =
                ray.t_min.is_finite() && solids.is_in_open(object, ray.at(ray.t_min), watch)?;
            if is_in {
                depth = self.turn(object, depth);
                self.since[object] = ray.t_min;
            }
        }
        Ok(depth)
    }

    /// Goes in or out of an object; returns in how many it is then.
    fn turn(&mut self, object: usize, depth: usize) -> usize {
        let is_in = &mut self.is_in[object];
        *is_in = !*is_in;
        if *is_in { depth + 1 } else { depth - 1 }
    }

    /// Adds the length in each object to its own sum.
    fn add_each(&mut self, solids: &Solids<'_>, way: &Way, met: &Met<'_>, sums: &mut [f64]) {
        for (t, object) in met.crossings() {
            if solids.rules[object] == Rule::Nothing {
                continue;
            }
            if self.is_in[object] {
                sums[object] += way.length(self.since[object], t);
            }
            self.since[object] = t;
            self.is_in[object] ^= true;
        }
        for &object in &solids.open {
            if std::mem::take(&mut self.is_in[object]) {
                sums[object] = f64::NAN;
            }
        }
    }

    /// Adds the length in any object; the ray starts in `depth` of them.
    fn add_union(
        &mut self,
        solids: &Solids<'_>,
        way: &Way,
        met: &Met<'_>,
        (mut depth, sum): (usize, &mut f64),
    ) {
        let mut since = way.t_min;
        for (t, object) in met.crossings() {
            if solids.rules[object] == Rule::Nothing {
                continue;
            }
            let before = depth;
            depth = self.turn(object, depth);
            if before == 0 {
                since = t;
            } else if depth == 0 {
                *sum += way.length(since, t);
            }
        }
        for &object in &solids.open {
            if std::mem::take(&mut self.is_in[object]) {
                *sum = f64::NAN;
            }
        }
    }
}

/// What makes lengths of a ray's parameters.
struct Way {
    t_min: f64,
    t_max: f64,
    /// The direction's length, times a power of two that brings its square into range.
    length: f64,
    scale: f64,
}

impl Way {
    fn new(ray: &Ray) -> Self {
        let scale = moderation(ray.direction);
        Self {
            t_min: ray.t_min,
            t_max: ray.t_max,
            length: (scale * ray.direction).length(),
            scale,
        }
    }

    /// The length of what lies between two parameters and before the ray's end.
    fn length(&self, enter: f64, exit: f64) -> f64 {
        let stretch = exit.min(self.t_max) - enter;
        stretch.max(0.0) / self.scale * self.length
    }
}
