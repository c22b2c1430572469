//! A tile of 16 x 16 pixels: which triangle is visible in each pixel, then where it is met.
//!
//! 1. Fill a [`VisibilityBuffer`] from the meshes that may be seen in the tile, the nearest first.
//! 2. Compute the hits of its pixels from that, eight at a time (`resolve.rs`).
//! 3. Intersect the other shapes that may be seen in the tile, eight rays at a time
//!    (`shoot/shapes.rs`). Objects that fit neither step get single rays; so does everything where
//!    float32 cannot do the tile.

use super::pixels::Pixels;
use super::plan::{GridSource, MOST_SHAPES, Placed, Plan, Rest, camera_of_tile};
use super::square::Square;
use super::tile_rays::TileRays;
use crate::accel::{Displacements, TILE, TileFrustum, TileScratch, VisibilityBuffer, fill_buffer};
use crate::geometry::{DVec3, PixelGrid, Ray, arrays};
use crate::shoot::batch::Memory;
use crate::shoot::hits::HitSlices;
use crate::shoot::ray_query::{FirstHit, RayQuery};
use crate::shoot::shapes::{FirstOfShapes, rays_of_row};
use crate::shoot::single::SingleRay;
use crate::simd::{Kernel, Lanes, WIDE};

/// See [the module](self).
pub(super) struct TileTask<'a> {
    pub(super) plan: &'a Plan<'a>,
    /// The rays of the tile, unless they are those of the plan's grid.
    pub(super) rays: Option<TileRays<'a>>,
    /// The largest distance of these rays from the grid, in pixels; `None` where that is too far.
    off: Option<f64>,
    /// The grid that its rays are on, or near: the picture's, or its own.
    pub(super) grid: PixelGrid,
    /// The tile's first pixel in the grid.
    corner: [usize; 2],
    /// The divisor that makes a depth of `Placed::entry`.
    unit: f64,
    /// The row and column of the tile among tiles.
    tile: [usize; 2],
    /// The row of the tile's first pixel in the picture.
    first_row: usize,
    first_column: usize,
    /// The number of pixels down and across.
    size: [usize; 2],
    /// The index in their square at which its results begin.
    first_index: usize,
    pub(super) pixels: Pixels,
    /// The comparisons of two triangles of a mesh by the exact test.
    pub(super) compared: u32,
}

impl<'a> TileTask<'a> {
    #[inline(always)]
    pub(super) fn new<L: Lanes>(
        l: L,
        plan: &'a Plan<'a>,
        (tile, first_index): ([usize; 2], usize),
        rays: Option<TileRays<'a>>,
        displacements: &mut Displacements,
    ) -> Self {
        let grid = &plan.grid;
        let [first_row, first_column] = arrays::map(tile, |k| k * TILE);
        let rows = (grid.rows - first_row).min(TILE);
        let columns = (grid.columns - first_column).min(TILE);
        let own = match &rays {
            Some(rays) if plan.source == GridSource::Curved => {
                Some(rays.grid(grid.position, [rows, columns]))
            }
            _ => None,
        };
        let is_unfit = own.is_some_and(|own| own.is_none());
        let own = own.flatten();
        let corner = if own.is_some() { [0, 0] } else { [first_row, first_column] };
        let grid = own.unwrap_or(*grid);
        let pixels = Pixels::new(&grid, corner, [rows, columns]);
        let off = match &rays {
            _ if is_unfit => None,
            Some(rays) if own.is_some() => {
                rays.displacements(l, &grid, &pixels, rows, displacements)
            }
            Some(rays) => rays.distance(l, &grid, &pixels, rows),
            None => Some(0.0),
        };
        Self {
            plan,
            rays,
            off,
            grid,
            corner,
            unit: own.map_or(1.0, |own| 1.01 * longest(&own)),
            tile,
            first_row,
            first_column,
            size: [rows, columns],
            first_index,
            pixels,
            compared: 0,
        }
    }

    /// Writes the tile's hits to its square; `near` is the square's [list](Plan::list_near).
    #[inline(always)]
    pub(super) fn run<L: Lanes>(
        &mut self,
        l: L,
        (memory, scratch, displacements): (&mut Memory, &mut TileScratch, &Displacements),
        near: &[u32],
        out: &mut HitSlices<'_>,
    ) {
        let [rows, columns] = self.size;
        let mut buffer = VisibilityBuffer::new(rows, columns);
        let is_filled = self.fill(l, (scratch, displacements), near, &mut buffer);
        if is_filled {
            self.resolve(l, &buffer, self.size, out);
        }
        match &self.plan.rest {
            Rest::Nothing if is_filled => {}
            Rest::Shapes(shapes) if is_filled => self.intersect_shapes(l, shapes, out),
            _ => {
                for row in 0..rows {
                    self.complete(l, memory, row, columns, is_filled, out);
                }
            }
        }
    }

    /// Intersects the shapes that may be seen in the tile.
    #[inline(always)]
    fn intersect_shapes<L: Lanes>(&self, l: L, shapes: &[Placed], out: &mut HitSlices<'_>) {
        let mut objects = [0; MOST_SHAPES];
        let mut count = 0;
        let [row, column] = self.tile;
        for placed in shapes {
            if placed.rows.contains(&row) && placed.columns.contains(&column) {
                objects[count] = placed.object;
                count += 1;
            }
        }
        if count == 0 {
            return;
        }
        l.call(IntersectShapes { tile: self, objects: &objects[..count], out });
    }

