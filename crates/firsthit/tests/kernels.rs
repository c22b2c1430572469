//! Every kernel on every instruction set of this machine, against brute force, bit for bit.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "a test may panic, and its numbers are small"
)]

mod support;

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use firsthit::shape::triangle::Shear;
use firsthit::shoot::{BruteForce, Trees, any_hit, first_hit, occluded_all, shoot_all};
use firsthit::{
    Camera, DAffine3, DMat3, DVec3, Hit, Hits, InstructionSet, Object, Plane, Projection, Ray,
    RayStart, Rays, Scene, Sphere, Transform, View,
};
use rayon::ThreadPoolBuilder;
use support::{Numbers, bumpy_sphere, mesh, refdata};

fn sets() -> impl Iterator<Item = InstructionSet> {
    InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
}

fn bits(hit: &Hit) -> (u64, i32, i32, [u64; 2]) {
    (
        hit.t.to_bits(),
        hit.object,
        hit.primitive,
        hit.barycentric.to_array().map(f64::to_bits),
    )
}

/// Shoots `rays` with every instruction set and compares with the judge; returns how many hit.
fn judged<R: Rays + ?Sized>(scene: &Scene, rays: &R) -> usize {
    let judge: Vec<Hit> = (0..rays.len())
        .map(|k| first_hit::<BruteForce>(scene, &rays.ray(k)))
        .collect();
    for set in sets() {
        let scene = scene.clone().with_instruction_set(set);
        let hits = shoot_all(&scene, rays, &()).unwrap();
        let any = occluded_all(&scene, rays, &()).unwrap();
        for (k, judge) in judge.iter().enumerate() {
            let (ray, hit) = (rays.ray(k), hits.get(k));
            let what = || format!("{set:?} {k} {ray:?}: {hit:?}, the judge says {judge:?}");
            assert_eq!(bits(&hit), bits(judge), "{}", what());
            assert_eq!(any[k], !judge.is_miss(), "any hit: {}", what());
            if k % 64 == 0 {
                assert_eq!(any_hit(&scene, &ray), !judge.is_miss(), "{}", what());
                let alone = first_hit::<Trees>(&scene, &ray);
                assert_eq!(bits(&alone), bits(judge), "alone: {}", what());
            }
        }
    }
    judge.iter().filter(|hit| !hit.is_miss()).count()
}

/// Triangles of all kinds: small, slivers, duplicates, degenerate ones, with shared corners and edges.
fn soup(count: usize, numbers: &mut Numbers) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points: Vec<DVec3> = (0..4).map(|_| numbers.point()).collect();
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    for k in 0..count {
        let first = points.len() as u32;
        let centre = numbers.point();
        let size = [1.0, 0.3, 0.05, 1e-3][k % 4];
        points.extend((0..3).map(|_| centre + size * numbers.point()));
        match k % 8 {
            5 => points[first as usize + 2] = points[first as usize] * (1.0 + 1e-12),
            6 => points[first as usize + 1] = points[first as usize],
            7 => triangles.push(triangles[numbers.below(triangles.len())]),
            _ => {}
        }
        let shared = numbers.below(points.len()) as u32;
        triangles.push([first, first + 1, first + 2]);
        triangles.push([first, first + 1, shared]);
    }
    (points, triangles)
}

/// Random rays, at corners and edges, along the axes through corners, in the planes of triangles, from corners,
/// with ends, and some that make no sense.
fn rays(points: &[DVec3], scale: f64, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    (0..count)
        .map(|k| {
            let [a, b, c] = [0; 3].map(|_| points[numbers.below(points.len())]);
            let origin = middle + 3.0 * scale * numbers.point();
            let axis = DVec3::AXES[k / 8 % 3] * [1.0, -1.0][k / 24 % 2];
            match k % 8 {
                0 => Ray::new(origin, numbers.point()),
                1 => Ray::new(origin, a - origin),
                2 => Ray::new(origin, a.lerp(b, numbers.unit()) - origin),
                3 => Ray::new(a - 2.0 * scale * axis, axis),
                4 => Ray::new(a, numbers.point()).up_to(scale * numbers.unit()),
                5 => Ray::new(a.lerp(b, 3.0), b.lerp(c, numbers.unit()) - a),
                6 => Ray::new(origin, 1e-30 * (a - origin) / scale).up_to(1e30 * scale),
                _ if k % 80 == 7 => Ray::new(origin, DVec3::splat(f64::NAN)),
                _ if k % 80 == 15 => Ray::new(origin * f64::INFINITY, axis),
                _ if k % 80 == 23 => Ray::new(origin, DVec3::ZERO),
                _ => Ray::new(
                    middle + 1e6 * scale * numbers.point(),
                    axis + 1e-9 * numbers.point(),
                ),
            }
        })
        .collect()
}

