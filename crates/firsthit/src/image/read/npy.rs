use std::io;

use npyz::{DType, Deserialize, NpyFile, NpyHeader, Order, TypeChar, TypeStr};

use super::{Array, Numbers, Output, elements};

/// One array without a name.
pub(in crate::image) fn decode(bytes: &[u8], most: u64) -> Result<Output, String> {
    let array = array(bytes, None, most)?;
    Ok(Output {
        arrays: vec![array],
        ..Output::default()
    })
}

/// An array of any type of number, of either byte order, in C or Fortran order.
pub(super) fn array(bytes: &[u8], name: Option<String>, most: u64) -> Result<Array, String> {
    let (header, data) = header(bytes)?;
    let kind = plain(&header)?;
    let size = kind.num_bytes().unwrap_or(1).max(1);
    let claimed = header.shape().to_vec();
    let count = elements(&claimed, 8, most)?;
    if count
        .checked_mul(size)
        .is_none_or(|needed| needed > data.len())
    {
        return Err(format!(
            "the array of shape {claimed:?} is longer than the file, which holds {} bytes of it",
            data.len()
        ));
    }
    let shape: Vec<usize> = (claimed.iter())
        .map(|&side| usize::try_from(side).map_err(|error| error.to_string()))
        .collect::<Result<_, _>>()?;
    let order = header.order();
    let file = NpyFile::with_header(header, data);
    let (dtype, numbers) = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 8) => ("float64", Numbers::Float64(values(file)?)),
        (TypeChar::Float, 4) => ("float32", Numbers::Float32(values(file)?)),
        (TypeChar::Bool, 1) => {
            let flags = values::<bool>(file)?;
            (
                "bool",
                Numbers::Integer(flags.into_iter().map(i64::from).collect()),
            )
        }
        (TypeChar::Int, 8) => ("int64", Numbers::Integer(values(file)?)),
        (TypeChar::Int, 4) => ("int32", whole::<i32>(file)?),
        (TypeChar::Int, 2) => ("int16", whole::<i16>(file)?),
        (TypeChar::Int, 1) => ("int8", whole::<i8>(file)?),
        (TypeChar::Uint, 8) => ("uint64", whole::<u64>(file)?),
        (TypeChar::Uint, 4) => ("uint32", whole::<u32>(file)?),
        (TypeChar::Uint, 2) => ("uint16", whole::<u16>(file)?),
        (TypeChar::Uint, 1) => ("uint8", whole::<u8>(file)?),
        _ => return Err(format!("expected numbers, got the type {kind}")),
    };
    let numbers = match order {
        Order::C => numbers,
        Order::Fortran => in_c_order(numbers, &shape),
    };
    // Without anybody to tell, the third axis is taken for the components of a picture.
    let components = match shape.as_slice() {
        [_, _, components] => (*components).max(1),
        _ => 1,
    };
    Ok(Array {
        name,
        components,
        shape,
        numbers,
        dtype: dtype.to_owned(),
        is_picture: false,
    })
}

/// The text in an array without dimensions.
pub(super) fn text(bytes: &[u8]) -> Result<String, String> {
    let (header, data) = header(bytes)?;
    let kind = plain(&header)?;
    if kind.type_char() != TypeChar::UnicodeStr || header.shape().iter().any(|&side| side != 1) {
        return Err(format!("expected a text, got the type {kind}"));
    }
    let length = usize::try_from(kind.size_field()).map_err(|error| error.to_string())?;
    let is_big_endian = kind.to_string().starts_with('>');
    let characters = data.chunks_exact(4).take(length).map(|bytes| {
        let bytes = <[u8; 4]>::try_from(bytes).unwrap_or_default();
        let code = if is_big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        };
        char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
    });
    let text: String = characters.collect();
    // NumPy fills up with zeros.
    Ok(text.trim_end_matches('\0').to_owned())
}

fn header(bytes: &[u8]) -> Result<(NpyHeader, &[u8]), String> {
    check_claims(bytes)?;
    let mut data = bytes;
    let header = NpyHeader::from_reader(&mut data).map_err(|error| one_line(&error))?;
    Ok((header, data))
}

fn plain(header: &NpyHeader) -> Result<TypeStr, String> {
    match header.dtype() {
        DType::Plain(kind) => Ok(kind),
        _ => Err("expected plain numbers, got records".to_owned()),
    }
}

fn values<T: Deserialize>(file: NpyFile<&[u8]>) -> Result<Vec<T>, String> {
    file.into_vec::<T>().map_err(|error| one_line(&error))
}

