//! Objects that touch in the world, each with its own transform, against exact arithmetic in the
//! world.
//!
//! The triangle of an object is what its transform makes of it without rounding. A ray that meets
//! it exactly meets it.

use std::sync::Arc;

use firsthit::shoot::{All, Cpu, First, trace, trace_with};
use firsthit::{
    DAffine3, DMat3, DVec3, Filtered, Hit, InstructionSet, Mesh, Object, Ray, RayFilter, Scene,
    SurfaceId, Transform,
};
use num_rational::BigRational;

use super::compared;
use crate::support::rational::{Exact, cross, dot, exact, minus, nearest, number};
use crate::support::{Ask, CUBE, Numbers, bits, cases, mesh, scene};

/// Where a transform puts a point, without rounding.
fn in_world(place: &DAffine3, point: DVec3) -> Exact {
    let rows = place.matrix3.transpose().to_cols_array_2d();
    let point = exact(point);
    std::array::from_fn(|k| dot(&rows[k].map(number), &point) + number(place.translation[k]))
}

/// Where a ray crosses a triangle, edges and corners included.
fn crossing(ray: &Ray, corners: [Exact; 3]) -> Option<BigRational> {
    let zero = number(0.0);
    let (origin, d) = (exact(ray.origin), exact(ray.direction));
    let [a, b, c] = corners.map(|corner| minus(&corner, &origin));
    let n = cross(&minus(&b, &a), &minus(&c, &a));
    let slope = dot(&n, &d);
    if slope == zero {
        return None;
    }
    let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&d, &cross(p, q)) / &slope);
    if sides.iter().any(|side| *side < zero) {
        return None;
    }
    let t = dot(&n, &a) / slope;
    (t > zero).then_some(t)
}

/// Whether a ray passes a triangle at a distance that rounding is nothing beside.
fn passes(ray: &Ray, corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners;
    let middle = (a + b + c) / 3.0;
    let radius = (a - middle)
        .length()
        .max((b - middle).length())
        .max((c - middle).length());
    let way = ray.direction.normalize();
    let off = (middle - ray.origin).cross(way).length();
    off > 1.01 * radius + 1e-13 * (ray.origin.length() + middle.length())
}

/// The triangles that a ray meets: `t`, the object and its triangle.
fn met(scene: &Scene, ray: &Ray) -> Vec<(f64, i32, i32)> {
    let mut all = Vec::new();
    for (index, object) in (0..).zip(scene.objects()) {
        let place = object.transform().world_from_object();
        let mesh = object.mesh().unwrap();
        for triangle in 0..mesh.triangles().len() {
            let corners = mesh.corners(triangle);
            if !passes(ray, corners.map(|corner| place.transform_point3(corner))) {
                let t = crossing(ray, corners.map(|corner| in_world(place, corner)));
                all.extend(t.map(|t| (nearest(&t), index, triangle as i32)));
            }
        }
    }
    all
}

/// A square of four by four, cut into triangles in the plane z = 0, from a corner on.
fn tile(corner: DVec3, size: f64) -> Arc<Mesh> {
    let points: Vec<DVec3> = (0..25)
        .map(|k| corner + 0.25 * size * DVec3::new(f64::from(k % 5), f64::from(k / 5), 0.0))
        .collect();
    let squares = (0..16).map(|k| k / 4 * 5 + k % 4);
    let halves = squares.flat_map(|k| [[k, k + 1, k + 6], [k, k + 6, k + 5]]);
    mesh(&points, halves.collect())
}

fn cube(corner: DVec3) -> Arc<Mesh> {
    let bit = |k: u32, bit: u32| f64::from(k >> bit & 1);
    let points: Vec<DVec3> = (0..8)
        .map(|k| corner + DVec3::new(bit(k, 0), bit(k, 1), bit(k, 2)))
        .collect();
    mesh(&points, CUBE.to_vec())
}

fn placed(mesh: &Arc<Mesh>, matrix: DMat3, translation: DVec3) -> Object {
    let place = DAffine3::from_mat3_translation(matrix, translation);
    Object::new(Arc::clone(mesh)).placed(Transform::new(place).unwrap())
}

/// The squares of a floor of seven by seven around a place.
fn squares(around: DVec3) -> impl Iterator<Item = DVec3> {
    (0..49).map(move |k| around + DVec3::new(f64::from(k % 7 - 3), f64::from(k / 7 - 3), 0.0))
}

const UTM: DVec3 = DVec3::new(500_000.0, 5_200_000.0, 120.5);

