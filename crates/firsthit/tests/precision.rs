//! What float64 must not lose: far away, nearly flat, very thin, very long and very short things.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use firsthit::shoot::{BruteForce, Trees, first_hit};
use firsthit::{Cuboid, DAffine3, DMat3, DVec3, Disc, Hit, Object, Ray, Scene, Transform, shoot};
use support::Numbers;

fn scene(objects: Vec<Object>) -> Scene {
    Scene::new(objects).unwrap()
}

fn agree(scene: &Scene, ray: &Ray) -> Hit {
    let judge = first_hit::<BruteForce>(scene, ray);
    let fast = first_hit::<Trees>(scene, ray);
    assert_eq!(
        (fast.t, fast.object, fast.primitive),
        (judge.t, judge.object, judge.primitive),
        "{ray:?}"
    );
    judge
}

fn turn(numbers: &mut Numbers) -> DMat3 {
    let axis = numbers.point().normalize();
    DMat3::from_axis_angle(axis, 6.0 * numbers.unit())
}

/// The start is exactly representable in both places, so only the way into object space can differ.
#[test]
fn an_object_far_from_the_origin_is_hit_as_it_is_near_it() {
    let mut numbers = Numbers::new(1);
    let mut hits = 0;
    for _ in 0..300 {
        let matrix = turn(&mut numbers);
        let far = (numbers.point() * 1e9).round();
        let at = |place| {
            let placed = DAffine3::from_mat3_translation(matrix, place);
            let cuboid = Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap();
            scene(vec![
                Object::new(cuboid).placed(Transform::new(placed).unwrap()),
            ])
        };
        let start = (numbers.point() * 1024.0).round() / 256.0;
        let direction = 0.5 * numbers.point() - start;
        let (near, away) = (
            shoot(&at(DVec3::ZERO), start, direction),
            shoot(&at(far), far + start, direction),
        );
        assert_eq!(
            (near.t, near.primitive),
            (away.t, away.primitive),
            "{far} {start} {direction}"
        );
        hits += u32::from(!near.is_miss());
    }
    assert!(hits > 150, "{hits}");
}

#[test]
fn the_box_of_a_disc_that_is_hardly_tilted_holds_all_of_it() {
    for tilt in [1e-6, 1e-8, 1e-9, 1e-10, 1e-100] {
        let disc = Disc::new(DVec3::ZERO, DVec3::new(tilt, 0.0, 1.0), 1.0).unwrap();
        let scene = scene(vec![Object::new(disc)]);
        for height in [-0.9, -0.5, 0.1, 0.7] {
            let ray = Ray::new(DVec3::new(-5.0, 0.0, tilt * height), DVec3::X);
            let t = agree(&scene, &ray).t;
            assert!((t - (5.0 - height)).abs() < 1e-12, "{tilt} {height} {t}");
        }
    }
}
