//! OBJ: Wavefront's text format, with its MTL materials.

mod ending;
mod index;
mod object;
mod plain;
mod statement;
mod values;

use std::collections::HashMap;

use super::fault::{Checked, Fault};
use super::model::Model;
use super::mtl::Library;
use super::report::Report;
use super::surface::Vertices;
use super::text::{self, Lines, Words, number, shown};
use crate::error::{Place, escape_controls};
use crate::geometry::single;
use crate::shape::Positions;
use index::{Indices, NONE};
use object::{Face, Gather, Object};
use statement::{CURVES, HARMLESS, is_continued, is_known, joined, name_of, numbers};
use values::{Materials, Values};

/// The memory is charged after this many lines.
const CHECK_EVERY: u64 = 1 << 16;

pub(super) fn read(bytes: &[u8], report: &mut Report) -> Checked<Model> {
    let text = text::decode(bytes);
    let mut reader = Reader::new(report);
    let mut lines = Lines::new(&text);
    loop {
        // By the count of lines, not their memory: a statement adds about as much as it has bytes.
        if lines.number.is_multiple_of(CHECK_EVERY) {
            reader.check_memory()?;
            reader.report.advance_until(lines.rest().len())?;
        }
        if reader.plain_line(&mut lines)? {
            continue;
        }
        let Some(line) = lines.next() else {
            break;
        };
        let number = lines.number;
        if is_continued(line) {
            reader.statement(&joined(line, &mut lines), number)?;
        } else {
            reader.statement(line, number)?;
        }
    }
    if let Some(why) = ending::cut(&text, &reader.indices) {
        let place = Place::Line(lines.number);
        reader.report.cut_short(place, &why);
    }
    reader.finish()
}

struct Reader<'a, 'w> {
    report: &'a mut Report<'w>,
    positions: Vec<[f64; 3]>,
    values: Values,
    /// The indices of vertices, texture coordinates and normals.
    indices: [Indices; 3],
    objects: Vec<Object>,
    object_of_name: HashMap<String, usize>,
    /// The name in force, and the object of that name if it has faces.
    name: String,
    object: Option<usize>,
    /// Whether there was any statement that OBJ knows.
    has_statements: bool,
    library: Library,
    materials: Materials,
    material: Option<u32>,
    /// The face that is being read.
    face: Face,
    corners: Vec<plain::Corner>,
}

impl<'a, 'w> Reader<'a, 'w> {
    fn new(report: &'a mut Report<'w>) -> Self {
        Self {
            name: report.source.stem(),
            report,
            positions: Vec::new(),
            values: Values::default(),
            indices: ["vertices", "texture coordinates", "normals"].map(Indices::new),
            objects: Vec::new(),
            object_of_name: HashMap::new(),
            object: None,
            has_statements: false,
            library: Library::default(),
            materials: Materials::default(),
            material: None,
            face: Face::default(),
            corners: Vec::new(),
        }
    }

    /// Fails when all that was read so far takes too much memory.
    fn check_memory(&mut self) -> Checked<()> {
        let positions = size_of_val(self.positions.as_slice());
        let objects: usize = self.objects.iter().map(Object::bytes).sum();
        self.report.budget.charge_growth(self.values.bytes() + positions + objects)
    }

    /// Reads the next line if it is one of the plain ones, of which files mostly consist.
    #[inline]
    fn plain_line(&mut self, lines: &mut Lines) -> Checked<bool> {
        let number = lines.number + 1;
        let rest = match lines.rest() {
            [b'v', text @ ..] if text.starts_with(b" ") && self.values.colors.is_empty() => {
                let Some((position, rest)) = plain::numbers(text) else {
                    return Ok(false);
                };
                self.positions.push(position);
                let [vertices, ..] = &mut self.indices;
                vertices.add(number)?;
                rest
            }
            [b'v', b'n', text @ ..] => {
                let Some((normal, rest)) = plain::numbers(text) else {
                    return Ok(false);
                };
                self.push_normal(normal, number)?;
                rest
            }
            [b'v', b't', text @ ..] => {
                let Some((uv, rest)) = plain::numbers(text) else {
                    return Ok(false);
                };
                self.push_uv(uv, number)?;
                rest
            }
            [b'f', text @ ..] => {
                let Some(rest) = plain::face(text, &mut self.corners) else {
                    return Ok(false);
                };
                self.plain_face(number)?;
                rest
            }
            _ => return Ok(false),
        };
        self.has_statements = true;
        lines.pass(rest);
        Ok(true)
    }