fn whole<T: Deserialize + TryInto<i64>>(file: NpyFile<&[u8]>) -> Result<Numbers, String> {
    let whole = values::<T>(file)?.into_iter().map(TryInto::try_into);
    let whole: Result<Vec<i64>, _> = whole.collect();
    whole
        .map(Numbers::Integer)
        .map_err(|_| "holds a whole number that 64 bits with a sign do not hold".to_owned())
}

/// Column by column to row by row.
fn in_c_order(numbers: Numbers, shape: &[usize]) -> Numbers {
    match numbers {
        Numbers::Float64(values) => Numbers::Float64(reordered(&values, shape)),
        Numbers::Float32(values) => Numbers::Float32(reordered(&values, shape)),
        Numbers::Integer(values) => Numbers::Integer(reordered(&values, shape)),
    }
}

fn reordered<T: Copy>(values: &[T], shape: &[usize]) -> Vec<T> {
    let place = |index: usize| {
        // The last axis runs fastest here and slowest there.
        let (mut rest, mut stride, mut place) = (index, values.len(), 0);
        for &side in shape.iter().rev() {
            stride /= side;
            place += rest % side * stride;
            rest /= side;
        }
        place
    };
    (0..values.len())
        .filter_map(|index| values.get(place(index)).copied())
        .collect()
}

/// Refuses an NPY file whose header claims what no file has, before somebody takes memory for it or multiplies
/// its numbers without minding where that leads.
///
/// # Errors
///
/// In words, what is wrong.
pub fn check_claims(bytes: &[u8]) -> Result<(), String> {
    check_header_length(bytes)?;
    let header = bytes.get(..bytes.len().min(1 << 16)).unwrap_or_default();
    let header = String::from_utf8_lossy(header);
    let Some((_, rest)) = header.split_once("shape") else {
        return Ok(());
    };
    let shape = rest.split(')').next().unwrap_or_default();
    let sizes = shape.split(|c: char| !c.is_ascii_digit());
    let mut elements = 1_u64;
    for size in sizes.filter(|size| !size.is_empty()) {
        let size: u64 = size.parse().unwrap_or(u64::MAX);
        elements = elements.saturating_mul(size.max(1));
    }
    if elements > 1 << 48 {
        return Err("the array is longer than the file".to_owned());
    }
    Ok(())
}

/// Refuses a header that is longer than the file, before somebody takes memory for it.
fn check_header_length(bytes: &[u8]) -> Result<(), String> {
    // After six bytes of magic the version: one of two bytes for the length, later ones of four.
    let length = match bytes.get(6..12) {
        Some(&[0 | 1, _, a, b, ..]) => u64::from(u16::from_le_bytes([a, b])),
        Some(&[_, _, a, b, c, d]) => u64::from(u32::from_le_bytes([a, b, c, d])),
        _ => return Ok(()),
    };
    if length > bytes.len() as u64 {
        return Err(format!(
            "the header of {length} bytes is longer than the file"
        ));
    }
    // Those of plain arrays have a hundred.
    if length > LONGEST_HEADER {
        return Err(format!(
            "the header of {length} bytes is over the limit of {LONGEST_HEADER}"
        ));
    }
    let end = usize::try_from(length).map_or(bytes.len(), |length| bytes.len().min(12 + length));
    check_nesting(bytes.get(8..end).unwrap_or_default())
}

const LONGEST_HEADER: u64 = 1 << 16;

/// Refuses brackets in brackets that no array of numbers has: the crate that reads headers takes twice the
/// time for each level.
fn check_nesting(header: &[u8]) -> Result<(), String> {
    let mut depth = 0_u32;
    for byte in header {
        match byte {
            b'[' | b'(' | b'{' => depth += 1,
            b']' | b')' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > 8 {
            return Err("the header's brackets are nested more than 8 deep".to_owned());
        }
    }
    Ok(())
}

/// The first line of a message: the rest of it are drawings.
fn one_line(error: &io::Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default().trim();
    format!("not a NumPy array: {}", crate::error::escape_controls(line))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_that_is_longer_than_the_file_takes_no_memory() {
        // Found by fuzzing: a length of 660 million.
        let mut bytes = b"\x93NUMPY\x03\x00\x76\x00\x7b\x27desc".to_vec();
        bytes.resize(214, b' ');
        let error = decode(&bytes, 1 << 20).unwrap_err();
        assert_eq!(
            error,
            "the header of 662372470 bytes is longer than the file"
        );
    }
    #[test]
    fn brackets_in_brackets_take_no_time() {
        let mut bytes = b"\x93NUMPY\x01\x00\x10\x27{'descr': ".to_vec();
        bytes.resize(10_012, b'[');
        let error = decode(&bytes, 1 << 20).unwrap_err();
        assert_eq!(error, "the header's brackets are nested more than 8 deep");
    }
}
