//! Shaders compute many points side by side. Each has to get what it gets alone, to the bit, with
//! every instruction set.

use std::sync::Arc;

use firsthit::channel::kind;
use firsthit::geometry::{DAffine3, DQuat, Transform};
use firsthit::image::{Data, Frame};
use firsthit::render::{Picture, Region};
use firsthit::scene::{
    DirectionalLight, Environment, EnvironmentKind, EnvironmentMap, PointLight, SphereLight,
};
use firsthit::shade::{Ground, Samples};
use firsthit::shoot::Cpu;
use firsthit::{
    Camera, Color, Cone, Cuboid, Cylinder, DVec3, Disc, Hit, InstructionSet, Light, Material,
    Object, Plane, Scene, Shade, Shader, Shading, Sphere, render,
};

use crate::support::{bumpy_sphere, mesh};

/// Shades one sample at a time.
struct Singly<'a>(Shading<'a>);

impl Shade for Singly<'_> {
    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color {
        self.0.shade(t, p, u_r, o)
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], coverage: &mut [f64]) {
        for k in 0..samples.rays.len() {
            let one = Samples {
                rays: &samples.rays[k..=k],
                hits: &samples.hits[k..=k],
                pixels: &samples.pixels[k..=k],
                ..*samples
            };
            (self.0).shade_all(&one, &mut colors[k..=k], &mut coverage[k..=k]);
        }
    }

    fn is_transparent(&self) -> bool {
        self.0.is_transparent()
    }

    fn is_random(&self) -> bool {
        self.0.is_random()
    }

    fn has_negative_noise(&self) -> bool {
        self.0.has_negative_noise()
    }
}

fn placed(object: Object) -> Object {
    let place = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.8, -0.6, 0.9),
        DQuat::from_rotation_x(0.5),
        DVec3::new(0.3, 0.6, 0.2),
    );
    object.placed(Transform::new(place).unwrap())
}

/// Meshes and one of each other shape, as they are or placed.
fn objects() -> Vec<Object> {
    let (points, triangles) = bumpy_sphere(8, 3);
    let bumpy = mesh(&points, triangles);
    let (low, high) = (DVec3::new(0.4, -1.4, -0.6), DVec3::new(1.2, -0.8, 0.3));
    vec![
        Object::new(Arc::clone(&bumpy)).colored(Color::new(0.8, 0.5, 0.3)),
        placed(Object::new(bumpy)).colored(Color::new(0.2, 0.6, 0.7)),
        Object::new(Sphere::new(DVec3::new(-1.5, -0.8, 0.0), 0.6).unwrap()),
        Object::new(Cuboid::new(low, high).unwrap()),
        placed(Object::new(
            Cone::new(DVec3::new(-1.0, -1.5, -0.6), DVec3::new(-1.0, -1.5, 0.6), 0.5, 0.1).unwrap(),
        )),
        Object::new(
            Cylinder::new(DVec3::new(1.4, 0.2, -0.9), DVec3::new(1.5, 0.2, 0.9), 0.3).unwrap(),
        ),
        Object::new(Disc::new(DVec3::new(0.0, 1.4, 0.5), DVec3::new(0.1, -1.0, 0.2), 0.9).unwrap()),
    ]
}

fn lights() -> Vec<Light> {
    let sun = |angle_degrees| {
        Light::from(DirectionalLight {
            direction: DVec3::new(0.6, 0.7, -0.9),
            color: Color::new(0.6, 0.5, 0.4),
            angle_degrees,
        })
    };
    vec![
        sun(0.0),
        sun(25.0),
        Light::from(PointLight {
            position: DVec3::new(-2.0, -3.0, 2.0),
            intensity: Color::new(2.0, 3.0, 1.0),
        }),
        Light::from(SphereLight {
            center: DVec3::new(2.0, -2.0, 2.5),
            radius: 0.5,
            ..SphereLight::default()
        }),
    ]
}

fn environment(kind: EnvironmentKind) -> Arc<Environment> {
    Arc::new(Environment { is_seen: false, ..Environment::new(kind) })
}

