//! Pictures against closed forms: shading, channels, antialiasing, and the same bytes for any
//! threads.

use firsthit::channel::{ChannelInput, ChannelKind, KINDS, kind, make};
use firsthit::image::{Data, Frame};
use firsthit::render::work;
use firsthit::scene::{DirectionalLight, PointLight};
use firsthit::shade::Lambert;
use firsthit::shoot::{First, trace};
use firsthit::watch::Watch;
use firsthit::{
    Background, Camera, Color, Cuboid, DVec3, Disc, Error, Hit, Light, Object, Plane, Scene, Shade,
    Shader, Shading, Sphere, example, render, shoot,
};

use crate::support::on_threads;

const RED: Color = Color::new(0.8, 0.1, 0.05);

fn doubles<'a>(frame: &'a Frame, name: &str) -> &'a [f64] {
    match &frame.channel(name).unwrap().data {
        Data::Float64(values) => values,
        other => panic!("{name} is {}", other.kind()),
    }
}

fn colors(frame: &Frame) -> Vec<[f32; 3]> {
    match &frame.channel("color").unwrap().data {
        Data::Float32(values) => values.as_chunks().0.to_vec(),
        other => panic!("color is {}", other.kind()),
    }
}

/// A ground of one colour seen from above, through one ray.
fn ground(lights: Vec<Light>, above: Option<Object>) -> Scene {
    let ground = Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()).colored(RED);
    let objects = std::iter::once(ground).chain(above).collect();
    Scene::new(objects).unwrap().with_lights(lights)
}

fn seen(scene: &Scene, shader: Shader, p: DVec3, u_r: DVec3) -> Color {
    let background = Background::Uniform(Color::new(0.1, 0.2, 0.3));
    let shade = Shading { background, ..shader.on(scene) };
    let hit = shoot(scene, p, u_r);
    shade.shade(hit.t, p, u_r, &hit)
}

fn close(a: Color, b: Color) -> bool {
    (a - b).length() < 1e-12
}

const EYE: DVec3 = DVec3::new(0.3, -0.2, 4.0);

fn lambert() -> Shader {
    Shader::Lambert(Lambert { ambient: Color::splat(0.1), shadows: true, ..Lambert::default() })
}

#[test]
fn parallel_light_counts_by_the_cosine_of_its_angle() {
    let color = Color::new(0.9, 0.8, 0.7);
    let light = Light::from(DirectionalLight {
        direction: DVec3::new(3.0, 0.0, -4.0),
        color,
        angle_degrees: 0.0,
    });
    let scene = ground(vec![light], None);
    let expected = RED * (Color::splat(0.1) + 0.8 * color);
    assert!(close(seen(&scene, lambert(), EYE, DVec3::NEG_Z), expected));
    // From below the same plane is its own shadow.
    assert!(close(seen(&scene, lambert(), -EYE, DVec3::Z), RED * 0.1));
}

#[test]
fn a_point_light_falls_off_with_the_square_of_its_distance() {
    let light = Light::from(PointLight {
        position: DVec3::new(0.3, -0.2, 2.0),
        intensity: Color::splat(2.0),
    });
    let scene = ground(vec![light], None);
    assert!(close(seen(&scene, lambert(), EYE, DVec3::NEG_Z), RED * (0.1 + 2.0 / 4.0)));
    let aside = DVec3::new(0.3, 1.3, 4.0); // 1.5 from below the light: 2.5 away, with a cosine of 0.8
    assert!(close(seen(&scene, lambert(), aside, DVec3::NEG_Z), RED * (0.1 + 0.8 * 2.0 / 6.25)));
}

