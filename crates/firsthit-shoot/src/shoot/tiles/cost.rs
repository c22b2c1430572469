//! Whether tiles serve a picture of many objects, or the tree over the objects does.

use std::f64::consts::PI;

use super::plan::{GridSource, Placed, Rest};
use crate::accel::TILE;
use crate::geometry::{DVec3, PixelGrid, Rays};
use crate::scene::Scene;

/// The number of meshes up to which tiles are used whatever they cost.
const MANY: usize = 64;

/// Microseconds of processor time: for each mesh in a tile, for each triangle of a mesh, and for a
/// ray through the tree over many objects. Measured on Zen 4 with AVX2.
const MESH_IN_TILE: f64 = 0.8;
const TRIANGLE: f64 = 3.3e-3;
const RAY_AMONG_MANY: f64 = 0.2;

/// Whether it costs more to bring each mesh into all tiles that it may be seen in than to send the
/// rays through the tree over many objects. Among more than [`MANY`] meshes, where tiles leave any
/// objects to that tree, each ray goes there in any case.
pub(super) fn costs_more(
    scene: &Scene,
    (rays, grid, source): (&dyn Rays, &PixelGrid, GridSource),
    (meshes, rest): (&[Placed], &Rest),
) -> bool {
    if meshes.len() <= MANY {
        return false;
    }
    if matches!(rest, Rest::Any) {
        return true;
    }
    let view = (source == GridSource::Curved).then(|| CurvedView::new(rays, grid));
    let (mut in_tiles, mut triangles) = (0.0, 0);
    for placed in meshes {
        let tiles = match &view {
            Some(view) => view.tiles_of(placed),
            None => (placed.rows.len() * placed.columns.len()) as f64,
        };
        let mesh = scene.plain_mesh(placed.object).filter(|_| tiles > 0.0);
        in_tiles += tiles;
        triangles += mesh.map_or(0, |(mesh, _)| mesh.count());
    }
    MESH_IN_TILE * in_tiles + TRIANGLE * triangles as f64
        > RAY_AMONG_MANY * (grid.rows * grid.columns) as f64
}

/// The view of curved rays, roughly: their tiles are not known yet.
struct CurvedView {
    /// A cone around some of the rays: its axis and half its angle.
    axis: DVec3,
    half: f64,
    /// The solid angle of the tile in the middle.
    tile: f64,
    tiles: f64,
}

impl CurvedView {
    fn new(rays: &dyn Rays, grid: &PixelGrid) -> Self {
        /// Rays each way that the cone is put around.
        const SAMPLES: usize = 9;
        let toward = |row: usize, column: usize| {
            let ray = rays.ray(row * grid.columns + column);
            ray.direction.normalize_or_zero()
        };
        let [last_row, last_column] = [grid.rows - 1, grid.columns - 1];
        let axis = toward(last_row / 2, last_column / 2);
        let samples = (0..SAMPLES * SAMPLES).map(|k| {
            let [row, column] = [k / SAMPLES, k % SAMPLES];
            toward(row * last_row / (SAMPLES - 1), column * last_column / (SAMPLES - 1))
        });
        let half = samples.fold(0.0, |half: f64, at| half.max(angle(axis, at)));
        let [down, across] = [last_row, last_column].map(|last| TILE.min(last));
        let [row, column] = [(last_row - down) / 2, (last_column - across) / 2];
        let corner = toward(row, column);
        let [below, beside] =
            [toward(row + down, column), toward(row, column + across)].map(|at| at - corner);
        Self {
            axis,
            half,
            tile: below.cross(beside).length(),
            tiles: (grid.rows.div_ceil(TILE) * grid.columns.div_ceil(TILE)) as f64,
        }
    }

    /// The number of tiles in which a mesh is seen.
    fn tiles_of(&self, placed: &Placed) -> f64 {
        let (centre, radius) = placed.sphere;
        let of_mesh = libm::asin((radius / centre.length()).min(1.0));
        if angle(self.axis, centre.normalize_or_zero()) > self.half + of_mesh {
            return 0.0;
        }
        let cap = 2.0 * PI * (1.0 - libm::cos(of_mesh));
        (1.0 + cap / self.tile).min(self.tiles)
    }
}

/// The angle between two directions of length one.
fn angle(a: DVec3, b: DVec3) -> f64 {
    libm::acos(a.dot(b).clamp(-1.0, 1.0))
}
