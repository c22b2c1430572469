//! Detects OBJ files that end early.

use super::index::Indices;
use super::statement::{is_continued, is_known};
use crate::io::text::{Words, unended, unended_line};

/// The sign that the text is truncated, if there is one.
///
/// Many whole files have no line break at their end, and a number cut short is still a number. So a
/// text is truncated only if its last line has no line break and makes no sense as the last: an
/// incomplete statement, or one that only later statements would use.
pub(super) fn cut(text: &[u8], indices: &[Indices; 3]) -> Option<String> {
    let last = text.trim_ascii_end().rsplit(|&byte| byte == b'\n' || byte == b'\r');
    if last.into_iter().next().is_some_and(is_continued) {
        return Some("the last line goes on, by its backslash".to_owned());
    }
    let line = unended_line(text)?;
    let statement = last_statement(text);
    // A comment is never incomplete.
    let mut words = Words::new(&statement).take_while(|word| !word.starts_with(b"#"));
    let keyword = words.next()?;
    let [vertices, uvs, normals] = indices;
    let why = match keyword {
        b"f" | b"fo" => incomplete(words)?,
        b"v" if vertices.last_is_unused() => "no face has this vertex",
        b"vt" if uvs.last_is_unused() => "no face has these texture coordinates",
        b"vn" if normals.last_is_unused() => "no face has this normal",
        b"o" | b"g" | b"usemtl" => "no face follows",
        word if !is_known(word) => "this is no statement",
        _ => return None,
    };
    Some(unended(line, why))
}

/// The last line, joined with the lines before it that end in a backslash.
fn last_statement(text: &[u8]) -> Vec<u8> {
    let mut lines = text.rsplit(|&byte| byte == b'\n' || byte == b'\r');
    let last = lines.next().unwrap_or_default();
    // CR and LF are two breaks with nothing between them.
    let before = lines.filter(|line| !line.is_empty());
    let continued = before.take_while(|line| is_continued(line));
    let mut pieces: Vec<&[u8]> =
        continued.filter_map(|line| line.trim_ascii_end().strip_suffix(b"\\")).collect();
    pieces.reverse();
    pieces.push(last);
    pieces.join(&b' ')
}

/// The part that an incomplete face lacks.
fn incomplete<'a>(corners: impl Iterator<Item = &'a [u8]>) -> Option<&'static str> {
    let pieces = |corner: &[u8]| corner.split(|&byte| byte == b'/').count();
    let (mut count, mut form, mut last) = (0, None, &b""[..]);
    for corner in corners {
        count += 1;
        last = corner;
        if *form.get_or_insert(pieces(corner)) != pieces(corner) {
            return Some("the corners of this face are not of one form");
        }
    }
    if count < 3 {
        Some("this face has fewer than 3 corners")
    } else if last.ends_with(b"/") {
        Some("an index is missing after the slash")
    } else {
        None
    }
}
