//! Every way to write rays, right and wrong.

use std::io::{Cursor, Write};

use crate::support::{Lab, npy, rays_npy};

/// Whole numbers, so that every type can hold them: the second ray misses.
const RAYS: [[i8; 6]; 3] = [[0, 0, 10, 0, 0, -1], [5, 0, 10, 0, 0, -1], [0, 0, -8, 0, 0, 2]];
const HITS: &str = "t,object\n10,0\ninf,-1\n4,0\n";

/// The rays as bytes, by row or by column.
fn bytes<const N: usize>(fortran: bool, number: impl Fn(i8) -> [u8; N]) -> Vec<u8> {
    let place = |k: usize| {
        if fortran { RAYS[k % 3][k / 3] } else { RAYS[k / 6][k % 6] }
    };
    (0..18).flat_map(|k| number(place(k))).collect()
}

fn hits(lab: &Lab, files: &str) -> String {
    let outcome = lab.ok(&format!("shoot square.ply {files} --channels t,object"));
    outcome.text().to_owned()
}

#[test]
fn arrays_of_any_numbers_and_any_order_are_read() {
    let lab = Lab::with_square();
    for fortran in [false, true] {
        let files = [
            ("<f8", bytes(fortran, |x| f64::from(x).to_le_bytes())),
            (">f8", bytes(fortran, |x| f64::from(x).to_be_bytes())),
            ("<f4", bytes(fortran, |x| f32::from(x).to_le_bytes())),
            (">f4", bytes(fortran, |x| f32::from(x).to_be_bytes())),
            ("|i1", bytes(fortran, i8::to_le_bytes)),
            ("<i2", bytes(fortran, |x| i16::from(x).to_le_bytes())),
            (">i4", bytes(fortran, |x| i32::from(x).to_be_bytes())),
            ("<i8", bytes(fortran, |x| i64::from(x).to_le_bytes())),
        ];
        for (descr, data) in files {
            lab.write("rays.npy", npy(descr, fortran, "(3, 6)", &data));
            assert_eq!(hits(&lab, "rays.npy"), HITS, "{descr} {fortran}");
        }
    }
}

/// The origins and the directions, each as an array of their own.
fn apart() -> [Vec<u8>; 2] {
    [0, 3].map(|first| {
        let numbers = RAYS.iter().flat_map(|ray| &ray[first..first + 3]);
        let data: Vec<u8> = numbers.flat_map(|&x| f64::from(x).to_le_bytes()).collect();
        npy("<f8", false, "(3, 3)", &data)
    })
}

#[test]
fn origins_and_directions_may_be_apart() {
    let lab = Lab::with_square();
    let [origins, directions] = apart();
    lab.write("origins.npy", &origins);
    lab.write("directions.npy", &directions);
    assert_eq!(hits(&lab, "origins.npy directions.npy"), HITS);
    lab.write("origins.csv", "x,y,z\n0,0,10\n5,0,10\n0,0,-8\n");
    lab.write("directions.csv", "0,0,-1\n0,0,-1\n0,0,2\n");
    assert_eq!(hits(&lab, "origins.csv directions.csv"), HITS);
    assert_eq!(hits(&lab, "origins.csv directions.npy"), HITS);
    lab.write("none.csv", "x,y,z\n");
    lab.write("nor.csv", "dx,dy,dz\n");
    assert_eq!(hits(&lab, "none.csv nor.csv"), "t,object\n");
    lab.write("one.csv", "0,0,-1\n");
    lab.fails("shoot square.ply origins.npy one.csv", 3, "3 origins, but 1 directions");
    lab.fails("shoot square.ply origins.npy", 3, "got columns: 3");
}

