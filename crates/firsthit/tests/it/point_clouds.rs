//! Point clouds, read by a reader of their headers that is not the library's.

use std::collections::BTreeMap;
use std::path::Path;

use firsthit::channel::{ChannelKind, KINDS};
use firsthit::geometry::srgb_encode;
use firsthit::image::{
    Array, ArrayValues, Channel, Data, Display, Frame, Metadata, WriteSettings, format_named,
    is_point_cloud, read, read_bytes,
};
use firsthit::{Background, Shader, Shading, example, render};

/// Those that point clouds hold.
fn held() -> impl Iterator<Item = &'static ChannelKind> {
    KINDS.iter().filter(|kind| kind.matte().is_none())
}

/// The example scene with every such channel, small.
fn frame(background: Background) -> Frame {
    let scene = example::scene().unwrap();
    let camera = example::camera(37, 50).unwrap();
    let shade = Shading { background, ..Shader::default().on(&scene) };
    // A transparent colour has an alpha of its own, of the same name.
    let is_there_already = background == Background::Transparent;
    let kinds = held().filter(|kind| !(is_there_already && kind.is_alpha()));
    let kinds: Vec<_> = kinds.collect();
    render(&scene, &camera, &shade, &kinds, 4, &()).unwrap()
}

fn encode(format: &str, frame: &Frame) -> firsthit::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let format = format_named(format).unwrap();
    let settings = WriteSettings::default();
    format.encode(frame, None, settings, &mut bytes, Path::new("-"))?;
    Ok(bytes)
}

/// The header's lines, and each column's cells, by its name.
struct Table {
    lines: Vec<String>,
    columns: BTreeMap<String, Vec<Vec<u8>>>,
}

impl Table {
    fn of(bytes: &[u8]) -> Self {
        let mut lines = Vec::new();
        let mut rest = bytes;
        loop {
            let end = rest.iter().position(|&byte| byte == b'\n').unwrap();
            lines.push(String::from_utf8(rest[..end].to_vec()).unwrap());
            rest = &rest[end + 1..];
            if ["end_header", "DATA binary"].contains(&lines.last().unwrap().as_str()) {
                break;
            }
        }
        let words = |start: &str| -> Vec<String> {
            let line = lines.iter().find_map(|line| line.strip_prefix(start));
            let words = line.unwrap_or_default().split_whitespace();
            words.map(str::to_owned).collect()
        };
        let sizes = |kind: &str| match kind {
            "double" => 8,
            "uchar" => 1,
            "int" | "float" => 4,
            other => panic!("{other}"),
        };
        let columns: Vec<(String, usize)> = if lines[0] == "ply" {
            let properties = lines.iter().filter_map(|line| line.strip_prefix("property "));
            let properties = properties.map(|line| line.split_once(' ').unwrap());
            properties.map(|(kind, name)| (name.to_owned(), sizes(kind))).collect()
        } else {
            let sizes = words("SIZE ");
            let sizes = sizes.iter().map(|size| size.parse().unwrap());
            words("FIELDS ").into_iter().zip(sizes).collect()
        };
        let count = [words("element vertex "), words("POINTS ")].concat();
        let count: usize = count[0].parse().unwrap();
        let row: usize = columns.iter().map(|(_, size)| size).sum();
        assert_eq!(rest.len(), count * row);
        let mut table = BTreeMap::new();
        let mut start = 0;
        for (name, size) in columns {
            let cells = rest.chunks_exact(row).map(|row| row[start..start + size].to_vec());
            assert!(table.insert(name, cells.collect()).is_none());
            start += size;
        }
        Self { lines, columns: table }
    }

    fn cells<T, const N: usize>(&self, name: &str, number: fn([u8; N]) -> T) -> Vec<T> {
        let cells = self.columns[name].iter();
        cells.map(|cell| number(cell[..].try_into().unwrap())).collect()
    }
}

