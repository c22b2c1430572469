//! Rays that leave edges and vertices of open meshes: what a ray from a little above meets at once
//! stops them.

use std::sync::Arc;

use firsthit::measure::thickness;
use firsthit::shoot::{Any, BruteForce, Count, Cpu, First, trace, trace_with};
use firsthit::{DVec3, Filtered, InstructionSet, Object, Ray, Scene, Transform};

use crate::support::{Numbers, bits, cases, mesh, scene};

fn object(points: &[DVec3], triangles: Vec<[u32; 3]>) -> Object {
    Object::new(mesh(points, triangles))
}

/// Whether rays from the place under `above` meet something, and the first `t`, by all that
/// answers.
fn stopped(scene: &Scene, above: DVec3, ways: &[DVec3]) -> Vec<bool> {
    let down = Ray::new(above, DVec3::NEG_Z);
    let hits = trace(scene, &[down], First, &()).unwrap();
    let hit = hits.get(0);
    let surface = scene.interaction(&down, &hit).unwrap();
    let (rays, filters): (Vec<_>, Vec<_>) = ways.iter().map(|&way| surface.leave(way)).unzip();
    let rays = Filtered::each(&rays, &filters);
    let found = trace_with(&BruteForce, scene, &rays, Any, &()).unwrap();
    let first = trace_with(&BruteForce, scene, &rays, First, &()).unwrap();
    let count = trace_with(&BruteForce, scene, &rays, Count, &()).unwrap();
    for set in InstructionSet::available() {
        let cpu = Cpu::with(set);
        assert_eq!(trace_with(&cpu, scene, &rays, Any, &()).unwrap(), found);
        let fast = trace_with(&cpu, scene, &rays, First, &()).unwrap();
        for k in 0..ways.len() {
            assert_eq!(
                bits(&fast.get(k)),
                bits(&first.get(k)),
                "{:?} {:?}",
                fast.get(k),
                first.get(k)
            );
        }
        assert_eq!(trace_with(&cpu, scene, &rays, Count, &()).unwrap(), count);
    }
    for (k, &is_met) in found.iter().enumerate() {
        assert_eq!(first.t[k].is_finite(), is_met);
        assert_eq!(count[k] > 0, is_met);
    }
    found
}

/// z = |x|, with vertices on its bottom line.
fn valley() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let row = |x: f64, z: f64| [-1.0, 0.0, 1.0].map(|y| DVec3::new(x, y, z));
    let points = [row(-1.0, 1.0), row(0.0, 0.0), row(1.0, 1.0)].concat();
    let mut triangles = Vec::new();
    for strip in [0, 3] {
        for k in [strip, strip + 1] {
            triangles.extend([[k, k + 3, k + 4], [k, k + 4, k + 1]]);
        }
    }
    (points, triangles)
}

#[test]
fn rays_from_the_bottom_of_an_open_valley_do_not_pass_through_its_slopes() {
    let (points, triangles) = valley();
    let turned: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let mirror = |points: &[DVec3]| -> Vec<DVec3> {
        points.iter().map(|p| DVec3::new(-p.x, p.y, p.z)).collect()
    };
    let far = Transform::translation(DVec3::new(4_500_000.0, 5_300_000.0, 812.0)).unwrap();
    let objects = [
        object(&points, triangles.clone()),
        object(&points, turned.clone()),
        object(&mirror(&points), turned),
        object(&points, triangles.iter().rev().copied().collect()),
        object(&points, triangles).placed(far),
    ];
    let ways = [
        ([-0.9, 0.0, 0.3], true),
        ([0.9, 0.0, 0.3], true),
        ([0.9, 0.4, 0.3], true),
        ([-0.9, 0.0, 0.91], false),
        ([0.9, 0.5, 0.91], false),
        ([0.0, 0.7, 0.01], false),
        ([0.0, 0.0, 1.0], false),
        // Against both slopes it goes through, as in a face.
        ([0.0, 0.0, -1.0], false),
    ];
    let expected = ways.map(|(_, is_stopped)| is_stopped);
    let ways = ways.map(|(way, _)| DVec3::from(way));
    for (number, valley) in objects.into_iter().enumerate() {
        let above = DVec3::new(0.0, 0.0, 5.0);
        // On a vertex, and on an edge.
        for y in [0.0, 0.25] {
            let above = valley.transform().point_in_world(above + y * DVec3::Y);
            // Alone, and in a scene with others.
            let beside =
                object(&[DVec3::splat(-50.0), DVec3::splat(-51.0), DVec3::X], vec![[0, 1, 2]]);
            for objects in [vec![valley.clone()], vec![valley.clone(), beside]] {
                let scene = scene(objects);
                assert_eq!(stopped(&scene, above, &ways), expected, "{number} {y}");
            }
        }
    }
}

#[test]
fn a_face_that_a_mesh_has_twice_stops_rays_from_its_corners_once() {
    let (points, triangles) = valley();
    let ways = [[-0.9, 0.0, 0.3], [0.9, 0.4, 0.3], [0.9, 0.5, 0.91]].map(DVec3::from);
    // A few faces around the corner, and so many that they are sorted.
    for (first, copies) in [(1, 1), (3, 1), (4, 1), (4, 20), (4, 21)] {
        for order in [[0, 1, 2], [1, 2, 0], [0, 2, 1]] {
            let again = order.map(|k| triangles[first][k]);
            let all = [triangles.clone(), vec![again; copies]].concat();
            let scene = scene(vec![object(&points, all)]);
            let found = stopped(&scene, DVec3::new(0.0, 0.0, 5.0), &ways);
            assert_eq!(found, [true, true, false], "{first} {copies} {order:?}");
        }
    }
}

