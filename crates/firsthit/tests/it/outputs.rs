//! Outputs: what they say of themselves, read back and compared, and files that are none.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use firsthit::channel::KINDS;
use firsthit::image::{
    ArrayValues, Channel, Data, Display, Encoding, FORMATS, Far, Format, Frame, Holds, Metadata,
    WriteSettings, compare, format_named, is_point_cloud, read, write, write_channel,
};
use firsthit::scene::DirectionalLight;
use firsthit::{
    Color, DVec3, DisplayTransform, Error, Light, Mesh, Object, Positions, Scene, Shader, Shading,
    Sphere, ToneMap, Transform, example, render,
};

use crate::support::Numbers as Random;
use crate::support::on_threads;

const ROWS: usize = 37;
const COLUMNS: usize = 50;

/// The example scene with every channel, small.
fn frame() -> Frame {
    let scene = example::scene().unwrap();
    let camera = example::camera(ROWS, COLUMNS).unwrap();
    let shade = Shading { background: example::background(), ..Shader::default().on(&scene) };
    let kinds: Vec<_> = KINDS.iter().collect();
    render(&scene, &camera, &shade, &kinds, 1, &()).unwrap()
}

fn encode(format: &Format, frame: &Frame, channel: Option<&str>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let settings = WriteSettings::default();
    let path = Path::new("-");
    let others;
    let frame = if format.takes_mattes {
        frame
    } else {
        others = without_mattes(frame.clone());
        &others
    };
    format.encode(frame, channel, settings, &mut bytes, path).unwrap();
    bytes
}

/// The frame's other channels.
fn without_mattes(frame: Frame) -> Frame {
    let mut others = Frame::new(frame.shape()).from_origin(frame.origin().clone());
    for channel in frame.into_channels() {
        if channel.display != Display::Matte {
            others.push(channel).unwrap();
        }
    }
    others
}

/// Every file of a frame, in every format, with and without a scale and a tone map.
fn write_all(frame: &Frame, folder: &Path) -> Vec<std::path::PathBuf> {
    let mut paths = Vec::new();
    for format in FORMATS {
        let mut frame = frame.clone();
        if !format.takes_mattes {
            frame = without_mattes(frame);
        }
        if format.holds != Holds::OneChannel {
            paths.push(folder.join(format!("all.{}", format.name)));
            write(&frame, paths.last().unwrap()).unwrap();
            continue;
        }
        for channel in frame.channels() {
            paths.push(folder.join(format!("{}.{}", channel.name, format.name)));
            write_channel(&frame, &channel.name, paths.last().unwrap()).unwrap();
        }
    }
    for name in ["t", "range", "z"] {
        paths.push(folder.join(format!("{name}-steps.png")));
        let settings = WriteSettings { png_scale: Some(0.1), ..WriteSettings::default() };
        let png = format_named("png").unwrap();
        let path = paths.last().unwrap();
        png.write(frame, Some(name), settings, path, &()).unwrap();
    }
    paths.push(folder.join("tone-mapped.png"));
    let settings = WriteSettings {
        display: DisplayTransform { exposure: -0.5, tone_map: ToneMap::Neutral },
        ..WriteSettings::default()
    };
    let (png, path) = (format_named("png").unwrap(), paths.last().unwrap());
    png.write(frame, Some("color"), settings, path, &()).unwrap();
    paths
}

