//! Point clouds as outputs, beside meshes that have the same extension.

use std::fs;

use serde_json::{Value, json};

use crate::support::Lab;

const CAMERA: &str = "--position 0,0,5 --aim 0,0,-1 --up 0,1,0 --size 30x20";

fn info(lab: &Lab, file: &str) -> Value {
    let outcome = lab.ok(&format!("info {file} --json"));
    serde_json::from_slice(&outcome.stdout).unwrap()
}

/// The channels that a file's metadata name.
fn channels(said: &Value) -> Vec<&str> {
    let channels = said["metadata"]["channels"].as_array().unwrap().iter();
    channels.map(|channel| channel["name"].as_str().unwrap()).collect()
}

#[test]
fn a_picture_is_a_cloud_of_what_it_shows() {
    let lab = Lab::with_square();
    let said = lab.ok(&format!("render square.ply {CAMERA} -o a.ply -o a.pcd -o a.npz --json"));
    let said: Value = serde_json::from_slice(&said.stdout).unwrap();
    let names = ["position", "normal", "color", "object"];
    assert_eq!(said["outputs"][0]["channels"], json!(names));
    assert_eq!(said["outputs"][2]["channels"], json!(["color"]));
    let hits = said["hits"].as_u64().unwrap();
    assert!(hits > 0 && hits < 600);
    for file in ["a.ply", "a.pcd"] {
        let said = info(&lab, file);
        assert_eq!(channels(&said), names);
        assert_eq!(said["metadata"]["shape"], json!([hits]));
        assert_eq!(said["metadata"]["camera"]["position"], json!([0.0, 0.0, 5.0]));
    }
    // The square lies in z = 0.
    let cloud = fs::read(lab.path("a.ply")).unwrap();
    let start = cloud.windows(11).position(|words| words == b"end_header\n").unwrap() + 11;
    let row = 6 * 8 + 3 + 4;
    assert_eq!(cloud.len(), start + row * usize::try_from(hits).unwrap());
    for point in cloud[start..].chunks_exact(row) {
        assert_eq!(point[16..24], 0.0_f64.to_le_bytes());
        assert_eq!(point[40..48], 1.0_f64.to_le_bytes());
    }
    lab.ok("diff a.ply a.pcd");
    assert!(lab.ok("diff a.ply a.ply").text().contains("position: equal"));
}

#[test]
fn the_channels_of_a_cloud_are_those_asked_for_and_its_positions() {
    let lab = Lab::with_square();
    let render = format!("render square.ply {CAMERA} --channels z,object");
    lab.ok(&format!("{render} -o a.ply -o a.exr"));
    assert_eq!(channels(&info(&lab, "a.ply")), ["position", "z", "object"]);
    // What was not asked for does not come into the others.
    assert_eq!(channels(&info(&lab, "a.exr")), ["z", "object"]);
    // What the picture leaves out the cloud has.
    lab.fails(&format!("{render} -o a.png -o b.ply"), 2, "holds one channel of several");
    assert!(!lab.path("b.ply").exists());
    lab.ok(&format!("render square.ply {CAMERA} --channels color,z -o a.png -o c.ply"));
    lab.fails(&format!("{render} -o {{channel}}.ply"), 2, "a point cloud holds all channels");
    lab.ok("demo --size 20x10 --samples 1 -o demo.pcd -o demo.png");
    assert_eq!(channels(&info(&lab, "demo.pcd")), ["position", "normal", "color", "object"]);
}

#[test]
fn rays_make_clouds_too() {
    let lab = Lab::with_square();
    lab.write("rays.csv", "0,0,2,0,0,-1\n9,9,2,0,0,-1\n0.25,0.5,2,0,0,-1\n");
    lab.ok("shoot square.ply rays.csv -o hits.ply -o hits.csv");
    let said = info(&lab, "hits.ply");
    assert_eq!(channels(&said), ["position", "normal", "t", "object", "primitive"]);
    assert_eq!(said["metadata"]["shape"], json!([2]), "the miss is left out");
    assert_eq!(said["metadata"]["camera"], Value::Null);
    lab.ok("shoot square.ply rays.csv -o hits.pcd --channels t");
    assert_eq!(channels(&info(&lab, "hits.pcd")), ["position", "t"]);
    lab.ok("shoot square.ply rays.csv -o hits.csv");
    assert!(lab.read("hits.csv").starts_with(b"t,object,primitive\n"));
}

#[test]
fn a_mesh_stays_a_mesh() {
    let lab = Lab::with_square();
    assert_eq!(info(&lab, "square.ply")["triangles"], 2);
    lab.fails("square.ply", 2, "did you mean firsthit render square.ply?");
    lab.ok(&format!("render square.ply {CAMERA} -o cloud.ply"));
    lab.fails(&format!("render square.ply {CAMERA} -o square.ply"), 2, "square.ply is an input");
    // The points can be loaded, but no picture shows them.
    lab.fails(&format!("render cloud.ply {CAMERA} -o nothing.png"), 3, "points without a face");
    lab.fails(
        "diff cloud.ply square.ply",
        3,
        "square.ply: more than points: a mesh, not a point cloud",
    );
}

#[test]
fn a_scene_file_asks_for_a_cloud() {
    let lab = Lab::new();
    let file = "[[objects]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n\n[[outputs]]\nfile = \"cloud.pcd\"\n\n\
        [[outputs]]\nfile = \"some.ply\"\nchannels = [\"object\"]\n";
    lab.write("ball.toml", file);
    lab.ok("render ball.toml --size 20x10");
    assert_eq!(channels(&info(&lab, "cloud.pcd")), ["position", "normal", "color", "object"]);
    assert_eq!(channels(&info(&lab, "some.ply")), ["position", "object"]);
}
