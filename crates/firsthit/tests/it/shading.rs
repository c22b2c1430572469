//! Shaders against closed forms, and the same bytes for any threads and parts.

use std::sync::Arc;

use firsthit::channel::kind;
use firsthit::geometry::{SettingsSchema, Value};
use firsthit::image::Frame;
use firsthit::render::{Picture, Region};
use firsthit::scene::{DirectionalLight, PointLight};
use firsthit::shade::{Hemisphere, Lambert, Matcap, Phong};
use firsthit::shape::Attribute;
use firsthit::{
    Background, Color, DAffine3, DVec3, Light, Mesh, Object, Positions, Scene, Shade, Shader,
    Shading, Sphere, Transform, example, shoot,
};

use crate::support::on_threads;

const RED: Color = Color::new(0.8, 0.1, 0.05);
const BEHIND: Color = Color::new(0.1, 0.2, 0.3);

fn seen(scene: &Scene, shader: &Shader, p: DVec3, u_r: DVec3) -> Color {
    let shade = Shading { background: Background::Uniform(BEHIND), ..shader.clone().on(scene) };
    let hit = shoot(scene, p, u_r);
    shade.shade(hit.t, p, u_r, &hit)
}

/// A few roundings of numbers up to 4.
fn assert_close(a: Color, b: Color) {
    // Written so that a NaN fails.
    let is_close = (a - b).abs().cmplt(DVec3::splat(1e-14)).all();
    assert!(is_close, "{a} is not {b}");
}

fn sun(towards: DVec3) -> Light {
    Light::from(DirectionalLight {
        direction: -towards,
        color: Color::new(0.9, 0.8, 0.7),
        angle_degrees: 0.0,
    })
}

/// A red ball of radius 1 in parallel light.
fn ball(light: Light) -> Scene {
    let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap()).colored(RED);
    Scene::new(vec![ball]).unwrap().with_lights(vec![light])
}

fn glossy(shininess: f64) -> Phong {
    Phong {
        ambient: Color::splat(0.1),
        diffuse: 0.5,
        specular: Color::new(0.3, 0.4, 0.5),
        shininess,
        ..Phong::default()
    }
}

/// Where the normal is (0.6, 0, 0.8), light from straight above is mirrored to 2 * 0.8 (0.6, 0,
/// 0.8) - (0, 0, 1) = (0.96, 0, 0.28), and so seen from above with a cosine of 0.28; half way
/// between light and viewer is straight up, 0.8 from the normal.
#[test]
fn highlights_on_a_ball_are_those_computed_by_hand() {
    let scene = ball(sun(DVec3::Z));
    let eye = DVec3::new(0.6, 0.0, 5.0);
    let light = Color::new(0.9, 0.8, 0.7);
    let settings = glossy(3.0);
    let matte = RED * 0.1 + 0.5 * 0.8 * RED * light;
    let highlight = |power: f64| power * settings.specular * light;
    let phong = seen(&scene, &Shader::Phong(settings), eye, DVec3::NEG_Z);
    assert_close(phong, matte + highlight(0.021_952));
    let blinn = seen(&scene, &Shader::BlinnPhong(settings), eye, DVec3::NEG_Z);
    assert_close(blinn, matte + highlight(0.512));
    // At the pole, lit from (0.6, 0, 0.8): mirrored to (-0.6, 0, 0.8); half way is (0.6, 0, 1.8) /
    // sqrt(3.6).
    let scene = ball(sun(DVec3::new(0.6, 0.0, 0.8)));
    let [phong, blinn] = [Shader::Phong, Shader::BlinnPhong]
        .map(|kind| seen(&scene, &kind(glossy(2.0)), DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z));
    assert_close(phong, matte + highlight(0.64));
    assert_close(blinn, matte + highlight(0.9));
}

#[test]
fn without_a_highlight_phong_and_blinn_are_lambert() {
    let scene = ball(sun(DVec3::new(0.3, -0.2, 0.9)));
    let matte = Phong { specular: Color::ZERO, ..Phong::default() };
    for k in 0..50 {
        let p = DVec3::new(0.9 - 0.03 * f64::from(k), 0.2, 5.0);
        let lambert = seen(&scene, &Shader::default(), p, DVec3::NEG_Z);
        for shader in [Shader::Phong(matte), Shader::BlinnPhong(matte)] {
            assert_close(seen(&scene, &shader, p, DVec3::NEG_Z), lambert);
        }
    }
}

