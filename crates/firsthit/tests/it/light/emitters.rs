//! Surfaces that emit light: copies of them, spheres around the point, what is shown as it is, and
//! a clear coat over them.

use std::f64::consts::PI;
use std::sync::Arc;

use firsthit::scene::MetalRough;
use firsthit::shade::Ground;
use firsthit::{
    Background, Color, DMat3, DVec3, Material, Mesh, Object, Positions, Ray, Scene, Shading, Sphere,
};

use super::{matte, means, quad, seen, shader};

fn glowing(color: f64, emission: f64) -> Material {
    Material { emission: Color::splat(emission), ..matte(color) }
}

fn ball(radius: f64, material: Material) -> Object {
    Object::new(Sphere::new(DVec3::ZERO, radius).unwrap()).with_materials([material])
}

const DOWN: [Ray; 1] = [Ray {
    origin: DVec3::new(0.3, 0.2, 0.5),
    direction: DVec3::NEG_Z,
    t_min: 0.0,
    t_max: f64::INFINITY,
}];

/// Files write two-sided surfaces as each triangle twice, or the whole object twice. A ray meets
/// one of them.
#[test]
fn copies_of_a_lamp_do_not_shine_twice() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    // Sides and heights whose rounding differs from ray to ray.
    let corners = corners.map(|[x, y]: [f64; 2]| [0.7 * x + 0.1, 0.9 * y, 2.3 + 0.1 * x]);
    let lamp = |triangles: &[[u32; 3]]| {
        let mesh = Mesh::new(Positions::compact(corners.to_vec()), triangles.to_vec());
        Object::new(Arc::new(mesh.unwrap())).with_materials([glowing(0.0, 3.0)])
    };
    let single = lamp(&[[0, 1, 2], [0, 2, 3]]);
    let double = lamp(&[[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]]);
    for name in ["direct", "path"] {
        let lit = |lamps: Vec<Object>| {
            let mut objects = vec![quad(0.0, 9.0).with_materials([matte(0.8)])];
            objects.extend(lamps);
            let scene = Scene::new(objects).unwrap();
            means(&scene, shader(name, &[]), &DOWN, 4096)[0].x
        };
        let expected = lit(vec![single.clone()]);
        assert!(expected > 0.1);
        for lamps in [vec![double.clone()], vec![single.clone(); 3]] {
            let got = lit(lamps);
            assert!((got / expected - 1.0).abs() < 0.01, "{name}: {got} {expected}");
        }
    }
}

/// A ball that glows inwards: everything in it sees light from everywhere.
#[test]
fn within_a_glowing_ball_light_comes_from_everywhere() {
    for name in ["direct", "path"] {
        let floor = quad(0.0, 1.0).with_materials([matte(0.6)]);
        let scene = Scene::new(vec![ball(10.0, glowing(0.0, 1.0)), floor]).unwrap();
        let depth = if name == "path" { &[("depth", 1.0)][..] } else { &[] };
        let got = means(&scene, shader(name, depth), &DOWN, 2048)[0].x;
        assert!((got - 0.6).abs() < 0.005, "{name}: {got}");
    }
}

/// Points of the glowing wall itself, inside or outside of it by rounding. A black ball in the
/// middle takes a quarter of all light, the square of the sine of the cone in which they see it;
/// the rest is the wall's.
#[test]
fn the_wall_of_a_glowing_ball_lights_itself() {
    let scene = Scene::new(vec![ball(2.0, glowing(0.6, 1.0)), ball(1.0, matte(0.0))]).unwrap();
    let rays: Vec<Ray> = (0..64)
        .map(|k| {
            let turn = 2.0 * PI * f64::from(k) / 64.0;
            let level = DVec3::new(libm::cos(turn), libm::sin(turn), 0.1);
            Ray::new(1.5 * level, level)
        })
        .collect();
    for name in ["direct", "path"] {
        let depth = if name == "path" { &[("depth", 1.0)][..] } else { &[] };
        let got = means(&scene, shader(name, depth), &rays, 512);
        let mean = got.iter().map(|color| color.x).sum::<f64>() / 64.0;
        assert!((mean - 1.45).abs() < 0.003, "{name}: {mean}");
        for color in got {
            assert!((color.x - 1.45).abs() < 0.05, "{name}: {color}");
        }
    }
}

