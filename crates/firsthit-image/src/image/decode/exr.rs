use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::block::UncompressedBlock;
use exr::block::reader::ChunksReader;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::{Vec2, f16};

use super::super::metadata::{ChannelRecord, Encoding, KEY, Metadata};
use super::output::{Array, ArrayValues, Output, collected, elements, metadata_of};

/// Every channel of every flat layer, at full resolution: components put together as the metadata
/// say, or as names that programs agree on do.
#[doc(hidden)]
pub fn decode(bytes: &[u8], most: u64) -> Result<Output, String> {
    // `exr` promises not to panic. Should it, that file is one that cannot be read, not the end of
    // the program.
    catch_unwind(AssertUnwindSafe(|| decode_checked(bytes, most)))
        .unwrap_or_else(|_| Err("not an EXR that can be read".to_owned()))
}

fn decode_checked(bytes: &[u8], most: u64) -> Result<Output, String> {
    let words = |error: exr::error::Error| crate::error::escape_controls(&error.to_string());
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(words)?;
    check_claims(reader.headers(), bytes.len(), most)?;
    let planes: Result<Vec<Planes>, String> = reader.headers().iter().map(Planes::of).collect();
    let mut planes = planes?;
    let mut output = Output::default();
    let text = reader.headers().iter().find_map(text);
    output.metadata = metadata_of(text.as_deref(), &mut output.notes);
    if reader.headers().iter().any(is_cropped) {
        let note = "its data window covers only part of its display window; the rest is missing";
        output.notes.push(note.to_owned());
    }
    let mut chunks = reader.all_chunks(false).map_err(words)?;
    let mut seen = 0;
    while let Some(chunk) = chunks.read_next_chunk() {
        let chunk = chunk.map_err(words)?;
        let meta = chunks.meta_data();
        let block = UncompressedBlock::decompress_chunk(chunk, meta, false).map_err(words)?;
        place(&block, meta, &mut planes);
        seen += 1;
    }
    let expected: usize =
        (chunks.meta_data().headers.iter()).map(|header| header.chunk_count).sum();
    if seen < expected {
        return Err(format!("holds {seen} blocks of {expected}"));
    }
    for layer in planes {
        output.arrays.extend(layer.into_arrays(output.metadata.as_ref())?);
    }
    Ok(output)
}

/// Refuses a file that claims more than it can hold, before memory is allocated.
fn check_claims(headers: &[Header], length: usize, most: u64) -> Result<(), String> {
    let mut total = 0_u64;
    for header in headers {
        if header.deep {
            return Err("deep data are not read".to_owned());
        }
        if (header.channels.list.iter()).any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err("channels of a lower resolution are not read".to_owned());
        }
        let Vec2(columns, rows) = header.layer_size;
        let channels = header.channels.list.len();
        elements(&[rows as u64, columns as u64, channels as u64], 8, most)?;
        let block = header.max_block_pixel_size();
        elements(&[block.x() as u64, block.y() as u64, channels as u64], 8, most)?;
        total =
            total.saturating_add((rows as u64 * columns as u64).saturating_mul(channels as u64));
    }
    elements(&[total], 8, most)?;
    // The best of the compressions packs to a thousandth.
    if total > 2048 * length as u64 {
        return Err(format!("{total} samples are more than the file can hold"));
    }
    Ok(())
}

/// Whether a layer lacks pixels of the picture. It may have more than all.
fn is_cropped(header: &Header) -> bool {
    let display = header.shared_attributes.display_window;
    let data = header.data_window();
    let (first, last) = (data.position, data.max());
    let (first_shown, last_shown) = (display.position, display.max());
    first.x() > first_shown.x()
        || first.y() > first_shown.y()
        || last.x() < last_shown.x()
        || last.y() < last_shown.y()
}

fn text(header: &Header) -> Option<String> {
    match header.own_attributes.other.get(&Text::new_or_none(KEY)?) {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    }
}

/// The samples of one layer, by the channels' names, as their 32 (or 16) bits.
struct Planes {
    prefix: String,
    rows: usize,
    columns: usize,
    types: BTreeMap<String, SampleType>,
    samples: BTreeMap<String, Vec<u32>>,
}

impl Planes {
    fn of(header: &Header) -> Result<Self, String> {
        let Vec2(columns, rows) = header.layer_size;
        let name = header.own_attributes.layer_name.as_ref();
        let mut planes = Self {
            prefix: name.map_or(String::new(), |name| format!("{name}.")),
            rows,
            columns,
            types: BTreeMap::new(),
            samples: BTreeMap::new(),
        };
        for channel in &header.channels.list {
            let count = rows * columns;
            let samples = collected(count, std::iter::repeat_n(0, count))?;
            let name = channel.name.to_string();
            planes.types.insert(name.clone(), channel.sample_type);
            planes.samples.insert(name, samples);
        }
        Ok(planes)
    }

    /// The channels that `metadata` know, then those that go together by convention, then the
    /// others.
    fn into_arrays(mut self, metadata: Option<&Metadata>) -> Result<Vec<Array>, String> {
        let mut arrays = Vec::new();
        let records = metadata.map_or(&[][..], |metadata| &metadata.channels);
        for ChannelRecord { name, stored, .. } in records {
            if let Some(stored) = stored {
                let is_signed = stored.encoding == Encoding::TwosComplement;
                arrays.extend(self.take(name, &stored.names, is_signed)?);
            }
        }
        for (name, components) in CUSTOM {
            let names: Vec<String> = components.iter().map(|&name| name.to_owned()).collect();
            arrays.extend(self.take(name, &names, false)?);
        }
        let others: Vec<String> = self.samples.keys().cloned().collect();
        for name in others {
            let full = format!("{}{name}", self.prefix);
            arrays.extend(self.take(&full, &[name], false)?);
        }
        Ok(arrays)
    }