#[test]
fn a_highlight_is_in_the_shadow_of_what_is_in_the_way() {
    let light =
        Light::from(PointLight { position: DVec3::new(0.0, 0.0, 3.0), ..PointLight::default() });
    let between = Object::new(Sphere::new(DVec3::new(0.0, 0.0, 2.0), 0.1).unwrap());
    let objects = [ball(light).objects(), &[between]].concat();
    let scene = Scene::new(objects).unwrap().with_lights(vec![light]);
    let (p, u_r) = (DVec3::new(3.0, 0.0, 1.0), DVec3::new(-3.0, 0.0, -0.001));
    let shadow = seen(&scene, &Shader::Phong(glossy(2.0)), p, u_r);
    assert_close(shadow, RED * 0.1);
    let bare = Phong { shadows: false, ..glossy(2.0) };
    assert!(seen(&scene, &Shader::Phong(bare), p, u_r).x > 0.17);
}

/// (1 + n . up) / 2 of the sky, and the rest of the ground.
#[test]
fn a_hemisphere_counts_by_how_much_a_normal_looks_up() {
    let up = DVec3::new(0.6, 0.0, 0.8);
    let scene = ball(sun(DVec3::Z)).with_up(up);
    let settings = Hemisphere {
        above: Color::new(0.5, 0.75, 1.0),
        below: Color::new(0.25, 0.125, 0.0),
        ..Hemisphere::default()
    };
    for (from, height) in [(DVec3::Z, 0.8), (DVec3::NEG_Z, -0.8), (DVec3::Y, 0.0), (up, 1.0)] {
        let share = f64::midpoint(1.0, height);
        let expected = RED * (settings.below + share * (settings.above - settings.below));
        let color = seen(&scene, &Shader::Hemisphere(settings), 4.0 * from, -from);
        assert_close(color, expected);
    }
}

#[test]
fn depth_cueing_is_linear_between_two_distances_for_every_shader_that_has_it() {
    let scene = ball(sun(DVec3::Z));
    let goal = Color::new(0.25, 0.5, 1.0);
    let mut count = 0;
    for &SettingsSchema { name, settings: list, .. } in Shader::KINDS {
        if !list.iter().any(|setting| setting.name == "depth_far") {
            continue;
        }
        let mut plain = Shader::named(name).unwrap();
        if name == "ghost" {
            plain.set("opacity", Value::Number(1.0)).unwrap();
        }
        let mut cued = plain.clone();
        cued.set("depth_near", Value::Number(2.0)).unwrap();
        cued.set("depth_far", Value::Number(6.0)).unwrap();
        cued.set("depth_color", Value::Vector(goal)).unwrap();
        for (distance, share) in
            [(1.0, 0.0), (2.0, 0.0), (3.0, 0.25), (5.0, 0.75), (6.0, 1.0), (9.0, 1.0)]
        {
            let p = DVec3::new(0.0, 0.0, 1.0 + distance);
            // The length of the direction is of no account.
            let color = |shader| seen(&scene, shader, p, DVec3::new(0.0, 0.0, -0.5));
            let (plain, cued) = (color(&plain), color(&cued));
            assert_close(cued, plain.lerp(goal, share));
        }
        count += 1;
    }
    assert!(count > 4, "{count}");
}

/// A triangle on the ground with normals.
fn with_normals(normals: [[f32; 3]; 3]) -> Object {
    let corners = vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]];
    let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2]]).unwrap();
    let normals = Attribute::per_vertex(normals.to_vec());
    let mesh = mesh.with_normals(normals).unwrap();
    Object::new(Arc::new(mesh)).colored(RED)
}

/// A scene of one triangle whose normals all lean by 0.6 to +x.
fn leaning() -> Scene {
    Scene::new(vec![with_normals([[0.6, 0.0, 0.8]; 3])]).unwrap()
}

/// In the middle of the longest edge the mean of (0.6, 0, 0.8) and (-0.6, 0, 0.8) has length 0.8
/// and is the face's normal.
#[test]
fn smooth_normals_have_length_one_with_a_transform_and_without() {
    let apart = [[0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], [0.0, 0.0, 1.0]];
    let by_two = apart.map(|normal| normal.map(|x: f32| 2.0 * x));
    let lights = vec![sun(DVec3::Z)];
    let (p, u_r) = (DVec3::new(0.0, -9.0, 1.0), DVec3::NEG_Z);
    for name in Shader::NAMES {
        let shader = Shader::named(name).unwrap();
        let flat = Scene::new(vec![with_normals([[0.0, 0.0, 1.0]; 3])]).unwrap();
        let flat = flat.with_lights(lights.clone());
        let expected = seen(&flat, &shader, p, u_r);
        for normals in [apart, by_two] {
            // So that the edge is not beside the ray.
            let tiny = DAffine3::from_translation(DVec3::new(1e-14, -1e-14, 1e-14));
            let still = with_normals(normals);
            let moved = still.clone().placed(Transform::new(tiny).unwrap());
            for object in [still, moved] {
                let scene = Scene::new(vec![object]).unwrap();
                let color = seen(&scene.with_lights(lights.clone()), &shader, p, u_r);
                assert!((color - expected).length() < 1e-7, "{name}: {color} {expected}");
            }
        }
    }
}

