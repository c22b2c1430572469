//! A band of a picture: some rows of tiles, a square of 4 x 4 tiles at a time.

use std::cell::Cell;

use super::plan::{GridSource, Plan, TALL};
use super::square::Square;
use super::tile::TileTask;
use super::tile_rays::SquareRays;
use crate::accel::{Displacements, TILE, TileScratch};
use crate::shoot::batch::Memory;
use crate::shoot::hits::HitSlices;
use crate::simd::{Kernel, Lanes};

/// See [the module](self).
pub(super) struct Band<'a> {
    pub(super) plan: &'a Plan<'a>,
    /// The band's number, from the top.
    pub(super) index: usize,
    pub(super) out: HitSlices<'a>,
}

impl Kernel for Band<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        assert!(L::HAS_PACKETS, "`trace_hits` asks before");
        let plan = self.plan;
        let mut memory = Memory::take();
        let mut tiles = TILES.take().unwrap_or_else(|| TileMemory {
            scratch: TileScratch::default(),
            square: Square::default(),
            rays: None,
            displacements: Displacements::NONE,
        });
        let TileMemory { scratch, square, rays, displacements } = &mut tiles;
        let first = self.index * plan.tiles_down;
        let [down, across] = [plan.grid.rows.div_ceil(TILE), plan.grid.columns.div_ceil(TILE)];
        let mut near = Vec::new();
        for left in (0..across).step_by(TALL) {
            plan.list_near(first, left, &mut near);
            let is_loaded = plan.source != GridSource::Grid;
            if is_loaded {
                let rays = rays.get_or_insert_default();
                let corner = [first * TILE, left * TILE];
                let rows = plan.tiles_down * TILE;
                if plan.source == GridSource::Curved {
                    rays.load_directions(plan.rays, &plan.grid, corner, rows);
                } else {
                    rays.load(plan.rays, &plan.grid, corner, rows);
                }
            }
            if let Some(rays) = rays.as_ref().filter(|_| plan.source == GridSource::Curved)
                && near.len() > FEW
            {
                plan.list_in_cone(rays.cone(plan.tiles_down), &mut near);
            }
            // Neighbours one after the other: what one has brought into the cache the next one
            // needs.
            for (dx, dy) in ORDER {
                let [row, column] = [first + dy, left + dx];
                if dy < plan.tiles_down && row < down && column < across {
                    let rays = rays.as_ref().filter(|_| is_loaded);
                    let rays = rays.map(|rays| rays.tile((dy, dx)));
                    let at = Square::index_of(dy * TILE, dx * TILE);
                    let mut task = TileTask::new(l, plan, ([row, column], at), rays, displacements);
                    task.run(l, (&mut memory, scratch, displacements), &near, &mut square.out());
                }
            }
            self.out.take(l, square, left * TILE, plan.grid.columns, plan.is_large);
        }
        l.end_streams();
        TILES.set(Some(tiles));
        memory.give_back();
    }
}

/// The most objects for which asking their trees costs less than finding where they are seen.
const FEW: usize = 3;

thread_local! {
    /// Made once for each thread.
    static TILES: Cell<Option<TileMemory>> = const { Cell::new(None) };
}

/// Memory for tiles, to be used again.
struct TileMemory {
    scratch: TileScratch,
    square: Square,
    /// Made when rays are not those of one grid.
    rays: Option<SquareRays>,
    /// The displacements of the tile that is being done.
    displacements: Displacements,
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
