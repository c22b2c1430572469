//! Pictures that nobody chose anything of: how they are seen, and what is said of it.

use std::path::Path;

use crate::support::{ABOVE, Lab, array};

/// How many rows and columns of a picture the model reaches over, and how many there are.
fn reach(lab: &Lab, file: &str) -> ([usize; 2], [usize; 2]) {
    let object = array(&lab.read(file));
    let [rows, columns] = [0, 1].map(|k| usize::try_from(object.shape[k]).unwrap());
    let hit = |k: usize| object.values[k] >= 0.0;
    let row = |row: &usize| (0..columns).any(|column| hit(row * columns + column));
    let column = |column: &usize| (0..rows).any(|row| hit(row * columns + column));
    let reach = [(0..rows).filter(row).count(), (0..columns).filter(column).count()];
    (reach, [rows, columns])
}

#[test]
fn every_view_of_a_model_fills_the_picture() {
    for (testdata, name) in [
        ("cube_binary.stl", "part.stl"),
        ("prism_64gon.obj", "part.obj"),
        ("torus_draco.glb", "part.glb"),
    ] {
        let lab = Lab::with(testdata, name);
        for view in ["iso", "front", "back", "left", "right", "top", "bottom"] {
            for more in ["", "--orthographic", "--up 1,2,3"] {
                lab.ok(&format!(
                    "render {name} --view {view} {more} --size 64x48 --channels object -o o.npy"
                ));
                let ([down, across], [rows, columns]) = reach(&lab, "o.npy");
                assert!(
                    10 * down >= 6 * rows || 10 * across >= 6 * columns,
                    "{name} {view} {more}: {across} x {down}"
                );
            }
        }
        let small = "--size 64x48 --quiet";
        lab.ok(&format!("render {name} --view iso -o a.npy {small}"));
        lab.ok(&format!("render {name} -o b.npy {small}"));
        assert_eq!(lab.read("a.npy"), lab.read("b.npy"), "{name}");
    }
}

#[test]
fn whatever_is_guessed_is_said_with_the_option_that_says_otherwise() {
    let lab = Lab::with_square();
    let light = "automatic light (--light)";
    let ground = "automatic light (--light), a ground for shadows (--ground)";
    let catcher = "a ground for shadows (--ground)";
    let around = "automatic light (--light), no shadows of lights outside of the room (--light)";
    for (options, guessed) in [
        ("", Some(format!("up +z (--up), view iso (--view), {ground}"))),
        ("--view top", Some(format!("up +z (--up), {ground}"))),
        ("--view top --no-ground", Some(format!("up +z (--up), {light}"))),
        ("--up 0,1,0 --view top", Some(ground.into())),
        (
            "--up 0,1,0 --view top --light point:0,0,9",
            Some("some light from all around (--shader)".into()),
        ),
        ("--up 0,1,0 --view top --light point:0,0,9 --shader direct", None),
        ("--up 0,1,0 --view top --light sun", Some(catcher.into())),
        (
            "--up 0,1,0 --view top --shader lambert",
            Some("light over the shoulder (--light)".into()),
        ),
        ("--up 0,1,0 --view top --shader unlit", None),
        ("--up 0,1,0 --view top --channels z", None),
        ("--position 0,-1,5 --up 0,1,0", Some(format!("aim at the middle (--look-at), {light}"))),
        ("--aim 0,1,-5 --up 0,1,0", Some(format!("all in the picture (--position), {ground}"))),
        (
            "--projection equirectangular --up 0,1,0",
            Some(format!("from the middle (--position), view front (--view), {around}")),
        ),
        (
            "--projection equirectangular --up 0,1,0 --aim 0,0,-1",
            Some(format!("from the middle (--position), {around}")),
        ),
        (ABOVE, Some(ground.into())),
    ] {
        // What is guessed does not depend on the picture's size; ABOVE says it already.
        let size = if options == ABOVE { "" } else { "--size 40x30" };
        let line = format!("render square.ply --samples 1 -o x.npy {size} {options}");
        let said = lab.ok(&line).stderr;
        let told = said.split_once("; guessed: ").map(|(_, told)| told.trim());
        assert_eq!(told, guessed.as_deref(), "{options}: {said}");
    }
    let quiet = lab.ok("render square.ply --size 40x30 --quiet");
    assert!(quiet.stderr.is_empty());
}

