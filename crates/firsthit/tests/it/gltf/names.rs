//! Names of nodes, meshes and materials; and the colours of texels at hits.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use firsthit::channel::{ChannelInput, ChannelKind, kind, make};
use firsthit::image::Data;
use firsthit::shoot::{First, trace};
use firsthit::{DVec3, Object, Ray, Scene};
use serde_json::json;

use super::builder::Builder;

/// Down on the plane z = 0.
fn down(points: &[[f64; 2]]) -> Vec<Ray> {
    let ray = |&[x, y]: &[f64; 2]| Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
    points.iter().map(ray).collect()
}

fn channels(scene: &Scene, rays: &[Ray], names: &[&str]) -> Vec<Data> {
    let hits = trace(scene, rays, First, &()).unwrap();
    let shots = ChannelInput { scene, rays: &rays, hits: &hits, sensor: None };
    let kinds: Vec<&ChannelKind> = names.iter().map(|name| kind(name).unwrap()).collect();
    let made = make(&kinds, &shots, &()).unwrap();
    made.into_iter().map(|channel| channel.data).collect()
}

/// A mesh of two triangles side by side, each a primitive with a material of its own, at two nodes
/// of one name, and once more by itself under a node without a name.
fn truck() -> Builder {
    let mut builder = Builder::triangle();
    let moved = builder.floats(&[2.0, 0.0, 0.0, 3.0, 0.0, 0.0, 2.0, 1.0, 0.0], "VEC3");
    let primitives = json!([
        {"attributes": {"POSITION": 0}, "material": 1},
        {"attributes": {"POSITION": moved}, "material": 0},
    ]);
    builder.json["meshes"] = json!([
        {"name": "wheels", "primitives": primitives},
        {"name": "plate", "primitives": [{"attributes": {"POSITION": 0}}]},
    ]);
    builder.json["materials"] = json!([{"name": "rubber"}, {"name": "steel\u{7}"}]);
    builder.json["nodes"] = json!([
        {"name": "truck", "children": [1, 2, 3]},
        {"name": "wheel", "mesh": 0},
        {"name": "wheel", "mesh": 0, "translation": [0, 10, 0]},
        {"children": [4], "translation": [0, 20, 0]},
        {"name": "plate", "mesh": 1},
    ]);
    builder
}

#[test]
fn objects_that_are_called_alike_are_told_apart() {
    let scene = truck().load().unwrap().into_scene().unwrap();
    let names: Vec<&str> = scene.objects().iter().map(Object::name).collect();
    assert_eq!(names, ["wheel", "wheel", "wheel", "wheel", "plate"]);
    let catalog = scene.catalog();
    let nodes: Vec<&str> = catalog.nodes().iter().map(|name| &**name).collect();
    assert_eq!(nodes, ["truck/wheel", "truck/wheel", "truck/node 3/plate"]);
    let meshes: Vec<&str> = catalog.meshes().iter().map(|name| &**name).collect();
    assert_eq!(meshes, ["wheels", "plate"]);
    let materials: Vec<&str> = catalog.materials().iter().map(|name| &**name).collect();
    assert_eq!(materials, ["steel\\u{7}", "rubber"]);

    let places = [[0.2, 0.2], [2.2, 0.2], [0.2, 10.2], [2.2, 10.2], [0.2, 20.2], [9.0, 9.0]];
    let asked = ["object", "node", "mesh", "material"];
    let made = channels(&scene, &down(&places), &asked);
    let expected =
        [[0, 1, 2, 3, 4, -1], [0, 0, 1, 1, 2, -1], [0, 0, 0, 0, 1, -1], [0, 1, 0, 1, -1, -1]];
    assert_eq!(made, expected.map(|ids| Data::Int32(ids.to_vec())));
}

#[test]
fn instances_of_a_node_have_its_number_and_are_objects() {
    let mut builder = Builder::triangle();
    let moves = builder.floats(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0], "VEC3");
    builder.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    builder.json["nodes"][0]["name"] = json!("trees");
    builder.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": moves}}});
    let scene = builder.load().unwrap().into_scene().unwrap();
    let made = channels(&scene, &down(&[[0.2, 0.2], [5.2, 0.2]]), &["object", "node", "mesh"]);
    assert_eq!(made, [[0, 1], [0, 0], [0, 0]].map(|ids| Data::Int32(ids.to_vec())));
    assert_eq!(&*scene.catalog().nodes()[0], "trees");
}

