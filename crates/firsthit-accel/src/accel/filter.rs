//! The float32 filter before the exact test: rejects triangles of a leaf that a ray misses, a
//! triangle in each lane.
//!
//! 1. Count the leaf's vertices from the ray's start, and shear them so that the ray runs along the
//!    axis of the depth.
//! 2. Compute the [`Sides`] of each triangle's edges. Reject a triangle when two sides have
//!    different signs, for certain. Most leaves end here.
//! 3. Mark a triangle as certain when all sides have the same sign, for certain.
//! 4. Say between which depths each triangle is met: around the corners' mean with the sides as
//!    weights where it is certain, else from its nearest to its farthest corner.
//! 5. Reject a triangle when all its depths are before the ray's start or beyond the limit.
//!
//! The test is the exact one's: Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection",
//! Journal of Computer Graphics Techniques 2(1), 2013. It departs in that every number has an error
//! bound. Where a bound leaves the answer open, `shape/triangle.rs` decides.
//!
//! # Error bounds
//!
//! In units of `U` (see `bounds.rs`). D is the depth of a vertex, X the largest of a triangle's
//! sheared coordinates, e its extent along an axis. For D there is one number for all vertices of a
//! leaf: the depth of the first, and the leaf's extent. So the bounds are numbers, not lanes.
//!
//! **A sheared coordinate** is off by at most E. For a vertex that is P from the ray's start across
//! the axis of the depth, E is the sum of these:
//!
//! - 2 P: two differences across, as the start has two parts;
//! - 2 D: two differences along, times a slope of at most 1;
//! - D: the slope;
//! - D + X: the product and the difference, where they are not fused;
//! - three blurs (`BLURS`), which hold what float64 rounded when it made the ray ready.
//!
//! P is at most X + D, and X at most 2 e. So E is 6 D + 6 e (`VERTEX`) and three blurs. The exact
//! test adds nothing to that.
//!
//! **A side** is a difference of two products of coordinates. It is off by at most B:
//!
//! - 4 E X: the coordinates, and 0.2 E X for what is quadratic in E (`SIDE_BY_ERROR`);
//! - 4 X^2: rounding, and as much again to spare (`SIDE_BY_SIZE`).
//!
//! Where one side is below -B and another above B, the exact test finds the same signs and rejects
//! the triangle. Where all are beyond B on the same side, it finds the same signs and accepts it.
//!
//! **X** is different in the two cases:
//!
//! - To reject, B must hold for rays inside the triangle. There X is at most the triangle's extent
//!   across the ray, which is at most 2 e (`EXTENT_ACROSS`), and E.
//! - To accept, B must hold for any ray: far from the ray, the rounding of a triangle without area
//!   may look like a tiny inside. But the ray passes the leaf's box, so X is at most twice the
//!   leaf's extent and what the test of the box lets through (`BOX_MARGIN`).
//!
//! **The depth** of a certain triangle is a mean of the corners' depths. It is off by the corners'
//! slack (`DEPTH` and three blurs), and by these, each times the spread of the corners' depths over
//! the sum of the sides:
//!
//! - 2 E X: the corners' places. The triangle's plane passes the ray at a depth that is off by the
//!   plane's slopes times E, for x and for y. A slope is at most X times the spread over the sum,
//!   as a triangle in a rectangle has half its area at most.
//! - 6 X^2: the sides' own rounding, 3 X^2 each, times how far each corner is from the mean: twice
//!   the spread for all three.
//! - 2.1 X^2: the sum that is computed is larger than the exact one by at most 9 X^2. As each side
//!   is above 4.3 E X + 9.2 X^2, the exact sum is two thirds of that at least.
//!
//! In all 2 E X (`MEAN`) and 8.1 X^2 (`MEAN_BY_SIZE`). Frusta have a simpler bound: with each side
//! off by B, the mean is off by 2 B spread / sum.

use super::bounds::{
    BLURS, BOX_MARGIN, DEPTH, EXTENT_ACROSS, MEAN, MEAN_BY_SIZE, SIDE_BY_ERROR, SIDE_BY_SIZE,
    VERTEX,
};
use super::edges::{Sides, depths};
use super::meshlet::Meshlet;
use super::rays::tree_ray::TreeRay;
use crate::simd::Lanes;

