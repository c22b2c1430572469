//! Points from clouds, and clouds with what was found of them.

use serde_json::Value;

use crate::support::{ABOVE, Lab, array, npy};

/// A cube from 0 to 1.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n";

fn with_cube() -> Lab {
    let lab = Lab::with_square();
    lab.write("cube.obj", CUBE);
    lab
}

#[test]
fn a_model_or_a_sentence_is_no_list_of_points() {
    let lab = with_cube();
    lab.write("hello.csv", "hello world\n");
    lab.write("six.csv", "a rather long line,of,words,in,six,fields\n");
    for command in ["nearest", "inside", "thickness"] {
        for (points, words) in [
            ("hello.csv", "hello.csv: line 1: expected x, y and z of a point"),
            ("six.csv", "six.csv: line 1: expected x, y and z of a point"),
            ("cube.obj", "cube.obj: line 1: expected x, y and z of a point"),
        ] {
            lab.fails(&format!("{command} cube.obj {points}"), 3, words);
        }
    }
    for points in ["hello.csv", "six.csv", "cube.obj"] {
        lab.fails(&format!("visible cube.obj {points}"), 3, &format!("{points}: line 1: "));
        lab.fails(&format!("shoot cube.obj {points}"), 3, &format!("{points}: line 1: "));
        let from = format!("shoot cube.obj {points} --from 0,0,9");
        lab.fails(&from, 3, "line 1: expected x, y and z of a point");
    }
    let stl = Lab::with("cube_binary.stl", "part.stl");
    stl.fails("nearest part.stl part.stl", 3, "part.stl: neither text nor a PLY");
    stl.fails("visible part.stl part.stl", 3, "part.stl: ");
}

#[test]
fn outputs_of_ours_are_points() {
    let lab = Lab::with_square();
    let render = "--channels position,object";
    lab.ok(&format!("render square.ply {ABOVE} {render} -o a.ply -o a.pcd -o a.npz -o a.exr"));
    lab.ok(&format!("render square.ply {ABOVE} --channels position -o a.npy"));
    let hits = lab.npz("a.npz")["object"].values.iter().filter(|&&x| x == 0.0).count();
    assert!(hits > 10);
    for name in ["a.ply", "a.pcd", "a.npz", "a.exr", "a.npy"] {
        let csv = lab.ok(&format!("nearest square.ply {name}"));
        let found = csv.text().lines().skip(1).filter(|line| {
            let distance = line.split(',').next().and_then(|x| x.parse::<f64>().ok());
            distance.is_some_and(|distance| distance < 1e-6)
        });
        assert_eq!(found.count(), hits, "{name}");
    }
    lab.ok("shoot square.ply a.ply --from 0,0,5 --channels position,t,object -o shot.csv");
    let again = lab.ok("nearest square.ply shot.csv");
    assert_eq!(again.text().lines().count(), hits + 1);
    let shot = String::from_utf8(lab.read("shot.csv")).unwrap();
    for line in shot.lines().skip(1) {
        let t: f64 = line.split(',').nth(3).unwrap().parse().unwrap();
        assert!((t - 1.0).abs() < 1e-12, "{line}");
    }
}

#[test]
fn a_scan_beside_its_part_is_one_command() {
    let lab = with_cube();
    let points = "0.5 0.5 1.25 7\n0.5 0.5 0.75 8\n0.5 -0.5 0.5 9\n";
    lab.write("scan.xyz", points);
    let outcome = lab.ok("nearest cube.obj scan.xyz --signed --cloud out.ply --cloud out.csv");
    assert_eq!(outcome.text(), "");
    let said = "out.ply, out.csv: 3 points, 3 found, mean 0.166667, RMS 0.353553, 95 % within 0.5, all within 0.5, ";
    assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
    let csv = String::from_utf8(lab.read("out.csv")).unwrap();
    assert_eq!(
        csv,
        "position_x,position_y,position_z,column_3,distance\n\
        0.5,0.5,1.25,7,0.25\n0.5,0.5,0.75,8,-0.25\n0.5,-0.5,0.5,9,0.5\n"
    );
    // It is a cloud again: its distances are replaced.
    let outcome = lab.ok("nearest cube.obj out.ply --cloud again.csv --json");
    let said: Value = serde_json::from_str(outcome.text()).unwrap();
    assert_eq!(said["outputs"], serde_json::json!([{"file": "again.csv"}]));
    assert_eq!(said["distances"]["mean"].as_f64(), Some(1.0 / 3.0));
    assert_eq!(said["distances"]["count"], 3);
    assert_eq!(lab.read("again.csv"), csv.replace("-0.25", "0.25").as_bytes());
    // What is asked for beside goes where it was told to.
    let outcome = lab.ok("nearest cube.obj scan.xyz --cloud more.pcd -o -");
    assert_eq!(outcome.text().lines().count(), 4);
    lab.fails("nearest cube.obj scan.xyz --cloud a.npy", 2, "--cloud: a.npy holds one channel");
    lab.fails("nearest cube.obj scan.xyz --cloud a.ply -o a.ply", 2, "named twice");
    lab.fails("nearest cube.obj out.ply --cloud out.ply", 2, "out.ply is an input");
    lab.fails("nearest cube.obj scan.xyz --cloud a.ply --count 2", 2, "cannot be used with");
}

#[test]
fn colours_of_a_cloud_stay_as_they_are() {
    let lab = Lab::with_square();
    lab.ok(&format!(
        "render square.ply {ABOVE} --color 0.2,0.4,0.7 --channels position,color,normal -o a.ply"
    ));
    lab.ok("nearest square.ply a.ply --cloud b.ply");
    let diff = lab.run("diff a.ply b.ply --channels color,position,normal");
    assert_eq!(diff.code, 0, "{}{}", diff.text(), diff.stderr);
}

#[test]
fn a_sensor_sees_points_of_a_cloud() {
    let lab = Lab::with_square();
    lab.write("points.xyz", "0.5 0.25 1\n0.5 0.25 -1\n3 0 -1\n");
    let outcome = lab.ok("visible square.ply points.xyz --from 0.5,0.25,3");
    assert_eq!(outcome.text(), "visible\n1\n0\n1\n");
    assert!(outcome.stderr.contains("3 points, 2 visible, "), "{}", outcome.stderr);
    lab.fails("visible square.ply points.xyz", 3, "expected");
    let data: Vec<u8> = [0.5, 0.25, -1.0].iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
    lab.write("points.npy", npy("<f8", false, "(1, 3)", &data));
    lab.fails(
        "visible square.ply points.npy",
        3,
        "--from X,Y,Z is for points that are seen from one place",
    );
    lab.ok("shoot square.ply points.npy --from 0.5,0.25,3 --channels t -o t.npy");
    assert_eq!(array(&lab.read("t.npy")).values, [0.75]);
}

#[test]
fn a_mesh_gives_its_vertices_with_a_word_about_its_faces() {
    let lab = Lab::with_square();
    let outcome = lab.ok("nearest square.ply square.ply");
    assert_eq!(outcome.text().lines().count(), 5);
    let said =
        "warning: square.ply: 1 of the element face are not read: the points are the vertices";
    assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
}
