//! Every lens: its rays and `project` are inverse to each other, and its hits are those of brute
//! force.

#![allow(
    clippy::large_types_passed_by_value,
    clippy::disallowed_methods,
    clippy::too_many_lines,
    reason = "any rounding will do for the shapes of lenses"
)]

use firsthit::camera::{Calibrated, Convention, PixelMatrix, distortion};
use firsthit::geometry::Rays;
use firsthit::image::CameraRecord;
use firsthit::sensor::{camera_of, camera_record};
use firsthit::shoot::{BruteForce, Cpu, Engine, First};
use firsthit::{
    Camera, DVec2, DVec3, Lens, Mesh, Object, Projection, Scene, Sphere, View, Viewplane,
};

const ROWS: usize = 48;
const COLUMNS: usize = 64;

/// A view at nowhere in particular.
fn view(lens: Lens) -> View {
    View {
        position: DVec3::new(0.3, -4.0, 1.7),
        aim: DVec3::new(-0.2, 1.0, -0.3),
        up: DVec3::new(0.1, 0.2, 1.0),
        rows: ROWS,
        columns: COLUMNS,
        lens,
    }
}

/// A lens' own numbers, those of real calibrations where there are such.
#[rustfmt::skip]
fn own_numbers(projection: Projection) -> &'static [(&'static str, f64)] {
    match projection {
        Projection::Perspective => &[
            ("shift_x", 0.2), ("shift_y", -0.1), ("tilt_x", 8.0), ("tilt_y", -5.0), ("skew", 0.02),
        ],
        Projection::Orthographic => &[("width", 4.0), ("height", 3.0), ("shift_x", 0.5)],
        Projection::Equirectangular => &[("horizontal_fov", 300.0)],
        Projection::Cylindrical | Projection::CubeMap | Projection::Octahedral => &[],
        Projection::OpenCv => &[
            ("k1", -0.28), ("k2", 0.09), ("p1", 0.001), ("p2", -0.002), ("k3", -0.01),
            ("s1", 0.001), ("s3", -0.0005), ("tau_x", 0.02), ("tau_y", -0.03),
        ],
        Projection::OpenCvFisheye => &[("k1", -0.03), ("k2", 0.01), ("k3", -0.004)],
        Projection::KannalaBrandt => &[("k1", 0.98), ("k2", -0.02), ("k3", 0.001)],
        Projection::DoubleSphere => &[("xi", -0.2), ("alpha", 0.6)],
        Projection::Eucm => &[("alpha", 0.6), ("beta", 1.1)],
        Projection::Ucm => &[("alpha", 0.55)],
        Projection::Mei => &[("xi", 1.4), ("k1", -0.2), ("k2", 0.1), ("p1", 0.001)],
        Projection::Fov => &[("omega", 0.92)],
        Projection::ThinPrismFisheye => &[
            ("k1", -0.05), ("k2", 0.01), ("p1", 0.001), ("p2", -0.002), ("k3", -0.002),
            ("k4", 0.0005), ("sx1", 0.002), ("sy1", -0.001),
        ],
        Projection::RadTanThinPrismFisheye => &[
            ("k0", -0.03), ("k1", 0.02), ("k2", -0.01), ("k3", 0.003), ("k4", -0.0005),
            ("k5", 0.00002), ("p0", 0.001), ("p1", -0.0005), ("s0", -0.001), ("s1", 0.0002),
            ("s2", 0.0005), ("s3", -0.0001),
        ],
        Projection::Equidistant | Projection::Equisolid => &[("fov", 210.0)],
        Projection::Stereographic => &[("fov", 200.0)],
        Projection::OrthographicFisheye => &[("fov", 170.0)],
    }
}

/// One of each.
fn lenses() -> Vec<(Projection, Lens)> {
    let matrix = [52.0, 49.0, 30.3, 25.1, 0.4];
    let matrix: Vec<_> = ["fx", "fy", "cx", "cy", "skew"].into_iter().zip(matrix).collect();
    let lens = |&projection: &Projection| {
        let default = Lens::named(projection, &[]).unwrap();
        let is_calibrated = default.parameters().iter().any(|&(name, _)| name == "fx");
        let mut numbers = own_numbers(projection).to_vec();
        numbers.extend(matrix.iter().filter(|_| is_calibrated));
        (projection, Lens::named(projection, &numbers).unwrap())
    };
    Projection::ALL.iter().map(lens).collect()
}

