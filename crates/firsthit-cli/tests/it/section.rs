//! Sections of files.

use serde_json::{Value, json};

use crate::support::Lab;

/// The unit cube, from -1 to 0 along x.
const CUBE: &str = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
    property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n\
    -1 0 0\n0 0 0\n0 1 0\n-1 1 0\n-1 0 1\n0 0 1\n0 1 1\n-1 1 1\n\
    4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

fn lab() -> Lab {
    let lab = Lab::new();
    lab.write("cube.ply", CUBE);
    lab
}

#[test]
fn a_cube_is_cut_through_its_middle_across_up() {
    let lab = lab();
    let outcome = lab.ok("section cube.ply --json -o cut.json");
    let report: Value = serde_json::from_slice(&outcome.stdout).unwrap();
    assert_eq!(report["origin"], json!([-0.5, 0.5, 0.5]));
    assert_eq!(report["normal"], json!([0.0, 0.0, 1.0]));
    assert_eq!((&report["closed_polylines"], &report["open_polylines"]), (&json!(1), &json!(0)));
    assert_eq!((&report["segments"], &report["warnings"]), (&json!(8), &json!([])));
    assert_eq!((&report["area"], &report["perimeter"]), (&json!(1.0), &json!(4.0)));
    let cut: Value = serde_json::from_slice(&lab.read("cut.json")).unwrap();
    for key in ["origin", "normal", "u", "v", "area", "perimeter", "left_out"] {
        assert_eq!(cut[key], report[key], "{key}");
    }
    let [polyline] = &cut["polylines"].as_array().unwrap()[..] else {
        panic!("one polyline");
    };
    let lengths =
        ["points", "points_2d", "primitives"].map(|key| polyline[key].as_array().unwrap().len());
    assert_eq!((lengths, &polyline["is_closed"]), ([8; 3], &json!(true)));
    let said = lab.ok("section cube.ply");
    let text = said.text();
    assert!(text.contains("curves     1 closed, 0 open, 8 segments"), "{text}");
    // The numbers are the result where no file is.
    let quiet = lab.ok("section cube.ply --quiet");
    assert_eq!((quiet.text(), &*quiet.stderr), (text, ""));
    let quiet = lab.ok("section cube.ply --quiet -o cut.svg");
    assert_eq!((quiet.text(), &*quiet.stderr), ("", ""));
}

#[test]
fn drawings_are_in_the_planes_coordinates() {
    let lab = lab();
    lab.write("strip.obj", "v 0 0 0\nv 4 0 0\nv 0 0 2\nf 1 2 3\n");
    lab.ok("section strip.obj --origin 1,0,1 --normal 0,0,1 -o cut.svg -o cut.dxf");
    let svg = String::from_utf8(lab.read("cut.svg")).unwrap();
    assert!(svg.contains("fill=\"none\"") && svg.contains("1.0 0.0"), "{svg}");
    let dxf = String::from_utf8(lab.read("cut.dxf")).unwrap();
    assert_eq!(dxf.matches("VERTEX").count(), 2);
    assert!(dxf.ends_with("  0\nEOF\n"), "{dxf}");
}

#[test]
fn what_is_left_out_or_missed_is_told() {
    let lab = lab();
    lab.write(
        "scene.toml",
        "[[objects]]\nname = \"ball\"\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n",
    );
    let said = lab.ok("section scene.toml --origin 0,0,0 --normal 1,0,0").stderr;
    assert!(
        said.contains("left out of the section, not a mesh: object 0, 'ball' (sphere)"),
        "{said}"
    );
    assert!(said.contains("the plane cuts nothing"), "{said}");
}

#[test]
fn wrong_planes_and_outputs_are_refused() {
    let lab = lab();
    lab.fails("section cube.ply --normal 0,0,0", 2, "normal must be a finite direction");
    lab.fails("section none.stl -o cut.png", 2, "a file in .svg, .dxf or .json");
    lab.fails("section none.stl -o cut.svg -o ./cut.svg", 2, "named twice");
    lab.fails("section none.stl -o no/cut.svg", 4, "the folder does not exist");
    lab.fails("section cube.ply --normal 1,2", 2, "three finite numbers");
}
