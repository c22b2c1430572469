//! Lines in the pictures of all lenses, against what their rays meet.

use std::sync::Arc;

use firsthit::edge::{EdgeKind, Edges, Lines, Subject};
use firsthit::shoot::Cpu;
use firsthit::{
    Camera, Cone, Cuboid, Cylinder, DAffine3, DVec3, Disc, Lens, Object, Projection, Render, Scene,
    Sphere, Transform, View,
};

use super::{SIDE, ball, covered, cube, mesh, of, only, scene};

/// Objects all around the origin, none of which touches another. Some occlude others.
fn around() -> Scene {
    let sphere = |x, y, z, radius| Object::new(Sphere::new(DVec3::new(x, y, z), radius).unwrap());
    let turned = DAffine3::from_translation(DVec3::new(0.5, 6.0, -1.0))
        * DAffine3::from_rotation_z(0.4)
        * DAffine3::from_rotation_x(0.7);
    let moved = DAffine3::from_translation(DVec3::new(-4.0, 4.0, 1.5));
    let place = |map| Transform::new(map).unwrap();
    let points = [[-5.0, -1.0, -1.0], [-6.0, 1.5, 0.0], [-5.5, 0.3, 2.0]];
    let disc = Disc::new(DVec3::new(4.0, 4.0, 3.0), DVec3::new(1.0, 2.0, 0.5), 1.2);
    let cone = (DVec3::new(0.2, -5.0, -1.0), DVec3::new(1.0, -6.0, 2.0));
    let cylinder = (DVec3::new(3.0, -4.5, 1.0), DVec3::new(5.0, -3.0, 2.0));
    let low = DVec3::new(-4.0, -4.0, -3.0);
    scene(vec![
        sphere(6.0, 1.0, 0.5, 1.5),
        sphere(12.0, 4.5, 1.0, 2.0),
        sphere(0.5, 0.3, 5.0, 1.3),
        sphere(0.3, 0.2, -4.0, 0.8),
        sphere(2.0, 14.0, 1.0, 3.0),
        Object::new(Arc::new(cube())).placed(place(turned)),
        Object::new(Arc::new(ball(24, 48))).placed(place(moved)),
        Object::new(Arc::new(mesh(&points, &[[0, 1, 2]]))),
        Object::new(disc.unwrap()),
        Object::new(Cone::new(cone.0, cone.1, 1.0, 0.2).unwrap()),
        Object::new(Cylinder::new(cylinder.0, cylinder.1, 0.5).unwrap()),
        Object::new(Cuboid::new(low, low + DVec3::new(1.5, 1.0, 2.0)).unwrap()),
    ])
}

/// A camera at the origin, or for parallel rays behind all objects, with some numbers of its lens.
fn camera(projection: Projection, size: [usize; 2], numbers: &[(&str, f64)]) -> Camera {
    let aim = DVec3::new(0.2, 1.0, 0.1);
    // Rays that start within an object end its picture where there is no edge.
    let is_parallel = projection == Projection::Orthographic;
    let view = View {
        position: if is_parallel { -20.0 * aim } else { DVec3::ZERO },
        aim,
        up: DVec3::Z,
        rows: size[0],
        columns: size[1],
        lens: Lens::named(projection, numbers).unwrap(),
    };
    Camera::new(view).unwrap()
}

fn cameras() -> Vec<Camera> {
    let matrix = [("fx", 70.0), ("fy", 70.0), ("cx", 120.0), ("cy", 80.0)];
    let calibrated = |projection, own: &[(&str, f64)]| {
        camera(projection, [160, 240], &[&matrix[..], own].concat())
    };
    let with_fov = |projection, fov| {
        let lens = Lens::with_fov(projection, fov, 160, 160).unwrap();
        let view = *camera(Projection::Octahedral, [160, 160], &[]).view();
        Camera::new(View { lens, ..view }).unwrap()
    };
    let flat = [("width", 12.0), ("height", 8.0)];
    vec![
        camera(Projection::Perspective, [160, 240], &[("width", 1.8), ("height", 1.2)]),
        camera(Projection::Orthographic, [160, 240], &flat),
        camera(Projection::Equirectangular, [160, 320], &[]),
        camera(Projection::Cylindrical, [120, 320], &[]),
        camera(Projection::CubeMap, [160, 240], &[]),
        camera(Projection::CubeMap, [180, 240], &[]),
        camera(Projection::Octahedral, [200, 200], &[]),
        calibrated(Projection::OpenCv, &[("k1", -0.1), ("p1", 0.002)]),
        calibrated(Projection::KannalaBrandt, &[("k1", 0.9), ("k2", 0.02)]),
        calibrated(Projection::DoubleSphere, &[("xi", -0.2), ("alpha", 0.6)]),
        calibrated(Projection::Mei, &[("xi", 1.3)]),
        with_fov(Projection::Equidistant, 180.0),
        with_fov(Projection::Equidistant, 330.0),
        with_fov(Projection::Stereographic, 220.0),
        with_fov(Projection::OrthographicFisheye, 160.0),
    ]
}

/// The object that each pixel sees and how much of it lines of a width cover.
fn seen(scene: &Scene, camera: &Camera, width: f64) -> Vec<[f64; 2]> {
    let edges = Edges { width, ..only(&[EdgeKind::Object]) };
    let render = Render::new(scene).camera(*camera).edges(edges);
    let frame = render.channels(&["object", "edge"]).frame().unwrap();
    let [object, edge] = ["object", "edge"].map(|name| frame.channel(name).unwrap());
    let values = |k| [object.data.value(k), edge.data.value(k)];
    (0..camera.rows() * camera.columns()).map(values).collect()
}

