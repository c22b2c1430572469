use std::io::{self, Cursor, Write};

use exr::block::writer::ChunksWriter;
use exr::block::{UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::meta::BlockDescription;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, Chromaticities, LineOrder, SampleType, Text,
};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use exr::prelude::{Compression, Vec2};

use super::content::{Content, check_float32, picture_sides};
use super::cryptomatte::{self, Cryptomatte};
use super::frame::{Channel, Data, Display};
use super::metadata::{Encoding, KEY, Stored};
use crate::error::Result;
use crate::geometry::single;
use crate::parallel;

/// Every sample has 32 bits.
const BYTES: usize = 4;

/// Refuses a frame that is no picture, and finite numbers that float32 would make infinite.
pub(super) fn check(content: &Content<'_>) -> Result<()> {
    picture_sides(content.shape, "[rows, columns], each from 1 to 2^31 - 1, for an EXR")?;
    let expected = "in the range of float32 for an EXR (or use npz)";
    let mut channels = content.channels.iter();
    channels.try_for_each(|channel| check_float32(channel, content.shape, expected))
}

/// The record of an EXR's channel: by the names that programs look for, where there are such.
pub(super) fn stored(channel: &Channel) -> Stored {
    let names = match (&*channel.name, channel.components) {
        (name, components) if channel.display == Display::Matte => {
            let layers = cryptomatte::layers(name);
            let name = |component| cryptomatte::plane_name(&layers, component);
            (0..components).map(name).collect()
        }
        (name, components) if channel.display == Display::Quantity && components > 1 => {
            (0..components).map(|k| format!("{name}.{k}")).collect()
        }
        ("color", 3) => ["R", "G", "B"].map(str::to_owned).to_vec(),
        // OpenEXR's colours are premultiplied, as ours are.
        ("color", 4) => ["R", "G", "B", "A"].map(str::to_owned).to_vec(),
        ("z", 1) => vec!["Z".to_owned()],
        (name, 1) => vec![name.to_owned()],
        (name, 2) => ["U", "V"].map(|axis| format!("{name}.{axis}")).to_vec(),
        ("normal", 3) => ["N.X", "N.Y", "N.Z"].map(str::to_owned).to_vec(),
        ("position", 3) => ["P.X", "P.Y", "P.Z"].map(str::to_owned).to_vec(),
        ("base_color", 3) => ["R", "G", "B"].map(|level| format!("base_color.{level}")).to_vec(),
        (name, components) => (0..components).map(|k| format!("{name}.{k}")).collect(),
    };
    match channel.data {
        Data::Float64(_) => Stored::new(names, "float32", Encoding::Rounded, channel.miss()),
        Data::Float32(_) => Stored::new(names, "float32", Encoding::Exact, channel.miss()),
        Data::Int32(_) => Stored::new(names, "uint32", Encoding::TwosComplement, "4294967295"),
        Data::Bool(_) => Stored::new(names, "uint32", Encoding::Exact, "0"),
    }
}

/// Writes scan lines in blocks of 16, compressed by ZIP, with all threads of the current rayon
/// pool. The compressed file is in memory before it is written, because its table of contents comes
/// first.
pub(super) fn encode(content: &Content<'_>, out: &mut dyn Write) -> io::Result<()> {
    let &[rows, columns] = content.shape else {
        return Err(io::Error::other("not a picture"));
    };
    // In the order of their names, which is the order of the file.
    let mut planes: Vec<Plane<'_>> = content.channels.iter().copied().flat_map(planes).collect();
    planes.sort_by(|a, b| a.name.cmp(&b.name));
    let header = header(content, &planes, (rows, columns));
    let mut file = Cursor::new(Vec::new());
    let written = exr::block::write(&mut file, vec![header].into(), true, |meta, writer| {
        let blocks: Vec<_> = enumerate_ordered_header_block_indices(&meta.headers).collect();
        // Enough for all threads, little beside the picture.
        for blocks in blocks.chunks(8 * rayon::current_num_threads()) {
            let compress = |&(place, index)| {
                if content.watch.is_stopped() {
                    return Err(exr::error::Error::Aborted);
                }
                let data = block(&planes, columns, index);
                let chunk = UncompressedBlock { index, data }.compress_to_chunk(&meta.headers);
                chunk.map(|chunk| (place, chunk))
            };
            for chunk in parallel::map(blocks, compress) {
                let (place, chunk) = chunk?;
                writer.write_chunk(place, chunk)?;
            }
        }
        Ok(())
    });
    written.map_err(|error| io::Error::other(error.to_string()))?;
    let mut file = file.into_inner();
    if !content.metadata.cryptomatte.is_empty() {
        sort_attributes(&mut file);
    }
    out.write_all(&file)
}