const PLACES: [(f64, f64); 8] = [
    (1.0, 0.0),
    (1e-6, 0.0),
    (1e6, 0.0),
    (1.0, 1e5),
    (1.0, -1e7),
    (1e-3, 1e2),
    (1e8, 3.0),
    (1e-4, 1e1),
];

fn placed(points: &[DVec3], scale: f64, offset: f64) -> Vec<DVec3> {
    let place = |p: &DVec3| scale * *p + DVec3::new(offset, -offset, 0.5 * offset);
    points.iter().map(place).collect()
}

/// Rounds of soups of every scale at every place; `rays_each` rays for each.
fn soups(rounds: u64, rays_each: usize) -> usize {
    let mut shot = 0;
    for round in 0..rounds {
        let mut numbers = Numbers::new(round + 1);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let (mut points, triangles) = soup([3, 12, 60][round as usize / 8 % 3], &mut numbers);
        if round % 2 == 0 {
            // As most files are.
            points = points.iter().map(|p| p.as_vec3().as_dvec3()).collect();
        }
        let points = placed(&points, scale, offset);
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        let rays = rays(&points, scale, rays_each, &mut numbers);
        judged(&scene, &rays);
        shot += rays.len();
    }
    shot
}

#[test]
fn soups_of_every_scale_and_place() {
    assert!(soups(48, 4000) > 100_000);
}

fn soak_rays() -> usize {
    std::env::var("FIRSTHIT_SOAK").map_or(1_000_000, |text| text.parse().unwrap())
}

/// `FIRSTHIT_SOAK` says how many rays; see the Makefile.
#[test]
#[ignore = "takes hours: make soak"]
fn soak() {
    let mut shot = 0;
    let mut round = 0;
    while shot < soak_rays() {
        round += 48;
        shot += soups(round, 4000);
        println!("{shot} rays");
    }
}

fn cameras(middle: DVec3, size: f64, numbers: &mut Numbers) -> Vec<Camera> {
    let mut cameras = Vec::new();
    for k in 0..8 {
        let position = middle + size * [2.0, 0.4, 8.0, 1.0][k % 4] * numbers.point();
        let projection = [Projection::Perspective, Projection::Orthographic][k / 4 % 2];
        let ray_start = [RayStart::Eye, RayStart::Viewplane][k % 2];
        let focal_length = size * [0.5, 0.01, 1.0][k % 3];
        let wide = match projection {
            Projection::Perspective => focal_length * [1.0, 3.0][k % 2],
            Projection::Orthographic => 2.0 * size,
        };
        let view = View {
            position,
            aim: middle + 0.3 * size * numbers.point() - position,
            up: numbers.point(),
            focal_length,
            width: wide,
            height: 0.8 * wide,
            rows: [33, 16, 50][k % 3],
            columns: [45, 31, 64][k % 3],
            projection,
            ray_start,
        };
        cameras.push(Camera::new(view).unwrap());
    }
    // Straight along an axis: slopes are exactly zero.
    let view = View {
        position: middle + 2.0 * size * DVec3::Z,
        focal_length: size,
        width: size,
        height: size,
        rows: 32,
        columns: 32,
        ..View::default()
    };
    cameras.push(Camera::new(view).unwrap());
    cameras
}

#[test]
fn cameras_on_soups() {
    let mut hits = 0;
    for round in 0..16 {
        let mut numbers = Numbers::new(100 + round);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let (points, triangles) = soup([12, 60][round as usize / 8], &mut numbers);
        let points = placed(&points, scale, offset);
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        for camera in cameras(
            placed(&[DVec3::ZERO], scale, offset)[0],
            scale,
            &mut numbers,
        ) {
            hits += judged(&scene, &camera);
        }
    }
    assert!(hits > 20_000, "{hits}");
}

