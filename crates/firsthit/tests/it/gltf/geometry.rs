//! Triangles and where they are.

use std::sync::Arc;

use firsthit::{DVec3, shoot};
use serde_json::json;

use super::builder::{Builder, FLOAT, bytes_of, points, push};

fn triangles(builder: &Builder) -> Vec<[u32; 3]> {
    let model = builder.load().unwrap();
    model.world.objects[0].mesh().unwrap().triangles().to_vec()
}

/// Five vertices of a strip.
fn five() -> Builder {
    let mut builder = Builder::new();
    let zigzag = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0];
    builder.attribute("POSITION", &zigzag, "VEC3");
    builder
}

#[test]
fn strips_turn_every_other_triangle_and_fans_share_their_first_corner() {
    let mut builder = five();
    builder.primitive()["mode"] = json!(5);
    assert_eq!(triangles(&builder), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    builder.primitive()["mode"] = json!(6);
    assert_eq!(triangles(&builder), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    builder.primitive()["mode"] = json!(4);
    assert_eq!(triangles(&builder), [[0, 1, 2]]);
    let warnings = builder.load().unwrap().warnings;
    assert!(warnings[0].contains("2 indices after the last triangle"), "{warnings:?}");
}

#[test]
fn points_and_lines_are_one_warning_each_kind_that_names_them() {
    for (mode, name) in [(0, "points"), (1, "lines"), (2, "line loops"), (3, "line strips")] {
        let mut builder = five();
        builder.primitive()["mode"] = json!(mode);
        let model = builder.load().unwrap();
        assert!(model.world.objects.is_empty());
        assert!(model.warnings[0].contains(&format!("primitives of {name} (mode {mode})")));
    }
}

#[test]
fn indices_are_the_same_in_every_type() {
    let shorts: Vec<u8> = [3_u16, 1, 0].iter().flat_map(|k| k.to_le_bytes()).collect();
    let words: Vec<u8> = [3_u32, 1, 0].iter().flat_map(|k| k.to_le_bytes()).collect();
    for (bytes, component) in [(&[3, 1, 0][..], 5121), (&shorts, 5123), (&words, 5125)] {
        let mut builder = five();
        let indices = builder.accessor(bytes, component, 3, "SCALAR");
        builder.primitive()["indices"] = json!(indices);
        assert_eq!(triangles(&builder), [[3, 1, 0]]);
    }
}

#[test]
fn normalised_numbers_are_shares_of_their_types_largest() {
    let signed: Vec<u8> = [32767_i16, -32767, -32768, 0, 16384, 1, 0, 0, 0]
        .iter()
        .flat_map(|k| k.to_le_bytes())
        .collect();
    for (bytes, component, expected) in [
        (signed.clone(), 5122, [[1.0, -1.0, -1.0], [0.0, 16384.0 / 32767.0, 1.0 / 32767.0]]),
        (
            vec![255, 0, 51, 102, 1, 2, 0, 0, 0],
            5121,
            [[1.0, 0.0, 0.2], [0.4, 1.0 / 255.0, 2.0 / 255.0]],
        ),
        (
            vec![127, 129, 128, 0, 1, 2, 0, 0, 0],
            5120,
            [[1.0, -1.0, -1.0], [0.0, 1.0 / 127.0, 2.0 / 127.0]],
        ),
    ] {
        let mut builder = Builder::new();
        let accessor = builder.accessor(&bytes, component, 3, "VEC3");
        builder.json["accessors"][accessor]["normalized"] = json!(true);
        builder.primitive()["attributes"]["POSITION"] = json!(accessor);
        assert_eq!(points(&builder.load().unwrap(), 0)[..2], expected.map(DVec3::from));
        // As they are, they are whole numbers.
        builder.json["accessors"][accessor]["normalized"] = json!(false);
        let whole = points(&builder.load().unwrap(), 0)[0];
        assert_eq!(whole, whole.round());
    }
}

#[test]
fn sparse_values_replace_those_that_are_there_or_zeros() {
    let mut builder = Builder::triangle();
    let indices = builder.view(&[0, 2]);
    let values = builder.view(&bytes_of(&[7.0, 8.0, 9.0, -1.0, -2.0, -3.0]));
    let sparse = json!({
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values},
    });
    builder.json["accessors"][0]["sparse"] = sparse;
    let replaced = [[7.0, 8.0, 9.0], [1.0, 0.0, 0.0], [-1.0, -2.0, -3.0]].map(DVec3::from);
    assert_eq!(points(&builder.load().unwrap(), 0), replaced);
    builder.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let replaced = [[7.0, 8.0, 9.0], [0.0; 3], [-1.0, -2.0, -3.0]].map(DVec3::from);
    assert_eq!(points(&builder.load().unwrap(), 0), replaced);
}

#[test]
fn interleaved_views_are_read_step_by_step() {
    let mut builder = Builder::new();
    let rows = [[0.0, 0.0, 0.0, 9.0], [1.0, 0.0, 0.0, 9.0], [0.0, 1.0, 0.5, 9.0]];
    let position = builder.accessor(&bytes_of(rows.as_flattened()), FLOAT, 3, "VEC3");
    builder.json["bufferViews"][0]["byteStride"] = json!(16);
    // The last step ends with the element, not with the stride.
    builder.json["bufferViews"][0]["byteLength"] = json!(44);
    builder.primitive()["attributes"]["POSITION"] = json!(position);
    assert_eq!(points(&builder.load().unwrap(), 0)[2], DVec3::new(0.0, 1.0, 0.5));
}

#[test]
fn morph_targets_are_added_by_the_meshs_weights_or_the_nodes() {
    let mut builder = Builder::triangle();
    let up = builder.floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0], "VEC3");
    let out = builder.floats(&[8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], "VEC3");
    builder.primitive()["targets"] = json!([{"POSITION": up}, {"POSITION": out}]);
    let corner = |builder: &Builder, k: usize| points(&builder.load().unwrap(), 0)[k];
    assert_eq!(corner(&builder, 2), DVec3::new(0.0, 1.0, 0.0));
    builder.json["meshes"][0]["weights"] = json!([0.5, 0.25]);
    assert_eq!(corner(&builder, 0), DVec3::new(2.0, 0.0, 0.5));
    assert_eq!(corner(&builder, 2), DVec3::new(0.0, 1.0, 2.0));
    builder.json["nodes"][0]["weights"] = json!([-1.0]);
    assert_eq!(corner(&builder, 0), DVec3::new(0.0, 0.0, -1.0));
}

