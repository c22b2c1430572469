//! Sections: judged by closed forms, by counting cells, and by rational arithmetic.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use firsthit::section::{Section, SectionPlane, section};
use firsthit::watch::Watch;
use firsthit::{DAffine3, DMat3, DVec3, Error, Object, Scene, Sphere, Transform};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

use crate::support::rational::{Exact, cross, dot, exact, minus};
use crate::support::{Ask, Numbers, bumpy_sphere, cases, mesh, on_threads, scene};

/// The boundary of cells of the unit lattice, wound outwards. Cells that only touch at an edge or a
/// corner share it.
fn cells(cells: &[[i32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for &cell in cells {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beside = cell;
                beside[axis] += 2 * side - 1;
                if cells.contains(&beside) {
                    continue;
                }
                let (l, m) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |a: i32, b: i32| {
                    let mut at = cell.map(f64::from);
                    at[axis] += f64::from(side);
                    at[l] += f64::from(a);
                    at[m] += f64::from(b);
                    DVec3::from(at)
                };
                let first = points.len() as u32;
                points.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
                let faces = [[0, 1, 2], [0, 2, 3]].map(|face| face.map(|k| first + k));
                // Counter-clockwise seen from the positive side of the axis.
                triangles
                    .extend(faces.map(|[a, b, c]| if side == 1 { [a, b, c] } else { [a, c, b] }));
            }
        }
    }
    (points, triangles)
}

fn one(points: &[DVec3], triangles: Vec<[u32; 3]>) -> Scene {
    scene(vec![Object::new(mesh(points, triangles))])
}

fn cube() -> Scene {
    let (points, triangles) = cells(&[[0, 0, 0]]);
    one(&points, triangles)
}

fn at_z(scene: &Scene, z: f64) -> Section {
    scene.section(DVec3::new(0.3, 0.2, z), DVec3::Z).unwrap()
}

/// Rounding of a few hundred terms near one.
const ROUNDING: f64 = 1e-12;

#[test]
fn a_cube_is_cut_in_a_square() {
    let cut = at_z(&cube(), 0.25);
    assert_eq!(cut.len(), 1);
    let polyline = cut.polylines().next().unwrap();
    assert!(polyline.is_closed && polyline.object == 0);
    // Two triangles on each of four sides.
    assert_eq!((polyline.points.len(), polyline.primitives.len()), (8, 8));
    assert!(polyline.points.iter().all(|point| point.z == 0.25));
    assert_eq!((cut.area(), cut.perimeter()), (1.0, 4.0));
    assert!(cut.warnings().is_empty() && cut.left_out().is_empty());
    let askew = cube().section(DVec3::splat(0.5), DVec3::ONE).unwrap();
    // A regular hexagon of side sqrt(1/2).
    let side = 0.5_f64.sqrt();
    assert!((askew.area() - 1.5 * 3.0_f64.sqrt() * side * side).abs() < ROUNDING);
    assert!((askew.perimeter() - 6.0 * side).abs() < ROUNDING);
}

#[test]
fn a_face_in_the_plane_is_cut_where_the_solid_is_below_it() {
    assert_eq!(at_z(&cube(), 1.0).area(), 1.0);
    assert!(at_z(&cube(), 0.0).is_empty());
    assert!(at_z(&cube(), 1.0_f64.next_up()).is_empty());
    assert_eq!(at_z(&cube(), f64::from_bits(1)).area(), 1.0);
    // From the other side it is the other way round.
    let from_below = |z: f64| cube().section(DVec3::new(0.0, 0.0, z), DVec3::NEG_Z).unwrap();
    assert_eq!((from_below(0.0).area(), from_below(1.0).len()), (1.0, 0));
}

