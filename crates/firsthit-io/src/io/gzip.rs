//! Gzip (RFC 1952): told by its first bytes, whatever the file is called.

use std::borrow::Cow;
use std::io::Read;

use flate2::bufread::GzDecoder;

use super::fault::{Checked, Fault};
use super::memory_budget::size_in_words;
use super::report::Report;
use crate::error::Place;
use crate::watch::{Watch, stop_if_asked};

const MAGIC: &[u8] = &[0x1f, 0x8b];

/// The number of bytes that are unpacked at a time.
const PIECE: u64 = 1 << 20;

/// The content itself; of a packed file, the unpacked content.
pub(super) fn unpacked<'a>(bytes: Cow<'a, [u8]>, report: &mut Report) -> Checked<Cow<'a, [u8]>> {
    if !bytes.starts_with(MAGIC) {
        return Ok(bytes);
    }
    let (content, trailing) = unpack(&bytes, report.budget.left(), report.watch)?;
    if trailing > 0 {
        let place = Place::Byte((bytes.len() - trailing) as u64);
        report.warn("gzip", &place, || {
            format!("{trailing} bytes after the packed content are not read")
        });
    }
    report.budget.charge_content(content.len() as u64, "its unpacked content")?;
    Ok(content.into())
}

/// The content of all members of a packed file, one after the other, and how many bytes follow the
/// last member that are neither another nor padding.
fn unpack(packed: &[u8], most: u64, watch: &dyn Watch) -> Checked<(Vec<u8>, usize)> {
    let (mut content, mut rest) = (Vec::new(), packed);
    while rest.starts_with(MAGIC) {
        member(&mut rest, [packed.len() as u64, most], &mut content, watch)?;
    }
    // Tapes are padded with zeros.
    let is_padding = rest.iter().all(|&byte| byte == 0);
    let trailing = if is_padding { 0 } else { rest.len() };
    Ok((content, trailing))
}

/// Unpacks one member, and moves `rest` behind it.
fn member(
    rest: &mut &[u8],
    [size, most]: [u64; 2],
    content: &mut Vec<u8>,
    watch: &dyn Watch,
) -> Checked<()> {
    let mut decoder = GzDecoder::new(&mut *rest);
    loop {
        let too_large = || {
            let limit = size_in_words(most);
            let what = format!(
                "unpacks to more than the {limit} of memory that are left of what is allowed \
                 (--max-memory raises the limit)"
            );
            Fault::too_large(Place::File, what)
        };
        let left = most.saturating_sub(content.len() as u64);
        // One byte more than allowed tells that there is more.
        let piece = PIECE.min(left.saturating_add(1));
        let room = usize::try_from(piece).map(|piece| content.try_reserve(piece));
        if !matches!(room, Ok(Ok(()))) {
            return Err(too_large());
        }
        match decoder.by_ref().take(piece).read_to_end(content) {
            Ok(0) => return Ok(()),
            Ok(read) if read as u64 > left => return Err(too_large()),
            Ok(_) => stop_if_asked(watch)?,
            Err(error) => {
                let at = size - decoder.get_ref().len() as u64;
                let what = match error.kind() {
                    std::io::ErrorKind::UnexpectedEof => "truncated: the packed content ends here",
                    _ => "the packed content is damaged",
                };
                return Err(Fault::at(Place::Byte(at), what));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn packed(content: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(content).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn members_follow_each_other_and_zeros_are_padding() {
        let file = [packed(b"solid "), packed(b"x"), vec![0; 512]].concat();
        assert_eq!(unpack(&file, 100, &()).unwrap(), (b"solid x".to_vec(), 0));
        let file = [packed(b"a"), b"garbage".to_vec()].concat();
        assert_eq!(unpack(&file, 100, &()).unwrap().1, 7);
    }

    #[test]
    fn a_bomb_is_stopped_at_the_limit_and_not_before() {
        let bomb = packed(&vec![0; 3 << 20]);
        assert!(bomb.len() < 5000);
        assert_eq!(unpack(&bomb, 3 << 20, &()).unwrap().0.len(), 3 << 20);
        for most in [0, 1, 1 << 20, (3 << 20) - 1] {
            assert!(matches!(unpack(&bomb, most, &()), Err(Fault::TooLarge { .. })));
        }
    }

    #[test]
    fn every_cut_and_every_changed_byte_of_the_content_is_noticed() {
        let text: Vec<u8> = (0..2000_u32).flat_map(|k| (k * k).to_le_bytes()).collect();
        let file = packed(&text);
        for end in 2..file.len() {
            assert!(unpack(&file[..end], 1 << 20, &()).is_err(), "{end}");
        }
        // The first ten bytes are the header, which has fields that do not matter.
        for k in 10..file.len() {
            let mut damaged = file.clone();
            damaged[k] ^= 0x10;
            // A few bits mean nothing, as those that fill the last byte.
            if let Ok((content, _)) = unpack(&damaged, 1 << 20, &()) {
                assert_eq!(content, text, "{k}");
            }
        }
    }
}
