//! Changes of a scene that leave its picture alone, or change it in a known way.

use std::sync::Arc;

use firsthit::render::{Picture, Region};
use firsthit::scene::{
    DirectionalLight, Environment, EnvironmentKind, Glass, Light, MetalRough, Model, PointLight,
    SphereLight,
};
use firsthit::{
    Background, Camera, Color, Cuboid, DVec3, Material, Object, Plane, Scene, Shade, Shader,
    Shading, Sphere, channel,
};

use super::{seen, shader};
use crate::support::on_threads;

/// A ball over a floor, in front of a block.
fn objects(size: f64) -> Vec<Object> {
    let ball = Sphere::new(size * DVec3::new(0.0, 0.0, 1.0), size).unwrap();
    let floor = Plane::new(DVec3::ZERO, DVec3::Z).unwrap();
    let [low, high] = [DVec3::new(1.2, 0.5, 0.0), DVec3::new(2.0, 1.5, 2.0)];
    let block = Cuboid::new(size * low, size * high).unwrap();
    vec![
        Object::new(ball).colored(Color::new(0.8, 0.3, 0.2)),
        Object::new(floor).colored(Color::splat(0.7)),
        Object::new(block).colored(Color::new(0.2, 0.4, 0.9)),
    ]
}

fn lamp(size: f64, strength: f64) -> Light {
    Light::from(SphereLight {
        center: size * DVec3::new(-2.0, -2.0, 4.0),
        radius: 0.7 * size,
        emission: Color::splat(8.0 * strength),
    })
}

fn sun(strength: f64) -> Light {
    Light::from(DirectionalLight {
        direction: DVec3::new(0.3, 1.0, -0.8),
        color: Color::splat(0.6 * strength),
        angle_degrees: 5.0,
    })
}

fn camera(size: f64) -> Camera {
    let [from, to] = [DVec3::new(1.0, -6.0, 3.0), DVec3::new(0.5, 0.0, 0.8)];
    Camera::look_at(size * from, size * to, DVec3::Z, 45.0, 24, 32).unwrap()
}

fn colors(scene: &Scene, shader: Shader, camera: &Camera, samples: u32) -> Vec<f32> {
    let shading =
        Shading { background: Background::Uniform(Color::new(0.1, 0.2, 0.3)), ..shader.on(scene) };
    picture(scene, &shading, camera, samples, None)
}

fn picture(
    scene: &Scene,
    shade: &dyn Shade,
    camera: &Camera,
    samples: u32,
    region: Option<Region>,
) -> Vec<f32> {
    let kinds = [channel::kind("color").unwrap()];
    let picture = Picture { samples, region, ..Picture::new(scene, camera, shade, &kinds) };
    let frame = picture.render(&()).unwrap();
    match &frame.channels()[0].data {
        firsthit::image::Data::Float32(values) => values.clone(),
        other => panic!("{other:?}"),
    }
}

fn lit(lights: Vec<Light>) -> Scene {
    Scene::new(objects(1.0)).unwrap().with_lights(lights)
}

#[test]
fn a_light_twice_as_strong_makes_a_picture_twice_as_bright_bit_for_bit() {
    for name in ["direct", "path", "lambert", "whitted"] {
        let dark = |scene: &Scene| {
            let mut shader = Shader::named(name).unwrap();
            let _ = shader.set("ambient", firsthit::geometry::Value::Number(0.0));
            let shading = Shading { background: Background::default(), ..shader.on(scene) };
            picture(scene, &shading, &camera(1.0), 4, None)
        };
        let once = dark(&lit(vec![lamp(1.0, 1.0), sun(1.0)]));
        let twice = dark(&lit(vec![lamp(1.0, 2.0), sun(2.0)]));
        // The numbers that a light draws are its own, so a light that is another draws others; but
        // not if it is scaled.
        let doubled: Vec<f32> = once.iter().map(|x| 2.0 * x).collect();
        assert!(twice == doubled, "{name}");
        assert!(once.iter().any(|&x| x > 0.1), "{name}");
    }
}

