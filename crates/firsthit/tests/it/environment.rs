//! Environments against closed forms, sums over all directions, and pictures that others decoded;
//! and in files.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use firsthit::channel::kind;
use firsthit::geometry::rotation;
use firsthit::image::Data;
use firsthit::load::{LoadSettings, load, load_bytes, load_environment};
use firsthit::scene::{Daylight, Environment, EnvironmentKind, EnvironmentMap};
use firsthit::shade::{Direct, Samples};
use firsthit::world::World;
use firsthit::{
    Camera, Color, DMat3, DVec3, Object, Plane, Ray, Scene, Shade, Shader, Sphere, View, fhs,
    render, shoot,
};

fn direct() -> Shader {
    Shader::Direct(Direct::default())
}

fn lit(objects: Vec<Object>, environment: Environment) -> Scene {
    let scene = Scene::new(objects).unwrap();
    scene.with_environment(Some(environment.into()))
}

fn upright(map: EnvironmentMap, up: DVec3) -> Environment {
    Environment::new(EnvironmentKind::of_map(map.into(), up, &DMat3::IDENTITY))
}

fn seen(scene: &Scene, p: DVec3, u_r: DVec3) -> Color {
    let hit = shoot(scene, p, u_r);
    direct().on(scene).shade(hit.t, p, u_r, &hit)
}

/// A dim sky with a spot of a sun, 0.15 % of the picture's width, that gives most of the light.
fn sunny() -> EnvironmentMap {
    let (columns, rows) = (640, 320);
    let texel = |k: usize| {
        let (row, column) = (k / columns, k % columns);
        if (row, column) == (90, 200) {
            [300_000.0, 250_000.0, 200_000.0]
        } else if row < rows / 2 {
            [0.3, 0.5, 0.9]
        } else {
            [0.1, 0.1, 0.05]
        }
    };
    let texels = (0..columns * rows).map(texel).collect::<Vec<_>>();
    EnvironmentMap::new(columns, rows, texels).unwrap()
}

#[test]
fn ambient_occlusion_in_the_open_is_one_under_any_environment() {
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let color = Color::new(3.0, 0.1, 0.6);
    let scene = lit(vec![ball], Environment::new(EnvironmentKind::Uniform(color)));
    let eye = DVec3::new(0.0, -5.0, 2.0);
    let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, 45.0, 24, 32).unwrap();
    let kinds = [kind("ao").unwrap()];
    for samples in [1, 16] {
        let frame = render(&scene, &camera, &direct().on(&scene), &kinds, samples, &()).unwrap();
        // A ball hides no sky from itself.
        let data = &frame.channel("ao").unwrap().data;
        assert!(*data == Data::Float32(vec![1.0; 24 * 32]), "{samples}");
    }
}

fn shared(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/light/public");
    root.join(name)
}

#[test]
#[ignore = "needs ../shared/light"]
fn what_directions_see_of_a_picture_is_what_the_oracle_decoded() {
    let text = fs::read_to_string(shared("08_environment.json")).unwrap();
    let case: serde_json::Value = serde_json::from_str(&text).unwrap();
    let path = shared(case["file"].as_str().unwrap());
    let (map, warnings) = load_environment(&path, &LoadSettings::default()).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let scene = lit(vec![], upright(map, DVec3::Y));
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        let list = value.as_array().unwrap().iter();
        list.map(|number| number.as_f64().unwrap()).collect()
    };
    let (rays, expected) = (case["rays"].as_array().unwrap(), case["expected"].as_array().unwrap());
    assert!(rays.len() > 5);
    for (ray, expected) in rays.iter().zip(expected) {
        let ray = numbers(ray);
        let (p, u_r) = (DVec3::from_slice(&ray[..3]), DVec3::from_slice(&ray[3..]));
        let expected = Color::from_slice(&numbers(expected));
        let got = seen(&scene, p, u_r);
        let off = (got - expected).abs() - 1e-6 * expected.abs();
        assert!(off.max_element() <= 1e-7, "{u_r}: {got} {expected}");
    }
}

/// Without noise: where light is the same from everywhere, surfaces choose where to look.
#[test]
fn in_a_uniform_map_a_matte_ball_has_its_albedo() {
    let albedo = Color::new(0.8, 0.35, 0.1);
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()).colored(albedo);
    let map = EnvironmentMap::new(64, 32, vec![[0.75; 3]; 64 * 32]).unwrap();
    let scene = lit(vec![ball], upright(map, DVec3::Z));
    for k in 0..20 {
        let p = rotation(DVec3::new(1.0, 2.0, 3.0), 18.0 * f64::from(k)) * (4.0 * DVec3::X);
        let got = seen(&scene, p, -p);
        assert!((got - 0.75 * albedo).length() < 1e-12, "{got}");
    }
}

