//! The beginning of an OFF file: its keyword and its counts.

use crate::io::fault::{Checked, Fault};
use crate::io::text::{Lines, Words, shown};

/// The values of vertices that a keyword names, in this order after their coordinates.
#[expect(clippy::struct_excessive_bools, reason = "the letters of a keyword, each there or not")]
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct VertexLayout {
    /// A fourth coordinate, that the others are divided by.
    pub(super) has_weights: bool,
    pub(super) has_normals: bool,
    pub(super) has_colors: bool,
    pub(super) has_uvs: bool,
    /// The number of dimensions stands before the counts.
    has_dimensions: bool,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) kind: VertexLayout,
    pub(super) vertices: u64,
    pub(super) faces: u64,
}

/// A line without its comment.
pub(super) fn statement(line: &[u8]) -> &[u8] {
    let end = memchr::memchr(b'#', line).unwrap_or(line.len());
    line.get(..end).unwrap_or_default().trim_ascii()
}

/// The next line that says anything.
pub(super) fn next_line<'a>(lines: &mut Lines<'a>) -> Option<&'a [u8]> {
    lines.map(statement).find(|line| !line.is_empty())
}

/// The prefix of the word `OFF`: any of `ST`, `C`, `N`, `4` and `n`; and the text after it, which
/// some programs write without a blank between. `None` for a word that is no keyword.
fn keyword(word: &[u8]) -> Option<(VertexLayout, &[u8])> {
    let mut kind = VertexLayout::default();
    let mut rest = word;
    loop {
        rest = match rest {
            [b'O', b'F', b'F', rest @ ..] => return Some((kind, rest)),
            [b'S', b'T', rest @ ..] => {
                kind.has_uvs = true;
                rest
            }
            [b'C', rest @ ..] => {
                kind.has_colors = true;
                rest
            }
            [b'N', rest @ ..] => {
                kind.has_normals = true;
                rest
            }
            [b'4', rest @ ..] => {
                kind.has_weights = true;
                rest
            }
            [b'n', rest @ ..] => {
                kind.has_dimensions = true;
                rest
            }
            _ => return None,
        };
    }
}

/// Reads up to the counts of vertices and faces. The keyword may be missing, and so may be the
/// count of edges, which says nothing.
pub(super) fn parse(lines: &mut Lines) -> Checked<Header> {
    let truncated = || Fault::file("truncated: the file ends before its counts");
    let mut line = next_line(lines).ok_or_else(truncated)?;
    let mut kind = VertexLayout::default();
    if let Some((found, rest)) = keyword(line) {
        kind = found;
        line = rest.trim_ascii();
        if line.starts_with(b"BINARY") {
            let what = "binary OFF is not read: save it as text, or as PLY";
            return Err(Fault::line(lines.number, what));
        }
    } else if !line.first().is_some_and(u8::is_ascii_digit) {
        let what = format!("not an OFF file: it begins with '{}'", shown(line));
        return Err(Fault::line(lines.number, what));
    }
    let mut counts = Vec::new();
    let wanted = if kind.has_dimensions { 3 } else { 2 };
    loop {
        for word in Words::new(line) {
            let count: Option<u64> = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            let wrong = || {
                let what = format!("'{}' is not a count from 0", shown(word));
                Fault::line(lines.number, what)
            };
            counts.push(count.ok_or_else(wrong)?);
        }
        if counts.len() >= wanted {
            break;
        }
        line = next_line(lines).ok_or_else(truncated)?;
    }
    if kind.has_dimensions {
        let dimensions = counts.remove(0);
        if dimensions != 3 {
            let what = format!("vertices must have 3 dimensions, got {dimensions}");
            return Err(Fault::line(lines.number, what));
        }
    }
    match *counts.as_slice() {
        [vertices, faces] | [vertices, faces, _] => Ok(Header { kind, vertices, faces }),
        _ => {
            let what = "expected the counts of vertices, faces and edges, and nothing else";
            Err(Fault::line(lines.number, what))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Option<(VertexLayout, u64, u64)> {
        let header = parse(&mut Lines::new(text)).ok()?;
        Some((header.kind, header.vertices, header.faces))
    }

    #[test]
    fn counts_stand_where_programs_write_them() {
        let plain = Some((VertexLayout::default(), 8, 6));
        for text in [
            &b"OFF\n8 6 12\n"[..],
            b"# made\nOFF # x\n\n# y\n8 6 12\n",
            b"OFF 8 6 0\n",
            b"OFF8 6 0\n",
            b"OFF\n8 6\n",
            b"8 6 12\n",
            b"OFF\n8\n6\n",
            b"nOFF\n3\n8 6 12\n",
        ] {
            let found = read(text).map(|(kind, vertices, faces)| {
                let kind = VertexLayout { has_dimensions: false, ..kind };
                (kind, vertices, faces)
            });
            assert_eq!(found, plain, "{}", String::from_utf8_lossy(text));
        }
        for text in [
            &b""[..],
            b"OFF",
            b"OFF\n-8 6 0",
            b"OFF\n8 6 1 2 3\n",
            b"OFF BINARY\n\0\0\0\x08",
            b"nOFF\n5\n8 6 12\n",
            b"ply\n",
            b"OFF\n8.5 6 0\n",
        ] {
            assert_eq!(read(text), None, "{}", String::from_utf8_lossy(text));
        }
    }

    #[test]
    fn letters_before_the_keyword_come_in_any_order() {
        let all = VertexLayout {
            has_weights: true,
            has_normals: true,
            has_colors: true,
            has_uvs: true,
            has_dimensions: false,
        };
        assert_eq!(read(b"STCN4OFF\n1 0 0"), Some((all, 1, 0)));
        assert_eq!(read(b"N4CSTOFF\n1 0 0"), Some((all, 1, 0)));
    }
}
