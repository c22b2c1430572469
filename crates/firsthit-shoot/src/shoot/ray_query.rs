//! The queries as a ray's state on its way through a scene, and memory for what came of many rays.

use super::hits::HitSlices;
use super::scaled_ray::ScaledRay;
use crate::accel::{self, CrossingList, MeshQuery};
use crate::geometry::{Hit, RayFilter, Rays, SurfaceId};
use crate::scene::Scene;
use crate::shape::Crossing;
use crate::shape::triangle::clear_of;

/// The query of a ray, with its answer so far.
pub(super) trait RayQuery: Copy + Send {
    /// The query that runs in each mesh.
    type InMesh: MeshQuery;
    /// Whether every crossing matters, those in the same place too.
    const ALL: bool = false;
    /// Whether there are rays that do not meet everything.
    const IS_FILTERED: bool = false;
    /// The answer before anything is met.
    const START: Self;
    /// The answer of a ray, by its index, before it has met anything.
    #[inline(always)]
    fn begin(_rays: &dyn Rays, _index: usize) -> Self {
        Self::START
    }
    /// The filter of the ray.
    #[inline(always)]
    fn filter(&self) -> &RayFilter {
        &RayFilter::NONE
    }
    /// The answer for a scene of one object; `surface` is as in [`take`](Self::take).
    fn of_mesh(
        surface: impl Fn(i32) -> SurfaceId,
        found: <Self::InMesh as MeshQuery>::Found,
    ) -> Self;
    /// Merges what was found in an object, of which `surface` tells what a number stands for.
    /// Returns the `t_max` of the scaled ray from here on, which the caller lowers and never
    /// raises; below zero nothing else matters.
    fn take(
        &mut self,
        scene: &Scene,
        scaled: &ScaledRay,
        surface: impl Fn(i32) -> SurfaceId,
        found: <Self::InMesh as MeshQuery>::Found,
    ) -> f64;
}

/// The first hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct FirstHit(pub(super) Hit);

impl FirstHit {
    /// The `t_max` of the scaled ray from here on.
    #[inline(always)]
    pub(super) fn t_max(&self, scaled: &ScaledRay) -> f64 {
        // Not below zero, as in `RayState::new`.
        (clear_of(self.0.t) / scaled.t_scale).max(f64::MIN_POSITIVE)
    }
}

impl RayQuery for FirstHit {
    type InMesh = accel::First;
    const START: Self = Self(Hit::MISS);

    #[inline(always)]
    fn of_mesh(surface: impl Fn(i32) -> SurfaceId, crossing: Option<Crossing>) -> Self {
        Self(crossing.map_or(Hit::MISS, |crossing| {
            let SurfaceId { object, primitive } = surface(crossing.primitive);
            Hit { t: crossing.t, object, primitive, barycentric: crossing.barycentric }
        }))
    }

    #[inline(always)]
    fn take(
        &mut self,
        scene: &Scene,
        scaled: &ScaledRay,
        surface: impl Fn(i32) -> SurfaceId,
        crossing: Option<Crossing>,
    ) -> f64 {
        let hit = |crossing: Crossing| scaled.hit(surface(crossing.primitive), crossing);
        let Some(hit) = crossing.and_then(hit) else {
            return f64::INFINITY;
        };
        if scaled.precedes(scene, &hit, &self.0) {
            self.0 = hit;
        }
        self.t_max(scaled)
    }
}

/// Whether there is any hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct AnyHit(pub(super) bool);

impl RayQuery for AnyHit {
    type InMesh = accel::Any;
    const START: Self = Self(false);

    #[inline(always)]
    fn of_mesh(_: impl Fn(i32) -> SurfaceId, is_hit: bool) -> Self {
        Self(is_hit)
    }

    #[inline(always)]
    fn take(
        &mut self,
        _: &Scene,
        _: &ScaledRay,
        _: impl Fn(i32) -> SurfaceId,
        is_hit: bool,
    ) -> f64 {
        self.0 |= is_hit;
        if self.0 { -1.0 } else { f64::INFINITY }
    }
}

/// The number of hits.
#[derive(Debug, Clone, Copy)]
pub(super) struct HitCount(pub(super) u32);

impl RayQuery for HitCount {
    type InMesh = accel::Count;
    const ALL: bool = true;
    const START: Self = Self(0);

    #[inline(always)]
    fn of_mesh(_: impl Fn(i32) -> SurfaceId, count: u32) -> Self {
        Self(count)
    }

    #[inline(always)]
    fn take(&mut self, _: &Scene, _: &ScaledRay, _: impl Fn(i32) -> SurfaceId, count: u32) -> f64 {
        self.0 = self.0.saturating_add(count);
        f64::INFINITY
    }
}

