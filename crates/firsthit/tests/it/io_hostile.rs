//! Files that attack: each is an error or a warning with its place, never a panic, a hang or a
//! gigabyte.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use firsthit::load::{LoadSettings, Loaded, load};
use firsthit::{Error, Result};

const LOOSE: LoadSettings = LoadSettings {
    strict: false,
    max_memory: 8 << 30,
    max_texture: 16_384,
    variant: None,
    verify: false,
    resources: Vec::new(),
    scale: 1.0,
};

/// Loads a file of that name and content.
fn read(name: &str, content: &[u8]) -> Result<Loaded> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    fs::write(&path, content).expect("room for a small file");
    load(&path, &LOOSE)
}

/// The message of the error that a content must be, from the place on.
fn refusal(name: &str, content: &[u8]) -> String {
    let error = read(name, content).expect_err("hostile content");
    assert!(matches!(error, Error::Parse { .. }), "{error}");
    let message = error.to_string();
    let (_, rest) = message.split_once(name).expect("the file's name");
    rest.to_owned()
}

fn ply(format: &str, header: &str, body: &[u8]) -> Vec<u8> {
    let mut file = format!("ply\nformat {format} 1.0\n{header}end_header\n").into_bytes();
    file.extend_from_slice(body);
    file
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const LITTLE: &str = "binary_little_endian";

#[test]
fn huge_counts_reserve_nothing() {
    let huge = 1_u64 << 40;
    let vertices = format!("element vertex {huge}\n{XYZ}");
    assert!(refusal("a.ply", &ply(LITTLE, &vertices, b"0123")).contains("truncated"));
    assert!(refusal("a.ply", &ply("ascii", &vertices, b"0 1 2\n")).contains("truncated"));
    let faces = format!(
        "element vertex 0\n{XYZ}element face {huge}\nproperty list uint int vertex_indices\n"
    );
    assert!(refusal("a.ply", &ply(LITTLE, &faces, &[0xff; 64])).contains("truncated"));
    assert!(refusal("a.ply", &ply(LITTLE, "element vertex -1\n", b"")).contains("count from 0"));
    let mut stl = vec![0; 84];
    stl[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(refusal("a.stl", &stl).contains("the bytes end after 0"));
}

#[test]
fn rows_of_nothing_take_no_time() {
    let header = format!("element nothing {}\nelement vertex 1\n{XYZ}", u64::MAX);
    let model = read("a.ply", &ply("ascii", &header, b"1 2 3\n")).expect("odd, but right");
    assert_eq!(model.world.objects[0].mesh().unwrap().positions().len(), 1);
    read("a.ply", &ply(LITTLE, &header, &[0; 12])).expect("odd, but right");
}

#[test]
fn indices_must_name_a_vertex() {
    let header =
        format!("element vertex 3\n{XYZ}element face 1\nproperty list uchar int vertex_indices\n");
    for (face, place) in [("3 0 1 3", ":13"), ("3 0 1 -1", ":13"), ("-1", ":13"), ("3 0 1", ":13")]
    {
        let body = format!("0 0 0\n1 0 0\n0 1 0\n{face}\n");
        let refused = refusal("a.ply", &ply("ascii", &header, body.as_bytes()));
        assert!(refused.starts_with(place), "{face}: {refused}");
    }
    for face in ["0 1 2", "1 2 4", "1 2 -4", "1 2 99999999999999999999", "1 2 x", "1 2 3/1/1/1"] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {face}\n");
        assert!(refusal("a.obj", text.as_bytes()).starts_with(":4: "), "{face}");
    }
}

#[test]
fn forward_indices_are_checked_at_the_end() {
    assert!(read("a.obj", b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").is_ok());
    assert!(refusal("a.obj", b"f 1 2 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").starts_with(":1: "));
}

#[test]
fn coordinates_that_are_garbage_cost_their_triangles_only() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 0 -inf 0\nv 1e30 0 0\n\
        f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\n";
    let model = read("a.obj", text).expect("three bad triangles of four");
    assert_eq!(model.world.objects[0].mesh().unwrap().triangles().len(), 1);
    assert!(model.warnings[0].contains("3 triangles"), "{:?}", model.warnings);
    assert!(model.warnings[0].contains("triangle 1 of 'a'"), "{:?}", model.warnings);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.obj");
    fs::write(&path, text).expect("room for a small file");
    assert!(load(&path, &LoadSettings { strict: true, ..LOOSE }).is_err());
}

#[test]
fn material_libraries_outside_the_folder_are_not_opened() {
    for name in ["../../etc/passwd", "/etc/passwd", "file:///etc/passwd", "..\\b.mtl", "/dev/zero"]
    {
        let text = format!("mtllib {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let model = read("a.obj", text.as_bytes()).expect("a warning only");
        let [warning] = model.warnings.as_slice() else { panic!("{:?}", model.warnings) };
        assert!(warning.contains(":1: ") && warning.contains("refused"), "{warning}");
    }
}

#[test]
fn every_prefix_of_a_file_is_read_or_refused() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata");
    for entry in fs::read_dir(data).expect("testdata") {
        let path = entry.expect("testdata").path();
        let name = format!("a.{}", path.extension().unwrap_or_default().to_string_lossy());
        if name == "a.md" || path.is_dir() {
            continue;
        }
        let bytes = fs::read(&path).expect("testdata");
        for end in (0..bytes.len()).step_by(7) {
            let _ = read(&name, &bytes[..end]);
        }
    }
}

#[test]
fn ninety_thousand_objects_take_moments() {
    let mut text = String::from("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\n");
    for k in 0..90_000 {
        writeln!(text, "o name {k}\nusemtl m{k}\nf 1 2 3").expect("a string");
    }
    let start = std::time::Instant::now();
    let model = read("a.obj", text.as_bytes()).expect("many objects");
    assert_eq!(model.world.objects.len(), 90_000);
    assert!(start.elapsed().as_secs() < 60);
}

#[test]
fn colours_that_are_no_numbers_are_a_warning() {
    let colors = "property float red\nproperty float green\nproperty float blue\n";
    let header = format!(
        "element vertex 3\n{XYZ}{colors}element face 1\nproperty list uchar int vertex_indices\n"
    );
    let body = b"0 0 0 nan inf 1e300\n1 0 0 1 1 1\n0 1 0 -5 1 1\n3 0 1 2\n";
    let model = read("a.ply", &ply("ascii", &header, body)).expect("odd, but right");
    let mesh = model.world.objects[0].mesh().unwrap();
    let values = &mesh.colors().unwrap().values;
    assert_eq!(values[..], [[1.0; 3], [1.0; 3], [0.0, 1.0, 1.0]]);
    assert!(model.warnings[0].contains(": 2, the first at index 0;"), "{:?}", model.warnings);
}

#[test]
fn what_is_not_the_format_has_a_place_too() {
    let refused = refusal("a.obj", b"\x00\x01\x02 nothing\n");
    assert!(refused.starts_with(":1: not an OBJ file"), "{refused}");
    let refused = refusal("a.ply", &ply("ascii", "element a 0\n", b""));
    assert!(refused.starts_with(":4: no vertex element"), "{refused}");
}

#[test]
fn a_property_that_is_there_twice_is_a_warning() {
    let header = format!("element vertex 1\n{XYZ}property float x\n");
    let model = read("a.ply", &ply("ascii", &header, b"0 0 0 5\n")).expect("odd, but right");
    assert!(model.warnings[0].contains(":7: property 'x' is there twice"), "{:?}", model.warnings);
}
