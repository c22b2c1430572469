//! Cameras with an aperture: what is in focus, how large the rest becomes, and what does not see
//! the lens.

#![allow(clippy::large_types_passed_by_value, reason = "a camera is handed over whole")]

use firsthit::camera::{
    Aim, Calibrated, Description, Equirectangular, Focus, Opening, PixelMatrix, distortion,
};
use firsthit::channel::{ChannelKind, KINDS, kind};
use firsthit::geometry::Bounds;
use firsthit::image::Frame;
use firsthit::render::{Picture, Sample};
use firsthit::scene::Background;
use firsthit::sensor::{Pushbroom, Readout, RollingShutter, Sensor, camera_of, camera_record};
use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{
    Camera, Color, Cuboid, DAffine3, DVec2, DVec3, Disc, InstructionSet, Lens, Object, Pose,
    Projection, RayStart, Rays, Render, Scene, Shader, Trajectory, View, Viewplane, example,
    render,
};

use crate::support::{is_full, on_threads};

/// A thin lens, off the middle and with a skew.
fn skewed(rows: usize, columns: usize) -> Camera {
    let matrix = PixelMatrix {
        fx: 200.0,
        fy: 180.0,
        cx: 0.5 * columns as f64 + 7.3,
        cy: 0.5 * rows as f64 - 4.1,
        skew: 40.0,
    };
    let view = View {
        position: DVec3::new(3.0, -2.0, 1.0),
        aim: DVec3::new(0.2, 0.3, -1.0),
        up: DVec3::new(0.1, 1.0, 0.3),
        rows,
        columns,
        lens: Lens::Flat(Viewplane::from_pixel_matrix(&matrix, rows, columns).unwrap()),
    };
    Camera::new(view).unwrap().thin_lens(0.5, 4.0).unwrap()
}

/// Each pixel's first number.
fn values(frame: &Frame, name: &str) -> Vec<f64> {
    let channel = frame.channel(name).unwrap();
    let count = channel.data.len() / channel.components;
    (0..count).map(|k| channel.data.value(k * channel.components)).collect()
}

fn bits(frame: &Frame, name: &str) -> Vec<u64> {
    let data = &frame.channel(name).unwrap().data;
    (0..data.len()).map(|k| data.value(k).to_bits()).collect()
}

/// White things before black.
fn flat(scene: &Scene, camera: Camera, samples: u32) -> Render<'_> {
    Render::new(scene)
        .camera(camera)
        .samples(samples)
        .background(Background::Uniform(Color::ZERO))
        .shade(Shader::named("unlit").unwrap())
}

