//! The table beside a picture of objects.

use crate::support::Lab;

const TWO: &str = "[[objects]]\nname = \"left, \\\"red\\\"\"\nshape = \"sphere\"\ncenter = [-2, 0, 0]\nradius = 1\n\
    [[objects]]\nname = \"right\"\nshape = \"sphere\"\ncenter = [2, 0, 0]\nradius = 1\n\
    [[objects]]\nname = \"far away\"\nshape = \"sphere\"\ncenter = [0, 0, 900]\nradius = 1\n";

const CAMERA: &str = "--position 0,-10,0 --look-at 0,0,0 --up 0,0,1 --size 64x32";

#[test]
fn a_table_names_the_colours_of_the_picture_beside_it() {
    let lab = Lab::new();
    lab.write("two.toml", TWO);
    lab.ok(&format!("render two.toml {CAMERA} --channels object -o o.png --legend o.csv"));
    let (_, _, bytes) = lab.png("o.png");
    let table = lab.read("o.csv");
    let mut reader = csv::Reader::from_reader(&table[..]);
    assert_eq!(reader.headers().unwrap(), vec!["object", "name", "color", "pixels"]);
    let rows: Vec<Vec<String>> =
        reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect();
    let names: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(names, ["", "left, \"red\"", "right", "far away"]);
    assert_eq!(rows[0][..3], ["-1", "", "#000000"]);
    assert_eq!(rows[3][3], "0");
    let mut all = 0;
    for row in &rows {
        let seen = bytes
            .chunks_exact(3)
            .filter(|rgb| format!("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]) == row[2]);
        let seen = seen.count();
        assert_eq!(seen.to_string(), row[3], "{row:?}");
        all += seen;
    }
    assert_eq!(all, 64 * 32);
}

#[test]
fn a_table_may_be_json_and_must_be_of_a_picture_of_objects() {
    let lab = Lab::new();
    lab.write("two.toml", TWO);
    lab.ok(&format!(
        "render two.toml {CAMERA} --channels color,object -o a.npz --legend names.json"
    ));
    let table: serde_json::Value = serde_json::from_slice(&lab.read("names.json")).unwrap();
    assert_eq!(table[2]["name"], "right");
    assert_eq!(table[2]["object"], 1);
    for (options, words) in [
        ("--legend names.csv", "needs object among the --channels"),
        ("--channels object --legend names.txt", "must end in .csv or .json"),
        ("--channels object -o a.npz --legend none/x.csv", "the folder does not exist"),
    ] {
        let code = if words.contains("folder") { 4 } else { 2 };
        lab.fails(&format!("render two.toml {options}"), code, words);
    }
}
