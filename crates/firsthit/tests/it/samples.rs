//! Pictures by parts, sample by sample, and by every engine: always the same bytes.

use std::ops::Range;

use firsthit::camera::Equirectangular;
use firsthit::channel::{ChannelKind, KINDS, kind};
use firsthit::image::{Channel, Frame};
use firsthit::render::{Picture, Region};
use firsthit::shade::Samples;
use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{
    Camera, Color, DVec3, Hit, InstructionSet, Lens, Render, Shade, Shader, View, example, render,
};

use crate::support::is_full;

fn small_camera() -> Camera {
    example::camera(30, 40).unwrap()
}

/// A shader that says of which pixel and sample it is asked.
struct Numbered;

impl Shade for Numbered {
    fn shade(&self, _: f64, _: DVec3, _: DVec3, _: &Hit) -> Color {
        Color::ZERO
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], _coverage: &mut [f64]) {
        for (color, &pixel) in colors.iter_mut().zip(samples.pixels) {
            *color = Color::new(pixel as f64, f64::from(samples.sample), 1.0);
        }
    }
}

/// The values of the channels, as bits.
fn all_bits(frame: &Frame, rows: Range<usize>, columns: Range<usize>) -> Vec<Vec<u64>> {
    let width = frame.shape()[1];
    let of_channel = |channel: &Channel| {
        let pixels = rows.clone().flat_map(|row| columns.clone().map(move |k| row * width + k));
        let each = channel.components;
        let values = pixels.flat_map(|pixel| pixel * each..(pixel + 1) * each);
        values.map(|k| channel.data.value(k).to_bits()).collect()
    };
    frame.channels().iter().map(of_channel).collect()
}

#[test]
fn a_region_is_that_part_of_the_whole() {
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let kinds: Vec<&ChannelKind> = KINDS.iter().collect();
    let shading = Shader::default().on(&scene);
    let panorama = Camera::new(View {
        lens: Lens::Equirectangular(Equirectangular::default()),
        ..*camera.view()
    });
    for camera in [camera, panorama.unwrap()] {
        for shade in [&shading as &dyn Shade, &Numbered] {
            let picture = Picture { samples: 3, ..Picture::new(&scene, &camera, shade, &kinds) };
            let whole = picture.render(&()).unwrap();
            for (rows, columns) in [(0..7, 3..40), (5..29, 17..39), (29..30, 39..40)] {
                let region = Region { rows: rows.clone(), columns: columns.clone() };
                let part = Picture { region: Some(region), ..picture.clone() };
                let part = part.render(&()).unwrap();
                assert_eq!(part.shape(), [rows.len(), columns.len()]);
                // K and the pose are the whole camera's: the file must say where its pixels begin.
                let pixels = part.metadata().pixels.unwrap();
                let first = [columns.start, rows.start].map(|first| first as f64 + 0.5);
                assert_eq!(pixels.first_center, first);
                let got = all_bits(&part, 0..rows.len(), 0..columns.len());
                assert!(got == all_bits(&whole, rows.clone(), columns.clone()), "{rows:?}");
            }
        }
    }
}

#[test]
fn a_region_outside_the_picture_is_refused() {
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let kinds = [kind("t").unwrap()];
    let shade = Shader::default().on(&scene);
    for (rows, columns) in [(0..0, 0..4), (0..31, 0..4), (3..4, 40..41), (29..31, 0..4)] {
        let picture = Picture {
            region: Some(Region { rows, columns }),
            ..Picture::new(&scene, &camera, &shade, &kinds)
        };
        let error = picture.render(&()).unwrap_err().to_string();
        assert!(error.starts_with("region must be a part of the picture"), "{error}");
    }
}

#[test]
fn samples_one_by_one_are_those_at_once() {
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let kinds: Vec<&ChannelKind> = KINDS.iter().collect();
    let shade = Shader::default().on(&scene);
    let all = |frame: &Frame| all_bits(frame, 0..30, 0..40);
    let picture = Picture::new(&scene, &camera, &shade, &kinds);
    let mut progressive = picture.start().unwrap();
    for samples in 1..=5 {
        progressive.add_sample(&()).unwrap();
        let at_once = Picture { samples, ..picture.clone() };
        let at_once = at_once.render(&()).unwrap();
        assert!(all(&progressive.frame().unwrap()) == all(&at_once), "{samples}");
    }
}

#[test]
fn a_shader_is_told_its_pixel_and_its_sample() {
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let kinds = [kind("color").unwrap()];
    let frame = render(&scene, &camera, &Numbered, &kinds, 4, &()).unwrap();
    let data = &frame.channels()[0].data;
    for pixel in 0..30 * 40 {
        let color = [0, 1, 2].map(|k| data.value(3 * pixel + k));
        // The mean of 0, 1, 2 and 3.
        assert_eq!(color, [pixel as f64, 1.5, 1.0]);
    }
}

#[test]
fn every_engine_makes_the_same_picture() {
    // Brute force takes a millisecond for a ray.
    let rows = if is_full() { 0..30 } else { 13..16 };
    let camera = small_camera().crop(rows, 0..40).unwrap();
    let scene = example::scene().unwrap();
    let kinds: Vec<&ChannelKind> = KINDS.iter().collect();
    let render = |engine: &dyn Engine| {
        let frame = Render::new(&scene).camera(camera).samples(2).engine(engine);
        let names: Vec<&str> = kinds.iter().map(|kind| &*kind.name).collect();
        all_bits(&frame.channels(&names).frame().unwrap(), 0..camera.rows(), 0..40)
    };
    let slow = render(&BruteForce);
    let has_two = |values: &Vec<u64>| values.iter().any(|&value| value != values[0]);
    assert!(slow.iter().filter(|values| has_two(values)).count() > kinds.len() / 2);
    for set in InstructionSet::available() {
        assert!(render(&Cpu::with(set)) == slow, "{set:?}");
    }
}
