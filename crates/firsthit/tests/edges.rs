//! Lines along edges: where they are, what hides them, and that they are the same however they are made.

#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test may panic, and its numbers are small"
)]

use std::sync::Arc;

use firsthit::camera::{Equirectangular, Viewplane};
use firsthit::channel::kind;
use firsthit::edge::{Dash, EdgeKind, EdgeKinds, Edges, Lines, Subject};
use firsthit::render::{Picture, Region};
use firsthit::sensor::RaySensor;
use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{
    Camera, Color, Cone, Cuboid, Cylinder, DAffine3, DVec2, DVec3, Disc, Lens, Material, Mesh,
    Object, Positions, Render, Scene, Shader, Side, Sphere, Transform, View, example,
};

const SIDE: usize = 200;

/// A cube from -1 to 1, each face of two triangles.
fn cube() -> Mesh {
    let corner = |k: u32| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.0 } else { -1.0 });
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let halves = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let faces = (0..12).map(|triangle| triangle / 2).collect();
    let mesh = Mesh::new(
        Positions::compact((0..8).map(corner).collect()),
        halves.collect(),
    );
    mesh.unwrap().with_faces(faces).unwrap()
}

fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
    Mesh::new(Positions::compact(points.to_vec()), triangles.to_vec()).unwrap()
}

fn scene(objects: Vec<Object>) -> Scene {
    Scene::new(objects).unwrap()
}

fn of(shape: impl Into<firsthit::Shape>) -> Scene {
    scene(vec![Object::new(shape)])
}

/// A camera that sees a square of 4 units, fifty pixels each, in parallel.
fn parallel(aim: DVec3) -> Camera {
    let viewplane = Viewplane {
        width: 4.0,
        height: 4.0,
        parallel: true,
        ray_start: firsthit::RayStart::Eye,
        ..Viewplane::default()
    };
    let view = View {
        position: -10.0 * aim.normalize(),
        aim,
        up: if aim.x == 0.0 && aim.y == 0.0 {
            DVec3::Y
        } else {
            DVec3::Z
        },
        rows: SIDE,
        columns: SIDE,
        lens: Lens::Flat(viewplane),
    };
    Camera::new(view).unwrap()
}

fn perspective(position: DVec3) -> Camera {
    Camera::look_at(position, DVec3::ZERO, DVec3::Z, 35.0, SIDE, SIDE).unwrap()
}

fn lines_of(scene: &Scene, camera: &Camera, edges: &Edges) -> Lines {
    let subject = Subject {
        scene,
        camera,
        engine: Cpu::shared(),
        cull: None,
    };
    let all = [0..camera.rows(), 0..camera.columns()];
    Lines::new(&subject, edges, all, &()).unwrap()
}

fn covered(scene: &Scene, camera: &Camera, edges: &Edges) -> Vec<f32> {
    let lines = lines_of(scene, camera, edges);
    lines
        .coverage(0..camera.rows(), 0..camera.columns())
        .unwrap()
}

/// The length of all pieces.
fn length(lines: &Lines) -> f64 {
    lines.pieces().iter().map(|[a, b]| a.distance(*b)).sum()
}

fn only(kinds: &[EdgeKind]) -> Edges {
    Edges {
        kinds: EdgeKinds::of(kinds),
        ..Edges::default()
    }
}

