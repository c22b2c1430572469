//! `t` and the order of hits against exact arithmetic.

use std::sync::Arc;

use firsthit::shoot::{All, Count, Cpu, Engine, First, trace};
use firsthit::{
    Camera, DAffine3, DMat3, DVec3, Hit, Lens, Mesh, Object, Ray, Scene, Shape, Transform,
    Viewplane,
};
use num_rational::BigRational;

use crate::support::rational::{cross, dot, exact, minus, nearest, number};
use crate::support::{Numbers, agree, bits, bumpy_sphere, cases, mesh, rounds, scene};

/// Where a ray crosses a triangle, edges and corners included.
fn crossing(ray: &Ray, corners: [DVec3; 3]) -> Option<BigRational> {
    let zero = number(0.0);
    let (origin, d) = (exact(ray.origin), exact(ray.direction));
    let [a, b, c] = corners.map(|corner| minus(&exact(corner), &origin));
    let n = cross(&minus(&b, &a), &minus(&c, &a));
    let slope = dot(&n, &d);
    if slope == zero {
        return None;
    }
    let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&d, &cross(p, q)) / &slope);
    if sides.iter().any(|side| *side < zero) {
        return None;
    }
    let t = dot(&n, &a) / slope;
    (t > zero).then_some(t)
}

/// Compares the hit with exact arithmetic over all triangles.
pub(crate) fn check(scene: &Scene, ray: &Ray, hit: &Hit) {
    let mut all = Vec::new();
    for (index, object) in (0..).zip(scene.objects()) {
        let Shape::Mesh(mesh) = object.shape() else { unreachable!("only meshes here") };
        for (triangle, _) in (0..).zip(mesh.triangles()) {
            let t = crossing(ray, mesh.corners(triangle as usize));
            all.extend(t.map(|t| (nearest(&t), index, triangle)));
        }
    }
    let first = |a: &(f64, i32, i32), b: &(f64, i32, i32)| a.partial_cmp(b).unwrap();
    let Some((t, object, triangle)) = all.into_iter().min_by(first) else {
        assert!(hit.is_miss(), "{ray:?} {hit:?}");
        return;
    };
    assert_eq!((hit.object, hit.primitive), (object, triangle), "{ray:?} {hit:?} {t:?}");
    let is_next = hit.t == t || hit.t == t.next_up() || hit.t == t.next_down();
    assert!(is_next, "{ray:?} {hit:?}, exactly {t:?}");
}

fn turn(numbers: &mut Numbers) -> DMat3 {
    DMat3::from_axis_angle(numbers.point().normalize(), 6.0 * numbers.unit())
}

/// A triangle around the origin whose corners are about `far` away.
fn around(numbers: &mut Numbers, frame: DMat3, far: f64) -> [DVec3; 3] {
    let from = 6.0 * numbers.unit();
    [0.0, 2.1, 4.2].map(|angle| {
        let (sin, cos) = (libm::sin(from + angle), libm::cos(from + angle));
        far * (0.5 + numbers.unit()) * (cos * frame.x_axis + sin * frame.y_axis)
    })
}

fn triangle(corners: [DVec3; 3]) -> Arc<Mesh> {
    mesh(&corners, vec![[0, 1, 2]])
}

/// Floors at any tilt, seen from a few lengths away, whose corners are up to 10^12 lengths away.
#[test]
fn t_is_next_to_the_exact_one_however_far_the_corners_are() {
    let mut numbers = Numbers::new(19);
    let mut hits = 0;
    for far in [1.0, 1e1, 1e3, 1e5, 1e8, 1e12] {
        for _ in 0..cases(150) {
            let frame = turn(&mut numbers);
            let corners = around(&mut numbers, frame, far);
            let scene = scene(vec![Object::new(triangle(corners))]);
            for slant in [1.0, 1e-1, 1e-2, 1e-4, 1e-6] {
                let target = frame * (numbers.point() * DVec3::new(0.2, 0.2, 0.0));
                let way = frame * (numbers.point() * DVec3::new(1.0, 1.0, slant));
                let ray = Ray::new(target - 3.0 * way, way);
                let hit = agree(&scene, &ray);
                check(&scene, &ray, &hit);
                hits += u32::from(!hit.is_miss());
            }
        }
    }
    assert!(hits > cases(2000), "{hits}");
}

