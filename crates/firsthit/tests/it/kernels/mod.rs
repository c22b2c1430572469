//! Every kernel on every instruction set of this machine, against brute force, bit for bit.

mod arrays;
mod curved;
mod fans;
mod leaks;
mod neighbours;
mod pixels;
mod planes;
mod shapes;

use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

use firsthit::scene::{AlphaMode, Build, BuildSettings};
use firsthit::shoot::{
    All, AllHits, Any, BruteForce, Count, Cpu, Engine, First, trace, trace_with,
};
use firsthit::{
    DAffine3, DQuat, DVec3, Hit, Hits, InstructionSet, Material, Object, Ray, Rays, Scene,
    Transform,
};

use crate::support::generators::{PLACES, cloud, placed, rays, short_rays, soup, unshared};
use crate::support::{Numbers, bits, bumpy_sphere, cases, mesh, on_threads, rounds, soak_rays};

/// Shoots `rays` with every instruction set and compares with brute force; returns how many hit.
/// Then some of them once more, which begin where they hit, just before, or anywhere.
fn checked<R: Rays + ?Sized>(scene: &Scene, rays: &R) -> usize {
    let hits = compared(scene, rays);
    let later = |(k, t): (usize, f64)| {
        let begin = [t, t.next_down(), 0.5 * t, 1.5 * t, -t, 1e30][k / 3 % 6];
        rays.ray(k).beyond(if t < f64::INFINITY { begin } else { t })
    };
    let some = hits.iter().enumerate().step_by(3);
    let later: Vec<Ray> = some.map(|(k, hit)| later((k, hit.t))).collect();
    compared(scene, &later);
    hits.iter().filter(|hit| !hit.is_miss()).count()
}

/// The hits of brute force, which are those of every instruction set.
fn compared<R: Rays + ?Sized>(scene: &Scene, rays: &R) -> Vec<Hit> {
    let expected: Vec<Hit> =
        (0..rays.len()).map(|k| BruteForce.first_hit(scene, &rays.ray(k))).collect();
    let every = All::default();
    let expected_all = trace_with(&BruteForce, scene, rays, every, &()).unwrap();
    let fast = BuildSettings { build: Build::Fast, rays: None };
    let quick = Scene::build(scene.objects().to_vec(), fast).unwrap();
    // The trees that were built in little time with one of the sets: what differs is not in the
    // kernels.
    let last = InstructionSet::available().last().map(|set| (set, &quick));
    for (set, scene) in InstructionSet::available().map(|set| (set, scene)).chain(last) {
        let engine = Cpu::with(set);
        let hits = trace_with(&engine, scene, rays, First, &()).unwrap();
        let any = trace_with(&engine, scene, rays, Any, &()).unwrap();
        let counts = trace_with(&engine, scene, rays, Count, &()).unwrap();
        let all = trace_with(&engine, scene, rays, every, &()).unwrap();
        for (k, expected) in expected.iter().enumerate() {
            let (ray, hit) = (rays.ray(k), hits.get(k));
            let what = || format!("{set:?} {k} {ray:?}: {hit:?}, brute force says {expected:?}");
            assert_eq!(bits(&hit), bits(expected), "{}", what());
            assert_eq!(any[k], !expected.is_miss(), "any hit: {}", what());
            let of_ray = |all: &AllHits| -> Vec<_> {
                let range = all.offsets[k]..all.offsets[k + 1];
                range.map(|index| bits(&all.hits.get(index))).collect()
            };
            let crossings = of_ray(&all);
            assert_eq!(crossings, of_ray(&expected_all), "all hits: {}", what());
            assert_eq!(counts[k] as usize, crossings.len(), "count: {}", what());
            if k % 64 == 0 {
                assert_eq!(engine.any_hit(scene, &ray), !expected.is_miss(), "{}", what());
                let alone = engine.first_hit(scene, &ray);
                assert_eq!(bits(&alone), bits(expected), "alone: {}", what());
            }
        }
    }
    expected
}

/// Rounds of soups of every scale at every place; `rays_each` rays for each, and half as many short
/// ones.
fn soups(rounds: Range<u64>, rays_each: usize) -> usize {
    let mut shot = 0;
    for round in rounds {
        let mut numbers = Numbers::new(round + 1);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let (mut points, triangles) = soup([3, 12, 60][round as usize / 8 % 3], &mut numbers);
        if round % 2 == 0 {
            // As most files are.
            points = points.iter().map(|p| p.as_vec3().as_dvec3()).collect();
        }
        let points = placed(&points, scale, offset);
        let (points, triangles) =
            if round % 3 == 2 { unshared(&points, &triangles) } else { (points, triangles) };
        let mut object = Object::new(mesh(&points, triangles));
        if round % 7 == 4 {
            // Without a hole, but each hit is asked for one.
            let alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
            object = object.with_materials([Material { alpha_mode, ..Material::default() }]);
        }
        let scene = Scene::new(vec![object]).unwrap();
        let rays = rays(&points, scale, rays_each, &mut numbers);
        checked(&scene, &rays);
        let short = short_rays(&points, scale, rays_each / 2 - 5, &mut numbers);
        checked(&scene, &short);
        shot += rays.len() + short.len();
    }
    shot
}