fn camera(lens: Lens) -> Camera {
    let view = view(lens);
    // A cross of six faces needs four columns for three rows: 48 x 64 is one.
    Camera::new(view).unwrap()
}

#[test]
fn rays_and_project_are_inverse_to_each_other() {
    for (projection, lens) in lenses() {
        let camera = camera(lens);
        let mut seen = 0;
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                for offset in [DVec2::splat(0.5), DVec2::new(0.1, 0.8)] {
                    let ray = camera.ray_within(row, column, offset);
                    if !ray.is_valid() {
                        continue;
                    }
                    seen += 1;
                    assert!((ray.direction.length() - 1.0).abs() < 1e-15);
                    let expected =
                        DVec2::new(column as f64 + offset.x, row as f64 + 1.0 - offset.y);
                    let pixel = camera.project(ray.at(3.0));
                    let off = pixel.map(|pixel| (pixel - expected).length());
                    assert!(
                        off.is_some_and(|off| off < 1e-9),
                        "{projection:?} {row} {column}: {pixel:?}"
                    );
                }
            }
        }
        assert!(2 * seen > ROWS * COLUMNS, "{projection:?}: {seen}");
    }
}

#[test]
fn the_place_of_the_camera_is_seen_by_parallel_rays_alone() {
    for (projection, lens) in lenses() {
        let camera = camera(lens);
        let is_seen = camera.project(camera.position()).is_some();
        assert_eq!(is_seen, projection == Projection::Orthographic, "{projection:?}");
    }
}

#[test]
fn a_record_gives_the_camera_back_to_the_bit() {
    for (projection, lens) in lenses() {
        let camera = camera(lens);
        let text = serde_json::to_string(&camera_record(&camera)).unwrap();
        let record: CameraRecord = serde_json::from_str(&text).unwrap();
        let again = camera_of(&record).unwrap();
        assert_eq!(again, camera, "{projection:?}");
        for pixel in [0, 700, ROWS * COLUMNS - 1] {
            let [own, other] = [&camera, &again].map(|camera| Rays::ray(camera, pixel));
            let bits = |v: DVec3| v.to_array().map(f64::to_bits);
            assert_eq!(bits(own.direction), bits(other.direction));
            assert_eq!(bits(own.origin), bits(other.origin));
        }
    }
}

