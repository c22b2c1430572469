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
use super::place::Entry;
use super::resource::{file_name, resource};
use crate::error::escape_controls;
use crate::geometry::Color;
use crate::scene::{AlphaMode, Filter, MapRole, Maps, Material, Texture, TextureMap, Wrap};

/// A material as it is used.
#[derive(Debug, Clone)]
pub(super) struct Look {
    pub(super) materials: Arc<[Material]>,
    /// The set of texture coordinates that it takes; `None` without a texture.
    pub(super) set: Option<usize>,
    pub(super) has_cutouts: bool,
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
        let (info, [red, green, blue, alpha]) = material.base();
        let texture = info.and_then(|info| self.texture(document, info, buffers, report));
        let alpha_mode = alpha_mode(material, entry, report)?;
        warn_of_unread(material, entry, report);
        let name = escape_controls(material.name.as_deref().unwrap_or_default());
        report
            .budget
            .charge(name.len() as u64, "a material's name")?;
        let look = Look {
            set: texture.as_ref().and(info).map(TextureInfo::set),
            has_cutouts: matches!(alpha_mode, AlphaMode::Mask { .. }),
            materials: Arc::new([Material {
                name: name.into(),
                color: Color::new(red, green, blue),
                alpha,
                maps: Maps::default().with(MapRole::Color, texture),
                alpha_mode,
                unlit: material.extensions.unlit.is_some(),
                double_sided: material.double_sided,
            }]),
        };
        self.known.insert(index, look.clone());
        Ok(look)
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
                format!("the texture {what}: its surfaces have a flat colour")
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
                format!("the image is not read, its surfaces have a flat colour: {reason}")
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
    let extension = name
        .as_deref()
        .and_then(|name| name.rsplit_once('.'))
        .map(|(_, end)| end);
    picture::decode(bytes.get(), extension, report)
}

fn wrap(code: Option<Index>) -> Wrap {
    match code {
        Some(Index(33071)) => Wrap::Clamp,
        Some(Index(33648)) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

fn alpha_mode(
    material: &MaterialEntry<'_>,
    entry: Entry,
    report: &mut Report,
) -> Checked<AlphaMode> {
    match material.alpha_mode.as_deref() {
        None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
        Some("MASK") => Ok(AlphaMode::Mask {
            cutoff: material.alpha_cutoff.unwrap_or(0.5),
        }),
        Some("BLEND") => {
            report.warn("blend", &entry.at("alphaMode"), || {
                "a surface that lets light through (BLEND) is seen as opaque".to_owned()
            });
            Ok(AlphaMode::Blend)
        }
        Some(mode) => {
            let mode = escape_controls(mode);
            let what = format!("must be OPAQUE, MASK or BLEND, got '{mode}'");
            Err(entry.fault("alphaMode", what))
        }
    }
}

fn warn_of_unread(material: &MaterialEntry<'_>, entry: Entry, report: &mut Report) {
    let unread: Vec<_> = material.unread().collect();
    if !unread.is_empty() {
        report.warn("unread", &entry.place(), || {
            let unread = unread.join(", ");
            format!("of materials only the base colour is read, not {unread}")
        });
    }
}
