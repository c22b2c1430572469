//! A tile's rays as seen from a tree: the planes around them, and where a point of the tree lies in
//! the tile's picture.
//!
//! The rays of a tile are `eye + depth * (centre + x * across + y * down)`, where x and y are
//! pixels counted from the tile's middle; parallel ones are
//! `eye + x * across + y * down + depth * centre`. So a point of the tree has coordinates (X, Y,
//! Z): it is on the ray x = X / Z, y = Y / Z (parallel: x = X, y = Y), at the depth Z. The matrix
//! that gives them is the inverse of the one with the columns `across`, `down` and `centre`.
//!
//! 1. Bring the eye and the columns into the tree's space. Move the eye of parallel rays along
//!    them, to the tree.
//! 2. Shear space along the axis that the tile looks along, so that the rays of the tile run nearly
//!    along it. Coordinates across are then small where the tile is, and float32 resolves them.
//! 3. Invert the matrix, in float64.
//! 4. Bound what X, Y and Z may be off in float32. Give up where that is too much of a pixel.
//! 5. Make four planes around the tile from the matrix' rows, and move them outwards by that.
//! 6. For each leaf: place its first vertex in float64 and the others from there in float32, so
//!    that rounding depends on the leaf's extent, neither on the tree's nor on the eye's distance
//!    ([`transformed`](TileFrustum::transformed)).
//!
//! Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", ACM Transactions on Graphics
//! 24(3), 2005, for the planes; Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
//! Coordinates", Graphics Hardware 1997, for the coordinates. It departs in the shear, which is
//! that of `shape/triangle.rs`, and in the bounds.
//!
//! # Error bounds
//!
//! In units of `U` (see `bounds.rs`); e is the leaf's extent.
//!
//! **A sheared coordinate** x is off by at most the sum of these:
//!
//! - 2 e: the differences with the first vertex along two axes, with a slope of at most 1;
//! - 3 e: the product, e, and its difference, 2 e;
//! - |x| + 2 e: the first vertex' place, rounded;
//! - |x|: the sum;
//! - 2: the vertices, where float32 does not hold them, as no coordinate of the tree is larger than
//!   1.
//!
//! In all 7 e (`TILE_VERTEX`) and two shares of x.
//!
//! **X and Y** have four shares more, of the matrix' entry, the products and the sums; where pixels
//! are skew, of numbers larger than X and Y (`skewness`). A side counts from a sample, and its part
//! of the six shares is in `relative`. But X and Y count from the tile's middle, which is up to 8.5
//! pixels from a sample: 7.5 on the grid, and one off it (`Displacements`). 6 times 8.5 shares
//! (`TILE_PIXEL`).
//!
//! **Z** counts from the eye. It is off by the sum of these:
//!
//! - 7 e, as above;
//! - 4 reaches, and three roundings of up to 4 reaches each: 16 reaches (`TILE_SIDEWAYS`);
//! - between the corners of a triangle, seven roundings more and one of the error itself, of up to
//!   2 reaches: 16 reaches.
//!
//! With an e of 2, that is 46 reaches at most (`TILE_DEPTH`).
//!
//! **A wrong Z** moves a vertex on the picture, in perspective: by its share of Z for each pixel
//! from the tile's middle. X and Y are Z times as large, so for each of these pixels they are off
//! by the error of Z itself. The 16 reaches above are `sideways`; what they are multiplied by is a
//! lever, in pixels:
//!
//! - a side counts from a sample, which is up to 8.5 pixels from the middle: 12 (`TILE_LEVER`);
//! - a plane is 7.52 pixels from it: 8 (`TILE_LEVER_OF_PLANES`);
//! - whether the tile is sharp enough is asked for its whole width: 16 (`TILE_LEVER_OF_WIDTH`).
//!
//! **The 51 shares of Z** that X and Y are off (`TILE_PIXEL`) are in the bound of a side by another
//! number, which is the same for all vertices of a leaf. Z is at most two reaches, so 51 shares of
//! it are 102 reaches. 7 times `sideways` are 112. So the lever of a side is larger by 7 times the
//! skewness (`TILE_LEVER_BY_SKEWNESS`).
//!
//! **A side** is a difference of two products of X and Y. Its `size` is how far the corners are
//! from the sample along X and Y, both together. It is off by the sum of these:
//!
//! - twice the size times what X and Y are off, and a little for what is quadratic in that
//!   (`TILE_SIDE_BY_ERROR`);
//! - 30 roundings of a product of X and Y, each a quarter of the size's square at most
//!   (`TILE_SIDE_BY_SIZE`); the last 4 of them where a sample is off the grid;
//! - the shares of the matrix and of the shear, in the same way (`TILE_SIDE_BY_SKEW`).
//!
//! **Rays off the grid** by up to `off` pixels move X and Y by that times Z. The planes and the
//! samples of a bounding box allow for all of it. If each ray's displacement is known, the sides
//! are evaluated where the ray is: the sizes count up to there, and `rest`, the rounding of the
//! displacements, takes the place of `off`. Where a side is bounded for a range of samples at once,
//! it may change by the largest displacement times its slopes.

