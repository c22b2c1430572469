//! The hit of an explained ray: the surface there, and its material.

use firsthit::explain::{AttributeThere, CatalogEntry, Explanation, HitDetails};
use firsthit::scene::MapRole;
use firsthit::shape::PropertyOf;
use firsthit::{AlphaMode, DVec2, Material};
use serde_json::{Value, json};

use super::{list, named, part, short};
use crate::words::{coordinate, exact_number, number, place, triple};

/// The most numbers of an attribute, and the most attributes, in texts for people.
const MOST: usize = 12;

/// The hit in words.
pub(super) fn lines(explained: &Explanation<'_>, details: &HitDetails<'_>) -> Vec<String> {
    let extent = explained.extent;
    let hit = &details.hit;
    let from_camera = explained.pixel.as_ref().map_or_else(String::new, |pixel| {
        let [range, z] = [pixel.range, pixel.z].map(|length| coordinate(length, extent));
        format!(", range {range}, z {z}")
    });
    let face =
        if details.shape == "mesh" { format!(", face {}", details.face) } else { String::new() };
    let named = named(hit.object, details.name, details.shape);
    let part = part(details.shape, hit.primitive);
    let side = if details.is_front { "front" } else { "back" };
    let mut lines = vec![
        format!("hit        t {}{from_camera}", exact_number(hit.t)),
        format!("           {named}, {part}{face}"),
    ];
    lines.extend(origin_line(details));
    lines.extend([
        format!("           position {}", place(details.position, extent)),
        format!("           normal {}, {side} met", triple(details.normal)),
    ]);
    if details.shading_normal.to_array() != details.normal.to_array()
        && details.shading_normal.is_finite()
    {
        let shading = triple(details.shading_normal);
        lines.push(format!("           shading normal {shading}"));
    }
    if let Some(weights) = weights(hit.barycentric) {
        lines.push(format!("           barycentric {}", list(&weights)));
    }
    if let Some(uv) = details.uv {
        lines.push(format!("           uv {}", list(&uv.to_array())));
    }
    let color = triple(details.color);
    lines.push(format!("           base colour {color}, linear"));
    lines.push(match (&details.material_entry, details.material) {
        (Some(entry), Some(material)) => {
            let (named, look) = (entry_text("material", entry), material_text(material));
            format!("           {named}: {look}")
        }
        _ => "           no material".to_owned(),
    });
    lines.extend(details.attributes.iter().take(MOST).map(attribute_line));
    let more = details.attributes.len().saturating_sub(MOST);
    if more > 0 {
        lines.push(format!("           ... and {more} more attributes"));
    }
    lines
}

/// The node and the mesh that the object comes from, if there are any.
fn origin_line(details: &HitDetails<'_>) -> Option<String> {
    let entries = [("node", &details.node), ("mesh", &details.mesh)].into_iter();
    let entries = entries.filter_map(|(kind, entry)| Some(entry_text(kind, entry.as_ref()?)));
    let entries: Vec<String> = entries.collect();
    (!entries.is_empty()).then(|| format!("           of {}", entries.join(", ")))
}

/// A node, a mesh or a material in words.
fn entry_text(kind: &str, entry: &CatalogEntry<'_>) -> String {
    let CatalogEntry { number, name } = entry;
    if name.is_empty() {
        format!("{kind} {number}")
    } else {
        format!("{kind} {number} '{}'", short(name))
    }
}

/// The weights of all corners of a triangle.
fn weights(barycentric: DVec2) -> Option<[f64; 3]> {
    let [b, c] = barycentric.to_array();
    (!barycentric.is_nan()).then_some([1.0 - b - c, b, c])
}

fn material_text(material: &Material) -> String {
    let alpha = match material.alpha_mode {
        AlphaMode::Opaque => "opaque".to_owned(),
        AlphaMode::Mask { cutoff } => format!("cut out below alpha {}", number(cutoff)),
        AlphaMode::Blend => "translucent".to_owned(),
    };
    let mut words = vec![
        format!("colour {}", triple(material.color)),
        format!("alpha {}", number(material.alpha)),
        alpha,
    ];
    if material.unlit {
        words.push("unlit".to_owned());
    }
    for (role, name) in [(MapRole::Color, "colour"), (MapRole::Alpha, "alpha")] {
        if let Some([columns, rows]) = map_size(material, role) {
            words.push(format!("{name} map of {columns} x {rows}"));
        }
    }
    words.join(", ")
}

fn map_size(material: &Material, role: MapRole) -> Option<[usize; 2]> {
    let texture = &material.maps.get(role)?.texture;
    Some([texture.columns(), texture.rows()])
}

fn attribute_line(attribute: &AttributeThere<'_>) -> String {
    let AttributeThere { name, of, values } = attribute;
    let shown = list(&values[..values.len().min(MOST)]);
    let more = if values.len() > MOST { ",..." } else { "" };
    let (name, of) = (short(name), of_name(*of));
    format!("           attribute '{name}' of {of}: {shown}{more}")
}

fn of_name(of: PropertyOf) -> &'static str {
    match of {
        PropertyOf::Vertices => "vertices",
        PropertyOf::Corners => "corners",
        PropertyOf::Faces => "faces",
    }
}

/// The hit for programs.
pub(super) fn json(details: &HitDetails<'_>) -> Value {
    let attribute = |attribute: &AttributeThere<'_>| {
        json!({
            "name": attribute.name,
            "of": of_name(attribute.of),
            "values": attribute.values,
        })
    };
    let attributes = details.attributes.iter().map(attribute);
    json!({
        "t": details.hit.t,
        "object": details.hit.object,
        "primitive": details.hit.primitive,
        "name": details.name,
        "shape": details.shape,
        "node": details.node.as_ref().map(entry_json),
        "mesh": details.mesh.as_ref().map(entry_json),
        "face": details.face,
        "position": details.position.to_array(),
        "normal": details.normal.to_array(),
        "shading_normal": details.shading_normal.to_array(),
        "front": details.is_front,
        "barycentric": weights(details.hit.barycentric),
        "uv": details.uv.map(|uv| uv.to_array()),
        "base_color": details.color.to_array(),
        "material": details.material.map(|material| material_json(details.material_entry.as_ref(), material)),
        "attributes": attributes.collect::<Vec<_>>(),
    })
}

fn entry_json(entry: &CatalogEntry<'_>) -> Value {
    json!({"id": entry.number, "name": entry.name})
}

fn material_json(entry: Option<&CatalogEntry<'_>>, material: &Material) -> Value {
    json!({
        "id": entry.map(|entry| entry.number),
        "name": entry.map(|entry| entry.name),
        "color": material.color.to_array(),
        "alpha": material.alpha,
        "alpha_mode": material.alpha_mode.name(),
        "cutoff": material.alpha_mode.cutoff(),
        "unlit": material.unlit,
        "double_sided": material.double_sided,
        "color_map": map_size(material, MapRole::Color),
        "alpha_map": map_size(material, MapRole::Alpha),
    })
}
