//! Scenes made from others: what is used again gives the same answers.

use firsthit::nearest::{NearestSettings, closest_points};
use firsthit::shoot::{Count, First, trace};
use firsthit::{
    Bounds, Cuboid, DAffine3, DQuat, DVec3, Object, Plane, Ray, Scene, Sphere, Transform,
};

use crate::support::{Numbers, agree, bits, bumpy_sphere, mesh, rays, scene};

#[test]
fn a_scene_with_other_objects_shares_what_did_not_change() {
    let (points, triangles) = bumpy_sphere(20, 8);
    let shared = Object::new(mesh(&points, triangles));
    let one = scene(vec![shared.clone()]);
    let moved = Transform::translation(DVec3::new(3.0, 0.0, 0.0)).unwrap();
    let two = one.with_objects(vec![shared.clone(), shared.clone().placed(moved)]).unwrap();
    assert_eq!(two.triangles(), 2 * one.triangles());
    let hit = agree(&two, &Ray::new(DVec3::new(3.0, 0.1, 9.0), DVec3::NEG_Z));
    assert_eq!(hit.object, 1);
    // The mesh's tree is there once, beside the two small ones over the objects.
    assert!(two.tree_bytes() < one.tree_bytes() + 1000);
}

/// Vertices that move, a little and beyond all recognition, together and apart.
#[test]
fn a_mesh_whose_vertices_moved_is_met_where_it_is_now() {
    let (points, triangles) = bumpy_sphere(24, 12);
    let mut last = scene(vec![Object::new(mesh(&points, triangles.clone()))]);
    let bytes = last.tree_bytes();
    let steps = [(0.0, 0.01), (1e6, 0.02), (0.0, 0.1), (5.0, 3.0), (0.0, 0.0), (1e-3, 1e-9)];
    for (step, (far, wild)) in (0..).zip(steps) {
        let mut numbers = Numbers::new(step);
        let points: Vec<DVec3> =
            points.iter().map(|p| *p + DVec3::splat(far) + wild * numbers.point()).collect();
        let moved = Object::new(mesh(&points, triangles.clone()));
        last = last.with_objects(vec![moved.clone()]).unwrap();
        let anew = scene(vec![moved]);
        // Its own tree in the first three; one built for these points has another size.
        if step < 3 {
            assert_eq!(last.tree_bytes(), bytes, "step {step}");
            assert_ne!(anew.tree_bytes(), bytes, "step {step}");
        }
        for ray in rays(&points, 400, step) {
            assert_eq!(bits(&agree(&last, &ray)), bits(&agree(&anew, &ray)));
        }
    }
    // Triangles that were in one place, and are no more.
    let together =
        [0.0, 0.0].map(|z| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]].map(DVec3::from));
    let apart = [0.0, 1.0].map(|z| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]].map(DVec3::from));
    let object = |points: [[DVec3; 3]; 2]| {
        let triangles = (0..60).map(|k| if k % 2 == 0 { [0, 1, 2] } else { [3, 4, 5] });
        Object::new(mesh(&points.concat(), triangles.collect()))
    };
    let scene = scene(vec![object(together)]).with_objects(vec![object(apart)]).unwrap();
    let hit = agree(&scene, &Ray::new(DVec3::new(0.2, 0.2, 5.0), DVec3::NEG_Z));
    assert_eq!((hit.t, hit.primitive), (4.0, 1));
}

