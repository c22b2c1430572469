//! Points of clouds, of every format.

use std::io::Cursor;
use std::path::Path;

use firsthit::image::{
    Array, ArrayValues, Channel, Data, Description, Display, FORMATS, Frame, Holds, Points, Unit,
    WriteSettings, points_of, read_points,
};

/// Numbers that float32 and steps of a quarter hold.
const POSITIONS: [[f64; 3]; 3] = [[0.25, -1.5, 3.0], [1000.75, 0.0, -2.25], [8.0, 9.5, 0.5]];
const INTENSITY: [i64; 3] = [7, 60000, 0];

fn read(bytes: &[u8]) -> Points {
    points_of(Path::new("cloud"), bytes).unwrap()
}

fn refused(bytes: &[u8]) -> String {
    points_of(Path::new("cloud"), bytes).unwrap_err().to_string()
}

fn column<'a>(points: &'a Points, name: &str) -> &'a Array {
    let is_it = |array: &&Array| array.name.as_deref() == Some(name);
    points.columns.iter().find(is_it).unwrap_or_else(|| panic!("{name}: {points:?}"))
}

fn numbers(array: &Array) -> Vec<f64> {
    match &array.numbers {
        ArrayValues::Float64(values) => values.clone(),
        ArrayValues::Float32(values) => values.iter().map(|&x| x.into()).collect(),
        ArrayValues::Integer(values) => values.iter().map(|&x| x as f64).collect(),
    }
}

fn check(bytes: &[u8], what: &str) {
    let points = read(bytes);
    assert_eq!(points.positions, POSITIONS, "{what}");
    let expected = INTENSITY.map(|x| x as f64);
    assert_eq!(numbers(column(&points, "intensity")), expected, "{what}");
    assert!(points.notes.is_empty(), "{what}: {:?}", points.notes);
}

/// Rows of three float32 and an unsigned short.
fn rows(is_big: bool) -> Vec<u8> {
    let mut rows = Vec::new();
    for (position, intensity) in POSITIONS.iter().zip(INTENSITY) {
        let intensity = u16::try_from(intensity).unwrap();
        #[expect(clippy::cast_possible_truncation, reason = "float32 holds them")]
        let position = position.map(|x| x as f32);
        if is_big {
            rows.extend(position.iter().flat_map(|x| x.to_be_bytes()));
            rows.extend(intensity.to_be_bytes());
        } else {
            rows.extend(position.iter().flat_map(|x| x.to_le_bytes()));
            rows.extend(intensity.to_le_bytes());
        }
    }
    rows
}

fn lines() -> String {
    let line = |(position, intensity): (&[f64; 3], i64)| {
        let [x, y, z] = position;
        format!("{x} {y} {z} {intensity}\n")
    };
    POSITIONS.iter().zip(INTENSITY).map(line).collect()
}

fn ply(format: &str, body: &[u8]) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\ncomment of another program\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty ushort intensity\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
    );
    [header.as_bytes(), body].concat()
}

fn pcd(data: &str, body: &[u8]) -> Vec<u8> {
    let header = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z _ intensity\nSIZE 4 4 4 1 2\nTYPE F F F U U\n\
        COUNT 1 1 1 2 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA {data}\n"
    );
    [header.as_bytes(), body].concat()
}

/// The rows with two bytes of padding in each.
fn padded_rows() -> Vec<u8> {
    let rows = rows(false);
    let padded = rows.chunks(14).map(|row| [&row[..12], &[9, 9], &row[12..]].concat());
    padded.collect::<Vec<_>>().concat()
}

/// Column by column, and packed by LZF: literally, or one column of zeros by references.
fn compressed() -> Vec<u8> {
    let rows = padded_rows();
    let column = |start: usize, size: usize| {
        let cells = rows.chunks(16).map(move |row| row[start..start + size].to_vec());
        cells.collect::<Vec<_>>().concat()
    };
    let columns = [(0, 4), (4, 4), (8, 4), (12, 1), (13, 1), (14, 2)];
    let columns: Vec<u8> = columns.iter().flat_map(|&(start, size)| column(start, size)).collect();
    let mut packed = Vec::new();
    // The padding is six nines: one, and a reference to five that begin one back.
    let (before, after) = (&columns[..37], &columns[42..]);
    for piece in before.chunks(32).chain(after.chunks(32)) {
        if piece == &after[..after.len().min(32)] {
            packed.extend([3 << 5, 0]);
        }
        packed.push(u8::try_from(piece.len() - 1).unwrap());
        packed.extend(piece);
    }
    let sizes =
        [packed.len(), columns.len()].map(|size| u32::try_from(size).unwrap().to_le_bytes());
    [sizes.as_flattened(), &packed].concat()
}

