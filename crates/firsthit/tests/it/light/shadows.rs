//! Shadows: surfaces that hide light, those that do not, and the ground that catches shadows.

use std::sync::Arc;

use firsthit::scene::{
    DirectionalLight, DiscLight, Environment, EnvironmentKind, EnvironmentMap, Light, MapRole,
    MetalRough, Model, SphereLight, Texture, TextureMap,
};
use firsthit::shade::Ground;
use firsthit::shape::Attribute;
use firsthit::{
    Background, Color, DVec3, Disc, Material, Mesh, Object, Positions, Ray, Scene, Shading, Sphere,
};

use super::{matte, means, quad, seen, shader};

fn rough_metal() -> Material {
    Material {
        model: Model::MetalRough(MetalRough {
            metallic: 1.0,
            roughness: 0.4,
            ..MetalRough::default()
        }),
        ..Material::colored(Color::ONE)
    }
}

fn lamp() -> Light {
    Light::from(SphereLight {
        center: DVec3::new(1.0, 0.0, 4.0),
        radius: 0.8,
        emission: Color::splat(5.0),
    })
}

const DOWN: [Ray; 1] = [Ray {
    origin: DVec3::new(0.0, 0.0, 0.5),
    direction: DVec3::NEG_Z,
    t_min: 0.0,
    t_max: f64::INFINITY,
}];

/// A lid between a floor and a lamp.
fn lidded(floor: Material, has_lid: bool) -> Scene {
    let mut objects = vec![quad(0.0, 9.0).with_materials([floor])];
    if has_lid {
        objects.push(quad(2.0, 9.0).with_materials([matte(0.5)]));
    }
    Scene::new(objects).unwrap().with_lights(vec![lamp()])
}

#[test]
fn without_shadows_nothing_hides_lights() {
    for floor in [rough_metal(), matte(0.7)] {
        let open = means(&lidded(floor.clone(), false), shader("direct", &[]), &DOWN, 8192)[0].x;
        let mut bare = shader("direct", &[]);
        bare.set("shadows", firsthit::geometry::Value::Flag(false)).unwrap();
        let hidden = means(&lidded(floor, true), bare, &DOWN, 8192)[0].x;
        assert!((hidden / open - 1.0).abs() < 0.02, "{hidden} {open}");
    }
}

/// Up to a reach things hide the environment; lights they always hide.
#[test]
fn a_reach_is_that_of_the_environment_alone() {
    let reach = shader("direct", &[("reach", 0.5)]);
    for floor in [rough_metal(), matte(0.7)] {
        let got = means(&lidded(floor.clone(), true), reach.clone(), &DOWN, 256)[0];
        assert_eq!(got, Color::ZERO);
        // What shines beyond it is seen as well.
        let shining = Material { emission: Color::ONE, ..matte(0.0) };
        let objects =
            vec![quad(0.0, 9.0).with_materials([floor]), quad(2.0, 9.0).with_materials([shining])];
        let scene = Scene::new(objects).unwrap();
        let [far, near] = [shader("direct", &[]), reach.clone()]
            .map(|shader| means(&scene, shader, &DOWN, 1024)[0].x);
        assert!(near > 0.1 && (near / far - 1.0).abs() < 0.01, "{near} {far}");
    }
}

/// A map with one bright spot over a rest that is even.
fn spotted() -> Environment {
    let texels = (0..64 * 32).map(|k| [if k == 5 * 64 + 40 { 900.0 } else { 0.5 }; 3]);
    let map = EnvironmentMap::new(64, 32, texels.collect::<Vec<_>>()).unwrap();
    Environment {
        is_seen: false,
        ..Environment::new(EnvironmentKind::of_map(
            Arc::new(map),
            DVec3::Z,
            &firsthit::DMat3::IDENTITY,
        ))
    }
}

/// An occlusion map takes its share of all that comes from the environment, whichever way it was
/// found.
#[test]
fn occlusion_maps_hide_the_environment() {
    let texture = Texture::new(1, 1, vec![[128, 128, 128, 255]]).unwrap();
    let map = TextureMap::new(Arc::new(texture), TextureMap::V_UP);
    let corners = [[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0]];
    let mesh = Mesh::new(Positions::compact(corners.to_vec()), vec![[0, 1, 2]])
        .and_then(|mesh| {
            mesh.with_uvs(Attribute::per_vertex(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))
        })
        .unwrap();
    let mesh = Arc::new(mesh);
    for floor in [rough_metal(), matte(0.7)] {
        let of = |material: Material| {
            let object = Object::new(Arc::clone(&mesh)).with_materials([material]);
            let scene =
                Scene::new(vec![object]).unwrap().with_environment(Some(Arc::new(spotted())));
            let ray = [Ray::new(DVec3::new(4.0, 1.0, 5.0), DVec3::NEG_Z)];
            means(&scene, shader("direct", &[]), &ray, 8192)[0].x
        };
        let plain = of(floor.clone());
        let occluded = of(Material {
            maps: floor.maps.clone().with(MapRole::Occlusion, map.clone()),
            ..floor
        });
        let expected = 128.0 / 255.0;
        assert!((occluded / plain - expected).abs() < 0.005, "{occluded} {plain}");
    }
}

