//! Engines: they compute the answers of queries.

use std::fmt::Debug;
use std::sync::OnceLock;

use super::all::trace_all;
use super::batch::{fill_batch, trace_array};
use super::query::Answers;
use super::ray_query::{AnyHit, FilteredSink, FirstHit, RayQuery};
use super::single::Single;
use super::tiles::trace_hits;
use crate::accel::InstructionSet;
use crate::error::Result;
use crate::geometry::{Hit, Ray, Rays};
use crate::parallel;
use crate::scene::Scene;
use crate::simd;
use crate::watch::Watch;

/// Finds what rays meet. All engines come to the same bits.
pub trait Engine: Debug + Sync {
    /// The first hit of a ray.
    fn first_hit(&self, scene: &Scene, ray: &Ray) -> Hit;

    /// Whether a ray meets anything.
    fn any_hit(&self, scene: &Scene, ray: &Ray) -> bool;

    /// The answers for many rays, in their order.
    ///
    /// # Errors
    ///
    /// [`Error::Interrupted`](crate::error::Error::Interrupted) when `watch` stops it; the answers
    /// then have no meaning. [`Error::Limit`](crate::error::Error::Limit) when all hits do not fit
    /// into memory.
    ///
    /// # Panics
    ///
    /// When `answers` are not for as many as there are rays.
    fn trace(
        &self,
        scene: &Scene,
        rays: &dyn Rays,
        answers: Answers<'_>,
        watch: &dyn Watch,
    ) -> Result<()>;

    /// The instruction set that shaders compute with; by default that of [`Cpu::shared`]. Answers
    /// do not depend on it.
    fn instruction_set(&self) -> InstructionSet {
        Cpu::shared().0
    }
}

/// The CPU engine: trees in lanes, on all threads of the current rayon pool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cpu(InstructionSet);

impl Cpu {
    /// The engine with the instruction set that `FIRSTHIT_ISA` names, or else the fastest that this
    /// machine has.
    ///
    /// # Errors
    ///
    /// The errors of [`InstructionSet::current`].
    pub fn current() -> Result<Self> {
        InstructionSet::current().map(Self)
    }

    /// The engine with an instruction set: only times depend on it. One that this machine does not
    /// have is replaced by the next plainer one.
    pub const fn with(instruction_set: InstructionSet) -> Self {
        Self(instruction_set)
    }

    /// The default engine, for callers that borrow one.
    pub fn shared() -> &'static Self {
        static SHARED: OnceLock<Cpu> = OnceLock::new();
        parallel::once(&SHARED, Self::default)
    }

    /// The instruction set.
    pub fn instruction_set(self) -> InstructionSet {
        self.0
    }

    fn one<Q: RayQuery>(self, scene: &Scene, ray: &Ray) -> Q {
        simd::run(self.0, Single(scene, ray, Q::START))
    }
}

/// [`Cpu::current`], for scenes: there is none where `FIRSTHIT_ISA` is wrong.
impl Default for Cpu {
    fn default() -> Self {
        Self(InstructionSet::current().unwrap_or(InstructionSet::Portable))
    }
}

impl Engine for Cpu {
    fn instruction_set(&self) -> InstructionSet {
        self.0
    }

    fn first_hit(&self, scene: &Scene, ray: &Ray) -> Hit {
        let FirstHit(hit) = self.one(scene, ray);
        hit
    }

    fn any_hit(&self, scene: &Scene, ray: &Ray) -> bool {
        let AnyHit(is_hit) = self.one(scene, ray);
        is_hit
    }

    fn trace(
        &self,
        scene: &Scene,
        rays: &dyn Rays,
        answers: Answers<'_>,
        watch: &dyn Watch,
    ) -> Result<()> {
        assert_eq!(answers.count(), Some(rays.len()), "an answer for each ray");
        if rays.is_filtered() {
            return trace_filtered(self.0, scene, rays, answers, watch);
        }
        match answers {
            Answers::First(hits) => trace_hits(self.0, scene, rays, hits, watch),
            Answers::Any(found) => trace_array(self.0, scene, rays, found, watch),
            Answers::Count(counts) => trace_array(self.0, scene, rays, counts, watch),
            Answers::All(all) => trace_all(self.0, scene, rays, all, watch),
        }
    }
}

/// The answers for rays that do not meet everything.
fn trace_filtered(
    set: InstructionSet,
    scene: &Scene,
    rays: &dyn Rays,
    answers: Answers<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    match answers {
        Answers::First(hits) => trace_array(set, scene, rays, FilteredSink(hits), watch),
        Answers::Any(found) => trace_array(set, scene, rays, FilteredSink(found), watch),
        Answers::Count(counts) => trace_array(set, scene, rays, FilteredSink(counts), watch),
        Answers::All(all) => all.fill(scene, rays, watch, |first, lists| {
            fill_batch(set, scene, rays, first, FilteredSink(lists));
        }),
    }
}