/// The first joint stays; the second is two up, where it was bound one up: it lifts by one.
#[test]
fn skins_are_at_rest_and_their_nodes_do_not_count() {
    let mut builder = Builder::triangle();
    let mut bind = [0.0; 32];
    for k in [0, 5, 10, 15, 16, 21, 26, 31] {
        bind[k] = 1.0;
    }
    bind[16 + 13] = -1.0;
    let bind = builder.floats(&bind, "MAT4");
    let joints = builder.accessor(&[0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0], 5121, 3, "VEC4");
    builder.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    let weights = [0.5, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    builder.attribute("WEIGHTS_0", &weights, "VEC4");
    builder.attribute("NORMAL", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0], "VEC3");
    builder.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0], "children": [1]},
        {"translation": [-100, 0, 0], "children": [2]},
        {"translation": [0, 2, 0]},
    ]);
    builder.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": bind}]);
    let model = builder.load().unwrap();
    let expected = [[0.0, 0.5, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(DVec3::from);
    assert_eq!(points(&model, 0), expected);
    assert_eq!(model.warnings, [""; 0]);
    // A joint that is no joint of the skin.
    builder.json["skins"][0]["joints"] = json!([1]);
    let refused = builder.refusal();
    assert!(
        refused.starts_with("#/meshes/0/primitives/0/attributes/JOINTS_0: joint 1"),
        "{refused}"
    );
}

#[test]
fn nodes_that_name_one_mesh_share_it() {
    let mut builder = Builder::triangle();
    builder.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 5]}]);
    builder.json["scenes"][0]["nodes"] = json!([1, 0]);
    let model = builder.load().unwrap();
    let [first, second] = &model.world.objects[..] else { panic!("two objects") };
    assert!(Arc::ptr_eq(first.mesh().unwrap(), second.mesh().unwrap()));
    // In the order of the scene.
    assert_eq!(points(&model, 0)[0].z, 5.0);
    assert_eq!((first.name(), second.name()), ("node 1", "node 0"));
    assert_eq!(model.vertices, Some(6));
}

#[test]
fn primitives_that_name_one_accessor_share_its_vertices() {
    let mut builder = five();
    let again = builder.primitive().clone();
    push(&mut builder.json["meshes"][0]["primitives"], again);
    let model = builder.load().unwrap();
    let [first, second] = [0, 1].map(|k: usize| model.world.objects[k].mesh().unwrap().positions());
    assert!(Arc::ptr_eq(first, second));
}

