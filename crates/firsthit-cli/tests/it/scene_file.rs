//! Scene files: what they ask for is made, and the command line has the last word.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{ABOVE, Arrays, Lab};

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// A camera that sees the square and a ball, lit from the side.
const SCENE: &str = "[camera]\nposition = [0, -6, 3]\nlook_at = [0, 0, 0.25]\nfov = 30\ncolumns = 32\nrows = 24\n\
    [[objects]]\nfile = 'square.ply'\n\
    [[objects]]\nshape = 'sphere'\ncenter = [0.25, 0, 0.5]\nradius = 0.5\ncolor = [0.5, 0.25, 0.125]\n\
    [[lights]]\nkind = 'directional'\ndirection = [1, 0.5, -1]\ncolor = [0.5, 0.5, 0.5]\n\
    [background]\ncolor = [0.25, 0.5, 0.75]\n\
    [shading]\nambient = [0.125, 0.125, 0.125]\n";

fn with_scene() -> Lab {
    let lab = Lab::with_square();
    lab.write("scene.toml", SCENE);
    lab
}

/// The arrays that a scene and options give.
fn made(lab: &Lab, scene: &str, options: &str) -> Arrays {
    lab.write("made.toml", scene);
    let channels = "--channels color,t,object";
    let outcome = lab.ok(&format!("render made.toml -q -o made.npz {channels} {options}"));
    assert_eq!(outcome.stderr, "", "{options}");
    lab.npz("made.npz")
}

#[test]
fn the_examples_make_the_pictures_of_the_documentation() {
    let lab = Lab::new();
    let mut pictures = Vec::new();
    for entry in fs::read_dir(docs().join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.extension() == Some("png".as_ref()) {
            pictures.push(name);
        } else {
            fs::copy(&path, lab.path(&name)).unwrap();
        }
    }
    for name in lab.names() {
        if Path::new(&name).extension() == Some("toml".as_ref()) {
            lab.ok(&format!("render --quiet {name}"));
        }
    }
    assert!(pictures.len() >= 9, "{pictures:?}");
    for name in pictures {
        let made = lab.png(&name);
        fs::copy(docs().join("scenes").join(&name), lab.path("committed.png")).unwrap();
        assert!(made == lab.png("committed.png"), "{name}: render docs/scenes again");
    }
}

#[test]
fn a_scene_file_says_what_the_command_line_says() {
    let lab = with_scene();
    let by_flags = "--position 0,-6,3 --look-at 0,0,0.25 --up 0,0,1 --fov 30 --size 32x24 \
        --background 0.25,0.5,0.75 --ambient 0.125,0.125,0.125";
    let lights = "[[lights]]\nkind = 'point'\nposition = [1, -2, 4]\nintensity = [9, 9, 9]\n";
    let scene =
        SCENE.split("[[lights]]").next().unwrap().split("[[objects]]\nshape").next().unwrap();
    let told = format!(
        "{scene}{lights}[background]\ncolor = [0.25, 0.5, 0.75]\n[shading]\nambient = [0.125, 0.125, 0.125]\n"
    );
    let told = made(&lab, &told, "--light directional:0,1,-1");
    lab.ok(&format!("render square.ply -q -o flags.npz --channels color,t,object --light directional:0,1,-1 {by_flags}"));
    assert_eq!(told, lab.npz("flags.npz"));
}

