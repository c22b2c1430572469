//! Defects of meshes: known ones in closed forms, and rational arithmetic for triangles that meet.

use std::sync::Arc;

use firsthit::lint::{Finding, FindingKind, KINDS, LintSettings, Report, lint, save_marked};
use firsthit::watch::Watch;
use firsthit::{DAffine3, DVec3, Error, Mesh, Object, Positions, Scene, Sphere, Transform};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use crate::support::rational::{Exact, cross, dot, exact, minus};
use crate::support::{Ask, Numbers, bumpy_sphere, cases, is_full, mesh, on_threads, scene};

const POINTS: [DVec3; 4] =
    [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, 0.0, 2.0)];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn one(points: &[DVec3], triangles: Vec<[u32; 3]>) -> Scene {
    scene(vec![Object::new(mesh(points, triangles))])
}

/// Names, counts and notes.
fn said(report: &Report) -> Vec<(&'static str, u64, &str)> {
    let words = |finding: &Finding| (finding.kind.name, finding.count);
    let findings = report.findings().iter();
    findings.map(|f| (words(f).0, words(f).1, &*f.note)).collect()
}

#[track_caller]
fn check(scene: &Scene, wanted: &[(&'static str, u64, &str)]) -> Report {
    let report = scene.lint().unwrap();
    assert_eq!(said(&report), wanted);
    assert_eq!(report.is_clean(), wanted.is_empty());
    report
}

#[test]
fn closed_meshes_are_clean() {
    check(&one(&POINTS, FACES.to_vec()), &[]);
    for seed in 0..3 {
        let (points, triangles) = bumpy_sphere(14, seed);
        check(&one(&points, triangles.clone()), &[]);
        // With vertices of their own, as in STL files.
        let own: Vec<DVec3> = triangles.iter().flatten().map(|&k| points[k as usize]).collect();
        let alone = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        check(&one(&own, alone.collect()), &[]);
    }
    check(&scene(Vec::new()), &[]);
    check(&scene(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap())]), &[]);
}

#[test]
fn holes_are_counted_by_edges_and_components() {
    let report = check(&one(&POINTS, FACES[..3].to_vec()), &[("hole", 3, "around 1 hole")]);
    let places = &report.findings()[0].places;
    let middles: Vec<DVec3> = places.iter().map(|place| place.position).collect();
    assert_eq!(middles, [DVec3::Y, DVec3::Z, DVec3::new(0.0, 1.0, 1.0)]);
    let (points, mut triangles) = bumpy_sphere(14, 1);
    // Far apart.
    triangles.remove(300);
    triangles.remove(30);
    check(&one(&points, triangles), &[("hole", 6, "around 2 holes")]);
}

#[test]
fn a_surface_in_several_objects_has_no_hole_between_them() {
    let positions = Arc::new(Positions::compact(POINTS.map(|p| p.to_array()).to_vec()));
    let part = |faces: &[[u32; 3]]| {
        Object::new(Arc::new(Mesh::new(Arc::clone(&positions), faces.to_vec()).unwrap()))
    };
    check(&scene(vec![part(&FACES[..1]), part(&FACES[1..])]), &[]);
    let apart = scene(vec![
        part(&FACES[..1]),
        part(&FACES[1..]).placed(Transform::translation(DVec3::X).unwrap()),
    ]);
    check(&apart, &[("hole", 6, "around 2 holes")]);
}

#[test]
fn two_places_of_one_mesh_close_each_other() {
    let half = Arc::new(Mesh::new(Positions::compact(SQUARE.to_vec()), ROOF.to_vec()).unwrap());
    let mirrored = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let below = Object::new(Arc::clone(&half)).placed(Transform::new(mirrored).unwrap());
    check(&scene(vec![Object::new(Arc::clone(&half)), below]), &[]);
    let apart = Transform::translation(DVec3::Z).unwrap();
    let above = Object::new(Arc::clone(&half)).placed(apart);
    check(&scene(vec![Object::new(half), above]), &[("hole", 4, "around 1 hole")]);
}

