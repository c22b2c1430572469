//! The statements of an OBJ file.

use crate::io::fault::{Checked, Fault};
use crate::io::text::{Lines, Words, next_number};

/// Statements of free-form geometry, which is not read.
pub(super) const CURVES: &[&[u8]] = &[
    b"vp", b"cstype", b"deg", b"bmat", b"step", b"curv", b"curv2", b"surf", b"parm", b"trim",
    b"hole", b"scrv", b"sp", b"end", b"con", b"bzp", b"bsp", b"cdc", b"cdp", b"res", b"ctech",
    b"stech",
];

/// Statements that change nothing that is seen here.
pub(super) const HARMLESS: &[&[u8]] = &[
    b"s",
    b"mg",
    b"lod",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"shadow_obj",
    b"trace_obj",
    b"maplib",
    b"usemap",
    b"t",
];

/// Whether a backslash joins the next line to this one. Not in a comment, where it ends a path.
pub(super) fn is_continued(line: &[u8]) -> bool {
    line.trim_ascii_end().ends_with(b"\\") && !line.contains(&b'#')
}

pub(super) fn joined(line: &[u8], lines: &mut Lines) -> Vec<u8> {
    let mut whole = Vec::new();
    let mut piece = Some(line);
    while let Some(line) = piece {
        let line = line.trim_ascii_end();
        if !is_continued(line) {
            whole.extend_from_slice(line);
            break;
        }
        whole.extend_from_slice(line.strip_suffix(b"\\").unwrap_or(line));
        whole.push(b' ');
        piece = lines.next();
    }
    whole
}

/// Whether a word begins a statement of the format.
pub(super) fn is_known(word: &[u8]) -> bool {
    const READ: &[&[u8]] =
        &[b"v", b"vt", b"vn", b"f", b"fo", b"o", b"g", b"p", b"l", b"usemtl", b"mtllib"];
    [READ, HARMLESS, CURVES].iter().any(|words| words.contains(&word))
}

/// The rest of a line as a name, which may have blanks, and a `#` that follows none.
pub(super) fn name_of(line: &[u8]) -> &[u8] {
    let mut words = Words::new(line);
    words.next();
    let rest = words.rest();
    let comment = rest.windows(2).position(|pair| matches!(pair, [b' ' | b'\t', b'#']));
    match comment.and_then(|end| rest.get(..end)) {
        Some(name) => name.trim_ascii_end(),
        None if rest.starts_with(b"#") => b"",
        None => rest,
    }
}

/// Reads `N` numbers.
pub(super) fn numbers<const N: usize>(words: &mut Words, line: u64) -> Checked<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = next_number(words).map_err(|what| Fault::line(line, what))?;
    }
    Ok(numbers)
}
