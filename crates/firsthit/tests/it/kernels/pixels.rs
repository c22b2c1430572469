//! Cameras, whose pixels go tile by tile.

use std::sync::Arc;

use firsthit::shoot::{Cpu, Engine, First, trace_with};
use firsthit::{
    Camera, DAffine3, DMat3, DVec3, InstructionSet, Lens, Object, Plane, Ray, RayStart, Scene,
    Sphere, Transform, View, Viewplane,
};

use super::checked;
use crate::support::generators::{PLACES, placed, rays, soup};
use crate::support::{Numbers, bits, bumpy_sphere, cases, is_full, mesh, rounds};

pub(super) fn cameras(middle: DVec3, size: f64, numbers: &mut Numbers) -> Vec<Camera> {
    let mut cameras = Vec::new();
    for k in 0..8 {
        let position = middle + size * [2.0, 0.4, 8.0, 1.0][k % 4] * numbers.point();
        let parallel = [false, true][k / 4 % 2];
        let ray_start = [RayStart::Eye, RayStart::Viewplane][k % 2];
        let focal_length = size * [0.5, 0.01, 1.0][k % 3];
        let wide = if parallel { 2.0 * size } else { focal_length * [1.0, 3.0][k % 2] };
        let view = View {
            position,
            aim: middle + 0.3 * size * numbers.point() - position,
            up: numbers.point(),
            rows: [33, 16, 50][k % 3],
            columns: [45, 31, 64][k % 3],
            lens: Lens::Flat(Viewplane {
                focal_length,
                width: wide,
                height: 0.8 * wide,
                parallel,
                ray_start,
                ..Viewplane::default()
            }),
        };
        cameras.push(Camera::new(view).unwrap());
    }
    // Straight along an axis: slopes are exactly zero.
    let view = View {
        position: middle + 2.0 * size * DVec3::Z,
        rows: 32,
        columns: 32,
        lens: Lens::Flat(Viewplane {
            focal_length: size,
            width: size,
            height: size,
            ..Viewplane::default()
        }),
        ..View::default()
    };
    cameras.push(Camera::new(view).unwrap());
    cameras
}

#[test]
fn cameras_on_soups() {
    let mut hits = 0;
    for round in rounds(16) {
        let mut numbers = Numbers::new(100 + round);
        let (scale, offset) = PLACES[round as usize % PLACES.len()];
        let (points, triangles) = soup([12, 60][round as usize / 8], &mut numbers);
        let points = placed(&points, scale, offset);
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        for camera in cameras(placed(&[DVec3::ZERO], scale, offset)[0], scale, &mut numbers) {
            hits += checked(&scene, &camera);
        }
    }
    assert!(hits > cases(20_000), "{hits}");
}

/// Directions with parts that are zero, of either sign, or next to nothing, through corners, where
/// every digit counts.
#[test]
fn cameras_whose_directions_have_tiny_parts() {
    const SIDE: u32 = 9;
    let at = |k: u32| DVec3::new(f64::from(k % SIDE) - 4.0, f64::from(k / SIDE) - 4.0, 0.0);
    let points: Vec<DVec3> = (0..SIDE * SIDE).map(at).collect();
    let mut hits = 0;
    for tiny in [0.0_f64, -0.0, 1e-17, 1e-59, -1e-61, 1e-160, -1e-300, 1e-310] {
        for scale in [1.0, tiny.abs().max(1e-70)] {
            // As wide as the grid of corners, but for the scale; a part of the size of the rest, or
            // none.
            let view = View {
                position: 4.0 * DVec3::Z,
                aim: DVec3::new(tiny, -tiny, -1.0),
                rows: SIDE as usize,
                columns: SIDE as usize,
                lens: Lens::Flat(Viewplane {
                    focal_length: 4.0,
                    width: f64::from(SIDE) * scale,
                    height: f64::from(SIDE),
                    ray_start: RayStart::Eye,
                    ..Viewplane::default()
                }),
                ..View::default()
            };
            let place = |p: &DVec3| DVec3::new(p.x * scale, p.y, p.z);
            let points: Vec<DVec3> = points.iter().map(place).collect();
            let scene = Scene::new(vec![Object::new(mesh(&points, grid(SIDE)))]).unwrap();
            for parallel in [false, true] {
                let camera = Camera::new(View {
                    lens: Lens::Flat(Viewplane { parallel, ..*view.lens.viewplane().unwrap() }),
                    ..view
                })
                .unwrap();
                hits += checked(&scene, &camera);
            }
        }
    }
    assert!(hits > 1_000, "{hits}");
}

