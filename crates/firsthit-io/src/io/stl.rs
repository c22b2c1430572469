//! STL: triangles without shared vertices, binary or text.
//!
//! The facets' own normals are not read: the normal is that of the winding. The binary format's
//! attribute bytes are colours where they are marked as such.

use std::sync::Arc;

use super::fault::{Checked, Fault};
use super::model::Model;
use super::report::Report;
use super::sanitize::linear;
use super::surface::{Surface, Vertices, face_attribute};
use super::text::{self, Lines, Words, next_number, shown};
use crate::error::{Place, escape_controls};
use crate::geometry::single;
use crate::scene::{Material, Object};
use crate::shape::Positions;

const HEADER: usize = 80;
const FACET: usize = 50;

/// The memory is charged after this many lines of text.
const CHECK_EVERY: u64 = 1 << 16;

pub(super) fn read(bytes: &[u8], report: &mut Report) -> Checked<Model> {
    let mut colors = Vec::new();
    let (positions, name) = if let Some((facets, rest)) = binary_of(bytes)? {
        if !rest.is_empty() {
            let place = Place::Byte((bytes.len() - rest.len()) as u64);
            report.warn("trailing", &place, || {
                format!("{} bytes after the last facet are not read", rest.len())
            });
        }
        report.budget.charge_growth(facets.len())?;
        colors = facet_colors(bytes.get(..HEADER).unwrap_or_default(), facets);
        report.budget.charge_content(size_of_val(&*colors) as u64, "the facets' colours")?;
        (Positions::Single(read_binary(facets).into()), None)
    } else {
        let (points, name) = read_text(&text::decode(bytes), report)?;
        (Positions::compact(points), name)
    };
    let name = name.unwrap_or_else(|| report.source.stem());
    let count = u32::try_from(positions.len() / 3).map_err(|_| Fault::file("too many facets"))?;
    if count == 0 {
        let what = || "no facets: there is nothing to see".to_owned();
        report.warn("empty", &Place::File, what);
    }
    let mut surface = Surface::default();
    surface.reserve(count as usize)?;
    (0..count.min(u32::MAX / 3)).for_each(|k| surface.push_triangle([3 * k, 3 * k + 1, 3 * k + 2]));
    let (mut mesh, _) = surface.finish(&Vertices::new(positions), &name, report)?;
    let is_painted = !colors.is_empty();
    if is_painted {
        let colors = face_attribute(&mesh, colors);
        mesh = mesh.with_colors(colors)?;
    }
    let object = Object::new(Arc::new(mesh)).named(name);
    // White leaves the mesh's own colours as they are.
    Ok(Model::of(vec![if is_painted {
        object.with_materials([Material::default()])
    } else {
        object
    }]))
}

/// The linear colours of facets, where any are stated: five bits for each of red, green and blue,
/// after one bit. Magics says so in the header, with the colour of all other facets; there a bit of
/// 0 marks a colour, and red is lowest. `VisCAM` and `SolidView` mark a colour by a bit of 1, and
/// blue is lowest.
fn facet_colors(header: &[u8], facets: &[u8]) -> Vec<[f32; 3]> {
    let (facets, _) = facets.as_chunks::<FACET>();
    let words = || facets.iter().map(|&[.., low, high]| u16::from_le_bytes([low, high]));
    let grey = Object::NEUTRAL.to_array().map(single);
    let of_all = memchr::memmem::find(header, b"COLOR=").map(|start| header.get(start + 6..));
    let level = |word: u16, shift: u32| linear(f64::from((word >> shift) & 31) / 31.0);
    let is_marked = |word: u16| word >> 15 == 1;
    if let Some(of_all) = of_all {
        let of_all = match of_all {
            Some(&[red, green, blue, ..]) => {
                [red, green, blue].map(|byte| linear(f64::from(byte) / 255.0))
            }
            _ => grey,
        };
        let color = |word| {
            if is_marked(word) { of_all } else { [0, 5, 10].map(|shift| level(word, shift)) }
        };
        return words().map(color).collect();
    }
    if !words().any(is_marked) {
        return Vec::new();
    }
    let color = |word| {
        if is_marked(word) { [10, 5, 0].map(|shift| level(word, shift)) } else { grey }
    };
    words().map(color).collect()
}

