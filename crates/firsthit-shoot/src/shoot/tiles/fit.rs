//! Finds the camera in an array of rays, which often are those of a picture's pixels.
//!
//! 1. Find how long a row is: where one begins, there is a leap from ray to ray.
//! 2. Fit a grid of pixels to the rays in the corners.
//! 3. Check 25 rays, evenly over the rows and columns. Any that is not near the grid means that
//!    there is no camera.
//! 4. Each tile measures how far its rays are off the grid, and adds that to its bounds.
//!
//! The grid only serves to rule triangles out. Hits and their places are those of the rays
//! themselves.
//!
//! Rays that go through no flat grid, as a fisheye's, are fitted tile by tile (`tile_rays.rs`).

use crate::accel::TILE;
use crate::geometry::{DMat3, DVec3, PixelGrid, Ray, Rays};

/// Rays farther from their grid than this share of a pixel are not for tiles.
pub(super) const FARTHEST: f64 = 0.01;

/// The grid of the whole rows in `rays`, and the ray that those begin with, as far as the corners
/// and a few others tell; `None` for any other rays. Before and behind there may be a part of a
/// row.
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
        position: if is_parallel { middle - first.direction } else { first.origin },
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
        is_near(&grid, row, column, &rays.ray(start + row * columns + column))
    };
    (is_sound(&grid, 0.5) && (0..25).all(on_grid)).then_some((start, grid))
}

/// Whether a grid's axes are well apart: the cosine of their angle is below `most`.
pub(super) fn is_sound(grid: &PixelGrid, most: f64) -> bool {
    // Written so that a NaN fails.
    grid.right.dot(grid.upwards).abs() < most
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

/// Whether a ray goes through the grid's pixel, roughly; for all of a tile see
/// [`TileRays::distance`](super::tile_rays::TileRays::distance).
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

/// The ends of four rays from an eye that make a parallelogram (but for the last): the first has
/// the length it has. That is where a picture's corners are.
pub(super) fn viewplane([first, right, below, last]: [DVec3; 4]) -> Option<[DVec3; 3]> {
    let lengths = DMat3::from_cols(right, below, -last).inverse() * first;
    let is_ahead = lengths.cmpgt(DVec3::ZERO).all() && lengths.is_finite();
    is_ahead.then_some([first, lengths.x * right, lengths.y * below])
}

/// The start of the first whole row, and the number of rays in a row, if there are rows: each
/// begins with a leap.
fn columns(rays: &dyn Rays) -> Option<(usize, usize)> {
    /// The factor between steps of a row that makes a leap.
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
        if is_parallel { ray.origin } else { ray.direction.normalize() }
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A grid of forty rows and seventy columns.
    pub(in super::super) fn pixels(is_parallel: bool) -> PixelGrid {
        let toward = DVec3::new(-3.0, 2.5, -0.5).normalize();
        let right = toward.cross(DVec3::new(0.1, 0.2, 1.0)).normalize();
        PixelGrid {
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
        }
    }

    fn array(is_parallel: bool) -> Vec<Ray> {
        let grid = pixels(is_parallel);
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
            // In single precision, in other lengths, and only the left part of the picture, which
            // is not straight ahead.
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
        assert_eq!(grid(&(0..rays.len()).map(scattered).collect::<Vec<_>>()), None);
    }
}
