//! The nearest points of files.

use crate::support::{Lab, npy, rays_npy};

/// The square from -1 to 1 at height 0, of two triangles.
const NEAREST: &str = "\
distance,object,primitive,position_x,position_y,position_z,barycentric_0,barycentric_1,barycentric_2";

fn columns(line: &str) -> Vec<f64> {
    line.split(',').map(|x| x.parse().unwrap()).collect()
}

#[test]
fn points_come_from_any_kind_of_file() {
    let lab = Lab::with_square();
    lab.write("points.csv", "x,y,z\n0.5,0.25,2\n\n4,0.25,-4\nnan,0,0\n");
    let csv = lab.ok("nearest square.ply points.csv").text().to_owned();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], NEAREST);
    assert_eq!(columns(lines[1])[..2], [2.0, 0.0]);
    assert_eq!(columns(lines[1])[3..6], [0.5, 0.25, 0.0]);
    assert_eq!(columns(lines[2])[0], 5.0);
    assert_eq!(columns(lines[2])[3..6], [1.0, 0.25, 0.0]);
    assert_eq!(lines[3], "inf,-1,-1,nan,nan,nan,nan,nan,nan");
    let numbers = [0.5, 0.25, 2.0, 4.0, 0.25, -4.0, f64::NAN, 0.0, 0.0];
    let data: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    lab.write("points.npy", npy("<f8", false, "(3, 3)", &data));
    assert_eq!(lab.ok("nearest square.ply points.npy").text(), csv);
    let piped = lab.pipe("nearest square.ply -", b"0.5,0.25,2\n4,0.25,-4\nnan,0,0\n");
    assert_eq!(piped.text(), csv);
    lab.ok("nearest square.ply points.npy -o a.npz -o a.csv -o a.ply");
    assert_eq!(std::fs::read_to_string(lab.path("a.csv")).unwrap(), csv);
    assert!(lab.ok("info a.npz").text().contains("distance"));
    lab.write("none.csv", "");
    assert_eq!(lab.ok("nearest square.ply none.csv").text().trim_end(), NEAREST);
}

#[test]
fn each_channel_has_a_file_where_the_name_says_so() {
    let lab = Lab::with_square();
    lab.write("points.csv", "0.5,0.25,2\n");
    lab.ok("nearest square.ply points.csv -o {channel}.npy -o near.npz");
    for name in ["distance", "object", "primitive", "position", "barycentric"] {
        assert!(lab.path(&format!("{name}.npy")).is_file(), "{name}");
    }
    let csv = lab.ok("nearest square.ply points.csv");
    let piped = lab.ok("nearest square.ply points.csv -o - -o again.csv");
    assert_eq!(piped.text(), csv.text());
    let npz = lab.ok("nearest square.ply points.csv -o - --format npz");
    assert!(npz.stdout.starts_with(b"PK"));
    lab.fails("nearest square.ply points.csv --format npy", 2, "one channel");
}

#[test]
fn a_misspelt_first_line_is_no_header() {
    let lab = Lab::with_square();
    for line in ["0 0 0.5", "0;0;0.5", "-a,-b,-c", "0,0,O.5"] {
        lab.write("points.csv", format!("{line}\n0,0,1\n"));
        lab.fails("nearest square.ply points.csv", 3, "");
    }
    lab.write("points.csv", "x,y,z\n0,0,1\n");
    assert_eq!(lab.ok("nearest square.ply points.csv").text().lines().count(), 2);
}

