//! The cases of `../shared/light`, and the same closed forms for scenes of our own.

use std::path::PathBuf;
use std::sync::Arc;

use firsthit::load::LoadSettings;
use firsthit::scene::{
    Background, DiscLight, Environment, EnvironmentKind, Glass, Light, Matte, Model,
    RectangleLight, SphereLight,
};
use firsthit::{
    Color, Cuboid, DVec3, Disc, Material, Mesh, Object, Plane, Positions, Ray, Scene, Shading,
    Sphere, load,
};
use serde_json::Value;

use super::{matte, means, seen, shader};

fn folder() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "../../../shared/light/public"].iter().collect()
}

struct Case {
    json: Value,
    rays: Vec<Ray>,
    expected: Vec<Color>,
}

fn triple(value: &Value, from: usize) -> DVec3 {
    DVec3::from([0, 1, 2].map(|k| value[from + k].as_f64().unwrap()))
}

fn case(name: &str) -> Case {
    let text = std::fs::read_to_string(folder().join(name).with_extension("json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    let rays = json["rays"].as_array().unwrap().iter();
    let expected = json["expected"].as_array().unwrap().iter();
    Case {
        rays: rays.map(|ray| Ray::new(triple(ray, 0), triple(ray, 3))).collect(),
        expected: expected.map(|color| triple(color, 0)).collect(),
        json,
    }
}

impl Case {
    fn scene(&self) -> Scene {
        let path = folder().join(self.json["file"].as_str().unwrap());
        load(&path, &LoadSettings::default()).unwrap().into_scene().unwrap()
    }

    fn samples(&self) -> u32 {
        self.json["tolerance"]["samples"].as_u64().unwrap_or(1) as u32
    }

    fn check(&self, got: &[Color]) {
        let number = |name: &str| self.json["tolerance"][name].as_f64().unwrap_or(0.0);
        for ((got, expected), ray) in got.iter().zip(&self.expected).zip(&self.rays) {
            let allowed = number("absolute") + number("relative") * expected.abs();
            let off = (*got - *expected).abs();
            assert!(off.cmple(allowed).all(), "{ray:?}: {got} instead of {expected}");
        }
    }
}

#[test]
#[ignore = "needs ../shared/light"]
fn a_sphere_light_on_a_floor() {
    let case = case("02_sphere_light");
    let floor = Plane::new(DVec3::ZERO, DVec3::Z).unwrap();
    let floor = Object::new(floor).with_materials([matte(0.5)]);
    let light =
        SphereLight { center: DVec3::new(0.0, 0.0, 2.0), radius: 0.5, emission: Color::splat(3.0) };
    let lit = Scene::new(vec![floor.clone()]).unwrap().with_lights(vec![light.into()]);
    let glowing = Material { emission: Color::splat(3.0), ..matte(0.0) };
    let ball = Sphere::new(light.center, 0.5).unwrap();
    let ball = Object::new(ball).with_materials([glowing]);
    let with_ball = Scene::new(vec![floor, ball]).unwrap();
    for scene in [lit, with_ball] {
        for shader in [shader("direct", &[]), shader("path", &[("depth", 1.0)])] {
            case.check(&means(&scene, shader, &case.rays, case.samples()));
        }
    }
}

#[test]
#[ignore = "needs ../shared/light"]
fn a_square_that_shines() {
    let case = case("03_quad_light");
    // The case is about matte surfaces. A dielectric of glTF, even of roughness 1, reflects 4 % at
    // its surface, so the file's own floor is a little darker.
    let mut objects = case.scene().objects().to_vec();
    for object in &mut objects {
        let matte = object
            .materials()
            .iter()
            .map(|material| Material { model: Model::Matte(Matte), ..material.clone() });
        *object = object.clone().with_materials(matte.collect::<Vec<_>>());
    }
    let scene = Scene::new(objects).unwrap();
    for shader in [shader("direct", &[]), shader("path", &[("depth", 1.0)])] {
        case.check(&means(&scene, shader, &case.rays, case.samples()));
    }
}

#[test]
#[ignore = "needs ../shared/light"]
fn ambient_occlusion_beside_a_wall_and_under_a_lid() {
    let case = case("04_ao");
    case.check(&means(&case.scene(), shader("ao", &[]), &case.rays, case.samples()));
}

#[test]
#[ignore = "needs ../shared/light"]
fn a_furnace_without_noise() {
    let case = case("05_furnace");
    let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    let ball = Object::new(ball).colored(Color::new(0.2, 0.5, 0.9));
    let white = Environment::new(EnvironmentKind::Uniform(Color::ONE));
    let scene = Scene::new(vec![ball]).unwrap().with_environment(Some(Arc::new(white)));
    for shader in [shader("direct", &[]), shader("path", &[])] {
        case.check(&means(&scene, shader, &case.rays, case.samples()));
    }
}

#[test]
#[ignore = "needs ../shared/light"]
fn a_slab_of_glass_before_a_sky() {
    let case = case("07_slab");
    let slab = Cuboid::new(DVec3::new(-50.0, -50.0, -0.1), DVec3::new(50.0, 50.0, 0.1)).unwrap();
    let glass = Material { model: Model::Glass(Glass::default()), ..Material::default() };
    let scene = Scene::new(vec![Object::new(slab).with_materials([glass])]).unwrap();
    let sky = Background::Gradient {
        horizon: Color::new(0.2, 0.3, 0.4),
        zenith: Color::new(0.9, 0.7, 0.5),
        up: DVec3::Z,
    };
    let whitted = shader("whitted", &[("depth", 16.0), ("least", 0.0)]);
    let shading = Shading { background: sky, ..whitted.on(&scene) };
    let got: Vec<Color> = seen(&shading, &case.rays, 1).into_iter().map(|(mean, _)| mean).collect();
    case.check(&got);
    let shading = Shading { background: sky, ..shader("path", &[("depth", 64.0)]).on(&scene) };
    for ((mean, error), expected) in
        seen(&shading, &case.rays, 4096).into_iter().zip(&case.expected)
    {
        let off = (mean - *expected).abs();
        assert!(off.cmple(4.0 * error + 1e-6).all(), "{mean} {error} {expected}");
    }
}

/// E / pi = L (r / d)^2 cos, the light wholly above the horizon.
#[test]
fn a_sphere_light_gives_the_square_of_radius_over_distance() {
    let floor =
        Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()).with_materials([matte(1.0)]);
    let light =
        SphereLight { center: DVec3::new(0.0, 0.0, 3.0), radius: 1.0, emission: Color::splat(2.0) };
    let scene = Scene::new(vec![floor]).unwrap().with_lights(vec![light.into()]);
    let rays = [0.0, 2.0, 5.0].map(|x| Ray::new(DVec3::new(x, 0.0, 0.1), DVec3::NEG_Z));
    let got = means(&scene, shader("direct", &[]), &rays, 256);
    for (got, x) in got.iter().zip([0.0_f64, 2.0, 5.0]) {
        let squared = x * x + 9.0;
        let expected = 2.0 / squared * 3.0 / squared.sqrt();
        assert!((got.x / expected - 1.0).abs() < 2e-3, "{got} {expected}");
    }
}

/// On its axis a disc gives L r^2 / (r^2 + h^2). A square gives Lambert's polygon formula, by
/// quadrature here.
#[test]
fn discs_and_rectangles_give_what_formulas_say() {
    let floor =
        Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()).with_materials([matte(1.0)]);
    let ray = [Ray::new(DVec3::new(0.0, 0.0, 0.1), DVec3::NEG_Z)];
    let of = |light: Light| {
        let scene = Scene::new(vec![floor.clone()]).unwrap().with_lights(vec![light]);
        means(&scene, shader("direct", &[]), &ray, 1024)[0].x
    };
    let disc = of(Light::from(DiscLight {
        center: DVec3::new(0.0, 0.0, 2.0),
        normal: DVec3::NEG_Z,
        radius: 1.5,
        emission: Color::ONE,
    }));
    let expected = 1.5 * 1.5 / (1.5 * 1.5 + 4.0);
    assert!((disc / expected - 1.0).abs() < 2e-3, "{disc} {expected}");
    let square = of(Light::from(RectangleLight {
        center: DVec3::new(0.3, 0.0, 2.0),
        edge_u: 2.0 * DVec3::Y,
        edge_v: 3.0 * DVec3::X,
        emission: Color::ONE,
    }));
    let mut expected = 0.0;
    let cells = 400_u32;
    for k in 0..cells * cells {
        let [x, y] = [k % cells, k / cells].map(|k| (f64::from(k) + 0.5) / f64::from(cells) - 0.5);
        let squared = DVec3::new(0.3 + 3.0 * x, 2.0 * y, 2.0).length_squared();
        expected += 4.0 / (squared * squared) * 6.0 / f64::from(cells * cells);
    }
    expected /= std::f64::consts::PI;
    assert!((square / expected - 1.0).abs() < 2e-3, "{square} {expected}");
}

