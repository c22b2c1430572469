//! The head of a PLY file: which elements follow, of which properties.

use std::collections::HashSet;

use crate::io::fault::{Checked, Fault};
use crate::io::text::{Lines, Words, shown};

/// The content of the header.
#[derive(Debug)]
pub(super) struct Header<'a> {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    pub(super) textures: Vec<Texture>,
    /// The first line, with its number, that says nothing a header may say.
    pub(super) stray: Option<(u64, String)>,
    /// The bytes after the header.
    pub(super) body: &'a [u8],
    /// The first line that declares a property its element has already, with the property's name.
    pub(super) repeated: Option<(u64, String)>,
    /// The number of the header's lines.
    pub(super) lines: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Format {
    Ascii,
    Little,
    Big,
}

/// A table of rows.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The names of its properties: looked up, so that a header of a million lines does not take a
    /// day.
    names: HashSet<String>,
    pub(super) line: u64,
}

/// A column.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: PropertyKind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PropertyKind {
    Scalar(Type),
    List { count: Type, item: Type },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Type {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Float32,
    Float64,
}

/// A texture that a comment names, as MeshLab writes it.
#[derive(Debug)]
pub(super) struct Texture {
    pub(super) name: String,
    pub(super) line: u64,
}

impl Header<'_> {
    /// The table of vertices, if there is one.
    pub(super) fn vertex_element(&self) -> Checked<Option<&Element>> {
        let mut found = self.elements.iter().filter(|e| e.name == "vertex");
        let first = found.next();
        match found.next() {
            Some(second) => Err(Fault::line(second.line, "a second element 'vertex'")),
            None => Ok(first),
        }
    }
}

impl Element {
    /// The least number of bytes of a row.
    pub(super) fn smallest_row(&self) -> u64 {
        let sizes = self.properties.iter().map(|property| match property.kind {
            PropertyKind::Scalar(kind) | PropertyKind::List { count: kind, .. } => kind.size(),
        });
        sizes.sum()
    }

    pub(super) fn has_lists(&self) -> bool {
        let mut kinds = self.properties.iter().map(|property| property.kind);
        kinds.any(|kind| matches!(kind, PropertyKind::List { .. }))
    }
}

impl Type {
    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::Int8,
            b"uchar" | b"uint8" => Self::Uint8,
            b"short" | b"int16" => Self::Int16,
            b"ushort" | b"uint16" => Self::Uint16,
            b"int" | b"int32" => Self::Int32,
            b"uint" | b"uint32" => Self::Uint32,
            b"float" | b"float32" => Self::Float32,
            b"double" | b"float64" => Self::Float64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }
}

pub(super) fn parse(bytes: &[u8]) -> Checked<Header<'_>> {
    let mut lines = Lines::new(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
    let start = lines.rest();
    let magic = lines.next().unwrap_or_default();
    if magic.trim_ascii() != b"ply" {
        let what = "not a PLY file: the first line must be 'ply'";
        return Err(Fault::line(1, what));
    }
    // In a file whose lines end with CR, an LF after the header is already the body's first byte.
    lines.bare_cr = matches!(start.get(magic.len()..), Some([b'\r', next, ..]) if *next != b'\n');
    let (mut format, mut elements, mut textures) = (None, Vec::new(), Vec::new());
    let (mut stray, mut repeated) = (None, None);
    while let Some(line) = lines.next() {
        let number = lines.number;
        let mut words = Words::new(line);
        match words.next() {
            None | Some(b"obj_info") => {}
            Some(b"comment") => textures.extend(comment(words, number)?),
            Some(b"format") => format = Some(parse_format(words, number)?),
            Some(b"element") => elements.push(parse_element(words, number)?),
            Some(b"property") => {
                let property = parse_property(words, number)?;
                let element: Option<&mut Element> = elements.last_mut();
                let orphan = || Fault::line(number, "a property before any element");
                let element = element.ok_or_else(orphan)?;
                if repeated.is_none() && !element.names.insert(property.name.clone()) {
                    repeated = Some((number, property.name.clone()));
                }
                element.properties.push(property);
            }
            Some(b"end_header") => {
                let missing = || Fault::line(number, "the header has no line 'format'");
                return Ok(Header {
                    format: format.ok_or_else(missing)?,
                    elements,
                    textures,
                    stray,
                    repeated,
                    body: lines.rest(),
                    lines: number,
                });
            }
            // A comment whose first word is missing, as an old exporter of Blender's writes it.
            // After an element it could as well be a misspelled property, without which all rows
            // would be misread.
            Some(_) if elements.is_empty() => stray = stray.or(Some((number, shown(line)))),
            Some(word) => {
                let what = format!("unknown word '{}' in the header", shown(word));
                return Err(Fault::line(number, what));
            }
        }
    }
    let what = "truncated: the header has no line 'end_header'";
    Err(Fault::line(lines.number, what))
}

/// The texture that a comment may name.
fn comment(mut words: Words, line: u64) -> Checked<Option<Texture>> {
    // Readers that look for these bytes instead of lines end the header here, and read the rest of
    // it as numbers: what the file shows must not depend on who reads it.
    if words.rest().windows(10).any(|bytes| bytes == b"end_header") {
        let what = "a comment contains 'end_header', where many programs would end the header; \
                    remove it from the comment";
        return Err(Fault::line(line, what));
    }
    let is_texture = words.next() == Some(b"TextureFile");
    Ok(is_texture
        .then(|| Texture { name: String::from_utf8_lossy(words.rest()).into_owned(), line }))
}

fn parse_format(mut words: Words, line: u64) -> Checked<Format> {
    match words.next() {
        Some(b"ascii") => Ok(Format::Ascii),
        Some(b"binary_little_endian") => Ok(Format::Little),
        Some(b"binary_big_endian") => Ok(Format::Big),
        other => {
            let what = format!(
                "format must be ascii, binary_little_endian or binary_big_endian, got '{}'",
                shown(other.unwrap_or_default())
            );
            Err(Fault::line(line, what))
        }
    }
}

fn parse_element(mut words: Words, line: u64) -> Checked<Element> {
    let name = shown(words.next().unwrap_or_default());
    let count = words.next().unwrap_or_default();
    let parsed = str::from_utf8(count).ok();
    let parsed = parsed.and_then(|count| count.parse().ok());
    let count = parsed.ok_or_else(|| {
        let count = shown(count);
        let what = format!("element '{name}' must have a count from 0, got '{count}'");
        Fault::line(line, what)
    })?;
    Ok(Element { name, count, properties: Vec::new(), names: HashSet::new(), line })
}

fn parse_property(mut words: Words, line: u64) -> Checked<Property> {
    let type_of = |word: Option<&[u8]>| {
        let word = word.unwrap_or_default();
        let wrong = || Fault::line(line, format!("unknown property type '{}'", shown(word)));
        Type::parse(word).ok_or_else(wrong)
    };
    let kind = match words.next() {
        Some(b"list") => {
            PropertyKind::List { count: type_of(words.next())?, item: type_of(words.next())? }
        }
        word => PropertyKind::Scalar(type_of(word)?),
    };
    match words.next() {
        Some(name) => Ok(Property { name: shown(name), kind }),
        None => Err(Fault::line(line, "a property without a name")),
    }
}
