//! Many triangles that overlap in one plane, or nearly: their planes become known on the way
//! (`shape/mesh/planes.rs`), and nothing changes by that.

use firsthit::shoot::{Any, BruteForce, Count, Cpu, Engine, First, trace_with};
use firsthit::{Camera, DVec3, Filtered, Hit, InstructionSet, Object, Ray, RayFilter, Rays, Scene};

use super::checked;
use crate::support::{Numbers, bits, cases, mesh};

/// Triangles in the plane z = slope . (x, y), of coordinates that make this exact; every fifth is a
/// last digit beside it, and `fan` says whether all the others have a corner in common.
fn sheet(count: u32, slope: [f64; 2], is_fan: bool, numbers: &mut Numbers) -> Scene {
    let mut points = Vec::new();
    for k in 0..count {
        for corner in 0..3 {
            let [x, y] = if is_fan && corner == 0 {
                [0.5, 0.5]
            } else {
                [0.0; 2].map(|_| (numbers.unit() * 1024.0).round() / 1024.0)
            };
            let z = slope[0] * x + slope[1] * y;
            let z = if k % 5 == 4 { z.next_up() } else { z };
            points.push(DVec3::new(x, y, z));
        }
    }
    let triangles = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap()
}

fn same(one: &Hit, other: &Hit) {
    assert_eq!(bits(one), bits(other), "{one:?} {other:?}");
}

#[test]
fn of_many_triangles_in_one_plane_the_lowest_is_met_and_rays_that_leave_them_meet_none() {
    let mut numbers = Numbers::new(31);
    for (slope, is_fan) in
        [([0.0, 0.0], false), ([0.0, 0.0], true), ([0.5, 0.25], false), ([0.5, 0.25], true)]
    {
        let count = 150;
        let scene = sheet(count, slope, is_fan, &mut numbers);
        let eye = DVec3::new(0.3, -1.0, 2.0);
        let aim = DVec3::new(0.5, 0.5, 0.3);
        let camera = Camera::look_at(eye, aim, DVec3::Z, 30.0, 24, 24).unwrap();
        let down = |numbers: &mut Numbers| {
            let start = DVec3::new(numbers.unit(), numbers.unit(), 2.0);
            Ray::new(start, DVec3::new(0.0, 0.0, -1.0) + 0.1 * numbers.point())
        };
        let rays: Vec<Ray> = (0..cases(200)).map(|_| down(&mut numbers)).collect();
        // Twice: the planes are known by then at the latest.
        for _ in 0..2 {
            assert!(checked(&scene, &camera) > 100);
            checked(&scene, &rays);
        }
        let hits: Vec<Hit> = (0..camera.len())
            .map(|k| BruteForce.first_hit(&scene, &Rays::ray(&camera, k)))
            .collect();
        let (mut leaving, mut filters): (Vec<Ray>, Vec<RayFilter>) = (Vec::new(), Vec::new());
        for (k, hit) in hits.iter().enumerate() {
            let ray = Rays::ray(&camera, k);
            if let Some(surface) = scene.interaction(&ray, hit) {
                // Also in the plane.
                let mut way = numbers.point();
                if k % 7 == 0 {
                    way.z = slope[0] * way.x + slope[1] * way.y;
                }
                let (ray, filter) = surface.leave(way);
                leaving.push(ray);
                filters.push(filter);
            }
        }
        let rays = Filtered::each(&leaving, &filters);
        let first = trace_with(&BruteForce, &scene, &rays, First, &()).unwrap();
        let any = trace_with(&BruteForce, &scene, &rays, Any, &()).unwrap();
        let all = trace_with(&BruteForce, &scene, &rays, Count, &()).unwrap();
        for set in InstructionSet::available() {
            let cpu = Cpu::with(set);
            let found = trace_with(&cpu, &scene, &rays, First, &()).unwrap();
            (0..rays.len()).for_each(|k| same(&found.get(k), &first.get(k)));
            assert_eq!(trace_with(&cpu, &scene, &rays, Any, &()).unwrap(), any);
            assert_eq!(trace_with(&cpu, &scene, &rays, Count, &()).unwrap(), all);
        }
    }
}
