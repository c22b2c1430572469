//! A camera's rays, tile by tile: float32 finds who wins each pixel, float64 says where it is met.

mod develop;

use super::fit::TileRays;
use super::hits::{HitSlices, Square};
use super::journey::{FirstHit, Quest};
use super::object::Moderate;
use super::pixels::Pixels;
use super::plan::{Plan, TALL, bundle, tileable};
use super::trees::{Memory, SingleRay};
use crate::accel::{Arbiter, Frame, Settling, TILE, Tile, Winner, fill};
use crate::geometry::{Hit, Ray};
use crate::scene::Scene;
use crate::shape::{Crossing, triangle::Shear};
use crate::simd::{Kernel, Lanes};

/// Some rows of tiles.
pub(super) struct Band<'a> {
    pub(super) plan: &'a Plan<'a>,
    /// Its number, from the top.
    pub(super) index: usize,
    pub(super) out: HitSlices<'a>,
}

impl Kernel for Band<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        let mut memory = Memory::take();
        let mut square = memory.square.take().unwrap_or_default();
        let first = self.index * self.plan.tiles_down;
        let [down, across] =
            [self.plan.grid.rows, self.plan.grid.columns].map(|n| n.div_ceil(TILE));
        let mut rays = memory.square_rays.take();
        let mut near = Vec::new();
        for left in (0..across).step_by(TALL) {
            self.plan.list_near(first, left, &mut near);
            if self.plan.is_fitted {
                let rays = rays.get_or_insert_default();
                let place = [first * TILE, left * TILE];
                let rows = self.plan.tiles_down * TILE;
                rays.load(self.plan.rays, &self.plan.grid, place, rows);
            }
            // Neighbours one after the other: what the one has brought into the cache the next one needs.
            for (dx, dy) in ORDER {
                let tile = (first + dy, left + dx);
                if dy < self.plan.tiles_down && tile.0 < down && tile.1 < across {
                    let rays = rays.as_ref().filter(|_| self.plan.is_fitted);
                    let rays = rays.map(|rays| rays.tile((dy, dx)));
                    self.tile(
                        l,
                        (&mut memory, &near),
                        tile,
                        (dy, dx),
                        rays,
                        &mut square.out(),
                    );
                }
            }
            let columns = self.plan.grid.columns;
            self.out
                .take(l, &mut square, left * TILE, columns, self.plan.is_large);
        }
        l.end_streams();
        memory.square = Some(square);
        memory.square_rays = rays;
        memory.give_back();
    }
}

/// The tiles of a square of a band, columns and rows, along Morton's curve.
const ORDER: [(usize, usize); TALL * TALL] = {
    let mut order = [(0, 0); TALL * TALL];
    let mut k = 0;
    while k < order.len() {
        order[k] = (k & 1 | k >> 1 & 2, k >> 1 & 1 | k >> 2 & 2);
        k += 1;
    }
    order
};

impl Band<'_> {
    /// The tile in a row and a column of tiles; `place` is where it stands in its square, `near` is the
    /// square's [list](Plan::list_near), `rays` are its rays where they are an array's.
    #[inline(always)]
    fn tile<L: Lanes>(
        &self,
        l: L,
        (memory, near): (&mut Memory, &[u32]),
        (row, column): (usize, usize),
        place: (usize, usize),
        rays: Option<TileRays<'_>>,
        out: &mut HitSlices<'_>,
    ) {
        let grid = &self.plan.grid;
        let rows = (grid.rows - row * TILE).min(TILE);
        let columns = (grid.columns - column * TILE).min(TILE);
        let first = [row * TILE, column * TILE];
        let places = Pixels::new(grid, first, [rows, columns]);
        let off = match &rays {
            Some(rays) => rays.distance(l, grid, &places, rows),
            None => Some(0.0),
        };
        let mut work = Work {
            plan: self.plan,
            rays,
            off: off.unwrap_or(f64::INFINITY),
            row: first[0],
            column: first[1],
            first: Square::place(place.0 * TILE, place.1 * TILE),
            pixels: places,
        };
        let mut found = Tile::new(rows, columns);
        let is_filled = off.is_some() && work.fill(l, (memory, near), row, column, &mut found);
        if is_filled {
            work.develop(l, &found, [rows, columns], out);
        }
        for row in 0..rows {
            work.complete(l, memory, row, columns, is_filled, out);
        }
    }
}

/// A tile by its first pixel.
struct Work<'a> {
    plan: &'a Plan<'a>,
    /// Its rays where they are an array's.
    rays: Option<TileRays<'a>>,
    /// What they are off the grid, in pixels.
    off: f64,
    row: usize,
    column: usize,
    /// Where in its square it begins.
    first: usize,
    pixels: Pixels,
}