/// Each border meets that of the copy in its place, which was taken for the other side of the edge.
#[test]
fn an_open_mesh_that_is_there_twice_is_open() {
    let open = Arc::new(Mesh::new(Positions::compact(SQUARE.to_vec()), ROOF.to_vec()).unwrap());
    let again = Arc::new(Mesh::clone(&open));
    let up = Transform::translation(DVec3::Z).unwrap();
    let object = |mesh: &Arc<Mesh>| Object::new(Arc::clone(mesh)).placed(up);
    let hole = ("hole", 4, "around 1 hole");
    check(&scene(vec![object(&open), object(&open)]), &[hole]);
    check(&scene(vec![object(&open); 3]), &[hole]);
    // Not the same mesh, but the same faces.
    let copies = scene(vec![object(&open), object(&again)]);
    check(&copies, &[("hole", 8, "around 2 holes")]);
    // The same faces the other way round are its inner side: the two are closed.
    let inner = ROOF.map(|[a, b, c]| [a, c, b]).to_vec();
    let inner = Arc::new(Mesh::new(Arc::clone(open.positions()), inner).unwrap());
    check(&scene(vec![object(&open), object(&inner)]), &[]);
    // What closes one of two copies closes both.
    let mirrored =
        DAffine3::from_translation(DVec3::Z) * DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let below = Object::new(Arc::clone(&open)).placed(Transform::new(mirrored).unwrap());
    check(&scene(vec![object(&open), object(&open), below]), &[]);
}

/// Only the first of the objects was looked at.
#[test]
fn a_hole_in_the_second_place_of_a_mesh_is_told() {
    let roof = Arc::new(Mesh::new(Positions::compact(SQUARE.to_vec()), ROOF.to_vec()).unwrap());
    let floor = vec![[0, 2, 1], [0, 3, 2]];
    let floor =
        Object::new(Arc::new(Mesh::new(Positions::compact(SQUARE.to_vec()), floor).unwrap()));
    let away = Transform::translation(DVec3::X * 9.0).unwrap();
    let second = Object::new(Arc::clone(&roof)).placed(away);
    let both = scene(vec![floor.clone(), Object::new(roof), second]);
    let report = check(&both, &[("hole", 4, "around 1 hole"), ("unreferenced", 1, "")]);
    let places = &report.findings()[0].places;
    assert!(places.iter().all(|place| place.object == Some(2)));
    assert_eq!(places[0].position, DVec3::new(10.0, 0.0, 0.0));
    assert!(report.marked(1).unwrap().all(|kind| kind.is_some()));
    assert!(report.marked(3).is_none());
}

#[test]
fn holes_with_a_common_vertex_are_one() {
    // Two triangles that touch at a corner.
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y];
    let bow = one(&points, vec![[0, 1, 2], [0, 3, 4]]);
    check(&bow, &[("hole", 6, "around 1 hole")]);
}

/// The file had fewer faces than its header said.
#[test]
fn marked_faces_by_the_report_of_another_scene_are_refused() {
    let tetrahedron = || mesh(&POINTS, FACES.to_vec());
    let shared = tetrahedron();
    let twice = scene(vec![
        Object::new(Arc::clone(&shared)),
        Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
        Object::new(Arc::clone(&shared)),
    ]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("marked.ply");
    let others = [
        scene(Vec::new()),
        scene(vec![Object::new(Arc::clone(&shared)); 2]),
        scene(vec![Object::new(shared); 3]),
        scene(vec![
            Object::new(mesh(&POINTS, FACES[1..].to_vec())),
            Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
            Object::new(tetrahedron()),
        ]),
    ];
    for other in others {
        let error = save_marked(&twice, &other.lint().unwrap(), &path, &()).unwrap_err();
        let expected = "report must be that of the scene, got one about ";
        assert!(error.to_string().starts_with(expected), "{error}");
        assert!(!path.exists());
    }
    save_marked(&twice, &twice.lint().unwrap(), &path, &()).unwrap();
    let file = std::fs::read(&path).unwrap();
    let end = b"end_header\n";
    let header = file.windows(end.len()).position(|part| part == end);
    // Vertices of 24 bytes, faces of 16.
    assert_eq!(file.len() - header.unwrap() - end.len(), 8 * 24 + 8 * 16);
}

/// A square, the tip of a roof over it, and the roof.
const SQUARE: [[f64; 3]; 5] =
    [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 1.0]];