/// A camera's rays in an array, as others make them: rounded, of any length, of a part of the picture, bent, and with
/// rays among them that are nobody's pixel.
fn pixels(camera: &Camera, kind: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let columns = if kind == 3 {
        16..camera.columns()
    } else {
        0..camera.columns()
    };
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
    rays
}

#[test]
fn arrays_of_a_cameras_rays() {
    let mut hits = 0;
    for round in 0..16 {
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
            let rays = pixels(camera, (k + round as usize) % 7, &mut numbers);
            hits += judged(&scene, &rays);
        }
    }
    assert!(hits > 20_000, "{hits}");
}

#[test]
fn cameras_on_instances_transforms_and_other_shapes() {
    let mut numbers = Numbers::new(5);
    let (points, triangles) = bumpy_sphere(6, 4);
    let shared = mesh(&points, triangles);
    let mut objects = vec![Object::new(Sphere::new(DVec3::ZERO, 0.7).unwrap())];
    for k in 0..24 {
        let matrix = DMat3::from_cols(numbers.point(), numbers.point(), numbers.point());
        let placed = DAffine3::from_mat3_translation(0.5 * matrix, 2.0 * numbers.point());
        let placed = Transform::new(placed).unwrap();
        objects.push(Object::new(Arc::clone(&shared)).placed(placed));
        if k == 12 {
            // Twice in the same place: the lower one wins every tie.
            objects.push(objects[3].clone());
        }
    }
    objects.push(Object::new(Plane::new(-2.0 * DVec3::Z, DVec3::Z).unwrap()));
    let mixed = Scene::new(objects.clone()).unwrap();
    let meshes = Scene::new(objects[1..26].to_vec()).unwrap();
    let mut hits = 0;
    for camera in cameras(DVec3::ZERO, 1.5, &mut numbers) {
        hits += judged(&mixed, &camera) + judged(&meshes, &camera);
    }
    let one = Scene::new(vec![objects[1].clone()]).unwrap();
    let rays = rays(&points, 1.0, 3000, &mut numbers);
    hits += judged(&mixed, &rays) + judged(&meshes, &rays) + judged(&one, &rays);
    assert!(hits > 5_000, "{hits}");
}

/// Every ray through a corner where six triangles meet, all at the same `t`.
#[test]
fn a_grid_looked_at_through_its_corners() {
    const SIDE: u32 = 33;
    let at = |k: u32| DVec3::new(f64::from(k % SIDE), f64::from(k / SIDE), 0.0);
    let points: Vec<DVec3> = (0..SIDE * SIDE).map(at).collect();
    let mut triangles = Vec::new();
    for k in (0..SIDE * (SIDE - 1)).filter(|k| k % SIDE + 1 < SIDE) {
        triangles.extend([[k, k + 1, k + SIDE], [k + 1, k + SIDE + 1, k + SIDE]]);
    }
    let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
    let side = f64::from(SIDE);
    let view = View {
        position: DVec3::new(0.5 * (side - 1.0), 0.5 * (side - 1.0), 4.0),
        focal_length: 4.0,
        width: side,
        height: side,
        rows: SIDE as usize,
        columns: SIDE as usize,
        projection: Projection::Orthographic,
        ray_start: RayStart::Eye,
        ..View::default()
    };
    let camera = Camera::new(view).unwrap();
    assert_eq!(judged(&scene, &camera), camera.pixels());
    let perspective = View {
        projection: Projection::Perspective,
        ..view
    };
    let camera = Camera::new(perspective).unwrap();
    assert_eq!(judged(&scene, &camera), camera.pixels());
}

fn hash(hits: &Hits) -> u64 {
    let mut hasher = DefaultHasher::new();
    for k in 0..hits.len() {
        bits(&hits.get(k)).hash(&mut hasher);
    }
    hasher.finish()
}

#[test]
fn pictures_and_batches_are_the_same_for_all_threads_and_instruction_sets() {
    let (points, triangles) = bumpy_sphere(60, 7);
    let objects = vec![Object::new(mesh(&points, triangles))];
    let mut numbers = Numbers::new(1);
    let batch = rays(&points, 1.0, 5000, &mut numbers);
    let camera = cameras(DVec3::ZERO, 1.5, &mut numbers)[0];
    let mut hashes = Vec::new();
    for set in sets() {
        for threads in [1, 2, 3, 7] {
            let pool = ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            hashes.push(pool.install(|| {
                let scene = Scene::new(objects.clone())
                    .unwrap()
                    .with_instruction_set(set);
                [
                    hash(&shoot_all(&scene, &batch, &()).unwrap()),
                    hash(&shoot_all(&scene, &camera, &()).unwrap()),
                ]
            }));
        }
    }
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:?}");
}

