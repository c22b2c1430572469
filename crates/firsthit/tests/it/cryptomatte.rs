//! Cryptomattes: against counts of what every sample meets, and the same bytes however they are
//! made.

#![allow(clippy::large_types_passed_by_value, reason = "a camera is handed over whole")]

use std::collections::BTreeMap;
use std::path::Path;

use firsthit::channel::asked;
use firsthit::image::{Data, Frame, WriteSettings, format_named, matte_id, read_bytes};
use firsthit::render::{Region, Sample};
use firsthit::scene::Background;
use firsthit::shoot::{BruteForce, Engine, First, trace_into};
use firsthit::{
    Camera, Color, Cuboid, DVec3, Material, Object, Ray, Render, Scene, Sphere, camera::View,
};

use crate::support::on_threads;

const SAMPLES: u32 = 24;

/// Balls and boxes, some of one name and some without, before nothing.
fn scene() -> Scene {
    let mut objects = Vec::new();
    for k in 0..9 {
        let along = f64::from(k);
        let centre = DVec3::new(0.31 * along - 1.2, 0.4 * libm::sin(2.1 * along), -0.3 * along);
        let ball = Object::new(Sphere::new(centre, 0.37).unwrap());
        let name = ["ball", "ball", "", "Ünï\"\\", "e"][k as usize % 5];
        let material = Material {
            name: ["red", "", "blue"][k as usize % 3].into(),
            color: Color::splat(0.1 * along),
            ..Material::default()
        };
        objects.push(ball.named(name).with_materials(vec![material]));
    }
    let floor = Cuboid::new(DVec3::new(-1.0, -1.2, -2.0), DVec3::new(1.0, -0.6, 0.5)).unwrap();
    objects.push(Object::new(floor).named("floor"));
    Scene::new(objects).unwrap()
}

fn camera() -> Camera {
    Camera::new(View {
        position: DVec3::new(0.0, 0.0, 4.0),
        rows: 30,
        columns: 40,
        ..View::default()
    })
    .unwrap()
}

fn picture<'a>(scene: &'a Scene, camera: Camera, channels: &'a [&'a str]) -> Render<'a> {
    let picture = Render::new(scene).camera(camera).samples(SAMPLES).ground(false);
    let background = Background::Transparent;
    picture.background(background).channels(channels)
}

fn numbers(frame: &Frame, channel: &str) -> Vec<f32> {
    match &frame.channel(channel).unwrap().data {
        Data::Float32(values) => values.clone(),
        other => panic!("{other:?}"),
    }
}

/// How many samples of each pixel meet each name, by brute force.
fn counted(
    scene: &Scene,
    camera: &Camera,
    name: impl Fn(usize) -> Option<String>,
) -> Vec<BTreeMap<u32, u32>> {
    let mut counts = vec![BTreeMap::new(); camera.pixels()];
    for k in 0..SAMPLES {
        let sample = Sample::new(camera, k);
        let rays: Vec<Ray> = (0..camera.pixels()).map(|pixel| sample.ray(pixel)).collect();
        let mut hits = firsthit::shoot::Hits::default();
        let engine: &dyn Engine = &BruteForce;
        trace_into(engine, scene, &rays, (First, &mut hits), &()).unwrap();
        for (pixel, counts) in counts.iter_mut().enumerate() {
            let object = usize::try_from(hits.get(pixel).object).ok();
            if let Some(name) = object.and_then(&name) {
                *counts.entry(matte_id(&name)).or_insert(0) += 1;
            }
        }
    }
    counts
}

/// Object names, and after the number those that have none.
fn object_name(scene: &Scene, number: usize) -> String {
    match scene.objects()[number].name() {
        "" => format!("object_{number}"),
        name => name.to_owned(),
    }
}

