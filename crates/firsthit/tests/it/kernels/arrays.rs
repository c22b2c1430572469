//! Rays in arrays: they go tile by tile where a camera's grid fits them (`shoot/tiles/fit.rs`).

use firsthit::{Camera, DAffine3, DVec3, Object, Ray, Scene, Sphere, Transform};

use super::checked;
use super::pixels::cameras;
use crate::support::generators::{PLACES, placed, soup};
use crate::support::{Numbers, cases, mesh, rounds};

/// A camera's rays in an array, as others make them: rounded, of any length, of a part of the
/// picture, bent, and with rays among them that belong to no pixel.
fn pixels(camera: &Camera, kind: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let columns = if kind == 3 { 16..camera.columns() } else { 0..camera.columns() };
    let mut rays = Vec::new();
    for row in 0..camera.rows() {
        for column in columns.clone() {
            let mut ray = camera.ray(row, column);
            match kind {
                1 => {
                    ray.origin = ray.origin.as_vec3().as_dvec3();
                    ray.direction = ray.direction.as_vec3().as_dvec3();
                }
                2 => ray.direction *= 0.1 + 3.0 * numbers.unit(),
                4 => ray.direction += 1e-3 * ray.direction.x * ray.direction.y * DVec3::Y,
                5 => ray.direction += 1e-9 * numbers.point(),
                _ => {}
            }
            rays.push(ray);
        }
    }
    if kind == 0 {
        // Only a part, which begins and ends within a row.
        rays.truncate(rays.len() - camera.columns() / 3);
        rays.drain(..camera.columns() / 2);
    }
    if kind == 6 {
        let count = rays.len();
        rays[count / 2].direction = DVec3::NAN;
        rays[count / 3].t_max = 1.0;
        rays[count / 5].direction *= 1e-200;
        rays[count / 7] = Ray::new(DVec3::ONE, DVec3::X);
    }
    if kind == 7 {
        // As good as zero, but for one that begins behind everything.
        for ray in &mut rays {
            ray.t_min = -1.0;
        }
        let one = 2 * rays.len() / 3 + 5;
        rays[one].t_min = 1e300;
    }
    rays
}

#[test]
fn arrays_of_a_cameras_rays() {
    let mut hits = 0;
    for round in rounds(16) {
        let mut numbers = Numbers::new(900 + round);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let (points, triangles) = soup(30, &mut numbers);
        let points = placed(&points, scale, offset);
        let mut objects = vec![Object::new(mesh(&points, triangles))];
        if round % 4 == 3 {
            let turn = DAffine3::from_rotation_y(0.7);
            let turned = objects[0].clone().placed(Transform::new(turn).unwrap());
            objects.push(turned);
            objects.push(Object::new(Sphere::new(DVec3::ZERO, 0.1 * scale).unwrap()));
        }
        let scene = Scene::new(objects).unwrap();
        let middle = placed(&[DVec3::ZERO], scale, offset)[0];
        for (k, camera) in cameras(middle, scale, &mut numbers).iter().enumerate() {
            let rays = pixels(camera, (k + round as usize) % 8, &mut numbers);
            hits += checked(&scene, &rays);
        }
    }
    assert!(hits > cases(20_000), "{hits}");
}

/// Parallel rays that all but run along the grid they start on, and not quite on it.
#[test]
fn arrays_of_grazing_parallel_rays() {
    let mut triangles = Vec::new();
    let mut points = Vec::new();
    for i in 0..60 {
        for j in 0..12 {
            let corner = DVec3::new(180.0 + 2.0 * f64::from(i), 6.0 * f64::from(j), -10.0);
            let first = u32::try_from(points.len()).unwrap();
            points.extend([corner, corner + 2.0 * DVec3::X, corner + 6.0 * DVec3::Y]);
            points.push(corner + DVec3::new(2.0, 6.0, 0.0));
            triangles.extend([[0, 1, 2], [1, 3, 2]].map(|t| t.map(|k| first + k)));
        }
    }
    let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
    let mut hits = 0;
    for (jitter, slope) in [(0.0, 0.05), (0.004, 0.05), (0.0001, 0.3), (0.004, 1.0)] {
        let mut rays = Vec::new();
        for k in 0..64 * 64 {
            let (i, j) = (f64::from(k % 64), f64::from(k / 64));
            let z = if k % 2 == 0 { jitter } else { -jitter };
            rays.push(Ray::new(DVec3::new(i, j, z), DVec3::new(1.0, 0.0, -slope)));
        }
        hits += checked(&scene, &rays);
    }
    assert!(hits > 3_000, "{hits}");
}

/// Rays that go a long way, a little aslant their grid: where an object is seen is not where it
/// would be straight ahead.
#[test]
fn arrays_a_little_aslant() {
    let points = [[-1.0, 70.0, 0.0], [12.0, -5.0, 0.0], [12.0, 70.0, 0.0]].map(DVec3::from);
    let scene = Scene::new(vec![Object::new(mesh(&points, vec![[0, 1, 2]]))]).unwrap();
    let ray = |k: usize| {
        let start = DVec3::new((k % 64) as f64, (k / 64) as f64, 1e8);
        Ray::new(start, DVec3::new(-5e-7, 0.0, -1.0))
    };
    let all: Vec<Ray> = (0..64 * 64).map(ray).collect();
    assert!(checked(&scene, &all) > 100);
}
