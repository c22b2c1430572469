//! Every crossing once: against rational arithmetic, for rays through vertices and edges, along
//! edges and in planes.

use std::sync::atomic::{AtomicUsize, Ordering};

use firsthit::shoot::{All, BruteForce, Count, Cpu, First, trace, trace_with};
use firsthit::watch::Watch;
use firsthit::{DVec3, Error, Mesh, Object, Ray, Rays, Scene, Sphere};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use crate::support::rational::{cross, dot, exact, minus, nearest};
use crate::support::{Numbers, bumpy_sphere, cases, mesh, scene};

/// A crossing of a perturbed ray.
struct Crossed {
    /// Of the ray as it is.
    t: BigRational,
    /// Of the perturbed one.
    perturbed: BigRational,
    triangle: i32,
    is_entering: bool,
}

/// The triangles that the line from `(e, e^2, e^3)` beside the ray's origin crosses, for an `e` of
/// 2^-500; in their order.
fn crossed(ray: &Ray, mesh: &Mesh) -> Vec<Crossed> {
    let e = BigRational::one() / BigRational::from_integer(num_traits::pow(2.into(), 500));
    let origin = exact(ray.origin);
    let [x, y, z] = origin.clone();
    let perturbed = [x + &e, y + &e * &e, z + &e * &e * &e];
    let d = exact(ray.direction);
    let mut all = Vec::new();
    for (triangle, _) in (0..).zip(mesh.triangles()) {
        let corners = mesh.corners(triangle as usize).map(exact);
        // What is not zero keeps its sign.
        let [a, b, c] = [0, 1, 2].map(|k| minus(&corners[k], &origin));
        let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&d, &cross(p, q)));
        if sides.iter().any(Signed::is_positive) && sides.iter().any(Signed::is_negative) {
            continue;
        }
        let [a, b, c] = [0, 1, 2].map(|k| minus(&corners[k], &perturbed));
        let n = cross(&minus(&b, &a), &minus(&c, &a));
        let slope = dot(&n, &d);
        let sides = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&d, &cross(p, q)));
        let is_crossed =
            sides.iter().all(Signed::is_positive) || sides.iter().all(Signed::is_negative);
        if is_crossed {
            let from_origin = minus(&corners[0], &origin);
            all.push(Crossed {
                t: dot(&n, &from_origin) / &slope,
                perturbed: dot(&n, &a) / &slope,
                triangle,
                is_entering: slope.is_negative(),
            });
        }
    }
    all.sort_by(|a, b| (&a.t, &a.perturbed, a.triangle).cmp(&(&b.t, &b.perturbed, b.triangle)));
    all
}

/// The bumpy sphere with few digits, and rays at what it has of edges and corners: through them,
/// along them, in planes.
fn adversarial(seed: u64) -> (Vec<DVec3>, Vec<[u32; 3]>, Vec<Ray>) {
    let mut numbers = Numbers::new(seed);
    let (points, triangles) = bumpy_sphere(3, 5);
    let digits = [1.0, 2.0, 8.0, 1e15][seed as usize % 4];
    let few = |v: DVec3| (v * digits).round() / digits;
    let points: Vec<_> = points.iter().map(|&point| few(3.0 * point)).collect();
    let mut rays = Vec::new();
    while rays.len() < 120 {
        let [a, b] = [0, 1].map(|_| points[numbers.below(points.len())]);
        let [p, q, r] = triangles[numbers.below(triangles.len())].map(|k| points[k as usize]);
        let k = rays.len();
        let (through, way) = match k % 6 {
            0 => (a, few(5.0 * numbers.point())),
            1 => (0.5 * (p + q), few(5.0 * numbers.point())),
            2 => (a, [DVec3::X, DVec3::NEG_Y, DVec3::Z][k / 6 % 3]),
            3 => (a, b - a),
            // Along an edge, and in a plane.
            4 => (p, q - p),
            _ => (p, 0.25 * (q - p) + 0.5 * (r - p)),
        };
        if way != DVec3::ZERO {
            rays.push(Ray::new(through - 4.0 * way, way));
        }
    }
    (points, triangles, rays)
}