#[test]
fn coverages_are_the_counts_of_brute_force() {
    let scene = scene();
    let lens = camera().thin_lens(0.6, 4.0).unwrap();
    for camera in [camera(), lens] {
        let names = ["crypto_object", "crypto_material", "color"];
        let frame = picture(&scene, camera, &names).frame().unwrap();
        let material = |object: usize| {
            let material = scene.objects()[object].materials().first()?;
            let number = scene.catalog().materials().iter().position(|name| *name == material.name);
            Some(match &*material.name {
                "" => format!("material_{}", number.unwrap()),
                name => name.to_owned(),
            })
        };
        let object = |number| Some(object_name(&scene, number));
        let of_objects = counted(&scene, &camera, object);
        check(&frame, "crypto_object", &of_objects);
        // Materials without a name differ in their look, so in their number: they are left to the
        // test below.
        let named = |object| material(object).filter(|name| !name.starts_with("material_"));
        let of_materials = counted(&scene, &camera, named);
        let pairs = numbers(&frame, "crypto_material");
        for (pixel, counts) in of_materials.iter().enumerate() {
            for (&id, &count) in counts {
                let found = pairs[12 * pixel..][..12].as_chunks::<2>().0.iter();
                let found = found.copied().find(|[key, _]| key.to_bits() == id);
                let [_, share] = found.expect("fewer than six materials");
                assert!((f64::from(share) - f64::from(count) / f64::from(SAMPLES)).abs() < 1e-7);
            }
        }
        // The coverage of all is that of the colours' alpha.
        let (pairs, colors) = (numbers(&frame, "crypto_object"), numbers(&frame, "color"));
        for pixel in 0..1200 {
            let shares = pairs[12 * pixel..][..12].iter().skip(1).step_by(2);
            let sum: f32 = shares.sum();
            let alpha = colors[4 * pixel + 3];
            assert!(sum <= 1.0 && (sum - alpha).abs() < 1e-6, "{pixel}: {sum} {alpha}");
        }
    }
}

/// The pairs of each pixel are the counts, sorted; the rest is zero.
fn check(frame: &Frame, channel: &str, counts: &[BTreeMap<u32, u32>]) {
    let pairs = numbers(frame, channel);
    let mut mixed = 0;
    for (pixel, counts) in counts.iter().enumerate() {
        let mut sorted: Vec<(u32, u32)> = counts.iter().map(|(&id, &count)| (id, count)).collect();
        sorted.sort_by_key(|&(id, count)| (std::cmp::Reverse(count), id));
        mixed += usize::from(sorted.len() > 1);
        let (pairs, _) = pairs[12 * pixel..][..12].as_chunks::<2>();
        for (rank, [id, share]) in pairs.iter().enumerate() {
            let (expected, count) = sorted.get(rank).copied().unwrap_or((0, 0));
            assert_eq!(id.to_bits(), expected, "{channel} {pixel} {rank}");
            let exact = f64::from(count) / f64::from(SAMPLES);
            assert!(f64::from(*share) <= exact && f64::from(share.next_up()) > exact);
        }
    }
    assert!(mixed > 30, "{mixed}");
}

#[test]
fn fewer_pairs_are_the_largest_of_more() {
    let scene = scene();
    let all = picture(&scene, camera(), &["crypto_object:12"]).frame().unwrap();
    let few = picture(&scene, camera(), &["crypto_object:2"]).frame().unwrap();
    let (all, few) = (numbers(&all, "crypto_object"), numbers(&few, "crypto_object"));
    assert_eq!((all.len(), few.len()), (1200 * 24, 1200 * 4));
    for pixel in 0..1200 {
        assert_eq!(all[24 * pixel..][..4], few[4 * pixel..][..4]);
    }
    for wrong in ["crypto_object:3", "crypto_object:0", "crypto_object:66", "crypto_object:x"] {
        let error = asked(wrong).unwrap_err().to_string();
        let expected = "channel must be a Cryptomatte of an even number of pairs from 2 to 64";
        assert_eq!(error, format!("{expected}, got {wrong}"));
    }
}