const ROOF: [[u32; 3]; 4] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];

#[test]
fn places_are_in_the_world() {
    let mut points = POINTS.map(|p| p.to_array()).to_vec();
    points.push([1.0, 2.0, 3.0]);
    let mesh = Arc::new(Mesh::new(Positions::compact(points), FACES[1..].to_vec()).unwrap());
    let up = Transform::translation(DVec3::new(0.0, 0.0, 10.0)).unwrap();
    let report = lint(&scene(vec![Object::new(mesh).placed(up)]), &LintSettings::default(), &());
    let report = report.unwrap();
    let of = |name: &str| report.findings().iter().find(|finding| finding.kind.name == name);
    let unused = of("unreferenced").unwrap().places[0].position;
    assert_eq!(unused, DVec3::new(1.0, 2.0, 13.0));
    assert!(of("hole").unwrap().places.iter().all(|place| place.position.z >= 10.0));
}

#[test]
fn a_flipped_face_disagrees_at_all_its_edges() {
    let mut faces = FACES.to_vec();
    faces[2].swap(0, 1);
    check(&one(&POINTS, faces), &[("winding", 3, "")]);
}

#[test]
fn a_closed_mesh_is_inside_out_by_the_exact_sign_of_its_volume() {
    let flipped: Vec<[u32; 3]> = FACES.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let report = check(&one(&POINTS, flipped.clone()), &[("inside-out", 1, "")]);
    assert!(report.marked(0).unwrap().all(|kind| kind.unwrap().name == "inside-out"));
    // Thinner than any rounding, and far away.
    for flip in [false, true] {
        let thin = [
            DVec3::new(1e8, 1.0, 1.0),
            DVec3::new(1e8, 2.0, 1.0),
            DVec3::new(1e8, 1.0, 2.0),
            DVec3::new(1e8_f64.next_up(), 1.0, 1.0),
        ];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let faces = faces.map(|[a, b, c]| if flip { [a, c, b] } else { [a, b, c] });
        let wanted: &[(&str, u64, &str)] = if flip { &[("inside-out", 1, "")] } else { &[] };
        check(&one(&thin, faces.to_vec()), wanted);
    }
    // A cavity is no mistake; beside the solid it is one.
    for (offset, is_cavity) in [(DVec3::splat(0.2), true), (DVec3::splat(3.0), false)] {
        let mut points = POINTS.map(|p| 10.0 * p - 1.0).to_vec();
        points.extend(POINTS.map(|p| p + 15.0 * (offset - 0.2)));
        let mut faces = FACES.to_vec();
        faces.extend(flipped.iter().map(|face| face.map(|k| k + 4)));
        let wanted: &[(&str, u64, &str)] = if is_cavity { &[] } else { &[("inside-out", 1, "")] };
        check(&one(&points, faces), wanted);
    }
}