/// The circle of confusion: a point at the distance z becomes a disc of the diameter
/// `aperture |z - focus| / (z focus)` at distance one, and of a disc of radius r the mean of x^2 is
/// r^2 / 4. That of a small disc in the scene adds to it, and that of a pixel, 1/12.
#[test]
fn a_small_disc_out_of_focus_has_the_moments_of_its_circle_of_confusion() {
    let (rows, columns, samples) = (64, 64, 256);
    let camera = skewed(rows, columns);
    let matrix = camera.pixel_matrix().unwrap();
    for depth in [2.0, 3.0, 4.0, 8.0, 30.0] {
        let radius = 0.01 * depth;
        let centre = camera.position() + depth * camera.aim() - 0.05 * depth * camera.right();
        let disc = Disc::new(centre, camera.aim(), radius).unwrap();
        let scene = Scene::new(vec![Object::new(disc)]).unwrap();
        let frame = flat(&scene, camera, samples).frame().unwrap();
        let shares = values(&frame, "color");
        let place = |k: usize| DVec2::new((k % columns) as f64 + 0.5, (k / columns) as f64 + 0.5);
        let sum: f64 = shares.iter().sum();
        let mean = |of: &dyn Fn(DVec2) -> f64| {
            let weighted = shares.iter().enumerate().map(|(k, share)| share * of(place(k)));
            weighted.sum::<f64>() / sum
        };
        let middle = DVec2::new(mean(&|p| p.x), mean(&|p| p.y));
        let seen = camera.project(centre).unwrap();
        assert!((middle - seen).abs().max_element() < 0.2, "{depth}: {middle} {seen}");

        let blur = 0.5 * 0.5 * (depth - 4.0).abs() / (depth * 4.0);
        let own = radius / depth;
        let moment = (blur * blur + own * own) / 4.0;
        let (across, down, lean) = (matrix.fx, matrix.fy, matrix.skew);
        let expected = [
            moment * (across * across + lean * lean) + 1.0 / 12.0,
            moment * down * down + 1.0 / 12.0,
            moment * lean * down,
        ];
        let measured = [
            mean(&|p| (p.x - middle.x) * (p.x - middle.x)),
            mean(&|p| (p.y - middle.y) * (p.y - middle.y)),
            mean(&|p| (p.x - middle.x) * (p.y - middle.y)),
        ];
        // Each of the 256 samples sees a dozen pixels of the small disc, some more or less, and so
        // counts more or less.
        let close = 0.03 * expected[0] + 0.05;
        for (measured, expected) in measured.iter().zip(expected) {
            let error = (measured - expected).abs();
            assert!(error < close, "{depth}: {measured} {expected}");
        }
        // Nothing is seen beyond the circle, by a pixel.
        let farthest = |of: &dyn Fn(DVec2) -> f64| {
            let lit = shares.iter().enumerate().filter(|(_, share)| **share > 0.0);
            lit.map(|(k, _)| of(place(k) - seen).abs()).fold(0.0, f64::max)
        };
        let most = (blur + own) * down + 1.0;
        let reached = farthest(&|p| p.y);
        assert!(reached < most && reached > most - 2.5, "{depth}: {reached} {most}");
    }
}

/// Flat colours on the plane in focus, whose edges pass no sample by less than rounding: the same
/// hits, so the same bits.
#[test]
fn what_is_in_focus_has_the_bits_of_a_pinhole() {
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 60.0, 60, 80).unwrap();
    let discs = (0..12).map(|k| {
        let angle = 0.7 + 2.4 * f64::from(k);
        let far = 0.13 + 0.11 * f64::from(k);
        let centre = DVec3::new(far * libm::cos(angle), far * libm::sin(angle), -5.0);
        Object::new(Disc::new(centre, DVec3::Z, 0.231).unwrap())
    });
    let scene = Scene::new(discs.collect()).unwrap();
    let sharp = flat(&scene, camera, 64).frame().unwrap();
    let lens = camera.thin_lens(0.8, 5.0).unwrap();
    let focused = flat(&scene, lens, 64).frame().unwrap();
    assert_eq!(bits(&sharp, "color"), bits(&focused, "color"));
    let partly =
        values(&sharp, "color").iter().filter(|&&share| share > 0.0 && share < 1.0).count();
    assert!(partly > 100, "{partly}");
    let elsewhere = flat(&scene, lens.thin_lens(0.8, 4.0).unwrap(), 64).frame().unwrap();
    assert_ne!(bits(&sharp, "color"), bits(&elsewhere, "color"));
}

/// From every sample's point of the lens, through the point in focus that the pinhole's ray goes
/// through.
#[test]
fn rays_of_a_sample_meet_those_of_the_pinhole_in_focus() {
    let camera = skewed(40, 50);
    for start in [RayStart::Eye, RayStart::Viewplane] {
        let camera = camera.starting_at(start);
        let pinhole = camera.thin_lens(0.0, 4.0).unwrap();
        for number in 1..40 {
            let (sample, sharp) = (Sample::new(&camera, number), Sample::new(&pinhole, number));
            let mut eyes = Vec::new();
            for pixel in [0, 49, 777, 1999] {
                let (ray, own) = (sample.ray(pixel), sharp.ray(pixel));
                let ahead = |point: DVec3| (point - camera.position()).dot(camera.aim());
                let at = |ray: &firsthit::Ray, depth: f64| {
                    let slope = ray.direction.dot(camera.aim());
                    ray.at((depth - ahead(ray.origin)) / slope)
                };
                assert!(at(&ray, 4.0).abs_diff_eq(at(&own, 4.0), 1e-12));
                assert!((ray.direction.length() - 1.0).abs() < 1e-15);
                // All start at the eye's depth, or all on the viewplane, whose distance is one.
                let depth = ahead(ray.origin);
                let expected = if start == RayStart::Eye { 0.0 } else { 1.0 };
                assert!((depth - expected).abs() < 1e-12, "{depth}");
                eyes.push(at(&ray, 0.0));
            }
            let from = eyes[0] - camera.position();
            assert!(from.length() < 0.25 && from.length() > 0.0);
            assert!(eyes.iter().all(|eye| eye.abs_diff_eq(eyes[0], 1e-12)));
        }
    }
}

