//! Nodes, cameras, lights, extensions.

use std::f64::consts::{FRAC_PI_2, PI};

use firsthit::scene::{DirectionalLight, PointLight, SpotLight};
use firsthit::shade::Lambert;
use firsthit::{
    AlphaMode, Background, Color, DVec3, Light, Projection, RayStart, Scene, Shade, Shader,
    Shading, shoot,
};
use serde_json::json;

use super::builder::{Builder, points, push};

#[test]
fn without_scenes_all_nodes_that_are_no_children_are_shown() {
    let mut builder = Builder::triangle();
    builder.json["nodes"] =
        json!([{"mesh": 0, "name": "child"}, {"children": [0]}, {"mesh": 0, "name": "b"}]);
    builder.json.as_object_mut().unwrap().remove("scenes");
    let names: Vec<_> =
        builder.load().unwrap().world.objects.iter().map(|o| o.name().to_owned()).collect();
    assert_eq!(names, ["child", "b"]);
    // The first scene is shown where none is named.
    builder.json["scenes"] = json!([{"nodes": [2]}, {"nodes": [1]}]);
    builder.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(builder.load().unwrap().world.objects[0].name(), "b");
    builder.json["scene"] = json!(1);
    assert_eq!(builder.load().unwrap().world.objects[0].name(), "child");
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_is_followed() {
    let mut builder = Builder::triangle();
    let count = 100_000;
    let mut nodes: Vec<_> = (1..count).map(|k| json!({"children": [k]})).collect();
    nodes.push(json!({"mesh": 0, "translation": [1, 2, 3]}));
    builder.json["nodes"] = json!(nodes);
    let model = builder.load().unwrap();
    assert_eq!(points(&model, 0)[0], DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn nodes_that_are_no_trees_are_refused() {
    for (nodes, place) in [
        (json!([{"children": [0]}]), "#/nodes/0/children/0: node 0"),
        (json!([{"children": [1]}, {"children": [0]}]), "#/nodes/1/children/0: node 0"),
        (json!([{"children": [1, 2]}, {"children": [2]}, {}]), "#/nodes/0/children/1: node 2"),
    ] {
        let mut builder = Builder::triangle();
        builder.json["nodes"] = nodes;
        assert!(builder.refusal().starts_with(place), "{}", builder.refusal());
    }
    let mut builder = Builder::triangle();
    builder.json["scenes"][0]["nodes"] = json!([0, 0]);
    assert!(builder.refusal().starts_with("#/scenes/0/nodes/1: node 0"));
}

#[test]
fn cameras_are_where_their_nodes_are() {
    let mut builder = Builder::triangle();
    builder.json["cameras"] = json!([
        {"name": "wide", "type": "perspective", "perspective": {"yfov": 1.0, "aspectRatio": 2.0, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 3.0, "ymag": 1.5, "znear": 0, "zfar": 9}},
    ]);
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    builder.json["nodes"] = json!([
        {"mesh": 0, "children": [1, 2]},
        {"camera": 1},
        // A quarter turn about y looks along -x; scale does not count.
        {"camera": 0, "name": "Front", "translation": [1, 2, 3], "rotation": [0, quarter, 0, quarter], "scale": [5, 5, 5]},
    ]);
    let cameras = builder.load().unwrap().world.cameras;
    let [wide, parallel] = &cameras[..] else { panic!("{cameras:?}") };
    assert_eq!((&*wide.name, &*wide.own_name), ("Front", "wide"));
    assert_eq!(wide.view.position, DVec3::new(1.0, 2.0, 3.0));
    assert!((wide.view.aim - DVec3::NEG_X).length() < 1e-15);
    assert!((wide.view.lens.viewplane().unwrap().height - 2.0 * 0.5_f64.tan()).abs() < 1e-15);
    assert_eq!(
        wide.view.lens.viewplane().unwrap().width,
        2.0 * wide.view.lens.viewplane().unwrap().height
    );
    assert_eq!(wide.view.lens.viewplane().unwrap().ray_start, RayStart::Eye);
    assert_eq!(parallel.view.lens.projection(), Projection::Orthographic);
    assert_eq!(
        (
            parallel.view.lens.viewplane().unwrap().width,
            parallel.view.lens.viewplane().unwrap().height
        ),
        (6.0, 3.0)
    );
    assert!(parallel.name.is_empty());
    // As pictures: its own shape, or another one with square pixels and the same height.
    let bounds = firsthit::Bounds::EMPTY;
    let support = |_: DVec3| f64::NEG_INFINITY;
    let own = wide.described(None).camera(bounds, support, DVec3::Y);
    let own = own.unwrap();
    assert_eq!((own.columns(), own.rows()), (1024, 512));
    for camera in &cameras {
        let square = camera.described(Some([300; 2])).camera(bounds, support, DVec3::Y).unwrap();
        let view = square.view();
        assert!(
            (view.lens.viewplane().unwrap().width - view.lens.viewplane().unwrap().height).abs()
                < 1e-12,
            "{view:?}"
        );
        assert!(
            (view.lens.viewplane().unwrap().height / camera.view.lens.viewplane().unwrap().height
                - 1.0)
                .abs()
                < 1e-12,
            "{view:?}"
        );
    }
}

#[test]
fn lights_are_where_their_nodes_are_and_a_white_surface_sends_back_one_part_in_pi() {
    let mut builder = Builder::triangle();
    builder.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1, 0.5, 0.25], "intensity": 8},
        {"type": "directional", "intensity": 2},
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
    ]}});
    let at = |light: usize| json!({"KHR_lights_punctual": {"light": light}});
    builder.json["nodes"] = json!([
        {"mesh": 0, "children": [1, 2, 3]},
        {"translation": [1, 2, 3], "extensions": at(0)},
        // Half a turn about x looks along z.
        {"rotation": [1, 0, 0, 0], "extensions": at(1)},
        {"translation": [0, 0, 9], "extensions": at(2)},
    ]);
    let model = builder.load().unwrap();
    let white = Color::ONE / PI;
    assert_eq!(
        model.world.lights[0],
        Light::from(PointLight {
            position: DVec3::new(1.0, 2.0, 3.0),
            intensity: Color::new(1.0, 0.5, 0.25) * (8.0 / PI),
        })
    );
    assert_eq!(
        model.world.lights[1],
        Light::from(DirectionalLight {
            direction: DVec3::Z,
            color: Color::ONE * (2.0 / PI),
            angle_degrees: 0.0,
        })
    );
    assert_eq!(
        model.world.lights[2],
        Light::from(SpotLight {
            position: DVec3::new(0.0, 0.0, 9.0),
            direction: DVec3::NEG_Z,
            intensity: white,
            inner_angle: 0.1,
            outer_angle: 0.5,
        })
    );
}

