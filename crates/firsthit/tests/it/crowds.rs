//! Hundreds of triangles on top of one another, nearly in one plane: the order is the exact one
//! before and after the mesh knows them.

use firsthit::shoot::{Any, BruteForce, Cpu, First, trace, trace_with};
use firsthit::{Camera, DVec3, Filtered, InstructionSet, Object, Ray, Scene};

use crate::exact::check;
use crate::support::{Numbers, bits, cases, mesh, rounds, scene};

/// How corners are off their planes.
#[derive(Clone, Copy, Debug)]
enum Off {
    /// By a rounding of float64.
    LastBit,
    /// By a rounding of float32.
    Single,
    /// By a rounding of large coordinates.
    Far,
    /// Not at all.
    Nothing,
}

const ALL: [Off; 4] = [Off::LastBit, Off::Single, Off::Far, Off::Nothing];

/// Triangles in one plane, or in two that cross; its middle.
fn crowd(numbers: &mut Numbers, off: Off, planes: usize) -> (Scene, DVec3) {
    let slopes = [[0.3, 0.7], [-0.6, 0.2], [0.25, 0.5], [-0.5, 0.125]];
    let count = 240;
    let middle = match off {
        Off::Far => DVec3::new(500_000.0, 5_600_000.0, 40.0),
        _ => DVec3::ZERO,
    };
    let mut points = Vec::new();
    for k in 0..count {
        for _ in 0..3 {
            let few = (numbers.point() * f64::from(1 << 20)).round() / f64::from(1 << 20);
            let point = if matches!(off, Off::Nothing) { few } else { numbers.point() };
            let first = if matches!(off, Off::Nothing) { 2 } else { 0 };
            let [a, b] = slopes[first + k % planes];
            let point = DVec3::new(point.x, point.y, a * point.x + b * point.y);
            points.push(match off {
                Off::Single => point.as_vec3().as_dvec3(),
                _ => middle + point,
            });
        }
    }
    let triangles = (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    (scene(vec![Object::new(mesh(&points, triangles.collect()))]), middle)
}

/// A camera from one side or the other.
fn camera(numbers: &mut Numbers, middle: DVec3) -> Camera {
    let side = if numbers.unit() < 0.5 { 1.0 } else { -1.0 };
    let way = numbers.point() + side * DVec3::new(-0.3, -0.7, 1.0);
    Camera::look_at(middle + 3.0 * way, middle, DVec3::Y, 40.0, 24, 32).unwrap()
}

#[test]
fn of_hundreds_nearly_in_one_plane_pictures_have_the_first() {
    let mut numbers = Numbers::new(31);
    let mut hits = 0;
    for off in ALL {
        for planes in [1, 2] {
            let (scene, middle) = crowd(&mut numbers, off, planes);
            for _ in 0..3 {
                let camera = camera(&mut numbers, middle);
                let slow = trace_with(&BruteForce, &scene, &camera, First, &()).unwrap();
                for set in InstructionSet::available() {
                    let fast = trace_with(&Cpu::with(set), &scene, &camera, First, &()).unwrap();
                    for index in 0..24 * 32 {
                        let (fast, slow) = (fast.get(index), slow.get(index));
                        assert_eq!(bits(&fast), bits(&slow), "{off:?} {planes} {index}");
                    }
                }
                for index in rounds(24 * 32).step_by(16) {
                    let ray = camera.ray(index / 32, index % 32);
                    check(&scene, &ray, &slow.get(index));
                    hits += u32::from(!slow.get(index).is_miss());
                }
            }
        }
    }
    assert!(hits > cases(100), "{hits}");
}

#[test]
fn rays_that_leave_hundreds_nearly_in_one_plane_meet_what_is_ahead() {
    let mut numbers = Numbers::new(32);
    let [mut free, mut blocked] = [0, 0];
    for off in ALL {
        for planes in [1, 2] {
            let (scene, middle) = crowd(&mut numbers, off, planes);
            let camera = camera(&mut numbers, middle);
            let known = trace(&scene, &camera, First, &()).unwrap();
            let (mut rays, mut filters) = (Vec::<Ray>::new(), Vec::new());
            for index in rounds(24 * 32) {
                let ray = camera.ray(index / 32, index % 32);
                if let Some(surface) = scene.interaction(&ray, &known.get(index)) {
                    for way in [-ray.direction, numbers.point(), numbers.point()] {
                        let (ray, filter) = surface.leave(way);
                        rays.push(ray);
                        filters.push(filter);
                    }
                }
            }
            let rays = Filtered::each(&rays, &filters);
            let found = trace_with(&BruteForce, &scene, &rays, Any, &()).unwrap();
            let first = trace_with(&BruteForce, &scene, &rays, First, &()).unwrap();
            for set in InstructionSet::available() {
                let cpu = Cpu::with(set);
                let fast = trace_with(&cpu, &scene, &rays, Any, &()).unwrap();
                assert_eq!(fast, found, "{off:?} {planes}");
                let fast = trace_with(&cpu, &scene, &rays, First, &()).unwrap();
                for k in 0..found.len() {
                    assert_eq!(bits(&fast.get(k)), bits(&first.get(k)), "{off:?} {planes} {k}");
                }
            }
            free += found.iter().filter(|found| !**found).count();
            blocked += found.iter().filter(|found| **found).count();
        }
    }
    assert!(free > cases(1000) && blocked > cases(300), "{free} {blocked}");
}

/// Rays in no order, which no tile sees.
#[test]
fn of_hundreds_nearly_in_one_plane_single_rays_meet_the_first() {
    let mut numbers = Numbers::new(33);
    for off in ALL {
        let (scene, middle) = crowd(&mut numbers, off, 2);
        let warm = camera(&mut numbers, middle);
        trace(&scene, &warm, First, &()).unwrap();
        let rays: Vec<Ray> = (0..cases(2000))
            .map(|_| {
                let target = middle + numbers.point() * DVec3::new(0.6, 0.6, 0.1);
                let origin = middle + 4.0 * numbers.point();
                Ray::new(origin, target - origin)
            })
            .collect();
        let slow = trace_with(&BruteForce, &scene, &rays, First, &()).unwrap();
        for set in InstructionSet::available() {
            let fast = trace_with(&Cpu::with(set), &scene, &rays, First, &()).unwrap();
            for (k, ray) in rays.iter().enumerate() {
                assert_eq!(bits(&fast.get(k)), bits(&slow.get(k)), "{off:?} {ray:?}");
            }
        }
    }
}