/// Cameras with the distortions that may have a thin lens.
fn distorted() -> [Camera; 2] {
    let matrix = [("fx", 30.0), ("fy", 28.0), ("cx", 26.3), ("cy", 19.1), ("skew", 0.7)];
    let opencv = [("k1", -0.25), ("k2", 0.06), ("p1", 0.01), ("s3", -0.005)];
    let cases: [(_, &[(&str, f64)]); 2] =
        [(Projection::OpenCv, &opencv), (Projection::Fov, &[("omega", 1.1)])];
    cases.map(|(projection, own)| {
        let lens = Lens::named(projection, &[&matrix[..], own].concat()).unwrap();
        Camera::new(View { lens, ..*skewed(40, 50).view() }).unwrap()
    })
}

/// With distortion too each ray goes from its sample's point of the lens to where the pixel's ray
/// through the middle is in focus.
#[test]
fn rays_through_a_distorted_lens_meet_the_chief_rays_in_focus() {
    for pinhole in distorted() {
        let camera = pinhole.thin_lens(0.5, 4.0).unwrap();
        for number in 0..40 {
            let (sample, sharp) = (Sample::new(&camera, number), Sample::new(&pinhole, number));
            let mut seen = 0;
            for pixel in 0..2000 {
                let (ray, own) = (sample.ray(pixel), sharp.ray(pixel));
                assert_eq!(ray.is_valid(), own.is_valid());
                if !own.is_valid() {
                    continue;
                }
                if number == 0 {
                    assert_eq!(ray, own);
                }
                seen += 1;
                assert!((ray.direction.length() - 1.0).abs() < 1e-15);
                let from = ray.origin - camera.position();
                assert!(from.dot(camera.aim()).abs() < 1e-14 && from.length() < 0.25);
                assert_eq!(from.length() > 0.0, number > 0);
                // The closed form: the point of the chief ray at the depth in focus.
                let slope = own.direction.dot(camera.aim());
                let point = own.at(4.0 / slope);
                let expected = (point - ray.origin).normalize();
                // Far off the axis the point is far away.
                assert!(expected.abs_diff_eq(ray.direction, 1e-13), "{pixel}");
            }
            assert!(seen > 1900, "{seen}");
        }
    }
}

/// A point out of focus is seen, from a point of the lens, where the pinhole sees the point in
/// focus behind it.
#[test]
fn the_camera_at_a_point_of_a_distorted_lens_projects_what_its_rays_meet() {
    for pinhole in distorted() {
        let camera = pinhole.thin_lens(0.5, 4.0).unwrap();
        let point = DVec2::new(0.6, -0.7);
        let eye = camera.through(point).unwrap();
        assert_eq!(eye.lens().aperture(), 0.0);
        let aside = 0.25 * (point.x * camera.right() + point.y * camera.upwards());
        assert!(eye.position().abs_diff_eq(camera.position() + aside, 1e-15));
        for pixel in (0..2000).step_by(7) {
            let ray = Rays::ray(&eye, pixel);
            if !ray.is_valid() {
                continue;
            }
            let seen = eye.project(ray.at(2.5)).unwrap();
            let expected = DVec2::new((pixel % 50) as f64 + 0.5, (pixel / 50) as f64 + 0.5);
            assert!((seen - expected).length() < 1e-9, "{pixel}");
            let depth = ray.direction.dot(camera.aim());
            let in_focus = ray.at(4.0 / depth);
            let by_pinhole = pinhole.project(in_focus).unwrap();
            assert!((by_pinhole - expected).length() < 1e-9, "{pixel}");
        }
    }
}

