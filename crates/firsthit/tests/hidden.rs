//! Hidden objects: for every query the scene is as if they were not there.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "a test may panic, and its numbers are small"
)]

#[allow(dead_code, reason = "some of it is for other tests")]
mod support;

use std::sync::Arc;

use firsthit::measure::{By, Rule, inside, path_lengths, rules};
use firsthit::nearest::{Method, Wanted, closest_points, closest_points_with, signed_distances};
use firsthit::section::{SectionPlane, section};
use firsthit::shoot::{All, Count, First, trace};
use firsthit::{Cone, Cuboid, DAffine3, DVec3, Disc, Object, Plane, Ray, Scene, Sphere, Transform};
use support::{Numbers, bumpy_sphere, mesh};

/// Objects side by side, every kind that hiding could miss.
fn objects() -> Vec<Object> {
    let bumpy = |seed| {
        let (points, triangles) = bumpy_sphere(4, seed);
        mesh(&points, triangles)
    };
    let (points, mut open) = bumpy_sphere(3, 9);
    open.truncate(open.len() - 7);
    let shared = bumpy(1);
    let at = |object: Object, x: f64| {
        let place = DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
        object.placed(Transform::new(place).unwrap())
    };
    let squeezed = DAffine3::from_scale(DVec3::new(1.0, 2.0, 0.5));
    let cone = Cone::new(DVec3::ZERO, DVec3::Z, 0.5, 0.0).unwrap();
    vec![
        Object::new(Arc::clone(&shared)),
        // In the place of the first: a duplicate, until that is hidden.
        Object::new(shared),
        at(Object::new(Sphere::new(DVec3::ZERO, 1.2).unwrap()), 1.0),
        at(Object::new(bumpy(2)), 3.0),
        at(Object::new(mesh(&points, open)), 5.0),
        Object::new(Plane::new(DVec3::new(0.0, 0.0, -0.3), DVec3::Z).unwrap()),
        Object::new(Disc::new(DVec3::new(4.0, 0.0, 0.2), DVec3::Y, 2.0).unwrap()),
        Object::new(Cuboid::new(DVec3::new(2.0, -1.0, -1.0), DVec3::new(2.5, 1.0, 1.0)).unwrap()),
        // No distance to it can be measured.
        Object::new(cone).placed(Transform::new(squeezed).unwrap()),
    ]
}

#[test]
fn hidden_objects_are_as_if_they_were_not_there() {
    let all = objects();
    let mut numbers = Numbers::new(7);
    let points: Vec<[f64; 3]> = (0..400)
        .map(|_| {
            let p = 3.0 * numbers.point();
            (p + DVec3::new(2.5, 0.0, 0.0)).to_array()
        })
        .collect();
    let rays: Vec<Ray> = points
        .iter()
        .map(|&origin| Ray::new(DVec3::from(origin), numbers.point()))
        .collect();
    let mut is_met = 0;
    for round in 0..24_u32 {
        // The cone is always hidden, by its mask or by name.
        let is_hidden: Vec<bool> = (0..all.len())
            .map(|k| k == 8 || numbers.below(3) == 0 || round == k as u32)
            .collect();
        let by_mask = |object: &Object| object.clone().masked(0);
        let hide = |object: &Object| object.clone().hidden(true);
        let marked =
            all.iter()
                .zip(&is_hidden)
                .map(|(object, &is_hidden)| match (is_hidden, round % 2) {
                    (false, _) => object.clone(),
                    (true, 0) => by_mask(object),
                    (true, _) => hide(object),
                });
        let built = Scene::new(marked.collect()).unwrap();
        let mut later = Scene::new(all.clone()).unwrap();
        let changes: Vec<(usize, bool)> = is_hidden.iter().copied().enumerate().collect();
        later.hide_objects(&changes).unwrap();
        // Identifiers of the scene that has only the others.
        let kept: Vec<usize> = (0..all.len()).filter(|&k| !is_hidden[k]).collect();
        let number = |object: i32| usize::try_from(object).map_or(-1, |k| kept[k] as i32);
        let fewer = Scene::new(kept.iter().map(|&k| all[k].clone()).collect()).unwrap();
        let asked: Vec<DVec3> = points.iter().copied().map(DVec3::from).collect();
        for scene in [&built, &later] {
            let (hits, expected) = (
                trace(scene, &rays, First, &()),
                trace(&fewer, &rays, First, &()),
            );
            let (hits, expected) = (hits.unwrap(), expected.unwrap());
            assert_eq!(hits.t, expected.t);
            assert!(
                hits.object
                    .iter()
                    .copied()
                    .eq(expected.object.iter().map(|&k| number(k)))
            );
            is_met += hits.object.iter().filter(|&&object| object >= 0).count();
            assert_eq!(
                trace(scene, &rays, Count, &()).unwrap(),
                trace(&fewer, &rays, Count, &()).unwrap()
            );
            let every = trace(scene, &rays, All { nearest: None }, &()).unwrap();
            let of_fewer = trace(&fewer, &rays, All { nearest: None }, &()).unwrap();
            assert_eq!(every.hits.t, of_fewer.hits.t);

            let wanted = Wanted {
                count: 3,
                ..Wanted::default()
            };
            let nearest = closest_points(scene, &points, wanted, &()).unwrap();
            let judged = closest_points_with(Method::BruteForce, scene, &points, wanted, &());
            let expected = closest_points(&fewer, &points, wanted, &()).unwrap();
            for found in [nearest, judged.unwrap()] {
                assert_eq!(found.distance, expected.distance);
                assert!(
                    found
                        .object
                        .iter()
                        .copied()
                        .eq(expected.object.iter().map(|&k| number(k)))
                );
            }
            let signed = signed_distances(scene, &points, &());
            match signed_distances(&fewer, &points, &()) {
                Ok(expected) => assert_eq!(signed.unwrap(), expected),
                Err(_) => assert!(signed.is_err()),
            }

            assert_eq!(
                inside(scene, &asked, By::Union, &()).unwrap().is_inside,
                inside(&fewer, &asked, By::Union, &()).unwrap().is_inside
            );
            let known = rules(scene).unwrap();
            assert!(
                is_hidden
                    .iter()
                    .zip(&known)
                    .all(|(&hidden, &rule)| !hidden || rule == Rule::Nothing)
            );
            let lengths = path_lengths(scene, &rays, By::Union, &()).unwrap();
            let expected = path_lengths(&fewer, &rays, By::Union, &()).unwrap();
            let bits =
                |lengths: Vec<f64>| lengths.into_iter().map(f64::to_bits).collect::<Vec<_>>();
            assert_eq!(bits(lengths), bits(expected));

            let plane = SectionPlane::new(DVec3::ZERO, DVec3::new(0.1, 0.2, 1.0)).unwrap();
            let cut = section(scene, plane, &()).unwrap();
            let expected = section(&fewer, plane, &()).unwrap();
            assert_eq!(cut.area().to_bits(), expected.area().to_bits());
            assert_eq!(cut.perimeter().to_bits(), expected.perimeter().to_bits());
            assert_eq!(scene.bounds(), fewer.bounds());
        }
    }
    assert!(is_met > 2000, "{is_met}");
}