#[test]
fn threads_regions_and_engines_make_the_same_pairs() {
    let scene = scene();
    let bits = |frame: Frame| -> Vec<u32> {
        numbers(&frame, "crypto_object").iter().map(|value| value.to_bits()).collect()
    };
    let whole = bits(picture(&scene, camera(), &["crypto_object"]).frame().unwrap());
    for threads in [1, 2, 3] {
        let made =
            on_threads(threads, || picture(&scene, camera(), &["crypto_object"]).frame().unwrap());
        assert!(bits(made) == whole, "{threads}");
    }
    let slow = picture(&scene, camera(), &["crypto_object"]).engine(&BruteForce);
    assert!(bits(slow.frame().unwrap()) == whole);
    let region = Region { rows: 7..19, columns: 5..33 };
    let part = picture(&scene, camera(), &["crypto_object"]).region(region);
    let part = bits(part.frame().unwrap());
    for row in 0..12 {
        let of_whole = &whole[12 * (40 * (row + 7) + 5)..][..12 * 28];
        assert!(part[12 * 28 * row..][..12 * 28] == *of_whole, "{row}");
    }
}

fn encoded(frame: &Frame, format: &str) -> firsthit::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let (settings, path) = (WriteSettings::default(), Path::new("-"));
    format_named(format)?.encode(frame, None, settings, &mut bytes, path)?;
    Ok(bytes)
}

#[test]
fn files_have_the_same_bytes_each_time_and_are_read_back() {
    let scene = scene();
    let channels = ["color", "crypto_object", "crypto_material:4", "z"];
    let frame = picture(&scene, camera(), &channels).frame().unwrap();
    for format in ["exr", "npz"] {
        let bytes = encoded(&frame, format).unwrap();
        for _ in 0..8 {
            assert!(encoded(&frame, format).unwrap() == bytes, "{format}");
        }
        let read = read_bytes(Path::new(&format!("a.{format}")), &bytes, u64::MAX).unwrap();
        let metadata = read.metadata.unwrap();
        assert_eq!(metadata, {
            let mut own = frame.metadata();
            for (own, read) in own.channels.iter_mut().zip(&metadata.channels) {
                own.stored.clone_from(&read.stored);
            }
            own
        });
        assert_eq!(metadata.samples, Some(SAMPLES));
        let manifest = &metadata.cryptomatte["crypto_object"].manifest;
        let names = ["ball", "object_2", "object_7", "Ünï\"\\", "e", "floor"];
        assert_eq!(manifest.len(), names.len());
        for name in names {
            assert_eq!(manifest[name], format!("{:08x}", matte_id(name)));
        }
        let found = |name: &str| {
            let array = read.arrays.iter().find(|array| array.name.as_deref() == Some(name));
            array.unwrap().shape.clone()
        };
        assert_eq!(found("crypto_object"), [30, 40, 12]);
        assert_eq!(found("crypto_material"), [30, 40, 8]);
    }
    // A part of a file's channels says nothing of the others.
    let sharp = picture(&scene, camera(), &["z"]).frame().unwrap();
    assert!(sharp.metadata().cryptomatte.is_empty());
}

#[test]
fn formats_of_pictures_and_points_refuse_mattes() {
    let scene = scene();
    let frame = picture(&scene, camera(), &["crypto_object"]).frame().unwrap();
    let error = encoded(&frame, "png").unwrap_err().to_string();
    assert_eq!(
        error,
        "channel must be a channel other than a Cryptomatte for a PNG (use exr), got crypto_object"
    );
    let frame = picture(&scene, camera(), &["position", "crypto_object"]).frame().unwrap();
    for format in ["ply", "pcd"] {
        let error = encoded(&frame, format).unwrap_err().to_string();
        let expected = "channel must be channels other than a Cryptomatte for a point cloud";
        assert!(error.starts_with(expected), "{error}");
    }
}