/// Without distortion it is the viewplane's thin lens.
#[test]
fn a_calibrated_lens_without_distortion_blurs_as_a_viewplane() {
    let flat = skewed(30, 40);
    let matrix = flat.pixel_matrix().unwrap();
    let lens = Calibrated::new(matrix, distortion::OpenCv::default());
    let view = View { lens: Lens::OpenCv(lens), ..*flat.view() };
    let calibrated = Camera::new(view).unwrap().thin_lens(0.5, 4.0).unwrap();
    for number in 0..20 {
        let [own, other] = [&calibrated, &flat].map(|camera| Sample::new(camera, number));
        for pixel in 0..1200 {
            let (own, other) = (own.ray(pixel), other.ray(pixel));
            assert!(own.origin.abs_diff_eq(other.origin, 1e-14));
            assert!(own.direction.abs_diff_eq(other.direction, 1e-14));
        }
    }
}

#[test]
fn a_distorted_picture_is_blurred_the_same_by_every_engine() {
    let scene = example::scene().unwrap();
    let view = *example::camera(30, 40).unwrap().view();
    for camera in distorted() {
        // Brute force takes a millisecond for a ray.
        let rows = if is_full() { 12..27 } else { 18..22 };
        let part = camera.crop(rows, 15..35).unwrap();
        let part = View { rows: part.rows(), columns: part.columns(), lens: *part.lens(), ..view };
        let pinhole = Camera::new(part).unwrap();
        let camera = pinhole.thin_lens(0.8, 6.0).unwrap();
        let picture = |camera, engine: &dyn Engine| {
            let picture = Render::new(&scene).camera(camera).samples(3).engine(engine);
            picture.channels(&["color", "z"]).frame().unwrap()
        };
        let blurred = picture(camera, Cpu::shared());
        for set in InstructionSet::available() {
            let other = picture(camera, &Cpu::with(set));
            assert!(bits(&other, "color") == bits(&blurred, "color"), "{set:?}");
        }
        let slow = picture(camera, &BruteForce);
        assert!(bits(&slow, "color") == bits(&blurred, "color"));
        let sharp = picture(pinhole, Cpu::shared());
        assert!(bits(&sharp, "color") != bits(&blurred, "color"));
        assert!(bits(&sharp, "z") == bits(&blurred, "z"));
    }
}

#[test]
fn a_distorted_lens_is_kept_by_records_and_descriptions() {
    for camera in distorted() {
        assert!(!camera_record(&camera).parameters.contains_key("aperture"));
        let camera = camera.thin_lens(0.5, 4.0).unwrap();
        let record = camera_record(&camera);
        let numbers = (record.parameters["aperture"], record.parameters["focus"]);
        assert_eq!(numbers, (0.5, 4.0));
        assert_eq!(camera_of(&record).unwrap(), camera);
        let bounds = Bounds { low: DVec3::NEG_ONE, high: DVec3::ONE };
        let support = |direction: DVec3| direction.abs().element_sum();
        let described = Description::of(camera.view());
        let again = described.camera(bounds, support, DVec3::Z).unwrap();
        assert_eq!(again, camera);
        let pinhole = Description { aperture: Some(0.0), ..described };
        let pinhole = pinhole.camera(bounds, support, DVec3::Z).unwrap();
        assert_eq!((pinhole.lens().aperture(), pinhole.lens().focus()), (0.0, 4.0));
        let part = camera.crop(2..20, 3..30).unwrap();
        let moved = camera.moved(&DAffine3::from_translation(DVec3::X)).unwrap();
        for camera in [part, moved, camera.resize(60, 80).unwrap()] {
            let lens = camera.lens();
            assert_eq!((lens.aperture(), lens.focus()), (0.5, 4.0));
        }
    }
}

