//! Built scenes: `firsthit build`, and the commands that take what it wrote.

use std::fmt::Write;

use serde_json::Value;

use crate::support::Lab;

/// A model with cameras and lights around it, in a scene file.
const SCENE: &str = "\
[camera]\nposition = [0.5, -4, 2]\nlook_at = [0.5, 0.5, 0]\ncolumns = 24\nrows = 16\n[[objects]]\nfile = \"square.ply\"\ncolor = \"teal\"\n\
rotate = { axis = [1, 0, 0], degrees = 60 }\n[[objects]]\nshape = \"sphere\"\ncenter = [0.5, 0, 0.5]\nradius = 0.25\n\
[[lights]]\nkind = \"point\"\nposition = [0, -3, 4]\nintensity = [9, 9, 9]\n[shading]\nsamples = 2\n";

#[test]
fn a_built_scene_is_taken_wherever_a_model_is() {
    let lab = Lab::with_square();
    lab.write("scene.toml", SCENE);
    lab.write("rays.csv", "0.25,0.25,9,0,0,-1\n0.5,0,9,0,0,-1\n9,9,9,0,0,-1\n");
    let said = lab.ok("build scene.toml -o city.fhs").stderr;
    assert!(said.starts_with("city.fhs: 2 triangles, "), "{said}");
    for file in ["scene.toml", "city.fhs"] {
        lab.ok(&format!("render {file} --channels color,t,object,normal -o {file}.npz -q"));
        let shot = lab.ok(&format!("shoot {file} rays.csv -q"));
        lab.write(&format!("{file}.csv"), shot.text());
        let colored = format!("render {file} --color red --view iso --size 20x20 -q");
        lab.ok(&format!("{colored} -o {file}.exr"));
    }
    lab.ok("diff scene.toml.npz city.fhs.npz");
    lab.ok("diff scene.toml.exr city.fhs.exr");
    assert_eq!(lab.read("scene.toml.csv"), lab.read("city.fhs.csv"));
    // Pictures say of what they are: the fingerprints are one.
    let scene = |name: &str| {
        let said = lab.ok(&format!("info {name} --json"));
        let said: Value = serde_json::from_str(said.text()).unwrap();
        said["metadata"]["scene"].clone()
    };
    assert_eq!(scene("scene.toml.npz"), scene("city.fhs.npz"));
    assert_ne!(scene("scene.toml.npz"), Value::Null);
}

/// A field of hills, as a PLY file in text.
fn hills(side: u32) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        side * side,
        2 * (side - 1) * (side - 1)
    );
    for k in 0..side * side {
        let height = k.wrapping_mul(2_654_435_761) >> 30;
        writeln!(text, "{} {} {height}", k % side, k / side).unwrap();
    }
    for k in (0..side * (side - 1)).filter(|k| k % side + 1 < side) {
        let (a, b) = (k, k + side);
        writeln!(text, "3 {a} {} {}\n3 {a} {} {b}", a + 1, b + 1, b + 1).unwrap();
    }
    text
}

