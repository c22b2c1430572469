//! The rays of a tile where they are not those of one grid: as they are, in lanes, and how far they
//! are off a grid.
//!
//! The rays of an array are near the grid of the whole picture, or they are not for tiles. Those of
//! a lens are near a grid of their own in each tile, and how far each is off that is known: what is
//! left of its error is rounding.

use super::fit::{FARTHEST, is_sound, viewplane};
use super::pixels::{HALVES, Pixels};
use super::square::SIDE;
use crate::accel::{BLOCK, Displacements, TILE, block_and_lane};
use crate::geometry::{DMat3, DVec3, PixelGrid, Ray, Rays, arrays};
use crate::simd::{Lanes, WIDE};

/// Tiles across and down a square.
const TILES: usize = SIDE / TILE;

/// The rays of a square of tiles as they are, in lanes: memory gives long rows far faster than
/// short ones.
#[derive(Debug)]
pub(super) struct SquareRays {
    /// The origins for each half of a block, tile by tile and row by row, and each axis.
    origin: Vec<[[f64; WIDE]; 3]>,
    direction: Vec<[[f64; WIDE]; 3]>,
    /// The tiles in which a ray begins or ends somewhere, row by row.
    has_ends: [bool; TILES * TILES],
}

impl Default for SquareRays {
    fn default() -> Self {
        Self {
            origin: vec![[[0.0; WIDE]; 3]; TILES * TILES * HALVES],
            direction: vec![[[0.0; WIDE]; 3]; TILES * TILES * HALVES],
            has_ends: [false; TILES * TILES],
        }
    }
}

impl SquareRays {
    /// Takes the rays from a row and a column of the grid on, at most `rows` rows.
    #[inline(always)]
    pub(super) fn load(
        &mut self,
        rays: &dyn Rays,
        grid: &PixelGrid,
        [row, column]: [usize; 2],
        rows: usize,
    ) {
        let rows = (grid.rows - row).min(rows).min(SIDE);
        let columns = (grid.columns - column).min(SIDE);
        self.has_ends.fill(false);
        let mut row_of_rays = [Ray::new(DVec3::ZERO, DVec3::ZERO); SIDE];
        for down in 0..rows.next_multiple_of(BLOCK) {
            // Where the square ends within a block, its last row again.
            if down < rows {
                let first = (row + down) * grid.columns + column;
                rays.read(first, &mut row_of_rays[..columns]);
            }
            // Likewise its last ray.
            let last = row_of_rays[columns - 1];
            row_of_rays[columns..].fill(last);
            for (across, ray) in row_of_rays.iter().enumerate() {
                let tile = down / TILE * TILES + across / TILE;
                self.has_ends[tile] |= !ray.is_whole();
                let (block, lane) = block_and_lane(down % TILE, across % TILE);
                let half = tile * HALVES + 2 * block + lane / WIDE;
                let (origin, direction) = (&mut self.origin[half], &mut self.direction[half]);
                for axis in 0..3 {
                    origin[axis][lane % WIDE] = ray.origin[axis];
                    direction[axis][lane % WIDE] = ray.direction[axis];
                }
            }
        }
    }

