//! Environment maps from files: pictures of all directions, in linear radiance.

#[cfg(feature = "exr")]
mod exr;
mod hdr;

use std::path::Path;

use super::fault::{Checked, Fault};
use super::gzip;
use super::memory_budget::check_free;
use super::read;
use super::report::Report;
use crate::error::{Place, Result};
use crate::scene::EnvironmentMap;

/// The texels of a picture, row by row from the top.
struct Picture {
    columns: usize,
    rows: usize,
    texels: Vec<[f32; 3]>,
}

/// The value that infinity is read as: the largest half float, beyond which cameras and programs
/// that write those overflow.
const BRIGHTEST: f32 = 65_504.0;

/// The map in the file of `report`.
///
/// # Errors
///
/// [`Error::Read`](crate::error::Error::Read) where the system refuses,
/// [`Error::Parse`](crate::error::Error::Parse) for content that is no such picture, and
/// [`Error::TooLarge`](crate::error::Error::TooLarge).
pub fn load_environment(report: &mut Report) -> Result<EnvironmentMap> {
    let path = report.source.path().to_owned();
    read::refuse_folder(&path)?;
    let bytes = read::regular_file(&path, report.budget.left(), report.watch)?;
    decoded(bytes, report)
}

/// The map that the scene of `whole` calls by this path, within the budget of that one.
///
/// # Errors
///
/// The errors of [`load_environment`].
pub fn load_environment_part(path: &Path, whole: &mut Report) -> Result<EnvironmentMap> {
    let mut report = whole.part(path);
    let map = load_environment(&mut report)?;
    whole.absorb(report);
    Ok(map)
}

/// The map of a file's content; its first bytes tell the format.
///
/// # Errors
///
/// [`Error::Parse`](crate::error::Error::Parse) and
/// [`Error::TooLarge`](crate::error::Error::TooLarge).
pub(crate) fn decoded(bytes: Vec<u8>, report: &mut Report) -> Result<EnvironmentMap> {
    let path = report.source.path().to_owned();
    let read = |report: &mut Report| {
        report.budget.charge_read(&path, bytes.len())?;
        let bytes = gzip::unpacked(bytes.into(), report)?;
        let mut picture = picture(&bytes, report)?;
        sanitize(&mut picture, report);
        let Picture { columns, rows, texels } = picture;
        EnvironmentMap::new(columns, rows, texels).map_err(Fault::Other)
    };
    read(report).map_err(|fault| fault.into_error(&path))
}

fn picture(bytes: &[u8], report: &mut Report) -> Checked<Picture> {
    if bytes.starts_with(b"#?") {
        return hdr::read(bytes, report);
    }
    #[cfg(feature = "exr")]
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return exr::read(bytes, report);
    }
    let what = "this is no environment map: it begins neither as Radiance's .hdr nor as .exr";
    Err(Fault::at(Place::Byte(0), what))
}

/// Refuses a picture that is too large, and charges it, before anything is allocated for it.
fn charge(columns: u64, rows: u64, report: &mut Report) -> Checked<()> {
    let side = u64::from(report.settings.max_texture);
    if columns == 0 || rows == 0 {
        return Err(Fault::file(format!("{columns} x {rows} texels are none")));
    }
    // As many texels as another texture may have, which take four bytes there.
    let is_small = columns <= side && rows <= side && 4 * columns * rows <= side * side;
    if !is_small {
        let what = format!(
            "{columns} x {rows} texels are over the limit of {side} a side and {side} x {side} / 4 in all \
             (--max-texture raises it)"
        );
        return Err(Fault::too_large(Place::File, what));
    }
    let bytes = columns * rows * size_of::<[f32; 3]>() as u64;
    report.budget.charge_texture(bytes)?;
    check_free(usize::try_from(bytes).unwrap_or(usize::MAX))
}