#[test]
fn two_lights_are_the_sum_bit_for_bit() {
    let scenes = [vec![lamp(1.0, 1.0)], vec![sun(1.0)], vec![lamp(1.0, 1.0), sun(1.0)]].map(lit);
    let rays: Vec<_> = (0..24 * 32).map(|k| camera(1.0).ray(k / 32, k % 32)).collect();
    let black = |scene: &Scene| -> Vec<Color> {
        let shading =
            Shading { background: Background::default(), ..shader("direct", &[]).on(scene) };
        seen(&shading, &rays, 1).into_iter().map(|(mean, _)| mean).collect()
    };
    let [one, other, both] = scenes.map(|scene| black(&scene));
    for ((one, other), both) in one.iter().zip(&other).zip(&both) {
        assert_eq!(*one + *other, *both);
    }
}

/// A power of two scales without rounding.
#[test]
fn a_scene_a_thousand_times_as_large_looks_the_same_bit_for_bit() {
    let size = 1024.0;
    for name in ["direct", "path", "ao"] {
        let near = Scene::new(objects(1.0)).unwrap();
        let far = Scene::new(objects(size)).unwrap();
        let point = |size: f64| {
            Light::from(PointLight {
                position: size * DVec3::new(-2.0, -2.0, 4.0),
                intensity: Color::splat(9.0 * size * size),
            })
        };
        let near = near.with_lights(vec![sun(1.0), point(1.0)]);
        let far = far.with_lights(vec![sun(1.0), point(size)]);
        let shader = || Shader::named(name).unwrap();
        let near = colors(&near, shader(), &camera(1.0), 3);
        assert!(near == colors(&far, shader(), &camera(size), 3), "{name}");
    }
}

#[test]
fn glass_of_index_one_is_invisible() {
    let scene = lit(vec![sun(1.0)]);
    let clear = Material {
        model: Model::Glass(Glass { ior: 1.0, ..Glass::default() }),
        ..Material::default()
    };
    let pane = Cuboid::new(DVec3::new(-3.0, -3.0, 0.5), DVec3::new(3.0, -2.9, 4.0)).unwrap();
    let mut with_pane = objects(1.0);
    with_pane.push(Object::new(pane).with_materials([clear]));
    let with_pane = Scene::new(with_pane).unwrap().with_lights(vec![sun(1.0)]);
    let whitted = || shader("whitted", &[("shadows", 0.0)]);
    let _ = whitted;
    let mut shader = Shader::named("whitted").unwrap();
    shader.set("shadows", firsthit::geometry::Value::Flag(false)).unwrap();
    let without = colors(&scene, shader.clone(), &camera(1.0), 1);
    let with = colors(&with_pane, shader, &camera(1.0), 1);
    for (with, without) in with.iter().zip(&without) {
        assert!((with - without).abs() < 1e-6, "{with} {without}");
    }
}

/// In a mirror one sees what the mirrored camera sees, for light that does not come by the mirror.
#[test]
fn a_mirror_shows_what_the_mirrored_camera_sees() {
    let mirror = Material {
        model: Model::MetalRough(MetalRough {
            metallic: 1.0,
            roughness: 0.0,
            ..MetalRough::default()
        }),
        ..Material::colored(Color::ONE)
    };
    let wall = Cuboid::new(DVec3::new(-9.0, -8.1, -9.0), DVec3::new(9.0, -8.0, 9.0)).unwrap();
    let mut with_wall = objects(1.0);
    with_wall.push(Object::new(wall).with_materials([mirror]));
    let mut shader = Shader::named("whitted").unwrap();
    shader.set("shadows", firsthit::geometry::Value::Flag(false)).unwrap();
    let [from, to] = [DVec3::new(1.0, -6.0, 3.0), DVec3::new(0.5, -8.0, 2.2)];
    let look = |from, to| Camera::look_at(from, to, DVec3::Z, 45.0, 24, 32).unwrap();
    let mirrored = |point: DVec3| DVec3::new(point.x, -16.0 - point.y, point.z);
    let seen = colors(
        &Scene::new(with_wall).unwrap().with_lights(vec![sun(1.0)]),
        shader.clone(),
        &look(from, to),
        1,
    );
    let direct = colors(&lit(vec![sun(1.0)]), shader, &look(mirrored(from), mirrored(to)), 1);
    // What is right in one is left in the other.
    for row in 0..24 {
        for column in 0..32 {
            for axis in 0..3 {
                let [here, there] = [column, 31 - column].map(|c| 3 * (32 * row + c) + axis);
                let (seen, direct) = (seen[here], direct[there]);
                assert!((seen - direct).abs() < 2e-5, "{row} {column}: {seen} {direct}");
            }
        }
    }
}