/// The elements that hit something, by another channel than the one that the writer looks at.
fn hits(frame: &Frame) -> Vec<usize> {
    let object = &frame.channel("object").unwrap().data;
    (0..object.len()).filter(|&at| object.value(at) >= 0.0).collect()
}

fn component(frame: &Frame, name: &str, k: usize) -> Vec<f64> {
    let channel = frame.channel(name).unwrap();
    let at = |element| channel.data.value(element * channel.components + k);
    hits(frame).into_iter().map(at).collect()
}

fn srgb(linear: f64) -> u8 {
    (255.0 * srgb_encode(linear)).round() as u8
}

#[test]
fn a_ply_holds_exactly_what_was_hit() {
    let frame = frame(example::background());
    assert!(!hits(&frame).is_empty() && hits(&frame).len() < 37 * 50, "hits and misses");
    let table = Table::of(&encode("ply", &frame).unwrap());
    let exact = [
        ("x", "position", 0),
        ("y", "position", 1),
        ("z", "position", 2),
        ("nx", "normal", 0),
        ("ny", "normal", 1),
        ("nz", "normal", 2),
        ("t", "t", 0),
        ("range", "range", 0),
        ("depth", "z", 0),
        ("barycentric_2", "barycentric", 2),
        ("u", "uv", 0),
        ("v", "uv", 1),
    ];
    for (column, name, k) in exact {
        let found: Vec<u64> = table.cells(column, u64::from_le_bytes);
        let expected = component(&frame, name, k);
        assert_eq!(found, expected.iter().map(|value| value.to_bits()).collect::<Vec<_>>());
    }
    for name in ["object", "primitive", "face"] {
        let found = table.cells(name, i32::from_le_bytes);
        let found: Vec<f64> = found.into_iter().map(f64::from).collect();
        assert_eq!(found, component(&frame, name, 0), "{name}");
    }
    for (k, name) in ["red", "green", "blue"].into_iter().enumerate() {
        let expected: Vec<u8> = component(&frame, "color", k).into_iter().map(srgb).collect();
        assert_eq!(table.cells(name, u8::from_le_bytes), expected, "{name}");
    }
    let front: Vec<f64> =
        table.cells("front", u8::from_le_bytes).into_iter().map(f64::from).collect();
    assert_eq!(front, component(&frame, "front", 0));
}

#[test]
fn a_pcd_holds_the_same_as_float32_with_packed_colours() {
    let frame = frame(example::background());
    let table = Table::of(&encode("pcd", &frame).unwrap());
    for (column, name, k) in [("z", "position", 2), ("normal_y", "normal", 1), ("depth", "z", 0)] {
        let expected = component(&frame, name, k);
        let expected: Vec<f32> = expected.into_iter().map(|value| value as f32).collect();
        assert_eq!(table.cells(column, f32::from_le_bytes), expected, "{column}");
    }
    let channels = [0, 1, 2].map(|k| component(&frame, "color", k));
    for (point, packed) in table.cells("rgb", u32::from_le_bytes).into_iter().enumerate() {
        let expected = [0, 1, 2].map(|k| u32::from(srgb(channels[k][point])));
        assert_eq!(packed, expected[0] << 16 | expected[1] << 8 | expected[2]);
    }
    let has = |line: &str| table.lines.iter().any(|other| other == line);
    let count = hits(&frame).len();
    assert!(has("VERSION 0.7") && has("HEIGHT 1") && has("VIEWPOINT 0 0 0 1 0 0 0"));
    assert!(has(&format!("WIDTH {count}")) && has(&format!("POINTS {count}")));
    assert!(table.lines[0].starts_with("# .PCD v0.7"));
}

