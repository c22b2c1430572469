//! Materials, textures, samplers and images.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::super::picture;
use super::super::report::{Checked, Report};
use super::buffers::{Buffers, file_name, resource};
use super::document::{Document, Index};
use super::place::Entry;
use crate::geometry::Color;
use crate::scene::{AlphaMode, Filter, Material, Texture, TextureMap, Wrap};

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MaterialEntry<'a> {
    #[serde(borrow)]
    alpha_mode: Option<Cow<'a, str>>,
    alpha_cutoff: Option<f64>,
    #[serde(default)]
    double_sided: bool,
    #[serde(default)]
    pbr_metallic_roughness: Pbr,
    normal_texture: Option<IgnoredAny>,
    occlusion_texture: Option<IgnoredAny>,
    emissive_texture: Option<IgnoredAny>,
    #[serde(default)]
    emissive_factor: [f64; 3],
    #[serde(default)]
    extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Pbr {
    base_color_factor: Option<[f64; 4]>,
    base_color_texture: Option<TextureInfo>,
    metallic_roughness_texture: Option<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
struct MaterialExtensions {
    #[serde(rename = "KHR_materials_unlit")]
    unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    diffuse: Option<Diffuse>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Diffuse {
    diffuse_factor: Option<[f64; 4]>,
    diffuse_texture: Option<TextureInfo>,
}

/// How a material names a texture.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: Index,
    #[serde(default)]
    tex_coord: Index,
    #[serde(default)]
    extensions: TextureInfoExtensions,
}

#[derive(Debug, Default, Deserialize)]
struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<TextureTransform>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct TextureTransform {
    #[serde(default)]
    offset: [f64; 2],
    #[serde(default)]
    rotation: f64,
    scale: Option<[f64; 2]>,
    tex_coord: Option<Index>,
}

#[derive(Debug, Deserialize)]
pub(super) struct TextureEntry {
    pub(super) sampler: Option<Index>,
    source: Option<Index>,
    #[serde(default)]
    extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
struct TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<Source>,
    #[serde(rename = "KHR_texture_basisu")]
    basisu: Option<Source>,
}

#[derive(Debug, Deserialize)]
struct Source {
    source: Option<Index>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct ImageEntry<'a> {
    #[serde(borrow)]
    uri: Option<Cow<'a, str>>,
    pub(super) buffer_view: Option<Index>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SamplerEntry {
    mag_filter: Option<Index>,
    min_filter: Option<Index>,
    wrap_s: Option<Index>,
    wrap_t: Option<Index>,
}

impl MaterialEntry<'_> {
    /// The textures that are read, and where each stands.
    pub(super) fn textures(&self) -> impl Iterator<Item = (&'static str, &TextureInfo)> {
        let base = &self.pbr_metallic_roughness.base_color_texture;
        let diffuse = self.extensions.diffuse.as_ref();
        let diffuse = diffuse.and_then(|diffuse| diffuse.diffuse_texture.as_ref());
        let place = "extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture";
        let base = base
            .as_ref()
            .map(|info| ("pbrMetallicRoughness/baseColorTexture", info));
        base.into_iter().chain(diffuse.map(|info| (place, info)))
    }

    /// The texture, and the linear colour and alpha that multiply it.
    fn base(&self) -> (Option<&TextureInfo>, [f64; 4]) {
        let pbr = &self.pbr_metallic_roughness;
        let (texture, factor) = match &self.extensions.diffuse {
            Some(diffuse) => (&diffuse.diffuse_texture, diffuse.diffuse_factor),
            None => (&pbr.base_color_texture, pbr.base_color_factor),
        };
        (texture.as_ref(), factor.unwrap_or([1.0; 4]))
    }

    /// The names of what it has that is not read.
    fn unread(&self) -> impl Iterator<Item = &'static str> {
        let rough = self
            .pbr_metallic_roughness
            .metallic_roughness_texture
            .is_some();
        [
            ("normalTexture", self.normal_texture.is_some()),
            ("occlusionTexture", self.occlusion_texture.is_some()),
            ("emissiveTexture", self.emissive_texture.is_some()),
            ("metallicRoughnessTexture", rough),
            ("emissiveFactor", self.emissive_factor != [0.0; 3]),
        ]
        .into_iter()
        .filter_map(|(name, is_there)| is_there.then_some(name))
    }
}