/// Every hit, in no order.
#[derive(Debug, Clone, Copy)]
pub(super) struct EveryHit(pub(super) CrossingList);

impl RayQuery for EveryHit {
    type InMesh = accel::All;
    const ALL: bool = true;
    const START: Self = Self(CrossingList::EMPTY);

    #[inline(always)]
    fn of_mesh(surface: impl Fn(i32) -> SurfaceId, list: CrossingList) -> Self {
        let mut all = CrossingList::EMPTY;
        all.append(list, surface);
        Self(all)
    }

    #[inline(always)]
    fn take(
        &mut self,
        _: &Scene,
        _: &ScaledRay,
        surface: impl Fn(i32) -> SurfaceId,
        list: CrossingList,
    ) -> f64 {
        self.0.append(list, surface);
        f64::INFINITY
    }
}

/// A query for a ray that does not meet everything.
#[derive(Debug, Clone, Copy)]
pub(super) struct FilteredQuery<Q> {
    query: Q,
    filter: RayFilter,
}

impl<Q: RayQuery> RayQuery for FilteredQuery<Q> {
    type InMesh = accel::FilteredQuery<Q::InMesh>;
    const ALL: bool = Q::ALL;
    const IS_FILTERED: bool = true;
    const START: Self = Self { query: Q::START, filter: RayFilter::NONE };

    fn begin(rays: &dyn Rays, index: usize) -> Self {
        Self { filter: rays.filter(index), ..Self::START }
    }

    #[inline(always)]
    fn filter(&self) -> &RayFilter {
        &self.filter
    }

    #[inline(always)]
    fn of_mesh(
        surface: impl Fn(i32) -> SurfaceId,
        found: <Self::InMesh as MeshQuery>::Found,
    ) -> Self {
        Self { query: Q::of_mesh(surface, found), ..Self::START }
    }

    #[inline(always)]
    fn take(
        &mut self,
        scene: &Scene,
        scaled: &ScaledRay,
        surface: impl Fn(i32) -> SurfaceId,
        found: <Self::InMesh as MeshQuery>::Found,
    ) -> f64 {
        self.query.take(scene, scaled, surface, found)
    }
}

/// Takes the answers for rays that do not meet everything.
pub(super) struct FilteredSink<S>(pub(super) S);

impl<S: Sink> Sink for FilteredSink<S> {
    type Query = FilteredQuery<S::Query>;

    fn len(&self) -> usize {
        self.0.len()
    }

    fn split_at(self, index: usize) -> (Self, Self) {
        let (before, after) = self.0.split_at(index);
        (Self(before), Self(after))
    }

    #[inline(always)]
    fn put(&mut self, index: usize, answer: &Self::Query) {
        self.0.put(index, &answer.query);
    }
}

/// Memory for the answers of a query, one for each ray.
pub(super) trait Sink: Sized + Send {
    /// The query of each ray.
    type Query: RayQuery;
    /// The number of rays.
    fn len(&self) -> usize;
    /// Splits the sink into that of the rays before an index, and that of the others.
    fn split_at(self, index: usize) -> (Self, Self);
    /// Takes the answer of a ray, by its index. Answers come in any order.
    fn put(&mut self, index: usize, answer: &Self::Query);

    /// Splits the sink into chunks of `size` rays; the last one may have fewer.
    fn chunks(self, size: usize) -> Vec<Self> {
        let mut chunks = Vec::with_capacity(self.len().div_ceil(size));
        let mut rest = self;
        while rest.len() > size {
            let (chunk, after) = rest.split_at(size);
            chunks.push(chunk);
            rest = after;
        }
        if rest.len() > 0 {
            chunks.push(rest);
        }
        chunks
    }
}

impl Sink for HitSlices<'_> {
    type Query = FirstHit;

    fn len(&self) -> usize {
        self.t.len()
    }

    fn split_at(self, index: usize) -> (Self, Self) {
        self.split_at(index)
    }

    #[inline(always)]
    fn put(&mut self, index: usize, FirstHit(hit): &FirstHit) {
        HitSlices::put(self, index, hit);
    }
}

/// Makes sinks of slices with a number for each ray.
macro_rules! slices {
    ($($answer:ty: $query:ident;)*) => {$(
        impl Sink for &mut [$answer] {
            type Query = $query;

            fn len(&self) -> usize {
                <[$answer]>::len(self)
            }

            fn split_at(self, index: usize) -> (Self, Self) {
                self.split_at_mut(index)
            }

            #[inline(always)]
            fn put(&mut self, index: usize, $query(answer): &$query) {
                self[index] = *answer;
            }
        }
    )*};
}

slices! {
    bool: AnyHit;
    u32: HitCount;
    CrossingList: EveryHit;
}
