//! Cameras whose rays go through no flat grid: each tile has a grid of its own, and knows how far
//! each ray is off it.

use firsthit::{Camera, DVec3, Lens, Object, Projection, Scene, View};

use super::checked;
use super::pixels::grid;
use crate::support::generators::{PLACES, placed, soup};
use crate::support::{Numbers, cases, mesh, rounds};

/// Cameras near a place, with lenses of every curvature: fine pictures, whose rays are off by a
/// hundredth of a pixel, and coarse ones, in which some tiles are just near enough to a grid and
/// others are not.
fn cameras(middle: DVec3, size: f64, numbers: &mut Numbers) -> Vec<Camera> {
    let matrix = |pixels: f64| [("fx", pixels), ("fy", pixels), ("cx", 24.0), ("cy", 17.0)];
    let calibrated = |projection, pixels: f64, own: &[(&'static str, f64)]| {
        Lens::named(projection, &[&matrix(pixels)[..], own].concat()).unwrap()
    };
    let opencv = [("k1", -0.3), ("k2", 0.05), ("p1", 0.01), ("s1", -0.01)];
    let double_sphere = [("xi", -0.2), ("alpha", 0.6)];
    let prism = [("k1", 0.05), ("p1", 0.01), ("sx1", -0.01)];
    let lenses = [
        calibrated(Projection::OpenCv, 40.0, &opencv),
        calibrated(Projection::OpenCv, 90.0, &opencv),
        calibrated(Projection::DoubleSphere, 20.0, &double_sphere),
        calibrated(Projection::OpenCvFisheye, 12.0, &[("k1", 0.05)]),
        calibrated(Projection::Fov, 40.0, &[("omega", 1.1)]),
        calibrated(Projection::ThinPrismFisheye, 14.0, &prism),
        Lens::with_fov(Projection::Equidistant, 150.0, 34, 48).unwrap(),
        Lens::with_fov(Projection::Equidistant, 60.0, 34, 48).unwrap(),
        Lens::with_fov(Projection::Equisolid, 320.0, 34, 48).unwrap(),
        Lens::named(Projection::Equirectangular, &[]).unwrap(),
        Lens::named(Projection::Equirectangular, &[("horizontal_fov", 100.0)]).unwrap(),
        Lens::named(Projection::Cylindrical, &[("horizontal_fov", 90.0)]).unwrap(),
        Lens::named(Projection::Octahedral, &[]).unwrap(),
    ];
    let view = |(k, lens): (usize, Lens)| {
        let position = middle + size * [2.0, 0.3, 6.0, 0.9][k % 4] * numbers.point();
        let view = View {
            position,
            aim: middle + 0.3 * size * numbers.point() - position,
            up: numbers.point(),
            rows: 34,
            columns: 48,
            lens,
        };
        Camera::new(view).unwrap()
    };
    lenses.into_iter().enumerate().map(view).collect()
}

#[test]
fn curved_rays_on_soups() {
    let mut hits = 0;
    for round in rounds(8) {
        let mut numbers = Numbers::new(7000 + round);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let middle = placed(&[DVec3::ZERO], scale, offset)[0];
        let (points, triangles) = soup([12, 80][round as usize % 2], &mut numbers);
        let points = placed(&points, scale, offset);
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        for camera in cameras(middle, scale, &mut numbers) {
            hits += checked(&scene, &camera);
        }
    }
    assert!(hits > cases(20_000), "{hits}");
}

/// Triangles of a fraction of a pixel up to some pixels, which share their edges.
#[test]
fn curved_rays_on_sheets_of_small_triangles() {
    let mut hits = 0;
    // Of each size at least one.
    for round in 0..cases(6).max(3) {
        let side = [40, 12, 5][round as usize % 3];
        let mut numbers = Numbers::new(7100 + round);
        let points: Vec<DVec3> = (0..side * side)
            .map(|k| {
                let [x, y] = [k % side, k / side].map(|n| f64::from(n) / f64::from(side - 1) - 0.5);
                DVec3::new(x, y, 0.02 * numbers.unit())
            })
            .collect();
        let scene = Scene::new(vec![Object::new(mesh(&points, grid(side)))]).unwrap();
        for camera in cameras(DVec3::ZERO, 1.0, &mut numbers) {
            hits += checked(&scene, &camera);
        }
    }
    assert!(hits > cases(5_000), "{hits}");
}

/// More objects than are asked for without looking where they are, one behind the other and side by
/// side.
#[test]
fn curved_rays_on_many_objects() {
    let mut hits = 0;
    for round in rounds(8) {
        let mut numbers = Numbers::new(7200 + round);
        let objects = (0..9).map(|_| {
            let (points, triangles) = soup(8, &mut numbers);
            let (scale, place) = (0.1 + 0.4 * numbers.unit(), 1.5 * numbers.point());
            let points: Vec<DVec3> = points.iter().map(|&point| place + scale * point).collect();
            Object::new(mesh(&points, triangles))
        });
        let scene = Scene::new(objects.collect()).unwrap();
        for camera in cameras(DVec3::ZERO, 1.5, &mut numbers) {
            hits += checked(&scene, &camera);
        }
    }
    assert!(hits > cases(4_000), "{hits}");
}

/// An object just before a wall: coarse fisheyes have tiles whose rays reach past the corners of
/// their grids, and so may the first depth at which the object is met.
#[test]
fn curved_rays_on_what_is_just_before_a_wall() {
    let mut hits = 0;
    for round in rounds(12) {
        let mut numbers = Numbers::new(7300 + round);
        let normal = numbers.point().normalize();
        let across = normal.any_orthonormal_vector();
        let square = |distance: f64, half: f64, aside: DVec3| {
            let upwards = normal.cross(across);
            let corner =
                |x: f64, y: f64| distance * normal + aside + half * (x * across + y * upwards);
            let points =
                [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            Object::new(mesh(&points, vec![[0, 1, 2], [0, 2, 3]]))
        };
        let objects = (0..6).map(|k| {
            let aside = across * (f64::from(k) - 2.5) * 0.5;
            square(1.0 - 0.004 * f64::from(k + 1), 0.2, aside)
        });
        let scene = Scene::new(objects.chain([square(1.0, 9.0, DVec3::ZERO)]).collect()).unwrap();
        for degrees in [150.0, 200.0, 205.0, 320.0] {
            let view = View {
                aim: normal + 0.2 * numbers.point(),
                up: numbers.point(),
                rows: 48,
                columns: 48,
                lens: Lens::with_fov(Projection::Equidistant, degrees, 48, 48).unwrap(),
                ..View::default()
            };
            hits += checked(&scene, &Camera::new(view).unwrap());
        }
    }
    assert!(hits > cases(20_000), "{hits}");
}