/// Objects of all kinds, moved one after the other: near and far, onto each other, flattened and
/// turned.
#[test]
fn a_moved_object_is_met_as_in_a_scene_built_anew() {
    let (points, triangles) = bumpy_sphere(12, 3);
    let ball = mesh(&points, triangles);
    let mut numbers = Numbers::new(20);
    let mut objects: Vec<Object> = (0..40)
        .map(|k| match k % 8 {
            5 => Object::new(Sphere::new(DVec3::ZERO, 0.7).unwrap()),
            6 => Object::new(Cuboid::new(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap()),
            3 if k == 3 => Object::new(mesh(&points, Vec::new())),
            7 if k == 7 => Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()),
            _ => Object::new(ball.clone()),
        })
        .collect();
    let mut moved = scene(objects.clone());
    let mut places = Vec::new();
    for step in 0..200 {
        let object = numbers.below(objects.len());
        let place = numbers.point() * [3.0, 3.0, 3.0, 1e4][step % 4];
        let turn = DQuat::from_axis_angle(numbers.point().normalize(), 3.0 * numbers.unit());
        let sizes = [DVec3::ONE, DVec3::new(1.0, 0.2, 3.0), DVec3::new(1.0, 1.0, 1e-7)];
        let map = DAffine3::from_scale_rotation_translation(sizes[step % 3], turn, place);
        let transform = match step % 5 {
            // Onto another one, to the last bit, and away again later.
            0 => *objects[numbers.below(objects.len())].transform(),
            _ => Transform::new(map).unwrap(),
        };
        objects[object] = objects[object].clone().placed(transform);
        // One by one, or several at once.
        if step < 100 {
            moved.move_object(object, transform).unwrap();
        } else {
            places.push((object, transform));
        }
        if step % 3 > 0 {
            continue;
        }
        moved.move_objects(&places).unwrap();
        places.clear();
        let rays: Vec<Ray> = (0..200)
            .map(|_| {
                let origin = 6.0 * numbers.point();
                Ray::new(origin, 3.0 * numbers.point() - origin)
            })
            .collect();
        assert_answers_as_anew(&moved, &objects, &rays, step);
    }
    let before = moved.bounds();
    let far = Transform::translation(DVec3::splat(1e6)).unwrap();
    assert!(moved.move_objects(&[(0, far), (40, far)]).is_err());
    assert_eq!(moved.bounds(), before);
}

