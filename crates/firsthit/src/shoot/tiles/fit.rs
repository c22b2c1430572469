//! The camera in an array of rays: many are those of a picture's pixels, whoever made them.
//!
//! 1. Find how long a row is: where one begins, there is a leap from ray to ray.
//! 2. Fit a grid of pixels to the rays in the corners.
//! 3. Check 25 rays, evenly over the rows and columns. Any that is not near the grid means that there is no camera.
//! 4. Each tile measures how far its rays are off the grid, and adds that to its bounds.
//!
//! The grid only serves to rule triangles out. What decides, and where they are met, are the rays themselves.

use super::pixels::{HALVES, Pixels};
use super::square::SIDE;
use crate::accel::{BLOCK, TILE, block_and_lane};
use crate::geometry::{DMat3, DVec3, PixelGrid, Ray, Rays};
use crate::simd::{Lanes, WIDE};

/// The grid of the whole rows in `rays`, and the ray that those begin with, as far as the corners and a few others tell;
/// `None` for any other rays. Before and behind there may be a part of a row.
pub(super) fn grid(rays: &dyn Rays) -> Option<(usize, PixelGrid)> {
    let (start, columns) = columns(rays)?;
    let rows = (rays.len() - start) / columns;
    if rows < TILE {
        return None;
    }
    let corner = |row: usize, column: usize| {
        let ray = rays.ray(start + row * (rows - 1) * columns + column * (columns - 1));
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
        first: [0, 0],
        whole: [rows, columns],
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
        offset: PixelGrid::CENTRE,
    };
    let on_grid = |k: usize| {
        let (row, column) = (k % 5 * (rows - 1) / 4, k / 5 * (columns - 1) / 4);
        is_near(
            &grid,
            row,
            column,
            &rays.ray(start + row * columns + column),
        )
    };
    (is_sound(&grid) && (0..25).all(on_grid)).then_some((start, grid))
}

/// Whether a grid's axes are well apart.
fn is_sound(grid: &PixelGrid) -> bool {
    // Written so that a NaN fails.
    grid.right.dot(grid.upwards).abs() < 0.5
        && grid.right.cross(grid.upwards).dot(grid.toward).abs() > 1e-3 * grid.toward.length()
}

/// Rows, columns and the start of rays that all start in one point: tiles have grids of their own.
pub(super) fn around(rays: &dyn Rays, [rows, columns]: [usize; 2]) -> Option<PixelGrid> {
    if rows < 2 || columns < 2 {
        return None;
    }
    Some(PixelGrid {
        rows,
        columns,
        first: [0, 0],
        whole: [rows, columns],
        position: rays.ray(0).origin,
        toward: DVec3::Z,
        right: DVec3::X,
        upwards: DVec3::Y,
        width: 1.0,
        height: 1.0,
        parallel: None,
        starts_on_viewplane: false,
        offset: PixelGrid::CENTRE,
    })
}

/// Whether a ray goes through the grid's pixel, roughly; for all of a tile see [`TileRays::distance`].
fn is_near(grid: &PixelGrid, row: usize, column: usize, ray: &Ray) -> bool {
    let normal = grid.right.cross(grid.upwards);
    let length = grid.toward.dot(normal) / ray.direction.dot(normal);
    let (crossing, is_alike) = match grid.parallel {
        Some(parallel) => (ray.origin - grid.position, ray.direction == parallel),
        None => (length * ray.direction, ray.origin == grid.position),
    };
    let [pixel, _] = grid.size();
    is_alike && ray.is_whole() && (crossing - grid.point(row, column)).length() < FARTHEST * pixel
}

/// The ends of four rays from an eye that make a parallelogram (but for the last): the first has the length it has.
/// That is where a picture's corners are.
fn viewplane([first, right, below, last]: [DVec3; 4]) -> Option<[DVec3; 3]> {
    let lengths = DMat3::from_cols(right, below, -last).inverse() * first;
    let is_ahead = lengths.cmpgt(DVec3::ZERO).all() && lengths.is_finite();
    is_ahead.then_some([first, lengths.x * right, lengths.y * below])
}