/// The mean of the colours of a level, white ground over so many samples, and the standard error of
/// that.
fn sampled(scene: &Scene, count: usize) -> (f64, f64) {
    let (p, u_r) = (DVec3::new(0.0, 0.0, 2.0), DVec3::new(0.1, 0.2, -1.0));
    let hit = shoot(scene, p, u_r);
    let (rays, hits) = (vec![Ray::new(p, u_r); count], vec![hit; count]);
    let pixels: Vec<u64> = (0..count as u64).collect();
    let samples = Samples { rays: &rays, hits: &hits, pixels: &pixels, sample: 0, cull: None };
    let mut colors = vec![Color::ZERO; count];
    let mut coverage = vec![1.0; count];
    let shade = direct().on(scene);
    shade.shade_all(&samples, &mut colors, &mut coverage);
    let greens: Vec<f64> = colors.iter().map(|color| color.y).collect();
    let mean = greens.iter().sum::<f64>() / count as f64;
    let squares = greens.iter().map(|green| (green - mean) * (green - mean));
    (mean, (squares.sum::<f64>() / count as f64 / count as f64).sqrt())
}

/// The irradiance of a level, white surface: the mean of the upper half's green by the cosine,
/// summed over fine cells.
fn taken(environment: &Environment) -> f64 {
    let (columns, rows) = (640 * 4, 320 * 4);
    let mut sum = 0.0;
    for row in 0..rows / 2 {
        let (sin, cos) = libm::sincos(PI * (f64::from(row) + 0.5) / f64::from(rows));
        for column in 0..columns {
            let (y, x) = libm::sincos(TAU * (f64::from(column) + 0.5) / f64::from(columns));
            let direction = DVec3::new(sin * x, sin * y, cos);
            sum += sin * cos * environment.radiance(direction).y;
        }
    }
    sum * (TAU / f64::from(columns)) * (PI / f64::from(rows)) / PI
}

#[test]
fn a_small_sun_lights_the_ground_without_bias_and_with_little_noise() {
    let environment = upright(sunny(), DVec3::Z);
    let expected = taken(&environment);
    let dim = 0.55;
    assert!(expected > 3.0 * dim, "the sun should count most: {expected}");
    let white = Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()).colored(Color::ONE);
    let scene = lit(vec![white], environment);
    let mut errors = Vec::new();
    for count in [1 << 10, 1 << 14] {
        let (mean, error) = sampled(&scene, count);
        assert!((mean - expected).abs() < 3.0 * error, "{count}: {mean} {expected} {error}");
        errors.push(error / expected);
    }
    // Of 1,024 directions that surfaces choose, hardly one would find the sun at all. What is left
    // is the tent of its one texel, which the table does not know.
    assert!(errors[0] < 0.04, "{errors:?}");
    assert!(errors[1] < 0.3 * errors[0], "{errors:?}");
}

#[test]
fn daylight_lights_the_ground_as_much_as_its_sum_says() {
    let day = Daylight::new(DVec3::Z, 20.0, 30.0, 3.0, Daylight::GROUND).unwrap();
    let environment = Environment::new(EnvironmentKind::Daylight(day.clone()));
    let expected = taken(&environment);
    let white = Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()).colored(Color::ONE);
    let (mean, error) = sampled(&lit(vec![white.clone()], environment.clone()), 1 << 13);
    assert!((mean - expected).abs() < 3.0 * error + 1e-4, "{mean} {expected} {error}");
    assert!(error < 0.01 * expected, "{error}");
    let scene = lit(vec![white], environment).with_lights(vec![day.sun_light().into()]);
    let whole = expected + (day.sun_light().color * day.towards_sun().z).y;
    let (mean, error) = sampled(&scene, 1 << 13);
    assert!((mean - whole).abs() < 3.0 * error + 1e-4, "{mean} {whole} {error}");
    // The sum of both is white, nearly.
    assert!((whole - 1.0).abs() < 0.05, "{whole}");
}