/// Flags, and what in the scene says the same.
const REPLACEMENTS: &[(&str, &str, &str)] = &[
    ("--fov 50", "fov = 30", "fov = 50"),
    ("--fov-axis diagonal", "fov = 30", "fov = 30\nfov_axis = 'diagonal'"),
    ("--position 1,-5,2", "position = [0, -6, 3]", "position = [1, -5, 2]"),
    ("--aim 0,2,-1", "look_at = [0, 0, 0.25]", "aim = [0, 2, -1]"),
    ("--look-at 0,0,1", "look_at = [0, 0, 0.25]", "look_at = [0, 0, 1]"),
    ("--look-at auto", "look_at = [0, 0, 0.25]\n", ""),
    ("--up 1,0,1", "fov = 30", "fov = 30\nup = [1, 0, 1]"),
    ("--size 20x30", "columns = 32\nrows = 24", "columns = 20\nrows = 30"),
    (
        "--focal-length 2 --viewplane 2x1 --ray-start viewplane",
        "fov = 30",
        "focal_length = 2\nwidth = 2\nheight = 1\nray_start = 'viewplane'",
    ),
    ("--orthographic", "fov = 30", "projection = 'orthographic'"),
    (
        "--orthographic --viewplane 3x2",
        "fov = 30",
        "projection = 'orthographic'\nwidth = 3\nheight = 2",
    ),
    ("--background 1,0,0", "[0.25, 0.5, 0.75]", "[1, 0, 0]"),
    (
        "--sky 1,0,0:0,0,1",
        "[background]\ncolor = [0.25, 0.5, 0.75]",
        "[sky]\nhorizon = [1, 0, 0]\nzenith = [0, 0, 1]",
    ),
    ("--ambient 0,0,0", "[0.125, 0.125, 0.125]", "[0, 0, 0]"),
    ("--no-shadows", "[shading]", "[shading]\nshadows = false"),
    ("--samples 3", "[shading]", "[shading]\nsamples = 3"),
    ("--shader unlit", "ambient = [0.125, 0.125, 0.125]", "shader = 'unlit'"),
    ("--color 1,0,0", "file = 'square.ply'", "file = 'square.ply'\ncolor = [1, 0, 0]"),
];

#[test]
fn flags_replace_the_file_s_words_one_by_one() {
    let lab = with_scene();
    let all = made(&lab, SCENE, "");
    for &(options, word, instead) in REPLACEMENTS {
        assert!(SCENE.contains(word), "{word}");
        let by_flag = made(&lab, SCENE, options);
        assert_ne!(by_flag, all, "{options}");
        assert_eq!(by_flag, made(&lab, &SCENE.replace(word, instead), ""), "{options}");
    }
}

#[test]
fn outputs_go_beside_the_scene_file_and_o_goes_before_them() {
    let lab = with_scene();
    fs::create_dir(lab.path("deep")).unwrap();
    fs::copy(lab.path("square.ply"), lab.path("deep/square.ply")).unwrap();
    let outputs = "[[outputs]]\nfile = 'a.png'\n[[outputs]]\nfile = 'all.npz'\nchannels = ['z', 'object']\n\
        [[outputs]]\nfile = '{channel}.npy'\nchannels = ['z', 'object']\n";
    lab.write("deep/scene.toml", format!("{SCENE}{outputs}"));
    let before = lab.names();
    let outcome = lab.ok("render deep/scene.toml");
    assert!(
        outcome
            .stderr
            .starts_with("deep/a.png, deep/all.npz, deep/z.npy, deep/object.npy: 32 x 24 pixels"),
        "{}",
        outcome.stderr
    );
    assert_eq!(lab.names(), before);
    assert_eq!(lab.png("deep/a.png").0, 32);
    let all = lab.npz("deep/all.npz");
    let mut names: Vec<&String> = all.keys().collect();
    names.sort();
    assert_eq!(names, ["object", "z"]);
    assert_eq!(crate::support::array(&lab.read("deep/z.npy")), all["z"]);
    for name in ["a.png", "all.npz", "z.npy", "object.npy"] {
        fs::remove_file(lab.path("deep").join(name)).unwrap();
    }
    lab.ok("render deep/scene.toml -o b.png");
    assert!(lab.path("b.png").exists() && !lab.path("deep/a.png").exists());
    lab.write("deep/one.toml", format!("{SCENE}[[outputs]]\nfile = 'a.npz'\n"));
    lab.ok("render deep/one.toml --channels t,normal");
    let mut names: Vec<String> = lab.npz("deep/a.npz").into_keys().collect();
    names.sort();
    assert_eq!(names, ["normal", "t"]);
    // Nothing asked for: as for any other file.
    lab.ok("render scene.toml");
    assert!(lab.path("scene.png").exists());
}

