//! Documents that attack: each is an error with its place, in moments and within its memory.

use std::fs;
use std::path::Path;

use firsthit::load::{LoadSettings, load, load_bytes};
use serde_json::{Value, json};

use super::builder::Builder;

/// A document with everything in it that is replaced below.
pub(crate) fn full() -> Builder {
    let mut builder = Builder::triangle();
    let indices = builder.accessor(&[0, 1, 2], 5121, 3, "SCALAR");
    builder.primitive()["indices"] = json!(indices);
    builder.primitive()["material"] = json!(0);
    builder.json["materials"] =
        json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    builder.json["textures"] = json!([{"source": 0}]);
    builder.json["images"] = json!([{"bufferView": 0}]);
    builder.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1}}]);
    builder.json["skins"] = json!([{"joints": [0]}]);
    builder
}

/// The refusal of the document with a value replaced.
fn refusal(pointer: &str, value: Value) -> String {
    let mut builder = full();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = builder.json.pointer_mut(parent).unwrap();
    let key = &*key.replace("~1", "/");
    match key.parse::<usize>() {
        Ok(index) if parent.is_array() => parent[index] = value,
        _ => parent[key] = value,
    }
    builder.refusal()
}

/// Where a value is put that is wrong there, and what the error's place adds to that (after `!`, is
/// instead).
fn wrong_values() -> impl Iterator<Item = (&'static str, Value, &'static str)> {
    [
        ("/asset/version", json!("1.0"), ""),
        ("/asset/minVersion", json!("2.1"), ""),
        ("/scene", json!(1), ""),
        ("/scenes/0/nodes/0", json!(7), ""),
        ("/nodes/0/mesh", json!(1), ""),
        ("/nodes/0/mesh", json!(-1), ""),
        ("/nodes/0/mesh", json!(0.5), ""),
        ("/nodes/0/mesh", json!("0"), ""),
        ("/nodes/0/mesh", json!(1e300), ""),
        ("/nodes/0/camera", json!(1), ""),
        ("/nodes/0/skin", json!(4), ""),
        ("/nodes/0/children", json!([1]), "/0"),
        ("/nodes/0/matrix", json!([1, 2, 3]), ""),
        ("/nodes/0/scale", json!([1, 2]), ""),
        ("/meshes/0/primitives/0/mode", json!(7), ""),
        ("/meshes/0/primitives/0/indices", json!(2), ""),
        ("/meshes/0/primitives/0/material", json!(1), ""),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(2), ""),
        ("/meshes/0/primitives/0/attributes/A~1B", json!(9), ""),
        ("/accessors/0/count", json!(4), ""),
        ("/accessors/0/count", json!(4_294_967_295_u64), ""),
        ("/accessors/0/count", json!(9_007_199_254_740_992_u64), ""),
        ("/accessors/0/byteOffset", json!(4), "!/accessors/0/count"),
        ("/accessors/0/byteOffset", json!(9_007_199_254_740_992_u64), "!/accessors/0/count"),
        ("/accessors/0/componentType", json!(5124), ""),
        ("/accessors/0/type", json!("VEC5"), ""),
        ("/accessors/0/type", json!("VEC2"), ""),
        ("/accessors/0/bufferView", json!(2), ""),
        ("/accessors/1/componentType", json!(5120), ""),
        ("/bufferViews/0/buffer", json!(1), ""),
        ("/bufferViews/0/byteLength", json!(999), ""),
        ("/bufferViews/0/byteOffset", json!(999), "!/bufferViews/0/byteLength"),
        ("/bufferViews/0/byteStride", json!(8), "!/accessors/0/count"),
        ("/bufferViews/0/byteStride", json!(16), "!/accessors/0/count"),
        ("/materials/0/alphaMode", json!("GLASS"), ""),
        ("/materials/0/pbrMetallicRoughness/baseColorTexture/index", json!(1), ""),
        ("/textures/0/source", json!(1), ""),
        ("/textures/0/sampler", json!(0), ""),
        ("/images/0/bufferView", json!(8), ""),
        ("/skins/0/joints", json!([5]), "/0"),
        ("/skins/0/inverseBindMatrices", json!(5), ""),
    ]
    .into_iter()
}

