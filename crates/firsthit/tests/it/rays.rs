//! Where rays begin, how far away they may, and what is out of range.

use firsthit::shoot::{Viewpoint, visible};
use firsthit::{
    Cone, Cuboid, Cylinder, DAffine3, DMat3, DVec3, Disc, Object, Plane, Ray, Scene, Shape, Sphere,
    Transform,
};

use crate::support::{Numbers, agree, bumpy_sphere, mesh, scene};

fn shapes(size: f64) -> Vec<Shape> {
    let (points, triangles) = bumpy_sphere(6, 3);
    let points: Vec<_> = points.into_iter().map(|point| size * point).collect();
    let lean = DVec3::new(0.3, 1.0, -0.2);
    vec![
        mesh(&points, triangles).into(),
        Sphere::new(size * DVec3::splat(0.1), size).unwrap().into(),
        Plane::new(size * DVec3::new(0.0, 1.0, 0.0), lean).unwrap().into(),
        Disc::new(size * DVec3::X, lean, size).unwrap().into(),
        Cuboid::new(DVec3::splat(-size), DVec3::splat(size)).unwrap().into(),
        Cylinder::new(size * DVec3::NEG_Y, size * lean, 0.5 * size).unwrap().into(),
        Cone::new(size * DVec3::NEG_Y, size * lean, 0.5 * size, 0.2 * size).unwrap().into(),
    ]
}

fn of(shape: Shape) -> Scene {
    scene(vec![Object::new(shape)])
}

#[test]
fn a_negative_t_min_lets_a_ray_see_where_it_starts() {
    let square = mesh(&[DVec3::ZERO, 4.0 * DVec3::X, 4.0 * DVec3::Y], vec![[0, 1, 2]]);
    let floor = Plane::new(DVec3::ZERO, DVec3::Z).unwrap();
    for scene in [of(square.into()), of(floor.into())] {
        let ray = Ray::new(DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.1, 0.2, 1.0));
        assert!(agree(&scene, &ray).is_miss());
        assert!(agree(&scene, &ray.beyond(-0.0)).is_miss());
        for t_min in [-1e-300, -1.0, -1e100, f64::NEG_INFINITY] {
            assert_eq!(agree(&scene, &ray.beyond(t_min)).t, 0.0, "{t_min}");
        }
        let above = Ray::new(ray.at(2.0), ray.direction);
        assert!(agree(&scene, &above.beyond(-1.9)).is_miss());
        assert_eq!(agree(&scene, &above.beyond(-2.1)).t, -2.0);
        assert_eq!(agree(&scene, &ray.beyond(-1.0).up_to(0.0)).t, 0.0);
        assert_eq!(agree(&scene, &above.beyond(-2.1).up_to(-2.0)).t, -2.0);
        assert!(agree(&scene, &above.beyond(-2.1).up_to(-2.01)).is_miss());
        assert!(agree(&scene, &ray.up_to(0.0)).is_miss());
    }
}

/// Where a ray begins is rounded as much as the far origin is: here to behind what is met just
/// after.
#[test]
fn rounding_does_not_lose_what_is_just_after_a_negative_t_min() {
    let (origin, speed, t_min) =
        (81_481_446.216_688_41, 1.489_806_302_766_356_6, -54_692_644.315_834_26);
    let level = DVec3::new(-1.0, -1.0, f64::from(-1.500_011_6e-8_f32));
    let scene =
        of(mesh(&[level, level + 4.0 * DVec3::X, level + 4.0 * DVec3::Y], vec![[0, 1, 2]]).into());
    let ray = Ray::new(DVec3::new(0.0, 0.0, origin), DVec3::new(0.0, 0.0, speed));
    assert!(!agree(&scene, &ray.beyond(t_min)).is_miss());
    let mut numbers = Numbers::new(12);
    for _ in 0..2000 {
        let speed = numbers.point() + 3.0 * DVec3::Z;
        let ray = Ray::new(speed * 1e6 * numbers.unit() + 1e-8 * numbers.point(), speed);
        let through = agree(&scene, &ray.beyond(f64::NEG_INFINITY)).t;
        for t_min in [through.next_down(), through - 1e-9, through] {
            let _ = agree(&scene, &ray.beyond(t_min));
        }
    }
}

