//! Light that goes through things: glass, translucent surfaces, mirrors that show what lights
//! nothing.

use std::sync::Arc;

use firsthit::scene::{AlphaMode, Environment, EnvironmentKind, Glass, MetalRough, Model};
use firsthit::{Color, Cuboid, DVec3, Material, Object, Ray, Scene, Sphere};

use super::{matte, means, quad, shader};

fn ball(center: DVec3, radius: f64, material: Material) -> Object {
    Object::new(Sphere::new(center, radius).unwrap()).with_materials([material])
}

fn mirror() -> Material {
    Material {
        model: Model::MetalRough(MetalRough {
            metallic: 1.0,
            roughness: 0.0,
            ..MetalRough::default()
        }),
        ..Material::colored(Color::ONE)
    }
}

fn glowing(emission: f64) -> Material {
    Material { emission: Color::splat(emission), ..matte(0.0) }
}

/// A ball that shines in the middle of coloured matter of index 1, seen through two units of it.
#[test]
fn what_is_inside_of_coloured_glass_is_seen_through_it() {
    let glass = Glass { ior: 1.0, absorption: Color::new(0.5, 0.2, 0.0) };
    let glass = Material { model: Model::Glass(glass), ..Material::default() };
    let objects = vec![ball(DVec3::ZERO, 3.0, glass), ball(DVec3::ZERO, 1.0, glowing(2.0))];
    let scene = Scene::new(objects).unwrap();
    let ray = [Ray::new(DVec3::new(0.0, 0.0, 9.0), DVec3::NEG_Z)];
    let expected = 2.0 * Color::new(-1.0, -0.4, 0.0).map(libm::exp);
    for shader in [shader("path", &[]), shader("whitted", &[])] {
        let got = means(&scene, shader, &ray, 4)[0];
        assert!((got - expected).length() < 1e-12, "{got} {expected}");
    }
    // From within, where nothing tells before the ray gets out of it.
    let ray = [Ray::new(DVec3::new(0.0, 0.0, 2.0), DVec3::Z)];
    let white = Environment::new(EnvironmentKind::Uniform(Color::ONE));
    let scene = scene.with_environment(Some(Arc::new(white)));
    let expected = Color::new(-0.5, -0.2, 0.0).map(libm::exp);
    for shader in [shader("path", &[]), shader("whitted", &[])] {
        let got = means(&scene, shader, &ray, 4)[0];
        assert!((got - expected).length() < 1e-12, "{got} {expected}");
    }
}

/// Facets turn no light between two sides of the same index, however rough they are.
#[test]
fn rough_matter_of_index_one_is_invisible() {
    let clear = MetalRough {
        metallic: 0.0,
        roughness: 0.5,
        ior: 1.0,
        transmission: 1.0,
        solid: true,
        ..MetalRough::default()
    };
    let clear = Material { model: Model::MetalRough(clear), ..Material::colored(Color::ONE) };
    let slab = Cuboid::new(DVec3::new(-5.0, -5.0, 0.0), DVec3::new(5.0, 5.0, 1.0)).unwrap();
    let slab = Object::new(slab).with_materials([clear]);
    let scene = Scene::new(vec![slab, ball(DVec3::NEG_Z, 0.5, glowing(3.0))]).unwrap();
    let rays = [0.0, 0.3, 0.6].map(|x| Ray::new(DVec3::new(x, 0.1, 4.0), DVec3::NEG_Z));
    let got = means(&scene, shader("path", &[]), &rays, 64);
    let expected = [3.0, 3.0, 0.0];
    for (got, expected) in got.iter().zip(expected) {
        assert!((got.x - expected).abs() < 1e-12, "{got} {expected}");
    }
}

#[test]
fn a_mirror_shows_what_light_does_not_change() {
    let unlit = Material { unlit: true, ..Material::colored(Color::new(0.3, 0.6, 0.9)) };
    let glass = quad(0.0, 4.0).with_materials([mirror()]);
    let scene = Scene::new(vec![glass, ball(DVec3::new(2.0, 0.0, 2.0), 1.0, unlit)]).unwrap();
    let ray = [Ray::new(DVec3::new(-2.0, 0.0, 2.0), DVec3::new(1.0, 0.0, -1.0))];
    for shader in [shader("path", &[]), shader("whitted", &[])] {
        let got = means(&scene, shader, &ray, 16)[0];
        let expected = Color::new(0.3, 0.6, 0.9);
        assert!((got - expected).length() < 1e-9, "{got}");
    }
}

#[test]
fn what_shines_is_seen_to_shine_by_every_shader_of_light() {
    let scene = Scene::new(vec![ball(DVec3::ZERO, 1.0, glowing(4.0))]).unwrap();
    let ray = [Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z)];
    for name in ["direct", "path", "whitted"] {
        assert_eq!(means(&scene, shader(name, &[]), &ray, 1)[0], Color::splat(4.0), "{name}");
    }
}