#[test]
fn shells_that_overlap_are_told_and_cavities_are_none() {
    let large = |p: DVec3| 10.0 * p - 1.0;
    let small = |p: DVec3| p + 1.0;
    let smallest = |p: DVec3| 0.25 * p + 1.1;
    let shells = |way: &[(&dyn Fn(DVec3) -> DVec3, bool)]| {
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for &(place, is_flipped) in way {
            let first = points.len() as u32;
            points.extend(POINTS.map(place));
            faces.extend(FACES.map(|[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|k| k + first);
                if is_flipped { [a, c, b] } else { [a, b, c] }
            }));
        }
        one(&points, faces)
    };
    let inside_out = ("inside-out", 1, "");
    // A cavity, one that faces outwards, a solid in a cavity, and the same inside out.
    check(&shells(&[(&large, false), (&small, true)]), &[]);
    check(&shells(&[(&large, false), (&small, false)]), &[("overlap", 1, "")]);
    let island = [(&large as &dyn Fn(_) -> _, false), (&small, true), (&smallest, false)];
    check(&shells(&island), &[]);
    let twice = [("inside-out", 2, ""), ("overlap", 1, "")];
    check(&shells(&[(&large, true), (&small, true)]), &twice);
    check(&shells(&[(&large, true), (&small, false)]), &[inside_out]);
    // Side by side, box in box and none in the other.
    let beside = |p: DVec3| p + DVec3::new(7.0, 7.0, 7.0);
    check(&shells(&[(&large, false), (&beside, false)]), &[]);
}

#[test]
fn degenerate_and_duplicate_faces_are_told_apart() {
    let mut points = POINTS.to_vec();
    // On the edge from 0 to 1, and a copy of 1.
    points.extend([DVec3::X, points[1]]);
    let mut faces = FACES.to_vec();
    faces.extend([[2, 1, 0], [1, 0, 2], [4, 4, 2], [5, 1, 2]]);
    let wanted = [("duplicate", 2, ""), ("degenerate", 2, "")];
    check(&one(&points, faces), &wanted);
    // A copy the other way round is a face of its own at the edges.
    let mut faces = FACES.to_vec();
    faces.push([0, 1, 2]);
    check(&one(&POINTS, faces), &[("non-manifold", 3, ""), ("duplicate", 1, "")]);
    let thin = one(&[DVec3::ZERO, DVec3::X, DVec3::X * 3.0], vec![[0, 1, 2]]);
    assert_eq!(said(&thin.lint().unwrap())[0], ("degenerate", 1, ""));
    let tiny = [DVec3::ZERO, DVec3::X, DVec3::new(3.0, 1e-300, 0.0)];
    let report = one(&tiny, vec![[0, 1, 2]]).lint().unwrap();
    assert!(report.findings().iter().all(|finding| finding.kind.name != "degenerate"));
}

#[test]
fn an_edge_of_four_faces_is_non_manifold() {
    let mut points = POINTS.to_vec();
    points.extend([DVec3::new(0.0, -2.0, 0.0), DVec3::new(0.0, 0.0, -2.0)]);
    let mut faces = FACES.to_vec();
    faces.extend([[0, 4, 1], [0, 1, 5], [1, 4, 5], [4, 0, 5]]);
    check(&one(&points, faces), &[("non-manifold", 1, "")]);
}

#[test]
fn crossing_solids_in_one_mesh_intersect_themselves() {
    let mut points = POINTS.to_vec();
    points.extend(POINTS.map(|p| p + 0.25));
    let mut faces = FACES.to_vec();
    faces.extend(FACES.map(|face| face.map(|k| k + 4)));
    let report = one(&points, faces).lint().unwrap();
    // The slanted face of the first goes through three faces of the second.
    let wanted = [("self-intersection", 4, ""), ("overlap", 2, "")];
    assert_eq!(said(&report), wanted);
    // A flap folded onto its neighbour.
    let fold = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.3, 0.3, 0.0)];
    let report = one(&fold, vec![[0, 1, 2], [0, 3, 1]]).lint().unwrap();
    assert_eq!(said(&report)[0], ("self-intersection", 2, ""));
}

#[test]
fn vertices_of_no_face_and_vertices_that_are_nowhere_are_counted_once() {
    let mut points = POINTS.to_vec();
    points.extend([DVec3::NAN, DVec3::ONE, DVec3::new(1.0, f64::INFINITY, 0.0)]);
    let positions = Positions::Double(points.iter().map(DVec3::to_array).collect());
    let shared = Arc::new(Mesh::new(positions, FACES.to_vec()).unwrap());
    let twice = scene(vec![Object::new(Arc::clone(&shared)), Object::new(shared)]);
    let report = check(&twice, &[("non-finite", 2, ""), ("unreferenced", 3, "")]);
    assert!(report.findings()[0].places[0].position.is_nan());
}

