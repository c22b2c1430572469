//! Precision of float64: far away, nearly flat, very thin, very long and very short things.

use std::sync::Arc;

use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{
    Bounds, Cone, Cuboid, Cylinder, DAffine3, DMat3, DVec3, Disc, Object, Ray, Scene, Shape,
    Sphere, Transform, shoot,
};

use crate::support::{Numbers, agree, bumpy_sphere, cases, mesh, scene};

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
            scene(vec![Object::new(cuboid).placed(Transform::new(placed).unwrap())])
        };
        let start = (numbers.point() * 1024.0).round() / 256.0;
        let direction = 0.5 * numbers.point() - start;
        let (near, away) =
            (shoot(&at(DVec3::ZERO), start, direction), shoot(&at(far), far + start, direction));
        assert_eq!((near.t, near.primitive), (away.t, away.primitive), "{far} {start} {direction}");
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

/// The rays run in the plane of a tilted wall, as closely as float64 can say: which of its
/// triangles are met is up to rounding, but where one is met, the ray is in it.
#[test]
fn a_triangle_seen_edge_on_is_met_where_the_ray_is_in_it() {
    const SIDE: u32 = 12;
    let mut numbers = Numbers::new(5);
    let mut hits = 0;
    for _ in 0..40 {
        let frame = turn(&mut numbers);
        let at = |x: f64, y: f64| frame.x_axis * x + frame.y_axis * y;
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for k in 0..SIDE * SIDE {
            let (row, column) = (k / SIDE, k % SIDE);
            let [x, y] = [column, row].map(|place| f64::from(place) + 0.3 * numbers.unit());
            points.push(at(0.1 * x, 0.1 * y));
            if row + 1 < SIDE && column + 1 < SIDE {
                triangles.extend([[k, k + 1, k + SIDE], [k + 1, k + SIDE + 1, k + SIDE]]);
            }
        }
        let wall = mesh(&points, triangles);
        let scene = scene(vec![Object::new(Arc::clone(&wall))]);
        for _ in 0..cases(1500) {
            let [start, end] =
                [0, 1].map(|_| at(3.0 * numbers.unit() - 1.0, 3.0 * numbers.unit() - 1.0));
            let ray = Ray::new(start, end - start);
            let hit = agree(&scene, &ray);
            let Ok(triangle) = usize::try_from(hit.primitive) else {
                continue;
            };
            let corners = wall.corners(triangle);
            let [b, c] = hit.barycentric.to_array();
            let point = (1.0 - b - c) * corners[0] + b * corners[1] + c * corners[2];
            assert!((point - ray.at(hit.t)).length() < 1e-13, "{ray:?} {hit:?}");
            hits += 1;
        }
    }
    assert!(hits > cases(1000), "{hits}");
}

/// An edge runs within 1e-280 of the ray, so that the product of its corners' coordinates
/// underflows.
#[test]
fn an_edge_that_all_but_touches_the_ray_is_met_at_the_edge() {
    let mut numbers = Numbers::new(1);
    let mut hits = 0;
    for _ in 0..1000 {
        let b = DVec3::new(1e-280 * (1.0 + numbers.unit()), 0.7 * (1.0 + numbers.unit()), 1.0);
        let across = -(0.5 + numbers.unit()) * b;
        let c = DVec3::new(across.x, across.y, 1.0 + numbers.unit());
        let triangle = mesh(&[DVec3::new(-1.0, 0.3, 0.0), b, c], vec![[0, 1, 2]]);
        let scene = scene(vec![Object::new(triangle)]);
        let hit = agree(&scene, &Ray::new(DVec3::new(0.0, 0.0, -3.0), DVec3::Z));
        if !hit.is_miss() {
            assert!(hit.t >= 4.0 - 1e-12 && hit.t <= 5.0, "{b} {c} {hit:?}");
            hits += 1;
        }
    }
    assert!(hits > 100, "{hits}");
}

