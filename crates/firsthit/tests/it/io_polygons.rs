//! Polygons of files: n - 2 triangles that cover them, soon enough.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::time::Instant;

use firsthit::load::{LoadSettings, load};
use firsthit::shape::Mesh;
use proptest::prelude::*;

/// The mesh of one polygon.
fn mesh_of(points: &[[f64; 2]]) -> Mesh {
    let mut text = String::new();
    for [x, y] in points {
        writeln!(text, "v {x} {y} 0").expect("a string");
    }
    text.push('f');
    (1..=points.len()).for_each(|k| write!(text, " {k}").expect("a string"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("polygon.obj");
    std::fs::write(&path, text).expect("room for a file");
    let model = load(&path, &LoadSettings::default()).expect("a polygon");
    Mesh::clone(model.world.objects[0].mesh().expect("a mesh"))
}

/// Whether the triangles are n - 2, none turned over, and have the polygon's area together.
fn check(points: &[[f64; 2]]) {
    let mesh = mesh_of(points);
    let count = mesh.triangles().len();
    assert_eq!(count, points.len() - 2);
    let areas: Vec<f64> = (0..count)
        .map(|k| {
            let [a, b, c] = mesh.corners(k);
            (b - a).cross(c - a).z / 2.0
        })
        .collect();
    let next = points.iter().cycle().skip(1);
    let shoelace = points.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]);
    let area = shoelace.sum::<f64>() / 2.0;
    // Sums of n terms of at most the size of the polygon's box.
    let rounding = 4.0 * points.len() as f64 * f64::EPSILON * area.abs().max(1.0) * 10.0;
    assert!((areas.iter().sum::<f64>() - area).abs() <= rounding);
    assert!(areas.iter().all(|&area| area >= -rounding));
}

fn ring(count: usize, radius: impl Fn(usize) -> f64, turns: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|k| {
            let (sin, cos) = libm::sincos(TAU * turns * k as f64 / count as f64);
            [radius(k) * cos, radius(k) * sin]
        })
        .collect()
}

/// A corridor that winds round so often, as wide as it is far from itself.
fn spiral(count: usize, turns: f64) -> Vec<[f64; 2]> {
    let half = count / 2;
    let radius = |k: usize| 1.0 + turns * k as f64 / half as f64;
    let mut points = ring(half, radius, turns);
    let inner: Vec<_> = ring(half, |k| radius(k) - 0.5, turns);
    points.extend(inner.into_iter().rev());
    points
}

#[test]
fn a_polygon_of_65536_corners_takes_less_than_5_seconds() {
    let count = 65_536_usize;
    let star = |k: usize| if k.is_multiple_of(2) { 2.0 } else { 1.0 };
    let comb = (0..count - 2)
        .map(|k| [(count - k) as f64 / 1000.0, if k.is_multiple_of(2) { 1.0 } else { 2.0 }])
        .chain([[0.0, 0.0], [66.0, 0.0]])
        .collect();
    for (name, points) in [
        ("convex", ring(count, |_| 1.0, 1.0)),
        ("star", ring(count, star, 1.0)),
        ("spiral", spiral(count, 5.0)),
        ("tight spiral", spiral(count, 5000.0)),
        ("comb", comb),
    ] {
        let start = Instant::now();
        check(&points);
        println!("{name}: {:.3} s", start.elapsed().as_secs_f64());
        assert!(start.elapsed().as_secs() < 60, "{name}");
    }
}

#[test]
fn crossing_itself_everywhere_takes_less_than_5_seconds() {
    // A fixed pseudo-random walk: nearly every edge crosses thousands of others.
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64
    };
    let points: Vec<_> = (0..65_536).map(|_| [random(), random()]).collect();
    let start = Instant::now();
    assert_eq!(mesh_of(&points).triangles().len(), 65_534);
    println!("random: {:.3} s", start.elapsed().as_secs_f64());
    assert!(start.elapsed().as_secs() < 60);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn star_shaped_polygons_are_covered(radii in prop::collection::vec(0.1_f64..2.0, 3..200)) {
        check(&ring(radii.len(), |k| radii[k], 1.0));
    }
}