    /// Adds the face of the corners that were read.
    fn plain_face(&mut self, line: u64) -> Checked<()> {
        self.face.clear();
        let [vertices, uvs, normals] = &mut self.indices;
        let [uv_ring, normal_ring] = &mut self.face.others;
        let resolve = |indices: &mut Indices, stated| match stated {
            0 => Ok(NONE),
            stated => indices.resolve(stated, line),
        };
        for &[vertex, uv, normal] in &self.corners {
            self.face.vertices.push(resolve(vertices, vertex)?);
            uv_ring.push(resolve(uvs, uv)?);
            normal_ring.push(resolve(normals, normal)?);
        }
        self.end_face(line);
        Ok(())
    }

    fn statement(&mut self, line: &[u8], number: u64) -> Checked<()> {
        let Some(statement) = line.split(|&byte| byte == b'#').next() else {
            return Ok(());
        };
        let mut words = Words::new(statement);
        let word = words.next();
        self.has_statements = self.has_statements || word.is_some_and(is_known);
        match word {
            None => {}
            Some(b"v") => self.vertex(words, number)?,
            Some(b"vt") => self.uv(words, number)?,
            Some(b"vn") => self.push_normal(numbers(&mut words, number)?, number)?,
            Some(b"f" | b"fo") => self.face(words, number)?,
            Some(b"o" | b"g") => self.begin_object(name_of(line)),
            Some(b"usemtl") => self.material = Some(self.materials.number(name_of(line))),
            Some(b"mtllib") => self.library.add(name_of(line), number, self.report),
            Some(b"p" | b"l") => self.warn("points", number, || {
                "points and lines are not read: only faces are".to_owned()
            }),
            Some(word) if HARMLESS.contains(&word) => {}
            Some(word) if CURVES.contains(&word) => self.warn("curves", number, || {
                format!("curves and curved surfaces are not read: '{}'", shown(word))
            }),
            Some(word) => self.warn("unknown", number, || {
                format!("unknown statement '{}' is not read", shown(word))
            }),
        }
        Ok(())
    }

    fn warn(&mut self, key: &'static str, line: u64, what: impl FnOnce() -> String) {
        self.report.warn(key, &Place::Line(line), what);
    }

    fn vertex(&mut self, mut words: Words, line: u64) -> Checked<()> {
        self.positions.push(numbers(&mut words, line)?);
        let extra: Vec<f64> = words.map(number).collect::<Option<_>>().ok_or_else(|| {
            Fault::line(line, "what follows a vertex's coordinates must be numbers")
        })?;
        match *extra.as_slice() {
            [] | [1.0] | [_, _, _] | [_, _, _, _] => {}
            [_] => self.warn("w", line, || {
                "weights of vertices (a fourth coordinate) are not read".to_owned()
            }),
            _ => self.warn("values", line, || {
                "a vertex with neither 3, 4, 6 nor 7 numbers: only its coordinates are read"
                    .to_owned()
            }),
        }
        self.values.push_color(self.positions.len() - 1, &extra);
        let [vertices, ..] = &mut self.indices;
        vertices.add(line)
    }

    fn uv(&mut self, mut words: Words, line: u64) -> Checked<()> {
        let [u] = numbers(&mut words, line)?;
        let v = words.next().map_or(Some(0.0), number);
        let v = v.ok_or_else(|| Fault::line(line, "a texture coordinate that is not a number"))?;
        self.push_uv([u, v], line)
    }

    fn push_uv(&mut self, uv: [f64; 2], line: u64) -> Checked<()> {
        self.values.uvs.push(uv.map(single));
        let [_, uvs, _] = &mut self.indices;
        uvs.add(line)
    }