/// A bumpy ball of triangles around a smooth one, and an instance of it.
fn scene() -> Scene {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let (rings, sides) = (20_u32, 30_u32);
    for i in 0..=rings {
        for j in 0..sides {
            let theta = std::f64::consts::PI * f64::from(i) / f64::from(rings);
            let phi = std::f64::consts::TAU * f64::from(j) / f64::from(sides);
            let radius = 1.5 + 0.1 * f64::from((i * 7 + j * 13) % 5);
            let (sin, cos) = theta.sin_cos();
            vertices.push((radius * DVec3::new(sin * phi.cos(), sin * phi.sin(), cos)).to_array());
            if i < rings {
                let at = |i: u32, j: u32| i * sides + j % sides;
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    let mesh =
        std::sync::Arc::new(Mesh::new(firsthit::Positions::compact(vertices), triangles).unwrap());
    let ball = Object::new(mesh.clone());
    let aside = firsthit::Transform::new(firsthit::geometry::DAffine3::from_translation(
        DVec3::new(3.0, 1.0, 0.5),
    ));
    let other = Object::new(mesh).placed(aside.unwrap());
    let smooth = Object::new(Sphere::new(DVec3::new(-3.0, 0.0, 1.0), 1.0).unwrap());
    Scene::new(vec![ball, other, smooth]).unwrap()
}

#[test]
fn every_lens_meets_what_brute_force_meets() {
    let scene = scene();
    for (projection, lens) in lenses() {
        let camera = camera(lens);
        let by_cpu = Cpu::default();
        let [fast, slow] = [&by_cpu as &dyn Engine, &BruteForce].map(|engine| {
            firsthit::shoot::trace_with(engine, &scene, &camera, First, &()).unwrap()
        });
        let hits = fast.object.iter().filter(|&&object| object >= 0).count();
        assert!(hits > 40, "{projection:?}: {hits}");
        assert_eq!(fast.object, slow.object, "{projection:?}");
        assert_eq!(fast.primitive, slow.primitive, "{projection:?}");
        let bits = |t: &[f64]| t.iter().map(|t| t.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&fast.t), bits(&slow.t), "{projection:?}");
    }
}

#[test]
fn z_and_range_are_those_of_the_true_ray() {
    for (projection, lens) in lenses() {
        let camera = camera(lens);
        for (row, column) in [(24, 32), (20, 40), (30, 20)] {
            let ray = camera.ray(row, column);
            assert!(ray.is_valid(), "{projection:?}");
            let from_camera = ray.at(2.5) - camera.position();
            let z = from_camera.dot(camera.aim());
            assert!((camera.z(row, column, 2.5) - z).abs() < 1e-12, "{projection:?}");
            if projection != Projection::Orthographic {
                let range = from_camera.length();
                assert!((camera.range(row, column, 2.5) - range).abs() < 1e-12, "{projection:?}");
            }
        }
    }
}

#[test]
fn a_part_of_a_picture_has_the_rays_of_the_whole() {
    for (projection, lens) in lenses() {
        let camera = camera(lens);
        let Ok(part) = camera.crop(7..31, 12..52) else {
            assert!(lens.is_panorama(), "{projection:?}");
            continue;
        };
        assert_eq!((part.rows(), part.columns()), (24, 40));
        for (row, column) in [(0, 0), (5, 39), (23, 20)] {
            let (own, whole) = (part.ray(row, column), camera.ray(row + 7, column + 12));
            if !whole.is_valid() {
                assert!(!own.is_valid());
                continue;
            }
            let off =
                (own.direction - whole.direction).length() + (own.origin - whole.origin).length();
            assert!(off < 1e-13, "{projection:?}: {off}");
        }
        let (own, whole) = (part.pixel_matrix(), camera.pixel_matrix());
        if let (Some(own), Some(whole)) = (own, whole) {
            assert!((own.cx - whole.cx + 12.0).abs() < 1e-12, "{projection:?}");
            assert!((own.cy - whole.cy + 7.0).abs() < 1e-12);
        }
    }
    assert!(camera(Lens::default()).crop(3..3, 0..4).is_err());
    assert!(camera(Lens::default()).crop(0..49, 0..4).is_err());
}

#[test]
fn a_binned_picture_sees_the_same() {
    for (projection, lens) in lenses() {
        let camera = camera(lens);
        let half = camera.resize(ROWS / 2, COLUMNS / 2).unwrap();
        // The middle of four pixels is that of the one that they become.
        let (own, whole) = (half.ray(11, 17), camera.ray_within(23, 35, DVec2::new(0.0, 1.0)));
        let corner = camera.ray_within(22, 34, DVec2::new(1.0, 0.0));
        assert!((corner.direction - whole.direction).length() < 2e-2);
        let off = (own.direction - corner.direction).length();
        assert!(off < 1e-13, "{projection:?}: {off}");
    }
}

/// A K that is not centred goes in and comes out.
#[test]
fn an_intrinsic_matrix_survives_the_viewplane() {
    let k = PixelMatrix { fx: 812.0, fy: 790.5, cx: 301.25, cy: 260.75, skew: 1.5 };
    let view = View::default();
    let lens = Lens::Flat(Viewplane::from_pixel_matrix(&k, view.rows, view.columns).unwrap());
    let camera = Camera::new(View { lens, ..view }).unwrap();
    let own = camera.pixel_matrix().unwrap();
    let pairs =
        [(own.fx, k.fx), (own.fy, k.fy), (own.cx, k.cx), (own.cy, k.cy), (own.skew, k.skew)];
    for (own, given) in pairs {
        assert!((own - given).abs() < 1e-12 * given.abs().max(1.0), "{own} {given}");
    }
    // By the definition of K.
    let point = DVec3::new(0.3, -0.2, -2.0);
    let (x, y) = (point.x / 2.0, -point.y / 2.0);
    let expected = DVec2::new(k.fx * x + k.skew * y + k.cx, k.fy * y + k.cy);
    assert!((camera.project(point).unwrap() - expected).length() < 1e-11);
    for &convention in Convention::ALL {
        let there = convention.own_pixel_matrix(convention.pixel_matrix(k));
        assert_eq!(there, k);
    }
}

#[test]
fn beyond_the_fold_there_is_no_ray() {
    // r (1 - 0.5 r²) is largest at r² = 2/3, where it is (2/3)^1.5.
    let matrix = PixelMatrix { fx: 100.0, fy: 100.0, cx: 100.0, cy: 100.0, skew: 0.0 };
    let barrel = distortion::OpenCv { k1: -0.5, ..distortion::OpenCv::default() };
    let lens = Lens::OpenCv(Calibrated::new(matrix, barrel));
    let camera = Camera::new(View { rows: 200, columns: 200, lens, ..View::default() }).unwrap();
    let fold = 100.0 * (2.0_f64 / 3.0).powf(1.5);
    for row in 0..200 {
        for column in 0..200 {
            let off = DVec2::new(column as f64 - 99.5, row as f64 - 99.5).length();
            assert_eq!(camera.ray(row, column).is_valid(), off < fold, "{row} {column}");
        }
    }
    let radius = (2.0_f64 / 3.0).sqrt();
    let aside = |r: f64| camera.project(DVec3::new(r, 0.0, -1.0));
    assert!(aside(0.999 * radius).is_some());
    assert!(aside(1.001 * radius).is_none());
    // Where the polynomial has come back.
    assert!(aside(1.5).is_none());
}

/// Of double spheres too: where the second sphere folds, and where the first does, whose centre is
/// then inside the second.
#[test]
fn directions_of_double_spheres_do_not_share_a_pixel() {
    let of = |xi: f64, alpha: f64| {
        let own = [("xi", xi), ("alpha", alpha)];
        calibrated(Projection::DoubleSphere, 60.0, &own)
    };
    let camera = of(-0.7751, 0.8668);
    // To the right, down and ahead.
    let seen = |[x, y, z]: [f64; 3]| camera.project(DVec3::new(x, -y, -z));
    assert_eq!(seen([0.6444, 0.4649, 0.6071]), None);
    assert!(seen([0.5758, 0.4154, 0.7042]).is_some());
    let pairs = [(-0.7751, 0.8668), (-0.2, 0.6), (0.5, 0.5), (1.0, 0.4), (1.4, 0.7)];
    for (xi, alpha) in pairs {
        let camera = of(xi, alpha);
        let radii = (0..1000).map(|k| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(k) / 1000.0).sin_cos();
            let pixel = camera.project(DVec3::new(sin, 0.0, -cos));
            pixel.map(|pixel| pixel.x)
        });
        let radii: Vec<Option<f64>> = radii.collect();
        let seen = radii.iter().take_while(|radius| radius.is_some()).count();
        assert!(seen > 200, "{xi} {alpha}: {seen}");
        assert!(radii[..seen].is_sorted_by(|a, b| a < b), "{xi} {alpha}");
        assert!(radii[seen..].iter().all(Option::is_none), "{xi} {alpha}");
    }
}