#[test]
fn crossings_are_those_of_a_ray_beside() {
    let (mut touched, mut total) = (0, 0);
    for seed in 0..8 {
        let (points, triangles, mut rays) = adversarial(seed);
        rays.truncate(cases(rays.len()));
        let scene = scene(vec![Object::new(mesh(&points, triangles.clone()))]);
        let mesh = scene.objects()[0].mesh().unwrap().clone();
        let all = trace(&scene, &rays[..], All::default(), &()).unwrap();
        let counts = trace(&scene, &rays[..], Count, &()).unwrap();
        let first = trace(&scene, &rays[..], First, &()).unwrap();
        for (k, ray) in rays.iter().enumerate() {
            let range = all.offsets[k]..all.offsets[k + 1];
            let line = crossed(ray, &mesh);
            // Entering and leaving in turn, all along the line.
            assert!(
                line.len().is_multiple_of(2) && line.iter().step_by(2).all(|at| at.is_entering)
            );
            let ahead: Vec<_> = line.into_iter().filter(|at| at.t.is_positive()).collect();
            let expected: Vec<i32> = ahead.iter().map(|at| at.triangle).collect();
            assert_eq!(all.hits.primitive[range.clone()], expected, "{ray:?}");
            assert_eq!(counts[k] as usize, expected.len());
            for (at, t) in ahead.iter().zip(&all.hits.t[range.clone()]) {
                let t_exactly = nearest(&at.t);
                assert!((t - t_exactly).abs() <= f64::EPSILON * t_exactly);
            }
            // Hits in one place may have neighbouring `t` in any order.
            let t = &all.hits.t[range.clone()];
            assert!(t.is_sorted_by(|a, b| *a <= b.next_up()));
            touched += usize::from(first.object[k] == 0 && range.is_empty());
            total += range.len();
        }
    }
    // Some rays only touch.
    assert!(touched > cases(10) && total > cases(1000), "{touched} {total}");
}

/// A line that begins behind the mesh enters and leaves in turn, too.
#[test]
fn lines_cross_closed_meshes_in_pairs() {
    for seed in 0..8 {
        let (points, triangles, rays) = adversarial(seed);
        let scene = scene(vec![Object::new(mesh(&points, triangles))]);
        let mesh = scene.objects()[0].mesh().unwrap().clone();
        let within = |ray: &Ray| Ray::new(ray.at(4.0), ray.direction).beyond(f64::NEG_INFINITY);
        let lines: Vec<Ray> = rays.iter().map(within).collect();
        let all = trace(&scene, &lines[..], All::default(), &()).unwrap();
        let slow = trace_with(&BruteForce, &scene, &lines[..], All::default(), &()).unwrap();
        assert_eq!(all.offsets, slow.offsets);
        assert_eq!(all.hits.primitive, slow.hits.primitive);
        let slow_counts = trace_with(&BruteForce, &scene, &lines[..], Count, &()).unwrap();
        for (k, line) in lines.iter().enumerate() {
            let range = all.offsets[k]..all.offsets[k + 1];
            assert!(range.len().is_multiple_of(2), "{line:?}");
            assert_eq!(slow_counts[k] as usize, range.len());
            for (place, &triangle) in all.hits.primitive[range].iter().enumerate() {
                let [a, b, c] = mesh.corners(usize::try_from(triangle).unwrap()).map(exact);
                let slope = dot(&cross(&minus(&b, &a), &minus(&c, &a)), &exact(line.direction));
                assert!(!slope.is_zero() && slope.is_negative() == (place % 2 == 0));
            }
        }
    }
}

