//! Each kind of edge is found where it is, and nowhere else.

use std::sync::Arc;

use firsthit::edge::{EdgeKind, Edges};
use firsthit::{Color, DAffine3, DVec3, Material, Mesh, Object, Sphere, Transform};

use super::{length, lines_of, mesh, of, only, parallel, scene};

const SQUARE: [[f64; 3]; 4] =
    [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

#[test]
fn an_open_square_has_four_boundaries_and_a_wireframe_its_diagonal() {
    let camera = parallel(DVec3::NEG_Z);
    let square = mesh(&SQUARE, &[[0, 1, 2], [0, 2, 3]]);
    let total = |mesh: &Mesh, kinds: &[EdgeKind]| {
        length(&lines_of(&of(Arc::new(mesh.clone())), &camera, &only(kinds)))
    };
    let diagonal = 100.0 * 2.0_f64.sqrt();
    assert!((total(&square, &[EdgeKind::Boundary]) - 400.0).abs() < 1e-6);
    assert!((total(&square, &[EdgeKind::Wireframe]) - 400.0 - diagonal).abs() < 1e-6);
    assert_eq!(total(&square, &[EdgeKind::Crease, EdgeKind::Silhouette]), 0.0);
    // One polygon of the file has no line within.
    let polygon = square.with_faces(vec![0, 0]).unwrap();
    assert!((total(&polygon, &[EdgeKind::Wireframe]) - 400.0).abs() < 1e-6);
}

#[test]
fn a_crease_is_an_angle_of_the_normals_above_the_one_given() {
    let camera = parallel(DVec3::NEG_Z);
    let (sine, cosine) = libm::sincos(40.0_f64.to_radians());
    let points = [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [cosine, 0.0, sine]];
    let roof = mesh(&points, &[[0, 1, 2], [1, 0, 3]]);
    let flipped = mesh(&points, &[[0, 1, 2], [0, 1, 3]]);
    for mesh in [roof, flipped] {
        let scene = of(Arc::new(mesh));
        for (angle, expected) in [(39.99, 100.0), (40.01, 0.0), (0.0, 100.0)] {
            let edges = Edges { angle, ..only(&[EdgeKind::Crease]) };
            let total = length(&lines_of(&scene, &camera, &edges));
            assert!((total - expected).abs() < 1e-6, "{angle} {total}");
        }
    }
    // What counts is the angle in the world: this transform makes it larger.
    let higher = Transform::new(DAffine3::from_scale(DVec3::new(1.0, 1.0, 3.0))).unwrap();
    let roof = mesh(&points, &[[0, 1, 2], [1, 0, 3]]);
    let scene = scene(vec![Object::new(Arc::new(roof)).placed(higher)]);
    let angle = libm::atan2(3.0 * sine, cosine).to_degrees();
    for (angle, expected) in [(angle - 0.01, 100.0), (angle + 0.01, 0.0)] {
        let edges = Edges { angle, ..only(&[EdgeKind::Crease]) };
        assert!((length(&lines_of(&scene, &camera, &edges)) - expected).abs() < 1e-6);
    }
}

#[test]
fn a_line_is_between_materials_that_differ() {
    let camera = parallel(DVec3::NEG_Z);
    let square = mesh(&SQUARE, &[[0, 1, 2], [0, 2, 3]]).with_slots(vec![0, 1]).unwrap();
    let square = Arc::new(square);
    let total = |colors: [Color; 2]| {
        let object = Object::new(Arc::clone(&square)).with_materials(colors.map(Material::colored));
        length(&lines_of(&scene(vec![object]), &camera, &only(&[EdgeKind::Material])))
    };
    let diagonal = 100.0 * 2.0_f64.sqrt();
    assert!((total([Color::X, Color::Y]) - diagonal).abs() < 1e-6);
    assert_eq!(total([Color::X, Color::X]), 0.0);
}

/// A small square before a large one of the same object, and before one of another.
#[test]
fn an_outline_is_where_another_object_is_behind() {
    let camera = parallel(DVec3::NEG_Z);
    let small = SQUARE.map(|[x, y, _]| [0.5 * x, 0.5 * y, 1.0]);
    let quads = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let both = mesh(&[SQUARE, small].concat(), &quads);
    let [large, small] = [SQUARE, small].map(|points| mesh(&points, &quads[..2]));
    let outline = only(&[EdgeKind::Object]);
    let one = of(Arc::new(both));
    assert!((length(&lines_of(&one, &camera, &outline)) - 400.0).abs() < 1e-6);
    let two = scene(vec![Object::new(Arc::new(large)), Object::new(Arc::new(small))]);
    assert!((length(&lines_of(&two, &camera, &outline)) - 600.0).abs() < 1e-6);
    let all = only(&[EdgeKind::Boundary]);
    assert!((length(&lines_of(&one, &camera, &all)) - 600.0).abs() < 1e-6);
    let ball = of(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let [whole, outline] = [only(&[EdgeKind::Silhouette]), outline]
        .map(|edges| length(&lines_of(&ball, &camera, &edges)));
    assert!(whole > 300.0 && whole == outline);
}
