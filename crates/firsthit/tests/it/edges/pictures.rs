//! Lines in rendered pictures.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use firsthit::camera::Equirectangular;
use firsthit::channel::kind;
use firsthit::edge::{Dash, EdgeKinds, Edges};
use firsthit::render::{Picture, Region};
use firsthit::sensor::RaySensor;
use firsthit::watch::Watch;
use firsthit::{Camera, Color, DVec3, Error, Lens, Render, Shader, View, example};

use super::{SIDE, cube, lines_of, of, parallel, perspective, seen_of_cube};
use crate::support::on_threads;

#[test]
fn regions_threads_and_passes_change_no_byte() {
    let scene = example::scene().unwrap();
    let lens = Lens::Equirectangular(Equirectangular::default());
    let camera = example::camera(60, 80).unwrap();
    let around = Camera::new(View { lens, ..*camera.view() }).unwrap();
    let kinds = [kind("color").unwrap(), kind("edge").unwrap(), kind("z").unwrap()];
    let shade = Shader::default().on(&scene);
    let edges = Edges { width: 2.5, hidden: Some(Dash::default()), ..Edges::default() };
    for camera in [&camera, &around] {
        let picture = Picture {
            edges: Some(edges),
            samples: 2,
            ..Picture::new(&scene, camera, &shade, &kinds)
        };
        let whole = picture.render(&()).unwrap();
        for threads in [1, 2, 7] {
            let again = on_threads(threads, || picture.render(&()).unwrap());
            assert!(again.channels() == whole.channels());
        }
        let region = Region { rows: 17..43, columns: 5..71 };
        let part = Picture { region: Some(region), ..picture.clone() }.render(&()).unwrap();
        for (part, whole) in part.channels().iter().zip(whole.channels()) {
            let each = part.components;
            for k in 0..part.data.len() {
                let (pixel, component) = (k / each, k % each);
                let there = (17 + pixel / 66) * 80 + 5 + pixel % 66;
                let [a, b] = [part.data.value(k), whole.data.value(there * each + component)];
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
    let edges = Edges { color: Color::new(1.0, 0.5, 0.0), width: 2.0, ..Edges::default() };
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
            let (before, after) =
                (of(&plain, "color", 4 * pixel + k), of(&drawn, "color", 4 * pixel + k));
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
fn what_cannot_be_drawn_is_refused() {
    let scene = of(Arc::new(cube()));
    let sensor = RaySensor::new(vec![DVec3::ZERO], vec![DVec3::X], [1, 1]).unwrap();
    let shade = Shader::default().on(&scene);
    let kinds = [kind("edge").unwrap()];
    let error = Picture::new(&scene, &sensor, &shade, &kinds).render(&()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "channel must be one that a sensor which is no camera has, got edge"
    );
    let colors = [kind("color").unwrap()];
    let edges = Some(Edges::default());
    let picture = Picture { edges, ..Picture::new(&scene, &sensor, &shade, &colors) };
    assert_eq!(
        picture.render(&()).unwrap_err().to_string(),
        "edges must be left out for a sensor that is no camera, got 1"
    );
    let camera = perspective(DVec3::new(5.0, -4.0, 3.0));
    for (edges, message) in [
        (
            Edges { width: 0.0, ..Edges::default() },
            "edges must be a width above 0 and up to 1000 pixels, got 0",
        ),
        (
            Edges { angle: 181.0, ..Edges::default() },
            "edge angle must be from 0 to 180 degrees, got 181",
        ),
        (
            Edges { kinds: EdgeKinds::NONE, ..Edges::default() },
            "edge kinds must be at least one, got none",
        ),
    ] {
        let error = Render::new(&scene).camera(camera).edges(edges).frame().unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}

fn dashed(on: f64, off: f64) -> Edges {
    Edges { hidden: Some(Dash { on, off }), ..Edges::default() }
}

/// A dash of 1e-12 pixels made a picture take hours.
#[test]
fn dashes_and_gaps_below_a_tenth_of_a_pixel_are_refused() {
    for (edges, got) in [
        (dashed(1e-12, 4.0), "0.000000000001"),
        (dashed(6.0, 0.0999), "0.0999"),
        (dashed(f64::NAN, 4.0), "NaN"),
        (dashed(6.0, f64::INFINITY), "inf"),
    ] {
        let expected = "hidden edges must be finite dashes and gaps of at least 0.1 pixels, got ";
        let error = edges.check().unwrap_err().to_string();
        assert_eq!(error, format!("{expected}{got}"));
    }
}

#[test]
fn the_shortest_dashes_are_drawn() {
    let edges = dashed(Dash::SHORTEST, Dash::SHORTEST);
    edges.check().unwrap();
    let (scene, camera) = (of(Arc::new(cube())), parallel(DVec3::new(-3.0, 2.0, -1.5)));
    let solid = lines_of(&scene, &camera, &Edges::default());
    let count = lines_of(&scene, &camera, &edges).pieces().len() - solid.pieces().len();
    // At most three dashes in each half pixel.
    assert!(count > 1000 && count < 3 * 2 * 3 * 200, "{count}");
}

/// Stops after a number of questions.
struct StopsAfter(AtomicUsize);

impl Watch for StopsAfter {
    fn is_stopped(&self) -> bool {
        let stop = |left: usize| left.checked_sub(1);
        self.0.fetch_update(Relaxed, Relaxed, stop).is_err()
    }
}

#[test]
fn the_coverage_of_wide_lines_can_be_interrupted() {
    let (scene, camera) = (of(Arc::new(cube())), parallel(DVec3::new(-3.0, 2.0, -1.5)));
    let edges = Edges { width: Edges::WIDEST, ..Edges::default() };
    let lines = lines_of(&scene, &camera, &edges);
    let watch = StopsAfter(AtomicUsize::new(3));
    let made = lines.coverage(0..SIDE, 0..SIDE, &watch);
    assert!(matches!(made, Err(Error::Interrupted)), "{made:?}");
}

/// Before a transparent background a line is as opaque as it covers: in the colours' own alpha and
/// in the channel of that name.
#[test]
fn the_alpha_channel_is_that_of_the_colours_with_their_lines() {
    let scene = example::scene().unwrap();
    let camera = example::camera(60, 80).unwrap();
    let shade = firsthit::Shading {
        background: firsthit::Background::Transparent,
        ..Shader::named("unlit").unwrap().on(&scene)
    };
    let kinds = ["color", "alpha", "object"].map(|name| kind(name).unwrap());
    let edges = Edges { width: 3.0, ..Edges::default() };
    let of = |edges| {
        let picture = Picture { edges, ..Picture::new(&scene, &camera, &shade, &kinds) };
        let frame = picture.render(&()).unwrap();
        let values = |channel: usize, index| frame.channels()[channel].data.value(index);
        let pixels = 0..60 * 80;
        let alphas: Vec<f64> = pixels.clone().map(|pixel| values(1, pixel)).collect();
        let colors: Vec<f64> = pixels.clone().map(|pixel| values(0, 4 * pixel + 3)).collect();
        let misses: Vec<bool> = pixels.map(|pixel| values(2, pixel) < 0.0).collect();
        (alphas, colors, misses)
    };
    let (plain, colors, misses) = of(None);
    assert_eq!(plain, colors);
    assert!(plain.iter().zip(&misses).all(|(&alpha, &miss)| !miss || alpha == 0.0));
    let (alphas, colors, misses) = of(Some(edges));
    assert_eq!(alphas, colors);
    assert!(alphas.iter().zip(&misses).any(|(&alpha, &miss)| miss && alpha > 0.5));
}
