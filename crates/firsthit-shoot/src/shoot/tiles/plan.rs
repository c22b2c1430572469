//! The plan of a picture's tiles: the objects that tiles can do, and where each may be seen.

use std::ops::Range;

use super::cost::costs_more;
use super::square::SIDE;
use crate::accel::{TILE, TileCamera};
use crate::geometry::{Bounds, DMat3, DVec3, PixelGrid, Rays, arrays};
use crate::scene::{Object, Scene};
use crate::shape::Surface;
use crate::shoot::batch::are_enough;

/// The largest rounding of an object's transform, as a share of coordinates, for which its box is
/// of use.
const MOST_ROUNDING: f64 = 1e-10;

/// The number of pixels from which on results go past the caches.
const LARGE: usize = 1 << 17;

/// Tiles down a band, where there are many bands.
pub(super) const TALL: usize = SIDE / TILE;

/// A scene made ready for a grid of pixels.
pub(super) struct Plan<'a> {
    pub(super) scene: &'a Scene,
    pub(super) rays: &'a dyn Rays,
    pub(super) grid: PixelGrid,
    pub(super) source: GridSource,
    /// The meshes that tiles can do, the nearest first.
    pub(super) meshes: Vec<Placed>,
    /// For each object, whether single rays leave it out: tiles draw it, it is hidden, a duplicate,
    /// or its leader stands for it.
    pub(super) is_tiled: Vec<bool>,
    /// The objects that tiles leave out.
    pub(super) rest: Rest,
    /// Rows of tiles in a band.
    pub(super) tiles_down: usize,
    /// Whether the results are more than the caches hold.
    pub(super) is_large: bool,
}

/// The objects that a visibility buffer cannot hold, by the way in which a tile's rays meet them.
pub(super) enum Rest {
    /// No objects are left.
    Nothing,
    /// A few shapes other than meshes: the rays of a tile intersect those that may be seen in it.
    Shapes(Vec<Placed>),
    /// Any objects: each ray traverses the tree over the objects.
    Any,
}

/// The most shapes that are listed tile by tile.
pub(super) const MOST_SHAPES: usize = 64;

/// The source of a tile's grid of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GridSource {
    /// The rays are those of one grid.
    Grid,
    /// The rays are an array's, and near one grid.
    Fitted,
    /// The rays start in one point, and each tile has a grid of its own that they are near. The
    /// plan's grid has rows, columns and that point only.
    Curved,
}

/// An object, and the tiles that it may be seen in.
pub(super) struct Placed {
    pub(super) object: u32,
    pub(super) rows: Range<usize>,
    pub(super) columns: Range<usize>,
    /// The depth from which on it may be met, in units of the viewplane's; of curved rays the
    /// distance.
    pub(super) entry: f64,
    /// The sphere around the object, for curved rays: its centre relative to where they start, and
    /// its radius.
    pub(super) sphere: (DVec3, f64),
}

impl<'a> Plan<'a> {
    /// `None` when rays one by one are the better way.
    pub(super) fn new(
        scene: &'a Scene,
        rays: &'a dyn Rays,
        grid: PixelGrid,
        source: GridSource,
    ) -> Option<Self> {
        let has_directions = source == GridSource::Grid && grid.parallel.is_none();
        if !is_unscaled(&grid) || (has_directions && !has_digits(&grid)) {
            return None;
        }
        let mut is_tiled = vec![false; scene.objects().len()];
        let (mut meshes, mut shapes) = (Vec::new(), Vec::new());
        let (mut others, mut are_shapes) = (0, true);
        for (index, object) in (0..).zip(scene.objects()) {
            let place = |bounds: Bounds| match source {
                GridSource::Curved => Some(around(&grid, (index, object), bounds)),
                GridSource::Grid | GridSource::Fitted => placed(&grid, (index, object), bounds),
            };
            let follows = scene.leader_of(index) != index;
            if follows || scene.duplicates().contains(index) || object.is_hidden() {
                is_tiled[index as usize] = true;
            } else if let Some((mesh, _)) = scene.plain_mesh(index) {
                is_tiled[index as usize] = true;
                meshes.extend(place(mesh.bounds()));
            } else {
                others += 1;
                are_shapes &= object.mesh().is_none();
                if are_shapes && others <= MOST_SHAPES {
                    shapes.extend(place(object.shape().bounds()));
                }
            }
        }
        let rest = match others {
            0 => Rest::Nothing,
            1..=MOST_SHAPES if are_shapes => Rest::Shapes(shapes),
            _ => Rest::Any,
        };
        if costs_more(scene, (rays, &grid, source), (&meshes, &rest)) {
            return None;
        }
        meshes.sort_by(|a: &Placed, b| a.entry.total_cmp(&b.entry));
        let tiles_down = if are_enough(grid.rows / (TALL * TILE)) { TALL } else { 1 };
        let is_of_use = !meshes.is_empty() || !matches!(rest, Rest::Any);
        is_of_use.then_some(Self {
            scene,
            rays,
            grid,
            source,
            meshes,
            is_tiled,
            rest,
            tiles_down,
            is_large: grid.rows * grid.columns >= LARGE,
        })
    }