#[test]
fn files_hold_the_values_and_say_where_they_come_from() {
    let folder = tempfile::tempdir().unwrap();
    let frame = frame();
    let scene = example::scene().unwrap();
    for path in write_all(&frame, folder.path()) {
        // What point clouds hold is judged in point_clouds.rs.
        if is_point_cloud(&path) {
            continue;
        }
        let output = read(&path).unwrap();
        let metadata = output.metadata.as_ref().unwrap();
        assert_eq!(metadata.scene.as_deref(), Some(scene.fingerprint()));
        assert_eq!(metadata.camera, frame.metadata().camera);
        assert_eq!(metadata.shape, [ROWS as u64, COLUMNS as u64]);
        assert_eq!(output.notes, Vec::<String>::new());
        for array in &output.arrays {
            let name = array.name.as_deref().unwrap();
            let channel = frame.channel(name).unwrap();
            let record = metadata.channel(name).unwrap();
            assert_eq!(record.about, channel.description.about);
            let stored = record.stored.as_ref().unwrap();
            if stored.encoding == Encoding::Picture {
                assert!(array.is_picture);
                continue;
            }
            for index in 0..channel.data.len() {
                let exact = channel.data.value(index);
                let (found, expected) = match &array.numbers {
                    ArrayValues::Float64(values) if stored.encoding == Encoding::Steps => {
                        let near =
                            exact.is_infinite() || (values[index] - exact).abs() <= 0.050_001;
                        (values[index], if near { values[index] } else { exact })
                    }
                    ArrayValues::Float64(values) => (values[index], exact),
                    ArrayValues::Float32(values) => {
                        (f64::from(values[index]), f64::from(exact as f32))
                    }
                    ArrayValues::Integer(values) => (values[index] as f64, exact),
                };
                let same = found == expected || found.is_nan() && expected.is_nan();
                assert!(same, "{} {name} {index}: {found} {expected}", path.display());
                assert_eq!(found.is_infinite(), exact.is_infinite());
            }
        }
    }
}

#[test]
fn the_same_frame_gives_the_same_bytes_whatever_the_threads() {
    let frame = frame();
    for format in FORMATS {
        let channel = (format.holds == Holds::OneChannel).then_some("z");
        let bytes = |threads| on_threads(threads, || encode(format, &frame, channel));
        let one = bytes(1);
        for threads in [1, 2, 5] {
            assert!(bytes(threads) == one, "{} {threads}", format.name);
        }
    }
}

#[test]
fn files_of_different_formats_compare_channel_by_channel() {
    let folder = tempfile::tempdir().unwrap();
    let frame = frame();
    let [exr, npz] = ["a.exr", "a.npz"].map(|name| folder.path().join(name));
    write(&frame, &exr).unwrap();
    write(&frame, &npz).unwrap();
    let (a, b) = (read(&exr).unwrap(), read(&npz).unwrap());
    for channel in frame.channels() {
        let (a, b) = (a.array(&channel.name).unwrap(), b.array(&channel.name).unwrap());
        let difference = compare(a, b, 0.0).unwrap();
        let apart = (difference.differing, difference.ulps.unwrap_or(0));
        assert_eq!(apart, (0, 0), "{}", channel.name);
    }
}

#[test]
fn a_16_bit_png_refuses_what_it_cannot_hold_and_names_the_pixel() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("z.png");
    let frame = frame();
    let values = |index: usize| frame.channel("z").unwrap().data.value(index);
    let finite = (0..ROWS * COLUMNS).filter(|&k| values(k).is_finite());
    let by_value = |a: &usize, b: &usize| values(*a).total_cmp(&values(*b));
    let farthest = finite.clone().max_by(by_value).unwrap();
    let nearest = finite.min_by(by_value).unwrap();
    let png = format_named("png").unwrap();
    let write = |scale| {
        let settings = WriteSettings { png_scale: Some(scale), ..WriteSettings::default() };
        png.write(&frame, Some("z"), settings, &path, &())
    };
    let too_small = values(farthest) / 65_536.0;
    let message = write(too_small).unwrap_err().to_string();
    let place = |k: usize| format!("at row {}, column {}", k / COLUMNS, k % COLUMNS);
    assert!(message.contains(&place(farthest)), "{message}");
    assert!(message.contains(&format!("z is {}", values(farthest))), "{message}");
    // What it suggests is right.
    let (_, fits) = message.rsplit_once("a scale of ").unwrap();
    write(fits.strip_suffix(" fits").unwrap().parse().unwrap()).unwrap();
    fs::remove_file(&path).unwrap();
    let message = write(2.1 * values(nearest)).unwrap_err().to_string();
    assert!(message.contains(&place(nearest)), "{message}");
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(write(scale), Err(Error::Argument { .. })));
    }
    assert!(!path.exists());
}

/// A frame of a row of distances, and of identifiers.
fn row(distances: &[f64], identifiers: &[i32]) -> Frame {
    let mut frame = Frame::new([1, distances.len()]);
    for (name, data) in
        [("z", Data::Float64(distances.to_vec())), ("object", Data::Int32(identifiers.to_vec()))]
    {
        let kind = firsthit::channel::kind(name).unwrap();
        frame.push(kind.channel(data)).unwrap();
    }
    frame
}