#[test]
fn one_scattering_is_direct_light_on_average() {
    let sky = Environment::new(EnvironmentKind::Hemispheres {
        above: Color::new(0.5, 0.6, 0.8),
        below: Color::splat(0.1),
        up: DVec3::Z,
    });
    let scene = lit(vec![lamp(1.0, 1.0)]).with_environment(Some(Arc::new(sky)));
    let rays: Vec<_> = (0..24 * 32).step_by(37).map(|k| camera(1.0).ray(k / 32, k % 32)).collect();
    let of = |shader: Shader| seen(&shader.on(&scene), &rays, 1024);
    let direct = of(shader("direct", &[]));
    let path = of(shader("path", &[("depth", 1.0)]));
    for ((one, error), (other, other_error)) in direct.into_iter().zip(path) {
        let off = (one - other).abs();
        assert!(off.cmple(5.0 * (error + other_error) + 1e-6).all(), "{one} {other} {error}");
    }
}

/// A white matte ball under a white sky is as bright as the sky is seen: each with the same
/// numbers.
#[test]
fn occlusion_is_a_white_scene_under_a_white_sky_on_average() {
    let white = |object: Object| object.colored(Color::ONE);
    let scene = Scene::new(objects(1.0).into_iter().map(white).collect()).unwrap();
    let sky = Environment::new(EnvironmentKind::Uniform(Color::ONE));
    let scene = scene.with_environment(Some(Arc::new(sky)));
    let rays: Vec<_> = (0..24 * 32).step_by(29).map(|k| camera(1.0).ray(k / 32, k % 32)).collect();
    let [occlusion, direct] =
        ["ao", "direct"].map(|name| seen(&shader(name, &[]).on(&scene), &rays, 1024));
    for ((one, error), (other, other_error)) in occlusion.into_iter().zip(direct) {
        let off = (one - other).abs();
        assert!(off.cmple(5.0 * (error + other_error) + 1e-6).all(), "{one} {other}");
    }
}

#[test]
fn bytes_are_the_same_for_any_threads_regions_and_splits_of_the_samples() {
    let sky = Environment::new(EnvironmentKind::Uniform(Color::splat(0.4)));
    let scene = lit(vec![lamp(1.0, 1.0), sun(1.0)]).with_environment(Some(Arc::new(sky)));
    let camera = camera(1.0);
    for name in ["direct", "path", "ao", "whitted"] {
        let shading = Shader::named(name).unwrap().on(&scene);
        let whole = picture(&scene, &shading, &camera, 5, None);
        for threads in [1, 2, 7] {
            let again = on_threads(threads, || picture(&scene, &shading, &camera, 5, None));
            assert!(again == whole, "{name} {threads}");
        }
        let region = Region { rows: 5..17, columns: 3..30 };
        let part = picture(&scene, &shading, &camera, 5, Some(region));
        for (row, part) in part.chunks(27 * 3).enumerate() {
            let first = 3 * (32 * (5 + row) + 3);
            assert!(part == &whole[first..first + 27 * 3], "{name} {row}");
        }
        let kinds = [channel::kind("color").unwrap()];
        let unfinished = Picture::new(&scene, &camera, &shading, &kinds);
        let mut progressive = unfinished.start().unwrap();
        for _ in 0..5 {
            progressive.add_sample(&()).unwrap();
        }
        let frame = progressive.frame().unwrap();
        let firsthit::image::Data::Float32(values) = &frame.channels()[0].data else {
            panic!("colours are float32");
        };
        assert!(values == &whole, "{name}");
    }
}