    /// Fills the visibility buffer; `false` where float32 cannot.
    #[inline(always)]
    fn fill<L: Lanes>(
        &mut self,
        l: L,
        (scratch, displacements): (&mut TileScratch, &Displacements),
        near: &[u32],
        buffer: &mut VisibilityBuffer,
    ) -> bool {
        let Some(off) = self.off else {
            return false;
        };
        let plan = self.plan;
        let displacements = (plan.source == GridSource::Curved).then_some(displacements);
        let rest = displacements.map_or(off, |_| Displacements::REST);
        let [row, column] = self.tile;
        for &index in near {
            let placed = &plan.meshes[index as usize];
            if !(placed.rows.contains(&row) && placed.columns.contains(&column)) {
                continue;
            }
            // All pixels meet something nearer already: nearer than the objects that come later,
            // too.
            if placed.entry / self.unit > 1.000_001 * f64::from(buffer.limit(l)) {
                break;
            }
            let Some((_, tree)) = plan.scene.plain_mesh(placed.object) else {
                continue;
            };
            let object = &plan.scene.objects()[placed.object as usize];
            let camera = camera_of_tile(&self.grid, object, [off, rest], self.corner);
            let Some(frustum) = TileFrustum::new(tree, &camera) else {
                return false;
            };
            let seen = (&frustum, displacements);
            fill_buffer(l, scratch, tree, seen, placed.object, buffer, self);
        }
        true
    }

    /// The index at which a row begins in the square's results.
    #[inline(always)]
    pub(super) fn at(&self, row: usize) -> usize {
        self.first_index + row * Square::STRIDE
    }

    /// Shoots single rays at what the tile leaves out: at all objects unless `is_filled`, else at
    /// those that tiles cannot do.
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
        for column in 0..columns {
            let at = self.at(row) + column;
            let ray = self.ray(row, column);
            let mut single = SingleRay::new(memory, plan.scene, &ray, FirstHit::START);
            if is_filled {
                single = single.after(out.get(at), &plan.is_tiled);
            }
            out.put(at, &l.call(single).0);
        }
    }

    /// The ray of a pixel of the tile.
    pub(super) fn ray(&self, row: usize, column: usize) -> Ray {
        // A lens may take long to make it once more.
        if let (Some(rays), Some(_)) = (&self.rays, self.off) {
            return rays.ray(row, column);
        }
        let columns = self.plan.grid.columns;
        let pixel = (self.first_row + row) * columns + self.first_column + column;
        self.plan.rays.ray(pixel)
    }

    /// Fills `rays` with those of a row of the tile.
    fn read_row(&self, row: usize, rays: &mut [Ray]) {
        if self.rays.is_none() {
            let first = (self.first_row + row) * self.plan.grid.columns + self.first_column;
            return self.grid.read(first, rays);
        }
        for (column, ray) in rays.iter_mut().enumerate() {
            *ray = self.ray(row, column);
        }
    }

    /// The depth of a hit at `t`, in units of the viewplane's.
    pub(super) fn depth(&self, row: usize, column: usize, t: f64) -> f64 {
        let grid = &self.grid;
        if self.rays.is_some() {
            let normal = grid.right.cross(grid.upwards);
            let direction = self.ray(row, column).direction;
            let depth = t * direction.dot(normal) / grid.toward.dot(normal);
            return depth + f64::from(u8::from(grid.starts_on_viewplane));
        }
        let unit = if grid.parallel.is_some() {
            grid.toward.length()
        } else {
            grid.point(self.first_row + row, self.first_column + column).length()
        };
        t / unit + f64::from(u8::from(grid.starts_on_viewplane))
    }
}

/// The largest distance from its position of the corners of a grid that has a pixel more on each
/// side, for rays that are off it.
fn longest(grid: &PixelGrid) -> f64 {
    let [width, height] = grid.size();
    let (right, up) =
        ((0.5 * grid.width + width) * grid.right, (0.5 * grid.height + height) * grid.upwards);
    let corners = [right + up, right - up, up - right, -right - up];
    let lengths = arrays::map(corners, |corner: DVec3| (grid.toward + corner).length());
    lengths.into_iter().fold(0.0, f64::max)
}

/// The rays of a tile against shapes other than meshes, as a function of its own: most pictures
/// have none.
struct IntersectShapes<'r, 'a, 'out> {
    tile: &'r TileTask<'a>,
    objects: &'r [u32],
    out: &'r mut HitSlices<'out>,
}

impl Kernel for IntersectShapes<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { tile, objects, out } = self;
        let grid = &tile.grid;
        let [rows, columns] = tile.size;
        let mut x = [[0.0; WIDE]; TILE / WIDE];
        for (column, x) in x.as_flattened_mut().iter_mut().enumerate() {
            *x = grid.x(tile.first_column + column.min(columns - 1));
        }
        let mut rays = [Ray::new(DVec3::ZERO, DVec3::ZERO); TILE];
        for row in 0..rows {
            if tile.rays.is_some() {
                tile.read_row(row, &mut rays[..columns]);
            }
            let y = grid.y(tile.first_row + row);
            for (first, x) in (0..columns).step_by(WIDE).zip(&x) {
                let count = (columns - first).min(WIDE);
                let eight = FirstOfShapes {
                    scene: tile.plan.scene,
                    objects,
                    at: tile.at(row) + first,
                    count,
                    out: &mut *out,
                };
                if tile.rays.is_none() {
                    let (bundle, are_same) = rays_of_row(l, grid, y, x);
                    if are_same == u8::MAX {
                        eight.of_bundle(l, &bundle);
                        continue;
                    }
                    tile.read_row(row, &mut rays[..columns]);
                }
                eight.of_rays(l, &rays[first..first + count]);
            }
        }
    }
}