/// Floors without a gap, by how they are made of objects.
fn floors() -> Vec<(&'static str, Vec<Object>)> {
    let pivot = DVec3::new(f64::from(0.7_f32), f64::from(-11.3_f32), f64::from(0.1_f32));
    let (unit, off) = (tile(DVec3::ZERO, 1.0), tile(pivot, 1.0));
    let mapped = tile(UTM, 1.0);
    let one = DMat3::IDENTITY;
    let quarter = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
    let tipped = DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y);
    let turned = |place: DVec3, k: i32| {
        let matrix = (0..k % 4).fold(one, |matrix, _| quarter * matrix);
        let middle = DVec3::new(0.5, 0.5, 0.0);
        placed(&off, matrix, place + middle - matrix * (pivot + middle))
    };
    let upright = {
        let points: Vec<DVec3> = (0..off.positions().len())
            .map(|k| tipped.transpose() * off.positions().get(k as u32))
            .collect();
        mesh(&points, off.triangles().to_vec())
    };
    let half = tile(pivot, 0.5);
    let stretched = {
        let stretch = DVec3::new(4.0, 0.5, -1.0);
        let points: Vec<DVec3> = (0..off.positions().len())
            .map(|k| stretch * off.positions().get(k as u32))
            .collect();
        mesh(&points, off.triangles().to_vec())
    };
    let around = |make: &dyn Fn(DVec3) -> Object| squares(DVec3::ZERO).map(make).collect();
    vec![
        ("integers", around(&|place| placed(&unit, one, place))),
        (
            "fractions",
            around(&|place| placed(&off, one, place - pivot)),
        ),
        (
            "maps",
            squares(UTM)
                .map(|place| placed(&unit, one, place))
                .collect(),
        ),
        (
            "maps at the origin",
            around(&|place| placed(&mapped, one, place - UTM)),
        ),
        (
            "turned",
            squares(DVec3::ZERO)
                .zip(0..)
                .map(|(place, k)| turned(place, k))
                .collect(),
        ),
        (
            "tipped",
            around(&|place| placed(&upright, tipped, place - pivot)),
        ),
        (
            "mirrored",
            squares(DVec3::ZERO)
                .zip(0..)
                .map(|(place, k)| {
                    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
                    match k % 2 {
                        0 => placed(&off, one, place - pivot),
                        _ => placed(&off, mirror, place + DVec3::X - mirror * pivot),
                    }
                })
                .collect(),
        ),
        (
            "scaled",
            squares(DVec3::ZERO)
                .zip(0..)
                .map(|(place, k)| {
                    let twice = DMat3::from_diagonal(DVec3::splat(2.0));
                    let squeezed = DMat3::from_diagonal(DVec3::new(0.25, 2.0, -1.0));
                    match k % 3 {
                        0 => placed(&off, one, place - pivot),
                        1 => placed(&half, twice, place - twice * pivot),
                        _ => placed(&stretched, squeezed, place - pivot),
                    }
                })
                .collect(),
        ),
        (
            "cubes",
            (0..27)
                .map(|k| {
                    let place =
                        DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
                    placed(&cube(pivot), one, place - DVec3::splat(1.5) - pivot)
                })
                .collect(),
        ),
    ]
}

/// A random edge or corner of a triangle in the world: a point of it.
fn target(scene: &Scene, numbers: &mut Numbers) -> DVec3 {
    let object = &scene.objects()[numbers.below(scene.objects().len())];
    let mesh = object.mesh().unwrap();
    let corners = mesh.corners(numbers.below(mesh.triangles().len()));
    let place = object.transform().world_from_object();
    let k = numbers.below(3);
    let [a, b] = [corners[k], corners[(k + 1) % 3]].map(|corner| place.transform_point3(corner));
    match numbers.below(3) {
        0 => a,
        1 => a + 0.125 * numbers.below(9) as f64 * (b - a),
        _ => a.lerp(b, numbers.unit()),
    }
}

/// A ray at an edge or a corner: exactly, or as exactly as float64 has it.
fn aimed(scene: &Scene, numbers: &mut Numbers) -> Ray {
    let target = target(scene, numbers);
    let mut from = numbers.point() * DVec3::new(2.0, 2.0, 3.0);
    from.z += 3.0_f64.copysign(from.z);
    match numbers.below(20) {
        0 => {
            let axis = DVec3::AXES[numbers.below(3)];
            Ray::new(target - 4.0 * axis, axis)
        }
        1 => {
            let origin = target + 1e9 * from;
            Ray::new(origin, target - origin)
        }
        2..6 => {
            let few = (from * 1_048_576.0).round() / 1_048_576.0;
            Ray::new(target - few, few)
        }
        6..12 => Ray::new(target - from, from),
        _ => {
            let origin = target + from;
            Ray::new(origin, target - origin)
        }
    }
}