    /// Takes the rays of a [picture](Rays::picture) that all start at `position`, from a row and a
    /// column on, at most `rows` rows.
    pub(super) fn load_directions(
        &mut self,
        rays: &dyn Rays,
        grid: &PixelGrid,
        [row, column]: [usize; 2],
        rows: usize,
    ) {
        let rows = (grid.rows - row).min(rows).min(SIDE);
        let columns = (grid.columns - column).min(SIDE);
        self.has_ends.fill(false);
        for origin in &mut self.origin {
            *origin = arrays::map(grid.position.to_array(), |x| [x; WIDE]);
        }
        let mut row_of_directions = [[0.0; SIDE]; 3];
        for down in 0..rows.next_multiple_of(BLOCK) {
            // Where the square ends within a block, its last row again.
            if down < rows {
                let first = (row + down) * grid.columns + column;
                let [x, y, z] = &mut row_of_directions;
                let axes = [&mut x[..columns], &mut y[..columns], &mut z[..columns]];
                rays.read_directions(first, axes);
            }
            // Likewise its last ray.
            for axis in &mut row_of_directions {
                for across in columns..SIDE {
                    axis[across] = axis[columns - 1];
                }
            }
            for across in (0..SIDE).step_by(BLOCK) {
                let tile = down / TILE * TILES + across / TILE;
                let (block, lane) = block_and_lane(down % TILE, across % TILE);
                let direction = &mut self.direction[tile * HALVES + 2 * block + lane / WIDE];
                for axis in 0..3 {
                    let from = &row_of_directions[axis][across..];
                    arrays::copy::<_, BLOCK>(from, &mut direction[axis][lane % WIDE..]);
                }
            }
        }
    }

    /// A cone around all rays with a direction in `tiles_down` rows of tiles: its axis, and the
    /// cosine of its half angle.
    pub(super) fn cone(&self, tiles_down: usize) -> (DVec3, f64) {
        let halves = &self.direction[..tiles_down * TILES * HALVES];
        let directions = || {
            let lanes = halves
                .iter()
                .flat_map(|[x, y, z]| (0..WIDE).map(|lane| DVec3::new(x[lane], y[lane], z[lane])));
            lanes.filter(|direction| direction.is_finite() && *direction != DVec3::ZERO)
        };
        let sum: DVec3 = directions().map(DVec3::normalize).sum();
        let axis = sum.normalize_or(DVec3::Z);
        let cosines = directions().map(|direction| direction.normalize().dot(axis));
        (axis, cosines.fold(1.0, f64::min))
    }

    /// The rays of a tile, by its row and column in the square.
    pub(super) fn tile(&self, (row, column): (usize, usize)) -> TileRays<'_> {
        let tile = row * TILES + column;
        TileRays { square: self, first: tile * HALVES, has_ends: self.has_ends[tile] }
    }
}

/// The rays of a tile.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileRays<'a> {
    square: &'a SquareRays,
    /// The index of the tile's first half block.
    first: usize,
    has_ends: bool,
}

/// [`FARTHEST`] for curved rays, which are near a grid in no more than a tile.
const FARTHEST_CURVED: f64 = 1.0;

/// Writes lanes in single precision.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "which is allowed for")]
fn put<L: Lanes>(l: L, value: L::Doubles, to: &mut [f32]) {
    let mut lanes = [0.0; WIDE];
    l.store64(value, &mut lanes);
    for k in 0..WIDE {
        to[k] = lanes[k] as f32;
    }
}

