//! The stored result, read back by others' code.

use std::io::Cursor;
use std::path::Path;

use firsthit::Error;
use firsthit::geometry::srgb_encode;
use firsthit::image::{
    Channel, Data, Display, FORMATS, Frame, Holds, WriteSettings, format_named, format_of, write,
};

use crate::support::npz;

/// A picture of 2 rows and 3 columns whose second element is a miss.
fn frame() -> Frame {
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    let t = vec![1.5, f64::INFINITY, 0.1, 5e-324, 1e300, f64::NAN];
    let color = vec![
        0.0, 0.5, 1.0, nan, -1.0, 2.0, 0.1, 0.2, 0.3, 0.4, 0.001, 0.0031, 0.6, 0.7, 0.8, 0.9, 1e-9,
        inf,
    ];
    let mut frame = Frame::new([2, 3]);
    for channel in [
        Channel::new("color", 3, Data::Float32(color), Display::Color),
        Channel::new("t", 1, Data::Float64(t), Display::Distance),
        Channel::new("object", 1, Data::Int32(vec![0, -1, 1, 2, 3, i32::MAX]), Display::Identifier),
        Channel::new(
            "front",
            1,
            Data::Bool(vec![true, false, true, true, true, false]),
            Display::Mask,
        ),
    ] {
        frame.push(channel).unwrap();
    }
    frame
}

fn encode(format: &str, frame: &Frame, channel: Option<&str>) -> Vec<u8> {
    let mut bytes = Vec::new();
    (format_named(format).unwrap())
        .encode(frame, channel, WriteSettings::default(), &mut bytes, Path::new("-"))
        .unwrap();
    bytes
}

/// Checks the pixels of a PNG of a frame's colours.
fn check_colors(frame: &Frame) {
    let bytes = encode("png", frame, Some("color"));
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let &[rows, columns] = frame.shape() else {
        panic!("a picture has rows and columns");
    };
    assert_eq!((info.height as usize, info.width as usize), (rows, columns));
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert!(reader.info().srgb.is_some());
    let data = &frame.channel("color").unwrap().data;
    assert_eq!(pixels.len(), data.len());
    for (index, &byte) in pixels.iter().enumerate() {
        let linear = data.value(index);
        assert_eq!(f64::from(byte), (srgb_encode(linear) * 255.0).round(), "{index}: {linear}");
    }
}

#[test]
fn a_png_holds_the_bytes_of_the_srgb_formula() {
    check_colors(&frame());
}

/// More rows than are coloured at a time, and no multiple of it; and a row that is longer than
/// that.
#[test]
fn large_pngs_are_whole() {
    for [rows, columns] in [[701, 499], [3, 200_003]] {
        let colors = (0_u32..).take(3 * rows * columns);
        let colors = colors.map(|k| (k.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0);
        let colors = Data::Float32(colors.collect());
        let mut frame = Frame::new([rows, columns]);
        frame.push(Channel::new("color", 3, colors, Display::Color)).unwrap();
        check_colors(&frame);
    }
}

#[test]
fn an_npz_holds_exactly_what_the_frame_holds() {
    let frame = frame();
    let arrays = npz::arrays(encode("npz", &frame, None));
    for channel in frame.channels() {
        let array = &arrays[&*channel.name];
        let shape: &[usize] = if channel.components == 3 { &[2, 3, 3] } else { &[2, 3] };
        assert_eq!(array.shape, shape);
        match &channel.data {
            Data::Float64(values) => {
                assert_bits(values, &array.values("<f8", f64::from_le_bytes), f64::to_bits);
            }
            Data::Float32(values) => {
                assert_bits(values, &array.values("<f4", f32::from_le_bytes), f32::to_bits);
            }
            Data::Int32(values) => assert_eq!(*values, array.values("<i4", i32::from_le_bytes)),
            Data::Bool(values) => {
                let flags = array.values("|b1", |[byte]| byte);
                assert_eq!(flags, values.iter().map(|&flag| u8::from(flag)).collect::<Vec<_>>());
            }
        }
    }
}

/// Equal as bits, because NaN is not equal to itself.
fn assert_bits<T: Copy, B: PartialEq + std::fmt::Debug>(a: &[T], b: &[T], bits: fn(T) -> B) {
    let bits = |values: &[T]| values.iter().map(|&value| bits(value)).collect::<Vec<B>>();
    assert_eq!(bits(a), bits(b));
}

#[test]
fn an_npy_file_holds_one_channel_of_a_batch() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("batch.NPY");
    // More values than the writer turns into bytes at a time.
    let values: Vec<i32> = (0..20_001).collect();
    let mut frame = Frame::new([values.len()]);
    let data = Data::Int32(values.clone());
    frame.push(Channel::new("object", 1, data, Display::Identifier)).unwrap();
    write(&frame, &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let array = npz::Array::of(&bytes);
    assert_eq!(array.shape, [20_001]);
    assert_eq!(array.values("<i4", i32::from_le_bytes), values);
}

#[test]
fn files_have_the_same_bytes_as_streams_every_time() {
    let folder = tempfile::tempdir().unwrap();
    // A point cloud takes more than one channel.
    for format in (FORMATS.iter()).filter(|format| format.holds != Holds::Points) {
        let path = folder.path().join("out");
        // Not all channels: an EXR refuses a distance of 1e300.
        let channel = Some("object");
        (format.write(&frame(), channel, WriteSettings::default(), &path, &())).unwrap();
        let streamed = encode(format.name, &frame(), channel);
        assert!(std::fs::read(&path).unwrap() == streamed, "{}", format.name);
    }
}

#[test]
fn what_a_format_cannot_hold_is_refused_before_the_file_is_touched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let message = write(&frame(), &path).unwrap_err().to_string();
    assert!(message.ends_with("got 4 for png: [color, t, object, front]"), "{message}");
    let mut batch = Frame::new([1]);
    batch.push(Channel::new("t", 1, Data::Float64(vec![1.0]), Display::Distance)).unwrap();
    let message = write(&batch, &path).unwrap_err().to_string();
    assert_eq!(
        message,
        "shape must be [rows, columns], each from 1 to 2^31 - 1, for a PNG, got [1]"
    );
    assert!(matches!(write(&Frame::new([0, 4]), &path), Err(Error::Argument { .. })));
    assert!(!path.exists());
}

