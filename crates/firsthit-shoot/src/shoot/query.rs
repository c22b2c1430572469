//! The queries for rays, and the destinations of their answers.

use super::all::{AllAnswers, AllHits};
use super::hits::{HitSlices, Hits};
use crate::error::Result;
use crate::memory::fit;

/// A question about rays, with an answer for each: [`First`], [`Any`], [`Count`] or [`All`].
///
/// ```
/// use firsthit::{DVec3, Object, Ray, Scene, Sphere};
/// use firsthit::shoot::{Any, Count, First, trace};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let rays = [
///     Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z),
///     Ray::new(DVec3::new(2.0, 0.0, 5.0), DVec3::NEG_Z),
/// ];
/// assert_eq!(trace(&scene, &rays[..], First, &())?.object, [0, -1]);
/// assert_eq!(trace(&scene, &rays[..], Any, &())?, [true, false]);
/// assert_eq!(trace(&scene, &rays[..], Count, &())?, [2, 0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
pub trait Query {
    /// The answers for many rays, in their order.
    type Answers: Default;

    /// Makes room for the answers of `count` rays, reusing their memory.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when they do not fit into memory.
    fn room<'a>(&self, answers: &'a mut Self::Answers, count: usize) -> Result<Answers<'a>>;
}

/// The first hit of each ray.
#[derive(Debug, Clone, Copy)]
pub struct First;

/// Whether each ray meets anything. Faster than the first hit.
#[derive(Debug, Clone, Copy)]
pub struct Any;

/// Counts how many times each ray crosses a surface: how many hits [`All`] has for it.
#[derive(Debug, Clone, Copy)]
pub struct Count;

/// Every crossing of each ray with a surface, in order; [`AllHits`] holds them.
///
/// Each crossing is there once. A ray through an edge or a corner crosses the triangles that a ray
/// infinitely little beside it would cross (`shape/triangle/crossed.rs`): through a closed mesh it
/// enters and leaves in turn, and where it only grazes, it does both or neither. So at an edge
/// [`First`] may see a surface that is not among these. A ray along a triangle does not cross it. A
/// solid that is no mesh is crossed at both ends. Surfaces in the same place count each.
///
/// The order is that of `t`, which is as [`First`] has it, and among hits closer than a few units
/// in the last place the float64 nearest to the exact one: it never decreases. Of equal ones it is
/// that of the object. Within a mesh it is then that of the exact `t`, after that the one in which
/// the ray beside enters and leaves, and at last that of the primitive. Those of a ray that leaves
/// a surface ([`Departure`](crate::geometry::Departure)) are in the order of `t` as it is, then of
/// (object, primitive), at edges too.
#[derive(Debug, Clone, Copy, Default)]
pub struct All {
    /// The number of first hits of each ray that are wanted; all for `None`.
    pub nearest: Option<usize>,
}

impl Query for All {
    type Answers = AllHits;

    fn room<'a>(&self, answers: &'a mut AllHits, count: usize) -> Result<Answers<'a>> {
        let AllHits { offsets, hits } = answers;
        fit(offsets, count + 1)?;
        offsets[0] = 0;
        hits.fit(0)?;
        Ok(Answers::All(AllAnswers { all: answers, nearest: self.nearest.unwrap_or(usize::MAX) }))
    }
}

impl Query for First {
    type Answers = Hits;

    fn room<'a>(&self, answers: &'a mut Hits, count: usize) -> Result<Answers<'a>> {
        answers.fit(count)?;
        Ok(Answers::First(answers.slices()))
    }
}

impl Query for Any {
    type Answers = Vec<bool>;

    fn room<'a>(&self, answers: &'a mut Vec<bool>, count: usize) -> Result<Answers<'a>> {
        fit(answers, count)?;
        Ok(Answers::Any(answers))
    }
}

impl Query for Count {
    type Answers = Vec<u32>;

    fn room<'a>(&self, answers: &'a mut Vec<u32>, count: usize) -> Result<Answers<'a>> {
        fit(answers, count)?;
        Ok(Answers::Count(answers))
    }
}

/// Memory for the answers of many rays, one for each; what is asked follows from it. Its content
/// before does not matter.
#[derive(Debug)]
pub enum Answers<'a> {
    /// The answers of [`First`].
    First(HitSlices<'a>),
    /// The answers of [`Any`].
    Any(&'a mut [bool]),
    /// The answers of [`Count`].
    Count(&'a mut [u32]),
    /// The answers of [`All`].
    All(AllAnswers<'a>),
}

impl Answers<'_> {
    /// The number of rays that the answers are for; `None` where the slices of hits differ in
    /// length.
    pub fn count(&self) -> Option<usize> {
        match self {
            Self::First(hits) => hits.count(),
            Self::Any(found) => Some(found.len()),
            Self::Count(counts) => Some(counts.len()),
            Self::All(AllAnswers { all, .. }) => all.offsets.len().checked_sub(1),
        }
    }
}