fn archive(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated);
    for (name, bytes) in entries {
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn archives_hold_origins_and_directions() {
    let lab = Lab::with_square();
    let [o, d] = apart();
    for (origins, directions) in [
        ("origins.npy", "directions.npy"),
        ("origin.npy", "dir.npy"),
        ("origin.npy", "direction.npy"),
    ] {
        let entries = [(directions, &d[..]), ("more.npy", b"junk"), (origins, &o[..])];
        lab.write("rays.npz", archive(&entries));
        assert_eq!(hits(&lab, "rays.npz"), HITS, "{origins} {directions}");
    }
    let rays = npy("|i1", false, "(3, 6)", &bytes(false, i8::to_le_bytes));
    lab.write("rays.npz", archive(&[("rays.npy", &rays)]));
    assert_eq!(hits(&lab, "rays.npz"), HITS);
    lab.write("rays.npz", archive(&[("origins.npy", &o)]));
    lab.fails(
        "shoot square.ply rays.npz",
        3,
        "expected entries origins and directions, or rays, or points; got origins.npy",
    );
    lab.write("rays.npz", &archive(&[("rays.npy", &rays)])[..90]);
    lab.fails("shoot square.ply rays.npz", 3, "rays.npz: ");
}

#[test]
fn text_may_have_a_header_comments_and_spaces() {
    let lab = Lab::with_square();
    for head in ["", "ox,oy,oz,dx,dy,dz\n", "# rays\n", "\u{feff}", "\"a\",b,c,d,e,f\n"] {
        lab.write("rays.csv", format!("{head}0, 0, 10,0,0,-1\r\n\n5,0,1e1,0,0,-1\n0,0,-8,0,0,+2"));
        assert_eq!(hits(&lab, "rays.csv"), HITS, "{head:?}");
    }
}

#[test]
fn files_that_hold_no_rays_are_bad_input() {
    let lab = Lab::with_square();
    let text: [(&[u8], &str); 10] = [
        (b"1,2,3,4,5\n", "got columns: 5"),
        (b"1,2,3,4,5,6\n1,2\n", "line 2: expected 6 columns, got 2"),
        (b"1,2,3,4,5,6\n1,2,3,4,5,x\n", "line 2: expected numbers"),
        (b"a,b,c,d,e,f\nx,y,z,u,v,w\n", "line 2: expected numbers"),
        (b"hello world\n", "line 1: the columns must be named ox,oy,oz"),
        (b"1 2 3 4 5 6\n", "line 1: expected numbers"),
        (b"\xff\xfe\x00\x01 garbage \x80\n1,2,3,4,5,6\n", "line 1"),
        (b"1,2,3,x,5,6\n", "line 1: expected numbers"),
        (b"# a\n\n1,2,3,4,5,x", "line 3: expected numbers"),
        (b"# a\n1,2,3,4,5,6\n  # b\r\n\r\n\n1,2\r\n\n", "line 6: expected 6 columns, got 2"),
    ];
    for (bytes, words) in text {
        lab.write("rays.csv", bytes);
        lab.fails("shoot square.ply rays.csv -o hits.npz", 3, words);
        lab.fails("shoot square.ply rays.csv -o hits.csv", 3, "rays.csv: ");
    }
    lab.fails("shoot square.ply none.npy -o hits.npz", 3, "none.npy: No such file");
    lab.fails("shoot square.ply . -o hits.npz", 3, "a folder, not a file");
    lab.fails("shoot none.ply rays.csv -o hits.npz", 3, "");
}

#[test]
fn arrays_that_lie_are_bad_input() {
    let lab = Lab::with_square();
    let some = [0; 96];
    let lies: [(&str, &str, &str); 14] = [
        ("<f8", "(1152921504606846976, 6)", "longer than the file"),
        ("<f8", "(18446744073709551615, 6)", "longer than the file"),
        ("<f8", "(99999999999999999999999, 6)", "longer than the file"),
        ("<f8", "(3, 6)", "longer than the file"),
        ("<f8", "(0, 1152921504606846976)", "longer than the file"),
        ("<f8", "(1152921504606846976, 0)", "longer than the file"),
        ("<f8", "(-1, 6)", "negative"),
        ("<f8", "(12,)", "expected an array of shape (n, 6)"),
        ("<f8", "()", "expected an array of shape (n, 6)"),
        ("<f8", "(2, 5)", "got columns: 5"),
        ("|O", "(1, 6)", "expected floats"),
        ("<c16", "(1, 6)", "expected floats"),
        ("<f99999999999999999999", "(1, 6)", "not a NumPy array"),
        ("<U1152921504606846976", "(2, 6)", "rays.npy: "),
    ];
    for (descr, shape, words) in lies {
        lab.write("rays.npy", npy(descr, false, shape, &some));
        lab.fails("shoot square.ply rays.npy -o hits.npz", 3, words);
    }
    let whole = rays_npy(&[[0.0, 0.0, 1.0, 0.0, 0.0, -1.0]]);
    for length in [6, 7, 9, 10, 50, 127, 128, whole.len() - 1] {
        lab.write("rays.npy", &whole[..length]);
        lab.fails("shoot square.ply rays.npy -o hits.npz", 3, "rays.npy: ");
    }
    let mut deep = b"\x93NUMPY\x01\x00\x00\xf0{'descr': ".to_vec();
    deep.resize(10 + 0xf000, b'(');
    lab.write("rays.npy", deep);
    lab.fails("shoot square.ply rays.npy -o hits.npz", 3, "nested more than 8 deep");
}

#[test]
fn lines_of_blanks_are_blank_lines() {
    let lab = Lab::with_square();
    lab.write("rays.csv", "  \n0,0,10,0,0,-1\n \t \n5,0,10,0,0,-1\n0,0,-8,0,0,2\n\n");
    assert_eq!(hits(&lab, "rays.csv"), HITS);
}
