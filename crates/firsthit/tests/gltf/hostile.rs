//! Documents that attack: each is an error with its place, in moments and within its memory.

use std::fs;
use std::path::Path;

use firsthit::Error;
use firsthit::load::{LoadSettings, load, load_bytes};
use serde_json::{Value, json};

use crate::builder::{Builder, FLOAT, push};

/// A document with everything in it that is replaced below.
fn full() -> Builder {
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

/// Where a value is put that is wrong there, and what the error's place adds to that (after `!`, is instead).
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
        (
            "/accessors/0/byteOffset",
            json!(9_007_199_254_740_992_u64),
            "!/accessors/0/count",
        ),
        ("/accessors/0/componentType", json!(5124), ""),
        ("/accessors/0/type", json!("VEC5"), ""),
        ("/accessors/0/type", json!("VEC2"), ""),
        ("/accessors/0/bufferView", json!(2), ""),
        ("/accessors/1/componentType", json!(5120), ""),
        ("/bufferViews/0/buffer", json!(1), ""),
        ("/bufferViews/0/byteLength", json!(999), ""),
        (
            "/bufferViews/0/byteOffset",
            json!(999),
            "!/bufferViews/0/byteLength",
        ),
        ("/bufferViews/0/byteStride", json!(8), "!/accessors/0/count"),
        (
            "/bufferViews/0/byteStride",
            json!(16),
            "!/accessors/0/count",
        ),
        ("/materials/0/alphaMode", json!("GLASS"), ""),
        (
            "/materials/0/pbrMetallicRoughness/baseColorTexture/index",
            json!(1),
            "",
        ),
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
        assert!(
            refused.starts_with(&expected),
            "{pointer} {value}: {refused}"
        );
    }
}

#[test]
fn indices_of_what_is_not_there_are_refused() {
    let mut builder = full();
    let place = builder.buffer.len() - 1;
    builder.buffer[place] = 3;
    assert_eq!(
        builder.refusal(),
        "#/accessors/1: element 2 is index 3, of 3 vertices"
    );
}

#[test]
fn cameras_that_see_nothing_are_refused() {
    for (camera, place) in [
        (json!({"type": "fisheye"}), "/type"),
        (json!({"type": "perspective"}), "/perspective"),
        (
            json!({"type": "perspective", "perspective": {"yfov": 0}}),
            "/perspective/yfov",
        ),
        (
            json!({"type": "perspective", "perspective": {"yfov": 4}}),
            "/perspective/yfov",
        ),
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
        assert!(
            refused.starts_with(&format!("#/cameras/0{place}: ")),
            "{refused}"
        );
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
        assert!(
            builder
                .refusal()
                .starts_with("#/accessors/0/sparse/count: ")
        );
    }
}

/// Loads within a limit of 16 MiB.
fn small(builder: &Builder) -> firsthit::Result<firsthit::load::Loaded> {
    let settings = LoadSettings {
        max_memory: 16 << 20,
        ..LoadSettings::default()
    };
    load_bytes(Path::new("a.gltf"), &builder.text(), &settings)
}

#[test]
fn counts_that_nothing_stands_behind_meet_the_limit_of_memory() {
    // An accessor of zeros only.
    let mut zeros = full();
    zeros.json["accessors"][0] =
        json!({"componentType": 5126, "count": 1_u64 << 50, "type": "VEC3"});
    // Sparse zeros.
    let mut sparse = full();
    let (indices, values) = (sparse.view(&[0]), sparse.view(&[0; 12]));
    sparse.json["accessors"][0] = json!({"componentType": 5126, "count": 1_u64 << 32, "type": "VEC3", "sparse":
        {"count": 1, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}}});
    // Instances of no bytes.
    let mut instances = full();
    let nothing = json!({"componentType": 5126, "count": 1_u64 << 45, "type": "VEC3"});
    let nothing = push(&mut instances.json["accessors"], nothing);
    instances.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": nothing}}});
    // Targets that name one accessor again and again.
    let mut targets = full();
    let zeros_again = json!({"componentType": 5126, "count": 3, "type": "VEC3"});
    let zeros_again = push(&mut targets.json["accessors"], zeros_again);
    targets.json["accessors"][0] = json!({"componentType": 5126, "count": 500_000, "type": "VEC3"});
    targets.json["accessors"][zeros_again]["count"] = json!(500_000);
    targets.primitive()["targets"] = json!(vec![json!({"POSITION": zeros_again}); 10_000]);
    targets.json["meshes"][0]["weights"] = json!(vec![1.0; 10_000]);
    for (name, builder) in [
        ("zeros", zeros),
        ("sparse", sparse),
        ("instances", instances),
        ("targets", targets),
    ] {
        let start = std::time::Instant::now();
        let error = small(&builder).unwrap_err();
        assert!(matches!(error, Error::TooLarge { .. }), "{name}: {error}");
        assert!(
            error.to_string().contains("--max-memory"),
            "{name}: {error}"
        );
        assert!(
            start.elapsed().as_secs() < 2,
            "{name}: {:?}",
            start.elapsed()
        );
    }
}

