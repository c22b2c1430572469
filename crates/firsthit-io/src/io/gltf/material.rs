//! Materials, textures, samplers and images.

use std::collections::HashMap;
use std::sync::Arc;

use super::super::fault::Checked;
use super::super::picture;
use super::super::report::Report;
use super::buffers::Buffers;
use super::document::Document;
use super::index::Index;
use super::material_entry::{ImageEntry, MaterialEntry, SamplerEntry, TextureInfo};
use super::model::MaterialNumbers;
use super::place::Entry;
use super::resource::{file_name, resource};
use crate::error::escape_controls;
use crate::scene::{AlphaMode, Filter, MapRole, Maps, Material, Texture, TextureMap, UvSet, Wrap};

/// A material as it is used.
#[derive(Debug, Clone)]
pub(super) struct Look {
    pub(super) materials: Arc<[Material]>,
    /// The sets of texture coordinates that its maps take; `None` for those that it does not need.
    pub(super) sets: [Option<usize>; 2],
    /// The set of texture coordinates of the normal maps, if there are any.
    pub(super) normal_set: Option<UvSet>,
    /// Whether alpha means anything.
    pub(super) has_alpha: bool,
}

/// The materials of a document; each is made when a primitive asks for it, and once.
#[derive(Debug, Default)]
pub(super) struct Looks {
    known: HashMap<usize, Look>,
    pictures: HashMap<usize, Option<Arc<Texture>>>,
}

impl Looks {
    pub(super) fn look<'a>(
        &mut self,
        document: &'a Document<'a>,
        Index(index): Index,
        buffers: &mut Buffers<'a>,
        report: &mut Report,
    ) -> Checked<Look> {
        if let Some(known) = self.known.get(&index) {
            return Ok(known.clone());
        }
        let entry = Entry::new("materials", index);
        let material = document.materials.get(index);
        let material = material.ok_or_else(|| entry.fault("", "there is no such material"))?;
        let (maps, sets) = self.maps(document, (material, entry), buffers, report);
        let alpha_mode = alpha_mode(material, entry)?;
        let name = escape_controls(material.name.as_deref().unwrap_or_default());
        let bytes = name.len() + size_of::<Material>();
        report.budget.charge(bytes as u64, "a material")?;
        let mut numbers = MaterialNumbers { entry, report };
        let (color, alpha) = numbers.base(material);
        let of_normals = [MapRole::Normal, MapRole::ClearcoatNormal];
        let mut of_normals = of_normals.into_iter().filter_map(|role| maps.get(role));
        let look = Look {
            sets,
            normal_set: of_normals.next().map(|map| map.uv_set),
            has_alpha: alpha_mode != AlphaMode::Opaque,
            materials: Arc::new([Material {
                name: name.into(),
                color,
                alpha,
                model: numbers.model(material),
                emission: numbers.emission(material),
                maps,
                normal_scale: numbers
                    .scale(material.normal_texture.as_ref().and_then(|info| info.scale)),
                occlusion_strength: numbers
                    .strength(material.occlusion_texture.as_ref().and_then(|info| info.strength)),
                alpha_mode,
                unlit: material.extensions.unlit.is_some(),
                double_sided: material.double_sided,
            }]),
        };
        self.known.insert(index, look.clone());
        Ok(look)
    }

    /// The maps of a material, and the sets of texture coordinates that they take: that of the
    /// colour comes first.
    fn maps<'a>(
        &mut self,
        document: &'a Document<'a>,
        (material, entry): (&MaterialEntry<'_>, Entry),
        buffers: &mut Buffers<'a>,
        report: &mut Report,
    ) -> (Maps, [Option<usize>; 2]) {
        let (mut maps, mut sets) = (Maps::default(), [None; 2]);
        for (role, place, info) in material.textures() {
            let Some(map) = self.texture(document, info, buffers, report) else {
                continue;
            };
            let set = Some(info.set());
            let mut known = sets.iter_mut().zip([UvSet::First, UvSet::Second]);
            let free = known.find(|(known, _)| **known == set || known.is_none());
            let Some((known, uv_set)) = free else {
                report.warn("TEXCOORD sets", &entry.at(place), || {
                    "a third set of texture coordinates is not read: the surface does without the texture".to_owned()
                });
                continue;
            };
            *known = set;
            maps = maps.with(role, TextureMap { uv_set, ..map });
        }
        (maps, sets)
    }

    fn texture<'a>(
        &mut self,
        document: &'a Document<'a>,
        info: &TextureInfo,
        buffers: &mut Buffers<'a>,
        report: &mut Report,
    ) -> Option<TextureMap> {
        let Index(index) = info.index;
        let entry = Entry::new("textures", index);
        let texture = document.textures.get(index)?;
        let webp = texture.extensions.webp.as_ref();
        let webp = webp.and_then(|webp| webp.source);
        let Some(image) = webp.or(texture.source) else {
            report.warn("source", &entry.place(), || {
                let what = if texture.extensions.basisu.is_some() {
                    "is in a format that is not read, KHR_texture_basisu"
                } else {
                    "has no image in a format that is read"
                };
                format!("the texture {what}: its surfaces do without it")
            });
            return None;
        };
        let picture = self.picture(document, image, buffers, report)?;
        let sampler = texture.sampler;
        let sampler = sampler.and_then(|Index(sampler)| document.samplers.get(sampler));
        let default = SamplerEntry::default();
        let sampler = sampler.unwrap_or(&default);
        if let Some(Index(index)) = texture.sampler {
            sampler.warn_of_unknown(Entry::new("samplers", index), report);
        }
        Some(TextureMap {
            wrap: [sampler.wrap_s, sampler.wrap_t].map(wrap),
            filter: match sampler.mag_filter {
                Some(Index(9728)) => Filter::Nearest,
                _ => Filter::Linear,
            },
            ..TextureMap::new(picture, info.picture_from_uv())
        })
    }

    /// An image's texels; one that cannot be had is a warning, once.
    fn picture<'a>(
        &mut self,
        document: &'a Document<'a>,
        Index(index): Index,
        buffers: &mut Buffers<'a>,
        report: &mut Report,
    ) -> Option<Arc<Texture>> {
        if let Some(known) = self.pictures.get(&index) {
            return known.clone();
        }
        let image = document.images.get(index)?;
        let picture = read(image, buffers, report);
        let picture = picture.map(Arc::new).map_err(|reason| {
            report.warn("image", &Entry::new("images", index).place(), || {
                format!("the image is not read, its surfaces do without it: {reason}")
            });
        });
        self.pictures.insert(index, picture.clone().ok());
        picture.ok()
    }
}

