//! Cameras against the formulas of the specification, in closed form.

use firsthit::camera::Equirectangular;
use firsthit::camera::FovAxis;
use firsthit::{Camera, DVec2, DVec3, Lens, RayStart, View, Viewplane};

fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-14 * (1.0 + a.length())
}

/// The specification's formula, literally: i counts rows from the bottom.
fn literal(view: &View, i: usize, j: usize) -> (DVec3, DVec3) {
    let u_c = view.aim / view.aim.length();
    let c_0 = view.position + view.lens.viewplane().unwrap().focal_length * u_c;
    let u_x = u_c.cross(view.up) / u_c.cross(view.up).length();
    let u_y = (-u_c).cross(u_x);
    let p_x = -view.lens.viewplane().unwrap().width / 2.0
        + view.lens.viewplane().unwrap().width / view.columns as f64 * (j as f64 + 0.5);
    let p_y = -view.lens.viewplane().unwrap().height / 2.0
        + view.lens.viewplane().unwrap().height / view.rows as f64 * (i as f64 + 0.5);
    let p = c_0 + p_x * u_x + p_y * u_y;
    let u_r = if view.lens.viewplane().unwrap().parallel {
        u_c
    } else {
        (p - view.position) / (p - view.position).length()
    };
    (p, u_r)
}

fn views() -> Vec<View> {
    let some = View {
        position: DVec3::new(3.0, -2.0, 1.5),
        aim: DVec3::new(-2.0, 1.0, -0.7),
        up: DVec3::new(0.1, 0.3, 2.0),
        rows: 5,
        columns: 4,
        lens: Lens::Flat(Viewplane {
            focal_length: 0.8,
            width: 1.9,
            height: 0.7,
            ..Viewplane::default()
        }),
    };
    let mut views = Vec::new();
    for parallel in [false, true] {
        views.push(View {
            lens: Lens::Flat(Viewplane { parallel, ..Viewplane::default() }),
            ..View::default()
        });
        views.push(View {
            lens: Lens::Flat(Viewplane { parallel, ..*some.lens.viewplane().unwrap() }),
            ..some
        });
        views.push(View {
            rows: 1,
            columns: 1,
            lens: Lens::Flat(Viewplane { parallel, ..*some.lens.viewplane().unwrap() }),
            ..some
        });
        views.push(View {
            aim: DVec3::Z,
            up: DVec3::NEG_X,
            lens: Lens::Flat(Viewplane { parallel, ..*some.lens.viewplane().unwrap() }),
            ..some
        });
    }
    views
}

#[test]
fn every_pixels_ray_is_the_formulas_with_row_0_at_the_top() {
    for view in views() {
        let camera = Camera::new(view).unwrap();
        for row in 0..view.rows.min(9) {
            for column in 0..view.columns.min(9) {
                let (p, u_r) = literal(&view, view.rows - 1 - row, column);
                let ray = camera.ray(row, column);
                assert!(
                    close(ray.origin, p) && close(ray.direction, u_r),
                    "{view:?} {row} {column}"
                );
                assert!((ray.direction.length() - 1.0).abs() < 1e-15);
            }
        }
    }
}

#[test]
fn the_frame_is_right_handed_with_the_picture_upright() {
    let camera =
        Camera::new(View { aim: DVec3::new(0.0, 3.0, 0.0), up: DVec3::Z, ..View::default() })
            .unwrap();
    assert_eq!((camera.right(), camera.upwards(), camera.aim()), (DVec3::X, DVec3::Z, DVec3::Y));
    let [top_left, bottom_right] =
        [camera.ray(0, 0), camera.ray(479, 639)].map(|ray| ray.direction);
    assert!(top_left.x < 0.0 && top_left.z > 0.0 && bottom_right.x > 0.0 && bottom_right.z < 0.0);
}

#[test]
fn the_eye_start_keeps_the_directions_and_moves_the_start_back() {
    for view in views() {
        let camera = Camera::new(view).unwrap();
        let eye = camera.starting_at(RayStart::Eye);
        let (a, b) = (camera.ray(0, 0), eye.ray(0, 0));
        assert_eq!(a.direction, b.direction);
        let back = (a.origin - b.origin).length();
        if view.lens.viewplane().unwrap().parallel {
            {
                assert!((b.origin - view.position).dot(eye.aim()).abs() < 1e-14);
            }
        } else {
            assert_eq!(b.origin, view.position);
        }
        assert!((camera.range(0, 0, 2.0) - (2.0 + back)).abs() < 1e-14);
        assert_eq!(eye.range(0, 0, 2.0), 2.0);
    }
}

#[test]
fn range_and_z_are_what_their_definitions_say() {
    for view in views() {
        let camera = Camera::new(view).unwrap();
        for (row, column) in [(0, 0), (view.rows - 1, view.columns / 2)] {
            let ray = camera.ray(row, column);
            let hit = ray.at(7.25);
            let z = (hit - view.position).dot(camera.aim());
            assert!((camera.z(row, column, 7.25) - z).abs() < 1e-13, "{view:?}");
            let range = if view.lens.viewplane().unwrap().parallel {
                z
            } else {
                (hit - view.position).length()
            };
            assert!((camera.range(row, column, 7.25) - range).abs() < 1e-13, "{view:?}");
            assert_eq!(camera.range(row, column, f64::INFINITY), f64::INFINITY);
            assert_eq!(camera.z(row, column, f64::INFINITY), f64::INFINITY);
        }
    }
}

