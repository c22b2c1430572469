//! The contents of glTF files: cameras by name, lights, and lists of all that they hold.

use serde_json::{Value, json};

use crate::support::{Array, Lab, array};

/// A square of two triangles from -1 to 1 at z = 0, and cameras above it.
fn document() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1, 2, 3, 4]}],
        "nodes": [
            {"mesh": 0, "scale": [2, 2, 1]},
            {"camera": 0, "name": "Front", "translation": [0, 0, 4]},
            {"camera": 1, "name": "Map", "translation": [0, 0, 9]},
            {"camera": 1, "name": "Map", "translation": [0, 0, 7]},
            {"translation": [0, 0, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "cameras": [
            {"name": "lens", "type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 2, "znear": 1}},
            {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0, "zfar": 1}},
        ],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 3}]}},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}],
        "accessors": [{"bufferView": 0, "componentType": 5120, "count": 4, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 16, "byteStride": 4}],
        // -1 -1 0, 1 -1 0, -1 1 0, 1 1 0
        "buffers": [{"byteLength": 16, "uri": "data:;base64,//8AAAH/AAD/AQAAAQEAAA=="}],
    })
}

fn lab() -> Lab {
    let lab = Lab::new();
    lab.write("a.gltf", document().to_string());
    lab
}

/// The shape of a picture of distances, and its middle.
fn z_of(lab: &Lab, camera: &str) -> (Vec<u64>, f64) {
    lab.ok(&format!("render a.gltf {camera} --channels z -o z.npy"));
    let Array { shape, values, .. } = array(&lab.read("z.npy"));
    let columns = usize::try_from(shape[1]).unwrap();
    let middle = values[usize::midpoint(values.len(), columns)];
    (shape, middle)
}

#[test]
fn cameras_are_taken_by_name_or_number() {
    let lab = lab();
    let own = (vec![512, 1024], 4.0);
    for camera in ["--camera Front", "--camera lens", "--camera 0"] {
        assert_eq!(z_of(&lab, camera), own, "{camera}");
    }
    assert_eq!(z_of(&lab, "--camera 1"), (vec![1024, 1024], 9.0));
    assert_eq!(z_of(&lab, "--camera 2 --size 60x40"), (vec![40, 60], 7.0));
}

#[test]
fn options_replace_what_the_files_camera_says() {
    let lab = lab();
    assert_eq!(z_of(&lab, "--camera Front --position 0,0,3 --size 40x40"), (vec![40, 40], 3.0));
}

/// From 4 away the square's edge of 2 is at 26.6 degrees: the file's 14 end before it, 30 behind
/// it.
#[test]
fn the_angle_of_the_file_is_that_of_the_picture() {
    let lab = lab();
    let corner = |camera: &str| {
        z_of(&lab, camera);
        array(&lab.read("z.npy")).values[0]
    };
    assert!((corner("--camera Front --size 100x100") - 4.0).abs() < 1e-12);
    assert_eq!(corner("--camera Front --size 100x100 --fov 60"), f64::INFINITY);
}

#[test]
fn a_camera_that_is_not_there_is_told_which_are() {
    let lab = lab();
    let outcome = lab.run("render a.gltf --camera Frint");
    assert_eq!(outcome.code, 2);
    let line = "firsthit: error: --camera 'Frint': the file has 0 Front (or lens), 1 Map, 2 Map\n";
    assert_eq!(outcome.stderr, line);
    let outcome = lab.run("render a.gltf --camera Map");
    assert!(
        outcome.stderr.contains("several cameras have this name, use a number: 1, 2"),
        "{}",
        outcome.stderr
    );
    let lab = Lab::with_square();
    let outcome = lab.run("render square.ply --camera 0");
    assert!(outcome.stderr.contains("the file has no cameras"), "{}", outcome.stderr);
}

#[test]
fn info_lists_cameras_lights_and_vertices() {
    let lab = lab();
    let outcome = lab.ok("info a.gltf --json");
    let info: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    assert_eq!((&info["triangles"], &info["vertices"]), (&json!(2), &json!(4)));
    assert_eq!(info["cameras"][0]["name"], "Front");
    assert_eq!(info["cameras"][1]["projection"], "orthographic");
    assert_eq!(info["cameras"][1]["height"], 4.0);
    assert_eq!(info["lights"][0]["kind"], "point");
    assert_eq!(info["lights"][0]["position"], json!([0.0, 0.0, 1.0]));
    assert_eq!((&info["materials"], &info["textures"]), (&json!([]), &json!([])));
    let output = lab.ok("info a.gltf");
    let text = output.text();
    for line in ["cameras    3", "lights     1", "  0  point at 0,0,1"] {
        assert!(text.lines().any(|there| there == line), "{line}: {text}");
    }
    assert!(text.contains("  0 Front (or lens)  (perspective, 28.6"), "{text}");
}

#[test]
fn a_broken_file_is_one_line_with_its_place() {
    let lab = Lab::new();
    let mut document = document();
    document["accessors"][0]["count"] = json!(5);
    lab.write("a.gltf", document.to_string());
    let outcome = lab.run("render a.gltf");
    assert_eq!(outcome.code, 3);
    let (line, rest) = outcome.stderr.split_once('\n').unwrap();
    assert!(line.starts_with("firsthit: error: a.gltf#/accessors/0/count: "), "{line}");
    assert_eq!(rest, "");
    assert_eq!(lab.names(), ["a.gltf"]);
}

/// The square with a translucent material and a variant that is opaque.
fn translucent() -> Lab {
    let mut json = document();
    json["materials"] = json!([
        {"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.4]}},
        {},
    ]);
    json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_materials_variants"]);
    json["extensions"]["KHR_materials_variants"] = json!({"variants": [{"name": "wood"}]});
    let primitive = &mut json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    primitive["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}});
    let lab = Lab::new();
    lab.write("a.gltf", json.to_string());
    lab
}

#[test]
fn translucent_surfaces_are_cut_out_below_an_alpha_and_variants_have_names() {
    let lab = translucent();
    assert_eq!(z_of(&lab, "--camera 1").1, 9.0);
    assert_eq!(z_of(&lab, "--camera 1 --blend-below 0.3").1, 9.0);
    assert_eq!(z_of(&lab, "--camera 1 --blend-below 0.5").1, f64::INFINITY);
    let wood =
        lab.ok("render a.gltf --camera 1 --channels z -o z.npy --variant wood --blend-below 0.5");
    let said = "--blend-below does nothing here: no material is translucent";
    assert!(wood.stderr.contains(said), "{}", wood.stderr);
    let outcome = lab.ok("info a.gltf");
    let text = outcome.text();
    assert!(text.contains("\nvariants   1\n  wood\n"), "{text}");
    let refused = lab.run("render a.gltf --variant oak");
    assert!(refused.stderr.contains("got \"oak\"; there are \"wood\""), "{}", refused.stderr);
    let refused = lab.run("render a.gltf --blend-below 2");
    assert!(refused.stderr.contains("expected a number from 0 to 1"), "{}", refused.stderr);
}