/// The exact `t` is next to halfway between two float64.
#[test]
fn a_hit_has_one_t_whatever_else_is_in_the_scene_and_whatever_is_asked() {
    let corners = [
        DVec3::new(0.525_731_112_119_133_6, -0.850_650_808_352_04, 0.0),
        DVec3::new(0.0, -0.525_731_112_119_133_6, -0.850_650_808_352_04),
        DVec3::new(0.850_650_808_352_04, 0.0, -0.525_731_112_119_133_6),
    ];
    let [a, b, c] = corners;
    let alone = triangle(corners);
    let more = mesh(&[a, b, c, DVec3::splat(5.0)], vec![[0, 1, 2], [1, 2, 3]]);
    let ray = Ray::new(DVec3::new(-2.5, -0.5, -0.5), DVec3::X);
    let t = agree(&scene(vec![Object::new(alone.clone())]), &ray).t;
    for meshes in [vec![&alone], vec![&more], vec![&alone, &more], vec![&more, &alone]] {
        let count = meshes.len();
        let objects = meshes.into_iter().map(|mesh| Object::new(mesh.clone()));
        let scene = scene(objects.collect());
        assert_eq!(agree(&scene, &ray).t, t);
        let all = trace(&scene, &[ray], All::default(), &()).unwrap();
        assert_eq!(all.hits.t, vec![t; count]);
        assert_eq!(all.hits.object, (0..count as i32).collect::<Vec<_>>());
        let up_to = [t, t.next_down()].map(|t_max| ray.up_to(t_max));
        let counts = trace(&scene, &up_to, Count, &()).unwrap();
        assert_eq!(counts, [count as u32, 0]);
    }
}

/// The floor is the second of two objects, the first of which is in front or behind by a billionth.
#[test]
fn of_two_floors_close_together_the_first_is_met() {
    let mut numbers = Numbers::new(20);
    let mut hits = 0;
    for far in [1.0, 1e3, 1e6, 1e9, 1e12] {
        for _ in 0..cases(150) {
            let frame = turn(&mut numbers);
            let shift = 1e-9 * frame.z_axis;
            let near = around(&mut numbers, frame, 3.0).map(|corner| corner + shift);
            let corners = around(&mut numbers, frame, far);
            let scene = scene(vec![Object::new(triangle(near)), Object::new(triangle(corners))]);
            for slant in [1.0, 1e-1, 1e-2] {
                let target = frame * (numbers.point() * DVec3::new(0.2, 0.2, 0.0));
                let way = frame * (numbers.point() * DVec3::new(1.0, 1.0, slant));
                let ray = Ray::new(target - 3.0 * way, way);
                let hit = agree(&scene, &ray);
                check(&scene, &ray, &hit);
                hits += u32::from(!hit.is_miss());
            }
        }
    }
    assert!(hits > cases(1500), "{hits}");
}

/// Two meshes in one plane, cut differently: the exact places are the same, so the first object is
/// met.
#[test]
fn of_two_triangles_in_one_plane_the_first_object_is_met() {
    let mut numbers = Numbers::new(21);
    let mut hits = 0;
    for _ in 0..cases(400) {
        // Corners with few digits, so that both planes are exactly one.
        let mut few = || (numbers.point() * 64.0).round();
        let (e, f) = (few(), few());
        let at = |x: f64, y: f64| x * e + y * f;
        let one = triangle([at(-3.0, -3.0), at(5.0, -2.0), at(-1.0, 6.0)]);
        let other = triangle([at(-2.0, -4.0), at(4.0, -1.0), at(-2.0, 5.0)]);
        let objects = [one, other].map(Object::new).to_vec();
        let mut reversed = objects.clone();
        reversed.reverse();
        let scenes = [scene(objects), scene(reversed)];
        for _ in 0..20 {
            let target = at(numbers.unit(), numbers.unit());
            let origin = 300.0 * numbers.point();
            let ray = Ray::new(origin, target - origin);
            for scene in &scenes {
                let hit = agree(scene, &ray);
                check(scene, &ray, &hit);
                hits += u32::from(!hit.is_miss());
            }
        }
    }
    assert!(hits > cases(8000), "{hits}");
}