#[test]
fn fisheyes_and_tilted_sensors_have_no_thin_lens() {
    let matrix = [("fx", 30.0), ("fy", 30.0), ("cx", 20.0), ("cy", 15.0)];
    for &projection in Projection::ALL {
        let lens = Lens::named(projection, &matrix);
        let Ok(lens) = lens else { continue };
        let view = View { rows: 30, columns: 40, lens, ..View::default() };
        let made = Camera::new(view).unwrap().thin_lens(0.1, 2.0);
        assert_eq!(made.is_ok(), projection.has_thin_lens(), "{projection:?}");
        if let Err(error) = made {
            let words = "only perspective cameras, opencv and fov have a thin lens, got";
            assert!(error.to_string().contains(words), "{error}");
            let named = Lens::named(projection, &[("aperture", 0.1)]);
            assert!(named.is_err(), "{projection:?}");
        }
    }
    let tilted = [&matrix[..], &[("tau_x", 0.1)]].concat();
    let lens = Lens::named(Projection::OpenCv, &tilted).unwrap();
    let camera = Camera::new(View { lens, ..View::default() });
    let error = camera.unwrap().thin_lens(0.1, 2.0).unwrap_err().to_string();
    assert!(error.starts_with("aperture must be zero for a tilted sensor"), "{error}");
}

fn small() -> (Scene, Camera) {
    let camera = example::camera(30, 40).unwrap();
    (example::scene().unwrap(), camera.thin_lens(0.4, 6.0).unwrap())
}

#[test]
fn only_colours_see_the_lens() {
    let (scene, camera) = small();
    let names: Vec<&str> = KINDS.iter().map(|kind| &*kind.name).collect();
    let pinhole = camera.thin_lens(0.0, 6.0).unwrap();
    let frame = |camera| {
        let picture = Render::new(&scene).camera(camera).samples(4);
        picture.channels(&names).frame().unwrap()
    };
    let (blurred, sharp) = (frame(camera), frame(pinhole));
    for name in names {
        let is_same = bits(&blurred, name) == bits(&sharp, name);
        let kind = kind(name).unwrap();
        let is_counted = kind.is_sample_count();
        assert_eq!(is_same, !kind.needs_samples() || is_counted, "{name}");
    }
    let rays = |camera: &Camera| (0..1200).map(|k| Rays::ray(camera, k)).collect::<Vec<_>>();
    assert_eq!(rays(&camera), rays(&pinhole));
}

#[test]
fn threads_engines_and_samples_one_by_one_make_the_same_bytes() {
    let (scene, camera) = small();
    let picture_of = |camera: Camera, engine: &dyn Engine| {
        let picture = Render::new(&scene).camera(camera).samples(5).engine(engine);
        bits(&picture.frame().unwrap(), "color")
    };
    let picture = |engine: &dyn Engine| picture_of(camera, engine);
    let first = picture(Cpu::shared());
    for threads in [1, 2, 3] {
        assert!(on_threads(threads, || picture(Cpu::shared())) == first, "{threads} threads");
    }
    // Brute force takes a millisecond for a ray.
    let part = if is_full() { (0..30, 0..40) } else { (10..20, 14..26) };
    let part = camera.crop(part.0, part.1).unwrap();
    let slow = picture_of(part, &BruteForce);
    assert!(slow == picture_of(part, Cpu::shared()));
    assert!(slow.iter().any(|&value| value != slow[0]));
    for set in InstructionSet::available() {
        assert!(picture(&Cpu::with(set)) == first, "{set:?}");
    }
    let kinds: Vec<&ChannelKind> = vec![kind("color").unwrap()];
    let shade = Shader::default().on(&scene);
    let at_once = render(&scene, &camera, &shade, &kinds, 5, &()).unwrap();
    let picture = Picture { samples: 5, ..Picture::new(&scene, &camera, &shade, &kinds) };
    let mut progressive = picture.start().unwrap();
    for _ in 0..5 {
        progressive.add_sample(&()).unwrap();
    }
    assert_eq!(bits(&progressive.frame().unwrap(), "color"), bits(&at_once, "color"));
}