impl TextureInfo {
    /// Which set of texture coordinates it takes.
    fn set(&self) -> usize {
        let transform = self.extensions.transform.as_ref();
        transform
            .and_then(|transform| transform.tex_coord)
            .unwrap_or(self.tex_coord)
            .0
    }

    /// The map of texture coordinates to the picture's: scaled, then turned, then moved.
    ///
    /// v counts downwards, so what turns counter-clockwise on paper has its sine the other way round. (The
    /// extension's listing has it wrong, its text and its test asset have it right: `KhronosGroup/glTF` issue 1563.)
    fn picture_from_uv(&self) -> [[f64; 3]; 2] {
        let Some(transform) = &self.extensions.transform else {
            return TextureMap::V_DOWN;
        };
        let ([x, y], [u, v]) = (transform.scale.unwrap_or([1.0; 2]), transform.offset);
        let (sine, cosine) = (libm::sin(transform.rotation), libm::cos(transform.rotation));
        [[cosine * x, sine * y, u], [-sine * x, cosine * y, v]]
    }
}

impl SamplerEntry {
    /// Says which of its words mean nothing: such are as if they were not there.
    fn warn_of_unknown(&self, entry: Entry, report: &mut Report) {
        const WRAPS: &[usize] = &[10497, 33071, 33648];
        const FILTERS: &[usize] = &[9728, 9729];
        const SMALLER: &[usize] = &[9728, 9729, 9984, 9985, 9986, 9987];
        for (name, code, known) in [
            ("wrapS", self.wrap_s, WRAPS),
            ("wrapT", self.wrap_t, WRAPS),
            ("magFilter", self.mag_filter, FILTERS),
            ("minFilter", self.min_filter, SMALLER),
        ] {
            if let Some(Index(code)) = code.filter(|code| !known.contains(&code.0)) {
                report.warn("sampler", &entry.at(name), || {
                    format!("must be one of {known:?}, got {code}: the default is taken")
                });
            }
        }
    }
}

impl TextureEntry {
    /// All images that it may be made from.
    pub(super) fn sources(&self) -> impl Iterator<Item = Index> {
        let extensions = [&self.extensions.webp, &self.extensions.basisu];
        let named = extensions
            .into_iter()
            .flatten()
            .filter_map(|source| source.source);
        self.source.into_iter().chain(named)
    }
}

/// A material as it is used.
#[derive(Debug, Clone)]
pub(super) struct Look {
    pub(super) materials: Arc<[Material]>,
    /// The set of texture coordinates that it takes; `None` without a texture.
    pub(super) set: Option<usize>,
    pub(super) has_holes: bool,
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
        let look = Look {
            set: texture.as_ref().and(info).map(TextureInfo::set),
            has_holes: matches!(alpha_mode, AlphaMode::Mask { .. }),
            materials: Arc::new([Material {
                color: Color::new(red, green, blue),
                alpha,
                texture,
                alpha_texture: None,
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
        let webp = texture
            .extensions
            .webp
            .as_ref()
            .and_then(|webp| webp.source);
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
        let sampler = texture
            .sampler
            .and_then(|Index(sampler)| document.samplers.get(sampler));
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
            let mode = crate::error::escape_controls(mode);
            let what = format!("must be OPAQUE, MASK or BLEND, got '{mode}'");
            Err(entry.fault("alphaMode", what))
        }
    }
}

fn warn_of_unread(material: &MaterialEntry<'_>, entry: Entry, report: &mut Report) {
    let unread: Vec<_> = material.unread().collect();
    if !unread.is_empty() {
        report.warn("unread", &entry.place(), || {
            format!(
                "of materials only the base colour is read, not {}",
                unread.join(", ")
            )
        });
    }
}
