//! Variants of materials: `KHR_materials_variants`.

use super::super::report::Report;
use super::document::Document;
use super::index::Index;

/// Gives the primitives the materials of the variant that is asked for, where the document has it;
/// adds the names of all to the report.
pub(super) fn choose(document: &mut Document<'_>, report: &mut Report) {
    let Some(list) = &document.extensions.variants else {
        return;
    };
    let asked = report.settings.variant.as_deref();
    let chosen = list.variants.iter().position(|one| Some(&*one.name) == asked);
    let names = list.variants.iter().map(|one| one.name.clone().into_owned());
    report.add_variants(names);
    let Some(chosen) = chosen else {
        return;
    };
    let primitives = document.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives);
    for primitive in primitives {
        let Some(mapped) = &primitive.extensions.variants else {
            continue;
        };
        let mut mappings = mapped.mappings.iter();
        // Without one, the primitive keeps its own material.
        if let Some(mapping) = mappings.find(|mapping| mapping.variants.contains(&Index(chosen))) {
            primitive.material = Some(mapping.material);
        }
    }
}