/// Of a camera that is carried, and stands still.
#[test]
fn cameras_that_move_line_by_line_have_a_lens_too() {
    let (scene, camera) = small();
    let still = Trajectory::new(vec![0.0, 1.0], vec![Pose::IDENTITY; 2]).unwrap();
    let shade = Shader::default().on(&scene);
    let kinds: Vec<&ChannelKind> = vec![kind("color").unwrap()];
    let of = |sensor: &dyn Sensor| {
        bits(&render(&scene, sensor, &shade, &kinds, 6, &()).unwrap(), "color")
    };
    let shutter = RollingShutter::new(&camera, &still, 0.0, 1.0, Readout::TopDown).unwrap();
    assert!(of(&shutter) == of(&camera));
    let row = camera.crop(12..13, 0..40).unwrap();
    let line = Pushbroom::new(&row, &still, vec![0.5]).unwrap();
    assert!(of(&line) == of(&row));
    let pinhole = row.thin_lens(0.0, 6.0).unwrap();
    assert!(of(&line) != of(&pinhole));
}

#[test]
fn a_single_sample_of_a_lens_is_refused_where_there_are_colours() {
    let (scene, camera) = small();
    let picture = |channels| {
        let picture = Render::new(&scene).camera(camera).samples(1);
        picture.channels(channels).frame()
    };
    let error = picture(&["color", "z"]).unwrap_err().to_string();
    assert_eq!(
        error,
        "samples must be at least 2 for colours and mattes of a camera with an aperture, got 1"
    );
    assert!(picture(&["z"]).is_ok());
}

#[test]
fn what_is_no_thin_lens_is_refused() {
    let camera = example::camera(3, 4).unwrap();
    let refused = |camera: &Camera, aperture, focus| {
        camera.thin_lens(aperture, focus).unwrap_err().to_string()
    };
    for (aperture, focus, error) in [
        (-1.0, 2.0, "aperture must be zero or a positive, finite number, got -1"),
        (f64::NAN, 2.0, "aperture must be zero or a positive, finite number, got NaN"),
        (1.0, 0.0, "focus must be positive and finite, got 0"),
        (1.0, f64::INFINITY, "focus must be positive and finite, got inf"),
    ] {
        assert_eq!(refused(&camera, aperture, focus), error);
    }
    let with = |lens| Camera::new(View { lens, ..*camera.view() }).unwrap();
    let parallel = Viewplane { parallel: true, ..Viewplane::default() };
    let tilted = Viewplane { tilt: DVec2::new(5.0, 0.0), ..Viewplane::default() };
    for (lens, words) in [
        (Lens::Flat(parallel), "aperture must be zero for parallel rays"),
        (Lens::Flat(tilted), "aperture must be zero for a tilted viewplane"),
        (
            Lens::Equirectangular(Equirectangular::default()),
            "aperture must be left out: only perspective cameras, opencv and fov have a thin lens, got equirectangular",
        ),
    ] {
        let error = refused(&with(lens), 0.1, 2.0);
        assert!(error.starts_with(words), "{error}");
    }
}

#[test]
fn records_and_cameras_made_from_others_keep_the_lens() {
    let camera = skewed(30, 40);
    let record = camera_record(&camera);
    assert_eq!((record.parameters["aperture"], record.parameters["focus"]), (0.5, 4.0));
    assert_eq!(camera_of(&record).unwrap(), camera);
    // Those of a pinhole say nothing of a lens.
    let pinhole = example::camera(3, 4).unwrap();
    assert!(!camera_record(&pinhole).parameters.contains_key("aperture"));
    let moved = camera.moved(&DAffine3::from_translation(DVec3::X)).unwrap();
    let part = camera.crop(2..20, 3..30).unwrap();
    for camera in [moved, part, camera.resize(60, 80).unwrap()] {
        let viewplane = camera.lens().viewplane().unwrap();
        assert_eq!((viewplane.aperture, viewplane.focus), (0.5, 4.0));
    }
}

