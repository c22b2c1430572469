//! Colours by numbers.

use serde_json::{Value, json};

use crate::support::{ABOVE, Lab, SQUARE};

/// The square with a number at each corner: 0 at the left, 8 at the right.
fn lab() -> Lab {
    let lab = Lab::new();
    let heated = SQUARE
        .replace("property float z\n", "property float z\nproperty float heat\n")
        .replace("-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n", "-1 -1 0 0\n1 -1 0 8\n1 1 0 8\n-1 1 0 0\n");
    lab.write("a.ply", heated);
    lab
}

fn legend(lab: &Lab, file: &str) -> Value {
    let said = lab.ok(&format!("info {file} --json"));
    let said: Value = serde_json::from_str(said.text()).unwrap();
    said["metadata"]["colors"].clone()
}

#[test]
fn surfaces_get_the_colours_of_their_numbers_and_files_the_legend() {
    let lab = lab();
    lab.ok(&format!(
        "render a.ply {ABOVE} --shader unlit --samples 1 --color-by attribute:heat \
         --color-range 0,16"
    ));
    let (_, _, bytes) = lab.png("a.png");
    // In the middle heat is 4: a quarter of viridis, about its step 64 of 255.
    let middle = &bytes[3 * (12 * 33 + 16)..][..3];
    let is_close = |(&one, other): (&u8, u8)| one.abs_diff(other) <= 1;
    assert!(middle.iter().zip([59, 82, 139]).all(is_close), "{middle:?}");
    let expected = json!({
        "by": "attribute:heat", "map": "viridis", "range": [0.0, 16.0],
        "below": null, "above": null, "missing": null,
    });
    assert_eq!(legend(&lab, "a.png"), expected);
    lab.ok(&format!("render a.ply {ABOVE} -o b.png"));
    assert_eq!(legend(&lab, "b.png"), Value::Null);
}

#[test]
fn a_range_marks_what_is_outside() {
    let lab = lab();
    let large = ABOVE.replace("33x25", "330x250");
    lab.ok(&format!(
        "render a.ply {large} --shader unlit --samples 1 --color-by attribute:heat --color-map grey \
         --color-range 0,2 --color-above red"
    ));
    let (_, _, bytes) = lab.png("a.png");
    assert_eq!(bytes[3 * (125 * 330 + 165)..][..3], [255, 0, 0]);
    assert_eq!(legend(&lab, "a.png")["above"], json!([1.0, 0.0, 0.0]));
}

#[test]
fn a_scene_file_asks_for_colours_which_options_change() {
    let lab = lab();
    lab.write(
        "a.toml",
        "[[objects]]\nfile = \"a.ply\"\n[colors]\nby = \"attribute:heat\"\nmap = \"turbo\"\nrange = [0, 1]\n",
    );
    lab.ok("render a.toml --size 30x20");
    assert_eq!(legend(&lab, "a.png")["map"], "turbo");
    lab.ok("render a.toml --size 30x20 --color-map magma");
    let changed = legend(&lab, "a.png");
    assert_eq!((&changed["map"], &changed["range"]), (&json!("magma"), &json!([0.0, 1.0])));
    lab.ok("build a.toml");
    lab.ok("render a.fhs --size 30x20 -o built.png");
    assert_eq!(legend(&lab, "built.png")["map"], "turbo");
    lab.ok("render a.toml --size 30x20 --color-by height");
    assert_eq!(legend(&lab, "a.png")["map"], "viridis");
}

#[test]
fn what_makes_no_sense_is_refused_or_said() {
    let lab = lab();
    lab.fails("render a.ply --color-by heat", 2, "attribute:NAME");
    lab.fails("render a.ply --color-by attribute:cold", 2, "there are heat");
    lab.fails("render a.ply --color-map turbo", 2, "needs --color-by");
    lab.fails("render a.ply --color-by object --color-range 2,1", 2, "rise");
    let unranged = "render a.ply --color-by object --color-below red";
    lab.fails(unranged, 2, "needs --color-range");
    let idle = lab.ok("render a.ply --size 30x20 --shader xray --color-by object");
    assert!(idle.stderr.contains("--color-by does nothing with --shader xray"));
    let idle = lab.ok("render a.ply --size 30x20 --channels t --color-by object -o t.npy");
    assert!(idle.stderr.contains("--color-by does nothing without color"));
}
