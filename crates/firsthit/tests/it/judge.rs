//! The trees against brute force, brute force against exact arithmetic, and closed meshes against
//! leaks.

use std::sync::Arc;

use firsthit::shoot::{Cpu, Engine, First, trace};
use firsthit::{
    Cone, Cuboid, Cylinder, DAffine3, DMat3, DVec3, Disc, Hit, Object, Plane, Ray, Sphere,
    Transform, shoot,
};
use robust::{Coord3D, orient3d};

use crate::support::{
    Numbers, agree, bits, bumpy_sphere, cases, is_full, mesh, on_threads, rays, scene,
};

/// Triangles of all kinds: small, slivers, duplicates, degenerate ones, with shared corners.
fn soup(count: usize, seed: u64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut numbers = Numbers::new(seed);
    let mut points = Vec::new();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for k in 0..count {
        let first = points.len() as u32;
        let centre = numbers.point();
        let size = [0.3, 0.05, 0.01][k % 3];
        points.extend((0..3).map(|_| centre + size * numbers.point()));
        match k % 10 {
            7 => points[first as usize + 2] = points[first as usize] * (1.0 + 1e-12),
            8 if !triangles.is_empty() => triangles.push(triangles[numbers.below(triangles.len())]),
            9 => points[first as usize + 1] = points[first as usize],
            _ => {}
        }
        triangles.push([first, first + 1, first + 2]);
    }
    (points, triangles)
}

#[test]
fn the_tree_gives_the_judges_bits_on_soups_of_every_scale_and_place() {
    for (scale, offset) in
        [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e5), (1.0, -1e7), (1e-3, 1e2)]
    {
        let (points, triangles) = soup(600, 3);
        let place = |p: &DVec3| scale * (*p + DVec3::new(offset, -offset, 0.5 * offset));
        let points: Vec<DVec3> = points.iter().map(place).collect();
        let scene = scene(vec![Object::new(mesh(&points, triangles))]);
        let middle = scene.bounds().centre();
        for ray in rays(&points.iter().map(|p| (*p - middle) / scale).collect::<Vec<_>>(), 3000, 5)
        {
            let direction = if ray.t_max < 1.0 { ray.direction } else { ray.direction * scale };
            agree(&scene, &Ray { origin: ray.origin * scale + middle, direction, ..ray });
        }
    }
}

#[test]
fn the_tree_gives_the_judges_bits_on_all_shapes_with_all_transforms() {
    let mut numbers = Numbers::new(11);
    let (points, triangles) = bumpy_sphere(12, 4);
    let mesh = mesh(&points, triangles);
    let mut objects = vec![Object::new(Plane::new(DVec3::new(0.0, 0.0, -3.0), DVec3::Z).unwrap())];
    for k in 0..60 {
        let matrix = DMat3::from_cols(numbers.point(), numbers.point(), numbers.point());
        let placed = DAffine3::from_mat3_translation(matrix, 4.0 * numbers.point());
        let shape: firsthit::Shape = match k % 6 {
            0 => Sphere::new(DVec3::ZERO, 1.0).unwrap().into(),
            1 => Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap().into(),
            2 => Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap().into(),
            3 => Cylinder::new(DVec3::ZERO, DVec3::Y, 0.5).unwrap().into(),
            4 => Cone::new(DVec3::ZERO, DVec3::Y, 0.8, 0.1).unwrap().into(),
            _ => Arc::clone(&mesh).into(),
        };
        objects.push(Object::new(shape).placed(Transform::new(placed).unwrap()));
    }
    let scene = scene(objects);
    let mut hits = 0;
    for ray in rays(&points, 6000, 8) {
        let ray = Ray { origin: 2.0 * ray.origin, ..ray };
        hits += u32::from(!agree(&scene, &ray).is_miss());
    }
    assert!(hits > 2000, "{hits}");
}

