//! A camera's rays, tile by tile: float32 finds who wins each pixel, float64 says where it is met.

use std::ops::Range;

use super::fit::{self, TileRays};
use super::hits::{Out, RowOfHits, SIDE};
use super::journey::{FirstHit, Journey, Quest};
use super::object::Moderate;
use super::trees::{self, Memory};
use crate::accel::{
    Arbiter, Bundle, Corners, Frame, MeshTree, Pencil, TILE, Tile, Winner, axes, fill,
    largest_axis, verdict,
};
use crate::geometry::{DVec3, Hit, PixelGrid, Rays};
use crate::scene::{Object, Scene};
use crate::shape::{Crossing, Mesh, Shape, triangle::Shear};
use crate::simd::{Kernel, LANES, Lanes, WIDE};

/// A scene made ready for a grid of pixels.
pub(super) struct Plan<'a> {
    scene: &'a Scene,
    rays: &'a dyn Rays,
    grid: PixelGrid,
    /// Whether the rays are an array's, and only near the grid.
    is_fitted: bool,
    /// What tiles can do, the nearest first.
    meshes: Vec<Placed>,
    /// Whether an object is in there, and whether all are.
    is_tiled: Vec<bool>,
    all_tiled: bool,
    /// Rows of tiles in a band.
    tiles_down: usize,
    /// Whether the results are more than the caches hold.
    is_large: bool,
}

/// An object, and the tiles that it may be seen in.
struct Placed {
    object: u32,
    rows: Range<usize>,
    columns: Range<usize>,
    depth: f64,
}

impl<'a> Plan<'a> {
    /// `None` when rays one by one are the better way.
    pub(super) fn new(scene: &'a Scene, rays: &'a dyn Rays) -> Option<Self> {
        let (grid, is_fitted) = match rays.grid() {
            Some(grid) => (grid, false),
            None => (fit::grid(rays)?, true),
        };
        if !is_moderate(&grid) {
            return None;
        }
        let mut is_tiled = vec![false; scene.objects().len()];
        let mut meshes = Vec::new();
        for (index, object) in (0..).zip(scene.objects()) {
            if scene.is_covered(index) {
                is_tiled[index as usize] = true;
            } else if tileable(scene, index).is_some() {
                is_tiled[index as usize] = true;
                meshes.extend(placed(&grid, index, object));
            }
        }
        meshes.sort_by(|a: &Placed, b| a.depth.total_cmp(&b.depth));
        // Enough bands for all threads; fewer, and one of them would be waited for.
        let many = 8 * rayon::current_num_threads();
        let tiles_down = if grid.rows >= many * TALL * TILE {
            TALL
        } else {
            1
        };
        let all_tiled = !is_tiled.contains(&false);
        is_tiled.contains(&true).then_some(Self {
            scene,
            rays,
            grid,
            is_fitted,
            meshes,
            is_tiled,
            all_tiled,
            tiles_down,
            is_large: grid.rows * grid.columns >= LARGE,
        })
    }

    /// How many pixels a band has, but for the last one.
    pub(super) fn band(&self) -> usize {
        self.tiles_down * TILE * self.grid.columns
    }
}

/// The mesh and the tree of an object whose triangles are all there is to it.
fn tileable(scene: &Scene, index: u32) -> Option<(&Mesh, &MeshTree)> {
    let object = &scene.objects()[index as usize];
    match (object.shape(), scene.mesh_tree(index as usize)) {
        (Shape::Mesh(mesh), Some(tree)) if tree.has_nodes() && !object.may_have_holes() => {
            Some((mesh, tree))
        }
        _ => None,
    }
}

/// Whether no direction needs other units (see [`Moderate`]).
fn is_moderate(grid: &PixelGrid) -> bool {
    let toward = grid.toward.length();
    let range = 1e-80..1e80;
    range.contains(&toward) && grid.width < 1e80 && grid.height < 1e80
}

