//! Rays to hits: what does this ray meet first, and does it meet anything?
//!
//! [`Trees`] and [`BruteForce`] come to the same bits: whatever the trees rule out, float64 decides about
//! the rest with the same code. Brute force is the judge that every faster way is tested against.
#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod fit;
mod hits;
mod journey;
mod judge;
mod object;
mod pixels;
mod plan;
mod tiles;
mod trees;

use rayon::prelude::*;

pub use hits::{HitSlices, Hits};
pub use judge::BruteForce;
pub use trees::Trees;

use crate::error::{Error, Result};
use crate::geometry::{DVec3, Hit, PixelGrid, Ray, Rays};
use crate::memory;
use crate::scene::Scene;
use crate::simd;
use crate::watch::Watch;
use journey::{AnyHit, FirstHit};
use plan::Plan;
use trees::{BATCH, Batch, Take};

/// The first object on the ray `p + t * u_r`: the smallest `t > 0`, and at the same `t` the lower
/// (object, primitive). `u_r` need not be of length one; a ray that is zero, infinite or NaN misses.
///
/// ```
/// use firsthit::{DVec3, Object, Scene, Sphere, shoot};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let hit = shoot(&scene, DVec3::new(0.0, -3.0, 0.0), DVec3::Y);
/// assert_eq!((hit.t, hit.object), (2.0, 0));
/// # Ok::<(), firsthit::Error>(())
/// ```
pub fn shoot(scene: &Scene, p: DVec3, u_r: DVec3) -> Hit {
    first_hit::<Trees>(scene, &Ray::new(p, u_r))
}

/// Whether anything is at `0 < t <= t_max` on the ray `p + t * u_r`. Sooner known than the first hit.
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
pub fn occluded(scene: &Scene, p: DVec3, u_r: DVec3, t_max: f64) -> bool {
    any_hit(scene, &Ray::new(p, u_r).up_to(t_max))
}

/// [`occluded`] for a ray with its own `t_min` and `t_max`.
pub fn any_hit(scene: &Scene, ray: &Ray) -> bool {
    trees::any_hit(scene, ray)
}

/// A way to find the first hit.
pub trait Search {
    /// The first hit of `ray`.
    fn first_hit(scene: &Scene, ray: &Ray) -> Hit;
}

/// The first hit of `ray`, found by `S`.
pub fn first_hit<S: Search>(scene: &Scene, ray: &Ray) -> Hit {
    S::first_hit(scene, ray)
}

/// [`shoot`] for many rays, by all threads of the current rayon pool. The order is that of the rays, and
/// the result does not depend on the number of threads.
///
/// # Errors
///
/// [`Error::Limit`] when the result does not fit into memory, [`Error::Interrupted`] when `watch` stops it.
pub fn shoot_all<R: Rays + ?Sized>(scene: &Scene, rays: &R, watch: &dyn Watch) -> Result<Hits> {
    let mut hits = Hits::default();
    shoot_all_into(scene, rays, &mut hits, watch)?;
    Ok(hits)
}

/// [`shoot_all`] into hits that are there already: their memory is used again, which for a million rays is a
/// large part of the time. After an error they are of no meaning.
///
/// # Errors
///
/// Those of [`shoot_all`].
pub fn shoot_all_into<R: Rays + ?Sized>(
    scene: &Scene,
    rays: &R,
    hits: &mut Hits,
    watch: &dyn Watch,
) -> Result<()> {
    hits.fit(rays.len())?;
    shoot_each(scene, &Borrowed(rays), hits.slices(), watch)
}

/// [`shoot_all`] into memory of the caller's, of which it does not matter what is in there. After an error it is of no
/// meaning.
///
/// # Errors
///
/// [`Error::Interrupted`] when `watch` stops it.
///
/// # Panics
///
/// When `hits` are not for as many as there are rays.
pub fn shoot_all_to<R: Rays + ?Sized>(
    scene: &Scene,
    rays: &R,
    hits: HitSlices<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    assert_eq!(hits.count(), Some(rays.len()), "a place for each ray");
    shoot_each(scene, &Borrowed(rays), hits, watch)
}

/// Rays behind a pointer, so that kernels are compiled once, in this crate, and not for each type of rays in the caller's.
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

    fn grid(&self) -> Option<PixelGrid> {
        self.0.grid()
    }
}