/// Rays along z through the corner that the triangles of a fan share: the exact `t` is a
/// difference, which often lies halfway between two float64. It is the same for all triangles, so
/// the lowest wins.
#[test]
fn triangles_with_one_exact_t_are_a_tie_wherever_it_lies() {
    let mut numbers = Numbers::new(23);
    let (mut hits, mut halfway) = (0, 0);
    for _ in 0..cases(300) {
        let corners: Vec<DVec3> = (0..12).map(|_| numbers.point() / 0.7).collect();
        let around = (1..11).map(|k| [0, k, k + 1]).rev().collect();
        let scene = scene(vec![Object::new(mesh(&corners, around))]);
        for _ in 0..10 {
            let t = (1.0 + numbers.unit()) / 0.7;
            let origin = corners[0] - DVec3::Z * t;
            let ray = Ray::new(origin, DVec3::Z);
            let hit = agree(&scene, &ray);
            check(&scene, &ray, &hit);
            hits += u32::from(!hit.is_miss());
            let exact = number(corners[0].z) - number(origin.z);
            let near = nearest(&exact);
            let [below, above] = [near.next_down(), near.next_up()].map(number);
            let two = number(2.0);
            let is_halfway =
                [below, above].iter().any(|other| number(near) + other == &two * &exact);
            halfway += u32::from(is_halfway);
        }
    }
    assert!(hits > cases(1500) && halfway > cases(150), "{hits} {halfway}");
}

/// Pictures too: each pixel's `t`, of triangles large and small, near and far.
#[test]
fn pictures_have_exact_distances() {
    let mut numbers = Numbers::new(22);
    let mut hits = 0;
    for size in [1e-3, 0.1, 1.0, 30.0, 1e4, 1e9] {
        for parallel in [false, true] {
            let points: Vec<_> =
                (0..12).map(|_| size * numbers.point() + DVec3::Z * 1e-3).collect();
            let triangles = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
            let scene = scene(vec![Object::new(mesh(&points, triangles))]);
            let eye = (2.0 + 0.3 * size.min(10.0)) * numbers.point().normalize();
            let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, 50.0, 24, 32).unwrap();
            let mut view = *camera.view();
            if parallel {
                view.lens = Lens::Flat(Viewplane {
                    width: 4.0,
                    height: 3.0,
                    parallel,
                    ..*view.lens.viewplane().unwrap()
                });
            }
            let camera = Camera::new(view).unwrap();
            let all = trace(&scene, &camera, First, &()).unwrap();
            for index in rounds(24 * 32) {
                let ray = camera.ray(index / 32, index % 32);
                let hit = all.get(index);
                assert_eq!(bits(&hit), bits(&Cpu::default().first_hit(&scene, &ray)));
                check(&scene, &ray, &hit);
                hits += u32::from(!hit.is_miss());
            }
        }
    }
    assert!(hits > cases(1000), "{hits}");
}

/// Two to the power of `exponent`.
fn power(exponent: i64) -> f64 {
    f64::from_bits(u64::try_from(1023 + exponent).unwrap() << 52)
}

/// Rays at corners and edges, from where it is exactly so and from where it is by rounding only;
/// the vertices of a closed mesh and its silhouette are part of it.
#[test]
fn edges_and_corners_are_decided_exactly() {
    let mut numbers = Numbers::new(23);
    let (points, triangles) = bumpy_sphere(3, 5);
    let few = |v: DVec3, digits: f64| (v * digits).round() / digits;
    let (mut hits, mut misses) = (0, 0);
    for (digits, scale) in
        [(1.0, 1.0), (4.0, 1.0), (4.0, power(-490)), (4.0, power(470)), (1e3, 1.0), (1e15, 1.0)]
    {
        let points: Vec<_> = points.iter().map(|&point| few(3.0 * point, digits)).collect();
        let scaled: Vec<_> = points.iter().map(|&point| scale * point).collect();
        let scene = scene(vec![Object::new(mesh(&scaled, triangles.clone()))]);
        for k in 0..cases(600) {
            let [a, b] = [0, 1].map(|_| points[numbers.below(points.len())]);
            let through = if k % 2 == 0 { a } else { few(0.5 * (a + b), 2.0 * digits) };
            let way = match k % 3 {
                0 => few(5.0 * numbers.point(), digits),
                1 => [DVec3::X, DVec3::NEG_Y, DVec3::Z][k / 3 % 3] * 5.0,
                _ => (through - points[numbers.below(points.len())]) * 4.0,
            };
            let ray = Ray::new(scale * (through - way), way);
            if way == DVec3::ZERO {
                continue;
            }
            let hit = agree(&scene, &ray);
            check(&scene, &ray, &hit);
            hits += u32::from(!hit.is_miss());
            misses += u32::from(hit.is_miss());
        }
    }
    assert!(hits > cases(1500) && misses > cases(10), "{hits} {misses}");
}

