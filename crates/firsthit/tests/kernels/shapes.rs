//! Shapes that are no meshes, alone and among meshes: pictures ask those that a tile may see, other rays those that a beam of them may
//! meet, and where there are many a tree.

use std::sync::Arc;

use firsthit::{
    Cone, Cuboid, Cylinder, DAffine3, DMat3, DVec3, Disc, Mesh, Object, Plane, Ray, Rays, Scene,
    Shape, Sphere, Transform,
};

use super::checked;
use super::generators::{PLACES, placed, rays, short_rays};
use super::pixels::cameras;
use super::support::{Numbers, bumpy_sphere, mesh};

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
            Cone::new(centre, centre + axis, radius, top)
                .unwrap()
                .into()
        }
        6 if k % 14 == 6 => Plane::new(centre, axis).unwrap().into(),
        _ => Disc::new(centre, axis, radius).unwrap().into(),
    }
}

/// So many shapes around a place, some of them turned and stretched, one hidden, two in the place of others; a few meshes among them
/// if there is one.
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

/// Rays sixteen by sixteen that nearly agree, from a place that they share or from places side by side, some of them with ends.
fn beams(places: &[DVec3], scale: f64, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
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
        for (count, has_meshes) in [(1, false), (3, true), (11, false), (30, true), (80, true)] {
            let mut numbers = Numbers::new((100 * round + count) as u64);
            let bumpy = has_meshes.then_some(&bumpy);
            let scene = Scene::new(objects(count, place, bumpy, &mut numbers)).unwrap();
            let places: Vec<DVec3> = (0..40)
                .map(|_| placed(&[1.5 * numbers.point()], scale, offset)[0])
                .collect();
            let middle = placed(&[DVec3::ZERO], scale, offset)[0];
            for (k, camera) in cameras(middle, scale, &mut numbers).iter().enumerate() {
                if k % PLACES.len() == round || count == 11 {
                    hits += checked(&scene, camera);
                }
                if (k + 1) % PLACES.len() == round {
                    // As an array.
                    let array: Vec<Ray> = (0..Rays::len(camera))
                        .map(|k| Rays::ray(camera, k))
                        .collect();
                    hits += checked(&scene, &array);
                }
            }
            hits += checked(&scene, &beams(&places, scale, 60, &mut numbers));
            hits += checked(&scene, &rays(&places, scale, 300, &mut numbers));
            hits += checked(&scene, &short_rays(&places, scale, 300, &mut numbers));
        }
    }
    assert!(hits > 30_000, "{hits}");
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
