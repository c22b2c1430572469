//! The points of a PCD, in text, binary or compressed.

use super::super::super::metadata::KEY;
use super::rows::Order;
use super::{Header, MOST_COLUMNS, Type, next_line, unknown};
use crate::image::Output;

pub(in crate::image) fn pcd(bytes: &[u8], most: u64) -> Result<Output, String> {
    let mut header = Header::default();
    let mut rest = bytes;
    let (mut names, mut sizes, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
    let (mut counts, mut sides) = (Vec::new(), [None, None]);
    let order = loop {
        let line = next_line(&mut rest)?;
        let mut words = line.split_ascii_whitespace();
        let first = words.next();
        let words: Vec<&str> = words.collect();
        match (first, &words[..]) {
            (Some("#"), [KEY, ..]) => header.comment(line, "#"),
            (None | Some("VERSION" | "VIEWPOINT"), _) => {}
            (Some(word), _) if word.starts_with('#') => {}
            (Some("FIELDS"), _) => names = words,
            (Some("SIZE"), _) => sizes = words,
            (Some("TYPE"), _) => kinds = words,
            (Some("COUNT"), _) => counts = words,
            (Some("WIDTH"), [side]) => sides[0] = side.parse::<u64>().ok(),
            (Some("HEIGHT"), [side]) => sides[1] = side.parse::<u64>().ok(),
            (Some("POINTS"), [count]) => header.set_count(count)?,
            (Some("DATA"), ["binary"]) => break Order::Little,
            (Some("DATA"), ["ascii"]) => break Order::Text,
            (Some("DATA"), ["binary_compressed"]) => break Order::Compressed,
            _ => return Err(unknown(line)),
        }
    };
    if let ([Some(width), Some(height)], None) = (sides, header.count) {
        header.count = width.checked_mul(height);
    }
    if counts.is_empty() {
        counts = vec!["1"; names.len()];
    }
    if [sizes.len(), kinds.len(), counts.len()] != [names.len(); 3] {
        return Err("FIELDS, SIZE, TYPE and COUNT do not go together".to_owned());
    }
    for (((name, size), kind), count) in names.into_iter().zip(sizes).zip(kinds).zip(counts) {
        let kind = Type::of_pcd(kind, size).ok_or_else(|| unknown(&format!("{kind} {size}")))?;
        let several: usize = count.parse().map_err(|_| unknown(count))?;
        if several > MOST_COLUMNS {
            return Err(format!("has more than {MOST_COLUMNS} columns"));
        }
        let numbered = |k: usize| match name {
            super::PADDING => name.to_owned(),
            _ if several == 1 => name.to_owned(),
            _ => format!("{name}_{k}"),
        };
        header.columns.extend((0..several).map(|k| (numbered(k), kind)));
    }
    header.read(rest, order, most)
}