#[test]
fn results_are_the_same_however_trees_are_built() {
    let lab = Lab::new();
    lab.write("hills.ply", hills(60));
    lab.write("rays.csv", "3.2,4.1,9,0,0,-1\n30,30,9,0.1,0.2,-1\n-9,9,9,0,0,-1\n");
    lab.write("points.csv", "3,4,9\n30,30,-5\n");
    for how in ["auto", "fast", "best"] {
        let build = format!("--build {how}");
        let asked = "--size 60x40 --channels color,t,primitive,ao --samples 2 -q";
        lab.ok(&format!("render hills.ply {build} {asked} -o {how}.npz"));
        lab.ok(&format!("render hills.ply {build} --size 60x40 -q -o {how}.png"));
        // Few rays for so many triangles: `auto` builds fast.
        lab.ok(&format!(
            "render hills.ply {build} --size 20x10 --shader lambert --samples 1 -q -o {how}.npy"
        ));
        let mut said = lab.ok(&format!("shoot hills.ply rays.csv {build} -q")).text().to_owned();
        said += lab.ok(&format!("nearest hills.ply points.csv {build} -q")).text();
        said += lab.ok(&format!("probe hills.ply --ray 3,4,9,0,0,-1 {build}")).text();
        lab.write(&format!("{how}.txt"), said);
    }
    for other in ["fast", "auto"] {
        for format in ["npz", "png", "npy", "txt"] {
            let (one, best) = (format!("{other}.{format}"), format!("best.{format}"));
            assert!(lab.read(&one) == lab.read(&best), "{one} differs");
        }
    }
    lab.fails("render hills.ply --build worst", 2, "worst");
    lab.ok("build hills.ply -q");
    let said = lab.ok("shoot hills.fhs rays.csv --build fast -q").stderr;
    assert!(said.contains("--build does nothing here"), "{said}");
}

#[test]
fn what_info_says_of_a_built_scene_is_what_it_says_of_its_source() {
    let lab = Lab::with("cube_quads_le.ply", "cube.ply");
    lab.ok("build cube.ply");
    assert_eq!(lab.names(), ["cube.fhs", "cube.ply"]);
    assert_eq!(lab.ok("info cube.fhs").text(), lab.ok("info cube.ply").text());
    // A scene may name it.
    lab.write("scene.toml", "[[objects]]\nfile = \"cube.fhs\"\n[[objects]]\nfile = \"cube.ply\"\n");
    let said = lab.ok("info scene.toml --json");
    let said: Value = serde_json::from_str(said.text()).unwrap();
    assert_eq!(said["objects"][0]["triangles"], said["objects"][1]["triangles"]);
    // Built again, it is the same file.
    lab.ok("build cube.fhs -o again.fhs");
    assert_eq!(lab.read("again.fhs"), lab.read("cube.fhs"));
}

#[test]
fn info_finds_damage_that_render_does_not_look_for() {
    let lab = Lab::with_square();
    lab.ok("build square.ply -o a.fhs -q");
    let mut bytes = lab.read("a.fhs");
    // A coordinate of a vertex, which stands in the mesh and in its tree.
    let one = 1.0_f32.to_le_bytes();
    let found = bytes.windows(4).rposition(|window| window == one).unwrap();
    bytes[found] ^= 1;
    lab.write("a.fhs", &bytes);
    lab.ok("render a.fhs --size 8x8 -q");
    lab.fails("info a.fhs", 3, "the file is damaged: the checksum of this section does not match");
    lab.write("a.fhs", &bytes[..bytes.len() - 9]);
    lab.fails("render a.fhs", 3, "it is truncated, or has grown");
    lab.write("a.fhs", "solid");
    lab.fails("shoot a.fhs rays.csv", 3, "");
    lab.fails("render a.fhs", 3, "a.fhs @ byte 0: this is no built scene");
}

#[test]
fn build_writes_a_file_of_its_own_or_nothing() {
    let lab = Lab::with_square();
    lab.fails("build square.ply -o square.npz", 2, "must end in .fhs");
    lab.ok("build square.ply -q");
    lab.fails("build square.fhs", 2, "is an input; it will not be overwritten");
    lab.fails("build square.ply -o none/a.fhs", 4, "the folder does not exist");
    lab.fails("build missing.ply", 3, "missing.ply");
    assert_eq!(lab.names(), ["square.fhs", "square.ply"]);
    let said = lab.ok("build square.ply --json");
    let said: Value = serde_json::from_str(said.text()).unwrap();
    assert_eq!(said["outputs"][0]["file"], "square.fhs");
    assert_eq!((&said["objects"], &said["triangles"]), (&1.into(), &2.into()));
    assert_eq!(said["bytes"], lab.read("square.fhs").len());
}