/// Sorts the attributes of the header by their names: where there are several of our own, `exr`
/// writes them in no fixed order. None becomes longer, so everything after them stays where it is.
fn sort_attributes(file: &mut [u8]) {
    /// The magic number and the version.
    const BEFORE: usize = 8;
    let text_end = |from: usize| {
        let end = file[from..].iter().position(|&byte| byte == 0);
        from + end.expect("texts of a header end in 0") + 1
    };
    let (mut attributes, mut at) = (Vec::new(), BEFORE);
    while file[at] != 0 {
        let name_end = text_end(at);
        let size_at = text_end(name_end);
        let size = file[size_at..].first_chunk().copied().map(u32::from_le_bytes);
        let size = size.expect("an attribute has a size") as usize;
        let end = size_at + 4 + size;
        attributes.push((file[at..name_end].to_vec(), file[at..end].to_vec()));
        at = end;
    }
    attributes.sort();
    let sorted: Vec<u8> = attributes.into_iter().flat_map(|(_, bytes)| bytes).collect();
    file[BEFORE..at].copy_from_slice(&sorted);
}

/// One component of a channel, under its name in the file.
struct Plane<'a> {
    name: String,
    channel: &'a Channel,
    component: usize,
}

fn planes(channel: &Channel) -> impl Iterator<Item = Plane<'_>> {
    let names = stored(channel).names.into_iter().enumerate();
    names.map(move |(component, name)| Plane { name, channel, component })
}

fn header(content: &Content<'_>, planes: &[Plane<'_>], (rows, columns): (usize, usize)) -> Header {
    let described = planes.iter().map(|plane| {
        let sample_type = match plane.channel.data {
            Data::Float64(_) | Data::Float32(_) => SampleType::F32,
            Data::Int32(_) | Data::Bool(_) => SampleType::U32,
        };
        let name = Text::new_or_panic(&plane.name);
        ChannelDescription::new(name, sample_type, plane.channel.display != Display::Color)
    });
    let metadata = &content.metadata;
    let mut own = LayerAttributes {
        layer_name: None,
        software_name: Text::new_or_none(format!("firsthit {}", metadata.firsthit)),
        ..LayerAttributes::default()
    };
    let said = [(KEY.to_owned(), metadata.to_json())];
    let mattes = metadata.cryptomatte.values();
    let said = said.into_iter().chain(mattes.flat_map(Cryptomatte::attributes));
    for (name, text) in said {
        let text = AttributeValue::Text(Text::new_or_panic(text));
        own.other.insert(Text::new_or_panic(name), text);
    }
    let shared = ImageAttributes {
        chromaticities: Some(REC_709),
        ..ImageAttributes::with_size((columns, rows))
    };
    Header::new(Text::default(), (columns, rows), described.collect())
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_shared_attributes(shared)
        .with_attributes(own)
}

/// The primaries and the white (D65) of ITU-R BT.709.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// The bytes of some rows: of each row all planes, of each plane all columns.
fn block(planes: &[Plane<'_>], columns: usize, index: exr::block::BlockIndex) -> Vec<u8> {
    let (first, rows) = (index.pixel_position.y(), index.pixel_size.y());
    let mut bytes = Vec::with_capacity(rows * columns * planes.len() * BYTES);
    for row in first..first + rows {
        for plane in planes {
            let components = plane.channel.components;
            let places = row * columns * components..(row + 1) * columns * components;
            let places = places.skip(plane.component).step_by(components);
            match &plane.channel.data {
                Data::Float64(values) => {
                    bytes.extend(places.flat_map(|k| single(values[k]).to_ne_bytes()));
                }
                Data::Float32(values) => bytes.extend(places.flat_map(|k| values[k].to_ne_bytes())),
                Data::Int32(values) => bytes.extend(places.flat_map(|k| values[k].to_ne_bytes())),
                Data::Bool(values) => {
                    bytes.extend(places.flat_map(|k| u32::from(values[k]).to_ne_bytes()));
                }
            }
        }
    }
    bytes
}