#[test]
fn a_view_is_instead_of_a_place_or_an_aim() {
    let lab = Lab::with_square();
    for other in ["--position 1,2,3", "--aim 1,2,3", "--look-at auto"] {
        lab.fails(&format!("render square.ply --view top {other}"), 2, "--view");
    }
    lab.fails("render square.ply --view side", 2, "possible values: iso, front, back");
}

/// Of a camera of the file only the lens stays.
#[test]
fn a_view_takes_the_place_of_the_cameras_of_the_file() {
    let lab = Lab::with_square();
    lab.write(
        "scene.toml",
        "camera = { position = [0, 0, 90], aim = [0, 0, 1], up = [0, 1, 0], fov = 20 }\n\
         [[objects]]\nfile = \"square.ply\"\n",
    );
    lab.ok("render scene.toml --view top --size 64x48 --channels object -o o.npy");
    let ([down, _], [rows, _]) = reach(&lab, "o.npy");
    assert!(10 * down >= 9 * rows, "{down} of {rows}");
}

#[test]
fn colours_are_the_mean_of_four_points_and_of_sixteen_in_soft_light() {
    let lab = Lab::with_square();
    let made = |options: &str| {
        lab.ok(&format!("render square.ply -o made.npy --size 64x48 --quiet {options}"));
        lab.read("made.npy")
    };
    assert_eq!(made(""), made("--samples 16"));
    assert_ne!(made(""), made("--samples 4"));
    let hard = "--shader lambert";
    assert_eq!(made(hard), made(&format!("{hard} --samples 4")));
    assert_ne!(made(hard), made(&format!("{hard} --samples 1")));
}

/// The part of a picture's pixels whose brightness differs from the background's by less than a
/// tenth.
fn lost(lab: &Lab, color: &str) -> f64 {
    lab.ok(&format!("render part.stl --color {color} --size 64x48 --quiet"));
    let (_, _, bytes) = lab.png("part.png");
    let brightness = |pixel: &[u8]| pixel.iter().map(|&byte| f64::from(byte)).sum::<f64>() / 765.0;
    let background = brightness(&bytes[..3]);
    lab.ok("render part.stl --channels object -o o.npy --size 64x48 --quiet");
    let object = array(&lab.read("o.npy"));
    let pixels = bytes.chunks_exact(3).zip(&object.values);
    let hit: Vec<_> = pixels.filter(|&(_, &object)| object >= 0.0).collect();
    let lost = hit.iter().filter(|(pixel, _)| (brightness(pixel) - background).abs() < 0.1);
    lost.count() as f64 / hit.len() as f64
}

#[test]
fn white_and_black_models_stand_out_from_the_background() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    for color in ["1,1,1", "0.8,0.8,0.8", "0.6,0.6,0.6", "0.03,0.03,0.03", "0,0,0"] {
        let lost = lost(&lab, color);
        assert!(lost < 0.5, "{color}: {lost}");
    }
}

/// All are OBJ files: the bust and the bottle have z up, the bunny y as the convention says.
#[test]
#[ignore = "needs ../shared/refdata and ../shared/scenes"]
fn busts_and_bottles_stand_upright() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    for (file, up) in [
        ("scenes/models/nefertiti.obj", "+z"),
        ("scenes/models/stanford-bunny.obj", "+y"),
        ("refdata/public/real/tm/fuze.obj", "+z"),
        ("refdata/public/real/tm/teapot.stl", "+z"),
        ("refdata/public/real/tm/tube.obj", "+y"),
        ("refdata/public/generated/cube_quads_ascii.ply", "+z"),
    ] {
        let path = models.join(file);
        assert!(path.is_file(), "needs ../shared/{file} beside the clone");
        let lab = Lab::new();
        let mut command = lab.command("render --size 16x12 --samples 1 -o x.png");
        let output = command.arg(path).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(&format!("guessed: up {up} (--up)")), "{file}: {said}");
    }
}