#[test]
fn a_far_background_saturates_or_is_a_miss_in_a_png_of_millimetres_as_asked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("z.png");
    let frame = row(&[1.5, 65.5354, 65.536, 1e300, f64::INFINITY], &[0; 5]);
    let write = |far| {
        let settings =
            WriteSettings { png_scale: Some(0.001), png_far: far, ..WriteSettings::default() };
        let png = format_named("png").unwrap();
        png.write(&frame, Some("z"), settings, &path, &())
    };
    let message = write(None).unwrap_err().to_string();
    assert!(message.contains("unless `far` is given"), "{message}");
    for (far, beyond, said) in [(Far::Saturate, 65.535, "65535"), (Far::Zero, f64::INFINITY, "0")] {
        write(Some(far)).unwrap();
        let output = read(&path).unwrap();
        let ArrayValues::Float64(z) = &output.arrays[0].numbers else {
            panic!("distances");
        };
        let expected = [1.5, 65.535, beyond, beyond, f64::INFINITY];
        let is_close = |(a, b): (&f64, f64)| *a == b || (a - b).abs() < 1e-9;
        assert!(z.iter().zip(expected).all(is_close), "{z:?}");
        let metadata = output.metadata.unwrap();
        let stored = metadata.channels[0].stored.as_ref().unwrap();
        assert_eq!((stored.scale, stored.far.as_deref()), (Some(0.001), Some(said)));
    }
}

#[test]
fn labels_of_16_bits_are_identifiers_plus_one_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("object.png");
    let settings = WriteSettings { png_labels: true, ..WriteSettings::default() };
    let png = format_named("png").unwrap();
    let write = |identifiers: &[i32]| {
        let frame = row(&[1.0; 3], identifiers);
        png.write(&frame, Some("object"), settings, &path, &())
    };
    write(&[-1, 0, 65_534]).unwrap();
    let output = read(&path).unwrap();
    assert!(matches!(&output.arrays[0].numbers, ArrayValues::Integer(v) if v == &[-1, 0, 65_534]));
    let decoder = png::Decoder::new(std::io::Cursor::new(fs::read(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    assert_eq!(reader.output_color_type(), (png::ColorType::Grayscale, png::BitDepth::Sixteen));
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    assert_eq!(bytes, [0, 0, 0, 1, 255, 255]);
    let message = write(&[0, 65_535, 0]).unwrap_err().to_string();
    assert!(message.contains("got 65535 at row 0, column 1"), "{message}");
    // What is no identifier is a picture as before.
    png.write(&row(&[1.0; 3], &[0; 3]), Some("z"), settings, &path, &()).unwrap();
}

#[test]
fn a_packed_npz_has_the_same_numbers_in_fewer_bytes_and_float32_halves_them() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, packed, small] =
        ["a", "b", "c"].map(|name| folder.path().join(name).with_extension("npz"));
    let frame = row(&vec![1.25; 5000], &vec![7; 5000]);
    let npz = format_named("npz").unwrap();
    let settings = WriteSettings { compress: true, ..WriteSettings::default() };
    write(&frame, &plain).unwrap();
    npz.write(&frame, None, settings, &packed, &()).unwrap();
    let size = |path: &Path| fs::metadata(path).unwrap().len();
    assert!(size(&packed) * 10 < size(&plain));
    let numbers = |path: &Path| {
        let arrays = read(path).unwrap().arrays;
        let numbers = arrays.into_iter().map(|array| array.numbers);
        numbers.collect::<Vec<_>>()
    };
    assert!(numbers(&plain) == numbers(&packed));
    write(&frame.rounded().unwrap(), &small).unwrap();
    // But for the metadata, which name the type, and are packed.
    assert!((size(&small) + 4 * 5000).abs_diff(size(&plain)) < 64);
    let tiny = row(&[1e-60, 1e60, f64::INFINITY, 0.0, 0.1], &[0; 5]).rounded().unwrap();
    let Data::Float32(values) = &tiny.channels()[0].data else {
        panic!("rounded");
    };
    assert_eq!(values, &[f32::from_bits(1), f32::MAX, f32::INFINITY, 0.0, 0.1]);
}