/// A panel of alpha 0.25 that shines lights a floor a quarter as much, and hides a quarter of a
/// brighter one behind it. By both ways to find it: a rough metal's own rays, and points that are
/// drawn of it.
#[test]
fn translucent_lamps_shine_as_much_as_they_are_there() {
    let lamp = |alpha, mode| {
        let material = Material { alpha, alpha_mode: mode, ..glowing(1.0) };
        quad(2.0, 3.0).with_materials([material])
    };
    let behind = quad(3.0, 40.0).with_materials([glowing(2.0)]);
    let metal = Material {
        model: Model::MetalRough(MetalRough {
            metallic: 1.0,
            roughness: 0.6,
            ..MetalRough::default()
        }),
        ..Material::colored(Color::ONE)
    };
    let ray = Ray::new(DVec3::new(0.1, 0.2, 0.5), DVec3::NEG_Z);
    for floor in [metal, matte(0.8)] {
        let of = |lamps: Vec<Object>, name| {
            let mut objects = vec![quad(0.0, 9.0).with_materials([floor.clone()])];
            objects.extend(lamps);
            let depth: &[(&str, f64)] = if name == "path" { &[("depth", 1.0)] } else { &[] };
            let scene = Scene::new(objects).unwrap();
            let got = means(&scene, shader(name, depth), &[ray; 64], 64);
            got.iter().map(|color| color.x).sum::<f64>() / 64.0
        };
        for name in ["direct", "path"] {
            let opaque = of(vec![lamp(1.0, AlphaMode::Opaque)], name);
            let blended = of(vec![lamp(0.25, AlphaMode::Blend)], name);
            assert!((blended / opaque - 0.25).abs() < 0.025, "{name} {blended} {opaque}");
            let all = of(vec![behind.clone()], name);
            let hidden = of(vec![lamp(1.0, AlphaMode::Opaque), behind.clone()], name) - opaque;
            let both = of(vec![lamp(0.25, AlphaMode::Blend), behind.clone()], name);
            let expected = 0.25 * (opaque + hidden) + 0.75 * all;
            assert!((both / expected - 1.0).abs() < 0.04, "{name} {both} {expected}");
        }
    }
}

/// Each ray splits at each surface of each pane: of 40 panes there would be more rays than can be.
#[test]
fn many_panes_end() {
    let pane = |k: u32| {
        let low = f64::from(k);
        let pane = Cuboid::new(DVec3::new(-9.0, -9.0, low), DVec3::new(9.0, 9.0, low + 0.5));
        let glass = Material { model: Model::Glass(Glass::default()), ..Material::default() };
        Object::new(pane.unwrap()).with_materials([glass])
    };
    let white = Environment::new(EnvironmentKind::Uniform(Color::ONE));
    let scene =
        Scene::new((0..40).map(pane).collect()).unwrap().with_environment(Some(Arc::new(white)));
    let ray = [Ray::new(DVec3::new(0.0, 0.0, 60.0), DVec3::NEG_Z)];
    let settings = [("least", 0.0), ("depth", 64.0)];
    let got = means(&scene, shader("whitted", &settings), &ray, 1)[0].x;
    assert!(got > 0.5 && got <= 1.0 + 1e-12, "{got}");
}

/// A floor and a point light inside of coloured matter of index 1: on the way from the light to the
/// floor, too, some is absorbed.
#[test]
fn light_is_absorbed_on_its_way_to_what_it_lights() {
    let absorption = Color::new(0.5, 0.2, 0.0);
    let glass = Glass { ior: 1.0, absorption };
    let glass = Material { model: Model::Glass(glass), ..Material::default() };
    let objects = vec![ball(DVec3::ZERO, 3.0, glass), quad(0.0, 1.0).with_materials([matte(1.0)])];
    let light =
        firsthit::scene::PointLight { position: DVec3::new(0.0, 0.0, 1.5), intensity: Color::ONE };
    let scene = Scene::new(objects).unwrap().with_lights(vec![light.into()]);
    let ray = [Ray::new(DVec3::new(0.01, 0.02, 9.0), DVec3::NEG_Z)];
    let expected = (-4.5 * absorption).map(libm::exp) / 2.25;
    for name in ["path", "whitted"] {
        let mut shader = shader(name, &[]);
        if name == "whitted" {
            let black = firsthit::geometry::Value::Vector(DVec3::ZERO);
            shader.set("ambient", black).unwrap();
        }
        let got = means(&scene, shader, &ray, 4)[0];
        assert!((got - expected).length() < 1e-3, "{name}: {got} {expected}");
    }
}

/// Refraction into a diamond leaves a sixth of the radiance, and the way out gives it back. A path
/// that ended by what it brings inside would be noisy, where every path is worth as much as any
/// other.
#[test]
fn roulette_ends_no_path_in_clear_glass() {
    let glass = Glass { ior: 2.4, absorption: Color::ZERO };
    let glass = Material { model: Model::Glass(glass), ..Material::default() };
    let white = Environment::new(EnvironmentKind::Uniform(Color::ONE));
    let scene = Scene::new(vec![ball(DVec3::ZERO, 1.0, glass)]).unwrap();
    let scene = scene.with_environment(Some(Arc::new(white)));
    let rays = [-0.9, -0.3, 0.2, 0.6].map(|x| Ray::new(DVec3::new(x, 0.1, 5.0), DVec3::NEG_Z));
    let shading = shader("path", &[("depth", 64.0), ("roulette", 1.0)]).on(&scene);
    for (mean, error) in super::seen(&shading, &rays, 256) {
        assert!((mean.x - 1.0).abs() < 1e-9 && error.x < 1e-6, "{mean} {error}");
    }
}