#[test]
fn what_is_in_the_way_casts_a_shadow_and_what_is_behind_the_light_does_not() {
    let disc = |z| Object::new(Disc::new(DVec3::new(0.0, 0.0, z), DVec3::Z, 0.1).unwrap());
    let light = Light::from(PointLight {
        position: DVec3::new(0.0, 0.0, 2.0),
        intensity: Color::splat(4.0),
    });
    let from = DVec3::new(3.0, 0.0, 4.0); // beside the disc
    let u_r = DVec3::ZERO - from;
    for (z, lit) in [(1.0, false), (3.0, true)] {
        let scene = ground(vec![light], Some(disc(z)));
        let expected = if lit { RED * 1.1 } else { RED * 0.1 };
        assert!(close(seen(&scene, lambert(), from, u_r), expected), "{z}");
        let bare = Shader::Lambert(Lambert {
            ambient: Color::splat(0.1),
            shadows: false,
            ..Lambert::default()
        });
        assert!(close(seen(&scene, bare, from, u_r), RED * 1.1), "{z}");
    }
}

/// With an epsilon that does not fit the scene, a surface would be in its own shadow.
#[test]
fn surfaces_do_not_shadow_themselves_at_any_scale_or_place() {
    for (scale, offset) in [(1.0, 0.0), (1e-5, 0.0), (1e6, 0.0), (1.0, 1e6), (1e-3, -50.0)] {
        let place = |p: DVec3| p * scale + DVec3::splat(offset);
        let sphere = Sphere::new(place(DVec3::ZERO), scale).unwrap();
        let light = Light::from(DirectionalLight {
            direction: DVec3::new(0.2, 0.3, -1.0),
            color: Color::ONE,
            angle_degrees: 0.0,
        });
        let scene = Scene::new(vec![Object::new(sphere)]).unwrap().with_lights(vec![light]);
        for k in 0..400 {
            let (x, y) = (f64::from(k % 20) / 20.0 - 0.5, f64::from(k / 20) / 20.0 - 0.5);
            let p = place(DVec3::new(x, y, 3.0));
            let hit = shoot(&scene, p, DVec3::NEG_Z);
            let color = seen(&scene, lambert(), p, DVec3::NEG_Z);
            assert!(!hit.is_miss() && color.x > 0.3, "{scale} {offset} {k}: {color}");
        }
    }
}

#[test]
fn unlit_is_the_objects_colour_and_normal_its_normal() {
    let scene = ground(Vec::new(), None);
    assert_eq!(seen(&scene, Shader::named("unlit").unwrap(), EYE, DVec3::NEG_Z), RED);
    let normal = seen(&scene, Shader::named("normal").unwrap(), EYE, DVec3::NEG_Z);
    assert_eq!(normal, Color::new(0.5, 0.5, 1.0));
    assert!(Shader::named("toon").unwrap_err().to_string().contains("unlit, normal, got 'toon'"));
}

#[test]
fn misses_see_the_background_which_is_a_function_of_the_direction() {
    let scene = ground(Vec::new(), None);
    assert_eq!(seen(&scene, lambert(), EYE, DVec3::Z), Color::new(0.1, 0.2, 0.3));
    let (horizon, zenith) = (Color::new(1.0, 0.5, 0.0), Color::new(0.0, 0.5, 1.0));
    let sky = Background::Gradient { horizon, zenith, up: DVec3::new(0.0, 0.0, 7.0) };
    assert_eq!(sky.color(DVec3::new(3.0, 0.0, 0.0)), horizon);
    assert_eq!(sky.color(DVec3::new(0.0, 0.0, 0.1)), zenith);
    assert_eq!(sky.color(DVec3::new(0.0, 4.0, -2.0)), horizon);
    assert!(close(sky.color(DVec3::new(0.0, 4.0, 3.0)), horizon.lerp(zenith, 0.6)));
}

fn small_camera() -> Camera {
    example::camera(30, 40).unwrap()
}

