use std::io::{self, Write};

use super::frame::{Channel, Data};

/// The number of values that are turned into bytes at a time: the buffer of 64 KiB stays in the
/// cache.
const CHUNK: usize = 8192;

/// Writes one channel as an NPY array of `shape`, followed by the components if there are several.
pub(super) fn encode(shape: &[usize], channel: &Channel, out: &mut dyn Write) -> io::Result<()> {
    let mut shape = shape.to_vec();
    if channel.components > 1 {
        shape.push(channel.components);
    }
    // Little-endian on every machine.
    let descr = match channel.data {
        Data::Float64(_) => "<f8",
        Data::Float32(_) => "<f4",
        Data::Int32(_) => "<i4",
        Data::Bool(_) => "|b1",
    };
    write_header(descr, &shape, out)?;
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
    write_header(&format!("<U{}", characters.len()), &[], out)?;
    write_values(&characters, u32::to_le_bytes, out)
}

/// Writes the header of version 1.0 (`numpy.lib.format`): a dictionary as a Python literal, filled
/// up so that the data begins at a multiple of 64 bytes.
fn write_header(descr: &str, shape: &[usize], out: &mut dyn Write) -> io::Result<()> {
    const ALIGNMENT: usize = 64;
    const BEFORE: usize = 10;
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (");
    for side in shape {
        header += &side.to_string();
        header += ", ";
    }
    header += "), }";
    // The line break is the last byte.
    let end = (BEFORE + header.len() + 1).next_multiple_of(ALIGNMENT);
    let room = end - BEFORE - 1 - header.len();
    header.extend(std::iter::repeat_n(' ', room));
    header.push('\n');
    let length = u16::try_from(header.len()).map_err(io::Error::other)?;
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(header.as_bytes())
}

/// Writes values by chunks: one value after the other would be a call for each.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_header(descr, shape, &mut bytes).unwrap();
        bytes
    }

    #[test]
    fn headers_are_these_bytes() {
        let start = b"\x93NUMPY\x01\x00\x76\x00{'descr': '<f4', 'fortran_order': False, 'shape': (30, 40, 3, ), }";
        let mut expected = start.to_vec();
        expected.resize(127, b' ');
        expected.push(b'\n');
        assert_eq!(header("<f4", &[30, 40, 3]), expected);
        let text = header("<U5", &[]);
        let start =
            b"\x93NUMPY\x01\x00\x76\x00{'descr': '<U5', 'fortran_order': False, 'shape': (), }   ";
        assert!(text.starts_with(start));
    }

    #[test]
    fn data_begins_at_a_multiple_of_64_bytes_whatever_the_header() {
        for digits in 1..18 {
            let shape = [10_usize.pow(digits); 3];
            let bytes = header("|b1", &shape);
            assert_eq!(bytes.len() % 64, 0, "{digits}");
            assert_eq!(bytes.last(), Some(&b'\n'));
        }
    }
}