/// Whether the line through `p` and `q` passes through a triangle, in exact arithmetic.
fn exactly_inside(p: DVec3, q: DVec3, corners: [DVec3; 3]) -> bool {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let side = |a: DVec3, b: DVec3| orient3d(coord(p), coord(q), coord(a), coord(b));
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)
}

/// Random rays are never within rounding of an edge, so the exact answer must be the judge's.
#[test]
fn the_judge_agrees_with_exact_arithmetic() {
    let (points, triangles) = soup(400, 21);
    // Duplicates and slivers have no inside to be exact about.
    let proper: Vec<[u32; 3]> = triangles.into_iter().filter(|t| t[0] / 3 % 10 < 7).collect();
    let mesh = mesh(&points, proper.clone());
    let scene = scene(vec![Object::new(Arc::clone(&mesh))]);
    let mut numbers = Numbers::new(22);
    let mut hits = 0;
    for _ in 0..3000 {
        // The second point is exactly the first one plus the direction.
        let p = (2.0 * numbers.point()).as_vec3().as_dvec3();
        let q = (2.0 * numbers.point()).as_vec3().as_dvec3();
        let ray = Ray::new(p, q - p);
        let crossed = (0..proper.len()).filter(|&k| exactly_inside(p, q, mesh.corners(k)));
        let at = |k: usize| {
            let [a, b, c] = mesh.corners(k);
            let normal = (b - a).cross(c - a);
            (a - p).dot(normal) / (q - p).dot(normal)
        };
        let first = crossed
            .map(|k| (at(k), k))
            .filter(|&(t, _)| t > 0.0)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let hit = agree(&scene, &ray);
        match first {
            None => assert!(hit.is_miss(), "{ray:?} {hit:?}"),
            Some((t, k)) => {
                assert_eq!(hit.primitive, k as i32, "{ray:?}");
                assert!((hit.t - t).abs() <= 1e-9 * t, "{} {t}", hit.t);
                hits += 1;
            }
        }
    }
    assert!(hits > 300, "{hits}");
}

/// Rays from inside at every corner and at points of every edge, also far from the origin and at
/// other scales: every one must hit.
#[test]
fn closed_meshes_do_not_leak() {
    let (points, triangles) = bumpy_sphere(if is_full() { 40 } else { 15 }, 9);
    for (scale, offset) in
        [(1.0, 0.0), (1.0, 2e5), (1e-4, 0.0), (1e8, 0.0), (1e-4, 10.0), (3.7, -1e3)]
    {
        // Far away, neighbouring corners fall together: the mesh is another one, and still closed.
        let place = |p: &DVec3| *p * scale + DVec3::splat(offset);
        let placed: Vec<DVec3> = points.iter().map(place).collect();
        let scene = scene(vec![Object::new(mesh(&placed, triangles.clone()))]);
        let mut numbers = Numbers::new(10);
        let inside = DVec3::splat(offset) + scale * 0.05 * numbers.point();
        let mut shot = 0;
        for triangle in &triangles {
            let corners = triangle.map(|k| placed[k as usize]);
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % 3];
                for target in [a, 0.5 * (a + b), a.lerp(b, numbers.unit())] {
                    let direction = target - inside;
                    for direction in [direction, direction / direction.length(), -direction] {
                        assert!(
                            !shoot(&scene, inside, direction).is_miss(),
                            "{scale} {offset} {inside} {direction}"
                        );
                        shot += 1;
                    }
                }
            }
        }
        assert_eq!(shot, 27 * triangles.len());
    }
}

/// Axis-parallel rays through the very coordinates of corners: slopes are exactly zero.
#[test]
fn axis_parallel_rays_through_corners_do_not_leak() {
    let (points, triangles) = bumpy_sphere(24, 2);
    let scene = scene(vec![Object::new(mesh(&points, triangles))]);
    for p in &points {
        for axis in 0..3 {
            // From the plane through the origin: inside, for the mesh is star-shaped with radius
            // 0.7 at least.
            let mut origin = *p;
            origin[axis] = 0.0;
            if origin.length() > 0.3 {
                continue;
            }
            for sign in [-1.0, 1.0] {
                let ray = Ray::new(origin, sign * DVec3::AXES[axis]);
                assert!(!agree(&scene, &ray).is_miss(), "{ray:?}");
            }
        }
    }
}