impl Work<'_> {
    /// Whether float32 could tell who wins.
    #[inline(always)]
    fn fill<L: Lanes>(
        &mut self,
        l: L,
        (memory, near): (&mut Memory, &[u32]),
        band: usize,
        tile: usize,
        found: &mut Tile,
    ) -> bool {
        let plan = self.plan;
        for &index in near {
            let placed = &plan.meshes[index as usize];
            if !(placed.rows.contains(&band) && placed.columns.contains(&tile)) {
                continue;
            }
            // What all pixels meet already is nearer, than those that come later too.
            if placed.entry > 1.000_001 * f64::from(found.limit(l)) {
                break;
            }
            let Some((_, tree)) = tileable(plan.scene, placed.object) else {
                continue;
            };
            let object = &plan.scene.objects()[placed.object as usize];
            let bundle = bundle(&plan.grid, object, self.off, [self.row, self.column]);
            let Some(frame) = Frame::new(tree, &bundle) else {
                return false;
            };
            fill(
                l,
                &mut memory.scratch,
                tree,
                &frame,
                placed.object,
                found,
                self,
            );
        }
        true
    }

    /// Where in the square's results a row begins.
    #[inline(always)]
    fn at(&self, row: usize) -> usize {
        self.first + row * Square::STRIDE
    }

    /// Shoots single rays at what the tile leaves out: at all objects unless `is_filled`, else at those that tiles
    /// cannot do.
    #[inline(always)]
    fn complete<L: Lanes>(
        &self,
        l: L,
        memory: &mut Memory,
        row: usize,
        columns: usize,
        is_filled: bool,
        out: &mut HitSlices<'_>,
    ) {
        let plan = self.plan;
        if is_filled && plan.all_tiled {
            return;
        }
        for column in 0..columns {
            let at = self.at(row) + column;
            let pixel = (self.row + row) * plan.grid.columns + self.column + column;
            let ray = plan.rays.ray(pixel);
            let mut single = SingleRay::new(memory, plan.scene, &ray, FirstHit::START);
            if is_filled {
                single = single.after(out.get(at), &plan.is_tiled);
            }
            out.put(at, &l.call(single).0);
        }
    }

    /// The ray of a pixel of the tile.
    fn ray(&self, row: usize, column: usize) -> Ray {
        let columns = self.plan.grid.columns;
        let pixel = (self.row + row) * columns + self.column + column;
        self.plan.rays.ray(pixel)
    }

    /// The judge's word about one pixel and one triangle.
    #[inline(always)]
    fn decide<L: Lanes>(&self, l: L, row: usize, column: usize, winner: Winner) -> Option<Hit> {
        let ray = self.ray(row, column);
        let scene = self.plan.scene;
        l.call(Decision { scene, ray, winner })
    }

    /// Whether `new` is the first of two hits of a pixel.
    fn precedes(&self, row: usize, column: usize, new: &Hit, old: &Hit) -> bool {
        Moderate::new(&self.ray(row, column))
            .is_some_and(|moderate| moderate.precedes(self.plan.scene, new, old))
    }

    /// The depth of a hit at `t`, in units of the viewplane's.
    fn depth(&self, row: usize, column: usize, t: f64) -> f64 {
        let grid = &self.plan.grid;
        if self.rays.is_some() {
            let normal = grid.right.cross(grid.upwards);
            let direction = self.ray(row, column).direction;
            let depth = t * direction.dot(normal) / grid.toward.dot(normal);
            return depth + f64::from(u8::from(grid.starts_on_viewplane));
        }
        let unit = if grid.parallel.is_some() {
            grid.toward.length()
        } else {
            grid.point(self.row + row, self.column + column).length()
        };
        t / unit + f64::from(u8::from(grid.starts_on_viewplane))
    }
}

/// What the judge says about a ray and a triangle, in a function of its own, which is rarely called.
struct Decision<'a> {
    scene: &'a Scene,
    ray: Ray,
    winner: Winner,
}

impl Kernel for Decision<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Option<Hit> {
        let Winner {
            object: index,
            slot,
        } = self.winner;
        let (mesh, tree) = tileable(self.scene, index)?;
        let moderate = Moderate::new(&self.ray)?;
        let object = &self.scene.objects()[index as usize];
        let ray = moderate.in_object(object, moderate.ray.t_max)?;
        let corners = tree.corners_in(mesh, slot);
        let hit = Shear::new(&ray).intersect_by(corners, |doubtful| l.call(Settling(doubtful)))?;
        let primitive = tree.triangle_in(slot).cast_signed();
        let crossing: Crossing = hit.crossing(primitive);
        ray.holds(hit.t)
            .then(|| moderate.hit(index, crossing))
            .flatten()
    }
}

impl Arbiter for Work<'_> {
    #[inline(never)]
    fn settle<L: Lanes>(
        &mut self,
        l: L,
        row: usize,
        column: usize,
        old: Winner,
        new: Winner,
    ) -> Option<(Winner, f64)> {
        let challenger = self.decide(l, row, column, new)?;
        let champion = if old == Winner::NONE {
            None
        } else {
            self.decide(l, row, column, old)
        };
        let (winner, hit) = match champion {
            Some(champion) if !self.precedes(row, column, &challenger, &champion) => {
                (old, champion)
            }
            _ => (new, challenger),
        };
        Some((winner, self.depth(row, column, hit.t)))
    }
}
