//! What the formats say arrives in the model.

use std::fs;
use std::path::Path;

use firsthit::geometry::{Color, DVec2, DVec3, srgb_decode};
use firsthit::io::{LoadSettings, Model, load};

/// Loads the first of some files.
fn read(files: &[(&str, &[u8])]) -> Model {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("room for a small file");
    }
    load(&folder.path().join(files[0].0), &LoadSettings::default()).expect("a right file")
}

fn names(model: &Model) -> Vec<&str> {
    model.parts.iter().map(|part| part.name.as_str()).collect()
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
        let meshes = model.parts.iter().map(|part| &part.mesh);
        let count: usize = meshes.map(|mesh| mesh.triangles().len()).sum();
        assert_eq!(count, 12, "{}", path.display());
        let high = model.parts[0].mesh.bounds().high;
        assert!(
            (high - DVec3::new(1.14, 1.53, 0.73)).length() < 1e-6,
            "{}",
            path.display()
        );
    }
}

#[test]
fn objects_come_in_the_order_of_their_first_faces() {
    let text = format!(
        "{CORNERS}f 1 2 3\no empty\ng b\nf 1 2 3 4\no a\nf 3 4 1\nf -4 -3 -2\ng b\nf 1 2 4\n"
    );
    let model = read(&[("scene.obj", text.as_bytes())]);
    assert_eq!(names(&model), ["scene", "b", "a"]);
    let b = &model.parts[1].mesh;
    assert_eq!(b.triangles(), [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
    assert_eq!([b.face(0), b.face(1), b.face(2)], [0, 0, 1]);
    assert!(std::sync::Arc::ptr_eq(
        b.positions(),
        model.parts[2].mesh.positions()
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
    assert_eq!(model.parts[0].color, Some(Color::X));
    let two = &model.parts[1].mesh;
    assert_eq!(two.color(0, DVec2::ZERO), Some(Color::X));
    assert_eq!(two.color(1, DVec2::ZERO), Some(Color::new(0.0, 0.0, 0.5)));
}

#[test]
fn normals_and_texture_coordinates_are_those_of_the_corners() {
    let text = format!(
        "{CORNERS}vt 0.25 0.5\nvt 1 1\nvn 0 0 1\nvn 1 0 0\no full\nf 1/1/1 2/2/1 3/2/2 4/1/2\n\
         o half\nf 1/1/1 2/2/1 3/2\no wrong\nf 1//9 2//9 3//9\n"
    );
    let model = read(&[("a.obj", text.as_bytes())]);
    let full = &model.parts[0].mesh;
    assert_eq!(full.uv(0, DVec2::ZERO), Some(DVec2::new(0.25, 0.5)));
    assert_eq!(full.shading_normal(1, DVec2::Y), Some(DVec3::X));
    assert_eq!(model.parts[1].mesh.shading_normal(0, DVec2::ZERO), None);
    assert_eq!(model.parts[2].mesh.shading_normal(0, DVec2::ZERO), None);
    assert!(
        model.warnings[0].contains("normals"),
        "{:?}",
        model.warnings
    );
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
    assert_eq!(model.parts[0].mesh.color(0, DVec2::ZERO), Some(grey));
    let text = format!(
        "{head}element vertex 4\n{xyz}element face 1\n{list}{rgb}end_header\n\
         0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 128 128 128\n"
    );
    let model = read(&[("a.ply", text.as_bytes())]);
    assert_eq!(model.parts[0].mesh.color(1, DVec2::ZERO), Some(grey));
}

#[test]
fn strips_turn_every_other_triangle_and_restart() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 1 2 3\n";
    let model = read(&[("a.ply", text.as_bytes())]);
    assert_eq!(
        model.parts[0].mesh.triangles(),
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
    assert!(
        error
            .to_string()
            .ends_with(":7: a facet must have 3 vertices, this has 2"),
        "{error}"
    );
}
