//! Which edges are visible, and which are occluded.

use std::sync::Arc;

use firsthit::edge::{Dash, EdgeKind, Edges, Lines, Subject};
use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{Cuboid, DAffine3, DVec3, Mesh, Object, Positions, Scene, Side, Sphere, Transform};

use super::{
    SIDE, covered, cube, length, lines_of, of, only, parallel, perspective, scene, seen_of_cube,
};

#[test]
fn a_cube_shows_the_edges_of_the_faces_that_are_seen() {
    let cameras = [
        parallel(DVec3::new(-3.0, 2.0, -1.5)),
        parallel(DVec3::new(-1.0, -1.0, -1.0)),
        parallel(DVec3::new(0.0, 1.0, -0.4)),
        perspective(DVec3::new(5.0, -4.0, 3.0)),
        perspective(DVec3::new(0.3, -7.0, 0.2)),
    ];
    for camera in &cameras {
        let expected = seen_of_cube(camera);
        for shape in [
            firsthit::Shape::from(Arc::new(cube())),
            Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap().into(),
        ] {
            let lines = lines_of(&of(shape.clone()), camera, &Edges::default());
            // Pieces that end at a face's border may be seen or not: half a pixel at each end of an
            // edge.
            let total = length(&lines);
            assert!((total - expected).abs() < 12.0, "{shape:?} {total} {expected}");
            for width in [0.5, 1.0, 3.0] {
                let edges = Edges { width, ..Edges::default() };
                let sum: f32 = covered(&of(shape.clone()), camera, &edges).iter().sum();
                // At each of the 7 corners up to three lines of this reach have ends, or lie on
                // each other.
                let ends = 7.0 * 0.5 * (width + 1.0) * (width + 1.0);
                let off = f64::from(sum) - expected * width;
                assert!(off.abs() < ends + 0.01 * expected * width, "{width} {off}");
            }
        }
    }
}

/// In the three-quarter view nine edges are seen, and where the others are there is nothing.
#[test]
fn hidden_edges_of_a_cube_do_not_shine_through() {
    let camera = parallel(DVec3::new(-3.0, 2.0, -1.5));
    let covered = covered(&of(Arc::new(cube())), &camera, &Edges::default());
    let hidden = DVec3::new(-1.0, 1.0, -1.0);
    let mut crossed = 0;
    for to in [DVec3::new(1.0, 1.0, -1.0), DVec3::new(-1.0, -1.0, -1.0), DVec3::new(-1.0, 1.0, 1.0)]
    {
        // But not near their ends, which others share.
        for k in 0..80 {
            let at = camera.project(hidden + (0.05 + 0.01 * f64::from(k)) * (to - hidden)).unwrap();
            crossed += usize::from(covered[at.y as usize * SIDE + at.x as usize] > 0.0);
        }
    }
    // In the picture they cross edges that are seen, three of them at most, each for some four
    // pixels.
    assert!(crossed < 24, "{crossed}");
}

#[test]
fn hidden_edges_are_dashed_when_that_is_asked_for() {
    let camera = parallel(DVec3::new(-3.0, 2.0, -1.5));
    let cube = of(Arc::new(cube()));
    let seen = length(&lines_of(&cube, &camera, &Edges::default()));
    let ends = |edge: [DVec3; 2]| edge.map(|end| camera.project(end).unwrap());
    let corner = DVec3::new(-1.0, 1.0, -1.0);
    let hidden: f64 = [DVec3::X, DVec3::NEG_Y, DVec3::Z]
        .map(|way| ends([corner, corner + 2.0 * way]))
        .map(|[a, b]| a.distance(b))
        .iter()
        .sum();
    for (on, off) in [(3.0, 1.0), (2.0, 5.0)] {
        let dash = Dash { on, off };
        let edges = Edges { hidden: Some(dash), ..Edges::default() };
        let dashed = length(&lines_of(&cube, &camera, &edges)) - seen;
        // Each of three edges may end within a dash.
        assert!((dashed - hidden * on / (on + off)).abs() < 3.0 * on + 1.0, "{dashed} {hidden}");
    }
}

/// Random triangles, some of which share vertices.
fn soup() -> Scene {
    let mut state = 7_u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((state >> 40) as u32) / f64::from(1_u32 << 24)
    };
    let points: Vec<[f64; 3]> = (0..24).map(|_| [(); 3].map(|()| 2.4 * random() - 1.2)).collect();
    let mut corner = || (24.0 * random()) as u32;
    let triangles = (0..24).map(|_| [(); 3].map(|()| corner())).collect();
    let mesh = Arc::new(Mesh::new(Positions::Double(points.into()), triangles).unwrap());
    let turned = DAffine3::from_rotation_x(0.7) * DAffine3::from_scale(DVec3::splat(0.8));
    let ball = Object::new(Sphere::new(DVec3::new(0.3, -0.2, 0.4), 0.5).unwrap());
    scene(vec![
        Object::new(Arc::clone(&mesh)),
        Object::new(mesh).placed(Transform::new(turned).unwrap()),
        ball,
    ])
}

#[test]
fn brute_force_sees_the_same() {
    let (scene, kinds) = (soup(), [EdgeKind::Wireframe, EdgeKind::Silhouette]);
    let edges = Edges { hidden: Some(Dash::default()), ..only(&kinds) };
    for camera in [parallel(DVec3::new(-3.0, 2.0, -1.5)), perspective(DVec3::new(3.0, -4.0, 2.0))] {
        let camera = camera.resize(60, 60).unwrap();
        for cull in [None, Some(Side::Front)] {
            let made = [Cpu::shared() as &dyn Engine, &BruteForce].map(|engine| {
                let subject = Subject { scene: &scene, camera: &camera, engine, cull };
                let lines = Lines::new(&subject, &edges, [0..60, 0..60], &()).unwrap();
                assert!(lines.pieces().len() > 2000);
                lines.coverage(0..60, 0..60, &()).unwrap()
            });
            assert!(made[0] == made[1]);
        }
    }
}

#[test]
fn nothing_has_no_lines() {
    let empty = scene(Vec::new());
    let camera = perspective(DVec3::new(5.0, -4.0, 3.0));
    assert!(covered(&empty, &camera, &Edges::default()).iter().all(|&x| x == 0.0));
    let hidden = scene(vec![Object::new(Arc::new(cube())).hidden(true)]);
    assert_eq!(lines_of(&hidden, &camera, &Edges::default()).pieces().len(), 0);
}