#[test]
fn soups_of_every_scale_and_place() {
    assert!(soups(0..48, cases(4000)) > cases(100_000));
}

/// Through trees of some levels, where packets go from node to node together; a cloud of triangles,
/// in which rays soon have little in common; and instances.
#[test]
fn short_rays_from_neighbours() {
    for (round, (scale, offset)) in PLACES.into_iter().enumerate() {
        let mut numbers = Numbers::new(round as u64 + 1);
        let (points, triangles) =
            if round % 2 == 0 { bumpy_sphere(40, 3) } else { cloud(4000, &mut numbers) };
        let points = placed(&points, scale, offset);
        let mesh = mesh(&points, triangles);
        let one = Scene::new(vec![Object::new(mesh.clone())]).unwrap();
        let rays = short_rays(&points, scale, cases(3990), &mut numbers);
        let met = checked(&one, &rays);
        assert!(met > rays.len() / 8 && met < rays.len(), "{met}");
        if round < 3 {
            let turn = DAffine3::from_rotation_z(0.4);
            let aside = DAffine3::from_translation(0.3 * scale * DVec3::X) * turn;
            let placed = Transform::new(aside).unwrap();
            let objects = vec![Object::new(mesh.clone()), Object::new(mesh).placed(placed)];
            let rays = &rays[..cases(1000)];
            checked(&Scene::new(objects).unwrap(), rays);
        }
    }
}

/// Many turned instances of some meshes at every scale, of which hardly any two rays come to the
/// same one at a time: then sixteen rays go together that are at sixteen meshes. Each mesh has
/// units and a middle of its own; some vertices are float32, and some are not.
#[test]
fn rays_among_many_instances() {
    const UNITS: [f64; 5] = [1.0, 0.01, 40.0, 3.0, 1e-3];
    const MIDDLES: [f64; 5] = [0.0, 5.0, 0.0, -70.0, 0.2];
    for round in rounds(8) {
        let mut numbers = Numbers::new(40 + round);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let meshes: Vec<_> = (0..5)
            .map(|k| {
                let (points, triangles) = if k == 0 {
                    bumpy_sphere(12, 3)
                } else {
                    soup([3, 12, 40, 7][k % 4], &mut numbers)
                };
                let mut points = placed(&points, UNITS[k], MIDDLES[k]);
                if k % 2 == 0 {
                    points = points.iter().map(|p| p.as_vec3().as_dvec3()).collect();
                }
                mesh(&points, triangles)
            })
            .collect();
        let objects: Vec<Object> = (0..160)
            .map(|k| {
                let mesh = k % 5;
                let size = scale * [1.0, 0.02, 3.0][k % 3] / UNITS[mesh];
                let size = size * (1.0 + 0.3 * numbers.point());
                let turn = DQuat::from_scaled_axis(3.0 * numbers.point());
                let place = placed(&[6.0 * numbers.point()], scale, offset)[0];
                let middle = placed(&[DVec3::ZERO], 1.0, MIDDLES[mesh])[0];
                let to_place = DAffine3::from_scale_rotation_translation(size, turn, place);
                let affine = to_place * DAffine3::from_translation(-middle);
                Object::new(meshes[mesh].clone()).placed(Transform::new(affine).unwrap())
            })
            .collect();
        let scene = Scene::new(objects).unwrap();
        let points: Vec<DVec3> = (0..200).map(|_| 6.0 * numbers.point()).collect();
        let points = placed(&points, scale, offset);
        let rays = rays(&points, 6.0 * scale, cases(1500), &mut numbers);
        let met = checked(&scene, &rays);
        assert!(met > rays.len() / 20, "{round}: {met} of {}", rays.len());
        // Few pixels, in each tile of which most objects may be seen.
        let middle = placed(&[DVec3::ZERO], scale, offset)[0];
        checked(&scene, &pixels::cameras(middle, 3.0 * scale, &mut numbers)[0]);
    }
}

/// Two sheets that go through one another, seen almost along them: which is first hangs on digits
/// that float32 lacks.
#[test]
fn sheets_seen_almost_along_them() {
    let mut hits = 0;
    for round in rounds(40) {
        let mut numbers = Numbers::new(900 + round);
        let normal = numbers.point().normalize();
        let (across, along) = normal.any_orthonormal_pair();
        let mut points = Vec::new();
        for _ in 0..2 {
            for [x, y] in [[-0.9, -0.8], [0.9, -0.7], [0.1, 0.9]] {
                let lift = 3e-7 * (2.0 * numbers.unit() - 1.0);
                let corner = x * across + y * along + lift * normal;
                points.push(corner.as_vec3().as_dvec3());
            }
        }
        let objects = vec![Object::new(mesh(&points, vec![[0, 1, 2], [3, 4, 5]]))];
        let rays: Vec<Ray> = (0..2000)
            .map(|k| {
                let place = (0.4 * numbers.unit()) * across + 0.3 * (numbers.unit() - 0.5) * along;
                let flat = numbers.point().reject_from(normal).normalize();
                let slope = [1e-1, 1e-2, 1e-3][k % 3];
                let direction = flat + slope * normal;
                Ray::new(place - (0.5 + numbers.unit()) * direction, direction)
            })
            .collect();
        hits += checked(&Scene::new(objects).unwrap(), &rays);
    }
    assert!(hits > cases(70_000), "{hits}");
}

