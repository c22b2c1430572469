//! OFF, the text format of the manual of Geomview, "Object File Format". Its vertices may have
//! colours, normals and texture coordinates.

mod header;
mod rows;

use std::sync::Arc;

use super::fault::{Checked, Fault};
use super::model::Model;
use super::report::Report;
use super::sanitize::{ValueKind, levels_of_bytes, linear, sanitize, sanitize_levels};
use super::surface::{Surface, Vertices, face_attribute};
use super::text;
use crate::error::Place;
use crate::geometry::single;
use crate::scene::{Material, Object};
use crate::shape::{Attribute, Positions};
use header::Header;
use rows::Rows;

/// The memory is charged after this many rows.
const CHECK_EVERY: u64 = 1 << 16;

pub(super) fn read(bytes: &[u8], report: &mut Report) -> Checked<Model> {
    let text = text::decode(bytes);
    let mut lines = text::Lines::new(&text);
    let header = header::parse(&mut lines)?;
    let mut rows = Rows::new(lines, &header)?;
    let mut model = Contents::default();
    for row in 0..header.vertices {
        model.check_memory(row, &rows, report)?;
        model.vertex(&header, &mut rows, report)?;
    }
    for row in 0..header.faces {
        model.check_memory(row, &rows, report)?;
        model.face(&header, &mut rows, report)?;
    }
    model.check_memory(0, &rows, report)?;
    if let Some(line) = rows.next_line() {
        report.warn("trailing", &Place::Line(line), || {
            "lines after the last face are not read".to_owned()
        });
    }
    model.finish(report)
}

/// Colours as they come.
#[derive(Debug, Default)]
struct Colors {
    /// The colours: none, or one for each element so far.
    values: Vec<[f32; 3]>,
    /// Whether a level was written with a point or an exponent: then levels run to 1, else to 255.
    has_fractions: bool,
}

impl Colors {
    /// Adds the colour of the one that comes after `count` others; of none, grey.
    fn push(&mut self, count: usize, color: Option<rows::Color>) {
        if color.is_none() && self.values.is_empty() {
            return;
        }
        let grey = Object::NEUTRAL.to_array().map(single);
        self.values.resize(count, grey);
        self.values.push(color.map_or(grey, |color| {
            self.has_fractions |= color.has_fractions;
            color.levels.map(linear)
        }));
    }

    fn finish(mut self, report: &mut Report) -> Vec<[f32; 3]> {
        // A file of noughts and ones alone has the pure colours, whatever it counts to.
        let reaches_over_one = self.values.iter().flatten().any(|&level| level > 1.0);
        if reaches_over_one && !self.has_fractions {
            levels_of_bytes(&mut self.values);
        }
        sanitize_levels(&mut self.values, report);
        self.values
    }
}

#[derive(Debug, Default)]
struct Contents {
    points: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    surface: Surface,
    /// The colours of vertices and of faces.
    colors: [Colors; 2],
    ring: Vec<u32>,
}

impl Contents {
    fn check_memory(&self, row: u64, rows: &Rows, report: &mut Report) -> Checked<()> {
        if !row.is_multiple_of(CHECK_EVERY) {
            return Ok(());
        }
        let colors = self.colors.iter().map(|colors| size_of_val(&*colors.values));
        let vertices = size_of_val(&*self.points) + size_of_val(&*self.normals);
        let vertices = vertices + size_of_val(&*self.uvs) + colors.sum::<usize>();
        report.budget.charge_growth(vertices + self.surface.bytes())?;
        report.advance_until(rows.left())
    }

    fn vertex(&mut self, header: &Header, rows: &mut Rows, report: &mut Report) -> Checked<()> {
        let kind = header.kind;
        rows.begin()?;
        let mut point = rows.numbers::<3>()?;
        if kind.has_weights {
            let [weight] = rows.numbers()?;
            point = point.map(|x| x / weight);
        }
        if kind.has_normals {
            self.normals.push(rows.numbers()?.map(single));
        }
        if kind.has_colors {
            let behind = if kind.has_uvs { 2 } else { 0 };
            let color = rows.color(behind, report)?;
            let [of_vertices, _] = &mut self.colors;
            of_vertices.push(self.points.len(), color);
        }
        if kind.has_uvs {
            self.uvs.push(rows.numbers()?.map(single));
        }
        self.points.push(point);
        rows.end("values of vertices that the first line does not declare are not read", report);
        Ok(())
    }

    fn face(&mut self, header: &Header, rows: &mut Rows, report: &mut Report) -> Checked<()> {
        rows.begin()?;
        let corners = rows.count()?;
        self.ring.clear();
        for _ in 0..corners {
            self.ring.push(rows.vertex(header.vertices)?);
        }
        if corners < 3 {
            report.warn("corners", &rows.place(), || {
                "points and lines (faces of fewer than 3 corners) are not read".to_owned()
            });
        }
        let color = rows.face_color(report)?;
        let [_, of_faces] = &mut self.colors;
        of_faces.push(self.surface.face_count() as usize, color);
        self.surface.push(&self.ring);
        Ok(())
    }

    fn finish(mut self, report: &mut Report) -> Checked<Model> {
        let name = report.source.stem();
        u32::try_from(self.points.len()).map_err(|_| Fault::file("too many vertices"))?;
        let [of_vertices, of_faces] = self.colors.map(|colors| colors.finish(report));
        if self.surface.is_empty() {
            let points = self.points.len();
            report.warn("empty", &Place::File, || {
                format!("no faces: there is nothing to see of {points} points")
            });
        }
        let vertices = Vertices::new(Positions::compact(self.points));
        let (mut mesh, _) = self.surface.finish(&vertices, &name, report)?;
        if !self.normals.is_empty() {
            sanitize(&mut self.normals, ValueKind::Normals, &Place::File, report);
            mesh = mesh.with_normals(Attribute::per_vertex(self.normals))?;
        }
        if !self.uvs.is_empty() {
            sanitize(&mut self.uvs, ValueKind::Coordinates, &Place::File, report);
            mesh = mesh.with_uvs(Attribute::per_vertex(self.uvs))?;
        }
        let colors = if !of_vertices.is_empty() {
            Some(Attribute::per_vertex(of_vertices))
        } else if of_faces.is_empty() {
            None
        } else {
            Some(face_attribute(&mesh, of_faces))
        };
        let Some(colors) = colors else {
            return Ok(Model::of(vec![Object::new(Arc::new(mesh)).named(name)]));
        };
        let object = Object::new(Arc::new(mesh.with_colors(colors)?)).named(name);
        // White leaves the mesh's own colours as they are.
        Ok(Model::of(vec![object.with_materials([Material::default()])]))
    }
}
