//! The findings of `firsthit lint`.

use serde_json::{Value, json};

use crate::support::{Lab, SQUARE};

/// A tetrahedron; without its last line it has a hole.
const TETRAHEDRON: &str =
    "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn open_tetrahedron(lab: &Lab) {
    lab.write("open.obj", TETRAHEDRON.replace("f 3 1 4\n", ""));
}

#[test]
fn a_clean_file_has_exit_code_0() {
    let lab = Lab::new();
    lab.write("clean.obj", TETRAHEDRON);
    assert_eq!(lab.ok("lint clean.obj").text(), "clean: nothing was found\n");
    let report: Value = serde_json::from_slice(&lab.ok("lint clean.obj --json").stdout).unwrap();
    assert_eq!(
        (&report["is_clean"], &report["files"]),
        (&json!(true), &json!([{"file": "clean.obj", "is_clean": true, "findings": []}]))
    );
    assert_eq!(report["checked"].as_array().unwrap().len(), 12);
}

#[test]
fn findings_have_exit_code_1_counts_and_places() {
    let lab = Lab::new();
    open_tetrahedron(&lab);
    let outcome = lab.run("lint open.obj");
    assert_eq!((outcome.code, outcome.stderr.as_str()), (1, ""));
    let text = String::from_utf8(outcome.stdout).unwrap();
    assert!(
        text.starts_with("hole: 3 edges around 1 hole\n  object 0 'open', triangle 0, at 0,1,0\n"),
        "{text}"
    );
    let outcome = lab.run("lint open.obj --json --places 1");
    assert_eq!(outcome.code, 1);
    let report: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    let place = json!({"object": 0, "name": "open", "primitive": 0, "position": [0.0, 1.0, 0.0]});
    assert_eq!(
        report["files"][0]["findings"],
        json!([{"kind": "hole", "count": 3, "of": "edge", "note": "around 1 hole", "places": [place]}])
    );
    assert_eq!(lab.ok("lint open.obj --ignore hole,units").code, 0);
}

#[test]
fn several_files_are_each_under_their_name() {
    let lab = Lab::new();
    lab.write("whole.obj", TETRAHEDRON);
    open_tetrahedron(&lab);
    let outcome = lab.run("lint whole.obj open.obj");
    assert_eq!(outcome.code, 1);
    let text = String::from_utf8(outcome.stdout).unwrap();
    assert!(
        text.starts_with("whole.obj:\nclean: nothing was found\nopen.obj:\nhole: 3 edges"),
        "{text}"
    );
    let outcome = lab.run("lint whole.obj open.obj --json");
    let report: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    let each = |key: &str| [0, 1].map(|k| report["files"][k][key].clone());
    assert_eq!(report["is_clean"], false);
    assert_eq!(each("file"), [json!("whole.obj"), json!("open.obj")]);
    assert_eq!(each("is_clean"), [json!(true), json!(false)]);
    assert_eq!(lab.ok("lint whole.obj whole.obj").code, 0);
    lab.fails("lint whole.obj open.obj -o a.ply", 2, "one file");
}

#[test]
fn a_file_that_cannot_be_read_stops_no_other() {
    let lab = Lab::new();
    lab.write("bad.obj", "v 0 0 nope\n");
    open_tetrahedron(&lab);
    let outcome = lab.run("lint bad.obj open.obj none.obj");
    let text = String::from_utf8(outcome.stdout).unwrap();
    assert!(text.starts_with("open.obj:\nhole: 3 edges"), "{text}");
    let said: Vec<&str> = outcome.stderr.lines().collect();
    let [bad, none] = said[..] else { panic!("{said:?}") };
    assert!(bad.starts_with("firsthit: error: bad.obj:1: "), "{bad}");
    assert!(none.starts_with("firsthit: error: none.obj: "), "{none}");
    assert_eq!(outcome.code, 3);
    let outcome = lab.run("lint open.obj bad.obj --json");
    let report: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    let [open, bad] = [0, 1].map(|k| &report["files"][k]);
    assert_eq!(open["findings"][0]["kind"], "hole");
    assert_eq!((&bad["file"], &bad["error"]), (&json!("bad.obj"), &report["error"]));
    assert_eq!((outcome.code, &report["exit_code"]), (3, &json!(3)));
}

#[test]
fn what_is_about_the_whole_scene_is_about_no_object() {
    let lab = Lab::new();
    lab.write(
        "small.obj",
        "v 0 0 0\nv 2e-4 0 0\nv 0 2e-4 0\nv 0 0 2e-4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
    );
    let outcome = lab.run("lint small.obj");
    let text = String::from_utf8(outcome.stdout).unwrap();
    assert!(
        text.starts_with("units: 1 scene: the largest side is") && text.contains("\n  at 0.0001,"),
        "{text}"
    );
    let outcome = lab.run("lint small.obj --json");
    let report: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    let place = &report["files"][0]["findings"][0]["places"][0];
    assert!(place["object"].is_null() && place["name"].is_null(), "{place}");
}

#[test]
fn marked_faces_have_the_colour_of_their_kind() {
    let lab = Lab::new();
    lab.write("flat.obj", TETRAHEDRON.to_owned() + "v 1 1 1\nv 9 9 9\nf 2 2 3\n");
    assert_eq!(lab.run("lint flat.obj -o marked.ply").code, 1);
    let marked = lab.read("marked.ply");
    // Vertices of 24 bytes, faces of 16; the last is degenerate.
    let header = marked.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let body = &marked[header..];
    assert_eq!(body.len(), 4 * 24 + 5 * 16);
    let colors: Vec<&[u8]> = body[4 * 24..].chunks(16).map(|face| &face[13..]).collect();
    assert_eq!(
        colors,
        [[200, 200, 200]; 4].iter().chain(&[[230, 60, 180]]).map(|c| &c[..]).collect::<Vec<_>>()
    );
    let info: Value = serde_json::from_slice(&lab.ok("info marked.ply --json").stdout).unwrap();
    assert_eq!((&info["triangles"], &info["vertices"]), (&json!(5), &json!(4)));
}

#[test]
fn what_cannot_be_is_refused() {
    let lab = Lab::new();
    lab.write("square.ply", SQUARE);
    lab.fails("lint square.ply --ignore leaks", 2, "hole");
    lab.fails("lint square.ply -o marked.stl", 2, "must end in .ply");
    lab.fails("lint square.ply -o square.ply", 2, "will not be overwritten");
    lab.fails("lint none.ply", 3, "none.ply");
}