/// A closed surface cut into objects is as tight as in one piece.
#[test]
fn objects_that_share_edges_do_not_leak_between_them() {
    let (points, triangles) = bumpy_sphere(16, 5);
    let objects =
        triangles.iter().map(|&triangle| Object::new(mesh(&points, vec![triangle]))).collect();
    let scene = scene(objects);
    for p in &points {
        assert!(
            !agree(
                &scene,
                &Ray::new(DVec3::new(0.01, -0.02, 0.03), *p - DVec3::new(0.01, -0.02, 0.03))
            )
            .is_miss()
        );
    }
}

#[test]
fn at_the_same_distance_the_lower_object_and_primitive_win() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
    let twice = mesh(&points, vec![[1, 3, 2], [0, 1, 2], [0, 1, 2]]);
    let scene = scene(vec![
        Object::new(Sphere::new(DVec3::new(0.2, 0.2, -5.0), 1.0).unwrap()),
        Object::new(Arc::clone(&twice)),
        Object::new(twice),
        Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()),
    ]);
    let hit = agree(&scene, &Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z));
    assert_eq!((hit.t, hit.object, hit.primitive), (1.0, 1, 1));
    let beside = agree(&scene, &Ray::new(DVec3::new(5.0, 5.0, 1.0), DVec3::NEG_Z));
    assert_eq!((beside.t, beside.object, beside.primitive), (1.0, 3, 0));
}

#[test]
fn rays_that_make_no_sense_miss_and_leave_their_neighbours_alone() {
    let scene = scene(vec![
        Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
        Object::new(Plane::new(DVec3::new(0.0, 0.0, -2.0), DVec3::Z).unwrap()),
    ]);
    let good = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
    let nan = DVec3::new(0.0, f64::NAN, 0.0);
    let bad = [
        Ray { direction: DVec3::ZERO, ..good },
        Ray { direction: nan, ..good },
        Ray { origin: nan, ..good },
        Ray { origin: DVec3::INFINITY, ..good },
        Ray { direction: DVec3::new(0.0, 0.0, f64::NEG_INFINITY), ..good },
        good.up_to(f64::NAN),
        good.up_to(0.0),
        good.up_to(-1.0),
        good.beyond(f64::NAN),
        good.beyond(f64::INFINITY),
        good.beyond(4.5).up_to(4.5),
    ];
    let rays: Vec<Ray> = bad.iter().flat_map(|&bad| [good, bad]).collect();
    let hits = trace(&scene, &rays, First, &()).unwrap();
    for (k, ray) in rays.iter().enumerate() {
        let hit = hits.get(k);
        if k % 2 == 0 {
            assert_eq!((hit.t, hit.object, hit.primitive), (4.0, 0, 0));
        } else {
            assert_eq!(bits(&hit), bits(&Hit::MISS), "{ray:?}");
            assert!(!Cpu::default().any_hit(&scene, ray), "{ray:?}");
        }
    }
}

#[test]
fn a_hit_needs_t_above_zero_and_up_to_t_max() {
    let scene = scene(vec![Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap())]);
    let from = |z: f64| Ray::new(DVec3::new(0.0, 0.0, z), DVec3::NEG_Z);
    assert!(agree(&scene, &from(0.0)).is_miss());
    assert_eq!(agree(&scene, &from(3.0).up_to(3.0)).t, 3.0);
    assert!(agree(&scene, &from(3.0).up_to(3.0_f64.next_down())).is_miss());
    assert_eq!(agree(&scene, &from(5e-324)).t, 5e-324);
    assert!(agree(&scene, &from(3.0).beyond(3.0)).is_miss());
    assert_eq!(agree(&scene, &from(3.0).beyond(3.0_f64.next_down())).t, 3.0);
    assert_eq!(agree(&scene, &from(3.0).beyond(f64::NEG_INFINITY)).t, 3.0);
    // Where directions are scaled, so are both ends.
    for length in [1e200, 1e-200] {
        let ray = Ray::new(DVec3::new(0.0, 0.0, 3.0), length * DVec3::NEG_Z);
        let t = agree(&scene, &ray).t;
        assert!(agree(&scene, &ray.beyond(t)).is_miss());
        assert_eq!(agree(&scene, &ray.beyond(t.next_down()).up_to(t)).t, t);
    }
}

