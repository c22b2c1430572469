//! glTF 2.0: scenes as JSON with binary buffers, and GLB, which is both in one file.

mod accessor;
mod buffers;
mod camera;
mod container;
mod document;
mod draco;
mod index;
mod light;
mod material;
mod material_entry;
mod mesh;
mod meshopt;
mod model;
mod named;
mod nodes;
mod objects;
mod place;
mod problem;
mod references;
mod resource;
mod skin;
mod values;
mod variants;

use super::fault::{Checked, Fault};
use super::model::Model;
use super::report::Report;
use crate::error::{Place, escape_controls};
use crate::scene::Object;
use buffers::Buffers;
use document::Document;
use objects::Objects;

/// The extensions that are read, or whose use is a warning where it shows.
const KNOWN: &[&str] = &[
    "CESIUM_RTC",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Extensions that change no surface, only its look: a picture without them is complete, so they
/// are a warning even where they are required.
const LOOKS: &[&str] = &[
    "GOOGLE_texture_basis",
    "KHR_animation_pointer",
    "KHR_materials_anisotropy",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_technique_webgl",
    "KHR_techniques_webgl",
    "KHR_texture_ktx",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_texture_dds",
];

pub(super) fn read(bytes: &[u8], report: &mut Report) -> Checked<Model> {
    let container = container::open(bytes, report)?;
    document::charge(&container, report)?;
    let mut document = document::parse(&container)?;
    variants::choose(&mut document, report);
    check_extensions(&document, report)?;
    references::check(&document)?;
    let placed = nodes::walk(&document, report)?;
    let cameras = camera::all(&document, &placed, report)?;
    let lights = light::all(&document, &placed, report)?;
    let buffers = Buffers::new(&document, container.binary);
    buffers.begin(report)?;
    let objects = Objects::new(&document, &placed, buffers, report).all()?;
    if let Some(relative) = &document.extensions.relative_to {
        let place = Place::Pointer("/extensions/CESIUM_RTC/center".into());
        report.warn("center", &place, || {
            let center = &relative.center;
            format!("everything is relative to {center:?}, which is not added: it stays around the file's own origin")
        });
    }
    if !document.animations.is_empty() {
        report.warn("animations", &Place::Pointer("/animations".into()), || {
            let count = document.animations.len();
            match count {
                1 => "1 animation is not read: everything is at rest".to_owned(),
                _ => format!("{count} animations are not read: everything is at rest"),
            }
        });
    }
    if objects.iter().all(|object| object.triangles() == 0) {
        let what = || "no triangles: there is nothing to see".to_owned();
        report.warn("empty", &Place::File, what);
    }
    let meshes = objects.iter().filter_map(Object::mesh);
    report.vertices = Some(meshes.map(|mesh| mesh.positions().len() as u64).sum());
    Ok(Model { cameras, lights, ..Model::of(objects) })
}

/// Refuses a document that cannot be read without an extension that is not read.
fn check_extensions(document: &Document<'_>, report: &mut Report) -> Checked<()> {
    let is_known = |name: &str| KNOWN.contains(&name);
    let required = document.extensions_required.iter().enumerate();
    for (k, name) in required {
        if !is_known(name) && !LOOKS.contains(&name.as_ref()) {
            let name = escape_controls(name);
            let what = format!("the extension '{name}' is required, and not read");
            let place = Place::Pointer(format!("/extensionsRequired/{k}"));
            return Err(Fault::at(place, what));
        }
    }
    let named = document.extensions_used.iter();
    let mut unknown: Vec<_> = named
        .chain(&document.extensions_required)
        .filter(|name| !is_known(name))
        .map(|name| escape_controls(name))
        .collect();
    unknown.sort_unstable();
    unknown.dedup();
    if !unknown.is_empty() {
        let place = Place::Pointer("/extensionsUsed".into());
        report.warn("extensions", &place, || {
            format!("extensions that are not read: {}", unknown.join(", "))
        });
    }
    Ok(())
}