use crate::accel::bounds::{
    BLUR, TILE_ANY_VERTEX, TILE_DEPTH, TILE_LEVER, TILE_LEVER_BY_SKEWNESS, TILE_LEVER_OF_PLANES,
    TILE_LEVER_OF_WIDTH, TILE_MOVED, TILE_PIXEL, TILE_PLANES, TILE_SIDE_BY_ERROR,
    TILE_SIDE_BY_SIZE, TILE_SIDE_BY_SKEW, TILE_SIDEWAYS, TILE_VERTEX, U,
};
use crate::accel::mesh_tree::MeshTree;
use crate::accel::meshlet::Meshlet;
use crate::accel::node::Node;
use crate::geometry::{DMat3, DVec3, arrays};
use crate::simd::Lanes;

/// The distance from a tile's first sample to its middle.
pub(super) const HALF: f32 = 7.5;

/// The rays of a tile, in the space of a mesh.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct TileCamera {
    /// The point in which the rays meet; of parallel rays, the start of the one in the tile's
    /// middle.
    pub eye: DVec3,
    /// The vector from there to the tile's middle on the viewplane.
    pub centre: DVec3,
    /// A pixel to the right, and one down, on the viewplane.
    pub across: DVec3,
    pub down: DVec3,
    pub is_perspective: bool,
    /// The depth at which hits begin: 1 on the viewplane, 0 at the eye.
    pub start_depth: f64,
    /// The largest of the numbers that these were computed from, for their rounding.
    pub largest: f64,
    /// The largest error of a ray, in pixels.
    pub off: f64,
    /// The error of a ray in pixels where the error of each is known
    /// ([`Displacements`](super::visibility::Displacements)); else `off`.
    pub rest: f64,
}

/// A [`TileCamera`] made ready for a tree.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct TileFrustum {
    axes: [usize; 3],
    /// The eye along those axes, sheared.
    eye: [f64; 3],
    slope: [f32; 2],
    /// The rows of the map from sheared coordinates to X, Y and Z.
    rows: [[f32; 3]; 3],
    /// The planes around the tile: normals along the axes of space, towards the inside, and the
    /// least that a point inside comes to.
    planes: [([f32; 3], f32); 4],
    /// The gradient of the depth.
    depth: [f32; 3],
    /// The eye along the axes of space.
    start: [f32; 3],
    pub(super) is_perspective: bool,
    pub(super) start_depth: f32,
    /// The depth that the eye of parallel rays was moved by.
    slid: f32,
    /// The error of X and Y, and its increase for each unit of a leaf's extent; that by a wrong Z
    /// is included.
    error: f32,
    error_per_extent: f32,
    /// The error of X and Y as a share of Z, in perspective.
    pub(super) share: f32,
    /// The error of a depth.
    pub(super) depth_error: f32,
    /// The error of a side is `(absolute + relative * size) * size`. A leaf adds its part to
    /// `absolute`. The size is how far the corners are from a sample along X and Y at most, both
    /// together, times Z.
    absolute: f32,
    pub(super) relative: f32,
}