#[test]
fn a_transparent_colour_is_divided_by_its_alpha() {
    let frame = frame(Background::Transparent);
    let table = Table::of(&encode("ply", &frame).unwrap());
    let alphas = component(&frame, "color", 3);
    assert!(alphas.iter().any(|&alpha| alpha > 0.0 && alpha < 1.0));
    let reds = component(&frame, "color", 0).into_iter().zip(&alphas);
    let reds: Vec<u8> = reds.map(|(red, alpha)| srgb(red / alpha)).collect();
    assert_eq!(table.cells("red", u8::from_le_bytes), reds);
    let alphas: Vec<u8> = alphas.iter().map(|alpha| (255.0 * alpha).round() as u8).collect();
    assert_eq!(table.cells("alpha", u8::from_le_bytes), alphas);
    let table = Table::of(&encode("pcd", &frame).unwrap());
    let packed = table.cells("rgba", |[_, _, red, alpha]: [u8; 4]| (red, alpha));
    assert_eq!(packed, reds.into_iter().zip(alphas).collect::<Vec<_>>());
}

/// Readers keep lines in 1024 bytes or less, and the metadata are longer than that.
#[test]
fn the_header_tells_the_metadata_in_short_lines() {
    let folder = tempfile::tempdir().unwrap();
    let frame = frame(example::background());
    for format in ["ply", "pcd"] {
        let bytes = encode(format, &frame).unwrap();
        let table = Table::of(&bytes);
        // All columns of a PCD are one line.
        assert!(table.lines.iter().all(|line| line.len() < 250), "{:?}", table.lines);
        let path = folder.path().join(format!("cloud.{format}"));
        frame.save(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
        assert!(is_point_cloud(&path));
        let output = read(&path).unwrap();
        let Metadata { shape, pixels, camera, channels, .. } = output.metadata.unwrap();
        assert_eq!(shape, [hits(&frame).len() as u64]);
        assert!(pixels.is_none() && camera == frame.origin().camera);
        assert!(output.notes.is_empty(), "{:?}", output.notes);
        // In the order of the frame, each as it was.
        let names: Vec<_> = output.arrays.iter().map(|array| array.name.clone().unwrap()).collect();
        assert_eq!(names, held().map(|kind| &*kind.name).collect::<Vec<_>>());
        assert_eq!(names, channels.iter().map(|channel| channel.name.clone()).collect::<Vec<_>>());
        for array in &output.arrays {
            assert_is_that_of(array, &frame);
        }
    }
}

/// An array that was read has the frame's numbers, each hit's last component.
fn assert_is_that_of(array: &Array, frame: &Frame) {
    let name = array.name.as_deref().unwrap();
    assert_eq!(array.is_picture, name == "color");
    let expected = component(frame, name, array.components - 1);
    for (index, expected) in expected.into_iter().enumerate() {
        let last = (index + 1) * array.components - 1;
        let (found, expected) = match &array.numbers {
            ArrayValues::Float64(values) => (values[last], expected),
            ArrayValues::Float32(values) => (f64::from(values[last]), f64::from(expected as f32)),
            ArrayValues::Integer(values) if name == "color" => {
                (values[last] as f64, f64::from(srgb(expected)))
            }
            ArrayValues::Integer(values) => (values[last] as f64, expected),
        };
        assert!(found == expected || found.is_nan() && expected.is_nan(), "{name} {index}");
    }
}

fn positions(values: &[f64]) -> Frame {
    let mut frame = Frame::new([values.len() / 3]);
    let data = Data::Float64(values.to_vec());
    frame.push(Channel::new("position", 3, data, Display::Position)).unwrap();
    frame
}

#[test]
fn a_cloud_without_points_is_a_file() {
    for format in ["ply", "pcd"] {
        let bytes = encode(format, &positions(&[f64::NAN; 6])).unwrap();
        assert!(Table::of(&bytes).columns["x"].is_empty());
        let name = format!("empty.{format}");
        let output = read_bytes(Path::new(&name), &bytes, 1 << 20).unwrap();
        assert_eq!(output.arrays[0].shape, [0, 3]);
    }
}

#[test]
fn what_a_cloud_cannot_hold_is_refused_before_the_file_is_touched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.ply");
    let mut frame = Frame::new([2]);
    let object = Channel::new("object", 1, Data::Int32(vec![0, 1]), Display::Identifier);
    frame.push(object).unwrap();
    let message = frame.save(&path).unwrap_err().to_string();
    assert_eq!(message, "channel must be position, and any others, for a point cloud, got object");
    assert!(!path.exists() && !is_point_cloud(&path));
    // 1e300 is a distance that float32 does not have.
    let mut far = positions(&[0.0; 6]);
    far.push(Channel::new("t", 1, Data::Float64(vec![0.0, 1e300]), Display::Distance)).unwrap();
    let message = encode("pcd", &far).unwrap_err().to_string();
    assert_eq!(
        message,
        "t must be in the range of float32 for a PCD (or use ply), got 1e300 at element 1"
    );
    assert!(encode("ply", &far).is_ok());
}