/// Closed meshes of the reference data, from a point near the middle: a ray at every corner and at every edge's
/// middle, and on from there, all of which meet the mesh.
/// Aims at each mesh that is closed, from a point inside, where it is, far away and in other sizes: at corners and
/// at edges, so many rays each. Returns how many rays there were.
fn leaks(rays_each: usize) -> usize {
    let Some(folder) = refdata() else {
        return 0;
    };
    let mut numbers = Numbers::new(7);
    let mut shot = 0;
    for path in ["generated", "real"]
        .iter()
        .flat_map(|name| files(&folder.join(name)))
    {
        let Ok(model) = firsthit::io::load(&path, &firsthit::io::LoadSettings::default()) else {
            continue;
        };
        for own in model.objects.iter().filter_map(Object::mesh) {
            if own.triangles().len() > 200_000 || !is_closed(own.triangles()) {
                continue;
            }
            let size = own.bounds().size().max_element();
            for (scale, sizes) in [(1.0, 0.0), (1.0, 1e5), (1e-4, 0.0), (1e8, 0.0)] {
                let offset = sizes * size * DVec3::new(1.0, -0.7, 0.3);
                let moved = |k: u32| scale * own.positions().get(k) + offset;
                let count = u32::try_from(own.positions().len()).unwrap();
                let points: Vec<DVec3> = (0..count).map(moved).collect();
                let mesh = mesh(&points, own.triangles().to_vec());
                let scene = Scene::new(vec![Object::new(mesh)]).unwrap();
                shot += aimed(&scene, rays_each, &mut numbers, &path);
            }
        }
    }
    shot
}

/// Shoots from inside the one closed mesh of a scene at its corners and edges, with every instruction set.
fn aimed(scene: &Scene, count: usize, numbers: &mut Numbers, path: &Path) -> usize {
    let mesh = scene.objects()[0].mesh().unwrap();
    let Some(inside) = point_inside(scene) else {
        return 0;
    };
    let mut rays = Vec::with_capacity(count);
    for k in 0..count {
        let [a, b, _] = mesh.corners(k / 2 % mesh.triangles().len());
        let target = if k % 2 == 0 {
            a
        } else {
            a.lerp(b, numbers.unit())
        };
        if target != inside {
            rays.push(Ray::new(inside, target - inside));
        }
    }
    for set in sets() {
        let scene = scene.clone().with_instruction_set(set);
        let hits = shoot_all(&scene, &rays, &()).unwrap();
        let any = occluded_all(&scene, &rays, &()).unwrap();
        let missed = (0..rays.len()).find(|&k| hits.get(k).is_miss() || !any[k]);
        let missed = missed.map(|k| rays[k]);
        assert_eq!(missed, None, "{} {set:?}", path.display());
    }
    rays.len()
}

/// So far away that float64 cannot bring the ray near, yet the judge says it hits.
#[test]
fn rays_from_very_far_away() {
    let points = [
        [
            0.704_673_351_557_588_5,
            0.792_725_582_506_619_3,
            0.755_299_526_949_494_4,
        ],
        [
            0.679_977_945_382_368_2,
            -0.938_001_182_180_339_8,
            -0.532_272_798_429_086_3,
        ],
        [
            -0.661_067_254_926_570_4,
            -0.101_627_778_287_902_04,
            -0.723_386_593_737_791,
        ],
    ];
    let points = points.map(DVec3::from);
    let scene = Scene::new(vec![Object::new(mesh(&points, vec![[0, 1, 2]]))]).unwrap();
    let aimed = Ray::new(
        DVec3::new(-1e17, 5_049_715_062_860_227.0, -2_542_603_579_874_058.5),
        DVec3::new(1.0, -0.050_497_150_628_602_27, 0.025_426_035_798_740_587),
    );
    let mut rays = vec![aimed];
    let mut numbers = Numbers::new(77);
    for k in 0..2000 {
        let way = 1e14 * (1_u64 << (3 * (k % 20))) as f64 * numbers.point();
        rays.push(Ray::new(points[0] - way, way));
        rays.push(Ray::new(0.3 * points[1] - way, way.normalize()).up_to(way.length() * 2.0));
    }
    assert!(judged(&scene, &rays) > 0);
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
        hits += judged(&scene, &rays);
    }
    assert!(hits > 3_000, "{hits}");
}