/// `FIRSTHIT_SOAK` says how many rays; see the Makefile.
#[test]
#[ignore = "takes long: make soak"]
fn soak() {
    let mut shot = 0;
    let mut round = 0;
    while shot < soak_rays() {
        // Every round has rays of its own; those of the test are the first.
        shot += soups(round..round + 48, 4000);
        round += 48;
        println!("{shot} rays");
    }
}

/// So far away that float64 cannot bring the ray near, yet exact arithmetic says it hits.
#[test]
fn rays_from_very_far_away() {
    let points = [
        [0.704_673_351_557_588_5, 0.792_725_582_506_619_3, 0.755_299_526_949_494_4],
        [0.679_977_945_382_368_2, -0.938_001_182_180_339_8, -0.532_272_798_429_086_3],
        [-0.661_067_254_926_570_4, -0.101_627_778_287_902_04, -0.723_386_593_737_791],
    ];
    let points = points.map(DVec3::from);
    let one = Object::new(mesh(&points, vec![[0, 1, 2]]));
    // Alone, and among others in the tree over objects.
    let others = (1..7).map(|k| {
        let beside = DVec3::new(0.0, 3.0 * f64::from(k), 0.0);
        (one.clone()).placed(Transform::translation(beside).unwrap())
    });
    let among = std::iter::once(one.clone()).chain(others).collect();
    let scenes = [vec![one.clone()], among].map(|objects| Scene::new(objects).unwrap());
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
    let met = scenes.each_ref().map(|scene| checked(scene, &rays));
    assert!(met[0] > 0 && met[1] >= met[0], "{met:?}");
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
    let camera = pixels::cameras(DVec3::ZERO, 1.5, &mut numbers)[0];
    let mut hashes = Vec::new();
    for set in InstructionSet::available() {
        for threads in [1, 2, 3, 7] {
            hashes.push(on_threads(threads, || {
                let scene = Scene::new(objects.clone()).unwrap();
                let engine = Cpu::with(set);
                [
                    hash(&trace_with(&engine, &scene, &batch, First, &()).unwrap()),
                    hash(&trace_with(&engine, &scene, &camera, First, &()).unwrap()),
                ]
            }));
        }
    }
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:?}");
}

/// A triangle without an inside that is far from the ray may look met in float32, if nothing but
/// the sizes of the triangles around it says what rounding comes to.
#[test]
fn points_are_not_met() {
    let mut numbers = Numbers::new(11);
    for _ in 0..cases(24) {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for k in 0..7_u32 {
            let place = numbers.point();
            let first = points.len() as u32;
            if k % 2 == 0 {
                points.extend((0..3).map(|_| place + 1e-4 * numbers.point()));
                triangles.push([first, first + 1, first + 2]);
            } else {
                points.push(place);
                triangles.push([first; 3]);
            }
        }
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        let mut all = Vec::new();
        for _ in 0..40 {
            // From one point in nearly the same direction, and each its own way.
            let (origin, aim) = (3.0 * numbers.point(), numbers.point());
            all.extend((0..16).map(|_| Ray::new(origin, aim + 0.05 * numbers.point() - origin)));
            all.extend((0..16).map(|_| {
                let origin = 3.0 * numbers.point();
                Ray::new(origin, numbers.point() - origin)
            }));
        }
        checked(&scene, &all);
    }
}

#[test]
fn identical_and_degenerate_triangles_do_no_harm() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let scene = Scene::new(vec![Object::new(mesh(&points, vec![[0, 1, 2]; 20_000]))]).unwrap();
    let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z);
    let hits = trace(&scene, &vec![ray; 3], First, &()).unwrap();
    assert_eq!((hits.t[2], hits.primitive[2]), (1.0, 0));

    let mut degenerate = vec![[0, 0, 1]; 1_000_000];
    degenerate.push([0, 1, 2]);
    let scene = Scene::new(vec![Object::new(mesh(&points, degenerate))]).unwrap();
    let hits = trace(&scene, &vec![ray; 3], First, &()).unwrap();
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
    let mut hits = checked(&scene, &rays(&points, 1.0, 400, &mut numbers));
    for camera in &pixels::cameras(DVec3::ZERO, 1.5, &mut numbers)[..3] {
        hits += checked(&scene, camera);
    }
    assert!(hits > 1_000, "{hits}");
}
