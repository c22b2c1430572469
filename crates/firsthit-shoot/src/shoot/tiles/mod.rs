//! The rays of a camera, and arrays of rays that are like those of one: tile by tile.

mod band;
mod cost;
mod exact;
mod fit;
mod pixels;
mod plan;
mod resolve;
mod square;
mod tile;
mod tile_rays;

use super::batch::{each_chunk, trace_array};
use super::hits::HitSlices;
use super::squares::trace_picture;
use crate::accel::InstructionSet;
use crate::error::Result;
use crate::geometry::{PixelGrid, Ray, Rays};
use crate::scene::Scene;
use crate::simd;
use crate::watch::Watch;
use band::Band;
use plan::{GridSource, Plan};

/// The first hits of rays: by tiles where they are those of a grid of pixels, or near one.
pub(super) fn trace_hits(
    set: InstructionSet,
    scene: &Scene,
    rays: &dyn Rays,
    hits: HitSlices<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    if !set.has_packets() {
        return trace_array(set, scene, rays, hits, watch);
    }
    let fits = |grid: &PixelGrid| grid.rows.checked_mul(grid.columns) == Some(rays.len());
    let own = rays.grid().filter(fits);
    let picture = rays
        .picture()
        .filter(|&[rows, columns]| own.is_none() && rows.checked_mul(columns) == Some(rays.len()));
    let (first, grid, source) = match (own, picture) {
        (Some(grid), _) => (0, Some(grid), GridSource::Grid),
        (None, Some(size)) => (0, fit::around(rays, size), GridSource::Curved),
        (None, None) => match fit::grid(rays) {
            Some((first, grid)) => (first, Some(grid), GridSource::Fitted),
            None => (0, None, GridSource::Fitted),
        },
    };
    let Some(grid) = grid else {
        return trace_array(set, scene, rays, hits, watch);
    };
    // An array may begin and end within a row of pixels.
    let (before, later) = hits.split_at(first);
    trace_array(set, scene, rays, before, watch)?;
    let count = grid.rows * grid.columns;
    let (inside, after) = later.split_at(count);
    let pixels = Later { rays, first };
    match Plan::new(scene, &pixels, grid, source) {
        Some(plan) => each_chunk(inside, plan.band(), watch, |index, out| {
            let plan = &plan;
            simd::run(set, Band { plan, index, out });
        })?,
        None => trace_picture(set, scene, &pixels, grid.columns, inside, watch)?,
    }
    let first = first + count;
    trace_array(set, scene, &Later { rays, first }, after, watch)
}

/// The rays from one on, which have no filters.
struct Later<'a> {
    rays: &'a dyn Rays,
    first: usize,
}

impl Rays for Later<'_> {
    fn len(&self) -> usize {
        self.rays.len() - self.first
    }

    fn ray(&self, index: usize) -> Ray {
        self.rays.ray(self.first + index)
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        self.rays.read(self.first + first, rays);
    }

    fn array(&self) -> Option<&[Ray]> {
        self.rays.array()?.get(self.first..)
    }

    fn read_directions(&self, first: usize, directions: [&mut [f64]; 3]) {
        self.rays.read_directions(self.first + first, directions);
    }
}