/// 300 primitives, 10,000 instances each: three million objects of a small file.
#[test]
fn objects_beyond_the_limit_of_memory_are_refused() {
    let mut builder = full();
    let primitive = builder.primitive().clone();
    builder.json["meshes"][0]["primitives"] = json!(vec![primitive; 300]);
    let many = push(
        &mut builder.json["accessors"],
        json!({"componentType": 5126, "count": 10_000, "type": "VEC3"}),
    );
    builder.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": many}}});
    let error = small(&builder).unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
}

/// An accessor of zeros that no byte stands for.
fn zeros(builder: &mut Builder, count: usize, component: u32, kind: &str) -> usize {
    let accessor = json!({"componentType": component, "count": count, "type": kind});
    push(&mut builder.json["accessors"], accessor)
}

/// Each would take gigabytes, in what is allowed, and be described in a few bytes.
#[test]
fn small_files_describe_little() {
    let mut files = Vec::new();
    // 60,000,000 vertices in 231 bytes: with their tree, 4 GB.
    let mut builder = Builder::triangle();
    let position = zeros(&mut builder, 60_000_000, FLOAT, "VEC3");
    builder.primitive()["attributes"]["POSITION"] = json!(position);
    files.push(("zeros", builder));
    let mut builder = Builder::triangle();
    let indices = zeros(&mut builder, 200_000_000, 5125, "SCALAR");
    builder.primitive()["indices"] = json!(indices);
    files.push(("indices", builder));
    let mut builder = Builder::triangle();
    let count = 10_000_000;
    let position = zeros(&mut builder, count, FLOAT, "VEC3");
    let joints = zeros(&mut builder, count, 5121, "VEC4");
    let weights = zeros(&mut builder, count, FLOAT, "VEC4");
    builder.primitive()["attributes"] =
        json!({"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights});
    builder.json["skins"] = json!([{"joints": [0]}]);
    builder.json["nodes"][0]["skin"] = json!(0);
    files.push(("skin", builder));
    let mut builder = Builder::triangle();
    let (indices, values) = (builder.view(&[0]), builder.view(&[0; 12]));
    builder.json["accessors"][0] = json!({"componentType": 5126, "count": 60_000_000, "type": "VEC3", "sparse":
        {"count": 1, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}}});
    files.push(("sparse", builder));
    // A mesh of 600 primitives that 8,000 nodes show.
    let mut builder = Builder::triangle();
    let primitive = builder.primitive().clone();
    builder.json["meshes"][0]["primitives"] = json!(vec![primitive; 600]);
    builder.json["nodes"] = json!(vec![json!({"mesh": 0}); 8000]);
    builder.json["scenes"][0]["nodes"] = json!((0..8000).collect::<Vec<_>>());
    files.push(("nodes", builder));
    // The same instances at many nodes.
    let mut builder = Builder::triangle();
    let places = builder.floats(&[1.0; 3000], "VEC3");
    let instancing = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
    builder.json["nodes"] = json!(vec![json!({"mesh": 0, "extensions": instancing}); 5000]);
    builder.json["scenes"][0]["nodes"] = json!((0..5000).collect::<Vec<_>>());
    files.push(("instances", builder));
    // A long name at many nodes.
    let mut builder = Builder::triangle();
    builder.json["meshes"][0]["name"] = json!("x".repeat(100_000));
    builder.json["nodes"] = json!(vec![json!({"mesh": 0}); 5000]);
    builder.json["scenes"][0]["nodes"] = json!((0..5000).collect::<Vec<_>>());
    files.push(("names", builder));
    // The same bytes for many primitives.
    let mut builder = Builder::triangle();
    let vectors = builder.floats(&vec![0.5; 300_000], "VEC3");
    builder.primitive()["attributes"] = json!({"POSITION": vectors, "NORMAL": vectors});
    let primitive = builder.primitive().clone();
    builder.json["meshes"][0]["primitives"] = json!(vec![primitive; 2000]);
    files.push(("attributes", builder));
    for (name, builder) in files {
        let error = builder.load().expect_err(name);
        assert!(matches!(error, Error::TooLarge { .. }), "{name}: {error}");
        let said = error.to_string();
        let words = "may describe: 256 times its size and 1/256 of what is allowed (--max-memory";
        assert!(said.contains(words), "{name}: {said}");
    }
}

/// What the size does not allow, the setting does.
#[test]
fn more_memory_allows_a_small_file_more() {
    let mut builder = Builder::triangle();
    let position = zeros(&mut builder, 3_000_000, FLOAT, "VEC3");
    builder.primitive()["attributes"]["POSITION"] = json!(position);
    assert!(matches!(builder.load(), Err(Error::TooLarge { .. })));
    let settings = LoadSettings {
        max_memory: 64 << 30,
        ..LoadSettings::default()
    };
    let model = load_bytes(Path::new("a.gltf"), &builder.text(), &settings).unwrap();
    assert_eq!(model.world.objects[0].triangles(), 1_000_000);
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
        assert!(
            refused.starts_with(&place) && refused.contains(word),
            "{refused}"
        );
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
        load_bytes(Path::new(name), bytes, &settings)
            .unwrap_err()
            .to_string()
    };
    assert!(message("a.gltf", b"{\n\"asset\": }").starts_with("a.gltf:2: "));
    assert!(message("a.gltf", b"").starts_with("a.gltf:1: "));
    assert!(message("a.gltf", b"{}").starts_with("a.gltf#: missing field `asset`"));
    assert!(message("a.gltf", b"{\"asset\": {\"version\": \"2.0\"}} x").starts_with("a.gltf:1: "));
    assert!(message("a.gltf", b"{\"asset\": {\"version\": \"\xff\"}}").starts_with("a.gltf"));
    let mut glb = b"glTF\x02\0\0\0\x1c\0\0\0\x08\0\0\0JSON{\"a\": ? ".to_vec();
    glb[8] = glb.len() as u8;
    assert!(
        message("a.glb", &glb).starts_with("a.glb @ byte 26: "),
        "{}",
        message("a.glb", &glb)
    );
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
        (
            json!({"uri": "missing.bin", "byteLength": 39}),
            "/uri",
            "missing.bin",
        ),
        (
            json!({"uri": "../x.bin", "byteLength": 39}),
            "/uri",
            "refused",
        ),
        (
            json!({"uri": "/dev/zero", "byteLength": 39}),
            "/uri",
            "refused",
        ),
        (
            json!({"uri": "https://host/x.bin", "byteLength": 39}),
            "/uri",
            "refused",
        ),
        (
            json!({"uri": "%2e%2e%2fx.bin", "byteLength": 39}),
            "/uri",
            "refused",
        ),
        (
            json!({"uri": "short.bin", "byteLength": 39}),
            "/byteLength",
            "39 bytes are stated, 4",
        ),
        (
            json!({"uri": "data:;base64,????", "byteLength": 39}),
            "/uri",
            "base64",
        ),
        (json!({"byteLength": 39}), "", "neither a uri nor"),
    ] {
        let mut builder = full();
        builder.json["buffers"] = json!([buffer]);
        let path = folder.path().join("a.gltf");
        fs::write(&path, builder.text()).unwrap();
        let error = load(&path, &LoadSettings::default())
            .unwrap_err()
            .to_string();
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
fn counts_that_no_memory_holds_are_limits_with_their_places() {
    let mut builder = Builder::triangle();
    let accessor = json!({"componentType": 5126, "count": 1_u64 << 34, "type": "VEC3"});
    let huge = push(&mut builder.json["accessors"], accessor);
    builder.primitive()["attributes"]["POSITION"] = json!(huge);
    let error = builder.load().unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    assert!(
        error.to_string().contains("#/accessors/1/count: "),
        "{error}"
    );
    let mut builder = Builder::triangle();
    let huge = push(
        &mut builder.json["accessors"],
        json!({"componentType": 5126, "count": 1_u64 << 34, "type": "VEC3"}),
    );
    builder.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": huge}}});
    let error = builder.load().unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    let place = "#/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION: ";
    assert!(error.to_string().contains(place), "{error}");
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
        (
            "/cameras/0/perspective/yfov",
            json!("1"),
            "expected a number",
        ),
        ("/skins/0/joints", json!(1), "expected an array"),
    ] {
        let refused = refusal(pointer, value);
        assert!(refused.ends_with(words), "{refused}");
    }
}