#[test]
fn triangles_of_any_size_are_met_at_the_same_place() {
    let mut numbers = Numbers::new(1);
    for _ in 0..500 {
        let corners = [
            numbers.point() - DVec3::new(1.5, 1.5, 0.0),
            DVec3::new(2.0, 0.1, numbers.unit()),
            DVec3::new(0.1, 2.0, numbers.unit()),
        ];
        let start = DVec3::new(0.0, 0.0, -3.0);
        let direction = 0.1 * numbers.point() - start;
        let t = |size: f64| {
            let triangle = mesh(&corners.map(|corner| size * corner), vec![[0, 1, 2]]);
            let scene = scene(vec![Object::new(triangle)]);
            agree(&scene, &Ray::new(size * start, size * direction)).t
        };
        let expected = t(1.0);
        for size in [1e-161, 1e-150, 1e-110, 1e-12, 1e12, 1e110, 1e149] {
            let t = t(size);
            assert!(t == expected || (t - expected).abs() < 1e-14, "{size} {t} {expected}");
        }
    }
}

#[test]
fn directions_may_have_any_length() {
    let (points, triangles) = bumpy_sphere(8, 4);
    let shapes: [Shape; 5] = [
        mesh(&points, triangles).into(),
        Sphere::new(DVec3::ZERO, 1.0).unwrap().into(),
        Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap().into(),
        Cylinder::new(DVec3::NEG_Y, DVec3::Y, 0.5).unwrap().into(),
        Cone::new(DVec3::NEG_Y, DVec3::Y, 0.8, 0.1).unwrap().into(),
    ];
    let mut numbers = Numbers::new(5);
    for shape in shapes {
        let scene = scene(vec![Object::new(shape)]);
        for _ in 0..100 {
            let (start, direction) = (0.1 * numbers.point(), numbers.point());
            let expected = shoot(&scene, start, direction);
            for length in [1e-306, 1e-200, 1e-160, 1e160, 1e200, 1e307] {
                let ray = Ray::new(start, length * direction);
                let hit = agree(&scene, &ray);
                assert_eq!(hit.primitive, expected.primitive, "{length} {ray:?}");
                let off = (hit.t * length - expected.t).abs();
                assert!(off < 1e-12 * expected.t, "{length} {ray:?}");
                assert_eq!(agree(&scene, &ray.up_to(hit.t)).t, hit.t);
                assert!(agree(&scene, &ray.up_to(0.999 * hit.t)).is_miss());
            }
        }
    }
}

/// In the space of an object that a transform makes tiny, rays are long and far away.
#[test]
fn rays_past_tiny_objects_miss() {
    let (points, triangles) = bumpy_sphere(8, 4);
    let shapes: [Shape; 6] = [
        mesh(&points, triangles).into(),
        Sphere::new(DVec3::ZERO, 1.0).unwrap().into(),
        Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap().into(),
        Cylinder::new(DVec3::NEG_Y, DVec3::Y, 0.5).unwrap().into(),
        Cone::new(DVec3::NEG_Y, DVec3::Y, 0.5, 0.0).unwrap().into(),
        Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap().into(),
    ];
    let mut numbers = Numbers::new(6);
    for shape in shapes {
        for size in [1e-99, 1e-80, 1e-60, 1e-30] {
            let tiny = Transform::new(DAffine3::from_scale(DVec3::splat(size))).unwrap();
            let scene = scene(vec![Object::new(shape.clone()).placed(tiny)]);
            let straight = Ray::new(DVec3::Z, DVec3::NEG_Z);
            assert!(!agree(&scene, &straight).is_miss(), "{shape:?} {size}");
            for _ in 0..200 {
                let origin = 10.0 * numbers.point();
                let ray = Ray::new(origin, 3.0 * numbers.point() - origin);
                let hit = agree(&scene, &ray);
                assert!(hit.is_miss(), "{shape:?} {size} {ray:?} {}", hit.t);
            }
        }
    }
}