#[test]
fn a_face_without_an_area_frees_no_rays_from_its_corners() {
    let (points, triangles) = valley();
    let ways = [[-0.9, 0.0, 0.3], [0.9, 0.4, 0.3], [0.9, 0.5, 0.91]].map(DVec3::from);
    for flat in [[4, 4, 1], [1, 4, 1], [4, 4, 4], [3, 4, 5]] {
        for all in
            [[triangles.clone(), vec![flat]].concat(), [vec![flat], triangles.clone()].concat()]
        {
            let scene = scene(vec![object(&points, all)]);
            let found = stopped(&scene, DVec3::new(0.0, 0.0, 5.0), &ways);
            assert_eq!(found, [true, true, false], "{flat:?}");
        }
    }
}

/// Heights without order on a grid, whose vertices have whole coordinates across.
fn terrain(side: u32, numbers: &mut Numbers) -> Scene {
    let mut points = Vec::new();
    for x in 0..side {
        for y in 0..side {
            points.push(DVec3::new(x.into(), y.into(), 1.5 * numbers.unit()));
        }
    }
    let mut triangles = Vec::new();
    for x in 0..side - 1 {
        for y in 0..side - 1 {
            let k = x * side + y;
            triangles.extend([[k, k + side, k + side + 1], [k, k + side + 1, k + 1]]);
        }
    }
    scene(vec![object(&points, triangles)])
}

#[test]
fn a_terrain_is_seen_from_its_vertices_as_from_a_little_above_them() {
    let mut numbers = Numbers::new(5);
    let (side, mut stopped, mut free) = (12, 0, 0);
    let scene = terrain(side, &mut numbers);
    for _ in 0..cases(3000) {
        let inner = |numbers: &mut Numbers| 1.0 + numbers.below(side as usize - 2) as f64;
        let [x, y] = [inner(&mut numbers), inner(&mut numbers)];
        // Vertices, the three kinds of edges, and faces.
        let share = numbers.unit();
        let [x, y] = match numbers.below(5) {
            0 => [x + share, y],
            1 => [x, y + share],
            2 => [x + share, y + share],
            3 => [x + share, y + numbers.unit()],
            _ => [x, y],
        };
        let down = Ray::new(DVec3::new(x, y, 9.0), DVec3::NEG_Z);
        let hit = trace(&scene, &[down], First, &()).unwrap().get(0);
        let surface = scene.interaction(&down, &hit).unwrap();
        let mut way = numbers.point();
        way.z = 0.5 * way.z.abs();
        if way.dot(surface.normal()) <= 0.0 {
            continue;
        }
        let (ray, filter) = surface.leave(way);
        let is_stopped = trace(&scene, &Filtered::new(&[ray], filter), Any, &()).unwrap()[0];
        let above = Ray::new(ray.origin + 1e-9 * DVec3::Z, way);
        assert_eq!(is_stopped, trace(&scene, &[above], Any, &()).unwrap()[0], "{hit:?} {way:?}");
        stopped += usize::from(is_stopped);
        free += usize::from(!is_stopped);
    }
    assert!(stopped > cases(300) && free > cases(300), "{stopped} {free}");
}

/// Once many rays have left vertices, what is around each is known, and the answers stay.
#[test]
fn rays_from_vertices_of_a_terrain_are_stopped_alike_however_many_there_were() {
    let mut numbers = Numbers::new(6);
    let side = 9;
    let scene = terrain(side, &mut numbers);
    let (mut rays, mut filters) = (Vec::new(), Vec::new());
    for x in 0..side {
        for y in 0..side {
            let down = Ray::new(DVec3::new(x.into(), y.into(), 9.0), DVec3::NEG_Z);
            let hit = trace(&scene, &[down], First, &()).unwrap().get(0);
            let surface = scene.interaction(&down, &hit).unwrap();
            for _ in 0..4 {
                let (ray, filter) = surface.leave(numbers.point());
                rays.push(ray);
                filters.push(filter);
            }
        }
    }
    let mesh = scene.objects()[0].mesh().unwrap();
    let alone = |k: usize| {
        // It knows nothing yet.
        let fresh = Scene::new(vec![Object::new(Arc::new((**mesh).clone()))]).unwrap();
        let ray = Filtered::new(&rays[k..=k], filters[k]);
        trace(&fresh, &ray, Any, &()).unwrap()[0]
    };
    let alone: Vec<bool> = (0..rays.len()).map(alone).collect();
    for _ in 0..2 {
        let all = Filtered::each(&rays, &filters);
        assert_eq!(trace(&scene, &all, Any, &()).unwrap(), alone);
    }
}

#[test]
fn thickness_at_a_vertex_of_an_open_mesh_is_measured_through_it() {
    let (mut points, mut triangles) = valley();
    let below = |p: &DVec3| *p - DVec3::Z;
    points.extend(points.clone().iter().map(below));
    triangles.extend(triangles.clone().into_iter().map(|[a, b, c]| [a + 9, c + 9, b + 9]));
    let scene = scene(vec![object(&points, triangles)]);
    // At a vertex, at an edge and in a face, against the normal of a slope.
    let at = [[0.0; 3], [0.0, 0.25, 0.0], [-0.25, 0.1, 0.25]];
    for length in thickness(&scene, &at, &()).unwrap() {
        assert!((length - 0.5_f64.sqrt()).abs() < 1e-12, "{length}");
    }
}
