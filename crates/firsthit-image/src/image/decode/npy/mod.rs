//! NumPy's arrays.

mod element;
mod header;
mod literal;
mod values;

pub use header::NpyHeader;
pub use values::NpyValues;

use super::output::{Array, ArrayValues, Output, elements};

/// One array without a name.
pub(in crate::image) fn decode(bytes: &[u8], most: u64) -> Result<Output, String> {
    let array = array(bytes, None, most)?;
    Ok(Output { arrays: vec![array], ..Output::default() })
}

/// An array of any type of number, of either byte order, in C or Fortran order.
pub(super) fn array(bytes: &[u8], name: Option<String>, most: u64) -> Result<Array, String> {
    let (header, data) = NpyHeader::parse(bytes)?;
    let (Some(dtype), claimed) = (header.dtype(), header.shape()) else {
        return Err(format!("expected numbers, got the type {}", header.descr()));
    };
    elements(claimed, 8, most)?;
    let numbers = match header.values(data)? {
        Some(NpyValues::Float64(values)) => ArrayValues::Float64(values),
        Some(NpyValues::Float32(values)) => ArrayValues::Float32(values),
        Some(NpyValues::Whole(values)) => ArrayValues::Integer(values),
        Some(NpyValues::Unsigned(values)) => ArrayValues::Integer(signed(values)?),
        None => return Err("expected numbers".to_owned()),
    };
    let shape: Vec<usize> = (claimed.iter())
        .map(|&side| usize::try_from(side).map_err(|error| error.to_string()))
        .collect::<Result<_, _>>()?;
    // The file does not tell: the third axis is taken for the components of a picture.
    let components = match shape.as_slice() {
        [_, _, components] => (*components).max(1),
        _ => 1,
    };
    Ok(Array { name, components, shape, numbers, dtype: dtype.to_owned(), is_picture: false })
}

fn signed(values: Vec<u64>) -> Result<Vec<i64>, String> {
    let signed: Result<Vec<i64>, _> = values.into_iter().map(i64::try_from).collect();
    signed.map_err(|_| "holds a whole number that 64 bits with a sign do not hold".to_owned())
}

/// The text in an array without dimensions.
pub(super) fn text(bytes: &[u8]) -> Result<String, String> {
    let (header, data) = NpyHeader::parse(bytes)?;
    let is_one = header.shape().iter().all(|&side| side == 1);
    let Some((length, is_big_endian)) = header.text().filter(|_| is_one) else {
        return Err(format!("expected a text, got the type {}", header.descr()));
    };
    let length = usize::try_from(length).map_err(|error| error.to_string())?;
    let (characters, _) = data.as_chunks::<4>();
    let characters = characters.iter().take(length).map(|&bytes| {
        let code =
            if is_big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) };
        char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
    });
    let text: String = characters.collect();
    // NumPy fills up with zeros.
    Ok(text.trim_end_matches('\0').to_owned())
}
