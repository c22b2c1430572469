//! Models hold all that their formats say.

use std::fs;
use std::path::Path;

use firsthit::geometry::{Color, DVec2, DVec3, Ray, srgb_decode};
use firsthit::load::{LoadSettings, Loaded, load};
use firsthit::shape::PropertyOf;
use firsthit::shoot::{BruteForce, Cpu, Engine};
use firsthit::{Object, Scene};

/// Loads the first of some files.
fn read(files: &[(&str, &[u8])]) -> Loaded {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("room for a small file");
    }
    load(&folder.path().join(files[0].0), &LoadSettings::default()).expect("a right file")
}

fn names(model: &Loaded) -> Vec<&str> {
    model.world.objects.iter().map(Object::name).collect()
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn every_spelling_of_the_cuboid_is_the_same_solid() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata");
    for entry in fs::read_dir(folder).expect("testdata") {
        let path = entry.expect("testdata").path();
        if !path.to_string_lossy().contains("cube_") {
            continue;
        }
        let model = load(&path, &LoadSettings::default()).expect("a right file");
        let meshes = model.world.objects.iter().filter_map(Object::mesh);
        let count: usize = meshes.map(|mesh| mesh.triangles().len()).sum();
        assert_eq!(count, 12, "{}", path.display());
        let high = model.world.objects[0].mesh().unwrap().bounds().high;
        assert!((high - DVec3::new(1.14, 1.53, 0.73)).length() < 1e-6, "{}", path.display());
    }
}

