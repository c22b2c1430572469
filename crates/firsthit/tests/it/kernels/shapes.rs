//! Shapes that are no meshes, alone and among meshes: pictures ask those that a tile may see, other
//! rays those that a beam of them may meet, and where there are many a tree.

use std::sync::Arc;

use firsthit::shoot::{Any, BruteForce, Cpu, First, trace, trace_with};
use firsthit::{
    Cone, Cuboid, Cylinder, DAffine3, DMat3, DVec3, Disc, Filtered, InstructionSet, Mesh, Object,
    Plane, Ray, RayFilter, Rays, Scene, Shape, Side, Sphere, SurfaceId, Transform,
};

use super::pixels::cameras;
use super::{bits, checked};
use crate::support::generators::{PLACES, placed, rays, short_rays};
use crate::support::{Numbers, bumpy_sphere, cases, is_full, mesh};

/// A shape of every kind in turn, near a point; an infinite one only now and then.
fn shape(k: usize, centre: DVec3, scale: f64, numbers: &mut Numbers) -> Shape {
    let radius = scale * [0.5, 0.1, 0.02][k % 3];
    let axis = scale * numbers.point();
    match k % 7 {
        0 | 5 => Sphere::new(centre, radius).unwrap().into(),
        1 => {
            let size = radius * (numbers.point() + 1.5);
            Cuboid::new(centre - size, centre + size).unwrap().into()
        }
        2 => Cylinder::new(centre, centre + axis, radius).unwrap().into(),
        3 => {
            let top = [0.0, 0.3, 1.5][k / 7 % 3] * radius;
            Cone::new(centre, centre + axis, radius, top).unwrap().into()
        }
        6 if k % 14 == 6 => Plane::new(centre, axis).unwrap().into(),
        _ => Disc::new(centre, axis, radius).unwrap().into(),
    }
}

/// So many shapes around a place, some of them turned and stretched, one hidden, two in the place
/// of others; a few meshes among them if there is one.
fn objects(
    count: usize,
    (scale, offset): (f64, f64),
    bumpy: Option<&Arc<Mesh>>,
    numbers: &mut Numbers,
) -> Vec<Object> {
    let mut objects: Vec<Object> = Vec::new();
    for k in 0..count {
        let at = placed(&[1.5 * numbers.point()], scale, offset)[0];
        let matrix = DMat3::from_cols(numbers.point(), numbers.point(), numbers.point());
        let turn = |size: f64| {
            let affine = DAffine3::from_mat3_translation(size * matrix, at);
            Transform::new(affine).unwrap()
        };
        objects.push(match (k % 5, bumpy) {
            (3, Some(bumpy)) => Object::new(Arc::clone(bumpy)).placed(turn(0.5 * scale)),
            (2, _) => Object::new(shape(k, DVec3::ZERO, 1.0, numbers)).placed(turn(scale)),
            _ => Object::new(shape(k, at, scale, numbers)),
        });
    }
    if count > 6 {
        objects[1] = objects[4].clone();
        objects[5] = objects[0].clone();
        objects[6] = objects[6].clone().hidden(true);
    }
    objects
}

/// Rays sixteen by sixteen that nearly agree, from a place that they share or from places side by
/// side, some of them with ends.
pub(super) fn beams(places: &[DVec3], scale: f64, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let mut rays = Vec::with_capacity(16 * count);
    for k in 0..count {
        let origin = places[numbers.below(places.len())] + 3.0 * scale * numbers.point();
        let target = places[numbers.below(places.len())];
        let way = [target - origin, DVec3::AXES[k % 3], -DVec3::AXES[k % 3]][k / 2 % 3];
        let spread = scale * [0.0, 1e-3, 0.1][k % 3];
        for lane in 0..16 {
            let start = origin + [0.0, spread][k % 2] * numbers.point();
            let aside = spread / scale * way.length() * numbers.point();
            let ray = Ray::new(start, way + [aside, DVec3::ZERO][k / 4 % 2]);
            rays.push(match (k % 8, lane) {
                (5, _) => ray.up_to(numbers.unit()),
                (6, 3) => ray.beyond(-numbers.unit()),
                (7, _) => ray.beyond(0.3 * numbers.unit()),
                _ => ray,
            });
        }
    }
    rays
}

