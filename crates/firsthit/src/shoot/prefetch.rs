//! The triangles of hits that are soon looked up, asked of memory beforehand.
//!
//! Neighbouring hits are on triangles anywhere in memory, and where a triangle's corners are is known only when the
//! triangle has come. So three blocks of hits are in work at a time: the triangles of the block after the next are
//! asked for, the corners of the next block, whose triangles have come meanwhile, and the present one is looked up.

use std::ops::Range;

use super::{Cpu, Hits};
use crate::geometry::Hit;
use crate::scene::{Object, Scene};
use crate::shape::{Mesh, Positions, Shape};
use crate::simd::{self, Kernel, Lanes};

/// How many hits are asked for at a time: their lines fit into a first-level cache, and take longer to look up than
/// memory takes to answer.
const BLOCK: usize = 32;

/// Asks for what hits need, in their order.
pub(crate) struct Prefetched<'a> {
    scene: &'a Scene,
    hits: &'a Hits,
    first: usize,
    count: usize,
}

impl<'a> Prefetched<'a> {
    /// For the hits from `first` on.
    pub(crate) fn new(scene: &'a Scene, hits: &'a Hits, first: usize, count: usize) -> Self {
        let made = Self {
            scene,
            hits,
            first,
            count,
        };
        made.ask(0, Stage::Triangles);
        made.ask(0, Stage::Corners);
        made.ask(BLOCK, Stage::Triangles);
        made
    }

    /// To be called with each hit in turn, before it is looked up.
    #[inline]
    pub(crate) fn advance(&mut self, k: usize) {
        if k.is_multiple_of(BLOCK) && k < self.count {
            self.ask(k + BLOCK, Stage::Corners);
            self.ask(k + 2 * BLOCK, Stage::Triangles);
        }
    }

    /// For the block of hits from `start` on.
    fn ask(&self, start: usize, stage: Stage) {
        let end = (start + BLOCK).min(self.count);
        if start < end {
            let block = Block {
                scene: self.scene,
                hits: self.hits,
                range: self.first + start..self.first + end,
                stage,
            };
            simd::run(Cpu::shared().instruction_set(), block);
        }
    }
}

/// What is asked for.
#[derive(Clone, Copy)]
enum Stage {
    /// The indices of the triangles' corners.
    Triangles,
    /// The corners, by these.
    Corners,
}

struct Block<'a> {
    scene: &'a Scene,
    hits: &'a Hits,
    range: Range<usize>,
    stage: Stage,
}

impl Kernel for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        for index in self.range {
            let hit = self.hits.get(index);
            let Some((mesh, triangle)) = triangle_of(self.scene, &hit) else {
                continue;
            };
            match self.stage {
                Stage::Triangles => ask(l, mesh.triangles().get(triangle)),
                Stage::Corners => {
                    for &vertex in mesh.triangles().get(triangle).into_iter().flatten() {
                        match mesh.positions().as_ref() {
                            Positions::Single(points) => ask(l, points.get(vertex as usize)),
                            Positions::Double(points) => ask(l, points.get(vertex as usize)),
                        }
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn ask<L: Lanes, T>(l: L, what: Option<&T>) {
    if let Some(what) = what {
        l.prefetch(what);
    }
}

/// The mesh and the triangle that were hit, if that is what was hit.
#[inline(always)]
fn triangle_of<'a>(scene: &'a Scene, hit: &Hit) -> Option<(&'a Mesh, usize)> {
    match scene.object(hit).map(Object::shape) {
        Some(Shape::Mesh(mesh)) => Some((mesh, usize::try_from(hit.primitive).ok()?)),
        _ => None,
    }
}