/// Makes radiance of what is none: NaN and negative numbers become 0, infinity becomes
/// [`BRIGHTEST`].
fn sanitize(picture: &mut Picture, report: &mut Report) {
    let columns = picture.columns.max(1);
    let (mut count, mut first) = (0_u64, String::new());
    for (index, texel) in picture.texels.iter_mut().enumerate() {
        let sanitized = texel.map(sanitized);
        if sanitized != *texel {
            if count == 0 {
                let [red, green, blue] = *texel;
                let (row, column) = (index / columns, index % columns);
                first = format!("[{red}, {green}, {blue}] in row {row}, column {column}");
            }
            count += 1;
            *texel = sanitized;
        }
    }
    if count > 0 {
        report.warn("texels", &Place::File, || {
            format!(
                "NaN and negative numbers are taken as 0 and infinity as {BRIGHTEST}, in {count} texels; the first is {first}"
            )
        });
    }
}

fn sanitized(value: f32) -> f32 {
    if value == f32::INFINITY {
        BRIGHTEST
    } else if value >= 0.0 {
        value
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::io::LoadSettings;

    fn read(bytes: &[u8], settings: LoadSettings) -> (Result<EnvironmentMap>, Vec<String>) {
        let mut report = Report::new("sky.hdr".as_ref(), settings, &());
        let read = decoded(bytes.to_vec(), &mut report);
        (read, report.take_lines())
    }

    fn hdr(size: &str, content: &[u8]) -> Vec<u8> {
        let head = format!("#?RADIANCE\n# comment\nFORMAT=32-bit_rle_rgbe\n\n{size}\n");
        [head.as_bytes(), content].concat()
    }

    fn texels(bytes: &[u8]) -> Vec<[f32; 3]> {
        let (map, lines) = read(bytes, LoadSettings::default());
        assert!(lines.is_empty(), "{lines:?}");
        map.unwrap().texels().to_vec()
    }

    #[test]
    fn numbers_are_mantissas_times_powers_of_two() {
        let plain = [
            [255, 128, 1, 128],
            [1, 0, 7, 1],
            [255, 255, 255, 255],
            [9, 9, 9, 0],
            [3, 2, 1, 9],
            [3, 2, 1, 10],
        ];
        let got = texels(&hdr("-Y 2 +X 3", plain.as_flattened()));
        for ([red, green, blue, exponent], got) in plain.into_iter().zip(got) {
            let scale = if exponent == 0 { 0.0 } else { libm::exp2(f64::from(exponent) - 136.0) };
            let expected = [red, green, blue].map(|mantissa| f64::from(mantissa) * scale);
            assert_eq!(got.map(f64::from), expected);
        }
    }

    #[test]
    fn every_packing_gives_the_same_texels() {
        let line: Vec<[u8; 4]> = (0_u8..9).map(|k| [7, 7, k / 5, 129]).collect();
        let plain = texels(&hdr("-Y 1 +X 9", line.as_flattened()));
        // Two texels, each repeated: four and three times.
        let old = [[7, 7, 0, 129], [1, 1, 1, 4], [7, 7, 1, 129], [1, 1, 1, 3]];
        assert_eq!(texels(&hdr("-Y 1 +X 9", old.as_flattened())), plain);
        let new = [2, 2, 0, 9, 137, 7, 9, 7, 7, 7, 7, 7, 7, 7, 7, 7, 133, 0, 132, 1, 137, 129];
        assert_eq!(texels(&hdr("-Y 1 +X 9", &new)), plain);
        // 1 + 2 + 256 times 1.
        let long = [[7, 7, 7, 129], [1, 1, 1, 2], [1, 1, 1, 1]];
        assert_eq!(texels(&hdr("-Y 1 +X 259", long.as_flattened())).len(), 259);
    }

    #[test]
    fn texels_come_in_the_order_that_the_size_says() {
        // Rows: 1 2 3 above 4 5 6.
        let written = |order: [u8; 6]| order.map(|k| [k, 0, 0, 136]).as_flattened().to_vec();
        for (size, order) in [
            ("-Y 2 +X 3", [1, 2, 3, 4, 5, 6]),
            ("-Y 2 -X 3", [3, 2, 1, 6, 5, 4]),
            ("+Y 2 +X 3", [4, 5, 6, 1, 2, 3]),
            ("+Y 2 -X 3", [6, 5, 4, 3, 2, 1]),
            ("+X 3 -Y 2", [1, 4, 2, 5, 3, 6]),
            ("-X 3 +Y 2", [6, 3, 5, 2, 4, 1]),
        ] {
            let got = texels(&hdr(size, &written(order)));
            let reds = got.iter().map(|texel| texel[0]).collect::<Vec<_>>();
            assert_eq!(reds, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{size}");
        }
    }

    #[test]
    fn what_is_damaged_is_said_with_its_place() {
        let whole = hdr("-Y 1 +X 9", &[2, 2, 0, 9, 137, 7, 137, 7, 137, 7, 137, 129]);
        for end in 0..whole.len() {
            let (read, _) = read(&whole[..end], LoadSettings::default());
            let error = read.unwrap_err().to_string();
            assert!(error.starts_with("sky.hdr @ byte"), "{error}");
        }
        for (size, content, part) in [
            ("-Y 1 +X 9", &[2, 2, 0, 8, 137, 7][..], "a line of 8"),
            ("-Y 1 +X 9", &[2, 2, 0, 9, 138, 7], "a run of 10"),
            ("-Y 1 +X 9", &[2, 2, 0, 9, 0], "a run of 0"),
            ("-Y 1 +X 2", &[1, 1, 1, 9], "repeated 9"),
            ("-Y 1 +X 2", &[5, 5, 5, 9, 1, 1, 1, 2], "repeated 2"),
            ("-Y 0 +X 9", &[], "0 texels"),
            ("-Z 1 +X 9", &[], "the size must be"),
            ("-Y 99999999999 +X 9", &[], "the size must be"),
            ("-Y 4294967295 +X 4294967295", &[], "max-texture"),
        ] {
            let error = read(&hdr(size, content), LoadSettings::default()).0.unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
        }
        let xyz = b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\x01\x01\x01\x80";
        let error = read(xyz, LoadSettings::default()).0.unwrap_err();
        assert!(error.to_string().contains("xyze"), "{error}");
    }

    #[test]
    fn limits_hold_before_anything_is_decoded() {
        let small = LoadSettings { max_texture: 8, ..LoadSettings::default() };
        let bytes = hdr("-Y 4 +X 8", &[9; 4 * 32]);
        let error = read(&bytes, small).0.unwrap_err();
        assert!(error.to_string().contains("8 x 4"), "{error}");
        let little = LoadSettings { max_memory: 500, ..LoadSettings::default() };
        assert!(matches!(read(&bytes, little).0, Err(Error::TooLarge { .. })));
        assert!(read(&bytes, LoadSettings::default()).0.is_ok());
    }

    #[test]
    fn an_exposure_that_is_not_one_is_told() {
        for (value, told) in [("2.5", 1), ("1.000", 0)] {
            let head = format!("#?RGBE\nEXPOSURE={value}\n\n-Y 1 +X 1\n");
            let bytes = [head.as_bytes(), &[2, 1, 1, 128]].concat();
            let (map, lines) = read(&bytes, LoadSettings::default());
            assert_eq!((map.is_ok(), lines.len()), (true, told), "{lines:?}");
        }
    }

    #[cfg(feature = "exr")]
    #[test]
    fn exr_is_read_and_what_is_no_light_is_mended_with_one_warning() {
        use ::exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};
        let colors = [[0.5, 0.25, 2.0], [f32::NAN, -1.0, f32::INFINITY], [1.0, 1.0, -0.0]];
        let pixel = |at: Vec2<usize>| {
            let [red, green, blue] = colors[at.x()];
            (red, green, blue)
        };
        let image = Image::from_channels((3, 1), SpecificChannels::rgb(pixel));
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        let bytes = bytes.into_inner();
        let (map, lines) = read(&bytes, LoadSettings::default());
        let texels = map.unwrap().texels().to_vec();
        assert_eq!(texels, [[0.5, 0.25, 2.0], [0.0, 0.0, BRIGHTEST], [1.0, 1.0, 0.0]]);
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(lines[0].contains("in 1 texels") && lines[0].contains("column 1"), "{lines:?}");
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end], LoadSettings::default()).0.is_err());
        }
    }
}