    fn push_normal(&mut self, normal: [f64; 3], line: u64) -> Checked<()> {
        self.values.normals.push(normal.map(single));
        let [.., normals] = &mut self.indices;
        normals.add(line)
    }

    fn face(&mut self, words: Words, line: u64) -> Checked<()> {
        self.face.clear();
        for word in words {
            self.corner(word, line)?;
        }
        self.end_face(line);
        Ok(())
    }

    /// Adds the face whose corners have come.
    fn end_face(&mut self, line: u64) {
        if self.face.vertices.len() < 3 {
            self.warn("face", line, || "a face of fewer than 3 corners is not read".to_owned());
            return;
        }
        let object = self.object.unwrap_or_else(|| {
            let object = self.objects.len();
            self.objects.push(Object::new(self.name.clone()));
            self.object_of_name.insert(self.name.clone(), object);
            object
        });
        self.object = Some(object);
        if let Some(object) = self.objects.get_mut(object) {
            object.push(&self.face, self.material);
        }
    }

    /// Reads `v`, `v/t`, `v//n` or `v/t/n`; what stands between the slashes may be missing.
    fn corner(&mut self, word: &[u8], line: u64) -> Checked<()> {
        let mut pieces = word.split(|&byte| byte == b'/');
        let [vertices, uvs, normals] = &mut self.indices;
        let vertex = vertices.parse(pieces.next().unwrap_or_default(), line)?;
        self.face.vertices.push(vertex);
        for (indices, ring) in [uvs, normals].into_iter().zip(&mut self.face.others) {
            ring.push(match pieces.next() {
                None | Some([]) => NONE,
                Some(piece) => indices.parse(piece, line)?,
            });
        }
        if pieces.next().is_some() {
            let what = format!("a corner has at most 3 indices, got '{}'", shown(word));
            return Err(Fault::line(line, what));
        }
        Ok(())
    }

    fn begin_object(&mut self, name: &[u8]) {
        self.name = match name {
            [] => self.report.source.stem(),
            _ => escape_controls(&String::from_utf8_lossy(name)),
        };
        self.object = self.object_of_name.get(&self.name).copied();
    }

    fn finish(mut self) -> Checked<Model> {
        self.check_memory()?;
        if !self.has_statements {
            let what = "not an OBJ file: it has no statement of one";
            return Err(Fault::line(1, what));
        }
        let [vertices, uvs, normals] = &self.indices;
        vertices.check()?;
        for others in [uvs, normals] {
            if let Err(Fault::Content { place, what }) = others.check() {
                let what = || format!("{what}; such objects go without");
                self.report.warn("indices", &place, what);
            }
        }
        if self.objects.is_empty() {
            let (points, stem) = (self.positions.len(), self.report.source.stem());
            self.report.warn("empty", &Place::File, || {
                format!("no faces: there is nothing to see of {points} vertices")
            });
            self.objects.push(Object::new(stem));
        }
        self.look_up_materials();
        self.values.sanitize(self.report);
        let vertices = Vertices::new(Positions::compact(self.positions));
        let mut gather = Gather::default();
        let (values, materials, report) = (&self.values, &self.materials, self.report);
        let finish =
            |object: Object| object.finish(&vertices, values, materials, &mut gather, report);
        let objects = self.objects.into_iter().map(finish);
        Ok(Model::of(objects.collect::<Checked<_>>()?))
    }

    /// Finds what the materials that were named look like, libraries that came later included.
    fn look_up_materials(&mut self) {
        let mut names: Vec<_> = self.materials.numbers.iter().collect();
        names.sort_unstable_by_key(|&(_, &number)| number);
        for (name, _) in names {
            let look = self.library.look(name, self.report);
            if look.is_err() {
                self.report.warn("material", &Place::File, || {
                    let name = shown(name);
                    format!("unknown material '{name}': its faces keep the neutral colour")
                });
            }
            self.materials.looks.push(look.unwrap_or(None));
        }
    }
}
