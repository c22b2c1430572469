use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::super::npz::METADATA;
use super::npy;
use super::output::{Output, metadata_of};
use crate::image::read::LONGEST_METADATA;

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
        // Names pack well, but not as a bomb does.
        let limit =
            if name == METADATA { room.min(most_metadata(bytes.len() as u64)) } else { room };
        let mut content = Vec::new();
        let read = (entry.by_ref().take(limit.saturating_add(1))).read_to_end(&mut content);
        read.map_err(|error| format!("{}: {error}", crate::error::escape_controls(&name)))?;
        // All entries together: a thousand of them may be the same few bytes.
        if content.len() as u64 > limit {
            let allowed = if limit < room { limit } else { most };
            return Err(format!("is over the limit of {allowed} bytes unpacked"));
        }
        room -= content.len() as u64;
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

/// The most bytes of unpacked metadata in a file of `length` bytes.
fn most_metadata(length: u64) -> u64 {
    length.saturating_mul(256).saturating_add(LONGEST_METADATA)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    #[test]
    fn metadata_that_unpack_like_a_bomb_are_refused() {
        let packed = |length: usize| {
            let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
            archive.start_file("metadata.npy", SimpleFileOptions::default()).unwrap();
            archive.write_all(&vec![0; length]).unwrap();
            archive.finish().unwrap().into_inner()
        };
        let refusal = |length| decode(&packed(length), 1 << 32).unwrap_err();
        assert!(refusal(32 << 20).contains("bytes unpacked"));
        assert!(!refusal(1 << 20).contains("bytes unpacked"));
    }
}