#[test]
fn instances_share_their_mesh_and_stand_where_they_are_put() {
    let mut builder = Builder::triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let to = builder.floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 2.0], "VEC3");
    let turned = builder.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half], "VEC4");
    let scaled = builder.floats(&[1.0, 1.0, 1.0, 3.0, 1.0, 1.0], "VEC3");
    builder.json["nodes"][0]["translation"] = json!([10, 0, 0]);
    builder.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing":
        {"attributes": {"TRANSLATION": to, "ROTATION": turned, "SCALE": scaled}}});
    let model = builder.load().unwrap();
    assert_eq!(model.world.objects.len(), 2);
    assert!(Arc::ptr_eq(
        model.world.objects[0].mesh().unwrap(),
        model.world.objects[1].mesh().unwrap()
    ));
    assert_eq!(points(&model, 0)[1], DVec3::new(11.0, 0.0, 1.0));
    // Three along x, turned to y.
    assert!((points(&model, 1)[1] - DVec3::new(10.0, 3.0, 2.0)).length() < 1e-6);
    // One rotation too few.
    builder.json["accessors"][turned]["count"] = json!(1);
    let refused = builder.refusal();
    assert!(
        refused.starts_with("#/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/"),
        "{refused}"
    );
}

#[test]
fn a_mirrored_node_keeps_its_outside() {
    let mut builder = Builder::triangle();
    builder.json["nodes"][0]["scale"] = json!([-1, 1, 1]);
    let scene = firsthit::Scene::new(builder.load().unwrap().world.objects).unwrap();
    let (eye, down) = (DVec3::new(-0.2, 0.2, 3.0), DVec3::NEG_Z);
    let hit = shoot(&scene, eye, down);
    assert_eq!(hit.t, 3.0);
    let ray = firsthit::Ray::new(eye, down);
    assert_eq!(scene.interaction(&ray, &hit).unwrap().normal(), DVec3::Z);
}

#[test]
fn a_flattened_node_is_flat_with_a_warning() {
    let mut builder = Builder::new();
    builder.attribute("POSITION", &[0.0, 0.0, 1.0, 2.0, 0.0, 5.0, 0.0, 2.0, 9.0], "VEC3");
    builder.json["nodes"][0]["scale"] = json!([1, 1, 0]);
    builder.json["nodes"][0]["translation"] = json!([0, 0, 4]);
    let model = builder.load().unwrap();
    assert!(model.warnings[0].starts_with("a.gltf#/nodes/0: "), "{:?}", model.warnings);
    let scene = firsthit::Scene::new(model.world.objects).unwrap();
    assert_eq!(shoot(&scene, DVec3::new(0.5, 0.5, 10.0), DVec3::NEG_Z).t, 6.0);
}

#[test]
fn matrices_come_column_by_column() {
    let mut builder = Builder::triangle();
    builder.json["nodes"][0]["matrix"] = json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]);
    let model = builder.load().unwrap();
    assert_eq!(points(&model, 0)[1], DVec3::new(5.0, 8.0, 7.0));
    assert_eq!(points(&model, 0)[2], DVec3::new(3.0, 6.0, 7.0));
}

#[test]
fn corners_that_are_not_finite_cost_their_triangles() {
    let mut builder = five();
    builder.buffer[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    builder.primitive()["mode"] = json!(6);
    let model = builder.load().unwrap();
    assert_eq!(model.world.objects[0].mesh().unwrap().triangles(), [[0, 2, 3], [0, 3, 4]]);
    assert!(model.warnings[0].contains("1 triangle has a corner"), "{:?}", model.warnings);
}

#[test]
fn values_beside_positions_that_are_not_finite_are_one_warning_each() {
    let mut builder = Builder::triangle();
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    builder.attribute("TEXCOORD_0", &[0.0, 0.0, nan, 1.0, 0.5, inf], "VEC2");
    builder.attribute("NORMAL", &[0., 0., 1., 0., nan, 1., 0., 0., 1.], "VEC3");
    builder.attribute("COLOR_0", &[nan, -1., 0.5, 1., inf, 1., 1., 1., 1.], "VEC3");
    let model = builder.load().unwrap();
    let mesh = model.world.objects[0].mesh().unwrap();
    assert_eq!(mesh.uvs().unwrap().values[..], [[0.0; 2]; 3]);
    assert_eq!(mesh.normals().unwrap().values[1], [0.0; 3]);
    let colors = &mesh.colors().unwrap().values;
    assert_eq!(colors[..2], [[1.0, 0.0, 0.5], [1.0; 3]]);
    assert_eq!(model.warnings.len(), 3, "{:?}", model.warnings);
    for (name, words) in [
        ("TEXCOORD_0", ": 2, the first at index 1"),
        ("NORMAL", ": 1, the first at index 1"),
        ("COLOR_0", ": 2, the first at index 0"),
    ] {
        let told = |line: &String| line.contains(name) && line.contains(words);
        assert!(model.warnings.iter().any(told), "{:?}", model.warnings);
    }
}

#[test]
fn vertices_without_a_weight_stay_where_the_node_is() {
    let mut builder = Builder::triangle();
    let joints = builder.accessor(&[0; 12], 5121, 3, "VEC4");
    builder.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    let mut weights = [0.0; 12];
    weights[0] = 1.0;
    builder.attribute("WEIGHTS_0", &weights, "VEC4");
    builder.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [0, 0, 7], "children": [1]},
        {"translation": [0, 0, 2]},
    ]);
    builder.json["skins"] = json!([{"joints": [1]}]);
    let model = builder.load().unwrap();
    let expected = [[0.0, 0.0, 9.0], [1.0, 0.0, 7.0], [0.0, 1.0, 7.0]].map(DVec3::from);
    assert_eq!(points(&model, 0), expected);
    assert!(
        model.warnings[0].contains("WEIGHTS_0: vertices without a weight: 2, the first at index 1"),
        "{:?}",
        model.warnings
    );
}