#[test]
fn positions_of_a_country_keep_their_digits_in_a_pcd() {
    let near = [0.1, 0.2, 0.3, 100.7, -40.3, 0.0];
    let far = near.map(|x: f64| x + 4_500_000.0);
    let read = |values: &[f64]| {
        let bytes = encode("pcd", &positions(values)).unwrap();
        let mut output = read_bytes(Path::new("a.pcd"), &bytes, 1 << 20).unwrap();
        output.arrays.remove(0).numbers
    };
    assert_eq!(read(&far), ArrayValues::Float64(far.to_vec()));
    assert_eq!(read(&near), ArrayValues::Float32(near.map(|x| x as f32).to_vec()));
}

#[test]
fn other_files_are_refused_in_words() {
    let read = |name: &str, bytes: &[u8]| {
        let read = read_bytes(Path::new(name), bytes, 1 << 20);
        read.unwrap_err().to_string()
    };
    let cloud = encode("ply", &positions(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])).unwrap();
    let text = String::from_utf8_lossy(&cloud).into_owned();
    let with = |old: &str, new: &str| {
        assert!(text.contains(old));
        text.replacen(old, new, 1).into_bytes()
    };
    for (bytes, expected) in [
        (with("binary_little_endian", "ascii"), "expected 3 numbers"),
        (with("end_header", "element face 1\nend_header"), "a mesh, not a point cloud"),
        (with("element vertex 2", "element vertex 3"), "holds 2 points of 3"),
        (with("element vertex 2", "element vertex 99999999"), "over the limit"),
        (with("double y", "double x"), "two of one name"),
        (with("double y", "list uchar int y"), "is not read"),
        (with("end_header\n", "end_header"), "ends within its header"),
        (b"solid".to_vec(), "ends within its header"),
        (b"solid\n".to_vec(), "not a PLY"),
    ] {
        let message = read("a.ply", &bytes);
        assert!(message.contains(expected), "{message}");
    }
    let many: Vec<String> = (0..300).map(|k| format!("property uchar c{k}\n")).collect();
    let many = many.concat();
    let message = read("a.ply", &with("end_header", &format!("{many}end_header")));
    assert!(message.contains("more than 256 columns"), "{message}");
    let cloud = encode("pcd", &positions(&[1.0, 2.0, 3.0])).unwrap();
    let text = String::from_utf8_lossy(&cloud).into_owned();
    for (old, new, expected) in [
        ("DATA binary", "DATA ascii", "expected 3 numbers"),
        ("COUNT 1 1 1", "COUNT 1 9 1", "holds 0 points of 1"),
        ("SIZE 4 4 4", "SIZE 4 4", "do not go together"),
        ("TYPE F F F", "TYPE F F Q", "is not read"),
        ("POINTS 1\n", "POINTS one\n", "'one' is not read"),
    ] {
        assert!(text.contains(old), "{old}");
        let message = read("a.pcd", text.replacen(old, new, 1).as_bytes());
        assert!(message.contains(expected), "{message}");
    }
}