fn shoot_each(
    scene: &Scene,
    rays: &dyn Rays,
    hits: HitSlices<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    let fits = |grid: &PixelGrid| grid.rows.checked_mul(grid.columns) == Some(rays.len());
    let own = rays.grid().filter(fits);
    let is_fitted = own.is_none();
    let (first, grid) = match own {
        Some(grid) => (0, Some(grid)),
        None => fit::grid(rays).map_or((0, None), |(first, grid)| (first, Some(grid))),
    };
    let pixels = Later { rays, first };
    let plan = grid.and_then(|grid| Plan::new(scene, &pixels, grid, is_fitted));
    // An array may begin and end within a row of pixels; without a plan, all is before.
    let (before, later) = hits.split_at(match &plan {
        Some(_) => first,
        None => rays.len(),
    });
    shoot_array(scene, rays, before, watch)?;
    let Some(plan) = &plan else {
        return Ok(());
    };
    let (tiled, after) = later.split_at(plan.pixels());
    each_chunk(tiled, plan.band(), watch, |index, out| {
        simd::run(scene.instruction_set(), tiles::Band { plan, index, out });
    })?;
    let first = first + plan.pixels();
    shoot_array(scene, &Later { rays, first }, after, watch)
}

/// Rays that need have nothing in common, in waves.
fn shoot_array(
    scene: &Scene,
    rays: &dyn Rays,
    out: HitSlices<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    each_chunk(out, BATCH, watch, |index, out| {
        let batch = Batch {
            scene,
            rays,
            first: index * BATCH,
            count: out.t.len(),
            take: out,
        };
        simd::run(scene.instruction_set(), batch);
    })
}

/// Fills hits, so many at a time, by all threads of the current rayon pool.
fn each_chunk(
    out: HitSlices<'_>,
    size: usize,
    watch: &dyn Watch,
    fill: impl Fn(usize, HitSlices<'_>) + Sync,
) -> Result<()> {
    let size = size.max(1);
    let HitSlices {
        t,
        object,
        primitive,
        barycentric,
    } = out;
    t.par_chunks_mut(size)
        .zip(object.par_chunks_mut(size))
        .zip(primitive.par_chunks_mut(size))
        .zip(barycentric.par_chunks_mut(size))
        .enumerate()
        .try_for_each(|(index, (((t, object), primitive), barycentric))| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let count = t.len() as u64;
            let out = HitSlices {
                t,
                object,
                primitive,
                barycentric,
            };
            fill(index, out);
            watch.advance(count);
            Ok(())
        })
}

/// The rays from one on.
struct Later<'a> {
    rays: &'a dyn Rays,
    first: usize,
}

impl Rays for Later<'_> {
    fn len(&self) -> usize {
        self.rays.len() - self.first
    }

    fn ray(&self, index: usize) -> Ray {
        self.rays.ray(self.first + index)
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        self.rays.read(self.first + first, rays);
    }
}

impl Take for HitSlices<'_> {
    type Quest = FirstHit;

    #[inline(always)]
    fn take(&mut self, index: usize, FirstHit(hit): &FirstHit) {
        self.put(index, hit);
    }
}

/// [`any_hit`] for many rays, by all threads of the current rayon pool.
///
/// # Errors
///
/// Those of [`shoot_all`].
pub fn occluded_all<R: Rays + ?Sized>(
    scene: &Scene,
    rays: &R,
    watch: &dyn Watch,
) -> Result<Vec<bool>> {
    occluded_each(scene, &Borrowed(rays), watch)
}

fn occluded_each(scene: &Scene, rays: &dyn Rays, watch: &dyn Watch) -> Result<Vec<bool>> {
    let mut found = memory::zeroed(rays.len())?;
    found
        .par_chunks_mut(BATCH)
        .enumerate()
        .try_for_each(|(batch, found)| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let count = found.len() as u64;
            let first = batch * BATCH;
            let batch = Batch {
                scene,
                rays,
                first,
                count: found.len(),
                take: Found(found),
            };
            simd::run(scene.instruction_set(), batch);
            watch.advance(count);
            Ok(())
        })?;
    Ok(found)
}

struct Found<'a>(&'a mut [bool]);

impl Take for Found<'_> {
    type Quest = AnyHit;

    #[inline(always)]
    fn take(&mut self, index: usize, AnyHit(is_hit): &AnyHit) {
        self.0[index] = *is_hit;
    }
}