/// Whether two pixels see almost in the same direction: not across a tear of the picture.
fn are_neighbours(camera: &Camera, a: [usize; 2], b: [usize; 2]) -> bool {
    let [a, b] = [a, b].map(|[row, column]| camera.ray(row, column).direction.normalize());
    a.dot(b) > 0.99
}

#[test]
fn between_two_pixels_that_see_different_objects_there_is_a_line() {
    let scene = around();
    for camera in cameras() {
        let name = camera.lens().projection().name();
        let seen = seen(&scene, &camera, 3.0);
        let at = |[row, column]: [usize; 2]| seen[row * camera.columns() + column];
        let mut changes = 0;
        for row in 1..camera.rows() {
            for column in 1..camera.columns() {
                for other in [[row - 1, column], [row, column - 1]] {
                    let here = [row, column];
                    let [[a, covered], [b, other_covered]] = [at(here), at(other)];
                    if a == b || !are_neighbours(&camera, here, other) {
                        continue;
                    }
                    // Of a line between them both centres are within a pixel, which a line three
                    // pixels wide covers.
                    changes += 1;
                    let least = covered.min(other_covered);
                    assert!(least > 0.99, "{name} {here:?} {other:?} {a} {b} {least}");
                }
            }
        }
        assert!(changes > 300, "{name} {changes}");
    }
}

#[test]
fn where_there_is_a_line_pixels_near_it_see_different_objects() {
    let scene = around();
    for camera in cameras() {
        let name = camera.lens().projection().name();
        let seen = seen(&scene, &camera, 1.0);
        let (mut lines, mut alone) = (0, 0);
        for row in 2..camera.rows() - 2 {
            for column in 2..camera.columns() - 2 {
                let near = (0..25).map(|k| [row + k / 5 - 2, column + k % 5 - 2]);
                // At its limit a lens may squeeze much into a pixel.
                let sees =
                    |&[row, column]: &[usize; 2]| camera.ray(row, column).direction.is_finite();
                let [object, covered] = seen[row * camera.columns() + column];
                if covered < 0.6 || !near.clone().all(|pixel| sees(&pixel)) {
                    continue;
                }
                lines += 1;
                let mut near = near.map(|[row, column]| seen[row * camera.columns() + column][0]);
                alone += usize::from(near.all(|other| other == object));
            }
        }
        // But for slivers that no pixel's centre sees.
        assert!(lines > 200 && alone * 100 < lines, "{name} {lines} {alone}");
    }
}

/// Both its ends are outside of what the lens sees, and it is in the picture for less than a
/// hundredth of its length: none of its 32 parts of equal length has an end in the picture.
#[test]
fn a_long_line_crosses_the_picture_of_a_fisheye() {
    let points = [[-1300.0, 5.0, -1.0], [700.0, 5.0, -1.0], [0.0, 5.0, -900.0]];
    let wall = of(Arc::new(mesh(&points, &[[0, 1, 2]])));
    let lens = Lens::with_fov(Projection::Equidistant, 120.0, SIDE, SIDE).unwrap();
    let view = View {
        position: DVec3::ZERO,
        aim: DVec3::Y,
        up: DVec3::Z,
        rows: SIDE,
        columns: SIDE,
        lens,
    };
    let camera = Camera::new(view).unwrap();
    let edges = Edges { width: 2.0, ..only(&[EdgeKind::Boundary]) };
    let covered = covered(&wall, &camera, &edges);
    for k in -80..=80 {
        let point = DVec3::new(0.1 * f64::from(k), 5.0, -1.0);
        let at = camera.project(point).unwrap();
        let there = covered[at.y as usize * SIDE + at.x as usize];
        assert!(there > 0.7, "{k} {there}");
    }
}

/// Turned by some columns, a panorama all around is the same picture moved by them, across its
/// edges too.
#[test]
fn lines_continue_across_the_seam_of_a_panorama() {
    let (scene, columns) = (around(), 160);
    let edges = Edges { width: 7.0, ..only(&[EdgeKind::Silhouette, EdgeKind::Boundary]) };
    for projection in [Projection::Equirectangular, Projection::Cylindrical] {
        let turned = |by: usize| {
            let angle = std::f64::consts::TAU * by as f64 / columns as f64;
            let (sine, cosine) = libm::sincos(angle);
            let view = View {
                aim: DVec3::new(sine, cosine, 0.0),
                ..*camera(projection, [80, columns], &[]).view()
            };
            Camera::new(view).unwrap()
        };
        let straight = covered(&scene, &turned(0), &edges);
        for by in (3..columns).step_by(13) {
            let camera = turned(by);
            let whole = covered(&scene, &camera, &edges);
            for (k, &covered) in whole.iter().enumerate() {
                let (row, column) = (k / columns, k % columns);
                let other = straight[row * columns + (column + by) % columns];
                // Pieces are cut in other places.
                assert!((covered - other).abs() < 0.02, "{by} {row} {column}");
            }
            let subject =
                Subject { scene: &scene, camera: &camera, engine: Cpu::shared(), cull: None };
            let lines = Lines::new(&subject, &edges, [0..80, 0..5], &()).unwrap();
            let part = lines.coverage(0..80, 0..5, &()).unwrap();
            for (k, covered) in part.iter().enumerate() {
                assert_eq!(*covered, whole[k / 5 * columns + k % 5]);
            }
        }
    }
}