#[test]
fn digits_lost_to_an_offset_and_unlikely_sizes_are_told() {
    let at = |offset: f64, scale: f64| {
        one(&POINTS.map(|p| p * scale + DVec3::splat(offset)), FACES.to_vec())
    };
    // At 500,000 float32 has steps of 1/32.
    check(&at(500_000.0, 32.0), &[("far", 1, "coordinates of object 0 come in steps of 0.03125")]);
    check(&at(500_000.0, 512.0), &[]);
    // Not in float64.
    check(&at(500_000.1, 32.1), &[]);
    let small = check(&at(0.0, 1e-4), &[("units", 1, "the largest side is 2e-4")]);
    // It is about no object.
    let place = small.findings()[0].places[0];
    assert_eq!((place.object, place.primitive), (None, None));
    check(&at(0.0, 1e7), &[("units", 1, "the largest side is 2e7")]);
}

#[test]
fn what_is_ignored_is_not_looked_for() {
    let scene = one(&POINTS, FACES[..3].to_vec());
    let ignore = vec![FindingKind::named("hole").unwrap()];
    let report = lint(&scene, &LintSettings { ignore, places: 1 }, &()).unwrap();
    assert!(report.is_clean() && report.checked().len() == KINDS.len() - 1);
    let settings = LintSettings { places: 1, ..LintSettings::default() };
    assert_eq!(lint(&scene, &settings, &()).unwrap().findings()[0].places.len(), 1);
}

#[test]
fn lint_can_be_stopped() {
    struct Stopped;
    impl Watch for Stopped {
        fn is_stopped(&self) -> bool {
            true
        }
    }
    let stopped = lint(&one(&POINTS, FACES.to_vec()), &LintSettings::default(), &Stopped);
    assert!(matches!(stopped, Err(Error::Interrupted)));
}

/// All points of a triangle in common with another, by rational arithmetic: the corners of the
/// polygon in which it is left when it is cut by the other's plane and by the planes through the
/// other's edges.
fn common(p: &[Exact; 3], q: &[Exact; 3]) -> Vec<Exact> {
    let normal = cross(&minus(&q[1], &q[0]), &minus(&q[2], &q[0]));
    let negative: Exact = normal.each_ref().map(|x| -x);
    let mut planes = vec![(normal.clone(), &q[0]), (negative, &q[0])];
    for k in 0..3 {
        planes.push((cross(&normal, &minus(&q[(k + 1) % 3], &q[k])), &q[k]));
    }
    let mut polygon: Vec<Exact> = p.to_vec();
    for (inwards, through) in planes {
        let height = |point: &Exact| dot(&inwards, &minus(point, through));
        let mut kept: Vec<Exact> = Vec::new();
        for k in 0..polygon.len() {
            let (a, b) = (&polygon[k], &polygon[(k + 1) % polygon.len()]);
            let (from, to) = (height(a), height(b));
            if !from.is_negative() {
                kept.push(a.clone());
            }
            if from.is_negative() != to.is_negative() && !from.is_zero() && !to.is_zero() {
                let share = &from / (&from - &to);
                kept.push(std::array::from_fn(|k| &a[k] + &share * (&b[k] - &a[k])));
            }
        }
        polygon = kept;
    }
    polygon
}

/// Whether two triangles meet in a point that is not on what they share.
fn judged(p: &[DVec3; 3], q: &[DVec3; 3]) -> bool {
    let shared: Vec<Exact> =
        p.iter().filter(|corner| q.contains(corner)).map(|&c| exact(c)).collect();
    let beside = |point: &Exact| match &shared[..] {
        [] => true,
        [a] => point != a,
        [a, b, ..] => {
            let (way, offset) = (minus(b, a), minus(point, a));
            let along: BigRational = dot(&way, &offset);
            let is_on_line = cross(&way, &offset).iter().all(Zero::is_zero);
            !is_on_line || along.is_negative() || along > dot(&way, &way)
        }
    };
    common(&p.map(exact), &q.map(exact)).iter().any(beside)
}