/// Where the first whole row begins, and how many rays there are in a row, if there are rows: each begins with a leap.
fn columns(rays: &dyn Rays) -> Option<(usize, usize)> {
    /// Of a row's steps, none is so many times longer than the one before.
    const LEAP: f64 = 5.0;
    /// Longer rows are not looked for.
    const LONGEST: usize = 1 << 16;
    let count = rays.len();
    if count < TILE {
        return None;
    }
    let (first, second) = (rays.ray(0), rays.ray(1));
    let is_parallel = first.direction == second.direction;
    let point = |ray: Ray| {
        if is_parallel {
            ray.origin
        } else {
            ray.direction.normalize()
        }
    };
    let mut leap = None;
    let mut last = point(second);
    let mut step = (last - point(first)).length();
    for k in 2..count.min(2 * LONGEST) {
        let next = point(rays.ray(k));
        let length = (next - last).length();
        if length > LEAP * step {
            let Some(first) = leap else {
                leap = Some(k);
                last = next;
                continue;
            };
            let columns = k - first;
            return (columns >= TILE && first <= columns).then_some((first % columns, columns));
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

/// Tiles across and down a square.
const TILES: usize = SIDE / TILE;

/// The rays of a square of tiles as they are, in lanes: memory gives long rows far faster than short ones.
#[derive(Debug)]
pub(super) struct SquareRays {
    /// For each half of a block, tile by tile and row by row, and each axis.
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
    /// Takes the rays from a row and a column of the grid on, so many rows at most.
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

    /// A cone around all rays of so many rows of tiles that are a direction: its axis, and the cosine of its half angle.
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

    /// Those of a tile, by its row and column in the square.
    pub(super) fn tile(&self, (row, column): (usize, usize)) -> TileRays<'_> {
        let tile = row * TILES + column;
        TileRays {
            square: self,
            first: tile * HALVES,
            has_ends: self.has_ends[tile],
        }
    }
}

/// The rays of a tile.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileRays<'a> {
    square: &'a SquareRays,
    /// Where it begins.
    first: usize,
    has_ends: bool,
}

/// Rays farther from their grid than this share of a pixel are not for tiles.
pub(super) const FARTHEST: f64 = 0.01;

/// The same for curved rays, which are near a grid in no more than a tile.
pub(super) const FARTHEST_CURVED: f64 = 0.2;

impl TileRays<'_> {
    /// How far the rays are off the grid at most, in pixels; `None` when not all of them are like those of a camera.
    /// The tile has its pixels in so many rows.
    #[inline(always)]
    pub(super) fn distance<L: Lanes>(
        &self,
        l: L,
        grid: &PixelGrid,
        pixels: &Pixels,
        rows: usize,
        most: f64,
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
        (off < most).then_some(off)
    }

    /// A grid that the rays are near, if they all start at `position`: a parallelogram through four of them that are so far inside
    /// that the others are off by as much in the middle as at the edges.
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
        is_sound(&grid).then_some(grid)
    }

    /// Which of eight rays are like those of a camera, and the square of how far each is off the grid's points.
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
                [
                    self.$part(l, half, 0),
                    self.$part(l, half, 1),
                    self.$part(l, half, 2),
                ]
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
            let across = l.add64(
                number(grid.toward[axis]),
                l.mul64(x, number(grid.right[axis])),
            );
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
            DVec3::from_array([0, 1, 2].map(|axis| parts[axis][lane % WIDE]))
        };
        let SquareRays {
            origin, direction, ..
        } = self.square;
        Ray::new(vector(&origin[half]), vector(&direction[half]))
    }

    /// Where eight rays start, half a block, along an axis.
    #[inline(always)]
    pub(super) fn origin<L: Lanes>(&self, l: L, half: usize, axis: usize) -> L::Doubles {
        l.load64(&self.square.origin[self.first + half][axis % 3])
    }

    /// Where they go.
    #[inline(always)]
    pub(super) fn direction<L: Lanes>(&self, l: L, half: usize, axis: usize) -> L::Doubles {
        l.load64(&self.square.direction[self.first + half][axis % 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forty rows of seventy rays.
    fn array(is_parallel: bool) -> Vec<Ray> {
        let toward = DVec3::new(-3.0, 2.5, -0.5).normalize();
        let right = toward.cross(DVec3::new(0.1, 0.2, 1.0)).normalize();
        let grid = PixelGrid {
            rows: 40,
            columns: 70,
            first: [0, 0],
            whole: [40, 70],
            position: DVec3::new(3.0, -2.0, 1.0),
            toward,
            right,
            upwards: right.cross(toward),
            width: 1.4,
            height: 0.8,
            parallel: is_parallel.then_some(toward),
            starts_on_viewplane: false,
            offset: PixelGrid::CENTRE,
        };
        (0..40 * 70).map(|k| grid.ray(k / 70, k % 70)).collect()
    }

    /// All rays go through the grid's points.
    fn assert_fits(rays: &[Ray], columns: usize) {
        let rays = rays.to_vec();
        let (start, grid) = grid(&rays).unwrap();
        assert_eq!(start, 0);
        assert_eq!((grid.columns, grid.rows), (columns, rays.len() / columns));
        for (k, ray) in rays.iter().enumerate() {
            assert!(is_near(&grid, k / columns, k % columns, ray), "{k}");
        }
    }

    #[test]
    fn the_grid_of_a_cameras_rays_is_found() {
        for is_parallel in [false, true] {
            let rays = array(is_parallel);
            assert_fits(&rays, 70);
            // In single precision, in other lengths, and only the left part of the picture, which is not straight
            // ahead.
            let single = |v: DVec3| v.as_vec3().as_dvec3();
            let change = |ray: &Ray| Ray::new(single(ray.origin), 2.0 * single(ray.direction));
            assert_fits(&rays.iter().map(change).collect::<Vec<_>>(), 70);
            let left = rays.chunks(70).flat_map(|row| &row[..20]).copied();
            assert_fits(&left.collect::<Vec<_>>(), 20);
            let (start, part) = grid(&rays[30..2500].to_vec()).unwrap();
            assert_eq!((start, part.columns, part.rows), (40, 70, 34));
            assert!(is_near(&part, 2, 3, &rays[70 + 2 * 70 + 3]));
        }
    }

    #[test]
    fn other_rays_have_no_grid() {
        let rays = array(false);
        assert_eq!(grid(&Vec::<Ray>::new()), None);
        assert_eq!(grid(&rays[..1].to_vec()), None);
        assert_eq!(grid(&vec![rays[0]; 1000]), None);
        assert_eq!(grid(&rays[..71].to_vec()), None, "a row and a ray");
        let bent = |ray: &Ray| {
            let bend = 0.1 * ray.direction.x * ray.direction.y;
            Ray::new(ray.origin, ray.direction + bend * DVec3::Y)
        };
        assert_eq!(grid(&rays.iter().map(bent).collect::<Vec<_>>()), None);
        let ending = rays.iter().map(|ray| ray.up_to(100.0));
        assert_eq!(grid(&ending.collect::<Vec<_>>()), None);
        let beginning = rays.iter().map(|ray| ray.beyond(0.1));
        assert_eq!(grid(&beginning.collect::<Vec<_>>()), None);
        let scattered = |k: usize| rays[k * 37 % rays.len()];
        assert_eq!(
            grid(&(0..rays.len()).map(scattered).collect::<Vec<_>>()),
            None
        );
    }
}
