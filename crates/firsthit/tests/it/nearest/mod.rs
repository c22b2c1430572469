//! Nearest points: trees on every instruction set against brute force, bit for bit; brute force
//! against rational arithmetic.

mod exact;
mod signed;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use firsthit::nearest::{
    ClosestPoints, Method, NearestSettings, closest_points, closest_points_with,
};
use firsthit::watch::Watch;
use firsthit::{
    Cone, Cuboid, Cylinder, DAffine3, DMat3, DQuat, DVec3, Disc, Error, InstructionSet, Mesh,
    Object, Plane, Scene, Shape, Sphere, Transform,
};

use crate::support::generators::{PLACES, cloud, placed, soup, unshared};
use crate::support::{Numbers, bumpy_sphere, mesh, on_threads, scene};

type Bits = (u64, i32, i32, [u64; 3], [u64; 2]);

/// Everything that the points of a scene have for an answer. NaNs are one.
fn bits(all: &ClosestPoints) -> Vec<Bits> {
    let number = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
    let element = |k: usize| {
        let weights = all.barycentric[k].to_array().map(number);
        let (object, primitive) = (all.object[k], all.primitive[k]);
        (number(all.distance[k]), object, primitive, all.point[k].map(number), weights)
    };
    (0..all.distance.len()).map(element).collect()
}

/// Compares every instruction set with brute force, for one and for several nearest points, without
/// and with a radius. Returns the nearest.
pub(crate) fn checked(scene: &Scene, points: &[[f64; 3]]) -> ClosestPoints {
    let judge = |wanted| {
        let judged = closest_points_with(Method::BruteForce, scene, points, wanted, &()).unwrap();
        for set in InstructionSet::available() {
            let method = Method::Trees(set);
            let found = closest_points_with(method, scene, points, wanted, &()).unwrap();
            let (found, judged) = (bits(&found), bits(&judged));
            for (k, (found, expected)) in found.iter().zip(&judged).enumerate() {
                let point = points[k / wanted.count];
                assert_eq!(found, expected, "{set:?} {wanted:?} {point:?} ({k})");
            }
        }
        judged
    };
    let nearest = judge(NearestSettings::default());
    let mut distances = nearest.distance.clone();
    distances.sort_by(f64::total_cmp);
    let radius = distances.get(points.len() / 3).copied().unwrap_or(1.0);
    if radius < f64::INFINITY {
        judge(NearestSettings { count: 1, radius });
        judge(NearestSettings { count: 4, radius: 2.0 * radius });
    }
    let several = judge(NearestSettings { count: 7, ..NearestSettings::default() });
    for (k, object) in several.object.iter().enumerate().step_by(7) {
        assert_eq!(*object, nearest.object[k / 7]);
        assert!(several.distance[k..k + 7].is_sorted());
    }
    nearest
}

/// Points all around, at corners, on edges, in triangles and a little beside, one after the other
/// nearby, far away.
fn around(corners: &[DVec3], scale: f64, count: usize, numbers: &mut Numbers) -> Vec<[f64; 3]> {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let mut before = middle;
    let point = |k: usize| {
        let [a, b, c] = [0; 3].map(|_| corners[numbers.below(corners.len())]);
        let off = [0.0, 1e-15, 1e-9, 1e-7, 1e-5, 1e-3][k / 16 % 6] * scale;
        let in_triangle = a.lerp(b, numbers.unit()).lerp(c, numbers.unit());
        before = match k % 16 {
            0..4 => middle + 1.5 * scale * numbers.point(),
            4 => a,
            5 => a + off * numbers.point(),
            6 => 0.5 * (a + b),
            7 => a.lerp(b, numbers.unit()) + off * numbers.point(),
            8 | 9 => in_triangle + off * numbers.point(),
            10 => before + 1e-4 * scale * numbers.point(),
            11 => before,
            12 => before + 1e-12 * scale * numbers.point(),
            13 => middle + 100.0 * scale * numbers.point(),
            14 => middle + [1e5, 1e8, 1e11, 1e17, 1e30][k / 16 % 5] * scale * numbers.point(),
            _ => [
                DVec3::splat(f64::NAN),
                DVec3::new(0.0, f64::INFINITY, 0.0),
                DVec3::new(1e150, 0.0, -1e149),
                DVec3::new(-1e200, 3.0, 2.0),
                DVec3::new(1e160, f64::MAX, 2.0),
            ][k / 16 % 5],
        };
        before.to_array()
    };
    (0..count).map(point).collect()
}

