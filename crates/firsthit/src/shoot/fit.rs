//! The camera in an array of rays: many are those of a picture's pixels, whoever made them.
//!
//! A grid of pixels is fitted to the rays in the corners, and each tile compares all its rays with it. The grid only
//! serves to rule triangles out, by as much less as the rays are off it; what decides, and where they meet it, are the
//! rays themselves.

use crate::accel::TILE;
use crate::geometry::{DMat3, DVec3, PixelGrid, Ray, Rays};
use crate::simd::{Lanes, WIDE};

/// The grid that `rays` are on, as far as those in the corners tell; `None` for any other rays.
pub(super) fn grid(rays: &dyn Rays) -> Option<PixelGrid> {
    let columns = columns(rays)?;
    let rows = rays.len() / columns;
    if rows < TILE || rows * columns != rays.len() {
        return None;
    }
    let corner = |row: usize, column: usize| {
        let ray = rays.ray(row * (rows - 1) * columns + column * (columns - 1));
        ray.is_valid().then_some(ray)
    };
    let corners = [corner(0, 0)?, corner(0, 1)?, corner(1, 0)?, corner(1, 1)?];
    let [first, right, below, last] = corners;
    let is_parallel = right.direction == first.direction && below.direction == first.direction;
    // Three corners of the viewplane, from the eye; of parallel rays, where they start.
    let [p, q, r] = if is_parallel {
        [first.origin, right.origin, below.origin]
    } else {
        viewplane([first, right, below, last].map(|ray| ray.direction))?
    };
    let (across, down) = ((q - p) / (columns - 1) as f64, (r - p) / (rows - 1) as f64);
    let middle = p.midpoint(q) + 0.5 * (r - p);
    let grid = PixelGrid {
        rows,
        columns,
        position: if is_parallel {
            middle - first.direction
        } else {
            first.origin
        },
        toward: if is_parallel { first.direction } else { middle },
        right: across.normalize(),
        upwards: -down.normalize(),
        width: across.length() * columns as f64,
        height: down.length() * rows as f64,
        parallel: is_parallel.then_some(first.direction),
        starts_on_viewplane: is_parallel,
    };
    // Written so that a NaN fails.
    let is_sound = grid.right.dot(grid.upwards).abs() < 0.5
        && grid.right.cross(grid.upwards).dot(grid.toward).abs() > 1e-3 * grid.toward.length();
    let on_grid = |k: usize| {
        let (row, column) = (k % 5 * (rows - 1) / 4, k / 5 * (columns - 1) / 4);
        is_near(&grid, row, column, &rays.ray(row * columns + column))
    };
    (is_sound && (0..25).all(on_grid)).then_some(grid)
}

/// Whether a ray goes through the grid's pixel, roughly; for all of a tile see [`TileRays::load`].
fn is_near(grid: &PixelGrid, row: usize, column: usize, ray: &Ray) -> bool {
    let normal = grid.right.cross(grid.upwards);
    let length = grid.toward.dot(normal) / ray.direction.dot(normal);
    let crossing = match grid.parallel {
        Some(_) => ray.origin - grid.position,
        None => length * ray.direction,
    };
    let pixel = grid.width / grid.columns as f64;
    (crossing - grid.point(row, column)).length() < FARTHEST * pixel
}

/// The ends of four rays from an eye that make a parallelogram (but for the last): the first has the length it has.
/// That is where a picture's corners are.
fn viewplane([first, right, below, last]: [DVec3; 4]) -> Option<[DVec3; 3]> {
    let lengths = DMat3::from_cols(right, below, -last).inverse() * first;
    let is_ahead = lengths.cmpgt(DVec3::ZERO).all() && lengths.is_finite();
    is_ahead.then_some([first, lengths.x * right, lengths.y * below])
}

/// How many rays there are in a row, if there are rows: the next one begins with a leap.
fn columns(rays: &dyn Rays) -> Option<usize> {
    /// Of a row's steps, none is so many times longer than the one before.
    const LEAP: f64 = 5.0;
    let count = rays.len();
    let (first, second) = (rays.ray(0), rays.ray(1.min(count.checked_sub(1)?)));
    let is_parallel = first.direction == second.direction;
    let place = |ray: Ray| {
        if is_parallel {
            ray.origin
        } else {
            ray.direction.normalize()
        }
    };
    let mut last = place(second);
    let mut step = (last - place(first)).length();
    for k in 2..count {
        let next = place(rays.ray(k));
        let length = (next - last).length();
        if length > LEAP * step {
            return (k >= TILE).then_some(k);
        }
        (last, step) = (next, length);
        // Written so that a NaN fails.
        let goes_on = step > 0.0;
        if !goes_on {
            return None;
        }
    }
    None
}

/// A tile's rays as they are, in lanes.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct TileRays {
    /// For each row and half of it, and each axis.
    origin: [[[f64; WIDE]; 3]; 2 * TILE],
    direction: [[[f64; WIDE]; 3]; 2 * TILE],
}

/// Rays farther from their grid than this share of a pixel are not for tiles.
const FARTHEST: f64 = 0.01;