#[test]
fn shapes_of_every_kind_with_and_without_meshes() {
    let (points, triangles) = bumpy_sphere(6, 4);
    let bumpy = mesh(&points, triangles);
    let mut hits = 0;
    for (round, place) in PLACES.into_iter().enumerate() {
        let (scale, offset) = place;
        let kinds = [(1, false), (3, true), (11, false), (30, true), (80, true)];
        for (kind, (count, has_meshes)) in kinds.into_iter().enumerate() {
            // Two of them at each place.
            if (kind + round) % kinds.len() > 1 && !is_full() {
                continue;
            }
            let mut numbers = Numbers::new((100 * round + count) as u64);
            let bumpy = has_meshes.then_some(&bumpy);
            let scene = Scene::new(objects(count, place, bumpy, &mut numbers)).unwrap();
            let places: Vec<DVec3> =
                (0..40).map(|_| placed(&[1.5 * numbers.point()], scale, offset)[0]).collect();
            let middle = placed(&[DVec3::ZERO], scale, offset)[0];
            for (k, camera) in cameras(middle, scale, &mut numbers).iter().enumerate() {
                if k % PLACES.len() == round || (count == 11 && is_full()) {
                    hits += checked(&scene, camera);
                }
                if (k + 1) % PLACES.len() == round {
                    // As an array.
                    let array: Vec<Ray> =
                        (0..Rays::len(camera)).map(|k| Rays::ray(camera, k)).collect();
                    hits += checked(&scene, &array);
                }
            }
            hits += checked(&scene, &beams(&places, scale, cases(60), &mut numbers));
            hits += checked(&scene, &rays(&places, scale, cases(300), &mut numbers));
            hits += checked(&scene, &short_rays(&places, scale, cases(300), &mut numbers));
        }
    }
    assert!(hits > cases(30_000), "{hits}");
}

/// Objects that are moved, hidden and shown stay where they are for beams too.
#[test]
fn moved_shapes_are_met_where_they_are() {
    let mut numbers = Numbers::new(7);
    let mut scene = Scene::new(objects(20, (1.0, 0.0), None, &mut numbers)).unwrap();
    let places: Vec<DVec3> = (0..40).map(|_| 1.5 * numbers.point()).collect();
    for round in 0..12 {
        // This builds the tree anew, and a move after it does not.
        let hidden = (numbers.below(20), round % 2 == 0);
        scene.hide_objects(&[hidden]).unwrap();
        let moved = DAffine3::from_translation(numbers.point());
        let moved = (numbers.below(20), Transform::new(moved).unwrap());
        scene.move_objects(&[moved]).unwrap();
        checked(&scene, &beams(&places, 1.0, 40, &mut numbers));
        checked(&scene, &cameras(DVec3::ZERO, 1.0, &mut numbers)[round % 8]);
    }
}

/// A ray alone is asked for the box of a cone first, and neighbours together: what they meet does
/// not depend on that.
#[test]
fn flat_cones_are_met_alike_side_by_side_and_alone() {
    let mut numbers = Numbers::new(51);
    for height in [1e-1, 1e-3, 1e-6, 1e-8, 1e-12, 1e-20, 1e-100] {
        for top in [0.0, 0.3, 2.0] {
            let axis = numbers.point().normalize();
            let cone = Cone::new(DVec3::ZERO, height * axis, 1.0, top).unwrap();
            let transform = DAffine3::from_scale(DVec3::new(1.0, 0.5, 3.0));
            let placed = Object::new(cone).placed(Transform::new(transform).unwrap());
            for object in [Object::new(cone), placed] {
                let scene = Scene::new(vec![object]).unwrap();
                let from = 3.0 * axis + numbers.point();
                let rays: Vec<Ray> =
                    (0..2000).map(|_| Ray::new(from, 1.5 * numbers.point() - from)).collect();
                assert!(checked(&scene, &rays) > 100);
            }
        }
    }
}

/// Rays that leave surfaces side by side, nearly in one direction. In some beams all rays see less,
/// in others one does.
fn leaving(scene: &Scene, starts: &[Ray], numbers: &mut Numbers) -> (Vec<Ray>, Vec<RayFilter>) {
    let hits = trace(scene, starts, First, &()).unwrap();
    let (mut rays, mut filters) = (Vec::new(), Vec::new());
    let mut way = DVec3::X;
    for (k, start) in starts.iter().enumerate() {
        if k % 16 == 0 {
            way = numbers.point();
        }
        let hit = hits.get(k);
        let direction = way + [0.0, 1e-3][k / 16 % 2] * numbers.point();
        let surface = scene.interaction(start, &hit);
        let (ray, mut filter) = match surface {
            Some(surface) => surface.leave(direction),
            None => (Ray::new(start.origin, direction), RayFilter::NONE),
        };
        let is_special = k / 16 % 3 == 0 || k % 16 == 5;
        match (is_special, k / 16 % 7) {
            (true, 0) => filter.mask = 0b01,
            (true, 1) => filter.cull = Some(Side::Front),
            (true, 2) => filter.only = Some(hit.object + 1),
            (true, 3) => {
                filter.departure = None;
                filter.skip[0] = Some(SurfaceId { object: hit.object, primitive: hit.primitive });
            }
            (true, 4) => filter.mask = 0,
            _ => {}
        }
        let end = [f64::INFINITY, 0.5 + numbers.unit()][k / 16 % 2];
        rays.push(match (k % 16, k / 16 % 5) {
            // Of an extreme length.
            (7, 0) => Ray::new(ray.origin, 1e120 * direction),
            (9, 1) => ray.beyond(-0.5),
            (3, 2) => Ray::new(DVec3::splat(1e160), direction),
            _ => ray.up_to(end),
        });
        filters.push(filter);
    }
    (rays, filters)
}