#[test]
fn an_exr_refuses_what_float32_would_make_a_miss() {
    let mut frame = Frame::new([1, 2]);
    let kind = firsthit::channel::kind("t").unwrap();
    let values = Data::Float64(vec![1.0, 1e39]);
    frame.push(kind.channel(values)).unwrap();
    let path = Path::new("never-written.exr");
    let message = write(&frame, path).unwrap_err().to_string();
    assert!(message.starts_with("t must be in the range of float32"), "{message}");
    assert!(message.contains("e39 at row 0, column 1") || message.contains("at row 0, column 1"));
    assert!(!path.exists());
}

#[test]
fn two_channels_never_share_a_name_in_a_file() {
    let quantity = |name: &'static str, components: usize| {
        let numbers = Data::Float64(vec![1.0; 2 * components]);
        Channel::new(name, components, numbers, Display::Quantity)
    };
    let mut frame = Frame::new([2]);
    for channel in [quantity("position", 3), quantity("q", 2), quantity("q_0", 1)] {
        frame.push(channel).unwrap();
    }
    let mut refused = 0;
    for format in FORMATS.iter().filter(|format| format.holds == Holds::Points) {
        let error = format.check(&frame, None, WriteSettings::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "channel must be one whose names in the file differ from those of the others, got q_0 of q and of q_0"
        );
        refused += 1;
    }
    assert_eq!(refused, 2);
    let npz = format_named("npz").unwrap();
    npz.check(&frame, None, WriteSettings::default()).unwrap();
}

#[test]
fn a_sidecar_of_another_array_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let frame = frame();
    let [z, object] = ["z.npy", "object.npy"].map(|name| folder.path().join(name));
    write_channel(&frame, "z", &z).unwrap();
    write_channel(&frame, "object", &object).unwrap();
    assert_eq!(read(&z).unwrap().arrays[0].name.as_deref(), Some("z"));
    fs::copy(&object, &z).unwrap();
    let output = read(&z).unwrap();
    assert_eq!((&output.arrays[0].name, &output.metadata), (&None, &None));
    assert_eq!(output.notes.len(), 1);
}

fn square(scale: f64) -> Arc<Mesh> {
    let points = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]| [scale * x, y, 0.0]);
    let mesh = Mesh::new(Positions::compact(points.to_vec()), vec![[0, 1, 2], [0, 2, 3]]);
    Arc::new(mesh.unwrap())
}

#[test]
fn the_fingerprint_sees_what_a_picture_would() {
    let scene = |objects| Scene::new(objects).unwrap();
    let one = || scene(vec![Object::new(square(1.0))]);
    let moved = Transform::translation(DVec3::X).unwrap();
    let ball = |radius| Object::new(Sphere::new(DVec3::ZERO, radius).unwrap());
    let light = Light::from(DirectionalLight {
        direction: DVec3::NEG_Z,
        color: Color::ONE,
        angle_degrees: 0.0,
    });
    let different = [
        one(),
        scene(vec![]),
        scene(vec![Object::new(square(2.0))]),
        scene(vec![Object::new(square(1.0)); 2]),
        scene(vec![Object::new(square(1.0)).placed(moved)]),
        scene(vec![Object::new(square(1.0)).colored(Color::X)]),
        scene(vec![Object::new(square(1.0)).hidden(true)]),
        scene(vec![ball(1.0)]),
        scene(vec![ball(2.0)]),
        one().with_lights(vec![light]),
    ];
    let prints: std::collections::HashSet<&str> =
        different.iter().map(Scene::fingerprint).collect();
    assert_eq!(prints.len(), different.len());
    // Not the name, the storage, the light that goes with the camera, or the number of threads.
    let vertices = vec![[9., 9., 9.], [1., 1., 0.], [0., 1., 0.], [1., 0., 0.], [0.; 3]];
    let shuffled =
        Mesh::new(Positions::Double(vertices.into()), vec![[4, 3, 1], [4, 1, 2]]).unwrap();
    let same = [
        scene(vec![Object::new(square(1.0)).named("other").colored(Object::NEUTRAL)]),
        scene(vec![Object::new(Arc::new(shuffled))]),
        one().with_automatic_lights(vec![light]),
        one().with_lights(vec![light]).with_automatic_lights(vec![]),
    ];
    for scene in &same {
        assert_eq!(scene.fingerprint(), different[0].fingerprint());
    }
    // As another program makes it of the same numbers: every machine comes to the same.
    assert_eq!(one().fingerprint(), "blake3:04fa907b4b40d01f8bceaac4b047030c");
}