#[test]
fn soups_of_every_scale_and_place() {
    for round in 0..48 {
        let mut numbers = Numbers::new(round + 1);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let (mut points, triangles) = soup([3, 12, 60][round as usize / 8 % 3], &mut numbers);
        if round % 2 == 0 {
            points = points.iter().map(|p| p.as_vec3().as_dvec3()).collect();
        }
        let points = placed(&points, scale, offset);
        let (points, triangles) =
            if round % 3 == 2 { unshared(&points, &triangles) } else { (points, triangles) };
        let scene = scene(vec![Object::new(mesh(&points, triangles))]);
        checked(&scene, &around(&points, scale, 160, &mut numbers));
    }
}

/// Enough triangles for several levels of nodes.
#[test]
fn trees_with_levels() {
    let mut numbers = Numbers::new(5);
    let (points, triangles) = cloud(3000, &mut numbers);
    let soup = scene(vec![Object::new(mesh(&points, triangles))]);
    checked(&soup, &around(&points, 1.0, 300, &mut numbers));
    let (points, triangles) = bumpy_sphere(24, 3);
    let ball = scene(vec![Object::new(mesh(&points, triangles))]);
    checked(&ball, &around(&points, 1.0, 400, &mut numbers));
    // Each point on the grid is as near to several triangles of a grid.
    let places = (0..400).map(|k| DVec3::new(f64::from(k % 20), f64::from(k / 20), 0.0));
    let places: Vec<DVec3> = places.collect();
    let cell = |k: u32| {
        let a = k / 19 * 20 + k % 19;
        [[a, a + 1, a + 20], [a + 1, a + 21, a + 20]]
    };
    let sheet = scene(vec![Object::new(mesh(&places, (0..361).flat_map(cell).collect()))]);
    let lattice =
        |k: u32| [0.5 * f64::from(k % 40), 0.5 * f64::from(k / 40), f64::from(k % 3) - 1.0];
    checked(&sheet, &(0..1600).step_by(3).map(lattice).collect::<Vec<_>>());
}

fn transforms() -> Vec<DAffine3> {
    let turn = DQuat::from_rotation_z(0.3) * DQuat::from_rotation_y(-2.0);
    let shear = DMat3::from_cols_array(&[1.0, 0.3, 0.0, -0.7, 2.0, 0.1, 0.2, 0.0, 0.3]);
    vec![
        DAffine3::IDENTITY,
        DAffine3::from_translation(DVec3::new(0.1, 5.0, -3.0)),
        DAffine3::from_rotation_translation(turn, DVec3::new(-4.0, 0.3, 0.1)),
        DAffine3::from_scale_rotation_translation(DVec3::splat(3.0), turn, DVec3::splat(1.0 / 3.0)),
        DAffine3::from_scale(DVec3::new(-1.0, 2.0, 0.01)),
        DAffine3::from_mat3_translation(shear, DVec3::new(2.0, 2.0, 2.0)),
        DAffine3::from_mat3_translation(1e-5 * shear, DVec3::new(1e3, 1e-3, 2.0)),
        DAffine3::from_mat3_translation(1e5 * shear, DVec3::new(1e7, 1e-3, 2.0)),
    ]
}

