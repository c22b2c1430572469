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
    assert!(outcome.stderr.contains("standard output: 3 points, 2 inside, "));
    lab.write("points.csv", POINTS);
    let outcome = lab.ok("inside cube.obj points.csv -o a.npy -o a.npz -o a.csv --json");
    let said: Value = serde_json::from_str(outcome.text()).unwrap();
    assert_eq!((&said["points"], &said["inside"]), (&3.into(), &2.into()));
    assert_eq!(said["rules"], serde_json::json!(["nonzero"]));
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
        ("inside cube.obj pairs.csv", 3, "pairs.csv: line 1: expected x, y and z of a point"),
        ("inside cube.obj none.csv", 3, "none.csv: "),
        ("inside cube.obj points.csv -o a.png", 2, "must end in one of"),
        ("inside cube.obj points.csv -o points.csv", 2, "is an input"),
        ("inside cube.obj points.csv -o a.csv --format npy", 2, "--format is for standard output"),
    ] {
        lab.fails(arguments, code, words);
    }
}

/// Two boxes in one mesh: what they have in common is inside, or by parity it is not; in every
/// command.
#[test]
fn the_rule_is_the_same_for_every_command() {
    let lab = Lab::new();
    let mut text = String::new();
    for (low, high) in [(["0", "0", "0"], ["2"; 3]), (["1", "0", "0"], ["3", "2", "2"])] {
        for k in 0..8 {
            let pick = |axis: usize| {
                if k >> axis & 1 == 1 { high[axis] } else { low[axis] }
            };
            text.push_str(&["v", pick(0), pick(1), pick(2), "\n"].join(" "));
        }
    }
    for first in [0, 8] {
        for face in
            [[1, 3, 4, 2], [1, 2, 6, 5], [2, 4, 8, 6], [4, 3, 7, 8], [3, 1, 5, 7], [5, 6, 8, 7]]
        {
            let corners = face.map(|k: i32| (k + first).to_string());
            text.push_str(&["f ", &corners.join(" "), "\n"].concat());
        }
    }
    lab.write("boxes.obj", text);
    lab.write("common.csv", "1.5,0.875,1.25\n");
    lab.write("side.csv", "0,0.875,1.25\n");
    let said = |command: &str| lab.ok(command).text().to_owned();
    let nonzero = ["1", "-0.5", "3", "6.0"];
    let parity = ["0", "0.5", "1", "4.0"];
    for (rule, wanted) in [("", nonzero), ("--rule nonzero", nonzero), ("--rule parity", parity)] {
        let lines = [
            said(&format!("inside boxes.obj common.csv {rule}")),
            said(&format!("nearest boxes.obj common.csv --signed {rule}")),
            said(&format!("thickness boxes.obj side.csv {rule}")),
        ];
        for (text, wanted) in lines.iter().zip(wanted) {
            let answer = text.lines().nth(1).unwrap();
            assert_eq!(answer.split(',').next().unwrap(), wanted, "{rule}: {text}");
        }
        let section = format!("section boxes.obj --origin 0,0,1 --normal 0,0,1 --json {rule}");
        let section: Value = serde_json::from_slice(&lab.ok(&section).stdout).unwrap();
        assert_eq!(section["area"].to_string(), wanted[3], "{rule}");
    }
    lab.fails("inside boxes.obj common.csv --rule evenodd", 2, "nonzero, parity");
    lab.fails("nearest boxes.obj common.csv --rule parity", 2, "--signed");
}
