//! Distances with a sign.

use std::sync::Arc;

use firsthit::measure::{FillRule, Grouping, Rule, inside};
use firsthit::nearest::{Method, NearestSettings, SignSettings, closest_point, closest_points};
use firsthit::nearest::{signed_distances, signed_distances_from, signed_distances_with};
use firsthit::{
    AlphaMode, Color, Cuboid, Cylinder, DQuat, DVec3, Disc, Object, Plane, Sphere, Transform,
};
use firsthit::{DAffine3, Material, Mesh};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use crate::support::rational::{Exact, cross, dot, exact, minus};
use crate::support::{Numbers, bumpy_sphere, cases, mesh, scene};

const BY_FORCE: SignSettings =
    SignSettings { rule: FillRule::Nonzero, allow_open: false, method: Method::BruteForce };

/// Whether a point is inside a mesh that is star-shaped around the origin, whose triangles look
/// outwards: in the cone over the triangle that the way outwards meets, it is on the inner side.
fn is_inside_star(mesh: &Mesh, point: &Exact) -> bool {
    let zero = BigRational::zero();
    (0..mesh.triangles().len()).any(|triangle| {
        let [a, b, c] = mesh.corners(triangle).map(exact);
        let sides = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| dot(&cross(p, q), point));
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let height = dot(&normal, &minus(point, &a));
        sides.iter().all(|side| *side >= zero) && height.is_negative()
    })
}

#[test]
fn the_sign_is_exact_next_to_the_surface() {
    let mut numbers = Numbers::new(3);
    let (points, triangles) = bumpy_sphere(5, 2);
    let shape = mesh(&points, triangles.clone());
    let ball = scene(vec![Object::new(Arc::clone(&shape))]);
    let mut asked = Vec::new();
    for k in 0..cases(1500) {
        let [a, b, c] = triangles[numbers.below(triangles.len())].map(|k| points[k as usize]);
        let on = match k % 4 {
            0 => a,
            1 => a.lerp(b, numbers.unit()),
            2 => a.lerp(b, numbers.unit()).lerp(c, numbers.unit()),
            _ => 0.8 * numbers.point(),
        };
        let off = [0.0, 1e-16, 1e-15, 1e-9, 0.1][k / 4 % 5];
        asked.push((on + off * numbers.point()).to_array());
    }
    let signed = signed_distances(&ball, &asked, &()).unwrap();
    let judged = signed_distances_with(BY_FORCE, &ball, &asked, &()).unwrap();
    let mut counts = [0; 3];
    for (k, &point) in asked.iter().enumerate() {
        let distance = signed[k];
        assert_eq!(distance.to_bits(), judged[k].to_bits());
        let nearest = closest_point(&ball, point.into()).unwrap().unwrap();
        assert_eq!(nearest.distance, distance.abs());
        let is_inside = is_inside_star(&shape, &exact(point.into()));
        if distance == 0.0 {
            assert!(distance.is_sign_positive());
            counts[0] += 1;
        } else {
            assert_eq!(distance < 0.0, is_inside, "{point:?}: {distance}");
            counts[1 + usize::from(is_inside)] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > cases(50)), "{counts:?}");
}

/// Where solids overlap a point is inside, although it crosses an even number of surfaces.
#[test]
fn the_inside_of_several_is_that_of_any() {
    let ball = |x: f64, radius| Object::new(Sphere::new(DVec3::X * x, radius).unwrap());
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::new(2.0, 1.0, 1.0),
        DQuat::from_rotation_z(1.0),
        DVec3::new(0.0, 20.0, 0.0),
    );
    let cuboid = Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap();
    let cuboid = Object::new(cuboid).placed(Transform::new(turned).unwrap());
    let bar = Cylinder::new(DVec3::new(0.0, -9.0, 0.0), DVec3::new(0.0, -7.0, 0.0), 0.5).unwrap();
    let scene = scene(vec![ball(0.0, 1.0), ball(0.5, 1.0), cuboid, Object::new(bar)]);
    let points = [
        [0.25, 0.0, 0.0],
        [-0.75, 0.0, 0.0],
        [3.0, 0.0, 0.0],
        [0.0, 20.0, 0.0],
        [0.0, -8.0, 0.25],
        [0.0, -8.0, 0.75],
    ];
    let signed = signed_distances(&scene, &points, &()).unwrap();
    let expected = [-0.75, -0.25, 1.5, -1.0, -0.25, 0.25];
    for (signed, expected) in signed.iter().zip(expected) {
        assert!((signed - expected).abs() < 1e-14, "{signed} {expected}");
    }
    assert_eq!(signed_distances(&scene, &[[f64::NAN; 3]], &()).unwrap(), [f64::INFINITY]);
}

