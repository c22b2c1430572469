//! Small documents that describe much: each is refused before it takes the memory.

use std::path::Path;

use firsthit::Error;
use firsthit::load::{LoadSettings, load_bytes};
use serde_json::json;

use super::builder::{Builder, FLOAT, push};
use super::hostile::full;

/// Loads within a limit of 16 MiB.
fn small(builder: &Builder) -> firsthit::Result<firsthit::load::Loaded> {
    let settings = LoadSettings { max_memory: 16 << 20, ..LoadSettings::default() };
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
    for (name, builder) in
        [("zeros", zeros), ("sparse", sparse), ("instances", instances), ("targets", targets)]
    {
        let start = std::time::Instant::now();
        let error = small(&builder).unwrap_err();
        assert!(matches!(error, Error::TooLarge { .. }), "{name}: {error}");
        assert!(error.to_string().contains("--max-memory"), "{name}: {error}");
        assert!(start.elapsed().as_secs() < 2, "{name}: {:?}", start.elapsed());
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

/// The setting allows more than the file's size does.
#[test]
fn more_memory_allows_a_small_file_more() {
    let mut builder = Builder::triangle();
    let position = zeros(&mut builder, 3_000_000, FLOAT, "VEC3");
    builder.primitive()["attributes"]["POSITION"] = json!(position);
    assert!(matches!(builder.load(), Err(Error::TooLarge { .. })));
    let settings = LoadSettings { max_memory: 64 << 30, ..LoadSettings::default() };
    let model = load_bytes(Path::new("a.gltf"), &builder.text(), &settings).unwrap();
    assert_eq!(model.world.objects[0].triangles(), 1_000_000);
}

#[test]
fn counts_that_no_memory_holds_are_limits_with_their_places() {
    let mut builder = Builder::triangle();
    let accessor = json!({"componentType": 5126, "count": 1_u64 << 34, "type": "VEC3"});
    let huge = push(&mut builder.json["accessors"], accessor);
    builder.primitive()["attributes"]["POSITION"] = json!(huge);
    let error = builder.load().unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("#/accessors/1/count: "), "{error}");
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