#[test]
fn objects_come_in_the_order_of_their_first_faces() {
    let text = format!(
        "{CORNERS}f 1 2 3\no empty\ng b\nf 1 2 3 4\no a\nf 3 4 1\nf -4 -3 -2\ng b\nf 1 2 4\n"
    );
    let model = read(&[("scene.obj", text.as_bytes())]);
    assert_eq!(names(&model), ["scene", "b", "a"]);
    let b = model.world.objects[1].mesh().unwrap();
    assert_eq!(b.triangles(), [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
    assert_eq!([b.face(0), b.face(1), b.face(2)], [0, 0, 1]);
    assert!(std::sync::Arc::ptr_eq(
        b.positions(),
        model.world.objects[2].mesh().unwrap().positions()
    ));
}

#[test]
fn materials_colour_objects_and_faces() {
    let text = format!(
        "mtllib my colours.mtl\n{CORNERS}o one\nusemtl red\nf 1 2 3\no two\nf 1 2 3\nusemtl blue\nf 1 3 4\n"
    );
    let library = b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 0.5\n";
    let model = read(&[("a.obj", text.as_bytes()), ("my colours.mtl", library)]);
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert_eq!(model.world.objects[0].color(), Color::X);
    let two = &model.world.objects[1];
    let color = |triangle| two.material(triangle).unwrap().color;
    assert_eq!([color(0), color(1)], [Color::X, Color::new(0.0, 0.0, 0.5)]);
}

/// A PNG of 2 x 2 texels: red and green above blue and a transparent black.
fn four_texels() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().expect("in memory");
    let texels = [
        255, 0, 0, 255, 0, 255, 0, 255, //
        0, 0, 255, 255, 0, 0, 0, 0,
    ];
    writer.write_image_data(&texels).expect("in memory");
    writer.finish().expect("in memory");
    bytes
}

const TEXTURED: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    mtllib a.mtl\nusemtl m\nf 1/1 2/2 3/3 4/4\n";

/// The colour that a ray down onto (x, y) sees of a model, if any.
fn seen(model: &Loaded, x: f64, y: f64) -> Option<Color> {
    let scene = Scene::new(model.world.objects.clone()).expect("a small scene");
    let ray = Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
    let hit = Cpu::default().first_hit(&scene, &ray);
    let judged = BruteForce.first_hit(&scene, &ray);
    assert_eq!((hit.t, hit.primitive), (judged.t, judged.primitive));
    scene.interaction(&ray, &hit).map(|surface| surface.color())
}

#[test]
fn textures_colour_obj_files_upwards_and_map_d_cuts_holes() {
    let files = [
        ("a.obj", TEXTURED.as_bytes()),
        ("a.mtl", b"newmtl m\nKd 0.5 0.5 0.5\nmap_Kd my tex.png\nmap_d my tex.png\n"),
        ("my tex.png", &four_texels()),
    ];
    let model = read(&files);
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    // Texel centres: v runs upwards, so the first row is above.
    assert_eq!(seen(&model, 0.25, 0.75), Some(0.5 * Color::X));
    assert_eq!(seen(&model, 0.75, 0.75), Some(0.5 * Color::Y));
    assert_eq!(seen(&model, 0.25, 0.25), Some(0.5 * Color::Z));
    assert_eq!(seen(&model, 0.75, 0.25), None);
}

#[test]
fn a_texture_that_cannot_be_read_is_a_warning_and_a_flat_colour() {
    for name in ["missing.png", "../a.png", "/etc/passwd", "a.mtl", "a\\b.png"] {
        let library = format!("newmtl m\nKd 1 0 0\nmap_Kd {name}\n");
        let model = read(&[("a.obj", TEXTURED.as_bytes()), ("a.mtl", library.as_bytes())]);
        let [warning] = model.warnings.as_slice() else {
            panic!("{name}: {:?}", model.warnings);
        };
        let start = format!("a.mtl:3: texture '{name}' is not read: ");
        assert!(warning.contains(&start), "{warning}");
        assert_eq!(seen(&model, 0.25, 0.25), Some(Color::X));
    }
}

#[test]
fn ply_files_name_their_texture_in_a_comment() {
    let text = "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 4\n\
        property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";
    let model = read(&[("a.ply", text.as_bytes()), ("t.png", &four_texels())]);
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert_eq!(seen(&model, 0.25, 0.75), Some(Color::X));
    assert_eq!(seen(&model, 0.25, 0.25), Some(Color::Z));
}

#[test]
fn normals_and_texture_coordinates_are_those_of_the_corners() {
    let text = format!(
        "{CORNERS}vt 0.25 0.5\nvt 1 1\nvn 0 0 1\nvn 1 0 0\no full\nf 1/1/1 2/2/1 3/2/2 4/1/2\n\
         o half\nf 1/1/1 2/2/1 3/2\no wrong\nf 1//9 2//9 3//9\n"
    );
    let model = read(&[("a.obj", text.as_bytes())]);
    let full = model.world.objects[0].mesh().unwrap();
    assert_eq!(full.uv(0, DVec2::ZERO), Some(DVec2::new(0.25, 0.5)));
    assert_eq!(full.shading_normal(1, DVec2::Y), Some(DVec3::X));
    assert_eq!(model.world.objects[1].mesh().unwrap().shading_normal(0, DVec2::ZERO), None);
    assert_eq!(model.world.objects[2].mesh().unwrap().shading_normal(0, DVec2::ZERO), None);
    assert!(model.warnings[0].contains("normals"), "{:?}", model.warnings);
}

#[test]
fn colours_of_ply_vertices_and_faces_are_srgb() {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let list = "property list uchar int vertex_indices\n";
    let head = "ply\nformat ascii 1.0\n";
    #[expect(clippy::cast_possible_truncation, reason = "colours are float32")]
    let grey = Color::splat(f64::from(srgb_decode(128.0 / 255.0) as f32));
    let text = format!(
        "{head}element vertex 3\n{xyz}{rgb}element face 1\n{list}end_header\n\
         0 0 0 128 128 128\n1 0 0 128 128 128\n0 1 0 128 128 128\n3 0 1 2\n"
    );
    let model = read(&[("a.ply", text.as_bytes())]);
    assert_eq!(model.world.objects[0].mesh().unwrap().color(0, DVec2::ZERO), Some(grey));
    let text = format!(
        "{head}element vertex 4\n{xyz}element face 1\n{list}{rgb}end_header\n\
         0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 128 128 128\n"
    );
    let model = read(&[("a.ply", text.as_bytes())]);
    assert_eq!(model.world.objects[0].mesh().unwrap().color(1, DVec2::ZERO), Some(grey));
}

#[test]
fn strips_turn_every_other_triangle_and_restart() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 1 2 3\n";
    let model = read(&[("a.ply", text.as_bytes())]);
    assert_eq!(
        model.world.objects[0].mesh().unwrap().triangles(),
        [[0, 1, 2], [2, 1, 3], [1, 2, 3]]
    );
}

