//! Rays to hits: what does this ray meet first, and does it meet anything?
//!
//! [`Trees`] and [`BruteForce`] come to the same bits: whatever the trees rule out, float64 decides about
//! the rest with the same code. Brute force is the judge that every faster way is tested against.
#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod judge;
mod object;
mod tiles;
mod trees;

use rayon::prelude::*;

pub use judge::BruteForce;
pub use trees::Trees;

use crate::accel::{Scratch, TILE};
use crate::error::{Error, Result};
use crate::geometry::{DVec2, DVec3, Hit, PixelGrid, Ray, Rays};
use crate::memory;
use crate::scene::Scene;
use crate::simd::{self, Kernel, Lanes};
use crate::watch::Watch;

/// The first object on the ray `p + t * u_r`: the smallest `t > 0`, and at the same `t` the lower
/// (object, primitive). `u_r` need not be of length one; a ray that is zero, infinite or NaN misses.
pub fn shoot(scene: &Scene, p: DVec3, u_r: DVec3) -> Hit {
    first_hit::<Trees>(scene, &Ray::new(p, u_r))
}

/// Whether anything is at `0 < t <= t_max` on the ray `p + t * u_r`. Sooner known than the first hit.
pub fn occluded(scene: &Scene, p: DVec3, u_r: DVec3, t_max: f64) -> bool {
    any_hit(scene, &Ray::new(p, u_r).up_to(t_max))
}

/// [`occluded`] for a ray with its own `t_max`.
pub fn any_hit(scene: &Scene, ray: &Ray) -> bool {
    simd::run(scene.instruction_set(), trees::Any(scene, ray))
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

/// What many rays met, an array for each quantity; see [`Hit`] for their meaning.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hits {
    /// The rays' parameters, infinity for a miss.
    pub t: Vec<f64>,
    /// The objects' identifiers, -1 for a miss.
    pub object: Vec<i32>,
    /// The primitives' identifiers, -1 for a miss.
    pub primitive: Vec<i32>,
    /// The weights of a triangle's corners 1 and 2, else NaN.
    pub barycentric: Vec<DVec2>,
}

impl Hits {
    /// How many rays there were.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there were none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// What the ray `index` met.
    ///
    /// # Panics
    ///
    /// When there was no such ray.
    pub fn get(&self, index: usize) -> Hit {
        Hit {
            t: self.t[index],
            object: self.object[index],
            primitive: self.primitive[index],
            barycentric: self.barycentric[index],
        }
    }
}

/// How many rays a thread takes at a time: enough to be worth it, few enough to stop within a moment.
const BATCH: usize = 1024;

/// [`shoot`] for many rays, by all threads of the current rayon pool. The order is that of the rays, and
/// the result does not depend on the number of threads.
///
/// # Errors
///
/// [`Error::Limit`] when the result does not fit into memory, [`Error::Interrupted`] when `watch` stops it.
pub fn shoot_all<R: Rays + ?Sized>(scene: &Scene, rays: &R, watch: &dyn Watch) -> Result<Hits> {
    shoot_each(scene, &Borrowed(rays), watch)
}

/// Rays behind a pointer: kernels are compiled once, not for each kind of rays.
struct Borrowed<'a, R: ?Sized>(&'a R);

impl<R: Rays + ?Sized> Rays for Borrowed<'_, R> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn ray(&self, index: usize) -> Ray {
        self.0.ray(index)
    }

    fn grid(&self) -> Option<PixelGrid> {
        self.0.grid()
    }
}

