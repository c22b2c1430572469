//! Rays as NumPy arrays.

use std::io::{Cursor, Read};

use firsthit::image::{NpyHeader, NpyValues};

use super::Table;

/// The most bytes that an entry of an archive may unpack to: a small file can claim, and even hold,
/// far more than the memory takes. 89 million rays fit in.
const MOST_BYTES: u64 = 1 << 32;

/// The arrays in an archive: origins and directions, or both in one.
pub(super) fn npz(bytes: Vec<u8>, alone: &str) -> Result<Vec<Table>, String> {
    let mut archive =
        zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let names: Vec<String> =
        archive.file_names().filter_map(|name| Some(name.ok()?.into_owned())).collect();
    let pick = |wanted: &[&str]| {
        let entries = wanted.iter().map(|wanted| format!("{wanted}.npy"));
        entries.into_iter().find(|entry| names.contains(entry))
    };
    let mut table = |name: &str| {
        let mut entry = archive.by_name(name).map_err(|error| format!("{name}: {error}"))?;
        let mut bytes = Vec::new();
        let read = entry.by_ref().take(MOST_BYTES + 1).read_to_end(&mut bytes);
        read.map_err(|error| format!("{name}: {error}"))?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(format!("{name}: is over the limit of {MOST_BYTES} bytes"));
        }
        npy(&bytes).map_err(|error| format!("{name}: {error}"))
    };
    if let Some(rays) = pick(&[alone]) {
        return Ok(vec![table(&rays)?]);
    }
    if alone != "rays" {
        return Err(format!(
            "expected the entry {alone}; got {}",
            crate::console::in_words(names.into_iter())
        ));
    }
    let origins = pick(&["origins", "origin"]);
    let directions = pick(&["directions", "direction", "dir"]);
    match (origins, directions) {
        (Some(origins), Some(directions)) => Ok(vec![table(&origins)?, table(&directions)?]),
        _ => Err(format!(
            "expected entries origins and directions, or rays, or points; got {}",
            crate::console::in_words(names.into_iter())
        )),
    }
}

/// An array of shape (n, columns) of any type of number, of either byte order, in C or Fortran
/// order.
pub(super) fn npy(bytes: &[u8]) -> Result<Table, String> {
    let (header, data) = NpyHeader::parse(bytes)?;
    let &[_, columns] = header.shape() else {
        let shape = header.shape();
        return Err(format!("expected an array of shape (n, 6) or (n, 3), got {shape:?}"));
    };
    let Some(columns) = usize::try_from(columns).ok().filter(|&columns| columns > 0) else {
        return Err("expected an array of shape (n, 6) or (n, 3)".to_owned());
    };
    let not_rays = || {
        let descr = header.descr();
        format!("expected floats (32 or 64 bit) or integers, got {descr}")
    };
    if header.dtype() == Some("bool") {
        return Err(not_rays());
    }
    let values = match header.values(data)?.ok_or_else(not_rays)? {
        NpyValues::Float64(values) => values,
        NpyValues::Float32(values) => values.into_iter().map(f64::from).collect(),
        NpyValues::Whole(values) => values.into_iter().map(|x| x as f64).collect(),
        NpyValues::Unsigned(values) => values.into_iter().map(|x| x as f64).collect(),
    };
    Ok(Table { columns, values })
}