/// On a plane under two hemispheres; above a shadow catcher under a map; and with a surface that
/// emits.
fn scenes() -> Vec<Scene> {
    let hemispheres = EnvironmentKind::Hemispheres {
        above: Color::new(0.4, 0.5, 0.7),
        below: Color::new(0.2, 0.15, 0.1),
        up: DVec3::new(0.1, 0.0, 2.0),
    };
    let texels = (0..32_u8).map(|k| [0.1 + f32::from(k % 7), 0.5, 1.0 / (1.0 + f32::from(k))]);
    let map = EnvironmentMap::new(8, 4, texels.collect::<Vec<_>>()).unwrap();
    let map =
        EnvironmentKind::of_map(Arc::new(map), DVec3::Z, &firsthit::geometry::DMat3::IDENTITY);
    let plane = Plane::new(DVec3::new(0.0, 0.0, -1.2), DVec3::Z).unwrap();
    let glowing =
        Material { emission: Color::new(3.0, 2.0, 1.0), ..Material::colored(Color::splat(0.2)) };
    let lamp = Sphere::new(DVec3::new(0.5, -2.0, 1.5), 0.3).unwrap();
    let scene =
        |more: Option<Object>| Scene::new(objects().into_iter().chain(more).collect()).unwrap();
    vec![
        scene(Some(Object::new(plane)))
            .with_lights(lights())
            .with_environment(Some(environment(hemispheres))),
        scene(None).with_lights(lights()).with_environment(Some(environment(map))),
        scene(Some(Object::new(lamp).with_materials([glowing]))),
    ]
}

fn colors(frame: &Frame) -> Vec<u32> {
    match &frame.channel("color").unwrap().data {
        Data::Float32(values) => values.iter().map(|x| x.to_bits()).collect(),
        other => panic!("color is {}", other.kind()),
    }
}

#[test]
fn points_side_by_side_get_the_colors_that_each_gets_alone() {
    let camera =
        Camera::look_at(DVec3::new(0.5, -5.0, 2.0), DVec3::ZERO, DVec3::Z, 45.0, 22, 37).unwrap();
    let kinds = [kind("color").unwrap()];
    let plain = Cpu::with(InstructionSet::Portable);
    for (number, scene) in scenes().iter().enumerate() {
        for name in Shader::NAMES {
            let shading = Shading {
                engine: &plain,
                ground: Ground::under(scene, DVec3::Z),
                ..Shader::named(name).unwrap().on(scene)
            };
            let singly = Singly(shading.clone());
            let expected = colors(&render(scene, &camera, &singly, &kinds, 2, &()).unwrap());
            let mut different = expected.clone();
            different.sort_unstable();
            different.dedup();
            // Ambient occlusion has three: 0, 1 or 2 of two samples see the sky.
            assert!(different.len() > 2, "{number} {name} {}", different.len());
            for set in InstructionSet::available() {
                let shading = Shading { engine: &Cpu::with(set), ..shading.clone() };
                let together = render(scene, &camera, &shading, &kinds, 2, &()).unwrap();
                assert_eq!(colors(&together), expected, "{number} {name} {set:?}");
            }
        }
    }
}

/// A picture of several slabs, the last of few rows: each has the memory of the one before.
#[test]
fn parts_of_a_large_picture_are_those_of_small_ones() {
    let scene = Scene::new(objects()).unwrap();
    let (rows, columns) = (130, 5000);
    let eye = DVec3::new(0.5, -5.0, 2.0);
    let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, 5.0, rows, columns).unwrap();
    let shading = Shader::named("lambert").unwrap().on(&scene);
    let kinds = ["color", "alpha", "object", "ao"].map(|name| kind(name).unwrap());
    let picture = |region| {
        let picture = Picture { region, ..Picture::new(&scene, &camera, &shading, &kinds) };
        picture.render(&()).unwrap()
    };
    let whole = picture(None);
    for part in [0..64, 64..128, 128..130] {
        let small = picture(Some(Region { rows: part.clone(), columns: 0..columns }));
        for (whole, small) in whole.channels().iter().zip(small.channels()) {
            let each = whole.components * columns;
            let of_part = part.start * each..part.end * each;
            match (&whole.data, &small.data) {
                (Data::Float32(whole), Data::Float32(small)) => {
                    assert!(whole[of_part] == small[..], "{part:?}");
                }
                (Data::Int32(whole), Data::Int32(small)) => {
                    assert!(whole[of_part] == small[..], "{part:?}");
                }
                (data, _) => panic!("{}", data.kind()),
            }
        }
    }
}