/// Where +z is up, the map's +x stays, its +y becomes +z, and its +z becomes -y; then it is turned.
#[test]
fn scene_environment_and_camera_turned_together_make_the_same_picture() {
    let mut texels = vec![[0.0; 3]; 24 * 12];
    for (k, texel) in texels.iter_mut().enumerate() {
        *texel = [(k % 24) as f32, (k / 24) as f32, (k * k % 17) as f32];
    }
    let map = Arc::new(EnvironmentMap::new(24, 12, texels).unwrap());
    let turned =
        |up, turn: &DMat3| Environment::new(EnvironmentKind::of_map(Arc::clone(&map), up, turn));
    let picture = |environment: &Environment, turn: &DMat3| {
        let camera = Camera::new(View {
            aim: *turn * DVec3::new(1.0, 0.3, -0.2),
            up: *turn * DVec3::Z,
            columns: 16,
            rows: 12,
            ..View::default()
        });
        let camera = camera.unwrap();
        let scene = lit(vec![], environment.clone());
        let pixels = (0..16 * 12).map(|k| {
            let ray = camera.ray(k / 16, k % 16);
            seen(&scene, ray.origin, ray.direction)
        });
        pixels.collect::<Vec<Color>>()
    };
    let plain = turned(DVec3::Z, &DMat3::IDENTITY);
    for (axis, degrees) in [(DVec3::Z, 30.0), (DVec3::new(1.0, -2.0, 0.5), 250.0)] {
        let turn = rotation(axis, degrees);
        let pairs = picture(&plain, &DMat3::IDENTITY);
        let pairs = pairs.into_iter().zip(picture(&turned(DVec3::Z, &turn), &turn));
        for (a, b) in pairs {
            assert!((a - b).length() < 1e-9, "{a} {b}");
        }
    }
    let of_y_up = turned(DVec3::Y, &DMat3::IDENTITY);
    let place = DVec3::new(0.3, 0.5, -0.8);
    let raised = DVec3::new(place.x, -place.z, place.y);
    assert_eq!(of_y_up.radiance(place), plain.radiance(raised));
}

fn hdr(texel: [u8; 4]) -> Vec<u8> {
    [&b"#?RADIANCE\n\n-Y 1 +X 1\n"[..], &texel].concat()
}

fn in_scene(folder: &Path, text: &str) -> Result<World, String> {
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    let loaded = load(&path, &LoadSettings::default()).map_err(|error| error.to_string())?;
    Ok(loaded.world)
}

#[test]
fn scene_files_have_environments_of_every_kind() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("sky")).unwrap();
    fs::write(folder.path().join("sky/a.hdr"), hdr([64, 128, 255, 129])).unwrap();
    let of = |text: &str| in_scene(folder.path(), &format!("[environment]\n{text}")).unwrap();
    let radiance = |text: &str, direction| {
        let world = of(text);
        assert!(world.lights.is_empty());
        world.environment.unwrap().radiance(direction)
    };
    let blue = Color::new(0.5, 1.0, 255.0 / 128.0);
    assert_eq!(radiance("file = \"sky/a.hdr\"", DVec3::X), blue);
    let text = "file = \"sky/a.hdr\"\nrotate = 30\nstrength = 2\nseen = false";
    assert_eq!(radiance(text, DVec3::Y), 2.0 * blue);
    assert!(!of(text).environment.unwrap().is_seen);
    assert_eq!(radiance("color = [1, 2, 3]", DVec3::X), Color::new(1.0, 2.0, 3.0));
    let halves = "above = [1, 1, 1]\nbelow = [0.5, 0, 0]";
    assert_eq!(radiance(halves, DVec3::Z), Color::ONE);
    assert_eq!(radiance(halves, DVec3::NEG_Z), 0.5 * Color::X);
    let gradient = "horizon = [1, 1, 1]\nzenith = [0, 0, 1]\nup = [0, 1, 0]";
    assert_eq!(radiance(gradient, DVec3::Y), Color::Z);

    let world = of("daylight = { elevation = 30, azimuth = 90, turbidity = 4 }\nstrength = 0.5");
    let day = Daylight::new(DVec3::Z, 30.0, 90.0, 4.0, Daylight::GROUND).unwrap();
    let sun = firsthit::Light::from(day.sun_light());
    assert_eq!(world.lights, [sun.scaled(0.5)]);
    let environment = world.environment.unwrap();
    assert_eq!(environment.radiance(DVec3::Z), 0.5 * day.radiance(DVec3::Z));
    let world = of("daylight = { elevation = 30, sun = false }");
    assert!(world.lights.is_empty() && world.environment.is_some());
}

#[test]
fn a_number_turns_about_up_and_a_table_about_any_axis() {
    let folder = tempfile::tempdir().unwrap();
    let texels: Vec<[u8; 4]> = (1..=4).map(|k| [k, k, 0, 136]).collect();
    let bytes = [b"#?RADIANCE\n\n-Y 1 +X 4\n", texels.as_flattened()].concat();
    fs::write(folder.path().join("a.hdr"), bytes).unwrap();
    let of = |rest: &str| {
        let text = format!("up = [0, 1, 0]\n[environment]\nfile = \"a.hdr\"\n{rest}");
        in_scene(folder.path(), &text).unwrap().environment.unwrap()
    };
    // The middle is between 2 and 3; a quarter turn to the left brings there what was to its right,
    // between 3 and 4.
    for (rest, at_x) in [
        ("", 2.5),
        ("rotate = 90", 3.5),
        ("rotate = { axis = [0, 5, 0], degrees = 90 }", 3.5),
        ("rotate = { axis = [0, -1, 0], degrees = 90 }", 1.5),
        ("rotate = { axis = [1, 0, 0], degrees = 90 }", 2.5),
    ] {
        let got = of(rest).radiance(DVec3::X).x;
        assert!((got - at_x).abs() < 1e-9, "{rest}: {got}");
    }
}