/// The triangles of a leaf that a ray may meet.
#[doc(hidden)]
pub struct Candidates<L: Lanes> {
    /// The triangles the ray may meet.
    pub(super) possible: u16,
    /// The triangles whose inside the ray meets for certain.
    pub(super) certain: u16,
    /// Depths between which the ray meets the triangle, if it does.
    pub(super) low: L::Floats,
    pub(super) high: L::Floats,
}

/// The candidates of `leaf` at depths from 0 to `limit`; `None` where the ray passes all triangles.
#[inline(always)]
pub(super) fn filter<L: Lanes>(
    l: L,
    ray: &TreeRay,
    leaf: &Meshlet,
    limit: f32,
) -> Option<Candidates<L>> {
    let [x, y, z] = ray.axes;
    macro_rules! relative {
        ($axis:ident, $k:literal) => {{
            let [high, low] = ray.start[$k];
            let vertices = l.load(&leaf.vertices[$axis % 3]);
            l.sub(l.sub(vertices, l.splat(high)), l.splat(low))
        }};
    }
    let along = z;
    let z = l.mul(relative!(z, 2), l.splat(ray.forwards));
    let x = l.neg_mul_add(l.splat(ray.slope[0]), z, relative!(x, 0));
    let y = l.neg_mul_add(l.splat(ray.slope[1]), z, relative!(y, 1));
    let rounding = Rounding::new(ray, leaf, along);
    let side = rounding.side(leaf.size, 0.0);

    let [a, b, c] = &leaf.corners;
    let (ax, bx, cx) = (l.permute(x, a), l.permute(x, b), l.permute(x, c));
    let (ay, by, cy) = (l.permute(y, a), l.permute(y, b), l.permute(y, c));
    let sides = Sides::new(l, [ax, ay], [bx, by], [cx, cy]);
    let possible = leaf.filled & !sides.outside(l, l.splat(side.bound));
    if possible == 0 {
        return None;
    }
    let (az, bz, cz) = (l.permute(z, a), l.permute(z, b), l.permute(z, c));
    let (nearest, farthest) = (l.min(l.min(az, bz), cz), l.max(l.max(az, bz), cz));
    let spread = l.sub(farthest, nearest);
    let slack = l.splat(rounding.depth());
    let (nearest, farthest) = (l.sub(nearest, slack), l.add(farthest, slack));
    let sure = rounding.side(leaf.extent, 2.0 * BOX_MARGIN);
    let certain = sides.inside(l, l.splat(sure.bound));
    let [depth, over] = sides.depth(l, [az, bz, cz]);
    let error = l.mul_add(l.splat(side.mean()), l.mul(spread, over), slack);
    let [low, high] = depths(l, certain, [depth, error], [nearest, farthest]);
    // Whether one is left would be hard to predict.
    let possible = possible & l.le(low, l.splat(limit)) & l.le(l.splat(0.0), high);
    Some(Candidates { possible, certain, low, high })
}

/// The rounding errors of the triangles of a leaf, as a ray sees them.
struct Rounding {
    /// The largest depth of a vertex, ahead of the ray's start or behind it.
    deep: f32,
    blur: f32,
}

impl Rounding {
    #[inline(always)]
    fn new(ray: &TreeRay, leaf: &Meshlet, along: usize) -> Self {
        let [high, low] = ray.start[2];
        let first = (leaf.vertices[along % 3][0] - high) - low;
        Self {
            // And a little more, for the rounding of all these.
            deep: 1.000_001 * (first.abs() + leaf.extent),
            blur: BLURS * ray.blur,
        }
    }

    /// The errors of the sides of triangles with this extent along an axis, and `more` across the
    /// ray.
    #[inline(always)]
    fn side(&self, extent: f32, more: f32) -> SideRounding {
        let error = VERTEX * self.deep + (VERTEX * extent + self.blur);
        let size = 2.1 * error + (EXTENT_ACROSS * extent + more);
        let bound = (SIDE_BY_ERROR * error + SIDE_BY_SIZE * size) * size;
        SideRounding { error, size, bound }
    }

    /// The error of a corner's depth.
    #[inline(always)]
    fn depth(&self) -> f32 {
        DEPTH * self.deep + self.blur
    }
}

/// E, X and B of the [error bounds](self).
struct SideRounding {
    error: f32,
    size: f32,
    bound: f32,
}