/// A file that is no output is refused in one line; nothing panics or takes more than it should.
#[test]
fn damaged_files_are_refused_or_read_but_never_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let frame = frame();
    let mut random = Random::new(4);
    let (mut refused, mut tried) = (0, 0);
    for format in FORMATS {
        let channel = (format.holds == Holds::OneChannel).then_some("z");
        let whole = encode(format, &frame, channel);
        let path = folder.path().join(format!("damaged.{}", format.name));
        for round in 0..150 {
            let mut bytes = whole.clone();
            let mut place = |limit: usize| (random.unit() * limit as f64) as usize;
            if round % 3 == 0 {
                bytes.truncate(place(whole.len()));
            } else {
                // The head, where the numbers are that sizes are made from, more often than the
                // rest.
                let reach = if round % 3 == 1 { 400 } else { whole.len() };
                for _ in 0..=round % 5 {
                    let at = place(reach.min(bytes.len()));
                    bytes[at] = place(256) as u8;
                }
            }
            fs::write(&path, &bytes).unwrap();
            tried += 1;
            if let Err(error) = read(&path) {
                refused += 1;
                let message = error.to_string();
                assert!(matches!(error, Error::Parse { .. }), "{message}");
                assert_eq!(message.lines().count(), 1, "{message}");
                // Our own words, not the crate's `ChunkType { type: IDAT }`.
                let words = message.replace(r"\u{", "");
                let words = words.split(" '").next().unwrap();
                assert!(!words.contains('{'), "{message}");
            }
        }
    }
    assert!(refused > tried / 4, "{refused} of {tried}");
}

#[test]
fn files_that_claim_more_than_they_hold_are_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let refuse = |name: &str, bytes: &[u8], words: &str| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains(words), "{name}: {message}");
    };
    // 2^15 squared pixels of float64 in a hundred bytes.
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (32768, 16384), }\n";
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((header.len() as u16).to_le_bytes());
    npy.extend(header.bytes());
    refuse("a.npy", &npy, "longer than the file");
    let tiny = encode(format_named("exr").unwrap(), &frame(), None);
    // The data window's and the display window's last corner.
    let corner: Vec<u8> =
        [COLUMNS as u32 - 1, ROWS as u32 - 1].iter().flat_map(|x| x.to_le_bytes()).collect();
    let large: Vec<u8> = [30_000_i32, 30_000].iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut exr = tiny.clone();
    for at in 0..8000.min(exr.len() - 8) {
        if exr[at..at + 8] == corner[..] {
            exr[at..at + 8].copy_from_slice(&large);
        }
    }
    assert_ne!(exr, tiny);
    // The number of blocks too, which must fit; after its name there are its type and its size.
    let name = b"chunkCount\0int\0";
    let at = exr.windows(name.len()).position(|window| window == name);
    let at = at.unwrap() + name.len() + 4;
    exr[at..at + 4].copy_from_slice(&30_001_i32.div_euclid(16).wrapping_add(1).to_le_bytes());
    refuse("a.exr", &exr, "limit");
    for name in ["a.png", "a.npz", "a.exr", "a.npy"] {
        refuse(name, b"", "");
        refuse(name, b"what else", "");
    }
}

#[test]
fn metadata_that_are_nonsense_are_a_note_and_the_numbers_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let bytes = encode(format_named("exr").unwrap(), &frame(), None);
    let mut changed = bytes.clone();
    let key = b"metadata_version";
    let at = bytes.windows(key.len()).position(|window| window == key).unwrap();
    changed[at] = b'?';
    fs::write(&path, changed).unwrap();
    let output = read(&path).unwrap();
    assert!(output.metadata.is_none() && output.notes.len() == 1);
    // By the names that programs agree on.
    assert_eq!(output.array("color").unwrap().components, 3);
    assert!(output.array("z").is_some() && output.array("object").is_some());
    assert!(Metadata::from_json("{}").is_err());
}