#[test]
fn every_channel_is_what_a_loop_over_the_pixels_gives() {
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let shade = |t: f64, p: DVec3, u_r: DVec3, o: &Hit| {
        if t == f64::INFINITY {
            u_r.abs()
        } else {
            Color::new(1.0 / t, p.x.abs(), f64::from(o.object))
        }
    };
    let names = [
        "color",
        "t",
        "range",
        "z",
        "object",
        "primitive",
        "face",
        "normal",
        "incidence",
        "position",
        "barycentric",
        "front",
    ];
    let kinds: Vec<_> = names.map(|name| kind(name).unwrap()).to_vec();
    let frame = render(&scene, &camera, &shade, &kinds, 1, &()).unwrap();
    assert_eq!(frame.shape(), [30, 40]);
    let vector = |name: &str, k: usize| DVec3::from_slice(&doubles(&frame, name)[3 * k..]);
    for k in 0..camera.pixels() {
        let (row, column) = (k / 40, k % 40);
        let ray = camera.ray(row, column);
        let hit = shoot(&scene, ray.origin, ray.direction);
        let color = shade(hit.t, ray.origin, ray.direction, &hit);
        assert_eq!(colors(&frame)[k], color.as_vec3().to_array());
        assert_eq!(doubles(&frame, "t")[k], hit.t);
        assert_eq!(doubles(&frame, "range")[k], camera.range(row, column, hit.t));
        assert_eq!(doubles(&frame, "z")[k], camera.z(row, column, hit.t));
        if hit.is_miss() {
            assert!(
                vector("normal", k).is_nan()
                    && vector("position", k).is_nan()
                    && vector("barycentric", k).is_nan()
            );
            assert!(doubles(&frame, "incidence")[k].is_nan());
        } else {
            assert_eq!(vector("normal", k), scene.interaction(&ray, &hit).unwrap().normal());
            let cosine = vector("normal", k).dot(ray.direction).abs();
            let angle = doubles(&frame, "incidence")[k];
            assert!((libm::cos(angle) - cosine).abs() < 1e-14, "{angle}");
            assert_eq!(vector("position", k), scene.interaction(&ray, &hit).unwrap().position());
        }
    }
}