/// The lengths in the picture of the edges of the cube of which a face is seen.
fn seen_of_cube(camera: &Camera) -> f64 {
    let mut total = 0.0;
    for axis in 0..3 {
        for (i, j) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let ends = [-1.0, 1.0].map(|k| {
                let mut end = DVec3::splat(k);
                (end[(axis + 1) % 3], end[(axis + 2) % 3]) = (i, j);
                end
            });
            let toward = match camera.lens().viewplane() {
                Some(viewplane) if viewplane.parallel => -camera.aim(),
                _ => camera.position(),
            };
            let is_in_front = |axis: usize, side: f64| {
                let from = if camera.lens().viewplane().unwrap().parallel {
                    0.0
                } else {
                    1.0
                };
                side * toward[axis] > from
            };
            if is_in_front((axis + 1) % 3, i) || is_in_front((axis + 2) % 3, j) {
                let [a, b] = ends.map(|end| camera.project(end).unwrap());
                total += a.distance(b);
            }
        }
    }
    total
}

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
            // Pieces that end at a face's border may be seen or not: half a pixel at each end of an edge.
            let total = length(&lines);
            assert!(
                (total - expected).abs() < 12.0,
                "{shape:?} {total} {expected}"
            );
            for width in [0.5, 1.0, 3.0] {
                let edges = Edges {
                    width,
                    ..Edges::default()
                };
                let sum: f32 = covered(&of(shape.clone()), camera, &edges).iter().sum();
                // At each of the 7 corners up to three lines of this reach have ends, or lie on each other.
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
    for to in [
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::new(-1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, 1.0),
    ] {
        // But not near their ends, which others share.
        for k in 0..80 {
            let at = camera
                .project(hidden + (0.05 + 0.01 * f64::from(k)) * (to - hidden))
                .unwrap();
            crossed += usize::from(covered[at.y as usize * SIDE + at.x as usize] > 0.0);
        }
    }
    // In the picture they cross edges that are seen, three of them at most, each for some four pixels.
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
        let edges = Edges {
            hidden: Some(dash),
            ..Edges::default()
        };
        let dashed = length(&lines_of(&cube, &camera, &edges)) - seen;
        // Each of three edges may end within a dash.
        assert!(
            (dashed - hidden * on / (on + off)).abs() < 3.0 * on + 1.0,
            "{dashed} {hidden}"
        );
    }
}

