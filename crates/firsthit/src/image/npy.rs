use std::io::{self, Write};

use npyz::{DType, TypeStr, WriteOptions, WriterBuilder};

use super::{Channel, Data};

/// How many values are turned into bytes at a time: the buffer of 64 KiB stays in the cache.
const CHUNK: usize = 8192;

/// Writes one channel as an NPY array of `shape`, followed by the components if there are several.
pub(super) fn encode(shape: &[usize], channel: &Channel, out: &mut dyn Write) -> io::Result<()> {
    let mut shape: Vec<u64> = shape.iter().map(|&side| side as u64).collect();
    if channel.components > 1 {
        shape.push(channel.components as u64);
    }
    WriteOptions::new_header_only()
        .dtype(dtype(&channel.data))
        .shape(&shape)
        .writer(&mut *out)
        .write_header_only()?;
    match &channel.data {
        Data::Float64(values) => write_values(values, f64::to_le_bytes, out),
        Data::Float32(values) => write_values(values, f32::to_le_bytes, out),
        Data::Int32(values) => write_values(values, i32::to_le_bytes, out),
        Data::Bool(values) => write_values(values, |value| [u8::from(value)], out),
    }
}

/// Writes a text as NumPy does: an array without dimensions, of UTF-32.
pub(super) fn encode_text(text: &str, out: &mut dyn Write) -> io::Result<()> {
    let characters: Vec<u32> = text.chars().map(u32::from).collect();
    let kind: TypeStr = (format!("<U{}", characters.len()).parse())
        .expect("a number of characters is NumPy's name of a text's type");
    WriteOptions::new_header_only()
        .dtype(DType::Plain(kind))
        .shape(&[])
        .writer(&mut *out)
        .write_header_only()?;
    write_values(&characters, u32::to_le_bytes, out)
}

/// Little-endian on every machine.
fn dtype(data: &Data) -> DType {
    let name = match data {
        Data::Float64(_) => "<f8",
        Data::Float32(_) => "<f4",
        Data::Int32(_) => "<i4",
        Data::Bool(_) => "|b1",
    };
    let name: TypeStr = name.parse().expect("these four are NumPy's own names");
    DType::Plain(name)
}

/// By chunks: `npyz` would write value by value.
fn write_values<T: Copy, const BYTES: usize>(
    values: &[T],
    bytes_of: impl Fn(T) -> [u8; BYTES],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut bytes = vec![0; CHUNK.min(values.len()) * BYTES];
    for chunk in values.chunks(CHUNK) {
        let bytes = &mut bytes[..chunk.len() * BYTES];
        for (place, &value) in bytes.chunks_exact_mut(BYTES).zip(chunk) {
            place.copy_from_slice(&bytes_of(value));
        }
        out.write_all(bytes)?;
    }
    Ok(())
}