#[test]
fn points_of_a_pixel_run_rightwards_and_upwards() {
    let camera = Camera::new(View::default()).unwrap();
    let middle = camera.ray_within(10, 20, DVec2::new(0.5, 0.5));
    assert_eq!(middle, camera.ray(10, 20));
    let corner = camera.ray_within(10, 20, DVec2::new(1.0, 1.0));
    assert!(close(corner.origin, camera.ray_within(9, 21, DVec2::ZERO).origin));
}

/// A camera as far away as the moon is from a watch still tells its pixels apart.
#[test]
fn directions_do_not_suffer_from_a_far_position() {
    let near = Camera::new(View {
        lens: Lens::Flat(Viewplane { width: 0.01, height: 0.01, ..Viewplane::default() }),
        ..View::default()
    })
    .unwrap();
    let far = Camera::new(View { position: DVec3::splat(4e11), ..*near.view() }).unwrap();
    assert_eq!(near.ray(3, 5).direction, far.ray(3, 5).direction);
}

#[test]
fn look_at_has_its_field_of_view_between_the_edges() {
    let position = DVec3::new(1.0, 2.0, 3.0);
    let camera =
        Camera::look_at(position, DVec3::new(1.0, 2.0, -4.0), DVec3::Y, 90.0, 200, 300).unwrap();
    let view = camera.view();
    assert_eq!(view.lens.viewplane().unwrap().ray_start, RayStart::Eye);
    assert!(
        (view.lens.viewplane().unwrap().height / 2.0 / view.lens.viewplane().unwrap().focal_length
            - 1.0)
            .abs()
            < 1e-15
    );
    assert!(
        (view.lens.viewplane().unwrap().width / view.lens.viewplane().unwrap().height - 1.5).abs()
            < 1e-15
    );
    assert_eq!(camera.aim(), DVec3::NEG_Z);
}

fn viewplane(view: &mut View) -> &mut Viewplane {
    match &mut view.lens {
        Lens::Flat(viewplane) => viewplane,
        _ => panic!("it has no viewplane"),
    }
}

/// Longitude and latitude of a direction, in degrees, as seen from a camera.
fn angles(camera: &Camera, direction: DVec3) -> (f64, f64) {
    let along = |axis: DVec3| direction.dot(axis);
    let longitude = libm::atan2(along(camera.right()), along(camera.aim()));
    (longitude.to_degrees(), libm::asin(along(camera.upwards())).to_degrees())
}

#[test]
fn a_panorama_has_degrees_for_columns_and_rows() {
    let camera = Camera::new(View {
        position: DVec3::new(5.0, 6.0, 7.0),
        aim: DVec3::new(1.0, 2.0, -0.5),
        up: DVec3::Z,
        rows: 18,
        columns: 36,
        lens: Lens::Equirectangular(Equirectangular::default()),
    })
    .unwrap();
    for row in 0..18 {
        for column in 0..36 {
            let ray = camera.ray(row, column);
            assert_eq!(ray.origin, camera.position());
            assert!((ray.direction.length() - 1.0).abs() < 1e-15);
            let (longitude, latitude) = angles(&camera, ray.direction);
            assert!((longitude - (10.0 * column as f64 - 175.0)).abs() < 1e-12);
            assert!((latitude - (85.0 - 10.0 * row as f64)).abs() < 1e-12);
            assert_eq!(camera.range(row, column, 3.0), 3.0);
            let z = 3.0 * ray.direction.dot(camera.aim());
            assert!((camera.z(row, column, 3.0) - z).abs() < 1e-15);
        }
    }
    // Offsets run rightwards and upwards.
    let corner = camera.ray_within(4, 20, DVec2::new(1.0, 1.0)).direction;
    let (longitude, latitude) = angles(&camera, corner);
    assert!((longitude - 30.0).abs() < 1e-12 && (latitude - 50.0).abs() < 1e-12);
    assert_eq!(camera.intrinsic_matrix(), None);
}

type Change<'a> = (&'a str, &'a dyn Fn(&mut View));

#[test]
fn what_makes_no_sense_is_refused_with_its_name() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let parallel = DVec3::new(-1.8, -1.8, 1.2);
    let changes: [Change; 12] = [
        ("aim", &|view| view.aim = DVec3::ZERO),
        ("aim", &|view| view.aim.x = nan),
        ("up", &|view| view.up = DVec3::ZERO),
        ("up", &|view| view.up = DVec3::new(0.0, 0.0, 1e200)),
        ("up", &|view| {
            (view.aim, view.up) = (parallel / -3.0, parallel);
        }),
        ("position", &|view| view.position.y = inf),
        ("focal_length", &|view| {
            viewplane(view).focal_length = 0.0;
        }),
        ("focal_length", &|view| {
            viewplane(view).focal_length = -1.0;
        }),
        ("width", &|view| viewplane(view).width = nan),
        ("height", &|view| viewplane(view).height = inf),
        ("rows", &|view| view.rows = 0),
        ("columns", &|view| view.columns = 0),
    ];
    for (name, change) in changes {
        let mut view = View::default();
        change(&mut view);
        let message = Camera::new(view).unwrap_err().to_string();
        let named = message.starts_with(&format!("{name} must be "));
        assert!(named && message.contains(", got "), "{message}");
    }
}