/// Checks the first hit and any hit of filtered rays, on every instruction set; how many hit.
fn checked_filtered(scene: &Scene, rays: &[Ray], filters: &[RayFilter]) -> usize {
    let rays = Filtered::each(rays, filters);
    let expected = trace_with(&BruteForce, scene, &rays, First, &()).unwrap();
    for set in InstructionSet::available() {
        let engine = Cpu::with(set);
        let hits = trace_with(&engine, scene, &rays, First, &()).unwrap();
        let any = trace_with(&engine, scene, &rays, Any, &()).unwrap();
        for (k, &any) in any.iter().enumerate() {
            let (hit, expected) = (hits.get(k), expected.get(k));
            let what = || format!("{set:?} {k} {:?}: {hit:?}", rays.ray(k));
            assert_eq!(bits(&hit), bits(&expected), "{} {expected:?}", what());
            assert_eq!(any, !expected.is_miss(), "any: {}", what());
        }
    }
    expected.count_hit()
}

#[test]
fn rays_that_leave_shapes_side_by_side() {
    let mut met = 0;
    for (round, place) in PLACES.into_iter().enumerate() {
        let (scale, offset) = place;
        for count in [4, 12, 40] {
            let mut numbers = Numbers::new((900 + 100 * round + count) as u64);
            let mut objects = objects(count, place, None, &mut numbers);
            for object in objects.iter_mut().step_by(3) {
                *object = object.clone().masked(0b10);
            }
            let scene = Scene::new(objects).unwrap();
            let places: Vec<DVec3> =
                (0..40).map(|_| placed(&[1.5 * numbers.point()], scale, offset)[0]).collect();
            let starts = beams(&places, scale, 200, &mut numbers);
            let (rays, filters) = leaving(&scene, &starts, &mut numbers);
            met += checked_filtered(&scene, &rays, &filters);
        }
    }
    assert!(met > 10_000, "{met}");
}

/// Where surfaces lie in one place, rounding may say which is first: it says the same side by side.
#[test]
fn shapes_that_touch_are_met_in_the_same_order_side_by_side() {
    let (low, high) = (DVec3::new(-1.0, -1.0, 1.0), DVec3::new(1.0, 1.0, 2.0));
    let level = |z: f64| {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corners = corners.map(|(x, y)| DVec3::new(x, y, z));
        Object::new(mesh(&corners, vec![[0, 1, 2], [0, 2, 3]]))
    };
    let disc = |z| Object::new(Disc::new(z * DVec3::Z, DVec3::Z, 0.7).unwrap());
    let objects = [
        disc(1.0),
        Object::new(Cylinder::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap()),
        Object::new(Cuboid::new(low, high).unwrap()),
        Object::new(Sphere::new(3.0 * DVec3::Z, 1.0).unwrap()),
        level(2.0),
        level(0.0),
        disc(0.0),
        Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()),
    ];
    let mut numbers = Numbers::new(41);
    let turn = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(0.3);
    let mut met = 0;
    for (round, place) in [DMat3::IDENTITY, turn].into_iter().enumerate() {
        let place = DAffine3::from_mat3(place);
        let placed = |object: &Object| object.clone().placed(Transform::new(place).unwrap());
        let scene = Scene::new(objects.iter().map(placed).collect()).unwrap();
        let middle = place.transform_point3(DVec3::Z);
        for (k, camera) in cameras(middle, 1.0, &mut numbers).iter().enumerate() {
            if k % 4 == round {
                met += checked(&scene, camera);
                let longer = |k| Rays::ray(camera, k);
                let longer = (0..Rays::len(camera)).map(longer);
                let longer: Vec<Ray> =
                    longer.map(|ray| Ray::new(ray.origin, 1e120 * ray.direction)).collect();
                met += checked(&scene, &longer);
            }
        }
        let inside =
            |_| place.transform_point3(numbers.point() * DVec3::new(0.9, 0.9, 0.0) + DVec3::Z);
        let places: Vec<DVec3> = (0..40).map(inside).collect();
        let starts = beams(&places, 1.0, 200, &mut numbers);
        met += checked(&scene, &starts);
        let (rays, filters) = leaving(&scene, &starts, &mut numbers);
        met += checked_filtered(&scene, &rays, &filters);
    }
    assert!(met > 10_000, "{met}");
}