/// Beside an infinitely long wall of height H at distance a: (1 + a / sqrt(a^2 + H^2)) / 2. The
/// wall is a hundred times as long as it is high: an end leaves 1e-4.
#[test]
fn occlusion_beside_a_wall() {
    let corners =
        vec![[0.0, -200.0, 0.0], [0.0, 200.0, 0.0], [0.0, 200.0, 2.0], [0.0, -200.0, 2.0]];
    let wall = Mesh::new(Positions::compact(corners), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let floor = Plane::new(DVec3::ZERO, DVec3::Z).unwrap();
    let scene = Scene::new(vec![Object::new(floor), Object::new(Arc::new(wall))]).unwrap();
    let rays = [0.1, 1.0, 4.0].map(|a| Ray::new(DVec3::new(a, 0.0, 0.01), DVec3::NEG_Z));
    let got = means(&scene, shader("ao", &[]), &rays, 4096);
    for (got, a) in got.iter().zip([0.1_f64, 1.0, 4.0]) {
        let expected = 0.5 * (1.0 + a / (a * a + 4.0).sqrt());
        assert!((got.x - expected).abs() < 4e-3, "{got} {expected}");
    }
    // Up to a reach D > a: 1 - (b - sin b cos b) / pi, cos b = a / D, while D is less than the way
    // to the top.
    let got = means(&scene, shader("ao", &[("reach", 1.5)]), &rays[1..2], 4096);
    let b = libm::acos(1.0 / 1.5);
    let expected = 1.0 - (b - libm::sin(b) * libm::cos(b)) / std::f64::consts::PI;
    assert!((got[0].x - expected).abs() < 4e-3, "{} {expected}", got[0]);
}

/// In a closed white sphere with a lamp in the middle every point gets I / R^2 from the lamp, and
/// of all bounces together rho / (1 - rho) I / R^2.
#[test]
fn all_bounces_in_a_sphere_are_a_geometric_series() {
    let ball = Object::new(Sphere::new(DVec3::ZERO, 2.0).unwrap()).with_materials([matte(0.6)]);
    let lamp = firsthit::scene::PointLight { position: DVec3::ZERO, intensity: Color::ONE };
    let scene = Scene::new(vec![ball]).unwrap().with_lights(vec![lamp.into()]);
    let ray = [Ray::new(DVec3::new(0.3, 0.1, 0.2), DVec3::new(0.3, -0.5, 0.4))];
    let got = means(&scene, shader("path", &[("depth", 200.0)]), &ray, 16_384)[0].x;
    let expected = 0.6 / 0.4 / 4.0;
    assert!((got / expected - 1.0).abs() < 0.01, "{got} {expected}");
}

#[test]
fn a_disc_that_shines_is_found_though_it_is_not_drawn() {
    let floor =
        Object::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap()).with_materials([matte(1.0)]);
    let glowing = Material { emission: Color::ONE, ..matte(0.0) };
    let disc = Disc::new(DVec3::new(0.0, 0.0, 2.0), DVec3::NEG_Z, 1.5).unwrap();
    let disc = Object::new(disc).with_materials([glowing]);
    let scene = Scene::new(vec![floor, disc]).unwrap();
    let ray = [Ray::new(DVec3::new(0.0, 0.0, 0.1), DVec3::NEG_Z)];
    let got = means(&scene, shader("direct", &[]), &ray, 4096)[0].x;
    let expected = 1.5 * 1.5 / (1.5 * 1.5 + 4.0);
    assert!((got / expected - 1.0).abs() < 0.01, "{got} {expected}");
}

#[test]
#[ignore = "needs ../shared/light"]
fn metallic_roughness_as_gltf_has_it_where_that_gives_no_more_than_it_gets() {
    let mut case = case("06_gltf_brdf");
    let scene = case.scene();
    let got = means(&scene, shader("direct", &[]), &case.rays, 1);
    // Seen from the side, the matte ground of what is no metal gets what the boundary leaves, and
    // not more.
    for k in [2, 5, 14] {
        assert!(case.rays[k].direction.z.abs() < 0.3);
        let share = got[k] / case.expected[k];
        assert!(share.max_element() < 0.99 && share.min_element() > 0.75, "{k}: {share}");
        case.expected[k] = got[k];
    }
    case.check(&got);
}
