//! Neighbours that are in a plane, or nearly, as the pixels of a row, and what they see from a
//! light: these go together.

use firsthit::{DVec3, Object, Ray, Scene};

use super::checked;
use crate::support::generators::{PLACES, placed};
use crate::support::{Numbers, bumpy_sphere, cases, mesh};

/// Sixteen rays over a triangle's edge `a` to `b`, and beyond it: from one point, to one point,
/// side by side, from a bent line to one point, and apart from one another.
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
        for kind in 0..cases(300) {
            let [a, b, c] = triangles[numbers.below(triangles.len())].map(|k| points[k as usize]);
            // Along an edge, or across the triangle.
            let ends = if kind % 2 == 0 { [a, b] } else { [a, b.midpoint(c)] };
            rays.extend(fan(kind, ends, scale, &mut numbers));
        }
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        let met = checked(&scene, &rays);
        assert!(met > rays.len() / 4 && met < rays.len(), "{met}");
    }
}

/// Rays side by side that start just above the edges between small triangles far from each other,
/// with others just behind: what float32 takes from the starts is large beside the triangles.
#[test]
fn starts_far_apart_just_above_small_triangles() {
    for (round, (scale, offset)) in PLACES.into_iter().enumerate() {
        let mut numbers = Numbers::new(400 + round as u64);
        let way = DVec3::new(0.3, 0.2, 1.0);
        let (mut points, mut triangles, mut aims) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..16 * 20 {
            let size = [1e-3, 1e-4, 1e-5][k / 16 % 3];
            let depth = 0.2 * f64::from(u8::from(k % 32 > 15)) * numbers.unit();
            let place = DVec3::new((k % 16) as f64 / 16.0, (k / 16) as f64 / 20.0, depth);
            // The same square twice, cut both ways.
            let gap = [1e-9, 1e-8, 1e-7][numbers.below(3)];
            for (behind, cut) in [(0.0, [[0, 1, 2], [0, 2, 3]]), (gap, [[0, 1, 3], [1, 2, 3]])] {
                let first = u32::try_from(points.len()).unwrap();
                triangles.extend(cut.map(|t| t.map(|k| first + k)));
                for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    let corner = DVec3::new(x, y, 0.2 * numbers.unit());
                    points.push(place + size * corner + behind * way);
                }
            }
            aims.push((points.len() - 8, size));
        }
        let points = placed(&points, scale, offset);
        let ray = |&(first, size): &(usize, f64)| {
            let share = 0.1 + 0.8 * numbers.unit();
            let aim = points[first].lerp(points[first + 2], share);
            Ray::new(aim - scale * size * way, scale * way)
        };
        let rays: Vec<Ray> = aims.iter().map(ray).collect();
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        assert_eq!(checked(&scene, &rays), rays.len());
    }
}
