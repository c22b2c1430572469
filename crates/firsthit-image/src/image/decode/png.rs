use std::io::{Cursor, ErrorKind};

use png::{BitDepth, Decoder, DecodingError, Limits, Transformations};

use super::super::metadata::{Encoding, KEY};
use super::output::{Array, ArrayValues, Output, collected, elements, metadata_of, only_channel};

/// The picture: distances where it holds steps of them, else its samples.
pub(in crate::image) fn decode(bytes: &[u8], most: u64) -> Result<Output, String> {
    let limits = Limits { bytes: usize::try_from(most).unwrap_or(usize::MAX) };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|error| in_words(&error, bytes.len()))?;
    let (columns, rows) = (reader.info().width, reader.info().height);
    let (color, depth) = reader.output_color_type();
    let components = color.samples();
    let shape = [rows.into(), columns.into(), components as u64];
    let count = elements(&shape, 8, most)?;
    // Deflate packs to a thousandth at best: a small file that claims a large picture holds none.
    if count as u64 / 8 > 2048 * bytes.len() as u64 {
        return Err(format!("{columns} x {rows} pixels are more than the file can hold"));
    }
    let size = reader.output_buffer_size().ok_or("is too large")?;
    let mut samples = collected(size, std::iter::repeat_n(0, size))?;
    reader.next_frame(&mut samples).map_err(|error| in_words(&error, bytes.len()))?;
    let mut output = Output::default();
    let texts = &reader.info().uncompressed_latin1_text;
    let text = texts.iter().find(|text| text.keyword == KEY);
    let text = text.map(|text| text.text.as_str());
    output.metadata = metadata_of(text, &mut output.notes);
    let (dtype, whole) = match depth {
        BitDepth::Sixteen => ("uint16", collected(count, sixteen(&samples))?),
        _ => ("uint8", collected(count, samples.into_iter().map(i64::from))?),
    };
    let channel = only_channel(output.metadata.as_ref());
    let (numbers, is_picture) = match channel {
        Some((_, Encoding::Steps, Some(scale))) => (distances(&whole, scale)?, false),
        Some((_, Encoding::Labels, _)) => {
            let identifiers = whole.iter().map(|label| label - 1);
            (ArrayValues::Integer(collected(count, identifiers)?), false)
        }
        Some((_, Encoding::Picture, _)) | None => (ArrayValues::Integer(whole), true),
        Some(_) => (ArrayValues::Integer(whole), false),
    };
    let shape = vec![rows as usize, columns as usize];
    let name = channel.map(|(name, _, _)| name);
    let array = Array::new(name, shape, components, numbers, dtype, is_picture);
    output.arrays.push(array);
    Ok(output)
}

/// The reason why there is no picture. The crate's own words hold names of its types.
fn in_words(error: &DecodingError, length: usize) -> String {
    match error {
        DecodingError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            format!("truncated: the picture goes on where the file ends, at byte {length}")
        }
        DecodingError::Format(_) => {
            "not a PNG, or a damaged one: its chunks are not what the format asks for".to_owned()
        }
        DecodingError::IoError(_) | DecodingError::Parameter(_) => {
            "not a PNG that can be read".to_owned()
        }
        DecodingError::LimitsExceeded => "takes more memory than is allowed".to_owned(),
    }
}

fn sixteen(samples: &[u8]) -> impl Iterator<Item = i64> {
    let number = |pair| u16::from_be_bytes(<[u8; 2]>::try_from(pair).unwrap_or_default());
    samples.chunks_exact(2).map(move |pair| number(pair).into())
}

/// Steps as distances: 0 is a miss.
fn distances(steps: &[i64], scale: f64) -> Result<ArrayValues, String> {
    let distance = |&steps: &i64| {
        if steps == 0 { f64::INFINITY } else { scale * steps as f64 }
    };
    collected(steps.len(), steps.iter().map(distance)).map(ArrayValues::Float64)
}