impl TileFrustum {
    /// `None` where float32 resolves too little of a pixel; the tile's rays then go one by one.
    #[expect(clippy::cast_possible_truncation, reason = "the rounding is allowed for")]
    #[expect(
        clippy::too_many_lines,
        reason = "one derivation, each line of which needs those before"
    )]
    pub fn new(tree: &MeshTree, camera: &TileCamera) -> Option<Self> {
        let space = &tree.space;
        let mut eye = (camera.eye - space.origin) * space.scale;
        let far = eye.abs().max_element();
        let [centre, across, down] =
            arrays::map([camera.centre, camera.across, camera.down], |v| v * space.scale);
        // Parallel rays may start anywhere on their way: near the tree, differences lose nothing.
        let mut slid = 0.0;
        if !camera.is_perspective {
            slid = -eye.dot(centre) / centre.length_squared();
            eye += slid * centre;
        }
        let reach = eye.abs().max_element() + 1.0;
        let z = largest_axis(centre);
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let slope = arrays::map([axes[0], axes[1]], |k| (centre[k] / centre[z]) as f32);
        let sheared = |v: DVec3| {
            let [x, y, z] = arrays::map(axes, |k| v[k]);
            DVec3::new(x - f64::from(slope[0]) * z, y - f64::from(slope[1]) * z, z)
        };
        let columns = arrays::map([across, down, centre], sheared);
        let inverse = DMat3::from_cols(columns[0], columns[1], columns[2]).inverse();
        let rows = arrays::from_fn::<_, 3>(|k| inverse.row(k));
        // The same rows for coordinates that are not sheared, as planes have.
        let unsheared = |row: DVec3| {
            let mut out = DVec3::ZERO;
            out[axes[0]] = row.x;
            out[axes[1]] = row.y;
            out[axes[2]] = row.z - row.x * f64::from(slope[0]) - row.y * f64::from(slope[1]);
            out
        };
        let sum = |row: DVec3| row.abs().element_sum();
        let u = f64::from(U);
        let blur = 4.0 * BLUR * (camera.largest * space.scale + far + reach);
        // The error of the rays themselves. In perspective it is largest at the tree's largest
        // depth. Of parallel rays it has any direction, so it counts along the depth too.
        let [x, y, depth] = arrays::map(rows, unsheared);
        let (off, rest, off_along) = if camera.is_perspective {
            let farthest = 1.001 * (sum(depth) - depth.dot(eye)).max(0.0);
            (camera.off * farthest, camera.rest * farthest, 0.0)
        } else {
            let pixel = sum(columns[0]).max(sum(columns[1]));
            (camera.off, camera.rest, 3.0 * camera.off * pixel)
        };
        let across_both = sum(rows[0]).max(sum(rows[1]));
        let units = if tree.is_exact { 0.0 } else { 2.0 };
        let rounding = across_both * (units * u + 2.0 * blur);
        let pixels = columns[0].abs() + columns[1].abs();
        let skewness = rows[0].abs().dot(pixels).max(rows[1].abs().dot(pixels));
        let share = TILE_PIXEL * skewness;
        let error_of_sides = rounding + rest + if camera.is_perspective { 0.0 } else { share };
        let error = error_of_sides + (off - rest);
        let along = TILE_DEPTH * reach + 4.0 * blur + off_along;
        let depth_error = sum(rows[2]) * along + TILE_MOVED * slid.abs();
        // The error of X and Y from a wrong Z, for each pixel from the tile's middle.
        let sideways = if camera.is_perspective {
            sum(rows[2]) * (TILE_SIDEWAYS * reach + 4.0 * blur)
        } else {
            0.0
        };
        let lever = if camera.is_perspective {
            TILE_LEVER + TILE_LEVER_BY_SKEWNESS * skewness
        } else {
            0.0
        };
        let skew = across_both * (sum(columns[0]) + sum(columns[1]));
        let is_in_range = skew < 1e4 && reach < 1e3 && (1e-12..1e12).contains(&sum(rows[2]));
        // Give up where X and Y may be off by a fifth of a pixel even at the tree's far side: most
        // samples would be undecided.
        let far_depth = if camera.is_perspective { 0.1 * sum(rows[2]) } else { 1.0 };
        let is_sharp = rounding + across_both * TILE_ANY_VERTEX + TILE_LEVER_OF_WIDTH * sideways
            < 0.2 * far_depth.max(1e-30);
        // Written so that a NaN fails.
        let is_usable = is_in_range
            && is_sharp
            && error.is_finite()
            && slid.abs() < 1e30
            && depth_error < 1e30
            && across_both < 1e12;
        if !is_usable {
            return None;
        }
        let reach_of_pixels = f64::from(HALF) + 0.02;
        let plane = |side: DVec3, sign: f64| {
            let normal = if camera.is_perspective {
                sign * side + reach_of_pixels * depth
            } else {
                sign * side
            };
            let below = if camera.is_perspective { 0.0 } else { reach_of_pixels };
            let box_error = sum(normal) * (TILE_PLANES * reach + 2.0 * blur);
            let slack =
                box_error + error + across_both * TILE_ANY_VERTEX + TILE_LEVER_OF_PLANES * sideways;
            (arrays::map(normal.to_array(), |x| x as f32), -((below + slack) * 1.000_01) as f32)
        };
        Some(Self {
            axes,
            eye: sheared(eye).to_array(),
            slope,
            rows: arrays::map(rows, |row| arrays::map(row.to_array(), |x| x as f32)),
            planes: [plane(x, 1.0), plane(x, -1.0), plane(y, 1.0), plane(y, -1.0)],
            depth: arrays::map(depth.to_array(), |x| x as f32),
            start: arrays::map(eye.to_array(), |x| x as f32),
            is_perspective: camera.is_perspective,
            start_depth: camera.start_depth as f32,
            slid: slid as f32,
            error: error as f32,
            error_per_extent: (TILE_VERTEX * (across_both + lever * sum(rows[2]))) as f32,
            depth_error: depth_error as f32,
            share: share as f32,
            absolute: (TILE_SIDE_BY_ERROR * (error_of_sides + lever * sideways)) as f32,
            relative: (TILE_SIDE_BY_SIZE + TILE_SIDE_BY_SKEW * skew) as f32,
        })
    }

    /// The coordinates X, Y and Z of a leaf's vertices.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the rounding is allowed for")]
    pub(super) fn transformed<L: Lanes>(&self, l: L, leaf: &Meshlet) -> [L::Floats; 3] {
        macro_rules! vertices {
            ($k:literal) => {
                &leaf.vertices[self.axes[$k] % 3]
            };
        }
        let (first_x, first_y, first_z) = (vertices!(0)[0], vertices!(1)[0], vertices!(2)[0]);
        macro_rules! place {
            ($k:literal, $first:ident) => {{
                let sheared = f64::from($first) - f64::from(self.slope[$k]) * f64::from(first_z);
                l.splat((sheared - self.eye[$k]) as f32)
            }};
        }
        let along = l.sub(l.load(vertices!(2)), l.splat(first_z));
        macro_rules! sheared {
            ($k:literal, $first:ident) => {{
                let across = l.sub(l.load(vertices!($k)), l.splat($first));
                let sheared = l.neg_mul_add(l.splat(self.slope[$k]), along, across);
                l.add(sheared, place!($k, $first))
            }};
        }
        let (x, y) = (sheared!(0, first_x), sheared!(1, first_y));
        let z = l.add(along, l.splat((f64::from(first_z) - self.eye[2]) as f32));
        macro_rules! row {
            ($k:literal) => {
                product(l, self.rows[$k], [x, y, z])
            };
        }
        [row!(0), row!(1), l.add(row!(2), l.splat(self.slid))]
    }

    /// The error of X and Y of a leaf's vertices.
    #[inline(always)]
    pub(super) fn error(&self, leaf: &Meshlet) -> f32 {
        self.error + self.error_per_extent * leaf.extent
    }

    /// The first part of the error of a side of a leaf's triangles; see [`Self::relative`].
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "a constant, for float32 too")]
    pub(super) fn absolute(&self, leaf: &Meshlet) -> f32 {
        self.absolute + TILE_SIDE_BY_ERROR as f32 * self.error_per_extent * leaf.extent
    }

    /// The boxes of a node that the tile's rays may meet at depths up to `limit`, and the depths
    /// from which on.
    #[inline(always)]
    pub(super) fn boxes<L: Lanes>(&self, l: L, node: &Node, limit: f32) -> (u16, L::Floats) {
        macro_rules! end {
            ($plane:literal) => {
                l.sub(l.load(&node.planes[$plane]), l.splat(self.start[$plane / 2]))
            };
        }
        let ends = [end!(0), end!(1), end!(2), end!(3), end!(4), end!(5)];
        macro_rules! inside {
            ($k:literal) => {{
                let (normal, least) = self.planes[$k];
                l.le(l.splat(least), farthest(l, &ends, normal))
            }};
        }
        let [x, y, z] = self.depth;
        let last = farthest(l, &ends, self.depth);
        let last = l.add(last, l.splat(self.slid + self.depth_error));
        let first = farthest(l, &ends, [-x, -y, -z]);
        let first = l.sub(l.splat(self.slid - self.depth_error), first);
        let met = inside!(0)
            & inside!(1)
            & inside!(2)
            & inside!(3)
            & l.le(l.splat(self.start_depth), last)
            & l.le(first, l.splat(limit));
        (met, l.max(first, l.splat(0.0)))
    }
}

/// The product of a vector with others.
#[inline(always)]
fn product<L: Lanes>(l: L, [x, y, z]: [f32; 3], of: [L::Floats; 3]) -> L::Floats {
    l.mul_add(l.splat(x), of[0], l.mul_add(l.splat(y), of[1], l.mul(l.splat(z), of[2])))
}

/// The largest dot product of a direction with a point of each box, which is at a corner.
#[inline(always)]
fn farthest<L: Lanes>(l: L, ends: &[L::Floats; 6], direction: [f32; 3]) -> L::Floats {
    macro_rules! corner {
        ($axis:literal) => {
            ends[2 * $axis + usize::from(direction[$axis] > 0.0)]
        };
    }
    product(l, direction, [corner!(0), corner!(1), corner!(2)])
}

/// The axis along which a vector is longest, of equal ones the first.
pub(crate) fn largest_axis(v: DVec3) -> usize {
    let v = v.abs();
    if v.x >= v.y && v.x >= v.z {
        0
    } else if v.y >= v.z {
        1
    } else {
        2
    }
}