#[test]
fn triangles_meet_where_rational_arithmetic_says_so() {
    let mut numbers = Numbers::new(17);
    let mut counts = [[0; 2]; 3];
    for k in 0..cases(8000) {
        // In a small lattice all that is special happens; some of them flat, some of them a little
        // beside.
        let height = [1.0, 0.0, 3.0][k % 3];
        let mut point = || {
            let [x, y, z] = [3, 3, 2].map(|n| numbers.below(n + 1) as f64);
            let beside = if numbers.unit() < 0.1 { x.next_up() } else { x };
            DVec3::new(beside / 3.0, y / 7.0, z * height)
        };
        let mut points: Vec<DVec3> = (0..6).map(|_| point()).collect();
        let shared = k / 3 % 3;
        for l in 0..shared {
            points[3 + l] = points[l];
        }
        let [p, q] = [[points[0], points[1], points[2]], [points[3], points[4], points[5]]];
        let has_area = |[a, b, c]: [Exact; 3]| {
            !cross(&minus(&b, &a), &minus(&c, &a)).iter().all(Zero::is_zero)
        };
        let in_common = p.iter().filter(|corner| q.contains(corner)).count();
        if !(has_area(p.map(exact)) && has_area(q.map(exact))) || in_common == 3 {
            continue;
        }
        let report = one(&points, vec![[0, 1, 2], [3, 4, 5]]).lint().unwrap();
        let found = report.findings().iter().find(|f| f.kind.name == "self-intersection");
        let judge = judged(&p, &q);
        assert_eq!(found.map_or(0, |f| f.count), if judge { 2 } else { 0 }, "{p:?} {q:?}");
        counts[in_common][usize::from(judge)] += 1;
    }
    assert!(counts.as_flattened().iter().all(|&count| count > cases(40)), "{counts:?}");
}

#[test]
fn self_intersections_of_soups_are_those_of_all_pairs() {
    let mut numbers = Numbers::new(23);
    let mut points = Vec::new();
    // A quarter of the pairs, of larger triangles.
    let (count, size) = if is_full() { (120, 0.3) } else { (60, 0.4) };
    for _ in 0..count {
        let centre = numbers.point();
        points.extend([(); 3].map(|()| centre + size * numbers.point()));
    }
    let triangles: Vec<[u32; 3]> = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let corners = |k: usize| [points[3 * k], points[3 * k + 1], points[3 * k + 2]];
    let meets = |k: usize| (0..triangles.len()).any(|l| l != k && judged(&corners(k), &corners(l)));
    let wanted: Vec<bool> = (0..triangles.len()).map(meets).collect();
    let report = one(&points, triangles.clone()).lint().unwrap();
    let found: Vec<bool> = report
        .marked(0)
        .unwrap()
        .map(|kind| kind.is_some_and(|kind| kind.name == "self-intersection"))
        .collect();
    assert_eq!(found, wanted);
    let met = wanted.iter().filter(|&&meets| meets).count();
    assert!((wanted.len() / 6..wanted.len() * 5 / 6).contains(&met), "{met}");
}

#[test]
fn the_report_is_the_same_for_any_number_of_threads() {
    let (points, mut triangles) = bumpy_sphere(100, 3);
    triangles.truncate(15_000);
    triangles.extend([[5, 900, 4000], [7, 1500, 2600]]);
    let scene = one(&points, triangles);
    let on = |threads: usize| on_threads(threads, || scene.lint().unwrap());
    let single = on(1);
    assert!(single.findings().len() >= 2, "{:?}", said(&single));
    assert!([2, 3].iter().all(|&threads| on(threads) == single));
}
