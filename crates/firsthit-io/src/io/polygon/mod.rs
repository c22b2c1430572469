//! Polygons into triangles: n - 2 of them, and every corner in one, however odd the polygon.
//!
//! A corner that were left out would open a crack to the neighbour that keeps it.
//!
//! The method is ear clipping (Meisters, "Polygons Have Ears", American Mathematical Monthly 82,
//! 1975; Eberly, "Triangulation by Ear Clipping", Geometric Tools, 2002) with exact orientations
//! (Shewchuk, "Adaptive Precision Floating-Point Arithmetic", 1997). A plain version takes
//! quadratic time and more. Here a corner is tested again only when its neighbours or what blocked
//! it has changed.

#[allow(
    clippy::indexing_slicing,
    reason = "every index is one of the polygon's own corners, counted here and not read from a file"
)]
mod clipper;
#[allow(
    clippy::indexing_slicing,
    reason = "every index is one of the polygon's own corners, counted here and not read from a file"
)]
mod columns;

use robust::{Coord, orient2d};

use crate::geometry::{Bounds, DVec3, unit};
use columns::Point;

/// The triangles of a polygon as indices of its corners, in its own winding; `None` when the fan
/// from the first corner, (0, k, k + 1), is right, as it is for every convex polygon, or as good as
/// any, as it is for one that is bent so much that it has no inside.
///
/// Always n - 2 triangles. They cover a simple polygon exactly; what crosses itself gets some
/// triangles. The corners must be finite.
pub(super) fn triangulate(corners: &[DVec3]) -> Option<Vec<[u32; 3]>> {
    if corners.len() < 4 {
        return None;
    }
    let normal = newell_normal(corners)?;
    let points = project(corners, normal);
    if fan_is_right(&points) || is_bent(corners, normal) {
        return None;
    }
    Some(clipper::Clipper::new(&points).run())
}

/// Whether a quadrilateral is so clearly convex, seen along one of the axes, that no rounding can
/// say otherwise: the common case, decided without [`triangulate`]. `false` for corners that are
/// not finite.
pub(super) fn is_plainly_convex([a, b, c, d]: [DVec3; 4]) -> bool {
    let [ab, ac, ad] = [b - a, c - a, d - a];
    let (first, second) = (ab.cross(ac), ac.cross(ad));
    // Both triangles of the fan, seen along the axis nearest their common normal.
    let axis = nearest_axis(first + second);
    let (first, second) = (first[axis], second[axis]);
    // A component of a cross product is wrong by some 1e-16 of this at most.
    let size = ab.length_squared().max(ac.length_squared()).max(ad.length_squared());
    let clear = 1e-12 * size;
    (first > clear && second > clear) || (first < -clear && second < -clear)
}

/// The largest distance of corners along the normal, as a share of the polygon's size, at which
/// seeing it along the normal says something about it.
const BENT: f64 = 0.1;

fn is_bent(corners: &[DVec3], normal: DVec3) -> bool {
    let heights = corners.iter().map(|corner| corner.dot(unit(normal)));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| {
        (low.min(height), high.max(height))
    });
    let size = Bounds::of(corners.iter().copied()).size().max_element();
    high - low > BENT * size
}

/// The axis along which a normal is longest.
fn nearest_axis(normal: DVec3) -> usize {
    let size = normal.abs();
    if size.z >= size.x && size.z >= size.y {
        2
    } else {
        // Written so that a NaN leads to y.
        1 - usize::from(size.x >= size.y)
    }
}

/// The polygon seen along the axis that is nearest its normal, counter-clockwise.
fn project(corners: &[DVec3], normal: DVec3) -> Vec<Point> {
    let axis = nearest_axis(normal);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (u, v) = if normal[axis] < 0.0 { (v, u) } else { (u, v) };
    let flat = |corner: &DVec3| Coord { x: corner[u], y: corner[v] };
    corners.iter().map(flat).collect()
}

/// The normal of the polygon's best plane, of any length (Newell's method: Tampieri, Graphics Gems
/// III, 1992); `None` if it is zero.
fn newell_normal(corners: &[DVec3]) -> Option<DVec3> {
    let (&first, rest) = corners.split_first()?;
    let offset = |corner: &DVec3| *corner - first;
    let largest = rest.iter().fold(0.0, |size: f64, c| size.max(offset(c).abs().max_element()));
    // Of size one first: products of tiny edges would vanish, those of huge ones overflow.
    let mut spokes = rest.iter().map(|corner| offset(corner) / largest);
    let mut last = spokes.next()?;
    let mut normal = DVec3::ZERO;
    for spoke in spokes {
        normal += last.cross(spoke);
        last = spoke;
    }
    (normal.is_finite() && normal != DVec3::ZERO).then_some(normal)
}

/// Whether no triangle of the fan is turned over. Then each point lies in as many of them as the
/// polygon winds round it: for a simple polygon in one if inside, in none if outside.
fn fan_is_right(points: &[Point]) -> bool {
    let Some((&hub, rim)) = points.split_first() else {
        return true;
    };
    let mut pairs = rim.iter().zip(rim.iter().skip(1));
    pairs.all(|(&a, &b)| orient2d(hub, a, b) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|p| DVec3::new(p[0], p[1], 7.0)).collect()
    }

    /// The triangles' areas along z, and how many there are.
    fn areas(corners: &[DVec3]) -> Vec<f64> {
        let triangles = triangulate(corners).unwrap_or_else(|| {
            (1..u32::try_from(corners.len()).unwrap() - 1).map(|k| [0, k, k + 1]).collect()
        });
        assert_eq!(triangles.len(), corners.len() - 2);
        let mut used = vec![false; corners.len()];
        triangles.iter().flatten().for_each(|&k| used[k as usize] = true);
        assert!(used.iter().all(|&used| used));
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| corners[k as usize]);
            (b - a).cross(c - a).z / 2.0
        };
        triangles.iter().map(area).collect()
    }

    #[test]
    fn convex_polygons_stay_fans() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0]]);
        assert_eq!(triangulate(&square), None);
    }

    #[test]
    fn a_dart_is_cut_at_its_reflex_corner() {
        let dart = flat(&[[0.0, 0.0], [3.0, 1.0], [0.0, 2.0], [1.0, 1.0]]);
        assert_eq!(areas(&dart), [1.0, 1.0]);
        let turned = flat(&[[3.0, 1.0], [0.0, 2.0], [1.0, 1.0], [0.0, 0.0]]);
        assert_eq!(triangulate(&turned), None, "the fan from its tip is right");
    }

    #[test]
    fn a_polygon_that_is_bent_stays_a_fan() {
        let mut dart = flat(&[[0.0, 0.0], [3.0, 1.0], [0.0, 2.0], [1.0, 1.0]]);
        assert!(triangulate(&dart).is_some());
        dart[1].z += 2.0;
        assert_eq!(triangulate(&dart), None);
    }

    #[test]
    fn a_ring_with_a_bridge_keeps_its_hole() {
        let ring = flat(&[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ]);
        let areas = areas(&ring);
        assert!(areas.iter().all(|&area| area >= 0.0));
        assert_eq!(areas.iter().sum::<f64>(), 12.0);
    }

    #[test]
    fn what_makes_no_sense_still_gives_its_triangles() {
        areas(&flat(&[[0.0, 0.0]; 6]));
        areas(&flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [1.5, 0.0]]));
        areas(&flat(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [-1.0, 1.0], [0.0, 0.0]]));
    }
}
