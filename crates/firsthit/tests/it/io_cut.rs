//! Files that end before their writer was done.

use std::fs;
use std::io::Write;
use std::path::Path;

use firsthit::Result;
use firsthit::load::{LoadSettings, Loaded, load};

/// Loads `name` from a folder with these files.
fn read(files: &[(&str, &[u8])], name: &str, strict: bool) -> Result<Loaded> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("room for a small file");
    }
    let settings = LoadSettings { strict, ..LoadSettings::default() };
    load(&folder.path().join(name), &settings)
}

/// The error about a file, or its warnings.
fn said(name: &str, content: &[u8]) -> String {
    match read(&[(name, content)], name, false) {
        Ok(model) => model.warnings.join("\n"),
        Err(error) => error.to_string(),
    }
}

const STL: &str = "solid a thing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
    vertex 0 1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\n\
    vertex 0 1 0\nendloop\nendfacet\nendsolid a thing\n";

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl red\n\
    f 1/1/1 2/1/1 3/1/1\n";

const MTL: &str = "newmtl red\nKa 0 0 0\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";

#[test]
fn an_ascii_stl_is_told_wherever_it_is_cut() {
    let whole = STL.find("endsolid").expect("an end") + "endsolid".len();
    for end in 1..whole {
        let said = said("a.stl", &STL.as_bytes()[..end]);
        assert!(!said.is_empty(), "{:?}", &STL[..end]);
    }
    for end in whole..=STL.len() {
        assert_eq!(said("a.stl", &STL.as_bytes()[..end]), "");
    }
    let (half, _) = STL.split_once("facet normal 0 0 1\nouter loop\nvertex 1").unwrap();
    let words = ":8: the file seems to be truncated: the solid that begins at line 1 has no endsolid; \
        facets read: 1";
    assert!(said("a.stl", half.as_bytes()).ends_with(words));
    let model = read(&[("a.stl", half.as_bytes())], "a.stl", false).expect("a warning only");
    assert_eq!(model.world.objects[0].triangles(), 1);
    let error = read(&[("a.stl", half.as_bytes())], "a.stl", true).expect_err("strict");
    assert!(error.to_string().ends_with(words), "{error}");
}

#[test]
fn a_solid_that_is_ended_hides_no_other_that_is_not() {
    let two = format!("{STL}{}", STL.replace("endsolid a thing\n", ""));
    assert!(said("a.stl", two.as_bytes()).contains("the solid that begins at line 17"));
    assert_eq!(said("a.stl", format!("{STL}{STL}").as_bytes()), "");
}

#[test]
fn an_ascii_ply_is_told_wherever_it_is_cut() {
    // Of the last number each digit is a number.
    for end in 1..PLY.len() - "2\n".len() {
        let said = said("a.ply", &PLY.as_bytes()[..end]);
        assert!(!said.is_empty(), "{:?}", &PLY[..end]);
    }
    assert_eq!(said("a.ply", PLY.trim_end().as_bytes()), "");
}

#[test]
fn what_an_obj_can_tell_of_being_cut_it_tells() {
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1 2 3\n";
    for (last, words) in [
        ("f 1", "this face has fewer than 3 corners: 'f 1'"),
        ("f 1/1/1 2/1/1 3/1", "the corners of this face are not of one form"),
        ("f 1/1 2/1 3/", "an index is missing after the slash"),
        ("v 0 0 1", "no face has this vertex"),
        ("vt 1 1", "no face has these texture coordinates"),
        ("vn 0 1 0", "no face has this normal"),
        ("usemtl re", "no face follows"),
        ("o thin", "no face follows"),
        ("use", "this is no statement"),
        ("f 1 2 \\", "the last line goes on, by its backslash"),
        ("f 1 2 \\\n", "the last line goes on, by its backslash"),
    ] {
        let text = format!("{start}{last}");
        let warnings = said("a.obj", text.as_bytes());
        let line = format!(":{}: the file seems to be truncated: ", 7);
        assert!(warnings.contains(&line) && warnings.contains(words), "{last}: {warnings}");
        let strict = read(&[("a.obj", text.as_bytes())], "a.obj", true);
        let error = strict.expect_err(last).to_string();
        assert!(error.contains(words), "{error}");
    }
    for last in ["v 0", "vn 0 1", "vt", "f 1 2 9", "v 0 0 -"] {
        let error = read(&[("a.obj", format!("{start}{last}").as_bytes())], "a.obj", false);
        let error = error.expect_err(last).to_string();
        assert!(error.contains(":7: "), "{error}");
    }
}