/// Instances under all kinds of transforms, one by one and together, some of them in the same
/// place.
#[test]
fn instances_are_measured_in_the_world() {
    let mut numbers = Numbers::new(11);
    let (points, triangles) = bumpy_sphere(6, 3);
    let shared = mesh(&points, triangles);
    let mut objects = Vec::new();
    for map in transforms() {
        let place = Transform::new(map).unwrap();
        let object = Object::new(Arc::clone(&shared)).placed(place);
        let corners: Vec<DVec3> = points.iter().map(|&p| map.transform_point3(p)).collect();
        let size = map.matrix3.x_axis.length().max(map.matrix3.y_axis.length());
        let of_one = around(&corners, size, 200, &mut numbers);
        checked(&scene(vec![object.clone()]), &of_one);
        objects.extend([object.clone(), object]);
    }
    let together = scene(objects);
    checked(&together, &around(&points, 3.0, 300, &mut numbers));
}

fn shapes() -> Vec<Shape> {
    let (o, up) = (DVec3::new(0.3, -0.2, 0.1), DVec3::new(0.2, 0.5, 1.0));
    let (points, triangles) = bumpy_sphere(3, 8);
    vec![
        Shape::from(Sphere::new(o, 0.8).unwrap()),
        Shape::from(Disc::new(-o, up, 0.7).unwrap()),
        Shape::from(Cuboid::new(o, up + 0.5).unwrap()),
        Shape::from(mesh(&points, triangles)),
        Shape::from(Plane::new(9.0 * o, up).unwrap()),
        Shape::from(Cylinder::new(o, up, 0.3).unwrap()),
        Shape::from(Cone::new(o, -up, 0.5, 0.0).unwrap()),
    ]
}

/// All shapes under all transforms that they allow, in one scene.
#[test]
fn shapes_of_all_kinds() {
    let mut numbers = Numbers::new(2);
    let mut objects = Vec::new();
    for (k, map) in transforms().into_iter().enumerate() {
        let place = Transform::new(map).unwrap();
        let fitting = shapes().into_iter().filter(|shape| shape.is_measurable(&place));
        objects.extend(fitting.map(|shape| Object::new(shape).placed(place)));
        let corners = [DVec3::ZERO, DVec3::ONE, map.translation, -0.3 * DVec3::X];
        let nearest = checked(&scene(objects.clone()), &around(&corners, 2.0, 160, &mut numbers));
        let distinct: std::collections::HashSet<_> = nearest.object.iter().collect();
        assert!(distinct.len() > 4 + k, "{k}: {distinct:?}");
    }
}

#[test]
fn of_equally_near_ones_the_lower_is_first() {
    let triangle = |z: f64| [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]].map(DVec3::from);
    let points = [triangle(1.0), triangle(-1.0), triangle(1.0)].concat();
    // Fifty in one place, more than a leaf holds.
    let mut triangles = vec![[3, 4, 5], [0, 1, 2]];
    triangles.extend([[0, 1, 2]; 50]);
    triangles.push([6, 7, 8]);
    let one = mesh(&points, triangles);
    let both = scene(vec![Object::new(Arc::clone(&one)), Object::new(one)]);
    let wanted = NearestSettings { count: 104, ..NearestSettings::default() };
    for method in [Method::default(), Method::BruteForce] {
        let found = closest_points_with(method, &both, &[[0.0, 0.0, 0.0]], wanted, &()).unwrap();
        let expected: Vec<(i32, i32)> = (0..2).flat_map(|o| (0..52).map(move |p| (o, p))).collect();
        let pairs: Vec<_> = found.object.iter().copied().zip(found.primitive).collect();
        assert_eq!(pairs[..52], expected[..52]);
        assert_eq!(pairs[52], (0, 52));
        let found = closest_points_with(method, &both, &[[0.0, 0.0, 0.5]], wanted, &()).unwrap();
        // Those at -1 are farther.
        let firsts = found.primitive.iter().take(52).copied();
        assert!(firsts.eq(1..=52), "{:?}", found.primitive);
        assert_eq!(found.object[51..53], [0, 1]);
    }
    checked(&both, &around(&points, 1.0, 200, &mut Numbers::new(4)));
}