/// The colour of a ground under a disc, before a white background.
fn ground_seen(scene: &Scene, at: DVec3, samples: u32) -> f64 {
    let shading = Shading {
        background: Background::Uniform(Color::ONE),
        ground: Some(Ground { point: DVec3::ZERO, up: DVec3::Z }),
        ..shader("direct", &[]).on(scene)
    };
    let ray = [Ray::new(at + DVec3::new(3.0, 0.0, 0.2), DVec3::new(-3.0, 0.0, -0.2))];
    seen(&shading, &ray, samples)[0].0.x
}

fn disc() -> Object {
    Object::new(Disc::new(DVec3::new(0.0, 0.0, 1.0), DVec3::Z, 1.0).unwrap())
}

/// A disc of radius 1 at height 1 hides half of an even sky from the point under it.
#[test]
fn the_ground_shows_how_much_of_the_sky_is_hidden() {
    let white =
        Environment { is_seen: false, ..Environment::new(EnvironmentKind::Uniform(Color::ONE)) };
    let scene = Scene::new(vec![disc()]).unwrap().with_environment(Some(Arc::new(white)));
    let got = ground_seen(&scene, DVec3::ZERO, 4096);
    assert!((got - 0.5).abs() < 0.005, "{got}");
}

/// Of a sun of cosine 0.8 and 0.7 as much as the sky, a shadow leaves the sky.
#[test]
fn the_ground_shows_the_shadow_of_the_sun() {
    let sky = Environment {
        is_seen: false,
        ..Environment::new(EnvironmentKind::Uniform(Color::splat(0.5)))
    };
    let sun = DirectionalLight {
        direction: DVec3::new(0.6, 0.0, -0.8),
        color: Color::splat(0.7),
        angle_degrees: 0.53,
    };
    let small = Object::new(Disc::new(DVec3::new(-60.0, 0.0, 80.0), DVec3::Z, 2.0).unwrap());
    let scene = Scene::new(vec![small])
        .unwrap()
        .with_lights(vec![sun.into()])
        .with_environment(Some(Arc::new(sky)));
    let got = ground_seen(&scene, DVec3::ZERO, 4096);
    let expected = 0.5 / (0.5 + 0.8 * 0.7);
    assert!((got - expected).abs() < 0.003, "{got} {expected}");
    assert!((ground_seen(&scene, DVec3::new(40.0, 0.0, 0.0), 256) - 1.0).abs() < 0.01);
}

/// The bright spot of a map casts a shadow: what is left there is what the rest of the sky brings.
#[test]
fn the_ground_shows_the_shadow_of_what_is_bright_in_a_map() {
    let environment = spotted();
    let up = DVec3::Z;
    // By cells, without the library's sums.
    let (mut all, mut brightest, mut spot) = (0.0, 0.0, DVec3::ZERO);
    let side = 1500_u32;
    for k in 0..side * side {
        let [across, height] = [k % side, k / side].map(|x| (f64::from(x) + 0.5) / f64::from(side));
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * across);
        let level = (1.0 - height * height).sqrt();
        let towards = DVec3::new(level * cos, level * sin, height);
        let radiance = environment.radiance(towards).x;
        all += 2.0 * height * radiance / f64::from(side * side);
        brightest += 2.0 * height * (radiance - 0.5) / f64::from(side * side);
        spot += (radiance - 0.5) * towards;
    }
    let towards = spot.normalize();
    let blocker = Object::new(Disc::new(100.0 * towards, towards, 15.0).unwrap());
    let hidden = 0.15 * 0.15 / (1.0 + 0.15 * 0.15) * towards.dot(up) * 0.5;
    let scene = Scene::new(vec![blocker]).unwrap().with_environment(Some(Arc::new(environment)));
    let got = ground_seen(&scene, DVec3::ZERO, 4096);
    let expected = 1.0 - (brightest + hidden) / all;
    assert!((got - expected).abs() < 0.01, "{got} {expected}");
}