/// Cells in a lattice meet at edges and corners, and planes of the lattice go through their
/// vertices, edges and faces.
#[test]
fn sections_of_lattice_cells_are_closed_and_their_area_is_a_count() {
    let mut numbers = Numbers::new(11);
    for _ in 0..60 {
        let mut solid: Vec<[i32; 3]> = Vec::new();
        for k in 0..64 {
            if numbers.unit() < 0.4 {
                solid.push([k % 4, k / 4 % 4, k / 16]);
            }
        }
        let (points, triangles) = cells(&solid);
        let scene = one(&points, triangles);
        for axis in 0..3 {
            let normal = [DVec3::X, DVec3::Y, DVec3::Z][axis];
            for half in 0..=8 {
                let place = f64::from(half) / 2.0;
                let cut = scene.section(normal * place, normal).unwrap();
                assert!(cut.polylines().all(|polyline| polyline.is_closed));
                // What is just below the plane.
                let layer = (half + 1) / 2 - 1;
                let count = solid.iter().filter(|cell| cell[axis] == layer).count();
                assert_eq!(cut.area(), count as f64, "{solid:?} {axis} {half}");
            }
        }
        // Through vertices, along diagonals of faces and of cells.
        for normal in [DVec3::new(1.0, 1.0, 0.0), DVec3::ONE, DVec3::new(1.0, -2.0, 3.0)] {
            let corner = DVec3::new(1.0, 2.0, 2.0);
            let cut = scene.section(corner, normal).unwrap();
            assert!(cut.polylines().all(|polyline| polyline.is_closed));
            let judge = judged(&scene, corner, normal).0;
            assert!((cut.area() - judge).abs() < ROUNDING, "{normal}");
        }
    }
}

/// The area and the perimeter of what is just below the plane: from the exact segments of all
/// triangles, without joining them. By Green's theorem the sum over oriented segments is the area,
/// in any order.
fn judged(scene: &Scene, origin: DVec3, normal: DVec3) -> (f64, f64) {
    let (o, n) = (exact(origin), exact(normal));
    let (mut twice, mut perimeter) = (BigRational::zero(), 0.0);
    for object in scene.objects() {
        let mesh = object.mesh().unwrap();
        for triangle in 0..mesh.triangles().len() {
            let corners = mesh.corners(triangle).map(exact);
            let sides = corners.each_ref().map(|corner| dot(&n, &minus(corner, &o)));
            let mut crossings: Vec<Exact> = Vec::new();
            for k in 0..3 {
                let (a, b) = (k, (k + 1) % 3);
                if sides[a].is_negative() == sides[b].is_negative() {
                    continue;
                }
                let share = &sides[a] / (&sides[a] - &sides[b]);
                let (p, q) = (&corners[a], &corners[b]);
                crossings.push(std::array::from_fn(|k| &p[k] + &share * (&q[k] - &p[k])));
            }
            let [p, q] = &crossings[..] else {
                continue;
            };
            let way = minus(q, p);
            let facing = cross(&minus(&corners[1], &corners[0]), &minus(&corners[2], &corners[0]));
            // Counter-clockwise around material: along normal x facing.
            let turn = dot(&n, &cross(&minus(p, &o), &minus(q, &o)));
            let is_forward = !dot(&cross(&n, &facing), &way).is_negative();
            twice += if is_forward { turn } else { -turn };
            perimeter += dot(&way, &way).to_f64().unwrap().sqrt();
        }
    }
    (0.5 * twice.to_f64().unwrap() / normal.length(), perimeter)
}

#[test]
fn sections_of_closed_meshes_are_closed_with_the_area_of_rational_arithmetic() {
    let mut numbers = Numbers::new(5);
    for seed in 0..cases(6) {
        let (points, triangles) = bumpy_sphere(9, seed);
        let scene = one(&points, triangles);
        for k in 0..12 {
            let through = points[numbers.below(points.len())];
            let other = points[numbers.below(points.len())];
            let (origin, normal) = match k % 4 {
                0 => (0.5 * numbers.point(), numbers.point()),
                1 => (through, numbers.point()),
                2 => (through, [DVec3::X, DVec3::Y, DVec3::NEG_Z][k / 4]),
                // Along an edge or a diagonal, but for rounding.
                _ => (through, (other - through).cross(numbers.point())),
            };
            if normal.length() == 0.0 {
                continue;
            }
            let cut = scene.section(origin, normal).unwrap();
            assert!(cut.polylines().all(|polyline| polyline.is_closed), "{origin} {normal}");
            let (area, perimeter) = judged(&scene, origin, normal);
            assert!((cut.area() - area).abs() < ROUNDING, "{origin} {normal}");
            assert!((cut.perimeter() - perimeter).abs() < ROUNDING, "{origin} {normal}");
        }
    }
}