#[test]
fn an_stl_facet_must_have_three_vertices() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.stl");
    let text =
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n";
    fs::write(&path, text).expect("room for a small file");
    let error = load(&path, &LoadSettings::default()).expect_err("two vertices");
    assert!(error.to_string().ends_with(":7: a facet must have 3 vertices, this has 2"), "{error}");
}

#[test]
fn a_stray_line_before_the_elements_of_a_ply_file_is_a_comment() {
    let text = "ply\nformat ascii 1.0\nCreated by a program\nelement vertex 3\nproperty float x\n\
        property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n\
        end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let model = read(&[("a.ply", text.as_bytes())]);
    assert_eq!(model.world.objects[0].triangles(), 1);
    assert!(
        model.warnings[0]
            .ends_with("a.ply:3: this line of the header is not read: 'Created by a program'"),
        "{:?}",
        model.warnings
    );
}

#[test]
fn files_without_any_geometry_are_empty_scenes() {
    for (name, text) in [("a.obj", "o a\n"), ("a.ply", "ply\nformat ascii 1.0\nend_header\n")] {
        let model = read(&[(name, text.as_bytes())]);
        assert_eq!(model.world.objects.iter().map(Object::triangles).sum::<usize>(), 0);
        assert_eq!(model.warnings.len(), 1, "{:?}", model.warnings);
    }
}

/// A square of two triangles, an edge list between them, with numbers by name.
fn scan(format: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty uchar quality\n\
         property float y\nproperty float z\nproperty double time\nelement face 2\nproperty int label\n\
         property list uchar int vertex_indices\nproperty uchar red\nend_header\n"
    );
    let corners = [[0_u8, 0], [1, 0], [1, 1], [0, 1]];
    let mut bytes = header.into_bytes();
    for (k, [x, y]) in (0_u8..).zip(corners) {
        if format == "ascii" {
            bytes.extend(format!("{x} {} {y} 0 {}\n", 10 * k, 0.1 * f64::from(k)).bytes());
            continue;
        }
        bytes.extend(f32::from(x).to_le_bytes());
        bytes.push(10 * k);
        bytes.extend(f32::from(y).to_le_bytes());
        bytes.extend(0.0_f32.to_le_bytes());
        bytes.extend((0.1 * f64::from(k)).to_le_bytes());
    }
    for (label, ring, red) in [(-7_i32, [0_i32, 1, 2], 200_u8), (1 << 30, [0, 2, 3], 100)] {
        if format == "ascii" {
            let [a, b, c] = ring;
            bytes.extend(format!("{label} 3 {a} {b} {c} {red}\n").bytes());
            continue;
        }
        bytes.extend(label.to_le_bytes());
        bytes.push(3);
        bytes.extend(ring.iter().flat_map(|index| index.to_le_bytes()));
        bytes.push(red);
    }
    bytes
}

#[test]
fn numbers_of_ply_files_are_kept_by_name() {
    for format in ["ascii", "binary_little_endian"] {
        let model = read(&[("a.ply", &scan(format))]);
        assert!(model.warnings.is_empty(), "{:?}", model.warnings);
        let mesh = model.world.objects[0].mesh().expect("a mesh");
        let values = |of, name| {
            let values = mesh.property(of, name).expect("the property");
            (0..values.len()).map(|k| values.get(k).expect("a value")).collect::<Vec<_>>()
        };
        let (vertices, faces) = (PropertyOf::Vertices, PropertyOf::Faces);
        assert_eq!(values(vertices, "quality"), [0.0, 10.0, 20.0, 30.0]);
        let times: Vec<f64> = (0..4).map(|k| 0.1 * f64::from(k)).collect();
        assert_eq!(values(vertices, "time"), times);
        assert_eq!(values(faces, "label"), [-7.0, f64::from(1 << 30)]);
        // One of three levels makes no colour.
        assert_eq!(values(faces, "red"), [200.0, 100.0]);
        assert_eq!(mesh.properties().len(), 4);
        assert_eq!(mesh.property(faces, "quality"), None);
    }
}
