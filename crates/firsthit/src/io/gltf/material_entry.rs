//! The JSON of materials, textures, samplers and images.

use std::borrow::Cow;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::super::report::Report;
use super::index::Index;
use super::place::Entry;
use crate::scene::TextureMap;

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct MaterialEntry<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Cow<'a, str>>,
    #[serde(borrow)]
    pub(super) alpha_mode: Option<Cow<'a, str>>,
    pub(super) alpha_cutoff: Option<f64>,
    pub(super) double_sided: bool,
    pub(super) pbr_metallic_roughness: Pbr,
    pub(super) normal_texture: Option<IgnoredAny>,
    pub(super) occlusion_texture: Option<IgnoredAny>,
    pub(super) emissive_texture: Option<IgnoredAny>,
    pub(super) emissive_factor: [f64; 3],
    pub(super) extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Pbr {
    pub(super) base_color_factor: Option<[f64; 4]>,
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_roughness_texture: Option<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_unlit")]
    pub(super) unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) diffuse: Option<Diffuse>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Diffuse {
    pub(super) diffuse_factor: Option<[f64; 4]>,
    pub(super) diffuse_texture: Option<TextureInfo>,
}

/// How a material names a texture.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: Index,
    #[serde(default)]
    pub(super) tex_coord: Index,
    #[serde(default)]
    pub(super) extensions: TextureInfoExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TextureTransform {
    pub(super) offset: [f64; 2],
    pub(super) rotation: f64,
    pub(super) scale: Option<[f64; 2]>,
    pub(super) tex_coord: Option<Index>,
}

#[derive(Debug, Deserialize)]
pub(super) struct TextureEntry {
    pub(super) sampler: Option<Index>,
    pub(super) source: Option<Index>,
    #[serde(default)]
    pub(super) extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    pub(super) webp: Option<Source>,
    #[serde(rename = "KHR_texture_basisu")]
    pub(super) basisu: Option<Source>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Source {
    pub(super) source: Option<Index>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct ImageEntry<'a> {
    #[serde(borrow)]
    pub(super) uri: Option<Cow<'a, str>>,
    pub(super) buffer_view: Option<Index>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SamplerEntry {
    pub(super) mag_filter: Option<Index>,
    pub(super) min_filter: Option<Index>,
    pub(super) wrap_s: Option<Index>,
    pub(super) wrap_t: Option<Index>,
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
    pub(super) fn base(&self) -> (Option<&TextureInfo>, [f64; 4]) {
        let pbr = &self.pbr_metallic_roughness;
        let (texture, factor) = match &self.extensions.diffuse {
            Some(diffuse) => (&diffuse.diffuse_texture, diffuse.diffuse_factor),
            None => (&pbr.base_color_texture, pbr.base_color_factor),
        };
        (texture.as_ref(), factor.unwrap_or([1.0; 4]))
    }

    /// The names of its properties that are not read.
    pub(super) fn unread(&self) -> impl Iterator<Item = &'static str> {
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
    pub(super) fn set(&self) -> usize {
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
    pub(super) fn picture_from_uv(&self) -> [[f64; 3]; 2] {
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
    pub(super) fn warn_of_unknown(&self, entry: Entry, report: &mut Report) {
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
