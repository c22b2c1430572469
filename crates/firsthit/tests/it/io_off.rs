//! OFF: every variant that people have, and files that attack.

use std::fmt::Write;
use std::path::Path;

use firsthit::geometry::{Color, DVec3, srgb_decode};
use firsthit::load::{LoadSettings, Loaded, load_bytes};
use firsthit::{Error, Result, Scene, shoot};

fn read(text: &[u8]) -> Result<Loaded> {
    load_bytes(Path::new("a.off"), text, &LoadSettings::default())
}

/// The colour that a ray down onto (x, y) sees.
fn seen(model: &Loaded, x: f64, y: f64) -> Color {
    let scene = Scene::new(model.world.objects.clone()).unwrap();
    let ray = firsthit::Ray::new(DVec3::new(x, y, 9.0), DVec3::NEG_Z);
    let hit = shoot(&scene, ray.origin, ray.direction);
    scene.interaction(&ray, &hit).unwrap().color()
}

const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

#[test]
fn every_spelling_of_a_square_is_the_same_two_triangles() {
    let face = "4 0 1 2 3";
    for text in [
        format!("OFF\n4 1 0\n{SQUARE}{face}\n"),
        format!("OFF\n4 1 4\n{SQUARE}{face}"),
        format!("OFF 4 1 0\n{SQUARE}{face}\n"),
        format!("OFF4 1 0\n{SQUARE}{face}\n"),
        format!("4 1 0\n{SQUARE}{face}\n"),
        format!("OFF\n4 1\n{SQUARE}{face}\n"),
        format!(
            "# by hand\nOFF # here\n\n4 1 0 # counts\n\n{SQUARE}\n# faces\n  {face}  # the only one\n"
        ),
        format!("OFF\r\n4 1 0\r\n{}{face}\r\n", SQUARE.replace('\n', "\r\n")),
        format!("OFF 4 1 0 {} {face}", SQUARE.replace('\n', " "))
            .replace("0 0 0 0 1", "0\n0 0 0\n1"),
        format!("4OFF\n4 1 0\n{}{face}\n", "0 0 0 2\n2 0 0 2\n2 2 0 2\n0 2 0 2\n"),
        format!("nOFF\n3\n4 1 0\n{SQUARE}{face}\n"),
        format!("\u{feff}OFF\n4 1 0\n{SQUARE}{face}\n"),
    ] {
        let model = read(text.as_bytes()).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(model.warnings.is_empty(), "{text}: {:?}", model.warnings);
        let mesh = model.world.objects[0].mesh().unwrap();
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]], "{text}");
        assert_eq!(mesh.bounds().high, DVec3::new(1.0, 1.0, 0.0), "{text}");
        assert_eq!(model.world.objects[0].name(), "a");
    }
}

#[test]
fn colours_count_to_255_or_to_one_and_are_srgb() {
    let half = srgb_decode(0.5);
    for (text, expected) in [
        (format!("OFF\n4 1 0\n{SQUARE}4 0 1 2 3 255 0 51\n"), Color::new(1.0, 0.0, srgb_decode(0.2))),
        (format!("OFF\n4 1 0\n{SQUARE}4 0 1 2 3 0.5 0 1.0\n"), Color::new(half, 0.0, 1.0)),
        (format!("OFF\n4 1 0\n{SQUARE}4 0 1 2 3 0.5 0 1.0 1\n"), Color::new(half, 0.0, 1.0)),
        ("COFF\n4 1 0\n0 0 0 255 0 51 255\n1 0 0 255 0 51 255\n1 1 0 255 0 51 255\n0 1 0 255 0 51 255\n4 0 1 2 3\n".into(),
            Color::new(1.0, 0.0, srgb_decode(0.2))),
        ("COFF\n4 1 0\n0 0 0 1 0 0.5\n1 0 0 1 0 0.5\n1 1 0 1 0 0.5\n0 1 0 1 0 0.5\n4 0 1 2 3\n".into(),
            Color::new(1.0, 0.0, half)),
        ("NCOFF\n4 1 0\n0 0 0 0 0 1 1 0 0 1\n1 0 0 0 0 1 1 0 0 1\n1 1 0 0 0 1 1 0 0 1\n0 1 0 0 0 1 1 0 0 1\n4 0 1 2 3\n".into(),
            Color::X),
    ] {
        let model = read(text.as_bytes()).unwrap();
        assert!(model.warnings.is_empty(), "{text}: {:?}", model.warnings);
        let color = seen(&model, 0.5, 0.25);
        assert!(color.abs_diff_eq(expected, 1e-6), "{text}: {color}");
    }
    // What is said to be a fraction and reaches 200 is not.
    let text = format!("OFF\n4 1 0\n{SQUARE}4 0 1 2 3 200.0 0 0\n");
    assert!(read(text.as_bytes()).unwrap().warnings[0].contains("from 0 to 255"));
}