#[test]
fn an_opencv_fisheye_ends_at_its_field_of_view() {
    let own = [("k1", 0.02), ("fov", 120.0)];
    let camera = calibrated(Projection::OpenCvFisheye, 80.0, &own);
    let edge = std::f64::consts::FRAC_PI_3;
    let radius = 80.0 * edge * (1.0 + 0.02 * edge * edge);
    for column in 0..200 {
        let off = (column as f64 - 99.5).abs();
        let ray = camera.ray_within(100, column, DVec2::new(0.5, 1.0));
        assert_eq!(ray.is_valid(), off < radius, "{column}");
    }
    // It touches the longer edges, and is said again.
    let lens = Lens::with_fov(Projection::OpenCvFisheye, 180.0, ROWS, COLUMNS).unwrap();
    let whole = Camera::new(view(lens)).unwrap();
    assert!(whole.ray(0, COLUMNS / 2).is_valid() && !whole.ray(0, 0).is_valid());
    assert!(lens.parameters().contains(&("fov", 180.0)));
    let text = serde_json::to_string(&camera_record(&whole)).unwrap();
    let record: CameraRecord = serde_json::from_str(&text).unwrap();
    assert_eq!(camera_of(&record).unwrap(), whole);
}

/// A camera whose normalised image is `pixels` to a unit, with the middle of the picture ahead.
fn calibrated(projection: Projection, pixels: f64, own: &[(&str, f64)]) -> Camera {
    let middle = [("fx", pixels), ("fy", pixels), ("cx", 100.0), ("cy", 100.0)];
    let lens = Lens::named(projection, &[&middle[..], own].concat()).unwrap();
    Camera::new(View { rows: 200, columns: 200, lens, ..View::default() }).unwrap()
}

