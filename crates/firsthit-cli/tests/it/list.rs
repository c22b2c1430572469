//! Lists of questions: lines of sight, and thickness.

use serde_json::Value;

use crate::support::{Lab, array};

#[test]
fn pairs_go_in_and_what_sees_what_comes_out() {
    let lab = Lab::with_square();
    let pairs = "0.5,0.25,-1,0.5,0.25,1\n0.5,0.25,1,0.5,0.25,-1\n3,0,-1,3,0,1\n0,0,1,0.5,0.5,1\n0.5,0.25,0,0,0,1\n";
    let outcome = lab.pipe("visible square.ply -", pairs.as_bytes());
    assert_eq!(outcome.text(), "visible\n0\n0\n1\n1\n1\n");
    let said = "standard output: 5 pairs, 3 visible, ";
    assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
    lab.write("pairs.csv", pairs);
    let outcome = lab.ok("visible square.ply pairs.csv -o a.npy --json --hide 0");
    let said: Value = serde_json::from_str(outcome.text()).unwrap();
    assert_eq!((&said["pairs"], &said["visible"]), (&5.into(), &5.into()));
    assert_eq!(array(&lab.read("a.npy")).values, [1.0; 5]);
    lab.write("points.csv", "0,0,1\n");
    let words = "pairs of points must be one array of 6 columns, got columns: 3";
    lab.fails("visible square.ply points.csv", 3, words);
}

#[test]
fn points_go_in_and_thickness_comes_out() {
    let lab = Lab::with_square();
    let corners =
        "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 0 0 0.5\nv 4 0 0.5\nv 4 4 0.5\nv 0 4 0.5\n";
    let faces = "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n";
    lab.write("plate.obj", format!("{corners}{faces}"));
    let points = "x,y,z\n1,1.25,0.5\n1.5,1,-2\n-1,2,0.25\n";
    let outcome = lab.pipe("thickness plate.obj -", points.as_bytes());
    assert_eq!(outcome.text(), "thickness\n0.5\n0.5\n4\n");
    let said = "standard output: 3 points, 0.5 at the thinnest, near point 0 (1,1.25,0.5), ";
    assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
    let outcome = lab.pipe("thickness square.ply - --json", b"0,0.5,1\n");
    assert_eq!(outcome.text(), "thickness\ninf\n");
    let said: Value = serde_json::from_str(&outcome.stderr).unwrap();
    assert_eq!((&said["points"], &said["least"]), (&1.into(), &Value::Null));
    let none = lab.pipe("thickness square.ply -", b"0,0.5,1\n");
    assert!(none.stderr.contains("1 point, nothing behind any, "), "{}", none.stderr);
    let far = "warning: every point is farther from the model than its own size";
    let said = |points: &[u8]| lab.pipe("thickness plate.obj -", points).stderr;
    assert!(said(b"9,4,4\n4,4,-5\n").contains(far));
    assert!(!said(b"9,4,4\n4,4,-3\n").contains(far));
    let nowhere = lab.pipe("thickness square.ply - --hide 0", b"0,0.5,1\n");
    assert_eq!(nowhere.text(), "thickness\nnan\n");
}