#[test]
fn normals_and_texture_coordinates_are_those_of_the_vertices() {
    let text = b"STNOFF\n3 1 0\n0 0 0 0 0 2 0 0\n1 0 0 0 0 2 1 0\n0 1 0 0 0 2 0 1\n3 0 1 2\n";
    let mesh = read(text).unwrap().world.objects[0].mesh().unwrap().clone();
    assert!(mesh.normals().is_some() && mesh.uvs().is_some());
}

#[test]
fn what_is_not_read_is_told() {
    for (face, said) in [
        ("4 0 1 2 3 7", "colour map"),
        ("4 0 1 2 3 1 2", "2 values after a face's corners"),
        ("4 0 1 2 3 1.0 0 0 0.5", "alpha 0.5"),
        ("2 0 1", "fewer than 3 corners"),
        ("4 0 1 2 3\n4 0 1 2 3", "lines after the last face"),
    ] {
        let text = format!("OFF\n4 1 0\n{SQUARE}{face}\n");
        let warnings = read(text.as_bytes()).unwrap().warnings;
        assert!(warnings.iter().any(|line| line.contains(said)), "{face}: {warnings:?}");
    }
    let text = "OFF\n3 1 0\n0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2\n";
    assert!(read(text.as_bytes()).unwrap().warnings[0].contains("does not declare"));
}

#[test]
fn hostile_off_files_are_refused_with_their_line_and_reserve_nothing() {
    for (text, said) in [
        ("OFF\n18446744073709551615 1 0\n", ":2: truncated"),
        ("OFF\n4 18446744073709551615 0\n", ":2: truncated"),
        ("OFF\n1099511627776 0 0\n0 0 0\n", ":2: truncated"),
        ("OFF\n-1 1 0\n", ":2: '-1' is not a count"),
        ("OFF\n99999999999999999999 1 0\n", "is not a count"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ":6: a vertex index"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", ":6: a vertex index"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 4294967296\n", ":6: a vertex index"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2\n", "which do not follow"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "the count of its corners"),
        ("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", ":4: the row has fewer"),
        ("OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", ":4: 'x' is not a number"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "truncated"),
        ("OFF BINARY\n\0\0\0\x08", "binary OFF is not read"),
        ("OFF", "truncated"),
        ("", "truncated"),
        ("solid x\n", "not an OFF file"),
        ("4nOFF\n7\n1 1 1\n", "3 dimensions"),
    ] {
        let error = read(text.as_bytes()).expect_err(text);
        assert!(matches!(error, Error::Parse { .. }), "{text}: {error}");
        assert!(error.to_string().contains(said), "{text}: {error}");
    }
    let text = "OFF\n3 1 0\n0 0 0\n1e300 0 0\nnan 1 0\n3 0 1 2\n";
    let model = read(text.as_bytes()).unwrap();
    assert!(model.world.objects[0].mesh().unwrap().triangles().is_empty());
    assert!(model.warnings[0].contains("dropped: 1 triangle"), "{:?}", model.warnings);
}

#[test]
fn every_prefix_and_every_changed_byte_of_an_off_file_is_read_or_refused() {
    let text = "COFF # x\n4 2 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n1 1 0 9 9 9 9\n0 1 0 1 1 1 1\n3 0 1 2\n4 0 1 2 3 0.5 1 0\n";
    for end in 0..text.len() {
        drop(read(&text.as_bytes()[..end]));
    }
    for k in 0..text.len() {
        for byte in [0, b' ', b'\n', b'-', b'9', b'#', 0xff] {
            let mut changed = text.as_bytes().to_vec();
            changed[k] = byte;
            drop(read(&changed));
        }
    }
}

#[test]
fn a_face_of_65536_corners_takes_moments_and_memory_is_bounded() {
    let mut text = String::from("OFF\n65536 1 0\n");
    for k in 0..65_536 {
        let angle = f64::from(k) / 65_536.0 * std::f64::consts::TAU;
        writeln!(text, "{} {} 0", libm::cos(angle), libm::sin(angle)).unwrap();
    }
    let ring: Vec<String> = (0..65_536).map(|k: u32| k.to_string()).collect();
    writeln!(text, "65536 {}", ring.join(" ")).unwrap();
    let start = std::time::Instant::now();
    let model = read(text.as_bytes()).unwrap();
    assert!(start.elapsed().as_secs() < 20);
    assert_eq!(model.world.objects[0].mesh().unwrap().triangles().len(), 65_534);
    let settings = LoadSettings { max_memory: 1 << 20, ..LoadSettings::default() };
    let refused = load_bytes(Path::new("a.off"), text.as_bytes(), &settings);
    assert!(matches!(refused, Err(Error::TooLarge { .. })));
}