/// Compares a hit with what is exactly met.
fn check(name: &str, scene: &Scene, ray: &Ray, hit: &Hit) -> bool {
    let met = met(scene, ray);
    let what = || format!("{name} {ray:?}: {hit:?}, exactly {met:?}");
    assert_eq!(hit.is_miss(), met.is_empty(), "{}", what());
    let first = met.iter().map(|(t, _, _)| *t).fold(f64::INFINITY, f64::min);
    let own = |(_, object, triangle): &&(f64, i32, i32)| {
        (hit.object, hit.primitive) == (*object, *triangle)
    };
    if let Some((t, _, _)) = met.iter().find(own) {
        // Of the first ones one whose `t` is as small but for the rounding of the origin.
        assert!(
            (t - first).abs() <= 1e-6 * (1.0 + t) && (hit.t - t).abs() <= 1e-6 * (1.0 + t),
            "{}",
            what()
        );
    } else {
        assert!(hit.is_miss(), "{}", what());
    }
    !hit.is_miss()
}

#[test]
fn no_ray_passes_between_objects_that_touch_in_the_world() {
    for (name, objects) in floors() {
        let scene = scene(objects);
        let mut numbers = Numbers::new(3);
        let rays: Vec<Ray> = (0..cases(3000))
            .map(|_| aimed(&scene, &mut numbers))
            .collect();
        let hits = compared(&scene, &rays);
        let met = rays
            .iter()
            .zip(&hits)
            .filter(|(ray, hit)| check(name, &scene, ray, hit))
            .count();
        assert!(met > rays.len() / 2, "{name}: {met}");
    }
}

/// The only object of a scene goes another way, and so do rays with filters.
#[test]
fn a_moved_mesh_is_met_where_it_is_in_the_world() {
    for (name, objects) in floors() {
        let scene = scene(objects[24..25].to_vec());
        let mut numbers = Numbers::new(4);
        let rays: Vec<Ray> = (0..cases(1500))
            .map(|_| aimed(&scene, &mut numbers))
            .collect();
        let hits = compared(&scene, &rays);
        for (ray, hit) in rays.iter().zip(&hits) {
            check(name, &scene, ray, hit);
        }
        let elsewhere = SurfaceId {
            object: 0,
            primitive: 1000,
        };
        let filter = RayFilter {
            skip: [Some(elsewhere), None],
            ..RayFilter::NONE
        };
        let filtered = Filtered::new(&rays[..], filter);
        for set in InstructionSet::available() {
            let answers = trace_with(&Cpu::with(set), &scene, &filtered, First, &()).unwrap();
            for (k, hit) in hits.iter().enumerate() {
                assert_eq!(
                    bits(&answers.get(k)),
                    bits(hit),
                    "{name} {set:?} {:?}",
                    rays[k]
                );
            }
        }
        for (ray, hit) in rays.iter().zip(&hits).step_by(7) {
            let explanation = scene.explain(ray).unwrap();
            let explained = explanation.hit.map_or(Hit::MISS, |hit| hit.hit);
            assert_eq!(bits(&explained), bits(hit), "{name} {ray:?}");
        }
    }
}

/// Each cube is closed and convex: a ray from outside crosses it twice or not at all.
#[test]
fn a_ray_leaves_each_moved_cube_as_often_as_it_enters_it() {
    let (name, objects) = floors().pop().unwrap();
    assert_eq!(name, "cubes");
    let scene = scene(objects);
    let mut numbers = Numbers::new(5);
    let rays: Vec<Ray> = (0..cases(6000))
        .map(|_| aimed(&scene, &mut numbers))
        .collect();
    let all = trace(&scene, &rays, All::default(), &()).unwrap();
    let mut crossed = 0;
    for (k, ray) in rays.iter().enumerate() {
        let hits: Vec<Hit> = (all.offsets[k]..all.offsets[k + 1])
            .map(|at| all.hits.get(at))
            .collect();
        for object in 0..27 {
            let of_it: Vec<&Hit> = hits.iter().filter(|hit| hit.object == object).collect();
            assert!(of_it.is_empty() || of_it.len() == 2, "{ray:?} {of_it:?}");
            crossed += of_it.len() / 2;
        }
    }
    assert!(crossed > rays.len(), "{crossed}");
}