#[test]
fn a_description_has_a_lens_with_a_distance_or_a_point() {
    let bounds = Bounds { low: DVec3::NEG_ONE, high: DVec3::ONE };
    let support = |direction: DVec3| direction.abs().element_sum();
    let made = |description: Description| description.camera(bounds, support, DVec3::Z);
    let base = Description {
        position: Some(DVec3::new(0.0, -5.0, 0.0)),
        aim: Some(Aim::At(DVec3::ZERO)),
        opening: Some(Opening::Fov(40.0)),
        aperture: Some(0.2),
        ..Description::default()
    };
    let lens = |description| {
        let camera = made(description).unwrap();
        let viewplane = *camera.lens().viewplane().unwrap();
        (viewplane.aperture, viewplane.focus)
    };
    let at = |focus| Description { focus: Some(focus), ..base };
    assert_eq!(lens(at(Focus::Distance(3.0))), (0.2, 3.0));
    assert_eq!(lens(at(Focus::At(DVec3::new(2.0, 1.0, 1.0)))), (0.2, 6.0));
    let again = Description::of(made(at(Focus::Distance(3.0))).unwrap().view());
    assert_eq!(lens(again), (0.2, 3.0));
    // Without an aperture it is a pinhole's again.
    assert_eq!(lens(Description { aperture: Some(0.0), ..again }), (0.0, 3.0));
    let alone = made(base).unwrap_err().to_string();
    assert_eq!(alone, "aperture must be given with a focus, got 0.2");
    let alone = Description { aperture: None, ..at(Focus::Distance(3.0)) };
    let alone = made(alone).unwrap_err().to_string();
    assert_eq!(alone, "focus must be given with an aperture alone, got 3");
    let behind = at(Focus::At(DVec3::new(0.0, -6.0, 0.0)));
    let behind = made(behind).unwrap_err().to_string();
    assert_eq!(behind, "focus must be positive and finite, got -1");
}

#[test]
fn a_cuboid_in_front_of_the_focus_is_blurred_by_the_share_of_the_lens_that_it_hides() {
    // A half-space from x = 0 on at half the distance in focus: the share of the lens that sees
    // past its edge from the point in focus at x is the part of the disc beyond the edge's image.
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 0.3, 1, 101).unwrap();
    let (aperture, focus, samples) = (1.0, 8.0, 2048);
    let wall = Cuboid::new(DVec3::new(0.0, -50.0, -4.001), DVec3::new(50.0, 50.0, -4.0)).unwrap();
    let scene = Scene::new(vec![Object::new(wall).colored(Color::ONE)]).unwrap();
    let lens = camera.thin_lens(aperture, focus).unwrap();
    let frame = flat(&scene, lens, samples).frame().unwrap();
    for (column, share) in values(&frame, "color").into_iter().enumerate() {
        let ray = camera.ray(0, column);
        // On the plane in focus; at half its distance the ray from l on the lens is at the mean of
        // both.
        let x = ray.direction.x / -ray.direction.z * focus;
        let s = (-x / (0.5 * aperture)).clamp(-1.0, 1.0);
        // The share of the unit disc to the right of s.
        let expected = (libm::acos(s) - s * (1.0 - s * s).sqrt()) / std::f64::consts::PI;
        // A pixel is 0.042 wide in focus, a twelfth of the radius: the share is nearly linear in
        // it.
        assert!((share - expected).abs() < 0.006, "{column}: {share} {expected}");
    }
}

/// The message names those that have one, and no others.
#[test]
fn the_projections_that_a_message_names_have_a_thin_lens() {
    for name in Projection::NAMES {
        let projection: Projection = name.parse().unwrap();
        let words = Projection::NO_THIN_LENS.split([' ', ',']);
        let is_named = words.into_iter().any(|word| word == *name);
        assert_eq!(is_named, projection.has_thin_lens(), "{name}");
    }
}