#[test]
fn what_has_no_inside_is_refused() {
    let (points, mut triangles) = bumpy_sphere(3, 2);
    triangles.pop();
    let open = Object::new(mesh(&points, triangles)).named("lid off");
    let plane = Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap());
    let disc = Object::new(Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap());
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let (points, triangles) = bumpy_sphere(3, 2);
    let see_through = Material {
        alpha: 0.5,
        alpha_mode: AlphaMode::Mask { cutoff: 0.6 },
        ..Material::colored(Color::ONE)
    };
    let cut_out = Object::new(mesh(&points, triangles)).with_materials([see_through]);
    for (object, what) in [
        (open, "mesh \"lid off\"), of which 3 edges belong to an odd number of triangles"),
        (cut_out, "mesh \"\"), parts of which its material cuts out"),
        (plane, "plane \"\")"),
        (disc, "disc \"\")"),
    ] {
        let scene = scene(vec![ball.clone(), object]);
        let error = signed_distances(&scene, &[[0.0; 3]], &()).unwrap_err();
        let expected = format!(
            "objects must be closed where signed distances are asked, got an open one: object 1 ({what}"
        );
        assert_eq!(error.to_string(), expected);
    }
}

/// One made all signed distances of a scene impossible.
#[test]
fn an_empty_mesh_has_no_inside_and_is_not_open() {
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let holes = Material {
        alpha: 0.5,
        alpha_mode: AlphaMode::Mask { cutoff: 0.6 },
        ..Material::colored(Color::ONE)
    };
    let empty = Object::new(mesh(&[], Vec::new())).with_materials([holes]);
    assert!(empty.shape().is_closed());
    assert_eq!(Rule::of(&empty, FillRule::default()).unwrap(), Rule::Nonzero);
    let points = [[0.0, 0.0, 0.25], [0.0, 3.0, 0.0]];
    let signed = signed_distances(&scene(vec![empty.clone(), ball]), &points, &());
    assert_eq!(signed.unwrap(), [-0.75, 2.0]);
    let nothing = scene(vec![empty]);
    assert_eq!(signed_distances(&nothing, &points, &()).unwrap(), [f64::INFINITY; 2]);
    let is_inside = inside(&nothing, &[DVec3::ZERO], Grouping::Union, &()).unwrap();
    assert_eq!(is_inside.is_inside, [false]);
}

#[test]
fn signs_of_known_distances_are_those_of_a_search() {
    let (points, triangles) = bumpy_sphere(5, 2);
    let ball = scene(vec![Object::new(mesh(&points, triangles))]);
    let mut numbers = Numbers::new(11);
    let asked: Vec<_> = (0..600).map(|_| numbers.point().to_array()).collect();
    let nearest = closest_points(&ball, &asked, NearestSettings::default(), &()).unwrap();
    let signed =
        signed_distances_from(SignSettings::default(), &ball, &asked, &nearest.distance, &())
            .unwrap();
    assert_eq!(signed, signed_distances(&ball, &asked, &()).unwrap());
    assert!(signed.iter().any(|&x| x < 0.0) && signed.iter().any(|&x| x > 0.0));
    let error =
        signed_distances_from(SignSettings::default(), &ball, &asked, &nearest.distance[1..], &())
            .unwrap_err();
    assert_eq!(error.to_string(), "distances must be one for each point, got 599");
}