#[test]
fn antialiased_colours_are_means_and_leave_all_else_alone() {
    let scene =
        Scene::new(vec![Object::new(Cuboid::new(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap())])
            .unwrap();
    let camera =
        Camera::look_at(DVec3::new(0.1, 0.2, 3.0), DVec3::ZERO, DVec3::Y, 30.0, 9, 12).unwrap();
    let covered = |t: f64, _: DVec3, _: DVec3, _: &Hit| {
        if t < f64::INFINITY { Color::ONE } else { Color::ZERO }
    };
    let kinds = ["color", "object", "t"].map(|name| kind(name).unwrap());
    let picture = |samples| render(&scene, &camera, &covered, &kinds, samples, &()).unwrap();
    let (one, many, more) = (picture(1), picture(16), picture(4096));
    for name in ["object", "t"] {
        assert_eq!(one.channel(name), many.channel(name));
    }
    let inner = colors(&many).iter().filter(|c| c[0] > 0.0 && c[0] < 1.0).count();
    assert!(inner > 5, "{inner} pixels on the border");
    for (few, many) in colors(&many).iter().zip(colors(&more)) {
        // Of a straight edge 16 points are within two of the truth.
        assert!((few[0] - many[0]).abs() <= 2.0 / 16.0 + 0.01, "{few:?} {many:?}");
    }
    assert!(matches!(
        render(&scene, &camera, &covered, &kinds, 0, &()),
        Err(Error::Argument { name: "samples", .. })
    ));
}

/// A shader that gets many pixels at once comes to the colours that it gives one by one.
#[test]
fn shading_together_and_one_by_one_is_the_same() {
    let lights = vec![
        Light::from(DirectionalLight {
            direction: DVec3::new(0.3, -1.0, -0.5),
            color: Color::splat(0.6),
            angle_degrees: 0.0,
        }),
        Light::from(PointLight {
            position: DVec3::new(1.0, 3.0, 2.0),
            intensity: Color::new(3.0, 2.0, 1.0),
        }),
    ];
    let scene = example::scene().unwrap().with_lights(lights);
    let camera = example::camera(30, 40).unwrap();
    let kinds = [kind("color").unwrap()];
    for name in Shader::NAMES {
        let shading = Shading {
            background: example::background(),
            ..Shader::named(name).unwrap().on(&scene)
        };
        let one_by_one = |t: f64, p: DVec3, u_r: DVec3, o: &Hit| shading.shade(t, p, u_r, o);
        // One by one, numbers are drawn that are no pixel's.
        if shading.is_random() {
            continue;
        }
        // More than are shaded at once, where that is quick.
        let all: &[u32] = if *name == "lambert" { &[1, 5, 300] } else { &[1, 5] };
        for &samples in all {
            let together = render(&scene, &camera, &shading, &kinds, samples, &()).unwrap();
            let single = render(&scene, &camera, &one_by_one, &kinds, samples, &()).unwrap();
            assert_eq!(colors(&together), colors(&single), "{name} {samples}");
            let mut different = colors(&together);
            different.dedup();
            assert!(different.len() > 100, "{name} {}", different.len());
        }
    }
}

#[test]
fn the_same_picture_with_1_2_and_7_threads() {
    let camera = example::camera(40, 64).unwrap();
    let kinds = ["color", "t", "object", "primitive", "normal", "barycentric"]
        .map(|name| kind(name).unwrap());
    let pictures = [1, 2, 7].map(|threads| {
        on_threads(threads, || {
            let scene = example::scene().unwrap();
            let shade =
                Shading { background: example::background(), ..Shader::default().on(&scene) };
            let frame = render(&scene, &camera, &shade, &kinds, 4, &()).unwrap();
            let mut bytes = Vec::new();
            let format = firsthit::image::format_named("npz").unwrap();
            format
                .encode(
                    &frame,
                    None,
                    firsthit::image::WriteSettings::default(),
                    &mut bytes,
                    "memory".as_ref(),
                )
                .unwrap();
            bytes
        })
    });
    assert!(pictures[0].len() > 100_000 && pictures.iter().all(|bytes| *bytes == pictures[0]));
}

#[test]
fn a_stopped_picture_is_interrupted() {
    struct Stopped;
    impl Watch for Stopped {
        fn is_stopped(&self) -> bool {
            true
        }
    }
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let shade = |_: f64, _: DVec3, _: DVec3, _: &Hit| Color::ZERO;
    let result = render(&scene, &camera, &shade, &[kind("color").unwrap()], 1, &Stopped);
    assert!(matches!(result, Err(Error::Interrupted)));
}

#[test]
fn channels_are_interrupted_too() {
    struct Stopped;
    impl Watch for Stopped {
        fn is_stopped(&self) -> bool {
            true
        }
    }
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let hits = trace(&scene, &camera, First, &()).unwrap();
    let shots = ChannelInput { scene: &scene, rays: &camera, hits: &hits, sensor: Some(&camera) };
    // Lines are drawn for pictures, not made of hits.
    for kind in KINDS.iter().filter(|kind| !kind.needs_samples() && kind.name != "edge") {
        let result = make(&[kind], &shots, &Stopped);
        assert!(matches!(result, Err(Error::Interrupted)), "{}", kind.name);
    }
}

#[test]
fn a_watch_is_told_of_all_the_work_that_was_announced() {
    #[derive(Default)]
    struct Counted(std::sync::atomic::AtomicU64);
    impl Watch for Counted {
        fn advance(&self, rays: u64) {
            self.0.fetch_add(rays, std::sync::atomic::Ordering::Relaxed);
        }
    }
    let (scene, camera) = (example::scene().unwrap(), small_camera());
    let shade = |_: f64, _: DVec3, _: DVec3, _: &Hit| Color::ZERO;
    let kinds: Vec<&ChannelKind> = KINDS.iter().collect();
    for samples in [1, 4] {
        let watch = Counted::default();
        render(&scene, &camera, &shade, &kinds, samples, &watch).unwrap();
        let announced = work(camera.pixels(), &kinds, samples);
        assert_eq!(watch.0.into_inner(), announced);
    }
}