/// A LAS of that format, with an extra float32 `height`, and its points.
fn las(format: u8) -> (Vec<u8>, Vec<u8>) {
    let length = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67][usize::from(format)] + 4;
    let mut points = Vec::new();
    for (k, position) in POSITIONS.iter().enumerate() {
        let mut point = vec![0; length];
        for (axis, x) in position.iter().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "whole, and small")]
            let steps = ((x - 100.0) * 4.0) as i32;
            point[4 * axis..4 * axis + 4].copy_from_slice(&steps.to_le_bytes());
        }
        point[12..14].copy_from_slice(&u16::try_from(INTENSITY[k]).unwrap().to_le_bytes());
        point[14] = if format < 6 { 2 | 3 << 3 } else { 2 | 3 << 4 };
        point[if format < 6 { 15 } else { 16 }] = 5;
        #[expect(clippy::cast_precision_loss, reason = "small")]
        point[length - 4..].copy_from_slice(&(k as f32 + 0.5).to_le_bytes());
        points.extend(point);
    }
    let mut header = vec![0; 375];
    header[..4].copy_from_slice(b"LASF");
    header[24..26].copy_from_slice(&[1, 4]);
    header[94..96].copy_from_slice(&375_u16.to_le_bytes());
    header[100..104].copy_from_slice(&1_u32.to_le_bytes());
    header[104] = format;
    header[105..107].copy_from_slice(&u16::try_from(length).unwrap().to_le_bytes());
    for axis in 0..3 {
        header[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.25_f64.to_le_bytes());
        header[155 + 8 * axis..163 + 8 * axis].copy_from_slice(&100.0_f64.to_le_bytes());
    }
    header[247..255].copy_from_slice(&3_u64.to_le_bytes());
    let mut extra = vec![0; 192];
    extra[2] = 9;
    extra[4..10].copy_from_slice(b"height");
    header.extend(record(b"LASF_Spec", 4, &extra));
    let start = u32::try_from(header.len()).unwrap();
    header[96..100].copy_from_slice(&start.to_le_bytes());
    (header, points)
}

fn record(user: &[u8], number: u16, content: &[u8]) -> Vec<u8> {
    let mut record = vec![0; 54];
    record[2..2 + user.len()].copy_from_slice(user);
    record[18..20].copy_from_slice(&number.to_le_bytes());
    record[20..22].copy_from_slice(&u16::try_from(content.len()).unwrap().to_le_bytes());
    record.extend(content);
    record
}

/// The LAS file, packed as LAZ.
fn laz(format: u8) -> Vec<u8> {
    let (mut header, points) = las(format);
    let items = laz::LazItemRecordBuilder::default_for_point_format_id(format, 4).unwrap();
    let how = laz::LazVlr::from_laz_items(items);
    let mut content = Vec::new();
    how.write_to(&mut content).unwrap();
    header.extend(record(b"laszip encoded", 22204, &content));
    header[100..104].copy_from_slice(&2_u32.to_le_bytes());
    let start = u32::try_from(header.len()).unwrap();
    header[96..100].copy_from_slice(&start.to_le_bytes());
    header[104] |= 0x80;
    let mut packed = Cursor::new(Vec::new());
    let mut compressor = laz::LasZipCompressor::new(&mut packed, how).unwrap();
    compressor.compress_many(&points).unwrap();
    compressor.done().unwrap();
    drop(compressor);
    // The place of the table of chunks counts from the start of the file.
    let mut packed = packed.into_inner();
    let table = i64::from_le_bytes(packed[..8].try_into().unwrap()) + i64::from(start);
    packed[..8].copy_from_slice(&table.to_le_bytes());
    [header, packed].concat()
}