impl TileRays<'_> {
    /// The largest distance of the rays from the grid, in pixels; `None` when not all of them are
    /// like those of a camera. The tile has its pixels in `rows` rows.
    #[inline(always)]
    pub(super) fn distance<L: Lanes>(
        &self,
        l: L,
        grid: &PixelGrid,
        pixels: &Pixels,
        rows: usize,
    ) -> Option<f64> {
        if self.has_ends {
            return None;
        }
        let mut farthest = l.splat64(0.0);
        for half in 0..2 * BLOCK * rows.div_ceil(BLOCK) {
            let (is_plain, squares) = self.squares(l, grid, pixels, half);
            if is_plain != u8::MAX {
                return None;
            }
            farthest = l.max64(squares, farthest);
        }
        let mut all = [0.0; WIDE];
        l.store64(farthest, &mut all);
        let [width, height] = grid.size();
        let pixel = width.min(height);
        // Rows and columns need not be at a right angle, nor parallel rays at one to the grid.
        let normal = grid.right.cross(grid.upwards);
        let sine = match grid.parallel {
            Some(parallel) => normal.dot(parallel.normalize()).abs(),
            None => normal.length(),
        };
        let off = 1.01 * all.into_iter().fold(0.0, f64::max).sqrt() / (pixel * sine);
        (off < FARTHEST).then_some(off)
    }

    /// Computes the displacement of each ray from the grid, and returns the largest along either
    /// axis, in pixels; `None` when not all of them are like those of a camera at the grid's
    /// position. The tile has its pixels in `rows` rows.
    #[inline(always)]
    pub(super) fn displacements<L: Lanes>(
        &self,
        l: L,
        grid: &PixelGrid,
        pixels: &Pixels,
        rows: usize,
        displacements: &mut Displacements,
    ) -> Option<f64> {
        // From a direction to where it crosses the viewplane, in pixels, times its depth.
        let [width, height] = grid.size();
        let axes = DMat3::from_cols(width * grid.right, -height * grid.upwards, grid.toward);
        let inverse = axes.inverse();
        let rows_of_inverse = arrays::from_fn::<_, 3>(|k| inverse.row(k));
        let [per_width, per_height] = [width.recip(), height.recip()];
        let mut most = l.splat64(0.0);
        for half in 0..2 * BLOCK * rows.div_ceil(BLOCK) {
            let d = [
                self.direction(l, half, 0),
                self.direction(l, half, 1),
                self.direction(l, half, 2),
            ];
            macro_rules! along {
                ($k:literal) => {{
                    let row = rows_of_inverse[$k];
                    let sum =
                        l.add64(l.mul64(d[0], l.splat64(row.x)), l.mul64(d[1], l.splat64(row.y)));
                    l.add64(sum, l.mul64(d[2], l.splat64(row.z)))
                }};
            }
            let (x, y, depth) = (along!(0), along!(1), along!(2));
            // Directions of other lengths would have to be scaled. Written so that a NaN fails.
            let is_plain = l.lt64(l.splat64(1e-20), depth) & l.lt64(depth, l.splat64(1e20));
            if is_plain != u8::MAX {
                return None;
            }
            let inverse = l.div64(l.splat64(1.0), depth);
            let own_x = l.mul64(pixels.x(l, half), l.splat64(per_width));
            let own_y = l.mul64(pixels.y(l, half), l.splat64(per_height));
            let across = l.sub64(l.mul64(x, inverse), own_x);
            // Pixels count their heights upwards.
            let down = l.add64(l.mul64(y, inverse), own_y);
            most = l.max64(l.max64(l.abs64(across), l.abs64(down)), most);
            let at = half % 2 * WIDE;
            put(l, across, &mut displacements.across[half / 2][at..]);
            put(l, down, &mut displacements.down[half / 2][at..]);
        }
        let mut all = [0.0; WIDE];
        l.store64(most, &mut all);
        let most = 1.01 * all.into_iter().fold(0.0, f64::max) + Displacements::REST;
        #[expect(clippy::cast_possible_truncation, reason = "a hundredth more")]
        let in_single = most as f32;
        displacements.most = in_single;
        (most < FARTHEST_CURVED).then_some(most)
    }

    /// A grid that the rays are near, if they all start at `position`: a parallelogram through four
    /// of them that are so far inside that the others are off by as much in the middle as at the
    /// edges.
    pub(super) fn grid(&self, position: DVec3, [rows, columns]: [usize; 2]) -> Option<PixelGrid> {
        let ends = |count: usize| {
            let inset = (count - 1) * 3 / 20;
            [inset, count - 1 - inset]
        };
        let ([top, bottom], [left, right]) = (ends(rows), ends(columns));
        if bottom <= top || right <= left {
            return None;
        }
        let direction = |row: usize, column: usize| self.ray(row, column).direction;
        let [p, q, r] = viewplane([
            direction(top, left),
            direction(top, right),
            direction(bottom, left),
            direction(bottom, right),
        ])?;
        let across = (q - p) / (right - left) as f64;
        let down = (r - p) / (bottom - top) as f64;
        let first = p - left as f64 * across - top as f64 * down;
        let (width, height) = (across.length(), down.length());
        let grid = PixelGrid {
            rows,
            columns,
            first: [0, 0],
            whole: [rows, columns],
            position,
            toward: first + 0.5 * (columns - 1) as f64 * across + 0.5 * (rows - 1) as f64 * down,
            right: across / width,
            upwards: -down / height,
            width: width * columns as f64,
            height: height * rows as f64,
            parallel: None,
            starts_on_viewplane: false,
            offset: PixelGrid::CENTRE,
        };
        // Far aside a fisheye's pixels lean.
        let is_unscaled = (1e-60..1e60).contains(&grid.toward.length());
        (is_unscaled && is_sound(&grid, 0.95)).then_some(grid)
    }

    /// The rays, of eight, that are like those of a camera, a bit each, and the squares of their
    /// distances from the grid's points.
    #[inline(always)]
    fn squares<L: Lanes>(
        &self,
        l: L,
        grid: &PixelGrid,
        pixels: &Pixels,
        half: usize,
    ) -> (u8, L::Doubles) {
        macro_rules! vector {
            ($part:ident) => {
                [self.$part(l, half, 0), self.$part(l, half, 1), self.$part(l, half, 2)]
            };
        }
        let number = |x: f64| l.splat64(x);
        let (o, d) = (vector!(origin), vector!(direction));
        let (x, y) = (pixels.x(l, half), pixels.y(l, half));
        let normal = grid.right.cross(grid.upwards);
        let across = l.mul64(d[0], number(normal.x));
        let along = l.add64(across, l.mul64(d[1], number(normal.y)));
        let along = l.add64(along, l.mul64(d[2], number(normal.z)));
        // Where the ray crosses the viewplane, from the grid's position on, and where it should.
        let length = l.div64(number(normal.dot(grid.toward)), along);
        let mut squares = number(0.0);
        let mut is_plain = l.lt64(number(0.0), length);
        for axis in 0..3 {
            let relative = l.sub64(o[axis], number(grid.position[axis]));
            let across = l.add64(number(grid.toward[axis]), l.mul64(x, number(grid.right[axis])));
            let point = l.add64(across, l.mul64(y, number(grid.upwards[axis])));
            let crossing = if let Some(parallel) = grid.parallel {
                // All from where they start, all the same way.
                let same = number(parallel[axis]);
                is_plain &= l.le64(d[axis], same) & l.le64(same, d[axis]);
                relative
            } else {
                // All from one point.
                is_plain &= l.le64(l.abs64(relative), number(0.0));
                l.mul64(d[axis], length)
            };
            let off = l.sub64(crossing, point);
            squares = l.add64(squares, l.mul64(off, off));
            is_plain &= l.lt64(l.abs64(d[axis]), number(1e80));
        }
        let longest = l.max64(l.max64(l.abs64(d[0]), l.abs64(d[1])), l.abs64(d[2]));
        is_plain &= l.lt64(number(1e-80), longest) & l.lt64(squares, number(1e160));
        (is_plain, squares)
    }

    /// A ray, of those without ends.
    pub(super) fn ray(&self, row: usize, column: usize) -> Ray {
        let (block, lane) = block_and_lane(row, column);
        let half = self.first + 2 * block + lane / WIDE;
        let vector = |parts: &[[f64; WIDE]; 3]| {
            DVec3::from_array(arrays::from_fn(|axis| parts[axis][lane % WIDE]))
        };
        let SquareRays { origin, direction, .. } = self.square;
        Ray::new(vector(&origin[half]), vector(&direction[half]))
    }

    /// The origins of eight rays, half a block, along an axis.
    #[inline(always)]
    pub(super) fn origin<L: Lanes>(&self, l: L, half: usize, axis: usize) -> L::Doubles {
        l.load64(&self.square.origin[self.first + half][axis % 3])
    }

    /// The directions of eight rays along an axis.
    #[inline(always)]
    pub(super) fn direction<L: Lanes>(&self, l: L, half: usize, axis: usize) -> L::Doubles {
        l.load64(&self.square.direction[self.first + half][axis % 3])
    }
}