#[test]
fn mistakes_in_environments_are_told_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("short.hdr"), &hdr([1, 2, 3, 128])[..24]).unwrap();
    fs::write(folder.path().join("not.hdr"), "P6 1 1 255").unwrap();
    for (text, place, part) in [
        ("file = \"short.hdr\"", ":2:8:", "short.hdr @ byte"),
        ("file = \"not.hdr\"", ":2:8:", "neither as"),
        ("file = \"gone.hdr\"", ":2:8:", "'gone.hdr' is not read"),
        ("file = \"../a.hdr\"", ":2:8:", "refused"),
        ("file = \"/etc/passwd\"", ":2:8:", "refused"),
        ("strength = 2", ":1:1:", "needs `file` or `color`"),
        ("colour = [1, 1, 1]", ":1:1:", "did you mean `color`"),
        ("color = [1, 1, 1]\nrotate = 3", ":3:1:", "unknown key `rotate`"),
        ("daylight = { elevation = 91 }", ":2:26:", "from 0 to 90"),
        ("daylight = { elevation = 9, ground = [2, 0, 0] }", ":2:38:", "ground must be"),
        ("file = \"short.hdr\"\nrotate = \"left\"", ":3:10:", "a finite number, or a table"),
    ] {
        let error = in_scene(folder.path(), &format!("[environment]\n{text}")).unwrap_err();
        assert!(error.contains(place) && error.contains(part), "{text}: {error}");
    }
    let text = b"[environment]\nfile = \"a.hdr\"";
    let error = load_bytes(Path::new("a.toml"), text, &LoadSettings::default()).unwrap_err();
    assert!(error.to_string().contains("in memory"), "{error}");
}

#[test]
fn built_scenes_keep_their_environments() {
    let folder = tempfile::tempdir().unwrap();
    let turn = rotation(DVec3::new(1.0, 2.0, 3.0), 40.0);
    let of_map = EnvironmentKind::of_map(sunny().into(), DVec3::Z, &turn);
    let day = Daylight::new(DVec3::Y, 12.0, -30.0, 5.0, Color::splat(0.4)).unwrap();
    let mut prints = Vec::new();
    for kind in [of_map, EnvironmentKind::Daylight(day)] {
        let environment =
            Arc::new(Environment { strength: 1.5, is_seen: false, ..Environment::new(kind) });
        let world = World { environment: Some(Arc::clone(&environment)), ..World::default() };
        let scene = world.clone().into_scene().unwrap();
        let path = folder.path().join("a.fhs");
        fhs::save(&path, &scene, &world, &()).unwrap();
        let opened =
            load(&path, &LoadSettings { verify: true, ..LoadSettings::default() }).unwrap();
        assert_eq!(opened.world.environment.as_deref(), Some(&*environment));
        let opened = opened.into_scene().unwrap();
        assert_eq!(opened.fingerprint(), scene.fingerprint());
        prints.push(scene.fingerprint().to_owned());
        let direction = DVec3::new(0.3, -0.2, 0.6);
        let radiance = opened.environment().unwrap().radiance(direction);
        assert_eq!(radiance, environment.radiance(direction));
    }
    prints.push(Scene::new(vec![]).unwrap().fingerprint().to_owned());
    prints.sort();
    prints.dedup();
    assert_eq!(prints.len(), 3);
}

#[test]
fn no_bytes_crash_the_reader() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hdr");
    let whole = [
        &b"#?RADIANCE\nEXPOSURE=2\n\n-Y 2 +X 9\n"[..],
        &[2, 2, 0, 9, 137, 7, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9, 137, 0, 137, 129],
        &[2, 2, 0, 9, 137, 7, 137, 7, 137, 0, 137, 129],
    ]
    .concat();
    let settings = LoadSettings { max_memory: 1 << 20, max_texture: 64, ..LoadSettings::default() };
    let mut read = 0;
    for place in 0..whole.len() {
        for value in [0, 1, 2, 9, 43, 48, 57, 127, 128, 255] {
            let mut bytes = whole.clone();
            bytes[place] = value;
            fs::write(&path, &bytes).unwrap();
            match load_environment(&path, &settings) {
                Ok((map, _)) => {
                    read += 1;
                    assert!(map.radiance(DVec3::ONE).is_finite());
                }
                Err(error) => assert!(!error.to_string().chars().any(char::is_control)),
            }
        }
    }
    assert!(read > 100, "{read}");
}