/// A lamp nearby, whose light varies over its own points, and a surface that shines as much: half
/// of a disc is hidden by a wall.
#[test]
fn the_ground_shows_shadows_of_lamps_and_of_what_shines() {
    // Upright, across the middle of the disc above: seen from the point under it, one half is
    // behind it.
    let corners =
        vec![[0.01, -50.0, 0.0], [0.01, 50.0, 0.0], [0.01, 50.0, 1.0], [0.01, -50.0, 1.0]];
    let wall = Mesh::new(Positions::compact(corners), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let wall = Object::new(Arc::new(wall)).colored(Color::ZERO);
    let lamp = DiscLight {
        center: DVec3::new(0.0, 0.0, 1.5),
        normal: DVec3::NEG_Z,
        radius: 2.0,
        emission: Color::ONE,
    };
    let lit = Scene::new(vec![wall.clone()]).unwrap().with_lights(vec![lamp.into()]);
    let ball = Sphere::new(DVec3::new(0.0, 0.0, 4.0), 1.0).unwrap();
    let glowing = Material { emission: Color::ONE, ..matte(0.0) };
    let ball = Object::new(ball).with_materials([glowing]);
    let with_ball = Scene::new(vec![wall, ball]).unwrap();
    for (what, scene) in [("a lamp", lit), ("a ball", with_ball)] {
        // On the wall's side to which the ray comes.
        let got = ground_seen(&scene, DVec3::new(0.02, 0.0, 0.0), 4096);
        assert!((got - 0.5).abs() < 0.02, "{what} {got}");
    }
}

/// A translucent pane in front of the ground: its shadow is seen through the pane as beside it.
#[test]
fn the_ground_is_seen_through_translucent_surfaces() {
    let pane =
        Material { alpha: 0.25, alpha_mode: firsthit::scene::AlphaMode::Blend, ..matte(0.0) };
    let environment =
        Environment { is_seen: false, ..Environment::new(EnvironmentKind::Uniform(Color::ONE)) };
    let environment = Some(Arc::new(environment));
    // Upright, across the ray and far from the point of the ground that it ends at.
    let pane = Object::new(Disc::new(DVec3::new(2.9, 0.0, 0.19), DVec3::X, 0.01).unwrap())
        .with_materials([pane]);
    let plain = Scene::new(vec![disc()]).unwrap();
    let plain = plain.with_environment(environment.clone());
    let with_pane = Scene::new(vec![disc(), pane]).unwrap();
    let with_pane = with_pane.with_environment(environment);
    let beside = ground_seen(&plain, DVec3::ZERO, 2048);
    let through = ground_seen(&with_pane, DVec3::ZERO, 2048);
    assert!((beside - 0.5).abs() < 0.01, "{beside}");
    assert!((through - 0.75 * beside).abs() < 0.01, "{through} {beside}");
}

/// A disc over the ground, in a sun.
fn disc_in(sun: DirectionalLight) -> Scene {
    let scene = Scene::new(vec![disc()]).unwrap();
    scene.with_lights(vec![sun.into()])
}

/// The scene before white, with a ground or without one.
fn before_white(scene: &Scene, has_ground: bool) -> Shading<'_> {
    let ground = Ground { point: DVec3::ZERO, up: DVec3::Z };
    Shading {
        background: Background::Uniform(Color::ONE),
        ground: has_ground.then_some(ground),
        ..shader("direct", &[]).on(scene)
    }
}

fn camera() -> firsthit::Camera {
    let (from, to) = (DVec3::new(0.0, -6.0, 3.0), DVec3::ZERO);
    firsthit::Camera::look_at(from, to, DVec3::Z, 40.0, 24, 32).unwrap()
}

/// The colours and alphas of a picture by one sample.
fn picture(shading: &Shading<'_>) -> [Vec<f64>; 2] {
    let kinds = ["color", "alpha"].map(|name| firsthit::channel::kind(name).unwrap());
    let camera = camera();
    let picture = firsthit::render::Picture {
        samples: 1,
        ..firsthit::render::Picture::new(shading.scene, &camera, shading, &kinds)
    };
    let frame = picture.render(&()).unwrap();
    [0, 1].map(|index| {
        let data = &frame.channels()[index].data;
        (0..data.len()).map(|k| data.value(k)).collect()
    })
}

/// A single sample of the ground may be darkened by more than all; a picture has no colour below 0,
/// and no alpha above 1.
#[test]
fn pictures_of_the_ground_have_no_colour_below_black() {
    let scene = disc_in(DirectionalLight {
        direction: DVec3::new(0.1, 0.2, -1.0),
        color: Color::ONE,
        angle_degrees: 60.0,
    });
    let shading = before_white(&scene, true);
    let within = |values: &Vec<f64>| values.iter().all(|x| (0.0..=1.0).contains(x));
    assert!(picture(&shading).iter().all(within));
    // It is a test only where samples are beyond.
    let rays: Vec<Ray> = (0..24 * 32).map(|k| camera().ray(k / 32, k % 32)).collect();
    let sampled = seen(&shading, &rays, 1);
    assert!(sampled.iter().any(|(color, _)| color.x < -0.01));
}