impl TileRays {
    pub(super) const NONE: Self = Self {
        origin: [[[0.0; WIDE]; 3]; 2 * TILE],
        direction: [[[0.0; WIDE]; 3]; 2 * TILE],
    };

    /// Takes the tile at a row and a column of the grid, which has so many rows and columns left; `None` when not all
    /// rays are like those of a camera, else how far they are off the grid at most, in pixels.
    #[inline(always)]
    pub(super) fn load<L: Lanes>(
        &mut self,
        l: L,
        rays: &dyn Rays,
        grid: &PixelGrid,
        [row, column]: [usize; 2],
        [rows, columns]: [usize; 2],
    ) -> Option<f64> {
        let mut row_of_rays = [Ray::new(DVec3::ZERO, DVec3::ZERO); TILE];
        for down in 0..rows {
            rays.fill(
                (row + down) * grid.columns + column,
                &mut row_of_rays[..columns],
            );
            for (across, ray) in row_of_rays.iter().enumerate() {
                // Where a tile ends early, its last ray again.
                let ray = if across < columns {
                    ray
                } else {
                    &row_of_rays[columns - 1]
                };
                if ray.t_max != f64::INFINITY {
                    return None;
                }
                let (half, lane) = (2 * down + across / WIDE, across % WIDE);
                for axis in 0..3 {
                    self.origin[half][axis][lane] = ray.origin[axis];
                    self.direction[half][axis][lane] = ray.direction[axis];
                }
            }
        }
        self.distance(l, grid, [row, column], [rows, columns])
    }

    /// See [`TileRays::load`].
    #[inline(always)]
    fn distance<L: Lanes>(
        &self,
        l: L,
        grid: &PixelGrid,
        [row, column]: [usize; 2],
        [rows, columns]: [usize; 2],
    ) -> Option<f64> {
        let normal = grid.right.cross(grid.upwards);
        let number = |x: f64| l.splat64(x);
        let plane = number(normal.dot(grid.toward));
        let mut farthest = number(0.0);
        for half in 0..2 * rows {
            macro_rules! vector {
                ($part:ident) => {
                    [
                        self.$part(l, half, 0),
                        self.$part(l, half, 1),
                        self.$part(l, half, 2),
                    ]
                };
            }
            let (o, d) = (vector!(origin), vector!(direction));
            let mut x = [0.0; WIDE];
            for (lane, x) in x.iter_mut().enumerate() {
                *x = grid.x(column + (WIDE * (half % 2) + lane).min(columns - 1));
            }
            let x = l.load64(&x);
            let base = grid.toward + grid.y(row + half / 2) * grid.upwards;
            let along = l.add64(
                l.add64(
                    l.mul64(d[0], number(normal.x)),
                    l.mul64(d[1], number(normal.y)),
                ),
                l.mul64(d[2], number(normal.z)),
            );
            // Where the ray crosses the viewplane, from the grid's position on, and where it should.
            let length = l.div64(plane, along);
            let mut squares = number(0.0);
            let mut is_plain = l.lt64(number(0.0), length);
            for axis in 0..3 {
                let relative = l.sub64(o[axis], number(grid.position[axis]));
                let point = l.add64(number(base[axis]), l.mul64(x, number(grid.right[axis])));
                let crossing = match grid.parallel {
                    // All from where they start, all the same way.
                    Some(parallel) => {
                        let same = number(parallel[axis]);
                        is_plain &= l.le64(d[axis], same) & l.le64(same, d[axis]);
                        relative
                    }
                    // All from one point.
                    None => {
                        is_plain &= l.le64(l.abs64(relative), number(0.0));
                        l.mul64(d[axis], length)
                    }
                };
                let off = l.sub64(crossing, point);
                squares = l.add64(squares, l.mul64(off, off));
                is_plain &= l.lt64(l.abs64(d[axis]), number(1e80));
            }
            let longest = l.max64(l.max64(l.abs64(d[0]), l.abs64(d[1])), l.abs64(d[2]));
            is_plain &= l.lt64(number(1e-80), longest) & l.lt64(squares, number(1e160));
            if is_plain != u8::MAX {
                return None;
            }
            farthest = l.max64(squares, farthest);
        }
        let mut all = [0.0; WIDE];
        l.store64(farthest, &mut all);
        let pixel = (grid.width / grid.columns as f64).min(grid.height / grid.rows as f64);
        // Twice: rows and columns need not be at a right angle.
        let off = 2.0 * all.into_iter().fold(0.0, f64::max).sqrt() / pixel;
        (off < FARTHEST).then_some(off)
    }

    /// Where eight rays start, half a row, along an axis.
    #[inline(always)]
    pub(super) fn origin<L: Lanes>(&self, l: L, half: usize, axis: usize) -> L::Doubles {
        l.load64(&self.origin[half % (2 * TILE)][axis % 3])
    }

    /// Where they go.
    #[inline(always)]
    pub(super) fn direction<L: Lanes>(&self, l: L, half: usize, axis: usize) -> L::Doubles {
        l.load64(&self.direction[half % (2 * TILE)][axis % 3])
    }
}
