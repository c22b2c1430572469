//! Pictures that are gone on with, and pictures that end where they are quiet.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use firsthit::channel::{ChannelKind, kind};
use firsthit::image::{Data, Frame};
use firsthit::render::{Picture, Region};
use firsthit::scene::{ColorBy, Coloring, Environment, EnvironmentKind};
use firsthit::shade::Samples;
use firsthit::watch::Watch;
use firsthit::{
    Camera, Color, DVec3, Hit, Object, Scene, Shade, Shader, Shading, Side, Sphere, example,
};

use crate::support::on_threads;

const ROWS: usize = 12;
const COLUMNS: usize = 16;

fn kinds(names: &[&str]) -> Vec<&'static ChannelKind> {
    names.iter().map(|name| kind(name).unwrap()).collect()
}

/// A small picture's scene and camera.
fn example() -> (Scene, Camera) {
    let camera = example::camera(ROWS, COLUMNS);
    (example::scene().unwrap(), camera.unwrap())
}

/// All that can be gone on with.
fn shaded() -> Vec<&'static ChannelKind> {
    kinds(&["color", "alpha", "samples"])
}

/// All values as bits, and the metadata.
fn said(frame: &Frame) -> (Vec<u64>, String) {
    let channels = frame.channels().iter();
    let values = channels.flat_map(|channel| {
        (0..channel.data.len()).map(|index| channel.data.value(index).to_bits())
    });
    (values.collect(), frame.metadata().to_json())
}

/// The picture by so many samples each time, its state going through a file in between.
fn in_steps(picture: &Picture<'_>, steps: &[u32]) -> Frame {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.npz");
    for (run, &step) in steps.iter().enumerate() {
        let mut going_on =
            if run == 0 { picture.start().unwrap() } else { picture.resume_from(&file).unwrap() };
        for _ in 0..step {
            going_on.add_sample(&()).unwrap();
        }
        going_on.state().unwrap().save(&file).unwrap();
    }
    let last = picture.resume_from(&file).unwrap();
    assert_eq!(last.samples(), steps.iter().sum::<u32>());
    last.frame().unwrap()
}

#[test]
fn any_split_of_the_samples_has_the_bytes_of_all_at_once() {
    let (scene, camera) = example();
    let camera = camera.thin_lens(0.2, 8.0).unwrap();
    let shade = Shader::named("direct").unwrap().on(&scene);
    let channels = shaded();
    let picture = Picture { samples: 5, ..Picture::new(&scene, &camera, &shade, &channels) };
    let at_once = said(&picture.render(&()).unwrap());
    for threads in [1, 3] {
        for steps in [&[1, 4][..], &[2, 3], &[3, 2], &[4, 1], &[5], &[1, 1, 1, 1, 1]] {
            let whole = on_threads(threads, || said(&in_steps(&picture, steps)));
            assert!(whole == at_once, "{threads} {steps:?}");
        }
    }
}

/// Black but for the pixel of a number, which is black and white in turn.
struct OneLoud(u64);

impl Shade for OneLoud {
    fn shade(&self, _: f64, _: DVec3, _: DVec3, _: &Hit) -> Color {
        Color::ZERO
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], _coverage: &mut [f64]) {
        let is_bright = samples.sample.is_multiple_of(2);
        for (color, &pixel) in colors.iter_mut().zip(samples.pixels) {
            *color = Color::splat(f64::from(u8::from(is_bright && pixel == self.0)));
        }
    }
}

/// Black but for one sample of a pixel, which is very bright: a firefly.
struct OneFirefly(u64);

impl Shade for OneFirefly {
    fn shade(&self, _: f64, _: DVec3, _: DVec3, _: &Hit) -> Color {
        Color::ZERO
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], _coverage: &mut [f64]) {
        for (color, &pixel) in colors.iter_mut().zip(samples.pixels) {
            let is_met = samples.sample == 5 && pixel == self.0;
            *color = Color::splat(if is_met { 80.0 } else { 0.0 });
        }
    }
}