#[test]
fn a_light_that_would_take_light_away_is_left_out_with_a_warning() {
    for light in [
        json!({"type": "point", "intensity": -3}),
        json!({"type": "directional", "color": [1, -0.5, 1]}),
    ] {
        let mut builder = Builder::triangle();
        builder.json["extensions"] =
            json!({"KHR_lights_punctual": {"lights": [light, {"type": "point"}]}});
        let at = |light: usize| json!({"KHR_lights_punctual": {"light": light}});
        builder.json["nodes"] = json!([
            {"mesh": 0, "children": [1, 2]}, {"extensions": at(0)}, {"extensions": at(1)},
        ]);
        let model = builder.load().unwrap();
        assert_eq!(model.world.lights.len(), 1);
        let [warning] = &model.warnings[..] else {
            panic!("{:?}", model.warnings);
        };
        assert!(
            warning.contains("/extensions/KHR_lights_punctual/lights/0/")
                && warning.contains("must not be negative, got -")
                && warning.ends_with("the light is left out"),
            "{warning}"
        );
    }
}

/// Pi / 2 as a float32 is above pi / 2, which is the most that a light may have.
#[test]
fn a_cone_of_a_quarter_turn_in_float32_is_one_of_a_quarter_turn() {
    let quarter = f64::from(std::f32::consts::FRAC_PI_2);
    assert!(quarter > FRAC_PI_2);
    let mut builder = Builder::triangle();
    builder.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "spot": {"outerConeAngle": quarter}},
    ]}});
    let at = json!({"KHR_lights_punctual": {"light": 0}});
    builder.json["nodes"] = json!([{"mesh": 0, "children": [1]}, {"extensions": at}]);
    let light = builder.load().unwrap().world.lights[0];
    let Light::Spot(spot) = light else {
        panic!("{light:?}");
    };
    assert_eq!(spot.outer_angle, FRAC_PI_2);
    assert!(light.check().is_ok());
}

