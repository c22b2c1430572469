//! Neighbours that are in a plane, or nearly, as the pixels of a row, and what they see from a light: these go together.

use firsthit::{DVec3, Object, Ray, Scene};

use super::pixels::grid;
use super::support::{Numbers, bumpy_sphere, mesh};
use super::{PLACES, judged, placed};

/// Sixteen rays over a triangle's edge `a` to `b`, and beyond it: from one point, to one point, side by side, from a bent line
/// to one point, and apart from one another.
fn fan(kind: usize, [a, b]: [DVec3; 2], scale: f64, numbers: &mut Numbers) -> Vec<Ray> {
    let light = a + scale * (0.2 + numbers.unit()) * numbers.point();
    let way = light - a;
    let width = [0.9, 3.0, 12.0][numbers.below(3)];
    let bend = scale * [1e-3, 1e-6, 1e-9][numbers.below(3)] * numbers.point();
    let along = (0..16).map(|k| f64::from(k) / 15.0);
    along
        .map(|x| {
            let on = a.lerp(b, width * (x - 0.5) + 0.5);
            let above = on + 1e-4 * (light - on);
            match kind % 5 {
                0 => Ray::new(light, on - light),
                1 => Ray::new(above, light - above).up_to(1.0),
                2 => Ray::new(on - way, way),
                3 => Ray::new(above + bend * (x * x), light - above).up_to(1.0),
                _ => Ray::new(on + 2.0 * way, -way + bend * x),
            }
        })
        .collect()
}

#[test]
fn fans_over_edges() {
    for (round, (scale, offset)) in PLACES.into_iter().enumerate() {
        let mut numbers = Numbers::new(300 + round as u64);
        let (points, triangles) = bumpy_sphere(20, round as u64);
        let points = placed(&points, scale, offset);
        let mut rays = Vec::new();
        for kind in 0..300 {
            let [a, b, c] = triangles[numbers.below(triangles.len())].map(|k| points[k as usize]);
            // Along an edge, or across the triangle.
            let ends = if kind % 2 == 0 {
                [a, b]
            } else {
                [a, b.midpoint(c)]
            };
            rays.extend(fan(kind, ends, scale, &mut numbers));
        }
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        let met = judged(&scene, &rays);
        assert!(met > rays.len() / 4 && met < rays.len(), "{met}");
    }
}

/// Rays side by side that start just above edges of a sheet, with another sheet just behind: starts far apart beside all
/// else, so that what float32 takes from them decides.
#[test]
fn starts_far_apart_just_above_edges() {
    const SIDE: usize = 24;
    for (round, (scale, offset)) in PLACES.into_iter().enumerate() {
        let mut numbers = Numbers::new(400 + round as u64);
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for gap in [0.0, [1e-7, 3e-8, 1e-6][round % 3]] {
            let first = u32::try_from(points.len()).unwrap();
            for k in 0..SIDE * SIDE {
                let place = DVec3::new((k % SIDE) as f64, (k / SIDE) as f64, 0.0);
                let place = place + 0.3 * numbers.point() * DVec3::new(1.0, 1.0, 0.0);
                points.push(place / SIDE as f64 + gap * DVec3::Z);
            }
            let sheet = grid(u32::try_from(SIDE).unwrap());
            triangles.extend(sheet.into_iter().map(|t| t.map(|k| first + k)));
        }
        let points = placed(&points, scale, offset);
        let way = scale * DVec3::new(0.3, 0.2, 1.0);
        let mut rays = Vec::new();
        for row in triangles.chunks(2 * (SIDE - 1)).cycle().take(120) {
            let height = [1e-4, 1e-3, 1e-2][numbers.below(3)];
            for k in 0..16 {
                let corners = row[k * row.len() / 16].map(|k| points[k as usize]);
                let [from, to] = [corners[k % 3], corners[(k + 1) % 3]];
                rays.push(Ray::new(from.lerp(to, numbers.unit()) - height * way, way));
            }
        }
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        // At the border a ray may pass.
        let met = judged(&scene, &rays);
        assert!(met > rays.len() * 9 / 10, "{met}");
    }
}