/// Sheets a few last digits apart, and in one place: each is there, in the exact order.
#[test]
fn close_sheets_are_in_order() {
    let sheet = |z: f64, tilt: f64| {
        let corners = [[-1.0, -1.0, z - tilt], [3.0, -1.0, z + 3.0 * tilt], [-1.0, 3.0, z - tilt]];
        corners.map(DVec3::from)
    };
    let z = 1.0_f64 / 3.0;
    let mut points = Vec::new();
    for k in [3, 1, 0, 2, 0, 1] {
        let z = f64::from_bits(z.to_bits() + k);
        points.extend(sheet(z, 1e-18));
    }
    let triangles: Vec<_> = (0..6).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let scene = scene(vec![Object::new(mesh(&points, triangles))]);
    let mesh = scene.objects()[0].mesh().unwrap().clone();
    let mut numbers = Numbers::new(3);
    for _ in 0..cases(200) {
        let origin = DVec3::new(0.3, 0.2, -1.0) + 0.1 * numbers.point();
        let ray = Ray::new(origin, DVec3::Z + 0.01 * numbers.point());
        let all = trace(&scene, &[ray][..], All::default(), &()).unwrap();
        let expected: Vec<i32> = crossed(&ray, &mesh).iter().map(|at| at.triangle).collect();
        assert_eq!(all.hits.primitive, expected, "{ray:?}");
        assert!(all.hits.t.is_sorted_by(|a, b| *a <= b.next_up()));
        let two = trace(&scene, &[ray][..], All { nearest: Some(2) }, &()).unwrap();
        assert_eq!(two.hits.primitive, expected[..2]);
        assert_eq!(two.offsets, [0, 2]);
    }
}

/// Solids are entered and left, even where a ray touches an edge or starts inside.
#[test]
fn solids_are_crossed_at_both_ends() {
    let ball = || Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let scene = Scene::new(vec![ball(), ball()]).unwrap();
    let rays = [
        Ray::new(DVec3::new(0.0, 0.0, 3.0), DVec3::NEG_Z),
        Ray::new(DVec3::new(0.0, 1.0, 3.0), DVec3::NEG_Z),
        Ray::new(DVec3::ZERO, DVec3::X),
        Ray::new(DVec3::ZERO, DVec3::NAN),
    ];
    for engine in [&BruteForce as &dyn firsthit::shoot::Engine, &Cpu::default()] {
        let all = trace_with(engine, &scene, &rays[..], All::default(), &()).unwrap();
        assert_eq!(all.offsets, [0, 4, 8, 10, 10]);
        assert_eq!(all.hits.object, [0, 1, 0, 1, 0, 0, 1, 1, 0, 1]);
        assert_eq!(all.hits.t[..4], [2.0, 2.0, 4.0, 4.0]);
    }
}

/// Rays that are computed from all hits of others.
struct FromCrossings<'a> {
    scene: &'a Scene,
    rays: Vec<Ray>,
}

impl Rays for FromCrossings<'_> {
    fn len(&self) -> usize {
        self.rays.len()
    }

    fn ray(&self, index: usize) -> Ray {
        // As many as a batch and more, so that threads share them.
        let others: Vec<Ray> = (0..3000).map(|k| self.rays[(index + k) % 40]).collect();
        let all = trace(self.scene, &others, All::default(), &()).unwrap();
        assert_eq!(all.offsets.len(), 3001);
        self.rays[index]
    }
}

#[test]
fn rays_may_come_from_another_query() {
    let (points, triangles) = bumpy_sphere(4, 3);
    let scene = scene(vec![Object::new(mesh(&points, triangles))]);
    let mut numbers = Numbers::new(4);
    let mut ray = || {
        let from = 2.0 * numbers.point();
        Ray::new(from, 0.2 * numbers.point() - from)
    };
    let rays: Vec<Ray> = (0..40).map(|_| ray()).collect();
    let expected = trace(&scene, &rays, All::default(), &()).unwrap();
    assert!(expected.hits.len() > 10);
    let scene = &scene;
    let found = trace(scene, &FromCrossings { scene, rays }, All::default(), &()).unwrap();
    assert_eq!(found.offsets, expected.offsets);
    assert_eq!(found.hits.t, expected.hits.t);
}

/// A thousand rays, of which the third one that is asked for stops everything.
#[derive(Default)]
struct Stopping(AtomicUsize);

impl Rays for Stopping {
    fn len(&self) -> usize {
        1000
    }

    fn ray(&self, _: usize) -> Ray {
        self.0.fetch_add(1, Ordering::Relaxed);
        Ray::new(DVec3::NEG_X, DVec3::X)
    }
}

impl Watch for Stopping {
    fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed) >= 3
    }
}

#[test]
fn brute_force_is_stopped_between_two_rays() {
    let scene = scene(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap())]);
    let rays = Stopping::default();
    let stopped = trace_with(&BruteForce, &scene, &rays, All::default(), &rays);
    assert!(matches!(stopped, Err(Error::Interrupted)));
    assert_eq!(rays.0.into_inner(), 3);
}