/// More objects than are listed, so that the tree over them is fitted: each change takes some out of
/// it, puts them back or adds to it.
#[test]
fn objects_that_come_and_go_are_met_as_in_a_scene_built_anew() {
    let (points, triangles) = bumpy_sphere(6, 3);
    let ball = mesh(&points, triangles);
    let mut numbers = Numbers::new(21);
    let mut new = |k: usize| {
        let object = match k % 5 {
            0 => Object::new(Sphere::new(DVec3::ZERO, 0.7).unwrap()),
            1 => Object::new(Cuboid::new(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap()),
            _ => Object::new(ball.clone()),
        };
        let turn = DQuat::from_axis_angle(numbers.point().normalize(), 3.0 * numbers.unit());
        let place = DAffine3::from_rotation_translation(turn, 9.0 * numbers.point());
        object.placed(Transform::new(place).unwrap())
    };
    let mut objects: Vec<Object> = (0..100).map(&mut new).collect();
    objects[7] = Object::new(Plane::new(DVec3::splat(-9.0), DVec3::Z).unwrap());
    objects[8] = objects[9].clone();
    let mut changed = scene(objects.clone());
    for step in 0..240 {
        let one = new(step);
        let k = (step * step * 31 + step) % objects.len();
        // At times all but a few are hidden.
        let hidden: Vec<(usize, bool)> = match step % 60 {
            50 => (3..objects.len()).map(|k| (k, true)).collect(),
            51..58 => vec![(step % 60 - 50, false), (step % 60 - 49, true)],
            58 => (0..objects.len()).map(|k| (k, k % 9 == 0)).collect(),
            _ => vec![(k, step % 3 > 0), (k / 2, false)],
        };
        match step % 4 {
            0 => objects.push(one),
            1 => objects[k] = one,
            2 => objects[k] = objects[k].clone().hidden(true).removed(step % 8 == 2),
            _ => {
                for &(k, is_hidden) in &hidden {
                    objects[k] = objects[k].clone().hidden(is_hidden);
                }
                changed.hide_objects(&hidden).unwrap();
                let to = *one.transform();
                objects[k / 3] = objects[k / 3].clone().placed(to);
                changed.move_object(k / 3, to).unwrap();
            }
        }
        changed = changed.with_objects(objects.clone()).unwrap();
        let rays: Vec<Ray> = rays(&points, 100, step as u64)
            .into_iter()
            .map(|ray| Ray::new(9.0 * ray.origin, ray.direction))
            .collect();
        assert_answers_as_anew(&changed, &objects, &rays, step);
    }
}

/// All corners judge the bounds, and a scene built anew judges rays and nearest points.
fn assert_answers_as_anew(changed: &Scene, objects: &[Object], rays: &[Ray], step: usize) {
    let anew = scene(objects.to_vec());
    let there = objects.iter().filter(|object| !object.is_hidden()).map(Object::bounds);
    let around = there.filter(Bounds::is_finite).fold(Bounds::EMPTY, Bounds::union);
    assert_eq!(changed.bounds(), around, "{step}");
    let [got, expected] = [changed, &anew].map(|scene| trace(scene, rays, First, &()).unwrap());
    for (k, ray) in rays.iter().enumerate() {
        assert_eq!(bits(&got.get(k)), bits(&expected.get(k)), "{step} {ray:?}");
    }
    let [got, expected] = [changed, &anew].map(|scene| trace(scene, rays, Count, &()).unwrap());
    assert_eq!(got, expected, "{step}");
    agree(changed, &rays[0]);
    let from = [rays[1].origin.to_array()];
    let nearest = |scene| closest_points(scene, &from, NearestSettings::default(), &()).unwrap();
    let [got, expected] = [changed, &anew].map(nearest);
    assert_eq!((got.object, got.distance), (expected.object, expected.distance), "{step}");
}

#[test]
#[cfg(feature = "frame")]
fn the_fingerprint_of_a_moved_scene_is_that_of_one_built_anew() {
    let (points, triangles) = bumpy_sphere(20, 8);
    let ball = Object::new(mesh(&points, triangles));
    let up = Transform::translation(DVec3::Z).unwrap();
    let objects = vec![ball.clone(), Object::new(Sphere::new(DVec3::X, 1.0).unwrap())];
    let mut moved = scene(objects.clone());
    let before = moved.fingerprint().to_owned();
    moved.move_object(0, up).unwrap();
    let anew = scene(vec![ball.placed(up), objects[1].clone()]);
    assert_eq!(moved.fingerprint(), anew.fingerprint());
    assert_ne!(moved.fingerprint(), before);
}

/// From no object that is in the way to one, and back: with few objects, which are in no tree, and
/// with more.
#[test]
fn what_moves_into_the_way_of_a_ray_is_met() {
    let ball = |x: f64| Object::new(Sphere::new(DVec3::new(x, 0.0, 0.0), 0.5).unwrap());
    let down = Ray::new(DVec3::new(100.0, 0.1, 9.0), DVec3::NEG_Z);
    let there = Transform::translation(DVec3::new(100.0, 0.0, 0.0)).unwrap();
    for count in 1..=7 {
        let mut scene = scene((0..count).map(|k| ball(2.0 * f64::from(k))).collect());
        assert!(agree(&scene, &down).is_miss(), "{count}");
        scene.move_object(0, there).unwrap();
        assert_eq!(agree(&scene, &down).object, 0, "{count}");
        scene.hide_objects(&[(0, true)]).unwrap();
        assert!(agree(&scene, &down).is_miss(), "{count}");
        scene.hide_objects(&[(0, false)]).unwrap();
        assert_eq!(agree(&scene, &down).object, 0, "{count}");
        scene.move_object(0, Transform::IDENTITY).unwrap();
        assert!(agree(&scene, &down).is_miss(), "{count}");
    }
}