#[test]
fn cameras_on_instances_transforms_and_other_shapes() {
    let mut numbers = Numbers::new(5);
    let (points, triangles) = bumpy_sphere(6, 4);
    let shared = mesh(&points, triangles);
    let mut objects = vec![Object::new(Sphere::new(DVec3::ZERO, 0.7).unwrap())];
    for k in 0..24 {
        let matrix = DMat3::from_cols(numbers.point(), numbers.point(), numbers.point());
        let placed = DAffine3::from_mat3_translation(0.5 * matrix, 2.0 * numbers.point());
        let placed = Transform::new(placed).unwrap();
        objects.push(Object::new(Arc::clone(&shared)).placed(placed));
        if k == 12 {
            // Twice in the same place: the lower one wins every tie.
            objects.push(objects[3].clone());
        }
    }
    objects.push(Object::new(Plane::new(-2.0 * DVec3::Z, DVec3::Z).unwrap()));
    let mixed = Scene::new(objects.clone()).unwrap();
    let meshes = Scene::new(objects[1..26].to_vec()).unwrap();
    let mut hits = 0;
    for (k, camera) in cameras(DVec3::ZERO, 1.5, &mut numbers).iter().enumerate() {
        // Where rays start, and from how far away, goes by single bits of `k`.
        let is_for_mixed = (k + k / 2 + k / 4) % 2 == 0;
        if is_for_mixed || is_full() {
            hits += checked(&mixed, camera);
        }
        if !is_for_mixed || is_full() {
            hits += checked(&meshes, camera);
        }
    }
    let one = Scene::new(vec![objects[1].clone()]).unwrap();
    let rays = rays(&points, 1.0, cases(3000), &mut numbers);
    hits += checked(&mixed, &rays) + checked(&meshes, &rays) + checked(&one, &rays);
    assert!(hits > cases(5_000), "{hits}");
}

/// The triangles of a square grid with so many points along a side, two in each cell.
pub(super) fn grid(side: u32) -> Vec<[u32; 3]> {
    (0..side * (side - 1))
        .filter(|k| k % side + 1 < side)
        .flat_map(|k| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]])
        .collect()
}

/// Every ray through a corner where six triangles meet, all at the same `t`.
#[test]
fn a_grid_looked_at_through_its_corners() {
    const SIDE: u32 = 33;
    let at = |k: u32| DVec3::new(f64::from(k % SIDE), f64::from(k / SIDE), 0.0);
    let points: Vec<DVec3> = (0..SIDE * SIDE).map(at).collect();
    let scene = Scene::new(vec![Object::new(mesh(&points, grid(SIDE)))]).unwrap();
    let side = f64::from(SIDE);
    let view = View {
        position: DVec3::new(0.5 * (side - 1.0), 0.5 * (side - 1.0), 4.0),
        rows: SIDE as usize,
        columns: SIDE as usize,
        lens: Lens::Flat(Viewplane {
            focal_length: 4.0,
            width: side,
            height: side,
            parallel: true,
            ray_start: RayStart::Eye,
            ..Viewplane::default()
        }),
        ..View::default()
    };
    let camera = Camera::new(view).unwrap();
    assert_eq!(checked(&scene, &camera), camera.pixels());
    let perspective = View {
        lens: Lens::Flat(Viewplane { parallel: false, ..*view.lens.viewplane().unwrap() }),
        ..view
    };
    let camera = Camera::new(perspective).unwrap();
    assert_eq!(checked(&scene, &camera), camera.pixels());
}