#[test]
fn columns_of_points_are_taken_by_name() {
    let lab = Lab::with_square();
    lab.write("points.csv", "0.25,0.5,2\n");
    let expected = lab.ok("nearest square.ply points.csv").text().to_owned();
    for text in [
        "Z,y,X\n2,0.5,0.25\n",
        "name,x,y,z,\nfirst,0.25,0.5,2,\n",
        "position_x,position_y,position_z,t\n0.25,0.5,2,inf\n",
        "easting,northing,height\n0.25,0.5,2\n",
        "x,y,height\n0.25,0.5,2\n",
    ] {
        lab.write("points.csv", text);
        assert_eq!(lab.ok("nearest square.ply points.csv").text(), expected, "{text}");
    }
    for (text, words) in [
        ("y,x,height\n0,0,1\n", "a line that names the columns x, y and z"),
        ("x,y,z,x\n0,0,1,2\n", "two columns are named x"),
        ("id,a,b,c\n1,0,0,1\n", "got 'id' 'a' 'b' 'c'"),
        ("0;0\n", "got '0' '0'"),
    ] {
        lab.write("points.csv", text);
        lab.fails("nearest square.ply points.csv", 3, words);
    }
    lab.write("reversed.csv", "dz,dy,dx,oz,oy,ox\n-1,0,0,10,0,0\n");
    lab.write("normals.csv", "x,y,z,nx,ny,nz\n0,0,10,0,0,-1\n");
    lab.write("plain.csv", "0,0,10,0,0,-1\n");
    let [reversed, normals, plain] = ["reversed", "normals", "plain"].map(|name| {
        let hits = lab.ok(&format!("shoot square.ply {name}.csv"));
        hits.text().to_owned()
    });
    assert_eq!((&reversed, &normals), (&plain, &plain));
}

#[test]
fn several_and_those_within_a_radius() {
    let lab = Lab::with_square();
    lab.write("points.csv", "0,0,2\n0,0,3\n");
    let text = lab.ok("nearest square.ply points.csv --count 3 --radius 2");
    let lines: Vec<Vec<f64>> = text.text().lines().skip(1).map(columns).collect();
    let heads: Vec<&[f64]> = lines.iter().map(|line| &line[..4]).collect();
    let miss = |point: f64| [point, f64::INFINITY, -1.0, -1.0];
    assert_eq!(heads[0], [0.0, 2.0, 0.0, 0.0]);
    assert_eq!(heads[1], [0.0, 2.0, 0.0, 1.0]);
    assert_eq!(heads[2..], [miss(0.0), miss(1.0), miss(1.0), miss(1.0)]);
}

#[test]
fn distances_have_signs_where_there_is_an_inside() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    let bounds = lab.ok("info part.stl --json").text().to_owned();
    let bounds: serde_json::Value = serde_json::from_str(&bounds).unwrap();
    let end = |k: usize, axis: usize| bounds["bounds"][k][axis].as_f64().unwrap();
    let middle = |axis| 0.5 * (end(0, axis) + end(1, axis));
    let [x, y, z] = [0, 1, 2].map(middle);
    lab.write("points.csv", format!("{x},{y},{z}\n{x},{y},{}\n", end(1, 2) + 3.0));
    let text = lab.ok("nearest part.stl points.csv --signed");
    let distances: Vec<f64> = text.text().lines().skip(1).map(|line| columns(line)[0]).collect();
    assert_eq!(distances, [-0.5 * (end(1, 2) - end(0, 2)), 3.0]);
    let open = Lab::with_square();
    open.write("points.csv", "0,0,1\n");
    open.fails("nearest square.ply points.csv --signed", 2, "objects must be closed");
}

#[test]
fn what_is_no_point_is_refused() {
    let lab = Lab::with_square();
    lab.write("rays.npy", rays_npy(&[[0.0, 0.0, 1.0, 0.0, 0.0, -1.0]]));
    let expected = "points must be an array of the shape (n, 3), got [1, 6]";
    lab.fails("nearest square.ply rays.npy", 3, expected);
    lab.write("points.csv", "0,0,1\n");
    let near = |options: &str| format!("nearest square.ply points.csv {options}");
    lab.fails(&near("--count 0"), 2, "--count");
    lab.fails(&near("--radius -1"), 2, "--radius");
    lab.fails(&near("--signed --count 2"), 2, "cannot be used with");
    lab.fails(&near("-o points.csv"), 2, "is an input");
    lab.fails(&near("-o near.npy"), 2, "holds one channel of several");
}
