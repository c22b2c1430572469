//! Triangles and rays at random: every kind that a kernel may take a way of its own for.

use firsthit::{DVec3, Ray};

use crate::support::Numbers;

/// Triangles of all kinds: small, slivers, duplicates, degenerate ones, with shared corners and
/// edges.
pub(crate) fn soup(count: usize, numbers: &mut Numbers) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points: Vec<DVec3> = (0..4).map(|_| numbers.point()).collect();
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    for k in 0..count {
        let first = points.len() as u32;
        let centre = numbers.point();
        let size = [1.0, 0.3, 0.05, 1e-3][k % 4];
        points.extend((0..3).map(|_| centre + size * numbers.point()));
        match k % 8 {
            5 => points[first as usize + 2] = points[first as usize] * (1.0 + 1e-12),
            6 => points[first as usize + 1] = points[first as usize],
            7 => triangles.push(triangles[numbers.below(triangles.len())]),
            _ => {}
        }
        let shared = numbers.below(points.len()) as u32;
        triangles.push([first, first + 1, first + 2]);
        triangles.push([first, first + 1, shared]);
    }
    (points, triangles)
}

/// Each triangle with vertices of its own, as in STL files.
pub(crate) fn unshared(points: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corners = triangles.iter().flatten();
    let points = corners.map(|&vertex| points[vertex as usize]).collect();
    let own = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    (points, own.collect())
}

pub(crate) fn placed(points: &[DVec3], scale: f64, offset: f64) -> Vec<DVec3> {
    let place = |p: &DVec3| scale * *p + DVec3::new(offset, -offset, 0.5 * offset);
    points.iter().map(place).collect()
}

/// Random rays, at corners and edges, along the axes through corners, in the planes of triangles,
/// from corners, with ends, and some that make no sense.
pub(crate) fn rays(points: &[DVec3], scale: f64, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    (0..count)
        .map(|k| {
            let [a, b, c] = [0; 3].map(|_| points[numbers.below(points.len())]);
            let origin = middle + 3.0 * scale * numbers.point();
            let axis = DVec3::AXES[k / 8 % 3] * [1.0, -1.0][k / 24 % 2];
            match k % 8 {
                0 => Ray::new(origin, numbers.point()),
                1 => Ray::new(origin, a - origin),
                2 => Ray::new(origin, a.lerp(b, numbers.unit()) - origin),
                3 => Ray::new(a - 2.0 * scale * axis, axis),
                4 => Ray::new(a, numbers.point()).up_to(scale * numbers.unit()),
                5 => Ray::new(a.lerp(b, 3.0), b.lerp(c, numbers.unit()) - a),
                6 => Ray::new(origin, 1e-30 * (a - origin) / scale).up_to(1e30 * scale),
                _ if k % 80 == 7 => Ray::new(origin, DVec3::splat(f64::NAN)),
                _ if k % 80 == 15 => Ray::new(origin * f64::INFINITY, axis),
                _ if k % 80 == 23 => Ray::new(origin, DVec3::ZERO),
                _ => {
                    Ray::new(middle + 1e6 * scale * numbers.point(), axis + 1e-9 * numbers.point())
                }
            }
        })
        .collect()
}

/// Short rays in all directions, many from a small place at a time, as ambient occlusion asks for:
/// from just off corners and edges, to corners nearby and just short of them, along the axes. In
/// some places there is one without an end.
pub(crate) fn short_rays(
    points: &[DVec3],
    scale: f64,
    count: usize,
    numbers: &mut Numbers,
) -> Vec<Ray> {
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let group = rays.len() / 16;
        let [a, b] = [0; 2].map(|_| points[numbers.below(points.len())]);
        let place = a.lerp(b, [0.0, 0.01, numbers.unit()][group % 3]);
        let far = |p: &DVec3| (*p - place).length();
        let nearby = points.iter().filter(|p| far(p) > 0.0);
        let corner = *nearby.min_by(|p, q| far(p).total_cmp(&far(q))).unwrap();
        let reach = scale * [0.5, 0.2, 0.03][numbers.below(3)];
        let off = reach * [0.0, 1e-5, 1e-2, 0.3][numbers.below(4)];
        for k in 0..16 {
            let origin = place + off * numbers.point();
            let axis = DVec3::AXES[k % 3] * [1.0, -1.0][k / 3 % 2];
            rays.push(match (k + group) % 8 {
                0 => Ray::new(origin, corner - origin).up_to(1.0),
                1 => Ray::new(origin, corner - origin).up_to(1.0 - f64::EPSILON),
                2 => Ray::new(origin, axis).up_to(reach),
                3 => Ray::new(place, numbers.point().with_z(0.0)).up_to(reach),
                4 if group % 4 == 0 => Ray::new(origin, numbers.point()),
                5 => Ray::new(origin, numbers.point() * DVec3::new(1.0, 1e-12, 1e-35)).up_to(reach),
                _ => Ray::new(origin, numbers.point()).up_to(reach * numbers.unit()),
            });
        }
    }
    rays.truncate(count);
    rays
}

/// Small triangles all over the cube from -1 to 1.
pub(crate) fn cloud(count: u32, numbers: &mut Numbers) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points = Vec::new();
    for _ in 0..count {
        let place = numbers.point();
        points.extend((0..3).map(|_| place + 0.06 * numbers.point()));
    }
    let triangles = (0..count).map(|k| [0, 1, 2].map(|corner| 3 * k + corner));
    (points, triangles.collect())
}

pub(crate) const PLACES: [(f64, f64); 8] = [
    (1.0, 0.0),
    (1e-6, 0.0),
    (1e6, 0.0),
    (1.0, 1e5),
    (1.0, -1e7),
    (1e-3, 1e2),
    (1e8, 3.0),
    (1e-4, 1e1),
];