#[test]
fn a_spot_is_full_within_its_inner_angle_and_nothing_beyond_its_outer_one() {
    let (inner, outer) = (0.2_f64, 0.6_f64);
    let light = Light::from(SpotLight {
        position: DVec3::new(0.0, 0.0, 2.0),
        direction: DVec3::new(0.0, 0.0, -3.0),
        intensity: Color::splat(5.0),
        inner_angle: inner,
        outer_angle: outer,
    });
    let ground = firsthit::Object::new(firsthit::Plane::new(DVec3::ZERO, DVec3::Z).unwrap());
    let scene = Scene::new(vec![ground.colored(Color::ONE)]).unwrap().with_lights(vec![light]);
    let lambert = Lambert { ambient: Color::ZERO, shadows: true, ..Lambert::default() };
    let shade =
        Shading { background: Background::default(), ..Shader::Lambert(lambert).on(&scene) };
    let seen = |angle: f64| {
        let (eye, down) = (DVec3::new(2.0 * angle.tan(), 0.0, 1.0), DVec3::NEG_Z);
        let hit = shoot(&scene, eye, down);
        shade.shade(hit.t, eye, down, &hit).x
    };
    // By the square of the distance, 2 / cos, and the cosine of the angle.
    let full = |angle: f64| 5.0 * angle.cos().powi(3) / 4.0;
    for angle in [0.0, 0.1, 0.19] {
        assert!((seen(angle) - full(angle)).abs() < 1e-12, "{angle}");
    }
    let half = (f64::midpoint(inner.cos(), outer.cos())).acos();
    assert!((seen(half) - 0.25 * full(half)).abs() < 1e-12);
    assert_eq!(seen(0.61), 0.0);
}

#[test]
fn extensions_that_are_not_read_are_a_warning_or_an_error_by_name() {
    let mut builder = Builder::triangle();
    builder.json["extensionsUsed"] = json!(["KHR_lights_punctual", "ACME_wobble", "ACME_flow"]);
    let warnings = builder.load().unwrap().warnings;
    assert_eq!(
        warnings,
        ["a.gltf#/extensionsUsed: extensions that are not read: ACME_flow, ACME_wobble"]
    );
    builder.json["extensionsRequired"] = json!(["KHR_mesh_quantization", "ACME_wobble"]);
    let refused = builder.refusal();
    assert_eq!(
        refused,
        "#/extensionsRequired/1: the extension 'ACME_wobble' is required, and not read"
    );
}

#[test]
fn animations_are_a_warning_and_blend_is_read() {
    let mut builder = Builder::triangle();
    builder.json["materials"] = json!([{"alphaMode": "BLEND"}]);
    builder.json["animations"] = json!([{"channels": [], "samplers": []}]);
    builder.primitive()["material"] = json!(0);
    let model = builder.load().unwrap();
    assert_eq!(model.world.objects[0].materials()[0].alpha_mode, AlphaMode::Blend);
    let [warning] = &model.warnings[..] else {
        panic!("{:?}", model.warnings);
    };
    assert!(warning.contains("#/animations: 1 "), "{warning}");
}

#[test]
fn ninety_thousand_nodes_of_one_mesh_take_moments() {
    let mut builder = Builder::triangle();
    for k in 1..90_000 {
        push(&mut builder.json["nodes"], json!({"mesh": 0, "name": format!("n{k}")}));
        push(&mut builder.json["scenes"][0]["nodes"], json!(k));
    }
    let start = std::time::Instant::now();
    assert_eq!(builder.load().unwrap().world.objects.len(), 90_000);
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}
