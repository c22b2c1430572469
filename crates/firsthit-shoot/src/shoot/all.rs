//! Every crossing of many rays.
//!
//! 1. Gather the crossings of some rays at a time in lists, in no order.
//! 2. Bring those of each ray into their order (`hit_order.rs`).
//! 3. Put all side by side, in the order of the rays.

use super::batch::{BATCH, fill_batch};
use super::hits::{HitSlices, Hits};
use super::scaled_ray::ScaledRay;
use crate::accel::{CrossingList, InstructionSet};
use crate::error::{Error, Result};
use crate::geometry::summary::summary;
use crate::geometry::{Hit, Ray, Rays};
use crate::memory;
use crate::parallel;
use crate::scene::Scene;
use crate::simd::with_stack;
use crate::watch::{Watch, stop_if_asked};

/// All hits of many rays: those of the ray `k` are from `offsets[k]` to `offsets[k + 1]`, in their
/// order.
///
/// ```
/// use firsthit::{DVec3, Object, Ray, Scene, Sphere};
/// use firsthit::shoot::{All, trace};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let rays = [
///     Ray::new(DVec3::new(2.0, 0.0, 5.0), DVec3::NEG_Z),
///     Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z),
/// ];
/// let all = trace(&scene, &rays[..], All::default(), &())?;
/// assert_eq!(all.offsets, [0, 0, 2]);
/// assert_eq!(all.hits.t, [4.0, 6.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, Default)]
pub struct AllHits {
    /// The index of each ray's first hit, and the number of all hits in the end: one more than
    /// rays.
    pub offsets: Vec<usize>,
    /// The hits of all rays.
    pub hits: Hits,
}

// Rays are many.
summary!(AllHits, "AllHits", |all| "rays": all.offsets.len().saturating_sub(1), "hits": all.hits.len());

impl AllHits {
    /// The number of the ray of each hit.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when there is no memory for them, and for more rays than an identifier can
    /// name.
    pub fn ray_numbers(&self) -> Result<Vec<i32>> {
        let mut numbers = Vec::new();
        let room = numbers.try_reserve_exact(self.hits.len());
        room.map_err(|_| memory::no_room_for("numbers of rays"))?;
        for (ray, ends) in self.offsets.windows(2).enumerate() {
            let number = i32::try_from(ray).map_err(|_| Error::Limit {
                what: "rays with all their hits",
                got: self.offsets.len().to_string(),
                limit: i32::MAX.to_string(),
            })?;
            numbers.extend(std::iter::repeat_n(number, ends[1] - ends[0]));
        }
        Ok(numbers)
    }
}

/// A ray for each hit: of the rays that were shot, those whose numbers are given, as often as they
/// are. With these, what is known of first hits can be asked about all hits.
///
/// ```
/// use firsthit::shoot::{All, RaysOfHits, trace};
/// use firsthit::{DVec3, Object, Ray, Rays, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let rays = [Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z)];
/// let all = trace(&scene, &rays[..], All::default(), &())?;
/// let numbers = all.ray_numbers()?;
/// let repeated = RaysOfHits::new(&rays[..], &numbers);
/// for k in 0..all.hits.len() {
///     let (hit, ray) = (all.hits.get(k), repeated.ray(k));
///     let normal = scene.interaction(&ray, &hit).map(|surface| surface.normal());
///     assert_eq!(normal, Some([DVec3::Z, DVec3::NEG_Z][k]));
/// }
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct RaysOfHits<'a, R: ?Sized> {
    rays: &'a R,
    numbers: &'a [i32],
}

impl<'a, R: Rays + ?Sized> RaysOfHits<'a, R> {
    /// A selection of `rays`: those with the [numbers](AllHits::ray_numbers).
    pub fn new(rays: &'a R, numbers: &'a [i32]) -> Self {
        Self { rays, numbers }
    }
}

impl<R: Rays + ?Sized> Rays for RaysOfHits<'_, R> {
    fn len(&self) -> usize {
        self.numbers.len()
    }

    fn ray(&self, index: usize) -> Ray {
        let number = usize::try_from(self.numbers[index]);
        self.rays.ray(number.expect("numbers count from 0"))
    }
}

/// The destination of all hits: see [`All`](super::All).
#[derive(Debug)]
pub struct AllAnswers<'a> {
    pub(super) all: &'a mut AllHits,
    /// The most hits that are wanted of each ray.
    pub(super) nearest: usize,
}

