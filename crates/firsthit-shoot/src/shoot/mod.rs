//! Rays to hits: what does this ray meet first, does it meet anything, and how often?
//!
//! An [`Engine`] answers. [`Cpu`] and [`BruteForce`] come to the same bits: whatever trees and
//! lanes rule out, float64 decides about the rest with the same code. Brute force is the reference
//! that every faster way is tested against.
#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod all;
mod batch;
mod brute_force;
mod encounter;
mod engine;
mod filter;
mod from_points;
mod hit_order;
mod hits;
mod instances;
mod neighbours;
mod prefetch;
mod query;
mod ray_query;
mod ray_state;
mod scaled_ray;
mod scene_packet;
mod scene_walk;
mod shapes;
mod single;
mod squares;
mod start;
mod tiles;
mod visible;

pub use all::{AllAnswers, AllHits, RaysOfHits};
pub use brute_force::BruteForce;
#[doc(hidden)]
pub use encounter::{Encounter, Encounters, Rejection};
pub use engine::{Cpu, Engine};
pub(crate) use from_points::FromPoints;
pub use hits::{HitSlices, Hits};
#[doc(hidden)]
pub use prefetch::Prefetcher;
pub use query::{All, Answers, Any, Count, First, Query};
pub use visible::{Viewpoint, visible};

use crate::error::Result;
use crate::geometry::{DVec3, Hit, Ray, Rays};
use crate::scene::Scene;
use crate::watch::Watch;

/// The first object on the ray `p + t * u_r`: the smallest `t > 0`, and at the same `t` the lower
/// (object, primitive). `u_r` need not be of length one; a ray that is zero, infinite or NaN
/// misses.
///
/// ```
/// use firsthit::{DVec3, Object, Scene, Sphere, shoot};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let hit = shoot(&scene, DVec3::new(0.0, -3.0, 0.0), DVec3::Y);
/// assert_eq!((hit.t, hit.object), (2.0, 0));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[doc(alias("raycast", "ray_cast", "ray triangle intersection", "first hit"))]
pub fn shoot(scene: &Scene, p: DVec3, u_r: DVec3) -> Hit {
    Cpu::default().first_hit(scene, &Ray::new(p, u_r))
}

/// Whether anything is at `0 < t <= t_max` on the ray `p + t * u_r`. Faster than the first hit.
///
/// ```
/// use firsthit::{DVec3, Object, Scene, Sphere, occluded};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let (eye, target) = (DVec3::new(-5.0, 0.0, 0.0), DVec3::new(5.0, 0.0, 0.0));
/// assert!(occluded(&scene, eye, target - eye, 1.0));
/// assert!(!occluded(&scene, eye, target - eye, 0.3), "the ball is farther away");
/// # Ok::<(), firsthit::Error>(())
/// ```
#[doc(alias("any hit", "shadow ray", "line of sight"))]
pub fn occluded(scene: &Scene, p: DVec3, u_r: DVec3, t_max: f64) -> bool {
    Cpu::default().any_hit(scene, &Ray::new(p, u_r).up_to(t_max))
}

/// Answers a query for many rays with [`Cpu`], by all threads of the current rayon pool. The
/// answers are in the order of the rays, and do not depend on the number of threads.
///
/// Another engine: [`trace_with`]. Memory that is there already: [`trace_into`], [`Engine::trace`].
///
/// # Errors
///
/// [`Error::Limit`](crate::error::Error::Limit) when the answers do not fit into memory,
/// [`Error::Interrupted`](crate::error::Error::Interrupted) when `watch` stops it.
#[doc(alias("raycast", "ray_cast", "ray triangle intersection", "all hits"))]
pub fn trace<Q: Query, R: Rays + ?Sized>(
    scene: &Scene,
    rays: &R,
    query: Q,
    watch: &dyn Watch,
) -> Result<Q::Answers> {
    trace_with(&Cpu::default(), scene, rays, query, watch)
}

/// [`trace`] with an engine of the caller's choice.
///
/// # Errors
///
/// The errors of [`trace`].
pub fn trace_with<Q: Query, R: Rays + ?Sized>(
    engine: &dyn Engine,
    scene: &Scene,
    rays: &R,
    query: Q,
    watch: &dyn Watch,
) -> Result<Q::Answers> {
    let mut answers = Q::Answers::default();
    trace_into(engine, scene, rays, (query, &mut answers), watch)?;
    Ok(answers)
}

/// [`trace_with`] into answers that are there already: their memory is used again, which for a
/// million rays is a large part of the time. After an error they have no meaning.
///
/// # Errors
///
/// The errors of [`trace`].
pub fn trace_into<Q: Query, R: Rays + ?Sized>(
    engine: &dyn Engine,
    scene: &Scene,
    rays: &R,
    (query, answers): (Q, &mut Q::Answers),
    watch: &dyn Watch,
) -> Result<()> {
    let answers = query.room(answers, rays.len())?;
    engine.trace(scene, &Borrowed(rays), answers, watch)
}

/// Rays behind a pointer: of an unsized type there is no `&dyn`.
struct Borrowed<'a, R: ?Sized>(&'a R);

impl<R: Rays + ?Sized> Rays for Borrowed<'_, R> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn ray(&self, index: usize) -> Ray {
        self.0.ray(index)
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        self.0.read(first, rays);
    }

    fn array(&self) -> Option<&[Ray]> {
        self.0.array()
    }

    fn grid(&self) -> Option<crate::geometry::PixelGrid> {
        self.0.grid()
    }

    fn picture(&self) -> Option<[usize; 2]> {
        self.0.picture()
    }

    fn read_directions(&self, first: usize, directions: [&mut [f64]; 3]) {
        self.0.read_directions(first, directions);
    }

    fn is_filtered(&self) -> bool {
        self.0.is_filtered()
    }

    fn filter(&self, index: usize) -> crate::geometry::RayFilter {
        self.0.filter(index)
    }
}
