//! Software prefetching of the triangles of hits.
//!
//! Looking up a hit reads the triangle's vertex indices, and then the vertices that they name: two
//! cache misses, the second of which cannot begin before the first has ended. So the loop is a
//! pipeline over blocks of hits. While block k is looked up, the vertices of block k + 1 and the
//! vertex indices of block k + 2 are prefetched.

use std::ops::Range;

use super::{Cpu, Hits};
use crate::geometry::Hit;
use crate::scene::{Object, Scene};
use crate::shape::{Mesh, Positions, Shape};
use crate::simd::{self, Kernel, Lanes};

/// The number of hits in a block: their cache lines fit into a first-level cache, and they take
/// longer to look up than memory takes to answer.
const BLOCK: usize = 32;

/// Prefetches the triangles of some hits, a block ahead of where they are looked up.
#[doc(hidden)]
pub struct Prefetcher<'a> {
    scene: &'a Scene,
    hits: &'a Hits,
    first: usize,
    count: usize,
}

impl<'a> Prefetcher<'a> {
    /// Begins to prefetch for `count` hits from number `first` on. With a `count` of 0 it does
    /// nothing.
    pub fn new(scene: &'a Scene, hits: &'a Hits, first: usize, count: usize) -> Self {
        let made = Self { scene, hits, first, count };
        made.prefetch(0, Stage::Triangles);
        made.prefetch(0, Stage::Vertices);
        made.prefetch(BLOCK, Stage::Triangles);
        made
    }

    /// Prefetches for later hits; called with the number of each hit in turn, from 0, before it is
    /// looked up.
    #[inline]
    pub fn advance(&mut self, k: usize) {
        if k.is_multiple_of(BLOCK) && k < self.count {
            self.prefetch(k + BLOCK, Stage::Vertices);
            self.prefetch(k + 2 * BLOCK, Stage::Triangles);
        }
    }

    /// Prefetches for the block of hits from `start` on.
    fn prefetch(&self, start: usize, stage: Stage) {
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

/// The stage of prefetching.
#[derive(Clone, Copy)]
enum Stage {
    /// The vertex indices of triangles.
    Triangles,
    /// The vertices that these name.
    Vertices,
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
                Stage::Triangles => prefetch(l, mesh.triangles().get(triangle)),
                Stage::Vertices => {
                    for &vertex in mesh.triangles().get(triangle).into_iter().flatten() {
                        match mesh.positions().as_ref() {
                            Positions::Single(points) => prefetch(l, points.get(vertex as usize)),
                            Positions::Double(points) => prefetch(l, points.get(vertex as usize)),
                        }
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn prefetch<L: Lanes, T>(l: L, what: Option<&T>) {
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