fn shoot_each(scene: &Scene, rays: &dyn Rays, watch: &dyn Watch) -> Result<Hits> {
    let count = rays.len();
    let plan = tiles::Plan::new(scene, rays);
    let mut hits = Hits {
        // Written once, by whoever shoots: memory that is zero costs nothing.
        t: zeroed(count, 0.0)?,
        object: zeroed(count, 0)?,
        primitive: zeroed(count, 0)?,
        barycentric: filled(count, Hit::MISS.barycentric)?,
    };
    // A row of tiles at a time, or a number of rays.
    let chunk = plan
        .as_ref()
        .map_or(BATCH, |plan| plan.columns() * TILE)
        .max(1);
    hits.t
        .par_chunks_mut(chunk)
        .zip(hits.object.par_chunks_mut(chunk))
        .zip(hits.primitive.par_chunks_mut(chunk))
        .zip(hits.barycentric.par_chunks_mut(chunk))
        .enumerate()
        .try_for_each(|(index, (((t, object), primitive), barycentric))| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let count = t.len() as u64;
            let out = Out {
                t,
                object,
                primitive,
                barycentric,
            };
            if let Some(plan) = &plan {
                simd::run(scene.instruction_set(), tiles::Band { plan, index, out });
            } else {
                let first = index * chunk;
                let batch = Batch {
                    scene,
                    rays,
                    first,
                    out,
                };
                simd::run(scene.instruction_set(), batch);
            }
            watch.advance(count);
            Ok(())
        })?;
    Ok(hits)
}

/// Where hits go.
struct Out<'a> {
    t: &'a mut [f64],
    object: &'a mut [i32],
    primitive: &'a mut [i32],
    barycentric: &'a mut [DVec2],
}

impl Out<'_> {
    #[inline(always)]
    fn put(&mut self, index: usize, hit: &Hit) {
        self.t[index] = hit.t;
        self.object[index] = hit.object;
        self.primitive[index] = hit.primitive;
        self.barycentric[index] = hit.barycentric;
    }

    #[inline(always)]
    fn get(&self, index: usize) -> Hit {
        Hit {
            t: self.t[index],
            object: self.object[index],
            primitive: self.primitive[index],
            barycentric: self.barycentric[index],
        }
    }
}

/// Rays from `first` on, one by one.
struct Batch<'a> {
    scene: &'a Scene,
    rays: &'a dyn Rays,
    first: usize,
    out: Out<'a>,
}

impl Kernel for Batch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        let mut scratch = Scratch::new();
        for k in 0..self.out.t.len() {
            let ray = self.rays.ray(self.first + k);
            let hit = trees::first_hit(l, &mut scratch, self.scene, &ray);
            self.out.put(k, &hit);
        }
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
    let rays: &dyn Rays = &Borrowed(rays);
    let mut found = filled(rays.len(), false)?;
    found
        .par_chunks_mut(BATCH)
        .enumerate()
        .try_for_each(|(batch, found)| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let count = found.len() as u64;
            let first = batch * BATCH;
            simd::run(
                scene.instruction_set(),
                AnyBatch {
                    scene,
                    rays,
                    first,
                    found,
                },
            );
            watch.advance(count);
            Ok(())
        })?;
    Ok(found)
}

struct AnyBatch<'a> {
    scene: &'a Scene,
    rays: &'a dyn Rays,
    first: usize,
    found: &'a mut [bool],
}

impl Kernel for AnyBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let mut scratch = Scratch::new();
        for (k, found) in self.found.iter_mut().enumerate() {
            let ray = self.rays.ray(self.first + k);
            *found = trees::any_hit(l, &mut scratch, self.scene, &ray);
        }
    }
}

/// A vector of `count` times `zero`, or an error instead of an abort when memory is short.
fn zeroed<T: Clone>(count: usize, zero: T) -> Result<Vec<T>> {
    // The standard library has no fallible way to memory that is zero already.
    memory::check("a result", count.saturating_mul(size_of::<T>()))?;
    Ok(vec![zero; count])
}

fn reserved<T>(mut vec: Vec<T>, count: usize) -> Result<Vec<T>> {
    vec.try_reserve_exact(count).map_err(|_| Error::Limit {
        what: "elements of a result",
        got: count.to_string(),
        limit: "the memory there is".into(),
    })?;
    Ok(vec)
}

/// A vector of `count` times `value`, or an error instead of an abort when memory is short.
pub(crate) fn filled<T: Clone>(count: usize, value: T) -> Result<Vec<T>> {
    let mut vec = reserved(Vec::new(), count)?;
    vec.resize(count, value);
    Ok(vec)
}
