//! The lines of shapes and of instances.

use std::sync::Arc;

use firsthit::edge::{EdgeKind, Edges};
use firsthit::{
    Cone, Cylinder, DAffine3, DVec2, DVec3, Disc, Mesh, Object, Positions, Sphere, Transform,
};

use super::{SIDE, ball, covered, cube, length, lines_of, of, only, parallel, perspective, scene};

#[test]
fn the_silhouette_of_a_ball_of_triangles_is_the_circle() {
    let silhouette = only(&[EdgeKind::Silhouette]);
    for camera in [parallel(DVec3::new(-3.0, 2.0, -1.5)), perspective(DVec3::new(5.0, -4.0, 3.0))] {
        let exact = of(Sphere::new(DVec3::ZERO, 1.0).unwrap());
        let circle = lines_of(&exact, &camera, &silhouette);
        let radius = circle.pieces()[0][0].distance(DVec2::splat(100.0));
        let is_round = |&[a, b]: &[DVec2; 2]| {
            let middle = DVec2::splat(100.0);
            (a.distance(middle) - radius).abs() < 1e-3 && (b.distance(middle) - radius).abs() < 1e-3
        };
        assert!(circle.pieces().iter().all(is_round));
        assert!((length(&circle) / (std::f64::consts::TAU * radius) - 1.0).abs() < 1e-3);
        for (rings, parts) in [(60, 120), (200, 400)] {
            let scene = of(Arc::new(ball(rings, parts)));
            let lines = lines_of(&scene, &camera, &silhouette);
            for [a, b] in lines.pieces() {
                let off = (0.5 * (*a + *b)).distance(DVec2::splat(100.0)) - radius;
                assert!(off.abs() < 1.0, "{off}");
            }
            // No gap anywhere around it.
            let covered = covered(&scene, &camera, &Edges { width: 3.0, ..silhouette });
            for k in 0..3600 {
                let (y, x) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 3600.0);
                let at = DVec2::splat(100.0) + radius * DVec2::new(x, y);
                let there = covered[at.y as usize * SIDE + at.x as usize];
                assert!(there > 0.3, "{k} {there}");
            }
        }
    }
}

#[test]
fn a_shape_has_the_lines_of_the_mesh_that_is_like_it() {
    let (bottom, top) = (DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 1.0));
    let prism = |low: f64, high: f64| {
        let parts = 720;
        let mut points = vec![bottom.to_array(), top.to_array()];
        for (z, radius) in [(-1.0, low), (1.0, high)] {
            for part in 0..parts {
                let (y, x) =
                    libm::sincos(std::f64::consts::TAU * f64::from(part) / f64::from(parts));
                points.push([radius * x, radius * y, z]);
            }
        }
        let mut triangles = Vec::new();
        for part in 0..parts {
            let [a, b] = [2 + part, 2 + (part + 1) % parts];
            let [c, d] = [a + parts, b + parts];
            triangles.extend([[a, b, d], [a, d, c], [0, b, a], [1, c, d]]);
        }
        of(Arc::new(Mesh::new(Positions::Double(points.into()), triangles).unwrap()))
    };
    let cylinder = of(Cylinder::new(bottom, top, 0.8).unwrap());
    let cone = of(Cone::new(bottom, top, 1.0, 0.3).unwrap());
    let camera = perspective(DVec3::new(4.0, -5.0, 2.5));
    for (shape, mesh) in [(cylinder, prism(0.8, 0.8)), (cone, prism(1.0, 0.3))] {
        for edges in [Edges::default(), only(&[EdgeKind::Silhouette])] {
            let [one, other] =
                [&shape, &mesh].map(|scene| length(&lines_of(scene, &camera, &edges)));
            assert!((one - other).abs() < 0.01 * other, "{one} {other}");
            let [one, other] = [&shape, &mesh].map(|scene| covered(scene, &camera, &edges));
            let off = one.iter().zip(&other).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f32::max) < 0.6);
        }
    }
    let disc = of(Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap());
    let rim = length(&lines_of(&disc, &parallel(DVec3::NEG_Z), &only(&[EdgeKind::Boundary])));
    assert!((rim - 100.0 * std::f64::consts::PI).abs() < 0.1, "{rim}");
}

#[test]
fn instances_and_mirrored_ones_have_lines_of_their_own() {
    let camera = perspective(DVec3::new(9.0, -8.0, 7.0));
    let cube = Arc::new(cube());
    let place = |x: f64, mirror: f64| {
        let map = DAffine3::from_scale(DVec3::new(0.7 * mirror, 0.7, 0.7));
        Transform::new(DAffine3::from_translation(DVec3::new(x, 0.0, 0.0)) * map).unwrap()
    };
    let object = |x, mirror| Object::new(Arc::clone(&cube)).placed(place(x, mirror));
    let cover = |objects| covered(&scene(objects), &camera, &Edges::default());
    let both = cover(vec![object(-1.5, 1.0), object(1.5, -1.0)]);
    let apart = [cover(vec![object(-1.5, 1.0)]), cover(vec![object(1.5, 1.0)])];
    let sum: f32 = apart[1].iter().sum();
    assert!(sum > 100.0);
    for (k, &both) in both.iter().enumerate() {
        let expected = apart[0][k].max(apart[1][k]);
        assert!((both - expected).abs() < 1e-6, "{k}: {both} {expected}");
    }
}