#[test]
fn a_field_of_view_of_zero_is_a_pinhole() {
    let pinhole = calibrated(Projection::OpenCv, 90.0, &[]);
    for omega in [0.0, 1e-200, 1e-9, -1e-9] {
        let camera = calibrated(Projection::Fov, 90.0, &[("omega", omega)]);
        for (row, column) in [(0, 0), (199, 7), (100, 100), (31, 160)] {
            let (own, flat) = (camera.ray(row, column), pinhole.ray(row, column));
            assert!((own.direction - flat.direction).length() < 1e-15, "{omega}");
            let [own, flat] =
                [&camera, &pinhole].map(|camera| camera.project(flat.at(2.0)).unwrap());
            assert!((own - flat).length() < 1e-11, "{omega}: {own} {flat}");
        }
    }
}

/// An undistorted radius of 1/2 is the one that the model keeps, whatever `omega` is; radii are
/// then angles in units of `omega`.
#[test]
fn half_a_unit_off_the_middle_stays_where_it_is() {
    for omega in [0.3_f64, 1.0, 2.5, -1.0] {
        let camera = calibrated(Projection::Fov, 100.0, &[("omega", omega)]);
        let pixel = camera.project(DVec3::new(0.5, 0.0, -1.0)).unwrap();
        assert!((pixel - DVec2::new(150.0, 100.0)).length() < 1e-11, "{omega}: {pixel}");
        // A right angle to the axis is at pi / (2 omega), and nothing is behind it.
        let edge = 100.0 * std::f64::consts::FRAC_PI_2 / omega.abs();
        for column in 0..200 {
            let ray = camera.ray_within(99, column, DVec2::new(0.5, 0.0));
            let off = (column as f64 + 0.5 - 100.0).abs();
            assert_eq!(ray.is_valid(), off < edge, "{omega} {column}");
        }
        assert_eq!(camera.project(DVec3::new(1.0, 0.0, 1e-9)), None);
    }
}

/// A radial fold of the polynomials: a (1 - 0.1 a²) is largest at a² = 10 / 3.
#[test]
fn thin_prism_fisheyes_end_at_the_fold() {
    let cases: [(_, &[(&str, f64)], f64); 4] = [
        (Projection::ThinPrismFisheye, &[("k1", -0.1)], 0.0),
        (Projection::RadTanThinPrismFisheye, &[("k0", -0.1)], 0.0),
        (Projection::ThinPrismFisheye, &[("k1", -0.1), ("p1", 1e-4), ("sx1", -2e-4)], 0.1),
        (Projection::RadTanThinPrismFisheye, &[("k0", -0.1), ("p0", 1e-4), ("s2", 2e-4)], 0.1),
    ];
    let angle = (10.0_f64 / 3.0).sqrt();
    let fold = 60.0 * angle * 2.0 / 3.0;
    for (projection, own, blurred) in cases {
        let camera = calibrated(projection, 60.0, own);
        for row in 0..200 {
            for column in 0..200 {
                let off = DVec2::new(column as f64 - 99.5, row as f64 - 99.5).length();
                if (off - fold).abs() > blurred {
                    let is_valid = camera.ray(row, column).is_valid();
                    assert_eq!(is_valid, off < fold, "{projection:?} {row} {column}");
                }
            }
        }
        for k in 0..40 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 40.0).sin_cos();
            let toward = |angle: f64| {
                let aside = angle.sin();
                camera.project(DVec3::new(aside * cos, aside * sin, -angle.cos()))
            };
            assert!(toward(0.99 * angle).is_some(), "{projection:?}");
            assert!(toward(1.01 * angle).is_none(), "{projection:?}");
            assert!(toward(3.1).is_none(), "{projection:?}");
        }
    }
}