    /// Lists which of `meshes` may be seen in the square of tiles from a row and a column of them
    /// on.
    pub(super) fn list_near(&self, row: usize, column: usize, near: &mut Vec<u32>) {
        near.clear();
        for (index, placed) in (0..).zip(&self.meshes) {
            let overlaps =
                |tiles: &Range<usize>, first| tiles.start < first + TALL && first < tiles.end;
            if overlaps(&placed.rows, row) && overlaps(&placed.columns, column) {
                near.push(index);
            }
        }
    }

    /// Leaves in `near` what a cone around curved rays may meet: its axis and the cosine of its
    /// half angle.
    pub(super) fn list_in_cone(&self, (axis, cosine): (DVec3, f64), near: &mut Vec<u32>) {
        /// Far more than rounding.
        const SLACK: f64 = 1e-6;
        let half = libm::acos(cosine.clamp(-1.0, 1.0));
        near.retain(|&index| {
            let (centre, radius) = self.meshes[index as usize].sphere;
            let distance = centre.length();
            let aside = libm::acos((axis.dot(centre) / distance).clamp(-1.0, 1.0));
            let reach = libm::asin((radius / distance).min(1.0));
            // Written so that a NaN keeps it.
            let is_beside = distance > radius && aside > half + reach + SLACK;
            !is_beside
        });
    }

    /// The number of pixels in a band, but for the last one.
    pub(super) fn band(&self) -> usize {
        self.tiles_down * TILE * self.grid.columns
    }
}

/// Whether no direction has to be scaled (see `scaled_ray.rs`).
fn is_unscaled(grid: &PixelGrid) -> bool {
    let toward = grid.toward.length();
    let range = 1e-80..1e80;
    range.contains(&toward) && grid.width < 1e80 && grid.height < 1e80
}

/// Whether no part of a direction is so small that its quotient, or what
/// [`quotient_by_inverse`](crate::geometry::arithmetic::quotient_by_inverse) corrects it by, has
/// lost digits: a sum of such parts times such sizes is zero or above 1e-160.
fn has_digits(grid: &PixelGrid) -> bool {
    let is_sound = |x: f64| x == 0.0 || x.abs() >= 1e-60;
    let vectors = [grid.toward, grid.right, grid.upwards];
    vectors.iter().all(|v| v.to_array().into_iter().all(is_sound))
        && is_sound(grid.width)
        && is_sound(grid.height)
}