/// One bright sample makes its pixel white; that is no reason to stop there.
#[test]
fn a_pixel_that_one_sample_made_white_is_not_quiet() {
    let scene = Scene::new(vec![]).unwrap();
    let camera = example::camera(16, 16).unwrap();
    let channels = shaded();
    let picture = Picture {
        samples: 64,
        noise: Some(0.01),
        ..Picture::new(&scene, &camera, &OneFirefly(20), &channels)
    };
    let frame = picture.render(&()).unwrap();
    assert!(counts(&frame).iter().all(|&count| count == 64));
}

fn counts(frame: &Frame) -> &[i32] {
    match &frame.channel("samples").unwrap().data {
        Data::Int32(counts) => counts,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_noise_ends_the_samples_where_tiles_and_their_neighbours_are_quiet() {
    let scene = Scene::new(vec![]).unwrap();
    let camera = example::camera(16, 80).unwrap();
    let shade = OneLoud(3 * 80 + 70);
    let channels = shaded();
    let picture = |noise, samples| Picture {
        samples,
        noise,
        ..Picture::new(&scene, &camera, &shade, &channels)
    };
    let frame = picture(Some(0.01), 70).render(&()).unwrap();
    for (pixel, &count) in counts(&frame).iter().enumerate() {
        // The loud pixel is in the last of five tiles.
        let expected = if pixel % 80 < 48 { 32 } else { 70 };
        assert_eq!(count, expected, "{pixel}");
    }
    assert_eq!(frame.metadata().samples, Some(70));
    for samples in [20, 32] {
        let with = picture(Some(0.01), samples).render(&()).unwrap();
        assert_eq!(said(&with), said(&picture(None, samples).render(&()).unwrap()));
    }
    let steps: [&[u32]; 3] = [&[31, 39], &[32, 38], &[33, 1, 36]];
    for steps in steps {
        let picture = picture(Some(0.01), 70);
        assert!(said(&in_steps(&picture, steps)) == said(&frame), "{steps:?}");
    }
}

/// Metadata said that colours were the mean of 70.
#[test]
fn metadata_say_how_many_samples_there_are_where_a_noise_ends_them_all() {
    let scene = Scene::new(vec![]).unwrap();
    let camera = example::camera(16, 40).unwrap();
    let shade = OneLoud(u64::MAX);
    let channels = kinds(&["color", "crypto_object"]);
    let picture = Picture {
        samples: 70,
        noise: Some(0.5),
        ..Picture::new(&scene, &camera, &shade, &channels)
    };
    assert_eq!(picture.render(&()).unwrap().metadata().samples, Some(32));
    let color = kinds(&["color"]);
    let picture = Picture { samples: 4, noise: None, channels: &color, ..picture };
    let mut going_on = picture.start().unwrap();
    let error = going_on.frame().err().unwrap().to_string();
    assert!(error.contains("a picture with a sample, got none"), "{error}");
    for _ in 0..3 {
        going_on.add_sample(&()).unwrap();
    }
    let frame = going_on.frame().unwrap();
    assert_eq!(frame.metadata().samples, Some(3));
}

#[test]
fn a_state_of_another_picture_is_refused() {
    let ball = |radius| Object::new(Sphere::new(DVec3::ZERO, radius).unwrap());
    let scene = Scene::new(vec![ball(1.0)]).unwrap();
    let other_scene = Scene::new(vec![ball(1.5)]).unwrap();
    let by_height = Some(Coloring::new(ColorBy::Height));
    let colored = scene.clone().with_coloring(by_height).unwrap();
    let camera = |at: f64| {
        let eye = DVec3::new(0.0, at, 2.0);
        Camera::look_at(eye, DVec3::ZERO, DVec3::Z, 45.0, ROWS, COLUMNS).unwrap()
    };
    let (camera, other_camera) = (camera(-5.0), camera(-6.0));
    let on = |scene| -> Shading<'_> { Shader::named("matcap").unwrap().on(scene) };
    let (shade, other_shade) = (on(&scene), Shader::named("unlit").unwrap().on(&scene));
    let (on_other, on_colored) = (on(&other_scene), on(&colored));
    let channels = shaded();
    let picture = Picture { samples: 2, ..Picture::new(&scene, &camera, &shade, &channels) };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.npz");
    let mut begun = picture.start().unwrap();
    begun.add_sample(&()).unwrap();
    begun.state().unwrap().save(&file).unwrap();
    let with_scene = |scene, shade| Picture { scene, shade, ..picture.clone() };
    let [mut moved, mut culled, mut part] = [(); 3].map(|()| picture.clone());
    moved.sensor = &other_camera;
    culled.cull = Some(Side::Back);
    part.region = Some(Region { rows: 0..4, columns: 0..COLUMNS });
    let others = [
        ("scene", with_scene(&other_scene, &on_other)),
        ("colours by numbers", with_scene(&colored, &on_colored)),
        ("shader", with_scene(&scene, &other_shade)),
        ("camera", moved),
        ("another background", culled),
        ("part of the picture", part),
    ];
    assert_eq!(picture.resume_from(&file).unwrap().samples(), 1);
    for (what, other) in &others {
        let error = other.resume_from(&file).err().unwrap().to_string();
        assert!(
            error.starts_with("state must be that of this picture, got ") && error.contains(what),
            "{what}: {error}"
        );
    }
}

/// Whether an environment is seen, and which way is up, change colours too.
#[test]
fn a_state_of_other_light_is_refused() {
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let scene = Scene::new(vec![ball]).unwrap();
    let sky = |is_seen| {
        let environment = Environment {
            is_seen,
            ..Environment::new(EnvironmentKind::Uniform(Color::splat(0.3)))
        };
        let environment = Some(Arc::new(environment));
        scene.clone().with_environment(environment)
    };
    let scenes = [sky(true), sky(false), sky(true).with_up(DVec3::X)];
    let shades = scenes.each_ref().map(|scene| Shader::named("hemisphere").unwrap().on(scene));
    let camera = example::camera(ROWS, COLUMNS).unwrap();
    let channels = shaded();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.npz");
    let pictures = [0, 1, 2].map(|k| Picture {
        samples: 2,
        ..Picture::new(&scenes[k], &camera, &shades[k], &channels)
    });
    let mut begun = pictures[0].start().unwrap();
    begun.add_sample(&()).unwrap();
    begun.state().unwrap().save(&file).unwrap();
    let resumed = pictures.each_ref().map(|picture| picture.resume_from(&file).is_ok());
    assert_eq!(resumed, [true, false, false]);
}

#[test]
fn a_state_in_memory_is_refused_for_another_size_and_for_channels_that_would_be_missing() {
    let (scene, shade) = (Scene::new(vec![]).unwrap(), OneLoud(0));
    let camera = example::camera(ROWS, COLUMNS).unwrap();
    let (channels, plain) = (shaded(), kinds(&["color", "t"]));
    let picture = Picture::new(&scene, &camera, &shade, &channels);
    let state = picture.start().unwrap().state().unwrap();
    let refused = |picture: Picture<'_>| picture.resume(&state).err().unwrap().to_string();
    let region = Some(Region { rows: 0..4, columns: 0..COLUMNS });
    let part = refused(Picture { region, ..picture.clone() });
    assert!(part.contains("another size"), "{part}");
    let more = refused(Picture { channels: &plain, ..picture.clone() });
    assert!(more.contains("got t"), "{more}");
}

/// Pixels that had ended went on, with the numbers of samples that others had.
#[test]
fn a_state_that_a_noise_ended_is_refused_without_one() {
    let scene = Scene::new(vec![]).unwrap();
    let camera = example::camera(16, 80).unwrap();
    let shade = OneLoud(0);
    let channels = shaded();
    let picture = Picture {
        samples: 40,
        noise: Some(0.01),
        ..Picture::new(&scene, &camera, &shade, &channels)
    };
    let mut going_on = picture.start().unwrap();
    for _ in 0..40 {
        going_on.add_sample(&()).unwrap();
    }
    let state = going_on.state().unwrap();
    assert_eq!(picture.resume(&state).unwrap().samples(), 40);
    let without = Picture { noise: None, ..picture };
    let error = without.resume(&state).err().unwrap().to_string();
    assert!(error.contains("without a noise"), "{error}");
}

/// A picture that was begun and had one sample was a pinhole's.
#[test]
fn a_single_sample_of_a_lens_is_refused_before_it_is_begun() {
    let scene = example::scene().unwrap();
    let camera = example::camera(ROWS, COLUMNS).unwrap();
    let camera = camera.thin_lens(0.2, 8.0).unwrap();
    let shade = Shader::default().on(&scene);
    let channels = shaded();
    let picture = Picture::new(&scene, &camera, &shade, &channels);
    let error = picture.start().err().unwrap().to_string();
    assert!(error.starts_with("samples must be at least 2"), "{error}");
    let plain = kinds(&["t"]);
    let plain = Picture { channels: &plain, ..picture };
    assert!(plain.start().is_ok());
}

/// Counts rays, and stops after some.
struct Counter {
    done: AtomicU64,
    most: u64,
}

impl Counter {
    fn until(most: u64) -> Self {
        let done = AtomicU64::new(0);
        Self { done, most }
    }
}

impl Watch for Counter {
    fn advance(&self, rays: u64) {
        self.done.fetch_add(rays, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.done.load(Ordering::Relaxed) > self.most
    }
}

#[test]
fn a_picture_resumes_from_its_file_with_the_bytes_and_the_progress_of_one_run() {
    let (scene, camera) = example();
    let shade = Shader::named("direct").unwrap().on(&scene);
    let folder = tempfile::tempdir().unwrap();
    let region = Region { rows: 2..9, columns: 3..11 };
    for (names, region) in [
        (&["color"][..], None),
        (&["object", "color", "ao", "z", "samples"], None),
        (&["color", "z"], Some(region)),
    ] {
        let channels = kinds(names);
        let with = |samples: u32| Picture {
            samples,
            region: region.clone(),
            ..Picture::new(&scene, &camera, &shade, &channels)
        };
        let state = folder.path().join(format!("{}.npz", names.len()));
        let whole = with(6);
        let pixels = whole.render(&()).unwrap().channels()[0].data.len() / 3;
        let pixels = if names[0] == "object" { 3 * pixels } else { pixels };
        let total = firsthit::render::work(pixels, &channels, 6);
        // Stopped in the third sample, which is finished and saved.
        let stopped = whole.render_resumed(&state, &Counter::until(5 * pixels as u64));
        assert!(matches!(stopped, Err(firsthit::Error::Interrupted)), "{names:?}");
        let known = whole_state(&state);
        assert_eq!(known, 3, "{names:?}");
        for _ in 0..2 {
            let counter = Counter::until(u64::MAX);
            let resumed = whole.render_resumed(&state, &counter).unwrap();
            assert!(said(&resumed) == said(&whole.render(&()).unwrap()), "{names:?}");
            assert_eq!(counter.done.into_inner(), total, "{names:?}");
        }
        let fewer = with(5).render_resumed(&state, &()).unwrap_err().to_string();
        assert!(fewer.contains("got 5, and "), "{fewer}");
    }
}

fn whole_state(state: &std::path::Path) -> u32 {
    let output = firsthit::image::read(state).unwrap();
    match &output.array("samples").unwrap().numbers {
        firsthit::image::ArrayValues::Integer(counts) => u32::try_from(counts[0]).unwrap(),
        other => panic!("{other:?}"),
    }
}

/// It is told before the work, and not after hours.
#[test]
fn a_state_that_cannot_be_saved_is_told_before_anything_is_rendered() {
    let (scene, camera) = example();
    let shade = Shader::named("direct").unwrap().on(&scene);
    let folder = tempfile::tempdir().unwrap();
    let channels = kinds(&["color"]);
    let picture = Picture::new(&scene, &camera, &shade, &channels);
    std::fs::create_dir(folder.path().join("folder.npz")).unwrap();
    for name in ["gone/state.npz", "folder.npz", "state.npy"] {
        let counter = Counter::until(u64::MAX);
        let refused = picture.render_resumed(&folder.path().join(name), &counter);
        assert!(refused.is_err(), "{name}");
        assert_eq!(counter.done.into_inner(), 0, "{name}");
    }
    let plain = kinds(&["z"]);
    let picture = Picture::new(&scene, &camera, &shade, &plain);
    let refused = picture.render_resumed(&folder.path().join("z.npz"), &());
    assert!(refused.unwrap_err().to_string().contains("without color"));
}

/// Tiles that one noise ended would stay as they are under a smaller one.
#[test]
fn a_state_of_another_noise_is_refused() {
    let (scene, camera) = example();
    let shade = Shader::named("direct").unwrap().on(&scene);
    let folder = tempfile::tempdir().unwrap();
    let channels = kinds(&["color"]);
    let with = |noise: Option<f64>| Picture {
        samples: 33,
        noise,
        ..Picture::new(&scene, &camera, &shade, &channels)
    };
    for (before, after) in [(Some(0.02), Some(0.01)), (None, Some(0.01)), (Some(0.02), None)] {
        let state = folder.path().join("state.npz");
        with(before).render_resumed(&state, &()).unwrap();
        with(before).render_resumed(&state, &()).unwrap();
        let refused = with(after).render_resumed(&state, &()).unwrap_err();
        assert!(refused.to_string().contains("another noise"), "{refused}");
        std::fs::remove_file(&state).unwrap();
    }
}

/// Before a transparent background the shadow on the ground is in alpha alone.
#[test]
fn a_noise_sees_shadows_on_a_transparent_ground() {
    let ball = Sphere::new(DVec3::new(0.0, 0.0, 1.0), 1.0).unwrap();
    let scene = Scene::new(vec![Object::new(ball)]).unwrap();
    let white = Environment::new(EnvironmentKind::Uniform(Color::ONE));
    let scene = scene.with_environment(Some(Arc::new(Environment { is_seen: false, ..white })));
    let (from, to) = (DVec3::new(0.0, -40.0, 25.0), DVec3::ZERO);
    let camera = Camera::look_at(from, to, DVec3::Z, 40.0, 96, 96).unwrap();
    let shade = Shading {
        background: firsthit::Background::Transparent,
        ground: firsthit::shade::Ground::under(&scene, DVec3::Z),
        ..Shader::named("direct").unwrap().on(&scene)
    };
    let channels = kinds(&["color", "samples", "object"]);
    let picture = Picture {
        samples: 128,
        noise: Some(0.02),
        ..Picture::new(&scene, &camera, &shade, &channels)
    };
    let frame = picture.render(&()).unwrap();
    let Data::Int32(objects) = &frame.channel("object").unwrap().data else {
        panic!("identifiers are int32");
    };
    // Beside the ball, in its shadow, and far away.
    let at =
        |row: usize, column: usize| (counts(&frame)[96 * row + column], objects[96 * row + column]);
    assert_eq!(at(49, 48), (128, -1));
    assert_eq!(at(0, 0), (32, -1));
}

#[test]
fn an_edited_state_is_refused() {
    let (scene, camera) = example();
    let (shade, own) = (Shader::named("direct").unwrap().on(&scene), OneLoud(0));
    let channels = shaded();
    let picture = Picture::new(&scene, &camera, &shade, &channels);
    let mut begun = picture.start().unwrap();
    begun.add_sample(&()).unwrap();
    let state = begun.state().unwrap();
    let edited = |edit: &dyn Fn(&mut firsthit::image::Channel)| {
        let mut edited = Frame::new(state.shape().to_vec());
        for channel in state.channels() {
            let mut channel = channel.clone();
            edit(&mut channel);
            edited.push(channel).unwrap();
        }
        edited
    };
    for (name, wrong) in
        [("sums", f64::NAN), ("sums", f64::INFINITY), ("squares", -1.0), ("squares", f64::NAN)]
    {
        let state = edited(&|channel| {
            if let (true, Data::Float64(values)) = (channel.name == name, &mut channel.data) {
                values[3] = wrong;
            }
        });
        let error = picture.resume(&state).err().unwrap().to_string();
        assert!(error.contains("no sums of colours"), "{name} {wrong}: {error}");
        // A shader of one's own may give any number.
        let own = Picture { shade: &own, ..picture.clone() };
        assert!(own.resume(&state).is_ok(), "{name} {wrong}");
    }
    let uncounted = edited(&|channel| {
        if let Data::Int32(counts) = &mut channel.data {
            counts.fill(0);
        }
    });
    let error = picture.resume(&uncounted).err().unwrap().to_string();
    assert!(error.contains("sums without samples"), "{error}");
    // Light beyond 1e154 has squares beyond all range.
    let bright = edited(&|channel| {
        if let (true, Data::Float64(values)) = (channel.name == "squares", &mut channel.data) {
            values.fill(f64::INFINITY);
        }
    });
    assert!(picture.resume(&bright).is_ok());
}