/// A material that is shown as it is gives no light, be it lit, met or seen in a mirror (glTF's
/// `KHR_materials_unlit`).
#[test]
fn what_is_unlit_does_not_emit() {
    let unlit = Material { unlit: true, ..glowing(0.5, 7.0) };
    let mirror = Material {
        model: MetalRough { metallic: 1.0, roughness: 0.0, ..MetalRough::default() }.into(),
        ..Material::colored(Color::ONE)
    };
    let above = quad(2.0, 9.0).with_materials([unlit]);
    for (floor, expected) in [(matte(1.0), 0.0), (mirror, 0.5)] {
        let scene = Scene::new(vec![quad(0.0, 9.0).with_materials([floor]), above.clone()]);
        let scene = scene.unwrap();
        for name in ["path", "whitted"] {
            let settings = if name == "whitted" { &[] } else { &[("depth", 2.0)][..] };
            let mut shader = shader(name, settings);
            if name == "whitted" {
                let black = firsthit::geometry::Value::Vector(DVec3::ZERO);
                shader.set("ambient", black).unwrap();
            }
            let got = means(&scene, shader, &DOWN, 64)[0];
            assert_eq!(got, Color::splat(expected), "{name}");
        }
    }
}

/// A coat keeps back of the light from below what it reflects of other light
/// (`KHR_materials_clearcoat`): 1 - 0.04 - 0.96 (1 - n.v)^5.
#[test]
fn a_clear_coat_dims_the_emission_below_it() {
    let coated = Material {
        model: MetalRough { clearcoat: 1.0, clearcoat_roughness: 0.5, ..MetalRough::default() }
            .into(),
        ..glowing(0.0, 1.0)
    };
    let scene = Scene::new(vec![quad(0.0, 9.0).with_materials([coated])]).unwrap();
    for degrees in [0.0_f64, 45.0, 80.0] {
        let (sine, cosine) = libm::sincos(degrees.to_radians());
        let direction = -DVec3::new(sine, 0.0, cosine);
        let ray = [Ray::new(-direction, direction)];
        let expected = 1.0 - 0.04 - 0.96 * libm::pow(1.0 - cosine, 5.0);
        for name in ["direct", "path", "whitted"] {
            let got = means(&scene, shader(name, &[]), &ray, 1)[0].x;
            assert!((got - expected).abs() < 1e-12, "{name} {degrees}: {got} {expected}");
        }
    }
}

/// A lamp close to the ground, all of it behind a lid: nothing of its light is left, whatever the
/// draws of the sample.
#[test]
fn all_light_of_a_near_lamp_is_missing_on_the_ground() {
    let lamp = quad(0.1, 1.0).with_materials([glowing(0.0, 1.0)]);
    let lid = quad(0.05, 30.0).with_materials([matte(0.0)]);
    let scene = Scene::new(vec![lamp, lid]).unwrap();
    let ground = Ground { point: DVec3::ZERO, up: DVec3::Z };
    let shading = Shading {
        background: Background::Uniform(Color::ONE),
        ground: Some(ground),
        ..shader("direct", &[]).on(&scene)
    };
    // Below the lid, downwards.
    let rays: Vec<Ray> = (0..256)
        .map(|k| {
            let [x, y] = [k % 16, k / 16].map(|x| 0.1 * (f64::from(x) - 7.5));
            Ray::new(DVec3::new(x, y, 0.04), DVec3::NEG_Z)
        })
        .collect();
    let got = seen(&shading, &rays, 64);
    let mean = got.iter().map(|(color, _)| color.x).sum::<f64>() / 256.0;
    assert!(mean.abs() < 0.03, "{mean}");
}

/// Lights beyond the range of float64 bring no light, and no NaN.
#[test]
fn lights_beyond_all_range_make_no_nan() {
    let lights = [(5.0, 1e300), (1e200, 1e199)];
    for (height, radius) in lights {
        let lamp = firsthit::scene::DiscLight {
            center: DVec3::new(0.0, 0.0, height),
            normal: DVec3::NEG_Z,
            radius,
            emission: Color::new(1e38, 0.0, 1e-38),
        };
        let scene = Scene::new(vec![quad(0.0, 9.0).with_materials([matte(0.5)])]).unwrap();
        let scene = scene.with_lights(vec![lamp.into()]);
        for name in ["direct", "path", "whitted", "lambert", "phong"] {
            let got = means(&scene, shader(name, &[]), &DOWN, 16)[0];
            assert!(got.is_finite(), "{name} {height} {radius}: {got}");
        }
    }
}

