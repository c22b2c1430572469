//! Files that cannot be read or written, and files that must not be.

use std::fs;

use crate::support::{Lab, SQUARE};

#[test]
fn what_cannot_be_read_is_bad_input() {
    let lab = Lab::with_square();
    lab.write("broken.ply", &SQUARE[..40]);
    lab.write("truncated.ply", &SQUARE[..SQUARE.len() - 20]);
    lab.write("notes.txt", "hello");
    fs::create_dir(lab.path("folder.ply")).unwrap();
    for command in ["info", "render"] {
        for file in ["missing.ply", "broken.ply", "truncated.ply", "notes.txt", "folder.ply", "."] {
            lab.fails(&format!("{command} {file}"), 3, file);
        }
    }
    lab.fails("info notes.txt", 3, ".obj (OBJ), .ply (PLY), .stl (STL)");
}

#[cfg(unix)]
#[test]
fn control_characters_in_names_do_not_reach_the_terminal() {
    let lab = Lab::new();
    lab.fails("info \u{1b}[31mred.ply", 3, "\\u{1b}[31mred.ply");
    let outcome = lab.run("render x.ply --\u{1b}[31mred\u{7}");
    assert!(!outcome.stderr.trim_end().contains(char::is_control), "{}", outcome.stderr);
}

#[test]
fn an_output_of_no_known_kind_is_wrong_usage() {
    let lab = Lab::with_square();
    for name in ["a.jpg", "a.tif", "a", ".png", "-", "a.csv", "a.stl"] {
        let words = "must end in one of .png, .exr, .npy, .npz, .ply, .pcd";
        lab.fails(&format!("render square.ply -o {name}"), 2, words);
    }
    lab.fails("render square.ply -o a.png -o ./a.png", 2, "named twice");
    lab.fails("demo -o a.png -o a.png", 2, "named twice");
}

