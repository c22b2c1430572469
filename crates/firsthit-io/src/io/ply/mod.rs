//! PLY, the Stanford polygon format: text or binary in either byte order, in any order of elements.

mod body;
mod faces;
mod header;
mod levels;
mod named;
mod vertices;

use std::path::Path;
use std::sync::Arc;

use super::fault::{Checked, Fault};
use super::model::Model;
use super::picture;
use super::report::Report;
use super::sanitize::{self, sanitize, sanitize_levels};
use super::surface::{Surface, Vertices, face_attribute};
use super::text::shown;
use crate::error::{Place, escape_controls};
use crate::scene::{MapRole, Maps, Material, Object, TextureMap};
use crate::shape::{Attribute, Positions};
use body::{Ascii, Binary, Rows, skip};
use faces::Faces;
use header::{Format, Header};
use vertices::VertexRows;

pub(super) fn read(bytes: &[u8], report: &mut Report) -> Checked<Model> {
    let header = header::parse(bytes)?;
    if let Some((line, text)) = &header.stray {
        report.warn("stray", &Place::Line(*line), || {
            format!("this line of the header is not read: '{text}'")
        });
    }
    if let Some((line, name)) = &header.repeated {
        report.warn("repeated", &Place::Line(*line), || {
            format!("property '{name}' is there twice in its element: the first one counts")
        });
    }
    match header.format {
        Format::Ascii => read_body(&header, Ascii::new(&header), report),
        Format::Little => read_body(&header, Binary::new(&header, bytes.len(), false), report),
        Format::Big => read_body(&header, Binary::new(&header, bytes.len(), true), report),
    }
}

fn read_body<R: Rows>(header: &Header, mut rows: R, report: &mut Report) -> Checked<Model> {
    if header.elements.is_empty() {
        let what = || "no elements: there is nothing to see".to_owned();
        report.warn("empty", &Place::File, what);
        return Ok(Model::default());
    }
    let element = header
        .vertex_element()?
        .ok_or_else(|| Fault::line(header.lines, "no vertex element: there is no geometry"))?;
    let mut vertices = VertexRows::new(element, header)?;
    let mut faces = Faces::new(element.count);
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices.read(element, &mut rows, report)?,
            "face" => faces.read(element, &mut rows, report)?,
            "tristrips" => faces.read_strips(element, &mut rows)?,
            name => {
                if element.count > 0 {
                    report.warn("element", &Place::Line(element.line), || {
                        format!("element '{name}' is not read")
                    });
                }
                skip(element, &mut rows)?;
            }
        }
    }
    rows.end(report);
    let texture = texture(header, report);
    model(vertices, faces, texture, report)
}

/// The texture that a comment names, as many programs write it.
fn texture(header: &Header, report: &mut Report) -> Option<TextureMap> {
    let named = header.textures.first()?;
    let place = Place::Line(named.line);
    if header.textures.len() > 1 {
        report.warn("textures", &place, || {
            let (count, name) = (header.textures.len(), shown(named.name.as_bytes()));
            format!("{count} textures are named, only the first is read: '{name}'")
        });
    }
    let scene = report.source.base().map(Path::to_owned);
    match scene.and_then(|scene| picture::sibling(&scene, &named.name, report)) {
        Ok(texture) => Some(TextureMap::new(texture.into(), TextureMap::V_UP)),
        Err(reason) => {
            report.warn("texture", &place, || {
                let name = escape_controls(&named.name);
                format!("texture '{name}' is not read: {reason}")
            });
            None
        }
    }
}

fn model(
    vertices: VertexRows,
    faces: Faces,
    texture: Option<TextureMap>,
    report: &mut Report,
) -> Checked<Model> {
    let name = report.source.stem();
    let surface = faces.surface;
    let mut properties = vertices.named.into_properties();
    properties.extend(faces.named.into_properties());
    let shared = Vertices::new(match vertices.points {
        Positions::Double(points) => Positions::compact(points.into_vec()),
        single @ Positions::Single(_) => single,
    });
    warn_if_empty(&surface, &shared, report);
    let count = surface.face_count();
    let (mut mesh, _) = surface.finish(&shared, &name, report)?;
    if let Some(mut normals) = vertices.normals {
        sanitize(&mut normals, sanitize::ValueKind::Normals, &Place::File, report);
        mesh = mesh.with_normals(Attribute::per_vertex(normals))?;
    }
    if let Some(mut uvs) = vertices.uvs {
        sanitize(&mut uvs, sanitize::ValueKind::Coordinates, &Place::File, report);
        mesh = mesh.with_uvs(Attribute::per_vertex(uvs))?;
    }
    let colors = match (vertices.colors, faces.colors) {
        (Some(colors), _) => Some(Attribute::per_vertex(colors)),
        (None, colors) if colors.len() == count as usize && count > 0 => {
            Some(face_attribute(&mesh, colors))
        }
        _ => None,
    };
    mesh = mesh.with_properties(properties)?;
    // White leaves the mesh's own colours as they are.
    let is_painted = colors.is_some() || texture.is_some();
    let look = is_painted.then(|| Material {
        maps: Maps::default().with(MapRole::Color, texture),
        ..Material::default()
    });
    if let Some(mut colors) = colors {
        (colors.values).edit(|values| sanitize_levels(values, report));
        mesh = mesh.with_colors(colors)?;
    }
    let object = Object::new(Arc::new(mesh)).named(name);
    Ok(Model::of(vec![match look {
        Some(look) => object.with_materials([look]),
        None => object,
    }]))
}

fn warn_if_empty(surface: &Surface, vertices: &Vertices, report: &mut Report) {
    if surface.is_empty() {
        let points = vertices.positions.len();
        report.warn("empty", &Place::File, || match points {
            0 => "no faces: there is nothing to see".to_owned(),
            _ => format!("no faces: there is nothing to see of a cloud of {points} points"),
        });
    }
}
