//! The way from rays to rows of answers: block by block, so that only the crossings of one block
//! are in memory.

use std::cmp::Ordering;
use std::ops::Range;

use super::winding::winding_number;
use super::{FillRule, Grouping, Rule, rules_with};
use crate::error::Result;
use crate::geometry::orientation::along_normal;
use crate::geometry::{DVec3, Ray, RayFilter, Rays};
use crate::parallel;
use crate::scene::{Object, Scene};
use crate::shape::{Facing, Mesh};
use crate::shoot::{All, AllHits, Engine, trace_into};
use crate::watch::{OnlyStops, Watch, stop_if_asked};

/// Rays whose crossings are in memory at a time.
const BLOCK: usize = 1 << 14;

/// Rays that a thread takes at a time.
const PIECE: usize = 64;

/// Fewer rays than this, with little to add up for each, are done by the calling thread alone.
const FEW: usize = 512;

/// The number of solid angles that take about a tenth of a second.
const FEW_ANGLES: u64 = 1 << 21;

/// A scene with the rule of each object, and which of the objects are open.
pub(crate) struct Solids<'a> {
    scene: &'a Scene,
    pub(crate) rules: Vec<Rule>,
    /// The open objects, whose winding number is no whole one.
    pub(crate) open: Vec<usize>,
    /// The meshes of which crossings count one way or the other, and which way their triangles
    /// face.
    facing: Vec<Option<(&'a Mesh, &'a Facing)>>,
}

/// Crossings of some rays, and those of one of them.
pub(crate) struct Met<'a> {
    all: &'a AllHits,
    range: Range<usize>,
}

impl<'a> Met<'a> {
    /// The objects that are crossed, in the order of the crossings.
    pub(crate) fn objects(&self) -> impl Iterator<Item = usize> + use<'a> {
        let objects = self.all.hits.object[self.range.clone()].iter();
        // Of hits, none is -1.
        objects.map(|&object| object.cast_unsigned() as usize)
    }

    /// The crossings, in order.
    pub(crate) fn crossings(&self) -> impl Iterator<Item = Crossed> + use<'a> {
        let t = self.all.hits.t[self.range.clone()].iter();
        let primitive = self.all.hits.primitive[self.range.clone()].iter();
        let all = t.zip(self.objects()).zip(primitive);
        all.map(|((&t, object), &primitive)| Crossed { t, object, primitive })
    }
}

/// The crossing of a ray with the surface of an object.
#[derive(Clone, Copy)]
pub(crate) struct Crossed {
    pub(crate) t: f64,
    pub(crate) object: usize,
    primitive: i32,
}

impl<'a> Solids<'a> {
    pub(crate) fn new(scene: &'a Scene, rule: FillRule) -> Result<Self> {
        let rules = rules_with(rule, scene)?;
        let open = (0..rules.len()).filter(|&k| rules[k] == Rule::WindingNumber);
        let open = open.collect();
        let facing = |(object, &rule): (&'a Object, &Rule)| match object.mesh() {
            Some(mesh) if rule == Rule::Nonzero => Ok(Some((&**mesh, mesh.facing()?))),
            _ => Ok(None),
        };
        let facing = scene.objects().iter().zip(&rules).map(facing);
        Ok(Self { facing: facing.collect::<Result<_>>()?, scene, rules, open })
    }

    /// The winding number of an object before a crossing, from that behind it; where parity
    /// decides, 0 or 1. So the inside is where it is not zero.
    #[inline]
    pub(crate) fn before(&self, ray: &Ray, crossed: Crossed, behind: i32) -> i32 {
        match self.is_outwards(ray, crossed) {
            Some(true) => behind + 1,
            Some(false) => behind - 1,
            None => behind ^ 1,
        }
    }

    /// The inverse of [`before`](Self::before).
    #[inline]
    pub(crate) fn behind(&self, ray: &Ray, crossed: Crossed, before: i32) -> i32 {
        match self.is_outwards(ray, crossed) {
            Some(true) => before - 1,
            Some(false) => before + 1,
            None => before ^ 1,
        }
    }

    /// Whether a crossing goes from the back of a triangle to its front; `None` where that does not
    /// matter.
    #[inline]
    fn is_outwards(&self, ray: &Ray, crossed: Crossed) -> Option<bool> {
        let (mesh, facing) = self.facing[crossed.object]?;
        let triangle = crossed.primitive.cast_unsigned() as usize;
        let transform = self.scene.objects()[crossed.object].transform();
        let way = transform.ray_in_object(ray).direction;
        let order = along_normal(mesh.corners(triangle), way);
        Some((order == Ordering::Greater) != facing.is_turned(triangle))
    }

