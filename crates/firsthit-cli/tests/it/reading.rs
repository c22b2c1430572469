//! How a file is read, and what is refused with a way to go on.

use crate::support::Lab;

const PART: &str = "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n";

#[test]
fn units_become_metres_and_a_scale_multiplies() {
    let lab = Lab::new();
    lab.write("a.obj", PART);
    for (option, bounds) in [
        ("", "0,0,0 to 1000,1000,0"),
        ("--units mm", "0,0,0 to 1,1,0"),
        ("--scale 2", "0,0,0 to 2000,2000,0"),
    ] {
        let said = lab.ok(&format!("info a.obj {option}"));
        assert!(said.text().contains(bounds), "{option}: {}", said.text());
    }
    lab.fails("info a.obj --units furlong", 2, "possible values");
    lab.fails("info a.obj --scale 0", 2, "above 0");
    lab.fails("info a.obj --scale 2 --units mm", 2, "cannot be used with");
    lab.write("s.toml", "[[objects]]\nfile = \"a.obj\"\n");
    lab.fails("info s.toml --scale 2", 2, "1 but for mesh files and models");
}

#[test]
fn a_texture_above_the_folder_needs_leave() {
    let lab = Lab::new();
    std::fs::create_dir_all(lab.path("model")).unwrap();
    std::fs::create_dir_all(lab.path("textures")).unwrap();
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
    lab.write("model/a.obj", obj);
    lab.write("model/a.mtl", "newmtl m\nmap_Kd ..\\textures\\t.png\n");
    lab.ok("demo --size 4x4 --samples 1 -q -o textures/t.png");
    let refused = lab.ok("info model/a.obj");
    assert!(refused.stderr.contains("--allow-parent"), "{}", refused.stderr);
    for option in ["--allow-parent", "--resources textures"] {
        let read = lab.ok(&format!("info model/a.obj {option}"));
        assert!(read.stderr.is_empty(), "{option}: {}", read.stderr);
    }
}

#[test]
fn a_picture_of_points_without_faces_is_no_success() {
    let lab = Lab::new();
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n1 1 1\n";
    lab.write("cloud.ply", ply);
    lab.fails("render cloud.ply -o a.png", 3, "2 points without a face");
    assert!(!lab.path("a.png").exists());
}

#[test]
fn names_like_formulas_are_text_in_a_legend() {
    let lab = Lab::new();
    let name = "=HYPERLINK(1)";
    let scene = format!(
        "[[objects]]\nname = \"{name}\"\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n"
    );
    lab.write("s.toml", scene);
    lab.ok("render s.toml --size 8x8 --channels object -o o.png --legend o.csv");
    let table = String::from_utf8(lab.read("o.csv")).unwrap();
    assert!(table.contains(",'=HYPERLINK(1),"), "{table}");
    lab.ok("render s.toml --size 8x8 --channels object -o o.png --legend o.json");
    let table = String::from_utf8(lab.read("o.json")).unwrap();
    assert!(table.contains("\"=HYPERLINK(1)\""), "{table}");
}

/// A LAS 1.4 file of no points, with a record of firsthit's behind it.
fn las(metadata: &[u8]) -> Vec<u8> {
    let mut file = vec![0; 375];
    file[..4].copy_from_slice(b"LASF");
    file[24..26].copy_from_slice(&[1, 4]);
    file[94..96].copy_from_slice(&375_u16.to_le_bytes());
    file[104] = 6;
    file[235..243].copy_from_slice(&375_u64.to_le_bytes());
    file[243..247].copy_from_slice(&1_u32.to_le_bytes());
    file.extend([0; 2]);
    file.extend(b"firsthit\0\0\0\0\0\0\0\0");
    file.extend(1_u16.to_le_bytes());
    file.extend((metadata.len() as u64).to_le_bytes());
    file.extend([0; 32]);
    file.extend(metadata);
    file
}

#[test]
fn info_tells_what_a_las_file_says_and_lists_the_outputs_it_reads() {
    let lab = Lab::new();
    lab.write("a.las", las(b"{}"));
    let said = lab.ok("info a.las");
    assert!(said.text().contains("LAS 1.4, points of format 6"), "{}", said.text());
    assert!(said.stderr.contains("metadata"), "{}", said.stderr);
    lab.ok("info a.las --json");
    lab.write("b.las", &las(b"{}")[..200]);
    lab.fails("info b.las", 3, "truncated");
    lab.write("c.laz", "hello");
    lab.fails("info c.laz", 3, "not a LAS file");
    lab.fails("info a.xyzzy", 3, ".pcd, .las");
    for end in (0..las(b"{}").len()).step_by(37) {
        lab.write("d.las", &las(b"{}")[..end]);
        let outcome = lab.run("info d.las");
        assert!([0, 3].contains(&outcome.code), "{end}: {}", outcome.stderr);
    }
}