    /// The channels called `names` as one array, if all are there and of one type; they are then
    /// gone.
    fn take(
        &mut self,
        name: &str,
        names: &[String],
        is_signed: bool,
    ) -> Result<Option<Array>, String> {
        let Some(&kind) = names.first().and_then(|name| self.types.get(name)) else {
            return Ok(None);
        };
        let is_there =
            |name: &String| self.samples.contains_key(name) && self.types.get(name) == Some(&kind);
        if !names.iter().all(is_there) {
            return Ok(None);
        }
        let planes: Vec<Vec<u32>> =
            (names.iter()).filter_map(|name| self.samples.remove(name)).collect();
        // A record that names a channel twice.
        if planes.len() != names.len() {
            return Ok(None);
        }
        let (dtype, numbers) = interleaved(&planes, kind, is_signed)?;
        let shape = vec![self.rows, self.columns];
        let array = Array::new(Some(name), shape, names.len(), numbers, dtype, false);
        Ok(Some(array))
    }
}

/// The samples of several planes, all of the first pixel, then all of the second; and their type's
/// name.
fn interleaved(
    planes: &[Vec<u32>],
    kind: SampleType,
    is_signed: bool,
) -> Result<(&'static str, ArrayValues), String> {
    let pixels = planes.first().map_or(0, Vec::len);
    let count = pixels * planes.len();
    let of_pixel = |k: usize| planes.iter().filter_map(move |plane| plane.get(k).copied());
    let bits = (0..pixels).flat_map(of_pixel);
    Ok(match kind {
        SampleType::F32 => {
            let singles = collected(count, bits.map(f32::from_bits))?;
            ("float32", ArrayValues::Float32(singles))
        }
        SampleType::F16 => {
            let singles = collected(count, bits.map(half))?;
            ("float16", ArrayValues::Float32(singles))
        }
        SampleType::U32 if is_signed => {
            let signed = collected(count, bits.map(|bits| i64::from(bits.cast_signed())))?;
            ("uint32", ArrayValues::Integer(signed))
        }
        SampleType::U32 => {
            let unsigned = collected(count, bits.map(i64::from))?;
            ("uint32", ArrayValues::Integer(unsigned))
        }
    })
}

/// The common names of a picture's components.
const CUSTOM: [(&str, &[&str]); 4] = [
    ("color", &["R", "G", "B"]),
    ("z", &["Z"]),
    ("normal", &["N.X", "N.Y", "N.Z"]),
    ("position", &["P.X", "P.Y", "P.Z"]),
];

fn half(bits: u32) -> f32 {
    u16::try_from(bits).map_or(f32::NAN, |bits| f16::from_bits(bits).to_f32())
}

/// Copies the samples of a block to where they belong. Smaller resolutions are left out.
fn place(block: &UncompressedBlock, meta: &MetaData, layers: &mut [Planes]) {
    let index = block.index;
    let (Some(header), Some(layer)) = (meta.headers.get(index.layer), layers.get_mut(index.layer))
    else {
        return;
    };
    if index.level != Vec2(0, 0) {
        return;
    }
    let mut data = block.data.as_slice();
    for row in index.pixel_position.y()..index.pixel_position.y() + index.pixel_size.y() {
        for channel in &header.channels.list {
            let size = if channel.sample_type == SampleType::F16 { 2 } else { 4 };
            let Some((line, rest)) = data.split_at_checked(index.pixel_size.x() * size) else {
                return;
            };
            data = rest;
            let first = row * layer.columns + index.pixel_position.x();
            let plane = layer.samples.get_mut(&channel.name.to_string());
            let Some(places) =
                plane.and_then(|plane| plane.get_mut(first..first + index.pixel_size.x()))
            else {
                return;
            };
            for (place, sample) in places.iter_mut().zip(line.chunks_exact(size)) {
                *place = match *sample {
                    [a, b] => u32::from(u16::from_ne_bytes([a, b])),
                    [a, b, c, d] => u32::from_ne_bytes([a, b, c, d]),
                    _ => 0,
                };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use exr::prelude::{Image, IntegerBounds, SpecificChannels, WritableImage};

    use super::*;

    #[test]
    fn a_part_of_a_picture_is_told() {
        for (position, end, told) in [
            ((0, 0), (16, 8), 0),
            ((4, 2), (32, 16), 1),
            ((0, 0), (16, 9), 1),
            // More than all.
            ((-2, -1), (12, 6), 0),
        ] {
            let channels = SpecificChannels::rgb(|_| (0.5_f32, 0.25_f32, 1.0_f32));
            let mut image = Image::from_channels((16, 8), channels);
            image.layer_data.attributes.layer_position = position.into();
            image.attributes.display_window = IntegerBounds::new((0, 0), end);
            let mut bytes = Cursor::new(Vec::new());
            image.write().to_buffered(&mut bytes).unwrap();
            let output = decode(bytes.get_ref(), 1 << 20).unwrap();
            assert_eq!(output.notes.len(), told, "{:?}", output.notes);
            assert_eq!(output.arrays[0].shape[..2], [8, 16]);
        }
    }
}