#[test]
fn closed_meshes_do_not_leak() {
    let shot = leaks(4_000);
    assert!(shot == 0 || shot > 100_000, "{shot}");
}

/// `FIRSTHIT_SOAK` says how many rays; see the Makefile.
#[test]
#[ignore = "takes hours: make soak"]
fn soak_of_leaks() {
    let mut shot = 0;
    while shot < soak_rays() {
        let rays = leaks(100_000);
        if rays == 0 {
            return;
        }
        shot += rays;
        println!("{shot} rays at corners and edges, each with every instruction set");
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(self::files(&path));
        } else {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// A point that the only object, a closed mesh, is met from an odd number of times.
fn point_inside(scene: &Scene) -> Option<DVec3> {
    let mesh = scene.objects()[0].mesh()?;
    let mut numbers = Numbers::new(9);
    let (low, size) = (mesh.bounds().low, mesh.bounds().size());
    (0..50).find_map(|_| {
        let point = low + size * (0.5 + 0.5 * numbers.point());
        let is_odd = |direction: DVec3| {
            let shear = Shear::new(&Ray::new(point, direction));
            let met = (0..mesh.triangles().len())
                .filter_map(|triangle| mesh.intersect_triangle(triangle, &shear));
            met.filter(|hit| hit.t > 0.0).count() % 2 == 1
        };
        (0..3).all(|_| is_odd(numbers.point())).then_some(point)
    })
}

/// Whether every edge is met by two triangles, once in each direction.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut edges = std::collections::HashMap::new();
    for &[a, b, c] in triangles {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            *edges.entry((p.min(q), p.max(q))).or_insert(0) += if p < q { 1 } else { -1 };
        }
    }
    !triangles.is_empty() && edges.values().all(|&sum| sum == 0)
}

#[test]
fn identical_and_degenerate_triangles_do_no_harm() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let scene = Scene::new(vec![Object::new(mesh(&points, vec![[0, 1, 2]; 20_000]))]).unwrap();
    let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z);
    let hits = shoot_all(&scene, &vec![ray; 3], &()).unwrap();
    assert_eq!((hits.t[2], hits.primitive[2]), (1.0, 0));

    let mut degenerate = vec![[0, 0, 1]; 1_000_000];
    degenerate.push([0, 1, 2]);
    let scene = Scene::new(vec![Object::new(mesh(&points, degenerate))]).unwrap();
    let hits = shoot_all(&scene, &vec![ray; 3], &()).unwrap();
    assert_eq!((hits.t[2], hits.primitive[2]), (1.0, 1_000_000));
}

/// Copies are asked once, and what looks like one is not taken for one.
#[test]
fn of_copies_in_one_place_the_lowest_is_met() {
    let mut numbers = Numbers::new(9);
    let (points, triangles) = bumpy_sphere(6, 4);
    // Each triangle five times, as itself, turned over, and beginning with another corner.
    let repeated = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [a, b, c], [a, c, b], [a, b, c]];
    let twenty = triangles.iter().flat_map(repeated);
    let many: Vec<[u32; 3]> = twenty.cycle().take(20 * triangles.len()).collect();
    let ball = Object::new(mesh(&points, triangles));
    let again = Object::new(mesh(&points, many));
    let moved = Transform::new(DAffine3::from_translation(1e-9 * DVec3::X)).unwrap();
    let objects = vec![
        again.clone().placed(moved),
        ball.clone(),
        again,
        ball.clone(),
        ball.clone().placed(moved),
        ball,
    ];
    let scene = Scene::new(objects).unwrap();
    let mut hits = judged(&scene, &rays(&points, 1.0, 400, &mut numbers));
    for camera in &cameras(DVec3::ZERO, 1.5, &mut numbers)[..3] {
        hits += judged(&scene, camera);
    }
    assert!(hits > 1_000, "{hits}");
}