/// A closed furnace: where all walls shine with 1 - rho and reflect rho, everything is 1.
#[test]
fn energy_is_neither_made_nor_lost_in_a_furnace() {
    let walls = Material { emission: Color::splat(0.4), ..Material::colored(Color::splat(0.6)) };
    let room = Cuboid::new(DVec3::splat(-3.0), DVec3::splat(3.0)).unwrap();
    let ball = Sphere::new(DVec3::new(0.5, 0.0, 0.0), 1.0).unwrap();
    let objects =
        [Object::new(room), Object::new(ball)].map(|object| object.with_materials([walls.clone()]));
    let scene = Scene::new(objects.into()).unwrap();
    let rays = [DVec3::X, DVec3::new(-0.3, 0.5, 0.2), DVec3::new(0.1, 0.2, -0.9)];
    let rays = rays.map(|towards| firsthit::Ray::new(DVec3::new(-2.0, 0.3, 0.1), towards));
    let shading = shader("path", &[("depth", 64.0), ("roulette", 64.0)]).on(&scene);
    for (mean, error) in seen(&shading, &rays, 512) {
        assert!((mean.x - 1.0).abs() < 5.0 * error.x + 1e-3, "{mean} {error}");
    }
}

/// Walls of white plastic, of colour 0.98, that shine a little: each way of light adds what the
/// last left, and no more.
#[test]
fn light_in_a_closed_box_of_white_plastic_does_not_grow() {
    let model = |roughness| MetalRough { roughness, ..MetalRough::default() };
    let room = Cuboid::new(DVec3::splat(-3.0), DVec3::splat(3.0)).unwrap();
    let ray = firsthit::Ray::new(DVec3::new(-2.0, 0.3, 0.1), DVec3::new(-0.3, 0.5, 0.2));
    for roughness in [0.1, 0.5] {
        let walls = Material {
            emission: Color::splat(0.02),
            model: model(roughness).into(),
            ..Material::colored(Color::splat(0.98))
        };
        let scene = Object::new(room).with_materials([walls]);
        let scene = Scene::new(vec![scene]).unwrap();
        let shading = shader("path", &[("depth", 100.0), ("roulette", 100.0)]).on(&scene);
        for (mean, error) in seen(&shading, &[ray], 64) {
            // A hundred times the same: that is all if nothing were lost.
            assert!(mean.x < 1.3 + 5.0 * error.x, "{roughness}: {mean} {error}");
        }
    }
}

/// Lights that take light away make pictures that nobody can explain: a ray of the camera's next
/// sample is darker than black.
#[test]
fn a_picture_with_light_below_zero_is_refused_whoever_gave_it() {
    let picture = |scene: &Scene| {
        let shading = Shader::default().on(scene);
        let kinds = [channel::kind("color").unwrap()];
        let camera = camera(1.0);
        let picture = Picture::new(scene, &camera, &shading, &kinds);
        picture.render(&()).map(drop).map_err(|error| error.to_string())
    };
    let color = "a colour of finite numbers that are not negative";
    let message = picture(&lit(vec![sun(1.0), sun(-1.0)])).unwrap_err();
    assert!(message.starts_with(&format!("color must be {color}")), "{message}");
    let message = picture(&lit(vec![lamp(1.0, f64::NAN)])).unwrap_err();
    assert!(message.contains(color), "{message}");
    let dark = Material { emission: Color::new(0.0, -0.1, 0.0), ..Material::default() };
    let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    let dark = Scene::new(vec![Object::new(ball).with_materials([dark])]).unwrap();
    let message = picture(&dark).unwrap_err();
    assert!(message.starts_with(&format!("emission must be {color}")), "{message}");
    assert!(picture(&lit(vec![sun(0.0)])).is_ok());
    let mut light = Light::named("point").unwrap();
    let value = firsthit::geometry::Value::Number(-1.0);
    let message = light.set("intensity", value).unwrap_err().to_string();
    assert_eq!(message, format!("intensity must be {color}, got -1,-1,-1"));
}