#[test]
fn faces_are_shaded_with_smooth_normals_or_flat() {
    let scene = leaning().with_lights(vec![sun(DVec3::Z)]);
    let light = Color::new(0.9, 0.8, 0.7);
    for (flat, cosine) in [(false, 0.8), (true, 1.0)] {
        let shader = Shader::Lambert(Lambert { flat, ambient: Color::ZERO, ..Lambert::default() });
        // Float32 normals.
        let color = seen(&scene, &shader, DVec3::Z, DVec3::NEG_Z);
        assert!((color - cosine * RED * light).length() < 1e-7, "{color}");
        let shader = Shader::Hemisphere(Hemisphere {
            flat,
            above: Color::ONE,
            below: Color::ZERO,
            ..Hemisphere::default()
        });
        let color = seen(&scene, &shader, DVec3::Z, DVec3::NEG_Z);
        assert!((color - (0.5 + cosine / 2.0) * RED).length() < 1e-7, "{color}");
    }
}

/// Light from the side that the smooth normal leans to would end with a jump where the face turns
/// away.
#[test]
fn light_on_smooth_normals_fades_before_the_face_turns_away() {
    let lit = |height: f64, flat: bool| {
        let scene = leaning().with_lights(vec![sun(DVec3::new(1.0, 0.0, height))]);
        let shader = Shader::Lambert(Lambert { flat, ambient: Color::ZERO, ..Lambert::default() });
        seen(&scene, &shader, DVec3::Z, DVec3::NEG_Z).x
    };
    assert_eq!(lit(-1e-3, false), 0.0);
    assert!(lit(1e-3, false) < 0.01 && lit(0.05, false) < 0.2);
    // High light counts in full: (0.6 + 4 * 0.8) / sqrt(17).
    assert!((lit(4.0, false) - 0.72 * 3.8 / 17.0_f64.sqrt()).abs() < 1e-7);
    assert!((lit(1e-3, true) - 0.72e-3).abs() < 1e-8);
}

/// Each ray has its own frame, which goes with the direction upwards.
#[test]
fn a_matcap_looks_the_same_wherever_it_is_and_turns_with_the_viewer() {
    let scene = ball(sun(DVec3::Z));
    let shade = Shading { upwards: DVec3::Y, ..Shader::Matcap(Matcap::default()).on(&scene) };
    let color = |p: DVec3, u_r: DVec3, upwards| {
        let hit = shoot(&scene, p, u_r);
        let shade = Shading { upwards, ..shade.clone() };
        shade.shade(hit.t, p, u_r, &hit)
    };
    let facing = color(4.0 * DVec3::Z, DVec3::NEG_Z, DVec3::Y);
    let aside = DVec3::new(1.0, 2.0, 2.0);
    assert_close(facing, color(3.0 * aside, -aside, DVec3::Y));
    // To the right of who looks along -z with +y upwards is +x; upwards it is where +x is upwards.
    let p = DVec3::new(0.6, 0.0, 4.0);
    let right = color(p, DVec3::NEG_Z, DVec3::Y);
    let up = color(p, DVec3::NEG_Z, DVec3::X);
    assert_close(right, color(DVec3::new(0.0, -0.6, 4.0), DVec3::NEG_Z, DVec3::X));
    assert!(up.length() > 1.5 * right.length(), "{up} {right}");
}

/// Every shader, over meshes, instances, planes and a sky.
#[test]
fn every_shader_gives_the_same_bytes_for_any_threads_and_parts() {
    let scene = example::scene().unwrap();
    let camera = example::camera(30, 40).unwrap();
    let kinds = [kind("color").unwrap()];
    for name in Shader::NAMES {
        let shade = Shader::named(name).unwrap().on(&scene);
        let picture = Picture { samples: 3, ..Picture::new(&scene, &camera, &shade, &kinds) };
        let with = |threads: usize| on_threads(threads, || picture.render(&())).unwrap();
        let one = with(1);
        for threads in [2, 7] {
            assert!(bits(&one) == bits(&with(threads)), "{name}: {threads}");
        }
        let part =
            Picture { region: Some(Region { rows: 5..29, columns: 0..40 }), ..picture.clone() };
        let part = part.render(&()).unwrap();
        assert!(bits(&part) == bits(&one)[5 * 40 * 3..29 * 40 * 3], "{name}");
    }
}

fn bits(frame: &Frame) -> Vec<u64> {
    let data = &frame.channel("color").unwrap().data;
    (0..data.len()).map(|k| data.value(k).to_bits()).collect()
}