/// A small part of a large mesh through a long lens: what float32 takes from a coordinate is seen
/// there, be the rest of the mesh in other leaves of the tree or in the same one.
#[test]
fn small_triangles_of_a_large_mesh() {
    const CELL: f64 = 0.24;
    let mut hits = 0;
    for round in rounds(24) {
        let side = [17, 3][round as usize / 12];
        let mut numbers = Numbers::new(500 + round);
        let middle = 900.0 * numbers.point();
        let [across, upwards, bump] = [0, 1, 2].map(|_| numbers.point().normalize());
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        // These are the first of a leaf, if there is but one.
        for (first, corner) in [(0, DVec3::splat(-1000.0)), (3, DVec3::splat(1000.0))] {
            points.extend([corner, corner + DVec3::X, corner + DVec3::Y]);
            triangles.push([0, 1, 2].map(|k| first + k));
        }
        points.extend((0..side * side).map(|k| {
            let place = [k % side, k / side].map(|n| f64::from(n) - 0.5 * f64::from(side - 1));
            let height = numbers.unit();
            middle + CELL * (place[0] * across + place[1] * upwards + height * bump)
        }));
        triangles.extend(grid(side).iter().map(|corners| corners.map(|k| k + 6)));
        if round % 2 == 0 {
            // What the tree holds as it is.
            points = points.iter().map(|v| v.as_vec3().as_dvec3()).collect();
        }
        let scene = Scene::new(vec![Object::new(mesh(&points, triangles))]).unwrap();
        let normal = (across.cross(upwards).normalize() + 0.5 * numbers.point()).normalize();
        let distance = [1200.0, 2000.0, 700.0][round as usize % 3];
        let wide = 0.8 * f64::from(side - 1) * CELL;
        let view = View {
            position: middle + distance * normal,
            aim: -normal,
            up: numbers.point(),
            rows: 80,
            columns: 80,
            lens: Lens::Flat(Viewplane {
                focal_length: distance,
                width: wide,
                height: wide,
                parallel: [false, true][round as usize / 2 % 2],
                ray_start: RayStart::Eye,
                ..Viewplane::default()
            }),
        };
        hits += checked(&scene, &Camera::new(view).unwrap());
    }
    assert!(hits > cases(60_000), "{hits}");
}

/// One hit in pixels larger than the triangle, far from the middle of the tile.
#[test]
fn a_hit_that_was_missed() {
    let points = [
        [0.415_942_341_089_248_66, -0.082_274_191_081_523_9, 0.213_607_579_469_680_8],
        [0.106_766_365_468_502_04, -0.139_673_843_979_835_5, -0.095_042_109_489_440_92],
        [0.507_356_464_862_823_5, -0.078_884_229_063_987_73, -0.038_143_336_772_918_7],
    ];
    let view = View {
        position: DVec3::new(
            32.038_183_786_494_656,
            -0.935_654_926_744_804_9,
            -42.573_441_264_255_03,
        ),
        aim: DVec3::new(0.363_536_567_681_311_1, 0.864_299_486_757_506_2, 0.347_602_590_826_367_1),
        up: DVec3::new(-0.790_571_125_573_886_3, 0.549_241_633_474_654_6, 0.270_796_830_607_249_7),
        rows: 16,
        columns: 16,
        lens: Lens::Flat(Viewplane {
            width: 80.0,
            height: 80.0,
            parallel: true,
            ray_start: RayStart::Eye,
            ..Viewplane::default()
        }),
    };
    let points = points.map(DVec3::from);
    let scene = Scene::new(vec![Object::new(mesh(&points, vec![[0, 1, 2]]))]).unwrap();
    assert_eq!(checked(&scene, &Camera::new(view).unwrap()), 1);
}