#[test]
fn instances_are_the_same_as_copies() {
    let (points, triangles) = bumpy_sphere(14, 6);
    let shared = mesh(&points, triangles.clone());
    let mut numbers = Numbers::new(31);
    let mut instances = Vec::new();
    let mut copies = Vec::new();
    for _ in 0..20 {
        // Powers of two, quarter turns, mirrors and short translations: nothing is rounded.
        let scale = [-0.5, 1.0, 2.0, -1.0][numbers.below(4)];
        let turn =
            [DMat3::IDENTITY, DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z)][numbers.below(2)];
        let offset = (numbers.point() * 8.0).round();
        let placed = DAffine3::from_mat3_translation(turn * scale, offset);
        instances.push(Object::new(Arc::clone(&shared)).placed(Transform::new(placed).unwrap()));
        let moved: Vec<DVec3> = points.iter().map(|&p| placed.transform_point3(p)).collect();
        copies.push(Object::new(mesh(&moved, triangles.clone())));
    }
    let (instances, copies) = (scene(instances), scene(copies));
    assert_eq!(instances.triangles(), copies.triangles());
    for ray in rays(&points, cases(4000), 32) {
        let ray = Ray::new(ray.origin * 4.0, ray.direction);
        let (a, b) = (agree(&instances, &ray), agree(&copies, &ray));
        // Through a corner, triangles tie in one space and are an ulp apart in the other.
        assert_eq!(a.object, b.object, "{ray:?}");
        assert!(a.is_miss() || (a.t - b.t).abs() <= 1e-12 * b.t, "{ray:?} {a:?} {b:?}");
    }
}

#[test]
fn a_mirrored_object_keeps_its_outside() {
    let mirror = Transform::new(DAffine3::from_scale(DVec3::new(-1.0, 2.0, 1.0))).unwrap();
    let (points, triangles) = bumpy_sphere(10, 7);
    for shape in [
        firsthit::Shape::from(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
        mesh(&points, triangles).into(),
    ] {
        let scene = scene(vec![Object::new(shape).placed(mirror)]);
        let mut numbers = Numbers::new(40);
        for _ in 0..500 {
            let outside = numbers.point().normalize() * 6.0;
            let ray = Ray::new(outside, -outside);
            let hit = agree(&scene, &ray);
            let normal = scene.interaction(&ray, &hit).unwrap().normal();
            assert!(
                (ray.direction.dot(normal) < 0.0) && (normal.length() - 1.0).abs() < 1e-14,
                "{ray:?} {normal}"
            );
        }
    }
}

#[test]
fn batches_of_every_size_and_any_number_of_threads_give_the_same() {
    let (points, triangles) = soup(300, 50);
    let scene = scene(vec![Object::new(mesh(&points, triangles))]);
    let all = rays(&points, 5000, 51);
    for size in [0, 1, 2, 3, 7, 8, 9, 1023, 1024, 1025, 5000] {
        let results = [1, 2, 7].map(|threads| {
            on_threads(threads, || trace(&scene, &all[..size], First, &()).unwrap())
        });
        for hits in &results {
            assert_eq!(hits.len(), size);
            for (k, ray) in all[..size].iter().enumerate() {
                assert_eq!(bits(&hits.get(k)), bits(&Cpu::default().first_hit(&scene, ray)));
            }
        }
    }
}
