//! Lines along edges.

use crate::support::{ABOVE, Lab};

/// The sum of a channel of one component.
fn sum(lab: &Lab, options: &str) -> f64 {
    lab.ok(&format!("render square.ply {ABOVE} -o a.npz {options}"));
    let edge = lab.npz("a.npz").remove("edge").unwrap();
    assert_eq!(edge.shape, [25, 33]);
    edge.values.iter().sum()
}

#[test]
fn lines_are_a_channel_and_over_the_colours() {
    let lab = Lab::with_square();
    // The square's sides are 6.6 pixels long; four corners are rounded off or overlap.
    let one = sum(&lab, "--channels edge");
    assert!((one - 4.0 * 6.6).abs() < 2.0, "{one}");
    let wide = sum(
        &lab,
        "--channels color,edge --edges 2 --edge-color red --shader unlit --color 0,0,1 --background 0,1,0 --samples 1",
    );
    assert!((wide - 8.0 * 6.6).abs() < 6.0, "{wide}");
    let all = lab.npz("a.npz");
    for (pixel, covered) in all["edge"].values.iter().enumerate() {
        let [red, green, blue] = [0, 1, 2].map(|k| all["color"].values[3 * pixel + k]);
        assert!((red - covered).abs() < 1e-6);
        assert!((red + green + blue - 1.0).abs() < 1e-6);
    }
    assert!(sum(&lab, "--channels edge --edge-kinds object,crease") == one);
    assert_eq!(sum(&lab, "--channels edge --edge-kinds crease"), 0.0);
    assert!(sum(&lab, "--channels edge --edge-kinds crease --wireframe") == one);
}

#[test]
fn a_scene_file_says_which_lines_and_options_say_otherwise() {
    let lab = Lab::with_square();
    lab.write(
        "a.toml",
        "[edges]\nwidth = 2\nkinds = [\"crease\"]\n[[objects]]\nfile = \"square.ply\"\n",
    );
    let sum = |file: &str, options: &str| {
        lab.ok(&format!("render {file} {ABOVE} -o a.npz --channels edge {options}"));
        lab.npz("a.npz").remove("edge").unwrap().values.iter().sum::<f64>()
    };
    assert_eq!(sum("a.toml", ""), 0.0);
    let boundary = sum("a.toml", "--edge-kinds boundary");
    assert_eq!(boundary, sum("square.ply", "--edges 2"));
    assert_ne!(boundary, sum("a.toml", "--edge-kinds boundary --edges 1"));
    lab.ok("build a.toml -o a.fhs");
    assert_eq!(sum("a.fhs", "--edge-kinds boundary"), boundary);
}

#[test]
fn a_line_behind_something_is_dashed_on_request() {
    let lab = Lab::with("cube_quads_ascii.ply", "cube.ply");
    let sum = |options: &str| {
        lab.ok(&format!("render cube.ply --size 100x100 -o a.npz --channels edge {options}"));
        lab.npz("a.npz").remove("edge").unwrap().values.iter().sum::<f64>()
    };
    let [seen, few, many] = ["", "--hidden-edges=1,9", "--hidden-edges"].map(sum);
    assert!(seen + 5.0 < few && few + 5.0 < many, "{seen} {few} {many}");
}

#[test]
fn options_that_do_nothing_are_told() {
    let lab = Lab::with_square();
    for (options, words) in [
        (
            "--channels z --edges 1",
            "--edges does nothing without color or edge among the --channels",
        ),
        ("--channels z --wireframe", "--wireframe does nothing without color or edge"),
        ("--channels edge --edge-color red", "--edge-color does nothing without color among"),
        (
            "--edge-kinds object --edge-angle 3",
            "--edge-angle does nothing without crease among the --edge-kinds",
        ),
        // Another option that does nothing hides nothing.
        (
            "--channels edge --edge-kinds object --edge-angle 3 --light auto",
            "--edge-angle does nothing without crease",
        ),
    ] {
        let outcome = lab.ok(&format!("render square.ply --size 8x8 {options}"));
        assert!(outcome.stderr.contains(words), "{options}: {}", outcome.stderr);
    }
    let fine = lab.ok("render square.ply --size 8x8 --edges 1.5 --edge-angle 3 --hidden-edges");
    assert!(!fine.stderr.contains("does nothing"), "{}", fine.stderr);
}

/// There was no way to do without them.
#[test]
fn the_file_s_lines_can_be_left_out() {
    let lab = Lab::with_square();
    let object = "[[objects]]\nfile = \"square.ply\"\n";
    lab.write("plain.toml", object);
    lab.write("lines.toml", format!("[edges]\nwidth = 3\n{object}"));
    let colors = |file: &str, options: &str| {
        lab.ok(&format!("render {file} {ABOVE} -o a.npz {options}"));
        lab.npz("a.npz").remove("color").unwrap()
    };
    let plain = colors("plain.toml", "");
    assert!(colors("lines.toml", "") != plain);
    assert!(colors("lines.toml", "--no-edges") == plain);
    lab.fails("render lines.toml --no-edges --edge-color red", 2, "cannot be used with");
    let idle = lab.ok("render lines.toml --size 8x8 --channels t --no-edges");
    assert!(
        idle.stderr.contains("--no-edges does nothing without color or edge"),
        "{}",
        idle.stderr
    );
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let lab = Lab::with_square();
    for (options, words) in [
        ("--edges 0", "a number of pixels above 0, up to 1000"),
        ("--edges 1001", "a number of pixels above 0, up to 1000"),
        ("--edge-angle 181", "a number of degrees from 0 to 180"),
        ("--edge-kinds ridge", "some of silhouette, crease, boundary, object, material, wireframe"),
        ("--hidden-edges=3", "two numbers of pixels, 0.1 at least, such as 6,4"),
        ("--hidden-edges=3,0", "two numbers of pixels, 0.1 at least, such as 6,4"),
    ] {
        lab.fails(&format!("render square.ply {options}"), 2, words);
    }
}