/// The corner of a box that reaches farthest along an axis, and a ray past it by about the rounding
/// of the way into object space: hit or missed, but by both.
#[test]
fn trees_allow_for_the_rounding_of_transforms() {
    let mut numbers = Numbers::new(77);
    for ratio in [1.0, 1e3, 1e6, 1e8, 1e10] {
        for far in [0.0, 1e3] {
            for _ in 0..50 {
                let flat = DMat3::from_diagonal(DVec3::new(1.0, 1.0 / ratio, 1.0));
                let matrix = turn(&mut numbers) * flat * turn(&mut numbers);
                let place = DVec3::splat(far);
                let placed = DAffine3::from_mat3_translation(matrix, matrix * -place);
                let (low, high) = (place - DVec3::ONE, place + DVec3::ONE);
                let cuboid = Cuboid::new(low, high).unwrap();
                let placed = Transform::new(placed).unwrap();
                let scene = scene(vec![Object::new(cuboid).placed(placed)]);
                let corners = Bounds { low, high }
                    .corners()
                    .map(|corner| placed.world_from_object().transform_point3(corner));
                for axis in 0..3 {
                    let highest = |a: &&DVec3, b: &&DVec3| a[axis].total_cmp(&b[axis]);
                    let corner = *corners.iter().max_by(highest).unwrap();
                    for _ in 0..14 {
                        let (mut through, mut direction) = (corner, numbers.point());
                        through[axis] += numbers.unit() * 1e-16 * (1.0 + far) * ratio;
                        direction[axis] = 0.0;
                        for away in [1.0, 1e3, 1e6] {
                            agree(&scene, &Ray::new(through - away * direction, direction));
                        }
                    }
                }
            }
        }
    }
}

/// The box is as far from the origin as it is brought back: its corners are rounded at that
/// distance.
#[test]
fn trees_allow_for_the_rounding_of_what_is_moved_back_to_the_origin() {
    let far = DVec3::splat(1e7);
    let cuboid = Cuboid::new(far - 1e-3, far + 1e-3).unwrap();
    let back = Transform::translation(-far).unwrap();
    let scene = scene(vec![Object::new(cuboid).placed(back)]);
    let mut numbers = Numbers::new(2);
    for _ in 0..1000 {
        let top = scene.bounds().high.z + 2e-9 * numbers.unit();
        agree(&scene, &Ray::new(DVec3::new(-1.0, 0.0, top), DVec3::X));
    }
}

#[test]
fn maps_that_flatten_space_are_refused() {
    let mut numbers = Numbers::new(3);
    for _ in 0..1000 {
        let (a, b) = (numbers.point(), numbers.point());
        let flat = DMat3::from_cols(a, b, numbers.unit() * a - numbers.unit() * b);
        assert!(Transform::new(DAffine3::from_mat3(flat)).is_err(), "{flat}");
    }
    let thin = DVec3::new(1e3, 1e-12, 1.0);
    assert!(Transform::new(DAffine3::from_scale(thin)).is_ok());
}

/// A floor of any size, and a tile on it that is thinner than a hair: which of them is met must not
/// depend on where the floor's corners are.
#[test]
fn the_size_of_a_triangle_does_not_change_which_object_is_met() {
    for size in [1e2, 1e5, 1e7, 1e8, 1e10, 1e12] {
        let flat = |size: f64, z: f64| {
            let corners = [(-size, -size), (size, -size), (0.3 * size, 1.7 * size)];
            mesh(&corners.map(|(x, y)| DVec3::new(x, y, z)), vec![[0, 1, 2]])
        };
        let scene =
            Scene::new(vec![Object::new(flat(size, 0.0)), Object::new(flat(4.0, 1e-9))]).unwrap();
        let mut numbers = Numbers::new(77);
        for _ in 0..2000 {
            let eye = DVec3::new(-2.0, 0.0, 1.0) + 0.1 * numbers.point();
            let target = DVec3::new(numbers.unit(), numbers.unit(), 0.0) - 0.5;
            let ray = Ray::new(eye, DVec3::new(target.x, target.y, 0.0) - eye);
            let hit = Cpu::default().first_hit(&scene, &ray);
            assert_eq!(hit.object, 1, "{size} {ray:?} {hit:?}");
            // The tile's corners are up to 7 lengths away, which its `t` may be off by in the last
            // places.
            let exact = (ray.origin.z - 1e-9) / -ray.direction.z;
            assert!((hit.t - exact).abs() <= 32.0 * f64::EPSILON, "{size} {hit:?} {exact}");
            assert_eq!(hit.t.to_bits(), BruteForce.first_hit(&scene, &ray).t.to_bits());
            // Beside the tile, the floor: to the last place, however far its corners are.
            let beside = Ray::new(eye, DVec3::new(-20.0, target.x, 0.0) - eye);
            let hit = Cpu::default().first_hit(&scene, &beside);
            let exact = beside.origin.z / -beside.direction.z;
            let off = if size < 1e4 { 1e3 } else { 2.0 } * f64::EPSILON;
            assert!(hit.object == 0 && (hit.t - exact).abs() <= off, "{size} {hit:?} {exact}");
        }
    }
}