#[test]
fn an_output_that_cannot_be_written_is_known_before_the_work() {
    let lab = Lab::with_square();
    fs::create_dir(lab.path("folder.png")).unwrap();
    lab.write("old.png", "old");
    let mut permissions = fs::metadata(lab.path("old.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(lab.path("old.png"), permissions).unwrap();
    // It would take hours.
    let long = "demo --size 4000x4000 --samples 65536";
    lab.fails(&format!("{long} -o none/a.png"), 4, "none/a.png: the folder does not exist");
    lab.fails(&format!("{long} -o old.png"), 4, "old.png: the file is read-only");
    lab.fails(&format!("{long} -o folder.png"), 4, "folder.png: is a folder, not a file");
    lab.fails(&format!("{long} -o old.png/a.png"), 4, "old.png/a.png: ");
    lab.fails("shoot square.ply - -o none/a.csv", 4, "the folder does not exist");
    assert_eq!(lab.read("old.png"), b"old");
}

#[test]
fn too_many_pixels_are_a_limit() {
    let lab = Lab::with_square();
    for command in ["render square.ply", "demo", "render missing.ply"] {
        lab.fails(
            &format!("{command} --size 100000x100000"),
            5,
            "--size: 100000x100000 is over the limit",
        );
        lab.fails(&format!("{command} --size 9999999999x9999999999"), 5, "over the limit");
    }
}

#[cfg(unix)]
#[test]
fn inputs_are_not_overwritten_under_any_name() {
    let lab = Lab::with_square();
    let rays = "0,0,1,0,0,-1\n";
    lab.write("rays.csv", rays);
    // The picture of this name leads to the model.
    std::os::unix::fs::symlink("square.ply", lab.path("link.png")).unwrap();
    std::os::unix::fs::symlink("rays.csv", lab.path("link.csv")).unwrap();
    fs::create_dir(lab.path("folder")).unwrap();
    fs::hard_link(lab.path("rays.csv"), lab.path("second.csv")).unwrap();
    lab.fails("render square.ply -o link.png", 2, "link.png is an input");
    lab.fails("shoot square.ply rays.csv -o second.csv", 2, "second.csv is an input");
    lab.fails("shoot square.ply rays.csv -o link.csv", 2, "link.csv is an input");
    lab.fails("shoot square.ply link.csv -o rays.csv", 2, "rays.csv is an input");
    lab.fails("shoot square.ply rays.csv -o folder/../rays.csv", 2, "is an input");
    assert_eq!(lab.read("rays.csv"), rays.as_bytes());
    assert_eq!(lab.read("square.ply"), SQUARE.as_bytes());
}

#[test]
fn quiet_says_nothing() {
    let lab = Lab::with_square();
    lab.write("rays.csv", "0,0,1,0,0,-1\n");
    for arguments in [
        "render square.ply --size 32x24 --channels t -q",
        "shoot square.ply rays.csv -o hits.npz --quiet",
        "demo --size 16x10 --samples 1 --quiet",
    ] {
        let outcome = lab.ok(arguments);
        assert_eq!((outcome.stderr.as_str(), outcome.text()), ("", ""), "{arguments}");
    }
}

#[test]
fn verbose_has_a_line_for_each_step() {
    let lab = Lab::with_square();
    for (arguments, steps) in [
        (
            "render square.ply --size 32x24 --channels t -o t.npz -v",
            &["reading square.ply", "parsing square.ply", "building trees", "shooting"][..],
        ),
        (
            "-v build square.ply -o a.fhs",
            &[
                "reading square.ply",
                "parsing square.ply",
                "building trees",
                "computing checksums of a.fhs",
                "writing a.fhs",
            ],
        ),
        ("info a.fhs --verbose", &["comparing checksums of a.fhs", "opening a.fhs", "measuring"]),
        ("section a.fhs --normal 1,0,0 -v", &["opening a.fhs", "cutting"]),
    ] {
        let said = lab.ok(arguments).stderr;
        let told = said.lines().filter_map(|line| line.strip_prefix("firsthit: "));
        let told: Vec<&str> = told.filter_map(|line| line.split(": ").next()).collect();
        assert_eq!(told, steps, "{said}");
    }
    let lint = lab.run("lint a.fhs -v").stderr;
    assert!(lint.contains("firsthit: checking meshes: "), "{lint}");
    lab.fails("info a.fhs -q -v", 2, "cannot be used with");
}

/// With the file's own channels it was refused, and with others on the command line it was written
/// through the link.
#[cfg(unix)]
#[test]
fn no_output_of_a_scene_leaves_its_folder_whatever_the_channels() {
    let lab = Lab::with_square();
    fs::create_dir(lab.path("scene")).unwrap();
    fs::copy(lab.path("square.ply"), lab.path("scene/square.ply")).unwrap();
    std::os::unix::fs::symlink("../out.png", lab.path("scene/z.png")).unwrap();
    lab.write(
        "scene/a.toml",
        "[[objects]]\nfile = \"square.ply\"\n[[outputs]]\nfile = \"{channel}.png\"\n",
    );
    let words = "output must be in the folder of the scene file, got z.png: refused";
    lab.fails("render scene/a.toml --size 8x8 --channels z", 2, words);
    assert!(!lab.path("out.png").exists());
    lab.ok("render scene/a.toml --size 8x8 --channels t,object");
    assert!(lab.path("scene/t.png").exists() && lab.path("scene/object.png").exists());
}

/// Commands that read a file and would write over it: a file that the command line names, or one
/// that another file names.
#[test]
fn no_command_writes_over_what_it_reads() {
    let lab = Lab::with_square();
    let scene = "[[objects]]\nfile = \"square.ply\"\n";
    let texts = [
        ("s.toml", scene),
        ("rays.csv", "0,0,1,0,0,-1\n"),
        ("pairs.csv", "0,0,1,0,0,-1\n"),
        ("points.csv", "0,0,1\n"),
        ("pose.csv", "1 0 0 0 0 1 0 0 0 0 1 5\n"),
    ];
    for (name, text) in texts {
        lab.write(name, text);
    }
    let size = "--size 8x6 --samples 1";
    lab.ok(&format!("render square.ply {size} -o e.exr"));
    lab.ok(&format!("render square.ply {size} --channels color,position -o cloud.ply"));
    let before: Vec<(String, Vec<u8>)> =
        lab.names().into_iter().map(|name| (name.clone(), lab.read(&name))).collect();
    for (command, output) in [
        (format!("render square.ply --camera e.exr {size}"), "-o e.exr"),
        (format!("render s.toml {size}"), "-o square.ply"),
        (format!("render square.ply {size} --environment e.exr"), "-o e.exr"),
        (
            format!(
                "render square.ply {size} -o a.png --channels object --pose pose.csv --convention opencv --fov 40"
            ),
            "--legend pose.csv",
        ),
        ("shoot s.toml rays.csv".to_owned(), "-o square.ply"),
        ("shoot square.ply rays.csv".to_owned(), "-o rays.csv"),
        ("shoot square.ply points.csv --from 0,0,9".to_owned(), "-o points.csv"),
        ("nearest s.toml points.csv".to_owned(), "-o square.ply"),
        ("nearest s.toml cloud.ply".to_owned(), "-o cloud.ply"),
        ("nearest s.toml points.csv".to_owned(), "--cloud square.ply"),
        ("inside s.toml points.csv".to_owned(), "-o points.csv"),
        ("thickness s.toml points.csv".to_owned(), "-o points.csv"),
        ("visible s.toml pairs.csv".to_owned(), "-o pairs.csv"),
        ("lint s.toml".to_owned(), "-o square.ply"),
    ] {
        lab.fails(&format!("{command} {output}"), 2, "is an input");
    }
    for (name, content) in before {
        assert!(lab.read(&name) == content, "{name}");
    }
}
