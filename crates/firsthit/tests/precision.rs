//! What float64 must not lose: far away, nearly flat, very thin, very long and very short things.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use firsthit::{Cuboid, DAffine3, DMat3, DVec3, Object, Scene, Transform, shoot};
use support::Numbers;

fn scene(objects: Vec<Object>) -> Scene {
    Scene::new(objects).unwrap()
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