/// The facets of a binary file and what follows them; `None` for text. They are told apart by the
/// size, which only binary files state: many of those, too, begin with "solid", the mark of text.
fn binary_of(bytes: &[u8]) -> Checked<Option<(&[u8], &[u8])>> {
    let start = bytes.trim_ascii_start();
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    let solid = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let utf16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    let is_text = utf16 || (solid && !bytes.contains(&0));
    let Some((count, body)) = bytes.get(HEADER..).and_then(<[u8]>::split_first_chunk::<4>) else {
        if is_text {
            return Ok(None);
        }
        let size = bytes.len();
        let what = format!("{size} bytes are neither text nor a header of 84 bytes");
        return Err(Fault::at(Place::Byte(0), what));
    };
    let count = u32::from_le_bytes(*count);
    let needed = usize::try_from(u64::from(count) * FACET as u64).unwrap_or(usize::MAX);
    match body.split_at_checked(needed) {
        Some((facets, rest @ [])) => Ok(Some((facets, rest))),
        _ if is_text => Ok(None),
        Some((_, rest)) if count == 0 && rest.len() >= FACET => {
            let room = rest.len() / FACET;
            let what = format!("the count of facets is 0, but there are bytes for {room}");
            Err(Fault::at(Place::Byte(HEADER as u64), what))
        }
        Some(found) => Ok(Some(found)),
        None => {
            let room = body.len() / FACET;
            let what =
                format!("truncated: the count of facets is {count}, the bytes end after {room}");
            Err(Fault::at(Place::Byte(HEADER as u64), what))
        }
    }
}

fn read_binary(facets: &[u8]) -> Vec<[f32; 3]> {
    let (facets, _) = facets.as_chunks::<FACET>();
    let mut points = Vec::with_capacity(3 * facets.len());
    for facet in facets {
        // 12 bytes of normal, 3 times 12 of corners, 2 of attributes.
        let (words, _) = facet.as_chunks::<4>();
        let mut numbers = words.iter().skip(3).map(|&word| f32::from_le_bytes(word));
        let mut next = || numbers.next().unwrap_or(f32::NAN);
        points.extend([(); 3].map(|()| [(); 3].map(|()| next())));
    }
    points
}

/// The state of the reader of a text STL.
#[derive(Default)]
struct TextReader {
    points: Vec<[f64; 3]>,
    /// The line of the facet that is not ended yet.
    open: Option<u64>,
    corners: usize,
    solids: usize,
    /// The line of the solid that is not ended yet.
    solid: Option<u64>,
    name: Option<String>,
}

/// The corners of all solids together, and the name if there is one solid with a name.
fn read_text(text: &[u8], report: &mut Report) -> Checked<(Vec<[f64; 3]>, Option<String>)> {
    let mut reader = TextReader::default();
    let mut lines = Lines::new(text);
    while let Some(line) = lines.next() {
        if lines.number.is_multiple_of(CHECK_EVERY) {
            report.budget.charge_growth(size_of_val(reader.points.as_slice()))?;
            report.advance_until(lines.rest().len())?;
        }
        reader.line(line, lines.number, report)?;
    }
    if let Some(open) = reader.open {
        let what = "truncated: the facet that begins here never ends";
        return Err(Fault::line(open, what));
    }
    if let Some(solid) = reader.solid {
        let count = reader.points.len() / 3;
        let why =
            format!("the solid that begins at line {solid} has no endsolid; facets read: {count}");
        report.cut_short(Place::Line(lines.number), &why);
    }
    let name = reader.name.filter(|_| reader.solids == 1);
    Ok((reader.points, name))
}

impl TextReader {
    fn line(&mut self, line: &[u8], number: u64, report: &mut Report) -> Checked<()> {
        let mut words = Words::new(line);
        while let Some(word) = words.next() {
            match word.to_ascii_lowercase().as_slice() {
                b"solid" => {
                    self.solids += 1;
                    self.solid = Some(number);
                    let name = escape_controls(&String::from_utf8_lossy(words.rest()));
                    self.name = Some(name).filter(|name| !name.is_empty());
                    return Ok(());
                }
                // The words after it are a name.
                b"endsolid" => {
                    self.solid = None;
                    return Ok(());
                }
                b"facet" => self.begin_facet(number)?,
                b"vertex" => self.vertex(&mut words, number)?,
                b"endfacet" => self.end_facet(number)?,
                b"outer" | b"loop" | b"endloop" => {}
                // The facet's own normal.
                b"normal" => words.by_ref().take(3).for_each(drop),
                _ => report.warn("unknown", &Place::Line(number), || {
                    format!("unknown word '{}' is not read", shown(word))
                }),
            }
        }
        Ok(())
    }

    fn begin_facet(&mut self, number: u64) -> Checked<()> {
        let Some(open) = self.open.replace(number) else {
            return Ok(());
        };
        let what = format!("a facet begins before that of line {open} has ended");
        Err(Fault::line(number, what))
    }

    fn vertex(&mut self, words: &mut Words, number: u64) -> Checked<()> {
        let mut next = || next_number(words).map_err(|what| Fault::line(number, what));
        self.points.push([next()?, next()?, next()?]);
        self.corners += 1;
        if self.open.is_none() {
            return Err(Fault::line(number, "a vertex outside of any facet"));
        }
        Ok(())
    }

    fn end_facet(&mut self, number: u64) -> Checked<()> {
        let corners = std::mem::take(&mut self.corners);
        if self.open.take().is_none() {
            return Err(Fault::line(number, "endfacet without a facet"));
        }
        if corners != 3 {
            let what = format!("a facet must have 3 vertices, this has {corners}");
            return Err(Fault::line(number, what));
        }
        Ok(())
    }
}