/// Where an object may be seen; `None` for nowhere.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of a float saturates"
)]
fn placed(grid: &PixelGrid, index: u32, object: &Object) -> Option<Placed> {
    let bounds = object.mesh()?.bounds();
    let aim = grid.toward.normalize();
    let focal = grid.toward.length();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in bounds.corners() {
        let world = object
            .transform()
            .world_from_object()
            .transform_point3(corner);
        let relative = world - grid.position;
        let depth = relative.dot(aim);
        let share = if grid.parallel.is_some() {
            1.0
        } else {
            focal / depth
        };
        let seen = DVec3::new(
            share * relative.dot(grid.right),
            share * relative.dot(grid.upwards),
            depth,
        );
        (low, high) = (low.min(seen), high.max(seen));
    }
    // Far more than rounding.
    let slack = 1e-9 * (high.abs().max(low.abs()).z + grid.position.abs().max_element());
    let whole = Placed {
        object: index,
        rows: 0..grid.rows.div_ceil(TILE),
        columns: 0..grid.columns.div_ceil(TILE),
        depth: low.z,
    };
    let skew = [
        (grid.right, aim),
        (grid.upwards, aim),
        (grid.right, grid.upwards),
    ];
    if skew.iter().any(|(a, b)| a.dot(*b).abs() > 1e-6) {
        return Some(whole);
    }
    if high.z < -slack {
        return None;
    }
    // Written so that a NaN leads to all of the picture.
    let is_in_front = low.z > slack || grid.parallel.is_some();
    if !(is_in_front && low.is_finite() && high.is_finite()) {
        return Some(whole);
    }
    let tiles = |low: f64, high: f64, size: f64, count: usize| {
        let pixel = size / count as f64;
        let blur = if grid.parallel.is_some() {
            slack
        } else {
            slack * focal / low.max(slack)
        };
        let pad = 1.0 + blur / pixel;
        let tile = |x: f64| (x / pixel + 0.5 * count as f64) / TILE as f64;
        let first = (tile(low) - pad).floor().max(0.0) as usize;
        first..((tile(high) + pad).ceil().max(0.0) as usize).min(count.div_ceil(TILE))
    };
    let columns = tiles(low.x, high.x, grid.width, grid.columns);
    let rows = tiles(-high.y, -low.y, grid.height, grid.rows);
    (!columns.is_empty() && !rows.is_empty()).then_some(Placed {
        rows,
        columns,
        ..whole
    })
}

/// Some rows of tiles.
pub(super) struct Band<'a> {
    pub(super) plan: &'a Plan<'a>,
    /// Its number, from the top.
    pub(super) index: usize,
    pub(super) out: Out<'a>,
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
        for left in (0..across).step_by(TALL) {
            // Neighbours one after the other: what the one has brought into the cache the next one needs.
            for (dx, dy) in ORDER {
                let tile = (first + dy, left + dx);
                if dy < self.plan.tiles_down && tile.0 < down && tile.1 < across {
                    self.tile(l, &mut memory, tile, (dy, dx), &mut square.out());
                }
            }
            let columns = self.plan.grid.columns;
            self.out
                .take(l, &square, left * TILE, columns, self.plan.is_large);
        }
        l.end_streams();
        memory.square = Some(square);
        memory.give_back();
    }
}

/// From so many pixels on, results go past the caches.
const LARGE: usize = 1 << 17;

/// Tiles down a band, where there are many bands.
const TALL: usize = SIDE / TILE;

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
    /// The tile in a row and a column of tiles; `place` is where it stands in its square.
    #[inline(always)]
    fn tile<L: Lanes>(
        &self,
        l: L,
        memory: &mut Memory,
        (row, column): (usize, usize),
        place: (usize, usize),
        out: &mut Out<'_>,
    ) {
        let grid = &self.plan.grid;
        let rows = (grid.rows - row * TILE).min(TILE);
        let columns = (grid.columns - column * TILE).min(TILE);
        let mut rays = memory.tile_rays.take();
        let mut off = Some(0.0);
        if self.plan.is_fitted {
            let rays = rays.get_or_insert_with(|| Box::new(TileRays::NONE));
            let first = [row * TILE, column * TILE];
            off = rays.load(l, self.plan.rays, grid, first, [rows, columns]);
        }
        let mut work = Work {
            plan: self.plan,
            rays: rays.as_deref().filter(|_| self.plan.is_fitted),
            off: off.unwrap_or(f64::INFINITY),
            row: row * TILE,
            column: column * TILE,
            first: (place.0 * SIDE + place.1) * TILE,
            x: [[0.0; WIDE]; 2],
        };
        for (k, x) in work.x.as_flattened_mut().iter_mut().enumerate() {
            *x = grid.x(work.column + k);
        }
        let mut pixels = Tile::new(rows, columns);
        let is_filled = off.is_some() && work.fill(l, memory, row, column, &mut pixels);
        if is_filled {
            work.develop(l, &pixels, [rows, columns], out);
        }
        for row in 0..rows {
            work.complete(l, memory, row, columns, is_filled, out);
        }
        memory.tile_rays = rays;
    }
}