#[test]
fn what_a_material_library_can_tell_of_being_cut_it_tells() {
    for (last, words) in [
        ("newmtl gree", "nothing is said of this material"),
        ("newmtl green\nKd 0 1", "a number is missing"),
        ("newmtl green\nKd 0", "numbers are missing"),
        ("newmtl green\nmap_", "this is no statement"),
    ] {
        let text = format!("{MTL}{last}");
        let files = [("a.obj", OBJ.as_bytes()), ("a.mtl", text.as_bytes())];
        let model = read(&files, "a.obj", false).expect("warnings only");
        let warnings = model.warnings.join("\n");
        assert!(warnings.contains("a.mtl:") && warnings.contains(words), "{last}: {warnings}");
        let error = read(&files, "a.obj", true).expect_err(last).to_string();
        assert!(error.contains("a.mtl:") && error.contains(words), "{error}");
    }
}

#[test]
fn whole_files_without_a_last_line_break_are_silent() {
    // A vertex may come after the face that has it.
    let backwards = "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0";
    let grey = "newmtl red\nKd 0.5";
    for (name, obj, mtl) in [
        ("both", OBJ.trim_end(), MTL.trim_end()),
        ("grey", OBJ.trim_end(), grey),
        ("backwards", backwards, MTL),
        ("comment", &format!("{OBJ}# 3 vert")[..], "# Blender MTL"),
        ("blank", &format!("{OBJ}  ")[..], "newmtl red\nd 1"),
    ] {
        let files = [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())];
        let model = read(&files, "a.obj", true).expect(name);
        let about_ends: Vec<_> =
            (model.warnings.iter()).filter(|warning| warning.contains("truncated")).collect();
        assert!(about_ends.is_empty(), "{name}: {about_ends:?}");
    }
    assert_eq!(said("a.stl", STL.trim_end().as_bytes()), "");
}

#[test]
fn packed_files_json_and_toml_fail_by_themselves() {
    let testdata = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata");
    let glb = fs::read(testdata.join("torus_meshopt.glb")).expect("a file of testdata");
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(PLY.as_bytes()).expect("memory");
    let gz = packer.finish().expect("memory");
    let gltf =
        br#"{"asset": {"version": "2.0"}, "nodes": [{"name": "a"}], "scenes": [{"nodes": [0]}]}"#;
    for (name, bytes, step) in [("a.ply.gz", &gz[..], 3), ("a.gltf", gltf, 1), ("a.glb", &glb, 97)]
    {
        assert!(read(&[(name, bytes)], name, false).is_ok(), "{name}");
        for end in (12..bytes.len()).step_by(step) {
            let cut = read(&[(name, &bytes[..end])], name, false);
            assert!(cut.is_err(), "{name} {end}");
        }
    }
    let toml = "[[objects]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = ";
    for end in 1..toml.len() {
        let cut = &toml[..end];
        // A cut in a comment or between two tables would be a whole file: there is none of these
        // here.
        assert!(!said("a.toml", cut.as_bytes()).is_empty(), "{cut}");
    }
}

/// The last statement goes on over two lines, and nothing ends it: many programs leave the last
/// line break out.
#[test]
fn a_whole_obj_whose_last_statement_is_continued_is_not_cut() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for face in ["f 1 2 \\\n3", "f 1 \\\r\n2 \\\r\n3"] {
        assert_eq!(said("a.obj", format!("{vertices}{face}").as_bytes()), "");
    }
    let cut = format!("{vertices}f 1 2 3\nf 1 \\\n2");
    assert_ne!(said("a.obj", cut.as_bytes()), "");
}