#[test]
fn nothing_that_was_read_is_written_over() {
    let lab = Lab::with_square();
    lab.ok(&format!("render square.ply -q -o texture.png {ABOVE}"));
    lab.write("a.mtl", "newmtl m\nmap_Kd texture.png\n");
    lab.write("a.obj", "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    lab.write("scene.toml", "[[objects]]\nfile = 'a.obj'\n[[outputs]]\nfile = 'texture.png'\n");
    lab.fails(
        "render scene.toml",
        3,
        "scene.toml: texture.png is an input; it will not be overwritten",
    );
    lab.fails(
        "render a.obj -o texture.png",
        2,
        "texture.png is an input; it will not be overwritten",
    );
    lab.write("twice.toml", "[[outputs]]\nfile = 'x.png'\n[[outputs]]\nfile = './x.png'\n");
    lab.fails("render twice.toml", 3, "twice.toml: ./x.png is named twice as an output");
    lab.write("nowhere.toml", "[[outputs]]\nfile = 'nowhere/x.png'\n");
    lab.fails("render nowhere.toml", 4, "nowhere/x.png: the folder does not exist");
}

#[test]
fn mistakes_are_one_line_with_a_place_and_exit_code_3() {
    let lab = with_scene();
    lab.write("scene.toml", SCENE.replace("position", "  postion"));
    lab.fails(
        "render scene.toml",
        3,
        "scene.toml:2:3: unknown key `postion`, did you mean `position`?\n",
    );
    lab.fails("info scene.toml", 3, "scene.toml:2:3: ");
    lab.write("rays.csv", "0,0,5,0,0,-1\n");
    lab.fails("shoot scene.toml rays.csv", 3, "scene.toml:2:3: ");
    lab.write("scene.toml", SCENE.replace("square.ply", "missing.ply"));
    lab.fails("render scene.toml", 3, "scene.toml:8:8: 'missing.ply' is not read: ");
    lab.write("scene.toml", SCENE);
    lab.fails("render scene.toml --fov 20 --orthographic", 2, "--orthographic");
    lab.write("scene.toml", SCENE.replace("fov = 30", "projection = 'orthographic'"));
    lab.fails(
        "render scene.toml --fov 20",
        2,
        "--fov is for perspective cameras, and the file's is orthographic; use --viewplane",
    );
    lab.fails("render scene.toml --size 99999x99999", 5, "--size: 99999x99999 is over the limit");
    lab.write(
        "scene.toml",
        SCENE.replace("columns = 32", "columns = 99999").replace("rows = 24", "rows = 99999"),
    );
    lab.fails("render scene.toml", 5, "99999x99999 is over the limit");
}

#[test]
fn shoot_and_info_take_scene_files() {
    let lab = with_scene();
    let outcome = lab.pipe("shoot scene.toml -", b"0.25,0,5,0,0,-1\n9,9,5,0,0,-1\n");
    assert_eq!(outcome.text(), "t,object,primitive\n4,1,0\ninf,-1,-1\n");
    let text = lab.ok("info scene.toml");
    assert!(text.text().contains("  1  sphere  (sphere, 0 triangles)\n"), "{}", text.text());
}

#[test]
fn schema_prints_what_is_in_the_documentation() {
    let lab = Lab::new();
    for (command, file) in [("schema", "scene.schema.json"), ("schema --plan", "plan.schema.json")]
    {
        let printed = lab.ok(command).stdout;
        let committed = fs::read(docs().join(file)).unwrap();
        assert!(printed == committed, "run: firsthit {command} > docs/{file}");
    }
}

#[test]
fn the_command_line_overrides_how_a_scene_file_shows_colours_key_by_key() {
    let lab = with_scene();
    let shown = |of_file: &str, options: &str| {
        lab.write("shown.toml", format!("{SCENE}{of_file}"));
        lab.ok(&format!("render shown.toml -q -o shown.png {options}"));
        lab.read("shown.png")
    };
    let of_file = "[display]\nexposure = -1.5\ntone_map = 'agx'\n";
    let both = shown(of_file, "");
    assert!(both == shown("", "--exposure -1.5 --tone-map agx"));
    assert!(shown(of_file, "--exposure 2") == shown("", "--exposure 2 --tone-map agx"));
    assert!(shown(of_file, "--tone-map none") == shown("", "--exposure -1.5"));
    assert!(shown(of_file, "--tone-map none --exposure 0") == shown("", ""));
    // A built scene says so too.
    lab.write("shown.toml", format!("{SCENE}{of_file}"));
    lab.ok("build shown.toml -q");
    lab.ok("render shown.fhs -q -o built.png");
    assert!(lab.read("built.png") == both);
}