#[test]
fn what_is_behind_is_met_in_the_order_of_t() {
    let mut numbers = Numbers::new(11);
    let mut behind = 0;
    let all: Vec<_> = shapes(1.0).into_iter().map(Object::new).collect();
    for objects in (0..all.len()).map(|k| vec![all[k].clone()]).chain([all.clone()]) {
        let scene = scene(objects);
        for k in 0..300 {
            let ray = Ray::new(2.0 * numbers.point(), numbers.point());
            let t_min = [-0.5, -3.0, -1e3, -1e30, f64::NEG_INFINITY][k % 5];
            let t_max = [f64::INFINITY, 0.0, -0.3][k % 3];
            let hit = agree(&scene, &ray.beyond(t_min).up_to(t_max));
            assert!(hit.is_miss() || (hit.t > t_min && hit.t <= t_max));
            behind += u32::from(hit.t < 0.0);
        }
    }
    assert!(behind > 400, "{behind}");
}

#[test]
fn numbers_whose_squares_are_out_of_range_are_met_by_nothing() {
    let mut numbers = Numbers::new(12);
    for size in [1e149, 2e150, 1e160, 1e300] {
        for shape in shapes(size) {
            let name = shape.name();
            let (scene, near) = (of(shape), size < 1e150);
            for _ in 0..50 {
                let start = 0.5e149 * numbers.point();
                let hit = agree(&scene, &Ray::new(start, numbers.point()));
                assert!(near || hit.is_miss(), "{name} {size}: {hit:?}");
                let start = size * numbers.point();
                let hit = agree(&scene, &Ray::new(start, numbers.point()));
                assert!(near || hit.is_miss(), "{name} {size}: {hit:?}");
            }
        }
    }
    let scene = of(Plane::new(DVec3::ZERO, DVec3::Z).unwrap().into());
    for (height, is_met) in [(0.9e150, true), (1.1e150, false), (1e200, false)] {
        let hit = agree(&scene, &Ray::new(height * DVec3::Z, DVec3::NEG_Z));
        assert_eq!(!hit.is_miss(), is_met, "{height}");
    }
}

#[test]
fn bounds_are_the_smallest_box() {
    let mut numbers = Numbers::new(13);
    for shape in shapes(1.0) {
        if matches!(shape, Shape::Plane(_)) {
            continue;
        }
        for _ in 0..20 {
            let turn = DMat3::from_axis_angle(numbers.point().normalize(), 6.0 * numbers.unit());
            let matrix = turn * DMat3::from_diagonal(DVec3::new(1.0, 0.3, 2.0));
            let placed = Transform::new(DAffine3::from_mat3_translation(matrix, numbers.point()));
            let object = Object::new(shape.clone()).placed(placed.unwrap());
            let bounds = scene(vec![object.clone()]).bounds();
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let (low, high) = (bounds.low.dot(axis), bounds.high.dot(axis));
                let off = (high - object.support(axis)).abs() + (low + object.support(-axis)).abs();
                assert!(off < 1e-13, "{}: {off}", shape.name());
            }
        }
    }
    let lean = Transform::new(DAffine3::from_rotation_z(0.7)).unwrap();
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()).placed(lean);
    assert!((scene(vec![ball]).bounds().high - DVec3::ONE).length() < 1e-15);
}