/// An object as a tile sees it.
#[derive(Clone, Copy)]
struct Sight<'a> {
    index: u32,
    object: &'a Object,
    mesh: &'a Mesh,
    tree: &'a MeshTree,
    /// The axis that its rays mostly go along.
    z: usize,
}

/// A tile by its first pixel.
struct Work<'a> {
    plan: &'a Plan<'a>,
    /// Its rays where they are an array's.
    rays: Option<&'a TileRays>,
    /// What they are off the grid, in pixels.
    off: f64,
    row: usize,
    column: usize,
    /// Where in its square it begins.
    first: usize,
    /// Where on the viewplane its columns are.
    x: [[f64; WIDE]; 2],
}

impl Work<'_> {
    /// Whether float32 could tell who wins.
    #[inline(always)]
    fn fill<L: Lanes>(
        &mut self,
        l: L,
        memory: &mut Memory,
        band: usize,
        tile: usize,
        pixels: &mut Tile,
    ) -> bool {
        let plan = self.plan;
        for placed in &plan.meshes {
            if !(placed.rows.contains(&band) && placed.columns.contains(&tile)) {
                continue;
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
                pixels,
                self,
            );
        }
        true
    }

    /// Where in the square's results a row begins.
    #[inline(always)]
    fn at(&self, row: usize) -> usize {
        self.first + row * SIDE
    }

    fn sight(&self, index: u32) -> Option<Sight<'_>> {
        let (mesh, tree) = tileable(self.plan.scene, index)?;
        let object = &self.plan.scene.objects()[index as usize];
        // Of parallel rays the very direction: where two axes are as long, the last bit chooses.
        let along = match self.plan.grid.parallel {
            Some(direction) => object
                .transform()
                .object_from_world()
                .transform_vector3(direction),
            None => bundle(&self.plan.grid, object, 0.0, [self.row, self.column]).centre,
        };
        Some(Sight {
            index,
            object,
            mesh,
            tree,
            z: largest_axis(along),
        })
    }

    /// Writes the hits.
    #[inline(always)]
    fn develop<L: Lanes>(
        &self,
        l: L,
        pixels: &Tile,
        [rows, columns]: [usize; 2],
        out: &mut Out<'_>,
    ) {
        let mut sight: Option<Sight<'_>> = None;
        for row in 0..rows {
            let at = self.at(row);
            let (slots, objects) = pixels.row(row);
            let mut hits = RowOfHits::MISSES;
            let all = l.load(objects);
            let mut left = u16::MAX >> (TILE - columns);
            left &= !l.same(all, l.splat(f32::from_bits(Winner::NONE.object)));
            while left != 0 {
                let object = objects[left.trailing_zeros() as usize % LANES];
                let here = left & l.same(all, l.splat(object));
                left &= !here;
                let index = object.to_bits();
                if sight.is_none_or(|sight| sight.index != index) {
                    sight = self.sight(index);
                }
                if let Some(sight) = &sight {
                    self.develop_object(l, sight, (slots, here), row, &mut hits);
                }
            }
            hits.write(at, columns, out);
        }
    }

    #[inline(always)]
    fn develop_object<L: Lanes>(
        &self,
        l: L,
        sight: &Sight<'_>,
        (slots, here): (&[f32; LANES], u16),
        row: usize,
        hits: &mut RowOfHits,
    ) {
        let axes = axes(sight.z);
        let corners = Corners::new(l, (sight.tree, sight.mesh), axes, slots, here);
        let mut left = here;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            hits.object[lane] = sight.index.cast_signed();
            hits.primitive[lane] = sight.tree.triangle_in(slots[lane].to_bits()).cast_signed();
        }
        for half in 0..2 {
            let [low, high] = here.to_le_bytes();
            let lanes = if half == 0 { low } else { high };
            if lanes == 0 {
                continue;
            }
            let rays = self.pencil(l, sight, row, half);
            let (sound, numbers) = verdict(l, sight.z, &rays, &corners, half);
            hits.put_half(l, half, lanes & sound, numbers);
            let mut open = lanes & !sound;
            while open != 0 {
                let column = WIDE * half + open.trailing_zeros() as usize;
                open &= open - 1;
                let winner = Winner {
                    object: sight.index,
                    slot: slots[column % LANES].to_bits(),
                };
                let hit = self.decide(row, column, winner).unwrap_or(Hit::MISS);
                hits.put(column, &hit);
            }
        }
    }

    /// The rays of eight pixels in an object's space: what [`Rays::ray`] and `ray_in_object` give, operation for
    /// operation.
    #[inline(always)]
    #[expect(clippy::too_many_lines, reason = "a macro for vectors is a part of it")]
    fn pencil<L: Lanes>(&self, l: L, sight: &Sight<'_>, row: usize, half: usize) -> Pencil<L> {
        let object = sight.object;
        let axes = axes(sight.z);
        let grid = &self.plan.grid;
        let x = l.load64(&self.x[half % 2]);
        // Where the object's space is the world's, its axes are taken in their order from the start.
        let is_at_home = object.transform().is_identity();
        let (order, z) = if is_at_home {
            (axes, sight.z)
        } else {
            ([0, 1, 2], 2)
        };
        let up = grid.y(self.row + row) * grid.upwards;
        // The lanes of a vector: an expression for each axis.
        macro_rules! vector {
            ($axis:ident => $value:expr) => {
                [
                    {
                        let $axis = 0;
                        $value
                    },
                    {
                        let $axis = 1;
                        $value
                    },
                    {
                        let $axis = 2;
                        $value
                    },
                ]
            };
        }
        let toward = vector!(k => l.splat64(grid.toward[order[k]]));
        let position = vector!(k => l.splat64(grid.position[order[k]]));
        let point = vector!(k => {
            let across = l.mul64(x, l.splat64(grid.right[order[k]]));
            l.add64(l.add64(toward[k], across), l.splat64(up[order[k]]))
        });
        let (origin, direction) = if let Some(rays) = self.rays {
            let half = 2 * row + half;
            (
                vector!(k => rays.origin(l, half, order[k])),
                vector!(k => rays.direction(l, half, order[k])),
            )
        } else if let Some(parallel) = grid.parallel {
            let start = if grid.starts_on_viewplane {
                point
            } else {
                vector!(k => l.sub64(point[k], toward[k]))
            };
            let origin = vector!(k => l.add64(position[k], start[k]));
            (origin, vector!(k => l.splat64(parallel[order[k]])))
        } else {
            let squares = vector!(k => l.mul64(point[k], point[k]));
            // The sum in the order of the axes of space.
            let [first, second, third] = match z {
                0 => [squares[2], squares[0], squares[1]],
                1 => [squares[1], squares[2], squares[0]],
                _ => squares,
            };
            let length = l.sqrt64(l.add64(l.add64(first, second), third));
            let origin = if grid.starts_on_viewplane {
                vector!(k => l.add64(position[k], point[k]))
            } else {
                position
            };
            (origin, vector!(k => l.div64(point[k], length)))
        };
        let place = object.transform().world_from_object().translation;
        let matrix = &object.transform().object_from_world().matrix3;
        macro_rules! turned {
            ($v:ident, $k:ident) => {{
                let $k = axes[$k];
                let part = [
                    l.mul64(l.splat64(matrix.x_axis[$k]), $v[0]),
                    l.mul64(l.splat64(matrix.y_axis[$k]), $v[1]),
                    l.mul64(l.splat64(matrix.z_axis[$k]), $v[2]),
                ];
                l.add64(l.add64(part[0], part[1]), part[2])
            }};
        }
        if is_at_home {
            return Pencil { origin, direction };
        }
        let moved = vector!(k => l.sub64(origin[k], l.splat64(place[k])));
        Pencil {
            origin: vector!(k => turned!(moved, k)),
            direction: vector!(k => turned!(direction, k)),
        }
    }

    /// Adds what tiles cannot do: everything where `is_tiled` is not set, else the objects that are not meshes.
    #[inline(always)]
    fn complete<L: Lanes>(
        &self,
        l: L,
        memory: &mut Memory,
        row: usize,
        columns: usize,
        is_filled: bool,
        out: &mut Out<'_>,
    ) {
        let plan = self.plan;
        if is_filled && plan.all_tiled {
            return;
        }
        for column in 0..columns {
            let at = self.at(row) + column;
            let pixel = (self.row + row) * plan.grid.columns + self.column + column;
            let ray = plan.rays.ray(pixel);
            if is_filled {
                let known = out.get(at);
                let mut journey = Journey::new(plan.scene, &ray, FirstHit(known), known.t);
                let is_wanted = |object: u32| !plan.is_tiled[object as usize];
                trees::go(l, memory, plan.scene, &mut journey, is_wanted);
                out.put(at, &journey.quest.0);
            } else {
                let mut journey = Journey::new(plan.scene, &ray, FirstHit::START, f64::INFINITY);
                trees::go(l, memory, plan.scene, &mut journey, |_| true);
                out.put(at, &journey.quest.0);
            }
        }
    }

    /// The judge's word about one pixel and one triangle.
    #[inline(never)]
    fn decide(&self, row: usize, column: usize, winner: Winner) -> Option<Hit> {
        let plan = self.plan;
        let (mesh, tree) = tileable(plan.scene, winner.object)?;
        let pixel = (self.row + row) * plan.grid.columns + self.column + column;
        let moderate = Moderate::new(&plan.rays.ray(pixel))?;
        let object = &plan.scene.objects()[winner.object as usize];
        let ray = moderate.in_object(object, moderate.ray.t_max)?;
        let hit = Shear::new(&ray).intersect(tree.corners_in(mesh, winner.slot))?;
        let primitive = tree.triangle_in(winner.slot).cast_signed();
        let crossing: Crossing = hit.crossing(primitive);
        (hit.t > 0.0 && hit.t <= ray.t_max)
            .then(|| moderate.hit(winner.object, crossing))
            .flatten()
    }

    /// The depth of a hit at `t`, in units of the viewplane's.
    fn depth(&self, row: usize, column: usize, t: f64) -> f64 {
        let grid = &self.plan.grid;
        if self.rays.is_some() {
            let pixel = (self.row + row) * grid.columns + self.column + column;
            let normal = grid.right.cross(grid.upwards);
            let direction = self.plan.rays.ray(pixel).direction;
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

impl Arbiter for Work<'_> {
    #[inline(never)]
    fn settle(
        &mut self,
        row: usize,
        column: usize,
        old: Winner,
        new: Winner,
    ) -> Option<(Winner, f64)> {
        let challenger = self.decide(row, column, new)?;
        let champion = if old == Winner::NONE {
            None
        } else {
            self.decide(row, column, old)
        };
        let (winner, hit) = match champion {
            Some(champion) if !challenger.precedes(&champion) => (old, champion),
            _ => (new, challenger),
        };
        Some((winner, self.depth(row, column, hit.t)))
    }
}

/// A tile's rays in an object's space.
fn bundle(grid: &PixelGrid, object: &Object, off: f64, [row, column]: [usize; 2]) -> Bundle {
    let half = 0.5 * (TILE as f64);
    let middle = |size: f64, count: usize, first: usize| {
        -size / 2.0 + size / count as f64 * (first as f64 + half)
    };
    let x = middle(grid.width, grid.columns, column);
    let y = -middle(grid.height, grid.rows, row);
    let aside = x * grid.right + y * grid.upwards;
    let map = object.transform().object_from_world();
    let place = object.transform().world_from_object().translation;
    let turned = |v: DVec3| map.transform_vector3(v);
    let (start, centre) = if grid.parallel.is_some() {
        (grid.position + aside, grid.toward)
    } else {
        (grid.position, grid.toward + aside)
    };
    let matrix = map.matrix3;
    let largest =
        [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.abs().max_element());
    let growth: f64 = largest.iter().sum();
    Bundle {
        eye: turned(start - place),
        centre: turned(centre),
        across: turned(grid.width / grid.columns as f64 * grid.right),
        down: turned(-grid.height / grid.rows as f64 * grid.upwards),
        is_perspective: grid.parallel.is_none(),
        start_depth: f64::from(u8::from(grid.starts_on_viewplane)),
        off,
        largest: growth
            * (start.abs().max_element() + place.abs().max_element() + centre.abs().max_element()),
    }
}