#[test]
fn clouds_of_every_format_have_the_same_points() {
    check(&ply("ascii", lines().as_bytes()), "ply in text");
    check(&ply("binary_little_endian", &rows(false)), "ply");
    check(&ply("binary_big_endian", &rows(true)), "ply of the other byte order");
    let text = lines()
        .replace(" 7\n", " 1 2 7\n")
        .replace(" 60000\n", " 1 2 60000\n")
        .replace(" 0\n", " 1 2 0\n");
    check(&pcd("ascii", text.as_bytes()), "pcd in text");
    check(&pcd("binary", &padded_rows()), "pcd");
    check(&pcd("binary_compressed", &compressed()), "compressed pcd");
    let named = format!("x y z intensity\n{}", lines());
    for (text, what) in [
        (named.clone(), "blanks"),
        (named.replace(' ', ","), "commas"),
        (named.replace(' ', ";"), "semicolons"),
        (named.replace(' ', "\t"), "tabs"),
        (named.replace(' ', " \t "), "blanks and tabs"),
        (named.replace('\n', "\r\n"), "line ends of two"),
        (format!("\u{feff}{named}\n\n"), "a mark of the byte order"),
        (format!("// {named}"), "names in a comment"),
        (format!("# made today\n# {named}"), "names in the last comment"),
        (named.replace("x y z", "X[m] Y[m] Z[m]"), "units"),
        (format!("3\n{named}"), "a number of points"),
        (named.replace("x y z intensity", "\"x\" \"y\" \"z\" \"intensity\""), "quotes"),
    ] {
        check(text.as_bytes(), what);
    }
}

#[test]
fn las_and_laz_of_every_format_have_the_same_points() {
    for format in 0..=10 {
        let (header, points) = las(format);
        let file = [header, points].concat();
        check(&file, "las");
        let has_waves = matches!(format, 4 | 5 | 9 | 10);
        let files = [Some(file), (!has_waves).then(|| laz(format))];
        for file in files.into_iter().flatten() {
            check(&file, &format!("format {format}"));
            let points = read(&file);
            assert_eq!(numbers(column(&points, "height")), [0.5, 1.5, 2.5]);
            assert_eq!(numbers(column(&points, "return_number")), [2.0; 3]);
            assert_eq!(numbers(column(&points, "number_of_returns")), [3.0; 3]);
            assert_eq!(numbers(column(&points, "classification")), [5.0; 3]);
        }
    }
}

#[test]
fn without_names_the_first_three_numbers_are_the_point() {
    let points = read(lines().as_bytes());
    assert_eq!(points.positions, POSITIONS);
    assert_eq!(numbers(column(&points, "column_3")), [7.0, 60000.0, 0.0]);
    // What is no number in a column that nobody needs takes the column out.
    let points = read(b"name,x,y,z,more\nfirst,1,2,3,\nsecond,4,5,6,7\n");
    assert_eq!(points.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert!(points.columns.iter().all(|array| array.name.as_deref() == Some("more")));
}

#[test]
fn rubbish_is_no_list_of_points() {
    for (text, words) in [
        ("hello world\n", "line 1: expected x, y and z of a point"),
        ("\n\nhello dear world\n", "line 3: expected x, y and z of a point"),
        ("solid part\nfacet normal 0 0 1\n", "line 1: expected"),
        ("solid my part\nfacet normal 0 0 1\n", "line 2: expected 3 columns, got 5"),
        ("1,2,3\n1,2,three\n", "line 2: expected a number for 'column_2', got 'three'"),
        ("1,2,3\n1,2\n", "line 2: expected 3 columns, got 2"),
        ("y,x,height\n0,0,1\n", "a line that names the columns x, y and z"),
        ("x,y,z,x\n0,0,1,2\n", "two columns are named x"),
        ("id,a,b,c\n1,0,0,1\n", "line 1: expected"),
        ("1,2\n", "line 1: expected"),
        ("12\n", "a number alone"),
    ] {
        let message = refused(text.as_bytes());
        assert!(message.contains(words), "{text:?}: {message}");
    }
    let mesh = [&[b' '; 80][..], &[1, 0, 0, 0], &[0; 50]].concat();
    assert!(refused(&mesh).contains("neither text nor a PLY, PCD, LAS, LAZ, NPY or NPZ"));
}

fn frame(positions: &[f64]) -> Frame {
    let channel = |name: &'static str, components, data, display| Channel {
        name: name.into(),
        components,
        data,
        display,
        description: Description { about: "", unit: Unit::None, frame: None },
    };
    let count = i32::try_from(positions.len() / 3).unwrap();
    let mut frame = Frame::new([1, positions.len() / 3]);
    let object = Data::Int32((0..count).collect());
    frame
        .push(channel("position", 3, Data::Float64(positions.to_vec()), Display::Position))
        .unwrap();
    frame.push(channel("object", 1, object, Display::Identifier)).unwrap();
    frame
}