impl SideRounding {
    /// The error of the depth of a certain triangle, by the spread of its corners' depths over the
    /// sum of the sides.
    #[inline(always)]
    fn mean(&self) -> f32 {
        (MEAN * self.error + MEAN_BY_SIZE * self.size) * self.size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::mesh_tree::MeshTree;
    use crate::accel::rays::packet::Packet;
    use crate::geometry::{DVec3, Ray};
    use crate::shape::triangle::{EdgeRule, Shear};
    use crate::shape::{Mesh, Positions};
    use crate::simd::{self, InstructionSet, Kernel, LANES};

    /// A ray that starts near a tree.
    struct Checked<'a>(&'a MeshTree, &'a Mesh, Ray);

    impl Kernel for Checked<'_> {
        type Output = usize;

        /// Compares the filter with the exact test, and returns how many triangles the ray meets.
        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> usize {
            let Self(tree, mesh, ray) = self;
            let mut packet = Packet::default();
            packet.put(0, &ray);
            packet.prepare(l, tree, 1);
            let tree_ray = packet.tree_ray(0);
            let depth_per_t = ray.direction.abs().max_element() * tree.space.scale;
            let mut met = 0;
            for leaf in &tree.leaves {
                let found = filter(l, &tree_ray, leaf, f32::INFINITY);
                let [mut lows, mut highs] = [[0.0; LANES]; 2];
                let [mut possible, mut certain] = [0; 2];
                if let Some(found) = found {
                    l.store(found.low, &mut lows);
                    l.store(found.high, &mut highs);
                    (possible, certain) = (found.possible, found.certain);
                }
                for lane in 0..leaf.filled.count_ones() as usize {
                    let triangle = tree.triangle(leaf, lane) as usize;
                    let hit =
                        mesh.intersect_triangle(triangle, EdgeRule::Closed, &Shear::new(&ray));
                    let [is_possible, is_certain] = [possible, certain].map(|m| m >> lane & 1 == 1);
                    let Some(hit) = hit.filter(|hit| hit.t > 0.0) else {
                        let is_wrong = is_possible && is_certain && lows[lane] > 0.0;
                        assert!(!is_wrong, "certain, and not met: {ray:?} {triangle}");
                        continue;
                    };
                    met += 1;
                    assert!(is_possible, "met, and left out: {ray:?} {triangle}");
                    let depth = hit.t * depth_per_t;
                    let (low, high) = (f64::from(lows[lane]), f64::from(highs[lane]));
                    let is_between = low <= depth && depth <= high;
                    assert!(is_between, "{low} {depth} {high}: {ray:?} {triangle}");
                }
            }
            met
        }
    }

    /// Rays aimed at edges and off them by a few roundings of float32, at triangles of all slopes
    /// and sizes.
    #[test]
    fn the_filter_agrees_with_the_exact_test() {
        let mut state = 1_u64;
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut point = || DVec3::new(unit(), unit(), unit());
        let mut met = vec![0; InstructionSet::available().count()];
        for round in 0..200 {
            let corners: Vec<DVec3> = (0..16)
                .flat_map(|k| {
                    let (middle, size) = (point(), [1.0, 0.2, 0.01, 1e-4][k % 4]);
                    [middle, middle + size * point(), middle + size * point()]
                })
                .collect();
            let positions = corners.iter().map(|p| p.as_vec3().as_dvec3().to_array());
            let triangles = (0..16).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
            let mesh = Mesh::new(Positions::compact(positions.collect()), triangles).unwrap();
            let tree = MeshTree::build(&mesh);
            for k in 0..160 {
                let [a, b, c] = mesh.corners(k % 16);
                let share = 0.5 + 0.5 * point().x;
                let off = [0.0, 1e-8, 1e-7, 1e-6][round % 4] * point();
                let aim = a.lerp(b, share).lerp(c, [0.0, 0.0, 0.3][k % 3]) + off;
                let mut origin = [1.0, 3.0, 8.0][k / 3 % 3] * point();
                if k % 5 == 0 {
                    // Nearly in the triangle's plane.
                    origin = c.lerp(a, 3.0) + 1e-2 * point();
                }
                let ray = Ray::new(origin, aim - origin);
                for (set, met) in InstructionSet::available().zip(&mut met) {
                    *met += simd::run(set, Checked(&tree, &mesh, ray));
                }
            }
        }
        assert!(met[0] > 20_000, "{met:?}");
    }
}