impl AllAnswers<'_> {
    /// Fills it with hits that `find` gathers, for the rays from a first one to before another; by
    /// all threads of the current rayon pool.
    pub(super) fn fill(
        self,
        scene: &Scene,
        rays: &dyn Rays,
        watch: &dyn Watch,
        find: impl Fn(usize, &mut [CrossingList]) + Sync,
    ) -> Result<()> {
        let Self { all, nearest } = self;
        let gather = |number: usize| {
            stop_if_asked(watch)?;
            let first = number * BATCH;
            let mut lists = [CrossingList::EMPTY; BATCH];
            let lists = &mut lists[..(rays.len() - first).min(BATCH)];
            let count = lists.len() as u64;
            // All on one thread, in whose memory the lists are.
            let (ordered, had_room) = with_stack(|| {
                CrossingList::gather(|| {
                    find(first, lists);
                    CrossingList::finish_all();
                    Ordered::new(scene, rays, (first, lists), nearest, watch)
                })
            });
            if !had_room {
                return Err(memory::no_room_for("hits of rays"));
            }
            watch.advance(count);
            ordered
        };
        let chunks: Vec<Ordered> = parallel::try_map(0..rays.len().div_ceil(BATCH), gather)?;
        let AllHits { offsets, hits } = all;
        let mut end = 0;
        let counts = chunks.iter().flat_map(|chunk| &chunk.counts);
        for (offset, &count) in offsets[1..].iter_mut().zip(counts) {
            end += count as usize;
            *offset = end;
        }
        hits.fit(end)?;
        let mut left = hits.slices();
        let mut parts = Vec::with_capacity(chunks.len());
        for chunk in chunks {
            let (part, after) = left.split_at(chunk.hits.len());
            parts.push((chunk, part));
            left = after;
        }
        let copy = |(chunk, mut part): (Ordered, HitSlices<'_>)| {
            for (index, hit) in chunk.hits.iter().enumerate() {
                part.put(index, hit);
            }
        };
        parallel::each(parts, copy);
        Ok(())
    }
}

/// The hits of some rays, those of each in their order.
struct Ordered {
    counts: Vec<u32>,
    hits: Vec<Hit>,
}

impl Ordered {
    fn new(
        scene: &Scene,
        rays: &dyn Rays,
        (first, lists): (usize, &[CrossingList]),
        nearest: usize,
        watch: &dyn Watch,
    ) -> Result<Self> {
        let mut counts = Vec::with_capacity(lists.len());
        let mut hits = Vec::new();
        // All are in memory until the last ray is done: no room for twice as many.
        let most = nearest.saturating_mul(lists.len());
        let room = hits.try_reserve_exact(CrossingList::count_all().min(most));
        room.map_err(|_| memory::no_room_for("hits of rays"))?;
        let mut of_ray = Vec::new();
        for (index, list) in (first..).zip(lists) {
            stop_if_asked(watch)?;
            of_ray.clear();
            let ray: Ray = rays.ray(index);
            let scaled = if rays.is_filtered() {
                ScaledRay::filtered(&ray, &rays.filter(index))
            } else {
                ScaledRay::new(&ray)
            };
            if let Some(scaled) = scaled {
                let mut room = Ok(());
                list.each(|node| {
                    // The list has hits of the scaled ray, which may be out of float64's
                    // range for the ray.
                    if room.is_ok()
                        && let Some(hit) = scaled.hit(node.surface(), node.crossing)
                    {
                        room = reserve(&mut of_ray, 1);
                        if room.is_ok() {
                            of_ray.push(hit);
                        }
                    }
                });
                room?;
                of_ray.reverse();
                scaled.order(scene, &mut of_ray);
            }
            of_ray.truncate(nearest);
            counts.push(u32::try_from(of_ray.len()).unwrap_or(u32::MAX));
            reserve(&mut hits, of_ray.len())?;
            hits.extend_from_slice(&of_ray);
        }
        Ok(Self { counts, hits })
    }
}

fn reserve(hits: &mut Vec<Hit>, count: usize) -> Result<()> {
    let refused = |_| memory::no_room_for("hits of rays");
    hits.try_reserve(count).map_err(refused)
}

/// [`AllAnswers::fill`] by trees.
pub(super) fn trace_all(
    set: InstructionSet,
    scene: &Scene,
    rays: &dyn Rays,
    answers: AllAnswers<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    answers.fill(scene, rays, watch, |first, lists| {
        fill_batch(set, scene, rays, first, lists);
    })
}