#[test]
fn a_point_has_no_more_than_there_are() {
    let ball = || Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let wanted = NearestSettings { count: 3, radius: 2.0 };
    let points = [[3.0, 0.0, 0.0], [3.0_f64.next_up(), 0.0, 0.0], [f64::NAN; 3]];
    let found = closest_points(&scene(vec![ball(), ball()]), &points, wanted, &()).unwrap();
    assert_eq!(found.object, [0, 1, -1, -1, -1, -1, -1, -1, -1]);
    assert_eq!(found.distance[..3], [2.0, 2.0, f64::INFINITY]);
    assert!(found.point[2].iter().all(|x| x.is_nan()));
    assert!(found.get(1, 0).is_none() && found.get(0, 1).is_some());
    assert_eq!((found.len(), found.count), (3, 3));
    let nothing = closest_points(&scene(vec![]), &points, wanted, &()).unwrap();
    assert!(nothing.object.iter().all(|&object| object == -1));
    let empty = Mesh::new(firsthit::Positions::compact(Vec::new()), Vec::new()).unwrap();
    checked(&scene(vec![Object::new(Arc::new(empty))]), &points);
    assert!(closest_points(&scene(vec![ball()]), &[], wanted, &()).unwrap().is_empty());
}

#[test]
fn what_makes_no_sense_is_refused() {
    let ball = scene(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap())]);
    let fails = |scene: &Scene, wanted| {
        let failed = closest_points(scene, &[[0.0; 3]], wanted, &());
        failed.unwrap_err().to_string()
    };
    let default = NearestSettings::default();
    assert_eq!(
        fails(&ball, NearestSettings { count: 0, ..default }),
        "count must be at least 1, got 0"
    );
    for radius in [-1.0, f64::NAN] {
        let expected = format!("radius must be zero or positive, got {radius}");
        assert_eq!(fails(&ball, NearestSettings { radius, ..default }), expected);
    }
    let huge = fails(&ball, NearestSettings { count: usize::MAX, ..default });
    assert!(huge.contains("over the limit"), "{huge}");
    let squeezed = Transform::new(DAffine3::from_scale(DVec3::new(1.0, 1.0, 2.0))).unwrap();
    let bar = Cylinder::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap();
    let odd = scene(vec![Object::new(bar).named("bar").placed(squeezed)]);
    assert_eq!(
        fails(&odd, default),
        "transform must be a rotation and a uniform scale where distances to a cone or a cylinder are asked, \
         got another one for object 0 (cylinder \"bar\")"
    );
}

#[test]
fn the_number_of_threads_does_not_matter_and_a_watch_ends_it() {
    struct Stopped(AtomicBool);
    impl Watch for Stopped {
        fn advance(&self, _: u64) {
            self.0.store(true, Ordering::Relaxed);
        }
        fn is_stopped(&self) -> bool {
            self.0.load(Ordering::Relaxed)
        }
    }
    let mut numbers = Numbers::new(9);
    let (points, triangles) = bumpy_sphere(12, 3);
    let ball = scene(vec![Object::new(mesh(&points, triangles))]);
    let points: Vec<[f64; 3]> = (0..5000).map(|_| numbers.point().to_array()).collect();
    let by = |threads: usize| {
        let found = || closest_points(&ball, &points, NearestSettings::default(), &()).unwrap();
        bits(&on_threads(threads, found))
    };
    assert_eq!(by(1), by(3));
    let stopped = Stopped(AtomicBool::new(false));
    let failed = closest_points(&ball, &points, NearestSettings::default(), &stopped);
    assert!(matches!(failed.unwrap_err(), Error::Interrupted));
}

/// The tree was made for another place, and objects have moved since.
#[test]
fn moved_objects_are_where_they_are() {
    let (points, triangles) = bumpy_sphere(4, 6);
    let shared = mesh(&points, triangles);
    let at = |k: f64| Transform::translation(DVec3::new(3.0 * k, 0.1, 0.0)).unwrap();
    let objects = (0..20).map(|k| Object::new(Arc::clone(&shared)).placed(at(f64::from(k))));
    let mut moving = scene(objects.collect());
    let around: Vec<[f64; 3]> = (0..60).map(|k| [f64::from(k), 2.0, 0.0]).collect();
    for k in 0..30 {
        moving.move_object(k * 7 % 20, at(-2.0 + 0.37 * k as f64)).unwrap();
        checked(&moving, &around);
    }
}
