//! GLB: the binary container of a glTF document and its first buffer.

use super::super::fault::{Checked, Fault};
use super::super::report::Report;
use super::super::source::has_extension;
use crate::error::Place;

const MAGIC: &[u8] = b"glTF";
const HEADER: usize = 12;
const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;

/// A document and where it begins in its file.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    /// The byte of the file at which `json` begins; `None` where the file is nothing else.
    pub(super) start: Option<usize>,
    pub(super) binary: Option<&'a [u8]>,
}

/// Takes a file apart: GLB by its first bytes, whatever the file is called, else JSON.
pub(super) fn open<'a>(bytes: &'a [u8], report: &mut Report) -> Checked<Container<'a>> {
    if bytes.starts_with(MAGIC) {
        return chunks(bytes, report);
    }
    if has_extension(report.source.path(), &["glb"]) {
        let what = "not a GLB file: the first four bytes must be 'glTF'";
        return Err(byte(0, what));
    }
    Ok(Container {
        json: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
        start: None,
        binary: None,
    })
}

fn byte(place: usize, what: impl Into<String>) -> Fault {
    Fault::at(Place::Byte(place as u64), what)
}

/// The little-endian number at `place`.
fn word(bytes: &[u8], place: usize) -> Checked<u32> {
    bytes
        .get(place..)
        .and_then(<[u8]>::first_chunk)
        .map(|word| u32::from_le_bytes(*word))
        .ok_or_else(|| byte(bytes.len(), "truncated: the file ends within a header"))
}

fn chunks<'a>(bytes: &'a [u8], report: &mut Report) -> Checked<Container<'a>> {
    let version = word(bytes, 4)?;
    if version != 2 {
        return Err(byte(4, format!("the version must be 2, got {version}")));
    }
    let bytes = within_length(bytes, report)?;
    let (mut json, mut binary) = (None, None);
    let mut place = HEADER;
    while place < bytes.len() {
        let (size, kind) = (word(bytes, place)?, word(bytes, place + 4)?);
        let start = place + 8;
        let end = usize::try_from(size).ok().and_then(|size| start.checked_add(size));
        let chunk = end.and_then(|end| bytes.get(start..end)).ok_or_else(|| {
            let left = bytes.len() - start;
            let what = format!("truncated: the chunk has {size} bytes, {left} are left");
            byte(place, what)
        })?;
        match kind {
            JSON if json.is_none() => json = Some((chunk, start)),
            BIN if json.is_some() && binary.is_none() => binary = Some(chunk),
            _ => report.warn("chunk", &Place::Byte(place as u64), || {
                format!("a chunk of kind {kind:#010x} is not read")
            }),
        }
        place = start + chunk.len();
    }
    let (json, start) = json.ok_or_else(|| byte(HEADER, "there is no JSON chunk"))?;
    // Some programs pad with zeros where it should be blanks.
    let padding = json.iter().rev().take_while(|&&byte| byte == 0).count();
    let json = json.get(..json.len() - padding).unwrap_or_default();
    Ok(Container { json, start: Some(start), binary })
}

/// The part of the file that its header says is the container.
fn within_length<'a>(bytes: &'a [u8], report: &mut Report) -> Checked<&'a [u8]> {
    let length = word(bytes, 8)?;
    let stated = usize::try_from(length).unwrap_or(usize::MAX);
    let within = bytes.get(..stated).ok_or_else(|| {
        let size = bytes.len();
        let what = format!("truncated: the length is {length}, the file has {size} bytes");
        byte(8, what)
    })?;
    if stated < HEADER + 8 {
        let what = format!("the length {length} leaves no room for a document");
        return Err(byte(8, what));
    }
    if within.len() < bytes.len() {
        let trailing = bytes.len() - within.len();
        report.warn("trailing", &Place::Byte(stated as u64), || {
            format!("{trailing} bytes after the container's end are not read")
        });
    }
    Ok(within)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::LoadSettings;

    /// The JSON, the binary chunk if there is one, and how many warnings there were.
    type Opened = (Vec<u8>, Option<Vec<u8>>, usize);

    fn opened(bytes: &[u8]) -> Result<Opened, String> {
        let mut report = Report::new("a.glb".as_ref(), LoadSettings::default(), &());
        let container = open(bytes, &mut report);
        let container =
            container.map_err(|fault| fault.into_error("a.glb".as_ref()).to_string())?;
        let binary = container.binary.map(<[u8]>::to_vec);
        Ok((container.json.to_vec(), binary, report.take_lines().len()))
    }

    fn glb(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, content) in chunks {
            bytes.extend(u32::try_from(content.len()).unwrap().to_le_bytes());
            bytes.extend(kind.to_le_bytes());
            bytes.extend(*content);
        }
        let length = u32::try_from(bytes.len()).unwrap();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        bytes
    }

    #[test]
    fn the_first_chunk_of_each_kind_is_taken() {
        let file = glb(&[(JSON, b"{}\0\0"), (7, b"?"), (BIN, b"1234"), (BIN, b"5678")]);
        let (json, binary, warnings) = opened(&file).unwrap();
        assert_eq!((&*json, &*binary.unwrap()), (&b"{}"[..], &b"1234"[..]));
        assert_eq!(warnings, 1, "one kind of warning, for both chunks");
    }

    #[test]
    fn lies_about_lengths_are_refused_where_they_stand() {
        let file = glb(&[(JSON, b"{}  "), (BIN, b"1234")]);
        let with = |place: usize, value: u32| {
            let mut file = file.clone();
            file[place..place + 4].copy_from_slice(&value.to_le_bytes());
            opened(&file).unwrap_err()
        };
        assert!(with(0, 1).starts_with("a.glb @ byte 0: "));
        assert!(with(4, 1).starts_with("a.glb @ byte 4: the version must be 2, got 1"));
        assert!(with(8, u32::MAX).starts_with("a.glb @ byte 8: truncated"));
        assert!(with(8, 12).starts_with("a.glb @ byte 8: "));
        assert!(with(8, 30).starts_with("a.glb @ byte 30: truncated"));
        assert!(with(12, u32::MAX).starts_with("a.glb @ byte 12: truncated"));
        assert!(with(24, 5).starts_with("a.glb @ byte 24: truncated"));
        assert!(with(16, BIN).starts_with("a.glb @ byte 12: there is no JSON chunk"));
        for end in 0..file.len() {
            assert!(opened(&file[..end]).is_err(), "{end}");
        }
        let longer = [&file[..], b"more"].concat();
        assert_eq!(opened(&longer).unwrap().2, 1);
    }
}