/// The texels of an image.
///
/// # Errors
///
/// In words, why there are none.
fn read(
    image: &ImageEntry<'_>,
    buffers: &mut Buffers<'_>,
    report: &mut Report,
) -> Result<Texture, String> {
    let (bytes, name) = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => (resource(uri, report), Some(uri)),
        (None, Some(view)) => (buffers.view(view, report).map_err(Into::into), None),
        (None, None) => return Err("it has neither a uri nor a buffer view".to_owned()),
    };
    let bytes = bytes.map_err(|problem| problem.into_words(report))?;
    let name = name.and_then(|uri| file_name(uri).ok());
    let extension = name.as_deref().and_then(|name| name.rsplit_once('.')).map(|(_, end)| end);
    picture::decode(bytes.get(), extension, report)
}

fn wrap(code: Option<Index>) -> Wrap {
    match code {
        Some(Index(33071)) => Wrap::Clamp,
        Some(Index(33648)) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

fn alpha_mode(material: &MaterialEntry<'_>, entry: Entry) -> Checked<AlphaMode> {
    match material.alpha_mode.as_deref() {
        None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
        Some("MASK") => Ok(AlphaMode::Mask { cutoff: material.alpha_cutoff.unwrap_or(0.5) }),
        Some("BLEND") => Ok(AlphaMode::Blend),
        Some(mode) => {
            let mode = escape_controls(mode);
            let what = format!("must be OPAQUE, MASK or BLEND, got '{mode}'");
            Err(entry.fault("alphaMode", what))
        }
    }
}
