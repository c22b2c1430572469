//! Neighbouring rays that go through the tree over many objects together.

use firsthit::scene::AlphaMode;
use firsthit::{
    DAffine3, DQuat, DVec3, Material, Object, Plane, Ray, Rays, Scene, Sphere, Transform,
};

use super::{checked, pixels, shapes};
use crate::support::generators::{PLACES, placed};
use crate::support::{Numbers, bumpy_sphere, cases, mesh, rounds};

/// Most are turned instances of one mesh; others are asked for holes, are spheres, or reach
/// everywhere.
#[test]
fn neighbours_among_objects_of_every_kind() {
    let mut hits = 0;
    for round in rounds(3) {
        let mut numbers = Numbers::new(900 + round);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        // The smaller one has leaves below its root alone.
        let (points, triangles) = bumpy_sphere([6, 12][round as usize % 2], round);
        let shared = mesh(&points, triangles);
        let alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        let cut_out = Material { alpha_mode, ..Material::default() };
        let places: Vec<DVec3> = (0..100).map(|_| 2.0 * numbers.point()).collect();
        let places = placed(&places, scale, offset);
        let mut objects = Vec::new();
        for (k, &place) in places.iter().enumerate() {
            let size = scale * (0.4 + 0.2 * numbers.point());
            let turn = DQuat::from_scaled_axis(3.0 * numbers.point());
            let affine = DAffine3::from_scale_rotation_translation(size, turn, place);
            let instance = Object::new(shared.clone()).placed(Transform::new(affine).unwrap());
            objects.push(match k % 16 {
                3 if round % 2 == 0 => Object::new(Sphere::new(place, 0.4 * scale).unwrap()),
                5 => instance.with_materials([cut_out.clone()]),
                9 => Object::new(shared.clone()).placed(Transform::translation(place).unwrap()),
                _ => instance,
            });
        }
        if round % 4 == 0 {
            let below = placed(&[-2.0 * DVec3::Z], scale, offset)[0];
            objects.push(Object::new(Plane::new(below, DVec3::Z).unwrap()));
        }
        let scene = Scene::new(objects).unwrap();
        let beams = shapes::beams(&places, scale, cases(200), &mut numbers);
        hits += checked(&scene, &beams);
        let middle = placed(&[DVec3::ZERO], scale, offset)[0];
        let cameras = pixels::cameras(middle, 2.0 * scale, &mut numbers);
        for (number, camera) in cameras.iter().enumerate() {
            hits += checked(&scene, camera);
            if number % 4 == 0 {
                let array: Vec<Ray> = (0..camera.len()).map(|k| Rays::ray(camera, k)).collect();
                hits += checked(&scene, &array[7..]);
            }
        }
    }
    assert!(hits > cases(30_000), "{hits}");
}

/// A `t_max` below the smallest normal number counts as it is.
#[test]
fn an_end_below_the_normal_numbers_ends_neighbours_too() {
    let square =
        [DVec3::new(-0.4, -0.4, 0.0), DVec3::new(0.4, -0.4, 0.0), DVec3::new(0.0, 0.4, 0.0)];
    let shared = mesh(&square, vec![[0, 1, 2]]);
    let places = (0..81).map(|k| DVec3::new(f64::from(k % 9 - 4), f64::from(k / 9 - 4), 0.0));
    let objects: Vec<Object> = places
        .map(|place| Object::new(shared.clone()).placed(Transform::translation(place).unwrap()))
        .collect();
    let scene = Scene::new(objects).unwrap();
    let rays: Vec<Ray> = (0..16)
        .map(|k| {
            let origin = DVec3::new(0.01 * f64::from(k % 4), 0.01 * f64::from(k / 4), 1e-211);
            let mut ray = Ray::new(origin, DVec3::new(1e95, 1e95, -1e98));
            ray.t_max = 1e-310;
            ray
        })
        .collect();
    assert_eq!(checked(&scene, &rays), 0);
    let whole: Vec<Ray> = rays.iter().map(|ray| Ray::new(ray.origin, ray.direction)).collect();
    assert!(checked(&scene, &whole) > 0);
}