#[test]
fn a_matrix_beside_its_parts_is_a_warning() {
    let mut builder = Builder::triangle();
    builder.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]);
    builder.json["nodes"][0]["translation"] = json!([0, 9, 0]);
    let warnings = builder.load().unwrap().warnings;
    assert!(
        warnings[0].starts_with("a.gltf#/nodes/0: has a matrix and a translation"),
        "{warnings:?}"
    );
}

/// A quarter turn about z as bytes has the length 1.0022.
#[test]
fn instances_turned_by_normalised_bytes_keep_their_size() {
    let mut builder = Builder::triangle();
    let turn = builder.accessor(&[0, 0, 90, 90], 5120, 1, "VEC4");
    builder.json["accessors"][turn]["normalized"] = json!(true);
    builder.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"ROTATION": turn}}});
    let model = builder.load().unwrap();
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    let turned = points(&model, 0);
    assert!(turned[1].abs_diff_eq(DVec3::Y, 1e-15), "{turned:?}");
    assert!(turned[2].abs_diff_eq(DVec3::NEG_X, 1e-15), "{turned:?}");
}

#[test]
fn a_rotation_of_few_digits_does_not_change_the_size() {
    for (turn, warned) in [
        (json!([0, 0, 0.71, 0.71]), false),
        (json!([0, 0, 3, 3]), true),
        (json!([0, 0, 1e200, 1e200]), true),
    ] {
        let mut builder = Builder::triangle();
        builder.json["nodes"][0]["rotation"] = turn;
        let model = builder.load().unwrap();
        assert_eq!(model.warnings.len(), usize::from(warned), "{:?}", model.warnings);
        assert!(points(&model, 0)[1].abs_diff_eq(DVec3::Y, 1e-15));
    }
    let mut builder = Builder::triangle();
    builder.json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
    let model = builder.load().unwrap();
    assert!(model.warnings[0].contains("no rotation"), "{:?}", model.warnings);
    assert_eq!(points(&model, 0)[1], DVec3::X);
}

/// Each specification of the extension shifts by another vector.
#[test]
fn a_centre_that_is_not_added_is_told_whether_it_is_declared_or_not() {
    for declared in [json!([]), json!(["CESIUM_RTC"])] {
        for list in ["extensionsUsed", "extensionsRequired"] {
            let mut builder = Builder::triangle();
            builder.json["extensions"] = json!({"CESIUM_RTC": {"center": [1.0, 2.0, 3.0]}});
            builder.json[list] = declared.clone();
            let model = builder.load().unwrap();
            let [warning] = model.warnings.as_slice() else {
                panic!("{:?}", model.warnings);
            };
            assert!(
                warning.contains("CESIUM_RTC/center: everything is relative to [1.0, 2.0, 3.0]"),
                "{warning}"
            );
        }
    }
}

#[test]
fn attributes_of_instances_that_are_not_read_are_told() {
    let mut builder = Builder::triangle();
    let ids = builder.floats(&[7.0], "SCALAR");
    let moved = builder.floats(&[1.0, 0.0, 0.0], "VEC3");
    builder.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing":
        {"attributes": {"_ID": ids, "TRANSLATION": moved}}});
    let model = builder.load().unwrap();
    assert!(model.warnings[0].contains("attributes/_ID: this attribute"), "{:?}", model.warnings);
}