/// From 10^9 times a shape's size away `t` cannot say where on it a hit is; the position is on the
/// surface all the same.
#[test]
fn positions_are_on_the_surface_however_far_away_the_origin_is() {
    let mut numbers = Numbers::new(14);
    for (kind, shape) in shapes(1.0).into_iter().enumerate() {
        let mut hits = 0;
        for k in 0..600 {
            let far = [1.0, 1e3, 1e6, 1e9][k % 4];
            let scene = of(shape.clone());
            let way = far * numbers.point().normalize();
            let ray = Ray::new(0.5 * numbers.point() - way, way);
            let hit = agree(&scene, &ray);
            if hit.is_miss() {
                continue;
            }
            hits += 1;
            let point = scene.interaction(&ray, &hit).unwrap().position();
            let along = (point - ray.at(hit.t)).length();
            assert!(along < 1e-14 * (1.0 + far), "{} {along}", shape.name());
            let (normal, lean) =
                (scene.interaction(&ray, &hit).unwrap().normal(), DVec3::new(0.3, 1.0, -0.2));
            let off = match &shape {
                Shape::Mesh(mesh) => {
                    let [a, _, _] = mesh.corners(usize::try_from(hit.primitive).unwrap());
                    (point - a).dot(normal)
                }
                Shape::Sphere(ball) => (point - ball.center()).length() - ball.radius(),
                Shape::Plane(plane) => (point - plane.point()).dot(lean.normalize()),
                Shape::Disc(disc) => (point - disc.center()).dot(lean.normalize()),
                Shape::Box(_) => point.abs().max_element() - 1.0,
                Shape::Cylinder(_) | Shape::Cone(_) if hit.primitive > 0 => {
                    let lid = [DVec3::NEG_Y, lean][usize::from(hit.primitive == 2)];
                    (point - lid).dot((lean + DVec3::Y).normalize())
                }
                _ => {
                    let axis = (lean + DVec3::Y).normalize();
                    let z = (point + DVec3::Y).dot(axis);
                    let share = z / (lean + DVec3::Y).length();
                    let top = if kind == 6 { 0.2 } else { 0.5 };
                    let radius = 0.5 + share * (top - 0.5);
                    (point + DVec3::Y - z * axis).length() - radius
                }
            };
            // An infinite plane is met far away, where coordinates are large.
            let size = point.abs().max_element().max(1.0);
            assert!(off.abs() < 2e-15 * size, "{} {far} {off}", shape.name());
        }
        assert!(hits > 100, "{} {hits}", shape.name());
    }
}

#[test]
fn what_is_beyond_reach_sees_nothing_from_either_side() {
    let scene = Scene::new(Vec::new()).unwrap();
    for far in [1e200, -1e200, f64::INFINITY, f64::NAN] {
        let [origin, far] = [0.0, far].map(|x| Viewpoint::new(DVec3::new(x, 0.0, 0.0)));
        let pairs = [[origin, far], [far, origin]];
        assert_eq!(visible(&scene, &pairs, 0.0, &()).unwrap(), [false; 2]);
    }
}

#[test]
fn points_a_float32_step_inside_a_wall_see_each_other_with_a_tolerance() {
    let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    let scene = Scene::new(vec![Object::new(ball)]).unwrap();
    let [inside, far] = [1.0 - 1e-7, 3.0].map(|x| Viewpoint::new(DVec3::new(x, 0.0, 0.0)));
    let seen = |pair, tolerance| visible(&scene, &[pair], tolerance, &()).unwrap();
    for pair in [[inside, far], [far, inside]] {
        assert_eq!(seen(pair, 0.0), [false]);
        assert_eq!(seen(pair, 0.5e-7), [false]);
        assert_eq!(seen(pair, 2e-7), [true]);
        assert_eq!(seen(pair, 1e9), [true]);
    }
    let [behind, before] = [-3.0, 3.0].map(|x| Viewpoint::new(DVec3::new(x, 0.0, 0.0)));
    assert_eq!(seen([behind, before], 1.9), [false]);
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        let error = visible(&scene, &[], tolerance, &()).unwrap_err().to_string();
        assert!(error.starts_with("tolerance must be 0 or more"), "{error}");
    }
}
