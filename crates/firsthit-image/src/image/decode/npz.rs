use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::super::npz::METADATA;
use super::npy;
use super::output::{Output, metadata_of};

/// An array for each entry, and the metadata from theirs.
pub(in crate::image) fn decode(bytes: &[u8], most: u64) -> Result<Output, String> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let mut output = Output::default();
    let mut text = None;
    let mut room = most;
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).map_err(|error| error.to_string())?;
        let name = (entry.name().map_err(|error| error.to_string())?).into_owned();
        let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else {
            continue;
        };
        let mut content = Vec::new();
        let read = (entry.by_ref().take(room.saturating_add(1))).read_to_end(&mut content);
        read.map_err(|error| format!("{}: {error}", crate::error::escape_controls(&name)))?;
        // All entries together: a thousand of them may be the same few bytes.
        room = room
            .checked_sub(content.len() as u64)
            .ok_or_else(|| format!("is over the limit of {most} bytes unpacked"))?;
        let named = |what| format!("{}: {what}", crate::error::escape_controls(&name));
        if name == METADATA {
            text = Some(npy::text(&content).map_err(named)?);
        } else {
            let array = npy::array(&content, Some(name.clone()), most).map_err(named)?;
            output.arrays.push(array);
        }
    }
    output.metadata = metadata_of(text.as_deref(), &mut output.notes);
    Ok(output)
}