/// The part of the picture in which an object in a box in its space may be seen; `None` for none.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of a float saturates"
)]
fn placed(grid: &PixelGrid, (index, object): (u32, &Object), bounds: Bounds) -> Option<Placed> {
    let axes = Axes::of(grid);
    let (low, high, farthest) = seen(grid, object, bounds, &axes);
    // Far more than rounding, as a share of what coordinates are computed from.
    let rounding = 1e-9 * (farthest + grid.position.abs().max_element());
    let slack = rounding * axes.growth;
    let entry = low.z - slack.z;
    let is_known = axes.is_sound && object.slack() < MOST_ROUNDING && entry.is_finite();
    let whole = Placed {
        object: index,
        rows: 0..grid.rows.div_ceil(TILE),
        columns: 0..grid.columns.div_ceil(TILE),
        entry: if is_known { entry } else { f64::NEG_INFINITY },
        sphere: (DVec3::ZERO, f64::INFINITY),
    };
    if !is_known {
        return Some(whole);
    }
    if high.z < -slack.z {
        return None;
    }
    // Written so that a NaN leads to all of the picture.
    let is_in_front = low.z > 2.0 * slack.z || grid.parallel.is_some();
    if !(is_in_front && low.is_finite() && high.is_finite()) {
        return Some(whole);
    }
    // The error of a point on the viewplane: a wrong depth moves it by its share,
    // as far as it is aside.
    let nearest = low.z - slack.z;
    let blur = |slack_across: f64, aside: f64| {
        if grid.parallel.is_some() {
            slack_across
        } else {
            (slack_across + slack.z * aside) / nearest
        }
    };
    // The tiles of a row or column of them, from where on the viewplane, counted from its first
    // edge, something is seen.
    let tiles = |low: f64, high: f64, blur: f64, pixel: f64, axis: usize| {
        let pad = 1.0 + blur / pixel;
        let from_first = 0.5 * grid.whole[axis] as f64 - grid.first[axis] as f64;
        let tile = |x: f64| (x / pixel + from_first) / TILE as f64;
        let count = [grid.rows, grid.columns][axis];
        let first = (tile(low) - pad).floor().max(0.0) as usize;
        first..((tile(high) + pad).ceil().max(0.0) as usize).min(count.div_ceil(TILE))
    };
    let [width, height] = grid.size();
    let aside = low.abs().max(high.abs());
    let columns = tiles(low.x, high.x, blur(slack.x, aside.x), width, 1);
    let rows = tiles(-high.y, -low.y, blur(slack.y, aside.y), height, 0);
    (!columns.is_empty() && !rows.is_empty()).then_some(Placed { rows, columns, ..whole })
}

/// An object in a box in its space, as curved rays may see it: anywhere, from a distance on.
fn around(grid: &PixelGrid, (index, object): (u32, &Object), bounds: Bounds) -> Placed {
    let corners = arrays::map(bounds.corners(), |corner| {
        let world = object.transform().world_from_object().transform_point3(corner);
        world - grid.position
    });
    let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let radii = arrays::map(corners, |corner| (corner - centre).length());
    let radius = radii.into_iter().fold(0.0, f64::max);
    // Far more than rounding.
    let largest = centre.length() + radius + grid.position.abs().max_element();
    let radius = radius + 1e-9 * largest;
    let is_known = object.slack() < MOST_ROUNDING && centre.is_finite() && radius.is_finite();
    let entry = (centre.length() - radius).max(0.0);
    Placed {
        object: index,
        rows: 0..grid.rows.div_ceil(TILE),
        columns: 0..grid.columns.div_ceil(TILE),
        entry: if is_known { entry } else { f64::NEG_INFINITY },
        sphere: if is_known { (centre, radius) } else { (DVec3::ZERO, f64::INFINITY) },
    }
}

/// The map from points relative to a grid's position to its own coordinates: to the right and
/// upwards along the viewplane, which need not be at right angles to anything, and along `toward`.
struct Axes {
    inverse: DMat3,
    /// The largest growth of a coordinate's rounding: the sum of each row of the inverse.
    growth: DVec3,
    is_parallel: bool,
    is_sound: bool,
}

impl Axes {
    fn of(grid: &PixelGrid) -> Self {
        let toward = grid
            .parallel
            .map_or(grid.toward, |direction| grid.toward.length() * direction.normalize());
        let axes = DMat3::from_cols(grid.right, grid.upwards, toward);
        let inverse = axes.inverse();
        let growth = DVec3::from_array(arrays::from_fn(|k| inverse.row(k).abs().element_sum()));
        let longest = axes.x_axis.length().max(axes.y_axis.length()).max(toward.length());
        Self {
            inverse,
            growth,
            is_parallel: grid.parallel.is_some(),
            // Axes that are nearly in a plane lose too many digits; a NaN fails.
            is_sound: growth.max_element() * longest
                < 1e6 * (toward.length() + 1.0 / toward.length()),
        }
    }
}