/// A torus of `around` times `across` quads about the z axis; its lowest and highest ring, and
/// those at z = 0, are exactly there.
fn torus(around: u32, across: u32, [large, small]: [f64; 2]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points = Vec::new();
    for k in 0..around {
        let turn = TAU * f64::from(k) / f64::from(around);
        for l in 0..across {
            let tilt = TAU * f64::from(l) / f64::from(across);
            let height = if 2 * l % across == 0 { 0.0 } else { small * libm::sin(tilt) };
            let radius = large + small * libm::cos(tilt);
            points.push(DVec3::new(radius * libm::cos(turn), radius * libm::sin(turn), height));
        }
    }
    let at = |k: u32, l: u32| k % around * across + l % across;
    let mut triangles = Vec::new();
    for k in 0..around {
        for l in 0..across {
            let [a, b, c, d] = [at(k, l), at(k + 1, l), at(k + 1, l + 1), at(k, l + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (points, triangles)
}

#[test]
fn a_torus_is_a_ring_across_its_axis_and_two_discs_along_it() {
    let (points, triangles) = torus(40, 24, [3.0, 1.0]);
    let scene = one(&points, triangles);
    // All vertices of two rings are on the plane.
    let ring = at_z(&scene, 0.0);
    let polygon = |corners: u32, radius: f64| {
        0.5 * f64::from(corners) * libm::sin(TAU / f64::from(corners)) * radius * radius
    };
    let areas: Vec<f64> = ring.polylines().map(|p| p.area(ring.plane()).unwrap()).collect();
    assert_eq!(areas.len(), 2);
    let [outer, inner] = [areas[0].max(areas[1]), areas[0].min(areas[1])];
    assert!((outer - polygon(40, 4.0)).abs() < 1e-11, "{outer}");
    assert!((inner + polygon(40, 2.0)).abs() < 1e-11, "{inner}");
    assert!(ring.polylines().all(|polyline| polyline.points.len() == 40));
    let discs = scene.section(DVec3::ZERO, DVec3::Y).unwrap();
    assert_eq!(discs.len(), 2);
    assert!((discs.area() - 2.0 * polygon(24, 1.0)).abs() < 1e-11);
    let perimeter = 2.0 * 24.0 * 2.0 * libm::sin(PI / 24.0);
    assert!((discs.perimeter() - perimeter).abs() < 1e-11);
}

#[test]
fn triangles_with_vertices_of_their_own_join_as_those_that_share_them() {
    let (points, triangles) = bumpy_sphere(12, 4);
    let shared = one(&points, triangles.clone());
    // As in STL files, and every other zero negative.
    let corners = triangles.iter().flatten().enumerate();
    let own: Vec<DVec3> = corners
        .map(|(k, &corner)| {
            let point = points[corner as usize];
            let zero = if k % 2 == 0 { -0.0 } else { 0.0 };
            DVec3::from(point.to_array().map(|x| if x == 0.0 { zero } else { x }))
        })
        .collect();
    let count = triangles.len() as u32;
    let alone = one(&own, (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect());
    for normal in [DVec3::X, DVec3::new(0.2, -0.5, 1.0)] {
        let [a, b] = [&shared, &alone].map(|scene| scene.section(points[30], normal).unwrap());
        assert_eq!(a, b);
        assert!(!a.is_empty() && a.polylines().all(|polyline| polyline.is_closed));
    }
}

#[test]
fn an_open_mesh_has_open_polylines_from_border_to_border() {
    let points = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 2.0)];
    let cut = at_z(&one(&points, vec![[0, 1, 2]]), 1.0);
    let polyline = cut.polylines().next().unwrap();
    assert!(!polyline.is_closed && polyline.area(cut.plane()).is_none());
    let ends = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0)];
    assert!(polyline.points == ends || polyline.points == [ends[1], ends[0]]);
    assert_eq!((polyline.primitives, cut.area(), cut.perimeter()), (&[0][..], 0.0, 1.0));
    // A strip whose triangles come in any order.
    let points: Vec<DVec3> =
        (0..20).map(|k| DVec3::new(f64::from(k / 2), 0.0, f64::from(k % 2))).collect();
    let mut strip: Vec<[u32; 3]> =
        (0..18).map(|k| if k % 2 == 0 { [k, k + 1, k + 2] } else { [k, k + 2, k + 1] }).collect();
    strip.sort_by_key(|triangle| triangle[0] * 7 % 18);
    let cut = at_z(&one(&points, strip), 0.5);
    let polyline = cut.polylines().next().unwrap();
    assert_eq!((cut.len(), polyline.is_closed, polyline.points.len()), (1, false, 19));
    assert_eq!(cut.perimeter(), 9.0);
}

#[test]
fn triangles_that_are_wound_the_other_way_join_all_the_same() {
    let (points, mut triangles) = bumpy_sphere(10, 8);
    let mut numbers = Numbers::new(2);
    for triangle in &mut triangles {
        if numbers.unit() < 0.5 {
            triangle.swap(0, 1);
        }
    }
    let scene = one(&points, triangles);
    let cut = scene.section(points[50], DVec3::new(1.0, 2.0, 0.5)).unwrap();
    assert!(cut.polylines().all(|polyline| polyline.is_closed));
    let perimeter = judged(&scene, points[50], DVec3::new(1.0, 2.0, 0.5)).1;
    assert!((cut.perimeter() - perimeter).abs() < ROUNDING);
}

#[test]
fn duplicates_and_triangles_without_area_leave_polylines_closed() {
    let (points, mut triangles) = bumpy_sphere(10, 8);
    let single = one(&points, triangles.clone()).section(points[44], DVec3::Z).unwrap();
    triangles.extend(triangles.clone());
    triangles.extend([[5, 5, 90], [7, 90, 90], [3, 3, 3]]);
    let double = one(&points, triangles).section(points[44], DVec3::Z).unwrap();
    assert!(double.polylines().all(|polyline| polyline.is_closed));
    assert!((double.area() - single.area()).abs() < ROUNDING);
}

#[test]
fn what_only_touches_at_a_point_is_not_cut_and_at_an_edge_it_is_there_and_back() {
    let roof = [
        DVec3::ZERO,
        DVec3::new(2.0, 0.0, 0.0),
        DVec3::new(1.0, 2.0, 0.0),
        DVec3::new(1.0, 0.5, 1.0),
    ];
    let pyramid = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    assert!(at_z(&one(&roof, pyramid), 1.0).is_empty());
    // A tetrahedron with an upper and a lower edge.
    let wedge = [
        DVec3::new(-1.0, 0.0, 0.0),
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(0.0, -1.0, 1.0),
        DVec3::new(0.0, 1.0, 1.0),
    ];
    let scene = one(&wedge, vec![[0, 3, 1], [0, 1, 2], [0, 2, 3], [1, 3, 2]]);
    let edge = at_z(&scene, 1.0);
    let polyline = edge.polylines().next().unwrap();
    assert!(polyline.is_closed && polyline.points.len() == 2);
    assert_eq!((edge.area(), edge.perimeter()), (0.0, 4.0));
    assert!(at_z(&scene, 0.0).is_empty());
    assert!((at_z(&scene, 0.5).area() - 1.0).abs() < ROUNDING);
}

#[test]
fn transforms_move_scale_and_mirror_what_is_cut() {
    let (points, triangles) = cells(&[[0, 0, 0]]);
    let mesh = mesh(&points, triangles);
    let placed = |matrix: DMat3, offset: DVec3| {
        let map = DAffine3::from_mat3_translation(matrix, offset);
        let object = Object::new(Arc::clone(&mesh)).placed(Transform::new(map).unwrap());
        scene(vec![object])
    };
    let scaled = placed(DMat3::from_diagonal(DVec3::new(2.0, 3.0, 5.0)), DVec3::splat(7.0));
    assert_eq!(at_z(&scaled, 9.0).area(), 6.0);
    assert!(at_z(&scaled, 6.0).is_empty());
    let mirrored = placed(DMat3::from_diagonal(DVec3::new(-2.0, 3.0, 1.0)), DVec3::ZERO);
    assert_eq!(at_z(&mirrored, 0.5).area(), 6.0);
    let turned = placed(DMat3::from_rotation_y(0.3), DVec3::ZERO);
    let slanted = turned.section(turned.bounds().centre(), DVec3::Y).unwrap();
    assert!((slanted.area() - 1.0).abs() < ROUNDING);
}

#[test]
fn an_area_that_leaves_open_curves_out_says_so() {
    let (points, triangles) = cells(&[[0, 0, 0]]);
    let moved: Vec<DVec3> = points.iter().map(|point| 3.0 * DVec3::X + *point).collect();
    // A cube, and one without the face that stands at x = 3.
    let gap = triangles.iter().copied().filter(|corners| {
        let at_gap = |k: &u32| moved[*k as usize].x == 3.0;
        !corners.iter().all(at_gap)
    });
    let gap = mesh(&moved, gap.collect::<Vec<_>>());
    let both = scene(vec![Object::new(mesh(&points, triangles.clone())), Object::new(gap.clone())]);
    let cut = at_z(&both, 0.5);
    assert_eq!((cut.len(), cut.area()), (2, 1.0));
    assert_eq!(
        cut.warnings(),
        [
            "1 of 2 curves is open, since the mesh has gaps there: the area is that of the closed ones alone"
        ]
    );
    // Of a sheet nobody expects an area.
    let cut = at_z(&scene(vec![Object::new(gap)]), 0.5);
    assert!(cut.warnings().is_empty() && cut.len() == 1);
}

#[test]
fn shapes_that_are_no_meshes_are_left_out_with_a_warning() {
    let (points, triangles) = cells(&[[0, 0, 0]]);
    let far = [DVec3::ZERO, DVec3::X * 1e200, DVec3::Z * 2.0];
    let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    let scene = scene(vec![
        Object::new(ball).named("ball"),
        Object::new(mesh(&points, triangles)),
        Object::new(ball),
        Object::new(mesh(&far, vec![[0, 1, 2]])).named("far"),
    ]);
    let cut = at_z(&scene, 0.5);
    assert_eq!((cut.left_out(), cut.area()), (&[0, 2, 3][..], 1.0));
    assert_eq!(
        cut.warnings(),
        [
            "left out of the section, not a mesh: 2 objects, the first of them object 0, 'ball' (sphere)",
            "left out of the section, at coordinates beyond 1e150: object 3, 'far' (mesh)"
        ]
    );
    assert!(cut.polylines().all(|polyline| polyline.object == 1));
}

#[test]
fn the_section_is_the_same_for_any_number_of_threads() {
    let (points, triangles) = bumpy_sphere(120, 3);
    let scene = one(&points, triangles);
    let cut = |threads: usize| {
        let normal = DVec3::new(0.1, 0.2, 1.0);
        on_threads(threads, || scene.section(DVec3::splat(0.1), normal).unwrap())
    };
    let single = cut(1);
    assert!(single.len() > 1);
    assert!([2, 3].iter().all(|&threads| cut(threads) == single));
}

#[test]
fn a_section_can_be_stopped() {
    struct Stopped;
    impl Watch for Stopped {
        fn is_stopped(&self) -> bool {
            true
        }
    }
    let plane = SectionPlane::new(DVec3::splat(0.5), DVec3::Z).unwrap();
    let stopped = section(&cube(), plane, &Stopped);
    assert!(matches!(stopped, Err(Error::Interrupted)));
}

#[test]
fn nothing_and_an_empty_mesh_have_an_empty_section() {
    let nothing = at_z(&scene(Vec::new()), 0.0);
    assert!(nothing.is_empty());
    for total in [nothing.area(), nothing.perimeter()] {
        assert_eq!(total.to_bits(), 0.0_f64.to_bits());
    }
    assert!(at_z(&one(&[], Vec::new()), 0.0).is_empty());
}