#[test]
fn what_was_written_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let frame = frame(POSITIONS.as_flattened());
    for format in FORMATS.iter().filter(|format| format.holds != Holds::OneChannel) {
        let path = folder.path().join(format!("a.{}", format.name));
        format.write(&frame, None, WriteSettings::default(), &path, &()).unwrap();
        let points = read_points(&path).unwrap();
        assert_eq!(points.positions, POSITIONS, "{}", format.name);
        assert_eq!(numbers(column(&points, "object")), [0.0, 1.0, 2.0], "{}", format.name);
        // From now on it is an input.
        let other = folder.path().join(format!("other.{}", format.name));
        std::fs::copy(&path, &other).unwrap();
        read_points(&other).unwrap();
        let again = format.write(&frame, None, WriteSettings::default(), &other, &());
        assert!(again.unwrap_err().to_string().contains("is an input"), "{}", format.name);
    }
}

#[test]
fn pixels_that_met_nothing_keep_their_places() {
    let nan = f64::NAN;
    let mut bytes = Vec::new();
    let format = firsthit::image::format_named("npz").unwrap();
    let frame = frame(&[1.0, 2.0, 3.0, nan, nan, nan]);
    format.encode(&frame, None, WriteSettings::default(), &mut bytes, Path::new("a")).unwrap();
    let points = read(&bytes);
    assert_eq!(points.positions[0], [1.0, 2.0, 3.0]);
    assert!(points.positions[1][0].is_nan());
    assert_eq!(numbers(column(&points, "object")), [0.0, 1.0]);
}

#[test]
fn files_that_end_early_or_claim_too_much_are_refused_in_words() {
    let (header, points) = las(6);
    let las = [header, points].concat();
    let files = [
        ply("ascii", lines().as_bytes()),
        ply("binary_big_endian", &rows(true)),
        pcd("binary_compressed", &compressed()),
        las.clone(),
        laz(3),
        laz(7),
    ];
    for file in &files {
        for end in 4..file.len() {
            // A table of chunks, and the end of the last number, may be missing.
            if let Ok(points) = points_of(Path::new("cut"), &file[..end]) {
                assert!(points.positions.len() <= 3);
            }
        }
        // Any byte may be any other.
        let mut state = 1_u64;
        for _ in 0..2000 {
            let mut changed = file.clone();
            for _ in 0..3 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let place = usize::try_from(state >> 33).unwrap() % changed.len();
                changed[place] = (state >> 24) as u8;
            }
            let _ = points_of(Path::new("changed"), &changed);
        }
    }
    let claims = |place: usize, bytes: &[u8], file: &[u8]| {
        let mut file = file.to_vec();
        file[place..place + bytes.len()].copy_from_slice(bytes);
        refused(&file)
    };
    let many = u64::MAX.to_le_bytes();
    assert!(claims(247, &many, &las).contains("over the limit"));
    assert!(claims(247, &many, &laz(7)).contains("over the limit"));
    assert!(claims(247, &4_u64.to_le_bytes(), &las).contains("holds 3 points of 4"));
    assert!(claims(104, &[11], &las).contains("points of format 11"));
    assert!(claims(105, &[20, 0], &las).contains("shorter than format 6"));
    let text = String::from_utf8(ply("ascii", lines().as_bytes())).unwrap();
    let many = text.replace("vertex 3", "vertex 99999999");
    assert!(refused(many.as_bytes()).contains("too short for 99999999 points"));
}