#[test]
fn what_is_wrong_is_told_by_its_pointer() {
    for (pointer, value, place) in wrong_values() {
        let expected = match place.strip_prefix('!') {
            Some(other) => format!("#{other}: "),
            None => format!("#{pointer}{place}: "),
        };
        let refused = refusal(pointer, value.clone());
        assert!(refused.starts_with(&expected), "{pointer} {value}: {refused}");
    }
}

#[test]
fn indices_of_what_is_not_there_are_refused() {
    let mut builder = full();
    let place = builder.buffer.len() - 1;
    builder.buffer[place] = 3;
    assert_eq!(builder.refusal(), "#/accessors/1: element 2 is index 3, of 3 vertices");
}

#[test]
fn cameras_that_see_nothing_are_refused() {
    for (camera, place) in [
        (json!({"type": "fisheye"}), "/type"),
        (json!({"type": "perspective"}), "/perspective"),
        (json!({"type": "perspective", "perspective": {"yfov": 0}}), "/perspective/yfov"),
        (json!({"type": "perspective", "perspective": {"yfov": 4}}), "/perspective/yfov"),
        (
            json!({"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": -1}}),
            "/perspective/aspectRatio",
        ),
        (
            json!({"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 1}}),
            "/orthographic/xmag",
        ),
    ] {
        let mut builder = full();
        builder.json["cameras"] = json!([camera]);
        builder.json["nodes"][0]["camera"] = json!(0);
        let refused = builder.refusal();
        assert!(refused.starts_with(&format!("#/cameras/0{place}: ")), "{refused}");
    }
}

#[test]
fn sparse_accessors_write_nowhere_but_in_themselves() {
    for (indices, word) in [([0_u8, 3], "index 3"), ([1, 1], "rise"), ([2, 1], "rise")] {
        let mut builder = full();
        let indices = builder.view(&indices);
        let values = builder.view(&[0; 24]);
        builder.json["accessors"][0]["sparse"] = json!({
            "count": 2,
            "indices": {"bufferView": indices, "componentType": 5121},
            "values": {"bufferView": values},
        });
        let refused = builder.refusal();
        assert!(
            refused.starts_with("#/accessors/0/sparse/indices: ") && refused.contains(word),
            "{refused}"
        );
        builder.json["accessors"][0]["sparse"]["count"] = json!(1_u64 << 40);
        assert!(builder.refusal().starts_with("#/accessors/0/sparse/count: "));
    }
}

#[test]
fn packed_views_are_checked_before_they_are_unpacked() {
    for (extension, value, word) in [
        ("count", json!(1_u64 << 50), "packed bytes end too early"),
        ("byteStride", json!(6), "byteStride must be"),
        ("byteStride", json!(0), "byteStride must be"),
        ("mode", json!("MAGIC"), "mode 'MAGIC'"),
        ("filter", json!("SEPIA"), "filter 'SEPIA'"),
        ("filter", json!("QUATERNION"), "does not go with"),
    ] {
        let mut builder = full();
        let packed = builder.view(&[0xa0; 64]);
        let mut meshopt = json!({"buffer": 0, "byteLength": 64, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"});
        meshopt["byteOffset"] = builder.json["bufferViews"][packed]["byteOffset"].clone();
        meshopt[extension] = value;
        builder.json["bufferViews"][packed]["extensions"] =
            json!({"EXT_meshopt_compression": meshopt});
        builder.json["accessors"][0]["bufferView"] = json!(packed);
        let refused = builder.refusal();
        let place = format!("#/bufferViews/{packed}/extensions/EXT_meshopt_compression: ");
        assert!(refused.starts_with(&place) && refused.contains(word), "{refused}");
    }
}

#[test]
fn draco_bytes_that_are_none_are_refused() {
    let mut builder = full();
    let packed = builder.view(b"DRACO\x02\x02\x01\x01\0\0\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff");
    builder.primitive()["extensions"] = json!({"KHR_draco_mesh_compression": {"bufferView": packed, "attributes": {"POSITION": 0}}});
    let refused = builder.refusal();
    assert!(
        refused
            .starts_with("#/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression: Draco: "),
        "{refused}"
    );
}

#[test]
fn broken_json_is_told_by_its_line_or_its_byte() {
    let settings = LoadSettings::default();
    let message = |name: &str, bytes: &[u8]| {
        load_bytes(Path::new(name), bytes, &settings).unwrap_err().to_string()
    };
    assert!(message("a.gltf", b"{\n\"asset\": }").starts_with("a.gltf:2: "));
    assert!(message("a.gltf", b"").starts_with("a.gltf:1: "));
    assert!(message("a.gltf", b"{}").starts_with("a.gltf#: missing field `asset`"));
    assert!(message("a.gltf", b"{\"asset\": {\"version\": \"2.0\"}} x").starts_with("a.gltf:1: "));
    assert!(message("a.gltf", b"{\"asset\": {\"version\": \"\xff\"}}").starts_with("a.gltf"));
    let mut glb = b"glTF\x02\0\0\0\x1c\0\0\0\x08\0\0\0JSON{\"a\": ? ".to_vec();
    glb[8] = glb.len() as u8;
    assert!(message("a.glb", &glb).starts_with("a.glb @ byte 26: "), "{}", message("a.glb", &glb));
    // Nested beyond all measure, where it is read and where it is passed over.
    for key in ["nodes", "extras"] {
        let mut deep = format!("{{\"asset\": {{\"version\": \"2.0\"}}, \"{key}\": ").into_bytes();
        deep.extend(vec![b'['; 1_000_000]);
        assert!(message("a.gltf", &deep).starts_with("a.gltf"), "{key}");
    }
}

#[test]
fn buffers_that_cannot_be_had_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("short.bin"), [0; 4]).unwrap();
    for (buffer, place, word) in [
        (json!({"uri": "missing.bin", "byteLength": 39}), "/uri", "missing.bin"),
        (json!({"uri": "../x.bin", "byteLength": 39}), "/uri", "refused"),
        (json!({"uri": "/dev/zero", "byteLength": 39}), "/uri", "refused"),
        (json!({"uri": "https://host/x.bin", "byteLength": 39}), "/uri", "refused"),
        (json!({"uri": "%2e%2e%2fx.bin", "byteLength": 39}), "/uri", "refused"),
        (json!({"uri": "short.bin", "byteLength": 39}), "/byteLength", "39 bytes are stated, 4"),
        (json!({"uri": "data:;base64,????", "byteLength": 39}), "/uri", "base64"),
        (json!({"byteLength": 39}), "", "neither a uri nor"),
    ] {
        let mut builder = full();
        builder.json["buffers"] = json!([buffer]);
        let path = folder.path().join("a.gltf");
        fs::write(&path, builder.text()).unwrap();
        let error = load(&path, &LoadSettings::default()).unwrap_err().to_string();
        assert!(
            error.contains(&format!("a.gltf#/buffers/0{place}: ")) && error.contains(word),
            "{error}"
        );
    }
}

#[test]
fn every_prefix_of_a_document_is_refused() {
    let text = full().text();
    for end in 0..text.len() {
        let result = load_bytes(Path::new("a.gltf"), &text[..end], &LoadSettings::default());
        assert!(result.is_err(), "{end}");
    }
}

#[test]
fn strides_are_from_4_to_252() {
    for stride in [0, 2, 253] {
        let refused = refusal("/bufferViews/0/byteStride", json!(stride));
        let expected = format!("#/bufferViews/0/byteStride: must be from 4 to 252, got {stride}");
        assert_eq!(refused, expected);
    }
}

#[test]
fn values_of_another_kind_are_told_in_the_words_of_json() {
    for (pointer, value, words) in [
        ("/meshes/0", json!(1), "expected an object"),
        ("/cameras/0/perspective/yfov", json!("1"), "expected a number"),
        ("/skins/0/joints", json!(1), "expected an array"),
    ] {
        let refused = refusal(pointer, value);
        assert!(refused.ends_with(words), "{refused}");
    }
}