    /// Whether a triangle of an object counts as facing the other way than its corners say.
    pub(crate) fn is_turned(&self, object: usize, primitive: i32) -> bool {
        let triangle = primitive.cast_unsigned() as usize;
        self.facing[object].is_some_and(|(_, facing)| facing.is_turned(triangle))
    }

    /// Counts how often each closed object goes around the start of a ray, in `turns`, which is
    /// zero for all of them before. Returns how many objects the start is in.
    pub(crate) fn wind(&self, ray: &Ray, met: &Met<'_>, turns: &mut [i32]) -> usize {
        let mut count = 0;
        for crossed in met.crossings() {
            if self.rules[crossed.object].is_of_closed() {
                let turns = &mut turns[crossed.object];
                let behind = std::mem::replace(turns, self.before(ray, crossed, *turns));
                count += usize::from(behind == 0);
                count -= usize::from(*turns == 0);
            }
        }
        count
    }

    /// Whether a point is in an open object, as its winding number says. A point outside the mesh's
    /// box never is.
    pub(crate) fn is_in_open(
        &self,
        object: usize,
        point: DVec3,
        watch: &dyn Watch,
    ) -> Result<bool> {
        let object = &self.scene.objects()[object];
        let Some(mesh) = object.mesh() else {
            return Ok(false);
        };
        // A ray from there, since that is how it comes to the object elsewhere.
        let ray = Ray::new(point, DVec3::Z);
        let point = object.transform().ray_in_object(&ray).origin;
        let bounds = mesh.bounds();
        let is_in_box = bounds.low.cmple(point).all() && point.cmple(bounds.high).all();
        // Either way round: a closed mesh that faces inwards holds the same points, too.
        Ok(is_in_box && winding_number(mesh, point, watch)?.abs() > 0.5)
    }

    fn is_little(&self, rays: usize) -> bool {
        let meshes = self.open.iter().filter_map(|&k| self.scene.objects()[k].mesh());
        let triangles: u64 = meshes.map(|mesh| mesh.triangles().len() as u64).sum();
        rays < FEW && triangles.saturating_mul(rays as u64) < FEW_ANGLES
    }

    /// Makes a row of `answers` for each ray, of all its crossings after `t_min`; `t_max` is
    /// ignored. `state` makes scratch memory, which is used again: it is called once for each piece
    /// of work that is under way at the same time.
    pub(crate) fn sweep<T: Send, S: Send>(
        &self,
        (engine, rays): (&dyn Engine, &dyn Rays),
        (by, answers): (Grouping, &mut [T]),
        watch: &dyn Watch,
        state: impl Fn() -> Result<S> + Sync,
        answer: impl Fn(&mut S, &Ray, &Met<'_>, &mut [T]) -> Result<()> + Sync,
    ) -> Result<()> {
        let width = by.width(self.scene);
        if width == 0 {
            watch.advance(rays.len() as u64);
            return Ok(());
        }
        let mut all = AllHits::default();
        let piece = if self.is_little(rays.len()) { BLOCK } else { PIECE };
        for (number, answers) in answers.chunks_mut(BLOCK * width).enumerate() {
            let (first, count) = (number * BLOCK, answers.len() / width);
            let part = RayRange { rays, first, count };
            trace_into(engine, self.scene, &part, (All::default(), &mut all), &OnlyStops(watch))?;
            let all = &all;
            let pieces = answers.chunks_mut(piece * width).enumerate();
            parallel::try_each_with(&state, pieces, |state, (number, answers)| {
                stop_if_asked(watch)?;
                let rows = (number * piece..).zip(answers.chunks_mut(width));
                for (index, row) in rows {
                    let range = all.offsets[index]..all.offsets[index + 1];
                    let ray = rays.ray(first + index);
                    answer(state, &ray, &Met { all, range }, row)?;
                }
                watch.advance((answers.len() / width) as u64);
                Ok(())
            })?;
        }
        Ok(())
    }
}

/// A range of many rays, without their ends.
struct RayRange<'a> {
    rays: &'a dyn Rays,
    first: usize,
    count: usize,
}

impl Rays for RayRange<'_> {
    fn len(&self) -> usize {
        self.count
    }

    fn ray(&self, index: usize) -> Ray {
        self.rays.ray(self.first + index).up_to(f64::INFINITY)
    }

    fn is_filtered(&self) -> bool {
        self.rays.is_filtered()
    }

    fn filter(&self, index: usize) -> RayFilter {
        self.rays.filter(self.first + index)
    }
}