#[test]
fn names_change_no_picture() {
    let scene = |builder: &Builder| builder.load().unwrap().into_scene().unwrap();
    let named = truck();
    let mut unnamed = truck();
    for list in ["nodes", "meshes", "materials"] {
        for entry in unnamed.json[list].as_array_mut().unwrap() {
            entry.as_object_mut().unwrap().remove("name");
        }
    }
    assert_ne!(named.json, unnamed.json);
    assert_eq!(scene(&named).fingerprint(), scene(&unnamed).fingerprint());
}

/// A path of a hundred thousand names, at each of them a mesh, would be ten thousand million names.
#[test]
fn long_paths_are_cut_at_their_beginning() {
    let mut builder = Builder::triangle();
    let count = 20_000;
    let node = |k: usize| json!({"name": format!("n{k}"), "mesh": 0, "children": [k + 1]});
    let mut nodes: Vec<_> = (1..count).map(|k| node(k - 1)).collect();
    nodes.push(json!({"name": "x".repeat(700), "mesh": 0}));
    builder.json["nodes"] = json!(nodes);
    let model = builder.load().unwrap();
    let path = |object: usize| model.world.objects[object].node().unwrap().name.clone();
    assert_eq!(&*path(2), "n0/n1/n2");
    let deep = path(count - 2);
    assert!(deep.len() <= 512 + 4, "{}", deep.len());
    assert!(deep.starts_with(".../n1") && deep.ends_with("/n19997/n19998"), "{deep}");
    assert_eq!(path(count - 1).len(), 4 + 700);
}

/// Two by two texels, row 0 at the top, as sRGB.
const TEXELS: [[u8; 3]; 4] = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [128, 128, 128]];

/// Level 128 in linear light, by the standard: ((128/255 + 0.055) / 1.055)^2.4.
const GREY: f64 = 0.215_860_500_113_899;

fn png() -> String {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(TEXELS.as_flattened()).unwrap();
    writer.finish().unwrap();
    format!("data:image/png;base64,{}", STANDARD.encode(bytes))
}

/// A square with texture coordinates (x, y), which run downwards in glTF, and a factor of (1/2, 1,
/// 1).
fn base_colors(filter: u32, places: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let mut builder = Builder::new();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    builder.attribute("POSITION", &corners, "VEC3");
    builder.attribute("TEXCOORD_0", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0], "VEC2");
    builder.primitive()["mode"] = json!(5);
    builder.primitive()["material"] = json!(0);
    builder.json["materials"] = json!([{"pbrMetallicRoughness":
        {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1, 1, 1]}}]);
    builder.json["textures"] = json!([{"source": 0, "sampler": 0}]);
    builder.json["samplers"] = json!([{"magFilter": filter, "wrapS": 33071, "wrapT": 33071}]);
    builder.json["images"] = json!([{"uri": png()}]);
    let scene = builder.load().unwrap().into_scene().unwrap();
    let made = channels(&scene, &down(places), &["base_color"]);
    let [Data::Float64(values)] = made.as_slice() else { panic!("{made:?}") };
    values.as_chunks().0.to_vec()
}

fn assert_near(seen: &[[f64; 3]], expected: &[[f64; 3]]) {
    assert_eq!(seen.len(), expected.len());
    for (seen, expected) in seen.iter().zip(expected) {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-6 || (a.is_nan() && b.is_nan());
        assert!(seen.iter().zip(expected).all(near), "{seen:?}, not {expected:?}");
    }
}

/// Texels and the means of texels by hand: a texel's centre is in the middle of its quarter.
#[test]
fn base_color_is_the_texel_times_the_factor() {
    let quarters = [[0.1, 0.2], [0.7, 0.1], [0.2, 0.6], [0.9, 0.8], [3.0, 3.0]];
    let texels = [
        [0.5, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.5 * GREY, GREY, GREY],
        [f64::NAN; 3],
    ];
    assert_near(&base_colors(9728, &quarters), &texels);
    // At the centres; a quarter of the way from one to the next; in the middle of all four; beyond
    // the centres, clamped.
    let places = [[0.25, 0.25], [0.375, 0.25], [0.5, 0.5], [0.05, 0.75]];
    let means = [
        [0.5, 0.0, 0.0],
        [0.5 * 0.75, 0.25, 0.0],
        [0.5 * (1.0 + GREY) / 4.0, (1.0 + GREY) / 4.0, (1.0 + GREY) / 4.0],
        [0.0, 0.0, 1.0],
    ];
    assert_near(&base_colors(9729, &places), &means);
}
