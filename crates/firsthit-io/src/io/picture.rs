//! Pictures for textures: PNG, JPEG, WebP, BMP, TGA, TIFF and GIF, their sizes checked before they
//! are decoded.

use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, ImageReader, Limits};

use super::memory_budget::{check_free, size_in_words};
use super::read;
use super::report::Report;
use super::source::without_gz;
use crate::scene::Texture;

/// The picture that a scene at `scene` calls `name`.
///
/// # Errors
///
/// In words, why it is not read.
pub(super) fn sibling(scene: &Path, name: &str, report: &mut Report) -> Result<Texture, String> {
    let path = read::sibling(scene, name, &report.settings.resources)?;
    let bytes = read::sibling_content(&path, report)?;
    let path = without_gz(&path);
    let extension = path.extension().and_then(|word| word.to_str());
    decode(&bytes, extension, report)
}

/// The texels of a picture. Its own bytes tell the format; where they do not (TGA), the file's
/// extension.
///
/// # Errors
///
/// In words, for a picture that is damaged, too large or of no known format.
pub(super) fn decode(
    bytes: &[u8],
    extension: Option<&str>,
    report: &mut Report,
) -> Result<Texture, String> {
    let format = image::guess_format(bytes)
        .ok()
        .or_else(|| extension.and_then(ImageFormat::from_extension))
        .ok_or("its format is not known; it must be PNG, JPEG, WebP, BMP, TGA, TIFF or GIF")?;
    let reader = || ImageReader::with_format(Cursor::new(bytes), format);
    let words = |error: image::ImageError| crate::error::escape_controls(&error.to_string());
    let (columns, rows) = reader().into_dimensions().map_err(words)?;
    let side = report.settings.max_texture;
    // The four bytes of a texel.
    let bytes_needed = 4 * u64::from(columns) * u64::from(rows);
    if columns > side || rows > side || bytes_needed > u64::from(side).pow(2) {
        return Err(format!(
            "{columns} x {rows} texels are over the limit of {side} a side and {side} x {side} bytes \
             in all (--max-texture raises it)"
        ));
    }
    // Decoders hold the picture in their own layout beside the result.
    let left = report.budget.left();
    if 2 * bytes_needed > left {
        let [needed, left] = [2 * bytes_needed, left].map(size_in_words);
        return Err(format!(
            "it takes {needed} of memory, {left} are left of what is allowed (--max-memory raises the limit)"
        ));
    }
    // Charged before the work: a damaged picture is decoded up to the damage.
    let charged = report.budget.charge_texture(bytes_needed);
    // The system's own limit: as decoded, as four bytes a texel, and as the texture.
    let in_all = usize::try_from(3 * bytes_needed).unwrap_or(usize::MAX);
    let charged = charged.and_then(|()| check_free(in_all));
    charged.map_err(|fault| fault.into_error(report.source.path()).to_string())?;
    let mut reader = reader();
    let mut limits = Limits::default();
    // Decoders need memory of the same order beside the result.
    limits.max_alloc = Some(2 * u64::from(side).pow(2));
    reader.limits(limits);
    let texels = reader.decode().map_err(words)?.into_rgba8().into_raw();
    let (texels, _) = texels.as_chunks::<4>();
    let size = |side: u32| usize::try_from(side).unwrap_or(usize::MAX);
    Texture::new(size(columns), size(rows), texels.to_vec()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::LoadSettings;

    fn decoded(
        bytes: &[u8],
        extension: Option<&str>,
        settings: LoadSettings,
    ) -> Result<Texture, String> {
        let mut report = Report::new("a.obj".as_ref(), settings, &());
        decode(bytes, extension, &mut report)
    }

    fn png(columns: u32, rows: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        let size = (3 * columns * rows) as usize;
        let levels: Vec<u8> = (0_u8..=255).cycle().take(size).collect();
        writer.write_image_data(&levels).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn texels_come_row_by_row_from_the_top() {
        let texture = decoded(&png(3, 2), None, LoadSettings::default()).unwrap();
        assert_eq!((texture.columns(), texture.rows()), (3, 2));
        assert_eq!(texture.texels()[4], [12, 13, 14, 255]);
    }

    #[test]
    fn too_large_is_said_before_anything_is_decoded() {
        let mut bytes = png(40, 2);
        let small = LoadSettings { max_texture: 39, ..LoadSettings::default() };
        let error = decoded(&bytes, None, small).unwrap_err();
        assert!(error.contains("40"), "{error}");
        // A header that lies: 2^31 - 1 squared.
        bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        assert!(decoded(&bytes, None, LoadSettings::default()).is_err());
    }

    /// The memory is for the decoded picture and for the texture: four bytes a texel each.
    #[test]
    fn a_texture_takes_twice_its_texels_of_the_memory_allowed() {
        let bytes = png(256, 128);
        let with_left = |left| {
            let settings =
                LoadSettings { max_memory: left + bytes.len() as u64, ..LoadSettings::default() };
            let path = "a.png".as_ref();
            let mut report = Report::new(path, settings, &());
            report.budget.charge_read(path, bytes.len()).unwrap();
            decode(&bytes, None, &mut report)
        };
        let needed = 2 * 4 * 256 * 128;
        with_left(needed).unwrap();
        let error = with_left(needed - 1).unwrap_err();
        let words = "it takes 256 KiB of memory, 256 KiB are left of what is allowed (--max-memory raises the limit)";
        assert_eq!(error, words);
    }

    #[test]
    fn what_is_no_picture_is_said_to_be_none() {
        for bytes in [&b""[..], b"GIF89a", b"not a picture", &png(4, 4)[..60]] {
            assert!(decoded(bytes, Some("png"), LoadSettings::default()).is_err());
        }
    }
}