/// The box around an object, which is in a box in its space, in the grid's coordinates, and the
/// largest coordinate of its corners relative to the grid's position. Of perspective grids the
/// first two coordinates are those on the viewplane.
fn seen(grid: &PixelGrid, object: &Object, bounds: Bounds, axes: &Axes) -> (DVec3, DVec3, f64) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut farthest: f64 = 0.0;
    for corner in bounds.corners() {
        let world = object.transform().world_from_object().transform_point3(corner);
        let relative = world - grid.position;
        let along = axes.inverse * relative;
        if !along.is_finite() {
            // Which neither `min` nor `max` would keep.
            return (DVec3::NAN, DVec3::NAN, f64::INFINITY);
        }
        let seen = if axes.is_parallel {
            along
        } else {
            DVec3::new(along.x / along.z, along.y / along.z, along.z)
        };
        (low, high) = (low.min(seen), high.max(seen));
        farthest = farthest.max(relative.abs().max_element());
    }
    (low, high, farthest)
}

/// The rays of the tile from a row and a column of pixels on, in an object's space. They are `off`
/// pixels from the grid at most, and `rest` from where they are known to be ([`TileCamera::rest`]).
pub(super) fn camera_of_tile(
    grid: &PixelGrid,
    object: &Object,
    [off, rest]: [f64; 2],
    [row, column]: [usize; 2],
) -> TileCamera {
    // From the first pixel to the middle of sixteen.
    let half = 0.5 * (TILE as f64 - 1.0);
    let [width, height] = grid.size();
    let x = grid.x(column) + half * width;
    let y = grid.y(row) - half * height;
    let aside = x * grid.right + y * grid.upwards;
    let map = object.transform().object_from_world();
    let translation = object.transform().world_from_object().translation;
    let turned = |v: DVec3| map.transform_vector3(v);
    let (start, centre) = if grid.parallel.is_some() {
        (grid.position + aside, grid.toward)
    } else {
        (grid.position, grid.toward + aside)
    };
    let matrix = map.matrix3;
    let largest =
        arrays::map([matrix.x_axis, matrix.y_axis, matrix.z_axis], |axis| axis.abs().max_element());
    let growth: f64 = largest.iter().sum();
    TileCamera {
        eye: turned(start - translation),
        centre: turned(centre),
        across: turned(width * grid.right),
        down: turned(-height * grid.upwards),
        is_perspective: grid.parallel.is_none(),
        start_depth: f64::from(u8::from(grid.starts_on_viewplane)),
        off,
        rest,
        largest: growth
            * (start.abs().max_element()
                + translation.abs().max_element()
                + centre.abs().max_element()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::fit::tests::pixels;
    use super::*;
    use crate::geometry::Ray;
    use crate::shape::{Mesh, Positions, Sphere};

    /// More spheres than a tile lists are left to the tree over the objects, for packets of rays.
    #[test]
    fn tiles_are_not_taken_for_a_hidden_mesh() {
        let corners = Positions::compact(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        let mesh = Object::new(Arc::new(Mesh::new(corners, vec![[0, 1, 2]]).unwrap()));
        let rays = Vec::<Ray>::new();
        let ball = |k| Object::new(Sphere::new(f64::from(k) * DVec3::X, 0.4).unwrap());
        for (last, is_hidden, is_tiled) in [(65, true, false), (65, false, true), (64, true, true)]
        {
            let objects = (0..last).map(ball).chain([mesh.clone().hidden(is_hidden)]);
            let scene = Scene::new(objects.collect()).unwrap();
            let plan = Plan::new(&scene, &rays, pixels(false), GridSource::Grid);
            assert_eq!(plan.is_some(), is_tiled, "{last} {is_hidden}");
        }
    }
}
