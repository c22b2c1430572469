//! The way from rays to rows of answers: block by block, so that only the crossings of one block are in memory.

use std::ops::Range;

use super::winding::winding_number;
use super::{By, Rule, rules};
use crate::error::{Error, Result};
use crate::geometry::{DVec3, Ray, RayFilter, Rays};
use crate::parallel;
use crate::scene::Scene;
use crate::shoot::{All, AllHits, Cpu, trace_into};
use crate::watch::{OnlyStops, Watch};

/// Rays whose crossings are in memory at a time.
const BLOCK: usize = 1 << 14;

/// Rays that a thread takes at a time.
const PIECE: usize = 64;

/// Fewer rays than this, with little to add up for each, are done by the calling thread alone.
const FEW: usize = 512;

/// So many solid angles take about a tenth of a second.
const FEW_ANGLES: u64 = 1 << 21;

/// A scene with the rule of each object, and which of the objects are open.
pub(super) struct Solids<'a> {
    pub(super) scene: &'a Scene,
    pub(super) rules: Vec<Rule>,
    /// The objects whose winding number counts.
    pub(super) open: Vec<usize>,
}

/// Crossings of some rays, and those of one of them.
pub(super) struct Met<'a> {
    all: &'a AllHits,
    range: Range<usize>,
}

impl<'a> Met<'a> {
    /// The objects that are crossed, in the order of the crossings.
    pub(super) fn objects(&self) -> impl Iterator<Item = usize> + use<'a> {
        let objects = self.all.hits.object[self.range.clone()].iter();
        // Of hits, none is -1.
        objects.map(|&object| object.cast_unsigned() as usize)
    }

    /// The same, each with its `t`.
    pub(super) fn crossings(&self) -> impl Iterator<Item = (f64, usize)> + use<'a> {
        let t = self.all.hits.t[self.range.clone()].iter().copied();
        t.zip(self.objects())
    }
}

impl<'a> Solids<'a> {
    pub(super) fn new(scene: &'a Scene) -> Result<Self> {
        let rules = rules(scene)?;
        let open = (0..rules.len()).filter(|&k| rules[k] == Rule::WindingNumber);
        let open = open.collect();
        Ok(Self { scene, rules, open })
    }

    /// Whether a point is in an open object, as its winding number says. A point outside the mesh's box never is.
    pub(super) fn is_in_open(
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
        // Either way round: by parity a mesh that faces inwards holds the same points.
        Ok(is_in_box && winding_number(mesh, point, watch)?.abs() > 0.5)
    }

    fn is_little(&self, rays: usize) -> bool {
        let meshes = self
            .open
            .iter()
            .filter_map(|&k| self.scene.objects()[k].mesh());
        let triangles: u64 = meshes.map(|mesh| mesh.triangles().len() as u64).sum();
        rays < FEW && triangles.saturating_mul(rays as u64) < FEW_ANGLES
    }

    /// Makes a row of `answers` for each ray, of all its crossings after `t_min`; `t_max` is ignored. `state` makes scratch memory, which
    /// is used again: it is called once for each piece of work that is under way at the same time.
    pub(super) fn sweep<T: Send, S: Send>(
        &self,
        rays: &dyn Rays,
        (by, answers): (By, &mut [T]),
        watch: &dyn Watch,
        state: impl Fn() -> Result<S> + Sync,
        answer: impl Fn(&mut S, &Ray, &Met<'_>, &mut [T]) -> Result<()> + Sync,
    ) -> Result<()> {
        let width = by.width(self.scene);
        if width == 0 {
            watch.advance(rays.len() as u64);
            return Ok(());
        }
        let (engine, mut all) = (Cpu::default(), AllHits::default());
        let piece = if self.is_little(rays.len()) {
            BLOCK
        } else {
            PIECE
        };
        for (number, answers) in answers.chunks_mut(BLOCK * width).enumerate() {
            let (first, count) = (number * BLOCK, answers.len() / width);
            let part = Part { rays, first, count };
            trace_into(
                &engine,
                self.scene,
                &part,
                (All::default(), &mut all),
                &OnlyStops(watch),
            )?;
            let all = &all;
            let pieces = answers.chunks_mut(piece * width).enumerate();
            parallel::try_each_with(&state, pieces, |state, (number, answers)| {
                if watch.is_stopped() {
                    return Err(Error::Interrupted);
                }
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

/// Some of many rays, without their ends.
struct Part<'a> {
    rays: &'a dyn Rays,
    first: usize,
    count: usize,
}

impl Rays for Part<'_> {
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
