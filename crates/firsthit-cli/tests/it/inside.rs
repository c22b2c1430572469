//! Which points are inside.

use serde_json::Value;

use crate::support::{Lab, array};

/// Of a cube from 0 to 1: its middle, a point beside it, and one just below its top.
const POINTS: &str = "x,y,z\n0.5,0.5,0.5\n2,0.5,0.5\n0.25,0.75,0.875\n";

/// The cube without its top, and with it.
fn cubes(lab: &Lab) {
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    let open = format!("{corners}f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    lab.write("open.obj", &open);
    lab.write("cube.obj", format!("{open}f 5 6 7 8\n"));
}

#[test]
fn points_go_in_and_answers_come_out() {
    let lab = Lab::new();
    cubes(&lab);
    let outcome = lab.pipe("inside cube.obj -", POINTS.as_bytes());
    assert_eq!(outcome.text(), "inside\n1\n0\n1\n");
    assert!(
        outcome
            .stderr
            .contains("standard output: 3 points, 2 inside, ")
    );
    lab.write("points.csv", POINTS);
    let outcome = lab.ok("inside cube.obj points.csv -o a.npy -o a.npz -o a.csv --json");
    let said: Value = serde_json::from_str(outcome.text()).unwrap();
    assert_eq!((&said["points"], &said["inside"]), (&3.into(), &2.into()));
    assert_eq!(said["rules"], serde_json::json!(["parity"]));
    assert_eq!(said["warnings"], serde_json::json!([]));
    assert_eq!(array(&lab.read("a.npy")).values, [1.0, 0.0, 1.0]);
    assert_eq!(lab.npz("a.npz")["inside"].shape, [3]);
    assert_eq!(lab.read("a.csv"), b"inside\n1\n0\n1\n");
    for none in ["", "x,y,z\n"] {
        let outcome = lab.pipe("inside cube.obj -", none.as_bytes());
        assert_eq!((outcome.code, outcome.text()), (0, "inside\n"), "{none:?}");
    }
}

#[test]
fn an_open_mesh_is_a_warning() {
    let lab = Lab::new();
    cubes(&lab);
    let outcome = lab.pipe("inside open.obj -", POINTS.as_bytes());
    assert_eq!(outcome.text().lines().nth(1), Some("1"));
    let words = "1 object of 1 is open: what is inside is decided by the winding number";
    assert!(outcome.stderr.contains(words), "{}", outcome.stderr);
}

#[test]
fn what_are_no_points_is_refused() {
    let lab = Lab::new();
    cubes(&lab);
    lab.write("pairs.csv", "0,0\n");
    lab.write("points.csv", POINTS);
    for (arguments, code, words) in [
        (
            "inside cube.obj pairs.csv",
            3,
            "pairs.csv: line 1: expected x, y and z of a point",
        ),
        ("inside cube.obj none.csv", 3, "none.csv: "),
        (
            "inside cube.obj points.csv -o a.png",
            2,
            "must end in one of",
        ),
        ("inside cube.obj points.csv -o points.csv", 2, "is an input"),
        (
            "inside cube.obj points.csv -o a.csv --format npy",
            2,
            "--format is for standard output",
        ),
    ] {
        lab.fails(arguments, code, words);
    }
}
