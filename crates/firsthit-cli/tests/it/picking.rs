//! Which objects are there, and which sides of them.

use std::fmt::Write as _;

use crate::support::Lab;

/// Two cubes of one file, one on the other, of which a ray from above meets the tops at t = 1 and
/// 2, and the bottoms at 2 and 3.
fn tower(lab: &Lab) {
    let cube = |name: &str, z: f64, first: u32| {
        let mut text = format!("o {name}\n");
        for corner in 0..8_u32 {
            let [x, y, up] = [corner & 1, corner >> 1 & 1, corner >> 2].map(f64::from);
            writeln!(text, "v {x} {y} {}", z + up).unwrap();
        }
        for face in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]]
        {
            let [a, b, c, d] = face.map(|corner: u32| corner + first);
            writeln!(text, "f {a} {b} {c} {d}").unwrap();
        }
        text
    };
    lab.write("tower.obj", cube("lower", 0.0, 1) + &cube("upper", 1.0, 9));
    lab.write("rays.csv", "0.5,0.25,3,0,0,-1\n0.5,0.25,3,0,0,1\n");
}

fn hits(lab: &Lab, arguments: &str) -> Vec<String> {
    let outcome = lab.ok(&format!("shoot tower.obj rays.csv --channels t,object {arguments}"));
    outcome.text().lines().skip(1).map(str::to_owned).collect()
}

#[test]
fn hidden_objects_are_not_met_and_the_others_keep_their_identifiers() {
    let lab = Lab::new();
    tower(&lab);
    assert_eq!(hits(&lab, ""), ["1,1", "inf,-1"]);
    assert_eq!(hits(&lab, "--hide upper"), ["2,0", "inf,-1"]);
    assert_eq!(hits(&lab, "--hide 1"), ["2,0", "inf,-1"]);
    assert_eq!(hits(&lab, "--only lower"), ["2,0", "inf,-1"]);
    assert_eq!(hits(&lab, "--only upper"), ["1,1", "inf,-1"]);
    assert_eq!(hits(&lab, "--only upper --only lower --hide upper"), ["2,0", "inf,-1"]);
    assert_eq!(hits(&lab, "--hide upper --hide lower"), ["inf,-1", "inf,-1"]);
    lab.fails("shoot tower.obj rays.csv --hide middle", 2, "there is no object \"middle\"");
    // Beside the file's objects there is none.
    lab.fails("shoot tower.obj rays.csv --only 2", 2, "the 2 there are");
}

#[test]
fn what_is_hidden_is_there_for_no_command() {
    let lab = Lab::new();
    tower(&lab);
    lab.write("points.csv", "0.5,0.5,1.5\n");
    let inside =
        |arguments: &str| lab.ok(&format!("inside tower.obj points.csv {arguments}")).stdout;
    assert_ne!(inside(""), inside("--hide upper"));
    let outcome = lab.ok("nearest tower.obj points.csv --only 0");
    assert!(outcome.text().lines().nth(1).unwrap().starts_with("0.5,0,"), "{}", outcome.text());
    lab.ok("section tower.obj --origin 0,0,1.5 --normal 0,0,1 -o all.json");
    lab.ok("section tower.obj --origin 0,0,1.5 --normal 0,0,1 -o cut.json --hide upper");
    let polylines = |name: &str| {
        let text = lab.read(name);
        serde_json::from_slice::<serde_json::Value>(&text).unwrap()["polylines"]
            .as_array()
            .unwrap()
            .len()
    };
    assert_eq!((polylines("all.json"), polylines("cut.json")), (1, 0));
    lab.ok("render tower.obj --size 20x20 --view top -o all.npz --channels object");
    lab.ok("render tower.obj --size 20x20 --view top -o less.npz --channels object --hide upper");
    let seen = |name: &str| lab.npz(name)["object"].values.iter().copied().fold(-1.0, f64::max);
    assert_eq!(
        (seen("all.npz").to_bits(), seen("less.npz").to_bits()),
        (1.0_f64.to_bits(), 0.0_f64.to_bits())
    );
}

#[test]
fn rays_pass_through_a_culled_side() {
    let lab = Lab::new();
    tower(&lab);
    assert_eq!(hits(&lab, "--cull back"), ["1,1", "inf,-1"]);
    // The bottom of the upper cube, and the top of the lower one, are in one place.
    assert_eq!(hits(&lab, "--cull front"), ["2,1", "inf,-1"]);
    assert_eq!(hits(&lab, "--cull front --only lower"), ["3,0", "inf,-1"]);
    let all = lab.ok("shoot tower.obj rays.csv --all --channels t,object --cull back");
    assert_eq!(all.text(), "ray,t,object\n0,1,1\n0,2,0\n");
    // Line by line, too.
    let lines =
        lab.pipe("shoot tower.obj - --channels t,object --cull front", b"0.5,0.25,3,0,0,-1\n");
    assert_eq!(lines.text().lines().nth(1), Some("2,1"));
    lab.fails("shoot tower.obj rays.csv --cull both", 2, "front, back");
}

#[test]
fn a_camera_looks_through_one_side() {
    let lab = Lab::new();
    tower(&lab);
    let render = |name: &str, more: &str| {
        lab.ok(&format!("render tower.obj --size 30x20 --channels z,color -o {name}.npz {more}"));
    };
    render("plain", "");
    render("back", "--cull back");
    render("front", "--cull front");
    // From outside, nobody sees the backs of solids.
    lab.ok("diff plain.npz back.npz");
    assert_eq!(lab.run("diff plain.npz front.npz").code, 1);
    lab.fails("render tower.obj -o x.png --cull left", 2, "--cull");
}