/// A ball of triangles, pole to pole.
fn ball(rings: u32, parts: u32) -> Mesh {
    let mut points = Vec::new();
    for ring in 0..=rings {
        let (sine, cosine) =
            libm::sincos(std::f64::consts::PI * f64::from(ring) / f64::from(rings));
        for part in 0..parts {
            let (y, x) = libm::sincos(std::f64::consts::TAU * f64::from(part) / f64::from(parts));
            points.push([sine * x, sine * y, cosine]);
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for part in 0..parts {
            let at = |ring: u32, part: u32| ring * parts + part % parts;
            let [a, b] = [at(ring, part), at(ring, part + 1)];
            let [c, d] = [at(ring + 1, part), at(ring + 1, part + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    Mesh::new(Positions::Double(points.into()), triangles).unwrap()
}

#[test]
fn the_silhouette_of_a_ball_of_triangles_is_the_circle() {
    let silhouette = only(&[EdgeKind::Silhouette]);
    for camera in [
        parallel(DVec3::new(-3.0, 2.0, -1.5)),
        perspective(DVec3::new(5.0, -4.0, 3.0)),
    ] {
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
            let covered = covered(
                &scene,
                &camera,
                &Edges {
                    width: 3.0,
                    ..silhouette
                },
            );
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
        of(Arc::new(
            Mesh::new(Positions::Double(points.into()), triangles).unwrap(),
        ))
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
    let rim = length(&lines_of(
        &disc,
        &parallel(DVec3::NEG_Z),
        &only(&[EdgeKind::Boundary]),
    ));
    assert!((rim - 100.0 * std::f64::consts::PI).abs() < 0.1, "{rim}");
}

const SQUARE: [[f64; 3]; 4] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

#[test]
fn an_open_square_has_four_boundaries_and_a_wireframe_its_diagonal() {
    let camera = parallel(DVec3::NEG_Z);
    let square = mesh(&SQUARE, &[[0, 1, 2], [0, 2, 3]]);
    let total = |mesh: &Mesh, kinds: &[EdgeKind]| {
        length(&lines_of(
            &of(Arc::new(mesh.clone())),
            &camera,
            &only(kinds),
        ))
    };
    let diagonal = 100.0 * 2.0_f64.sqrt();
    assert!((total(&square, &[EdgeKind::Boundary]) - 400.0).abs() < 1e-6);
    assert!((total(&square, &[EdgeKind::Wireframe]) - 400.0 - diagonal).abs() < 1e-6);
    assert_eq!(
        total(&square, &[EdgeKind::Crease, EdgeKind::Silhouette]),
        0.0
    );
    // One polygon of the file has no line within.
    let polygon = square.with_faces(vec![0, 0]).unwrap();
    assert!((total(&polygon, &[EdgeKind::Wireframe]) - 400.0).abs() < 1e-6);
}

#[test]
fn a_crease_is_an_angle_of_the_normals_above_the_one_given() {
    let camera = parallel(DVec3::NEG_Z);
    let (sine, cosine) = libm::sincos(40.0_f64.to_radians());
    let points = [
        [0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [cosine, 0.0, sine],
    ];
    let roof = mesh(&points, &[[0, 1, 2], [1, 0, 3]]);
    let flipped = mesh(&points, &[[0, 1, 2], [0, 1, 3]]);
    for mesh in [roof, flipped] {
        let scene = of(Arc::new(mesh));
        for (angle, expected) in [(39.99, 100.0), (40.01, 0.0), (0.0, 100.0)] {
            let edges = Edges {
                angle,
                ..only(&[EdgeKind::Crease])
            };
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
        let edges = Edges {
            angle,
            ..only(&[EdgeKind::Crease])
        };
        assert!((length(&lines_of(&scene, &camera, &edges)) - expected).abs() < 1e-6);
    }
}

#[test]
fn a_line_is_between_materials_that_differ() {
    let camera = parallel(DVec3::NEG_Z);
    let square = mesh(&SQUARE, &[[0, 1, 2], [0, 2, 3]])
        .with_slots(vec![0, 1])
        .unwrap();
    let square = Arc::new(square);
    let total = |colors: [Color; 2]| {
        let object = Object::new(Arc::clone(&square)).with_materials(colors.map(Material::colored));
        length(&lines_of(
            &scene(vec![object]),
            &camera,
            &only(&[EdgeKind::Material]),
        ))
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
    let two = scene(vec![
        Object::new(Arc::new(large)),
        Object::new(Arc::new(small)),
    ]);
    assert!((length(&lines_of(&two, &camera, &outline)) - 600.0).abs() < 1e-6);
    let all = only(&[EdgeKind::Boundary]);
    assert!((length(&lines_of(&one, &camera, &all)) - 600.0).abs() < 1e-6);
    let ball = of(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let [whole, outline] = [only(&[EdgeKind::Silhouette]), outline]
        .map(|edges| length(&lines_of(&ball, &camera, &edges)));
    assert!(whole > 300.0 && whole == outline);
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
    let apart = [
        cover(vec![object(-1.5, 1.0)]),
        cover(vec![object(1.5, 1.0)]),
    ];
    let sum: f32 = apart[1].iter().sum();
    assert!(sum > 100.0);
    for (k, &both) in both.iter().enumerate() {
        let expected = apart[0][k].max(apart[1][k]);
        assert!((both - expected).abs() < 1e-6, "{k}: {both} {expected}");
    }
}

/// Random triangles, some of which share vertices.
fn soup() -> Scene {
    let mut state = 7_u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        f64::from((state >> 40) as u32) / f64::from(1_u32 << 24)
    };
    let points: Vec<[f64; 3]> = (0..24)
        .map(|_| [(); 3].map(|()| 2.4 * random() - 1.2))
        .collect();
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
    let edges = Edges {
        hidden: Some(Dash::default()),
        ..only(&kinds)
    };
    for camera in [
        parallel(DVec3::new(-3.0, 2.0, -1.5)),
        perspective(DVec3::new(3.0, -4.0, 2.0)),
    ] {
        let camera = camera.resize(60, 60).unwrap();
        for cull in [None, Some(Side::Front)] {
            let made = [Cpu::shared() as &dyn Engine, &BruteForce].map(|engine| {
                let subject = Subject {
                    scene: &scene,
                    camera: &camera,
                    engine,
                    cull,
                };
                let lines = Lines::new(&subject, &edges, [0..60, 0..60], &()).unwrap();
                assert!(lines.pieces().len() > 2000);
                lines.coverage(0..60, 0..60).unwrap()
            });
            assert!(made[0] == made[1]);
        }
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "one picture after the other")]
fn regions_threads_and_passes_change_no_byte() {
    let scene = example::scene().unwrap();
    let lens = Lens::Equirectangular(Equirectangular::default());
    let camera = example::camera(60, 80).unwrap();
    let around = Camera::new(View {
        lens,
        ..*camera.view()
    })
    .unwrap();
    let kinds = [
        kind("color").unwrap(),
        kind("edge").unwrap(),
        kind("z").unwrap(),
    ];
    let shade = Shader::default().on(&scene);
    let edges = Edges {
        width: 2.5,
        hidden: Some(Dash::default()),
        ..Edges::default()
    };
    for camera in [&camera, &around] {
        let picture = Picture {
            edges: Some(edges),
            samples: 2,
            ..Picture::new(&scene, camera, &shade, &kinds)
        };
        let whole = picture.render(&()).unwrap();
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let again = pool.install(|| picture.render(&()).unwrap());
            assert!(again.channels() == whole.channels());
        }
        let region = Region {
            rows: 17..43,
            columns: 5..71,
        };
        let part = Picture {
            region: Some(region),
            ..picture.clone()
        }
        .render(&())
        .unwrap();
        for (part, whole) in part.channels().iter().zip(whole.channels()) {
            let each = part.components;
            for k in 0..part.data.len() {
                let (pixel, component) = (k / each, k % each);
                let there = (17 + pixel / 66) * 80 + 5 + pixel % 66;
                let [a, b] = [
                    part.data.value(k),
                    whole.data.value(there * each + component),
                ];
                assert_eq!(a.to_bits(), b.to_bits(), "{}", part.name);
            }
        }
        let mut passes = picture.start().unwrap();
        passes.add_sample(&()).unwrap();
        passes.add_sample(&()).unwrap();
        assert!(passes.frame().unwrap().channels() == whole.channels());
    }
}

#[test]
fn lines_are_over_the_colours_and_opaque() {
    let scene = of(Arc::new(cube()));
    let camera = parallel(DVec3::new(-3.0, 2.0, -1.5));
    let edges = Edges {
        color: Color::new(1.0, 0.5, 0.0),
        width: 2.0,
        ..Edges::default()
    };
    let render = Render::new(&scene)
        .camera(camera)
        .background(firsthit::Background::Transparent)
        .channels(&["color", "edge"]);
    let plain = render.clone().frame().unwrap();
    let drawn = render.edges(edges).frame().unwrap();
    let of = |frame: &firsthit::image::Frame, name: &str, k: usize| {
        frame.channel(name).unwrap().data.value(k)
    };
    let mut outside = 0;
    for pixel in 0..SIDE * SIDE {
        let covered = of(&drawn, "edge", pixel);
        for (k, line) in [1.0, 0.5, 0.0, 1.0].into_iter().enumerate() {
            let (before, after) = (
                of(&plain, "color", 4 * pixel + k),
                of(&drawn, "color", 4 * pixel + k),
            );
            assert!((after - (1.0 - covered) * before - covered * line).abs() < 1e-6);
        }
        outside += usize::from(covered == 1.0 && of(&plain, "color", 4 * pixel + 3) < 0.5);
    }
    assert!(outside > 50, "{outside}");
    // The channel alone has lines one pixel wide.
    let sum: f64 = (0..SIDE * SIDE).map(|k| of(&plain, "edge", k)).sum();
    let expected = seen_of_cube(&parallel(DVec3::new(-3.0, 2.0, -1.5)));
    assert!((sum / expected - 1.0).abs() < 0.03, "{sum} {expected}");
}

#[test]
fn nothing_has_no_lines() {
    let empty = scene(Vec::new());
    let camera = perspective(DVec3::new(5.0, -4.0, 3.0));
    assert!(
        covered(&empty, &camera, &Edges::default())
            .iter()
            .all(|&x| x == 0.0)
    );
    let hidden = scene(vec![Object::new(Arc::new(cube())).hidden(true)]);
    assert_eq!(
        lines_of(&hidden, &camera, &Edges::default()).pieces().len(),
        0
    );
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let scene = of(Arc::new(cube()));
    let sensor = RaySensor::new(vec![DVec3::ZERO], vec![DVec3::X], [1, 1]).unwrap();
    let shade = Shader::default().on(&scene);
    let kinds = [kind("edge").unwrap()];
    let error = Picture::new(&scene, &sensor, &shade, &kinds)
        .render(&())
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "channel must be one that a sensor which is no camera has, got edge"
    );
    let colors = [kind("color").unwrap()];
    let edges = Some(Edges::default());
    let picture = Picture {
        edges,
        ..Picture::new(&scene, &sensor, &shade, &colors)
    };
    assert_eq!(
        picture.render(&()).unwrap_err().to_string(),
        "edges must be left out for a sensor that is no camera, got 1"
    );
    let camera = perspective(DVec3::new(5.0, -4.0, 3.0));
    for (edges, message) in [
        (
            Edges {
                width: 0.0,
                ..Edges::default()
            },
            "edges must be a width above 0 and up to 1000 pixels, got 0",
        ),
        (
            Edges {
                angle: 181.0,
                ..Edges::default()
            },
            "edge angle must be from 0 to 180 degrees, got 181",
        ),
        (
            Edges {
                kinds: EdgeKinds::NONE,
                ..Edges::default()
            },
            "edge kinds must be at least one, got none",
        ),
    ] {
        let error = Render::new(&scene)
            .camera(camera)
            .edges(edges)
            .frame()
            .unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}