#[test]
fn extensions_choose_formats_in_any_case() {
    assert_eq!(format_of(Path::new("a/b.PNG")).unwrap().name, "png");
    for path in ["a.jpg", "png", "", ".png"] {
        let message = format_of(Path::new(path)).unwrap_err().to_string();
        assert!(message.ends_with(" (known: .png, .exr, .npy, .npz, .ply, .pcd)"), "{message}");
    }
}

#[cfg(unix)]
mod unix {
    use std::fs::{self, Permissions};
    use std::io::Write;
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    use std::path::Path;

    use firsthit::image::write_whole;

    fn write_text(path: &Path, text: &str) {
        write_whole(path, &(), |out| out.write_all(text.as_bytes())).unwrap();
    }

    #[test]
    fn devices_survive() {
        write_text(Path::new("/dev/null"), "gone");
        let null = fs::metadata("/dev/null").unwrap();
        assert!(null.file_type().is_char_device());
    }

    /// `/dev/stdout` is such a link when it is redirected to a file.
    #[test]
    #[cfg(target_os = "linux")]
    fn an_open_file_is_written_into_not_replaced() {
        use std::os::fd::AsRawFd;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        let mut open = fs::File::create(&path).unwrap();
        open.write_all(b"before ").unwrap();
        let link = folder.path().join("stdout");
        symlink(format!("/proc/self/fd/{}", open.as_raw_fd()), &link).unwrap();
        write_text(&link, "after");
        assert_eq!(fs::read(&path).unwrap(), b"before after");
        assert_eq!(open.metadata().unwrap().len(), 12, "it is still the same file");
    }

    #[test]
    fn symbolic_links_survive_and_lead_to_the_new_file() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("b")).unwrap();
        let link = folder.path().join("link.png");
        symlink("b/target.png", &link).unwrap();
        for text in ["made through a link to nothing", "replaced"] {
            write_text(&link, text);
            assert!(link.is_symlink());
            let target = folder.path().join("b/target.png");
            assert_eq!(fs::read(&target).unwrap(), text.as_bytes());
        }
        let ring = folder.path().join("ring.png");
        symlink("ring.png", &ring).unwrap();
        let message = write_whole(&ring, &(), |_| Ok(())).unwrap_err().to_string();
        assert!(message.ends_with("too many symbolic links"), "{message}");
    }

    #[test]
    fn permissions_are_those_of_the_old_file_or_of_the_umask() {
        let folder = tempfile::tempdir().unwrap();
        let [ours, plain] = ["ours", "plain"].map(|name| folder.path().join(name));
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        write_text(&ours, "new");
        fs::File::create(&plain).unwrap();
        assert_eq!(mode(&ours), mode(&plain));
        fs::set_permissions(&ours, Permissions::from_mode(0o640)).unwrap();
        write_text(&ours, "newer");
        assert_eq!(mode(&ours) & 0o777, 0o640);
    }
}