/// An edge where the products of a side round to the same number, at sizes where what is left of
/// them is tiny.
#[test]
fn edges_of_tiny_triangles_are_met() {
    let corners = [[1.25, 0.125, 0.0], [0.125, 1.0, 0.125], [0.0625, 0.125, 1.0]];
    let origin = DVec3::new(0.0625, 1.5, 14.3125);
    let direction = DVec3::new(0.625, -0.9375, -14.25);
    for exponent in [0, -440, -460, -490] {
        let scale = power(exponent);
        let corners = corners.map(|corner| scale * DVec3::from(corner));
        let scene = scene(vec![Object::new(triangle(corners))]);
        let ray = Ray::new(scale * origin, direction);
        let hit = agree(&scene, &ray);
        assert!(!hit.is_miss(), "{exponent}");
        check(&scene, &ray, &hit);
    }
}

/// However thin a triangle is, the point of its weights is where the ray meets it.
#[test]
fn positions_in_slivers_are_where_the_ray_is() {
    let mut numbers = Numbers::new(25);
    let mut hits = 0;
    for k in 0..4000_i64 {
        let [a, b, across] = [0, 1, 2].map(|_| numbers.point());
        let thickness = power(-3 * (k % 18));
        let c = a.lerp(b, 1.2 * numbers.unit()) + thickness * across;
        let corners = [[a, b, c], [b, c, a], [c, a, b]][usize::try_from(k % 3).unwrap()];
        let scene = scene(vec![Object::new(triangle(corners))]);
        let [v, w] = [numbers.unit(), numbers.unit()];
        let [v, w] = if v + w > 1.0 { [1.0 - v, 1.0 - w] } else { [v, w] };
        let [a, b, c] = corners;
        let target = a + v * (b - a) + w * (c - a);
        let direction = numbers.point();
        let ray = Ray::new(target - direction, direction);
        let hit = agree(&scene, &ray);
        if hit.is_miss() {
            continue;
        }
        hits += 1;
        // At a grazing angle what `t` is rounded to counts along the triangle.
        let off = scene.interaction(&ray, &hit).unwrap().position().distance(ray.at(hit.t));
        let normal = (b - a).cross(c - a);
        let sine = direction.dot(normal).abs() / (direction.length() * normal.length());
        assert!(off * sine < 3e-15, "{corners:?} {ray:?} {off:e}");
        let [v, w] = hit.barycentric.to_array();
        assert!(v >= 0.0 && w >= 0.0 && v + w <= 1.0 + 1e-15, "{v} {w}");
    }
    assert!(hits > 2000, "{hits}");
    // At a corner, of a triangle that float64 has no area for.
    let thin = [[0.0, -1e-20, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 0.0]].map(DVec3::from);
    let scene = scene(vec![Object::new(triangle(thin))]);
    let ray = Ray::new(DVec3::new(1.0, 1.0, 5.0), DVec3::NEG_Z);
    let hit = agree(&scene, &ray);
    assert_eq!(scene.interaction(&ray, &hit).unwrap().position(), thin[1]);
}

/// A closed mesh in two objects: no ray from inside passes between them, whatever the transform
/// that they have in common.
#[test]
fn a_seam_between_objects_under_one_transform_is_tight() {
    let mut numbers = Numbers::new(24);
    let (points, triangles) = bumpy_sphere(6, 9);
    for k in 0..12 {
        let half = triangles.len() / 2;
        let placed = match k {
            0 => DAffine3::IDENTITY,
            1..6 => DAffine3::from_translation(1e3 * numbers.point()),
            _ => {
                let shear = DMat3::from_cols(DVec3::X, numbers.point(), DVec3::Z);
                DAffine3::from_mat3_translation(turn(&mut numbers) * shear, numbers.point())
            }
        };
        let Ok(transform) = Transform::new(placed) else {
            continue;
        };
        let part = |triangles: &[[u32; 3]]| {
            Object::new(mesh(&points, triangles.to_vec())).placed(transform)
        };
        let scene = scene(vec![part(&triangles[..half]), part(&triangles[half..])]);
        let inside = placed.transform_point3(0.1 * numbers.point());
        for _ in 0..400 {
            let [a, b] = [0, 1].map(|_| points[numbers.below(points.len())]);
            let target = placed.transform_point3(a.lerp(b, numbers.unit()));
            let corner = placed.transform_point3(a);
            for aim in [target, corner] {
                if aim != inside {
                    let hit = agree(&scene, &Ray::new(inside, aim - inside));
                    assert!(!hit.is_miss(), "{placed:?} {aim}");
                }
            }
        }
    }
}