#[test]
fn an_up_that_is_almost_the_aim_will_do() {
    let up = DVec3::new(1e-9, 0.0, -1.0);
    assert!(Camera::new(View { up, ..View::default() }).is_ok());
}

#[test]
fn a_field_of_view_is_the_angle_between_edges_or_corners() {
    let (rows, columns) = (30, 40);
    // The middles of opposite edges, and opposite corners, in columns and rows from the upper left.
    for (axis, [from, to]) in [
        (FovAxis::Vertical, [(20.0, 0.0), (20.0, 30.0)]),
        (FovAxis::Horizontal, [(0.0, 15.0), (40.0, 15.0)]),
        (FovAxis::Diagonal, [(0.0, 0.0), (40.0, 30.0)]),
    ] {
        for fov in [1.0, 45.0, 90.0, 170.0] {
            let viewplane = Viewplane::with_fov(fov, axis, rows, columns).unwrap();
            let [width, height] = [viewplane.width, viewplane.height];
            assert!((width / height - 4.0 / 3.0).abs() < 1e-15);
            let direction = |(x, y): (f64, f64)| {
                DVec3::new(width * (x / 40.0 - 0.5), height * (0.5 - y / 30.0), 1.0)
            };
            let angle = direction(from).angle_between(direction(to)).to_degrees();
            assert!((angle - fov).abs() < 1e-9, "{axis:?} {fov}: {angle}");
        }
    }
}

#[test]
fn look_at_refuses_angles_and_targets_that_show_nothing() {
    for fov in [0.0, 180.0, -10.0, f64::NAN] {
        assert!(Camera::look_at(DVec3::ZERO, DVec3::X, DVec3::Z, fov, 4, 4).is_err());
    }
    assert!(Camera::look_at(DVec3::X, DVec3::X, DVec3::Z, 45.0, 4, 4).is_err());
}

/// The product of two directions that are nearly the same is mostly rounding; the frame must be one
/// all the same.
#[test]
fn the_frame_is_orthonormal_however_close_up_is_to_aim() {
    let mut accepted = 0;
    for k in 0..200 {
        let aim = DVec3::new(0.3, -0.7, 0.1 + 0.01 * f64::from(k));
        for apart in [1e-3, 1e-8, 1e-12, 1e-14, 3e-15] {
            let up = aim + apart * DVec3::new(0.5, 1.0, -0.3);
            let Ok(camera) = Camera::new(View { aim, up, ..View::default() }) else {
                continue;
            };
            let (right, upwards) = (camera.right(), camera.upwards());
            for (a, b, expected) in [
                (right, camera.aim(), 0.0),
                (upwards, camera.aim(), 0.0),
                (right, upwards, 0.0),
                (right, right, 1.0),
                (upwards, upwards, 1.0),
            ] {
                assert!((a.dot(b) - expected).abs() < 1e-15, "{aim} {up} {a} {b}");
            }
            accepted += 1;
        }
    }
    assert!(accepted > 600, "{accepted}");
}

#[test]
fn no_columns_are_refused_by_their_own_name() {
    for camera in [
        Camera::look_at(DVec3::ZERO, DVec3::X, DVec3::Z, 40.0, 5, 0),
        Camera::new(View {
            columns: 0,
            lens: Lens::Flat(Viewplane::with_fov(40.0, FovAxis::Vertical, 480, 0).unwrap()),
            ..View::default()
        }),
    ] {
        let error = camera.unwrap_err().to_string();
        assert_eq!(error, "columns must be at least 1, got 0");
    }
}

#[test]
fn a_camera_that_was_taken_apart_is_the_same_to_the_last_bit() {
    let mut changed_by_new = 0;
    for k in 0..1000 {
        let place = |step: f64| (step * f64::from(k)).fract() - 0.5;
        let aim = DVec3::new(place(0.618_034), place(0.414_214), place(0.732_051) + 1.0);
        let camera =
            Camera::new(View { aim, up: DVec3::new(0.3, -2.0, 5.0), ..View::default() }).unwrap();
        assert_eq!(Camera::from_view_exact(*camera.view()).unwrap(), camera);
        changed_by_new += usize::from(Camera::new(*camera.view()).unwrap() != camera);
    }
    assert!(changed_by_new > 0, "there is no need for it");
    let view = View { aim: DVec3::new(0.0, 0.0, -2.0), ..View::default() };
    let message = Camera::from_view_exact(view).unwrap_err().to_string();
    assert!(message.starts_with("aim must be of length one"), "{message}");
}