/// Such pixels, whose ray all but meets an edge.
#[test]
fn triangles_smaller_than_a_pixel() {
    let mut hits = 0;
    for round in 0..300 {
        let mut numbers = Numbers::new(3000 + round);
        let points = [0, 1, 2].map(|_| numbers.point().as_vec3().as_dvec3());
        let pixel = [5.0, 1.0, 0.2][round as usize % 3];
        let mut view = View {
            position: 40.0 * numbers.point(),
            up: numbers.point(),
            rows: 16,
            columns: 16,
            lens: Lens::Flat(Viewplane {
                focal_length: 30.0,
                width: 16.0 * pixel,
                height: 16.0 * pixel * [1.0, 30.0][round as usize / 6 % 2],
                parallel: [true, false][round as usize / 3 % 2],
                ray_start: RayStart::Eye,
                ..Viewplane::default()
            }),
            ..View::default()
        };
        view.aim = -view.position + numbers.point();
        // Moved so that the ray of a pixel in a corner meets the point of an edge 30 units away.
        let along = numbers.unit();
        let edge = points[0] + along * (points[1] - points[0]);
        let (row, column) = [(0, 15), (0, 0), (15, 0)][round as usize % 3];
        let ray = Camera::new(view).unwrap().ray(row, column);
        view.position += edge - (ray.origin + 30.0 * ray.direction);
        let scene = Scene::new(vec![Object::new(mesh(&points, vec![[0, 1, 2]]))]).unwrap();
        hits += checked(&scene, &Camera::new(view).unwrap());
    }
    assert!(hits > 150, "{hits}");
}

/// Two trees whose leaves have the same numbers, side by side in a tile: each has its own
/// triangles.
#[test]
fn meshes_with_other_orders_side_by_side() {
    let (points, triangles) = bumpy_sphere(12, 3);
    let single = |p: &DVec3| p.as_vec3().as_dvec3();
    let points: Vec<DVec3> = points.iter().map(single).collect();
    let backwards: Vec<[u32; 3]> = triangles.iter().rev().copied().collect();
    let beside: Vec<DVec3> = points.iter().map(|p| *p + 2.0 * DVec3::X).collect();
    let beside: Vec<DVec3> = beside.iter().map(single).collect();
    let objects =
        vec![Object::new(mesh(&points, triangles)), Object::new(mesh(&beside, backwards))];
    let scene = Scene::new(objects).unwrap();
    let mut hits = 0;
    for columns in [40, 64, 150] {
        let view = View {
            position: DVec3::new(1.0, 0.1, 6.0),
            rows: columns / 2,
            columns,
            lens: Lens::Flat(Viewplane {
                focal_length: 1.0,
                width: 1.0,
                height: 0.5,
                ..Viewplane::default()
            }),
            ..View::default()
        };
        let camera = Camera::new(view).unwrap();
        let rays: Vec<Ray> =
            (0..columns * columns / 2).map(|k| camera.ray(k / columns, k % columns)).collect();
        hits += checked(&scene, &camera) + checked(&scene, &rays);
    }
    assert!(hits > 5_000, "{hits}");
}

/// Large pictures go to memory past the caches, in lines that know nothing of tiles and rows.
#[test]
fn large_pictures_of_any_width() {
    let (points, triangles) = bumpy_sphere(20, 4);
    let one = Object::new(mesh(&points, triangles));
    for set in InstructionSet::available() {
        let scene = Scene::new(vec![one.clone()]).unwrap();
        let engine = Cpu::with(set);
        for [rows, columns] in [[225, 613], [1031, 129], [2049, 64], [131, 1003]] {
            let (height, width) = (rows as f64 / 500.0, columns as f64 / 500.0);
            let view = View {
                position: 4.0 * DVec3::Z,
                rows,
                columns,
                lens: Lens::Flat(Viewplane {
                    focal_length: 1.5,
                    width,
                    height,
                    ..Viewplane::default()
                }),
                ..View::default()
            };
            let camera = Camera::new(view).unwrap();
            let hits = trace_with(&engine, &scene, &camera, First, &()).unwrap();
            let met = (0..hits.len()).filter(|&k| hits.t[k].is_finite()).count();
            assert!(met > 9_000 && met < hits.len(), "{met}");
            for index in 0..hits.len() {
                let ray = camera.ray(index / columns, index % columns);
                let (got, wanted) = (hits.get(index), engine.first_hit(&scene, &ray));
                assert_eq!(bits(&got), bits(&wanted), "{set:?} {columns} {index}");
            }
        }
    }
}