/// Without a fold they see all directions but the one straight back, each once.
#[test]
fn thin_prism_fisheyes_see_behind_the_camera() {
    for (projection, own) in [
        (Projection::ThinPrismFisheye, [("k1", 0.002), ("sx1", 1e-3)]),
        (Projection::RadTanThinPrismFisheye, [("k0", 0.002), ("s0", 1e-3)]),
    ] {
        let camera = calibrated(projection, 25.0, &own);
        let mut behind = 0;
        for row in 0..200 {
            for column in 0..200 {
                let ray = camera.ray(row, column);
                if !ray.is_valid() {
                    continue;
                }
                behind += usize::from(ray.direction.z > 0.0);
                let pixel = camera.project(ray.at(1.0)).unwrap();
                let expected = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let off = (pixel - expected).length();
                assert!(off < 1e-10, "{projection:?} {row} {column}: {off}");
            }
        }
        assert!(behind > 12_000, "{projection:?}: {behind}");
        assert_eq!(camera.project(DVec3::Z), None);
    }
}

/// Without tangential and thin prism distortion they are OpenCV's fisheye, and without radial
/// distortion in front of it equidistant.
#[test]
fn thin_prism_fisheyes_without_a_prism_are_opencvs() {
    let series = [0.03, -0.01, 0.002, -0.0003];
    let named =
        |names: [&'static str; 4]| std::array::from_fn::<_, 4, _>(|k| (names[k], series[k]));
    let reference = calibrated(Projection::OpenCvFisheye, 70.0, &named(["k1", "k2", "k3", "k4"]));
    for (projection, names) in [
        (Projection::ThinPrismFisheye, ["k1", "k2", "k3", "k4"]),
        (Projection::RadTanThinPrismFisheye, ["k0", "k1", "k2", "k3"]),
    ] {
        let camera = calibrated(projection, 70.0, &named(names));
        let mut seen = 0;
        for row in 0..200 {
            for column in 0..200 {
                let [own, other] =
                    [&camera, &reference].map(|camera| camera.ray(row, column).direction);
                assert_eq!(own.is_nan(), other.is_nan(), "{projection:?} {row} {column}");
                if !own.is_nan() {
                    seen += 1;
                    assert!((own - other).length() < 1e-14, "{projection:?}");
                }
            }
        }
        assert!(seen > 20_000, "{seen}");
    }
}

#[test]
fn numbers_that_make_no_lens_are_refused() {
    let bad: &[(Projection, &[(&str, f64)])] = &[
        (Projection::OpenCv, &[("fx", 0.0)]),
        (Projection::OpenCv, &[("fx", 1.0), ("fy", 1.0), ("k1", f64::NAN)]),
        (Projection::DoubleSphere, &[("fx", 1.0), ("fy", 1.0), ("alpha", 1.5)]),
        (Projection::KannalaBrandt, &[("fx", 1.0), ("fy", 1.0), ("k1", -1.0)]),
        (Projection::Fov, &[("fx", 1.0), ("fy", 1.0), ("omega", std::f64::consts::PI)]),
        (Projection::Equirectangular, &[("horizontal_fov", 400.0)]),
        (Projection::Cylindrical, &[("vertical_fov", 180.0)]),
        (Projection::Perspective, &[("tilt_x", 90.0)]),
        (Projection::Orthographic, &[("tilt_x", 10.0)]),
    ];
    for (projection, numbers) in bad {
        let lens = Lens::named(*projection, numbers).unwrap();
        assert!(Camera::new(view(lens)).is_err(), "{projection:?} {numbers:?}");
    }
    let error = Lens::named(Projection::Eucm, &[("k1", 0.1)]).unwrap_err().to_string();
    assert!(error.contains("alpha, beta"), "{error}");
    let cube = Lens::named(Projection::CubeMap, &[]).unwrap();
    assert!(Camera::new(View { rows: 50, columns: 64, lens: cube, ..View::default() }).is_err());
}

/// Solid angles of pixels from their corners add up to the whole sphere.
#[test]
fn a_cube_map_sees_every_direction_once() {
    let lens = Lens::named(Projection::CubeMap, &[]).unwrap();
    for [rows, columns] in [[8, 48], [48, 8], [16, 24], [24, 32]] {
        let camera = Camera::new(View { rows, columns, lens, ..View::default() }).unwrap();
        let mut sum = DVec3::ZERO;
        let mut count = 0;
        for k in 0..rows * columns {
            let ray = Rays::ray(&camera, k);
            if ray.is_valid() {
                sum += ray.direction;
                count += 1;
            }
        }
        assert_eq!(count, 6 * 64);
        assert!(sum.length() < 1e-12, "{sum}");
    }
}