/// Through the front of a translucent sphere its back is seen: a + (1 - a) a of the light of an
/// opaque one.
#[test]
fn a_translucent_sphere_emits_with_its_back_too() {
    let opacity = 0.5;
    let material = Material {
        alpha: opacity,
        alpha_mode: firsthit::scene::AlphaMode::Blend,
        ..glowing(0.0, 1.0)
    };
    let sphere = Sphere::new(DVec3::new(0.3, 0.2, 3.0), 1.0).unwrap();
    let sphere = Object::new(sphere).with_materials([material]);
    let floor = quad(0.0, 9.0).with_materials([matte(1.0)]);
    let scene = Scene::new(vec![floor, sphere]).unwrap();
    let expected = (opacity + (1.0 - opacity) * opacity) / 9.0;
    for name in ["direct", "path"] {
        let depth = if name == "path" { &[("depth", 1.0)][..] } else { &[] };
        let got = means(&scene, shader(name, depth), &DOWN, 8192)[0].x;
        assert!((got / expected - 1.0).abs() < 0.02, "{name}: {got} {expected}");
    }
}

/// Under a large ceiling that emits, points of it are a poor sample: directions by the surface
/// count as well.
#[test]
fn direct_light_of_a_near_ceiling_has_little_noise() {
    let floor = quad(0.0, 1e3).with_materials([matte(1.0)]);
    let ceiling = quad(1.0, 1e2).with_materials([glowing(0.0, 1.0)]);
    let scene = Scene::new(vec![floor, ceiling]).unwrap();
    let shading = shader("direct", &[]).on(&scene);
    let (mean, error) = seen(&shading, &DOWN, 256)[0];
    assert!((mean.x - 1.0).abs() < 0.02 && error.x < 0.02, "{mean} {error}");
}

/// A lamp that lies in its ceiling, as far as numbers can say so: the ceiling does not hide it.
/// Level, tilted, and far from the origin.
#[test]
fn lights_in_a_surface_are_not_hidden_by_it() {
    let tilt = DMat3::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7);
    for (turn, far) in [(DMat3::IDENTITY, 0.0), (tilt, 0.0), (tilt, 1e3), (tilt, 5e5)] {
        let place = |p: DVec3| turn * p + DVec3::splat(far);
        let level = |height: f64, half: f64, color: f64| {
            let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
            let corners = corners.map(|[x, y]| place(DVec3::new(x, y, height)));
            let triangles = vec![[0, 1, 2], [0, 2, 3]];
            let mesh = Mesh::new(
                Positions::Double(corners.map(|p| p.to_array()).to_vec().into()),
                triangles,
            );
            Object::new(Arc::new(mesh.unwrap())).with_materials([matte(color)])
        };
        let center = place(DVec3::new(0.1, 0.0, 2.3));
        let rectangle = firsthit::scene::RectangleLight {
            center,
            edge_u: turn * DVec3::new(0.0, 2.0, 0.0),
            edge_v: turn * DVec3::new(2.0, 0.0, 0.0),
            emission: Color::ONE,
        };
        let point = firsthit::scene::PointLight { position: center, intensity: Color::ONE };
        let ray = [Ray::new(place(DVec3::new(0.0, 0.0, 1.0)), turn * DVec3::NEG_Z)];
        for light in [firsthit::Light::from(rectangle), point.into()] {
            for name in ["direct", "path", "whitted", "lambert"] {
                let lit = |ceiling: Option<Object>| {
                    let all = [Some(level(0.0, 9.0, 0.8)), ceiling];
                    let scene = Scene::new(all.into_iter().flatten().collect()).unwrap();
                    let scene = scene.with_lights(vec![light]);
                    let depth = if name == "path" { &[("depth", 1.0)][..] } else { &[] };
                    means(&scene, shader(name, depth), &ray, 256)[0].x
                };
                let (open, under) = (lit(None), lit(Some(level(2.3, 5.0, 0.0))));
                assert!(open > 0.05);
                assert!((under / open - 1.0).abs() < 1e-3, "{name} {far}: {under} {open}");
            }
        }
    }
}
