//! Rays as NumPy arrays.

use std::io::{self, Cursor, Read};

use firsthit::image::check_npy_claims;
use npyz::{DType, Deserialize, NpyFile, NpyHeader, Order, TypeChar};

use super::Table;

/// What an entry of an archive may unpack to: a small file can claim, and even hold, far more than the
/// memory takes. 89 million rays fit in.
const MOST_BYTES: u64 = 1 << 32;

/// The arrays in an archive: origins and directions, or both in one.
pub(super) fn npz(bytes: Vec<u8>) -> Result<Vec<Table>, String> {
    let mut archive =
        zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let names: Vec<String> = archive
        .file_names()
        .filter_map(|name| Some(name.ok()?.into_owned()))
        .collect();
    let pick = |wanted: &[&str]| {
        let entries = wanted.iter().map(|wanted| format!("{wanted}.npy"));
        entries.into_iter().find(|entry| names.contains(entry))
    };
    let mut table = |name: &str| {
        let mut entry = archive
            .by_name(name)
            .map_err(|error| format!("{name}: {error}"))?;
        let mut bytes = Vec::new();
        let read = entry.by_ref().take(MOST_BYTES + 1).read_to_end(&mut bytes);
        read.map_err(|error| format!("{name}: {error}"))?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(format!("{name}: is over the limit of {MOST_BYTES} bytes"));
        }
        npy(&bytes).map_err(|error| format!("{name}: {error}"))
    };
    if let Some(rays) = pick(&["rays"]) {
        return Ok(vec![table(&rays)?]);
    }
    let origins = pick(&["origins", "origin"]);
    let directions = pick(&["directions", "direction", "dir"]);
    match (origins, directions) {
        (Some(origins), Some(directions)) => Ok(vec![table(&origins)?, table(&directions)?]),
        _ => Err(format!(
            "expected entries origins and directions, or rays; got {}",
            crate::console::in_words(names.into_iter())
        )),
    }
}

/// An array of shape (n, columns) of any type of number, of either byte order, in C or Fortran order.
pub(super) fn npy(bytes: &[u8]) -> Result<Table, String> {
    check_npy_claims(bytes)?;
    let mut data = bytes;
    let header = NpyHeader::from_reader(&mut data).map_err(|error| one_line(&error))?;
    let file = NpyFile::with_header(header, data);
    let &[rows, columns] = file.shape() else {
        let shape = file.shape();
        return Err(format!(
            "expected an array of shape (n, 6) or (n, 3), got {shape:?}"
        ));
    };
    let DType::Plain(kind) = file.dtype() else {
        return Err("expected plain numbers, got records".into());
    };
    let size = kind.num_bytes().unwrap_or(1).max(1);
    let (rows, columns) = whole(rows, columns, data.len() / size)?;
    let order = file.order();
    let values = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 8) => plain(file, |x: f64| x),
        (TypeChar::Float, 4) => plain(file, <f64 as From<f32>>::from),
        (TypeChar::Int, 4) => plain(file, <f64 as From<i32>>::from),
        (TypeChar::Int, 8) => plain(file, |x: i64| x as f64),
        (TypeChar::Int, 2) => plain(file, <f64 as From<i16>>::from),
        (TypeChar::Int, 1) => plain(file, <f64 as From<i8>>::from),
        (TypeChar::Uint, 4) => plain(file, <f64 as From<u32>>::from),
        (TypeChar::Uint, 8) => plain(file, |x: u64| x as f64),
        (TypeChar::Uint, 2) => plain(file, <f64 as From<u16>>::from),
        (TypeChar::Uint, 1) => plain(file, <f64 as From<u8>>::from),
        _ => {
            return Err(format!(
                "expected floats (32 or 64 bit) or integers, got {kind}"
            ));
        }
    };
    let values = values.map_err(|error| one_line(&error))?;
    let values = match order {
        Order::C => values,
        Order::Fortran => (0..rows * columns)
            .map(|k| values[k % columns * rows + k / columns])
            .collect(),
    };
    Ok(Table { columns, values })
}

fn plain<T: Deserialize>(file: NpyFile<&[u8]>, convert: impl Fn(T) -> f64) -> io::Result<Vec<f64>> {
    Ok(file.into_vec::<T>()?.into_iter().map(convert).collect())
}

/// Rows and columns, if there are as many numbers. A header may claim anything; what is there is what counts.
fn whole(rows: u64, columns: u64, numbers: usize) -> Result<(usize, usize), String> {
    let sizes = usize::try_from(rows)
        .ok()
        .zip(usize::try_from(columns).ok());
    let fits = |&(rows, columns): &(usize, usize)| {
        let count = rows.checked_mul(columns);
        columns > 0 && count.is_some_and(|count| count <= numbers)
    };
    sizes
        .filter(fits)
        .ok_or_else(|| format!("the array of shape ({rows}, {columns}) is longer than the file"))
}

/// The first line of a message: the rest of it are drawings.
fn one_line(error: &io::Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default().trim();
    format!("not a NumPy array: {line}")
}
