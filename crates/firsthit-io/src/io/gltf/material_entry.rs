//! The JSON of materials, textures, samplers and images.

use std::borrow::Cow;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::super::report::Report;
use super::index::Index;
use super::place::Entry;
use crate::scene::{MapRole, TextureMap};

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
    pub(super) normal_texture: Option<TextureInfo>,
    pub(super) occlusion_texture: Option<TextureInfo>,
    pub(super) emissive_texture: Option<TextureInfo>,
    pub(super) emissive_factor: [f64; 3],
    pub(super) extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Pbr {
    pub(super) base_color_factor: Option<[f64; 4]>,
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: Option<f64>,
    pub(super) roughness_factor: Option<f64>,
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_unlit")]
    pub(super) unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) diffuse: Option<Diffuse>,
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_ior")]
    pub(super) ior: Option<Ior>,
    #[serde(rename = "KHR_materials_specular")]
    pub(super) specular: Option<Specular>,
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_volume")]
    pub(super) volume: Option<Volume>,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub(super) clearcoat: Option<Clearcoat>,
    #[serde(rename = "KHR_materials_sheen")]
    pub(super) sheen: Option<Sheen>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct EmissiveStrength {
    pub(super) emissive_strength: Option<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Ior {
    pub(super) ior: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
#[expect(clippy::struct_field_names, reason = "as glTF has them")]
pub(super) struct Specular {
    pub(super) specular_factor: Option<f64>,
    pub(super) specular_texture: Option<TextureInfo>,
    pub(super) specular_color_factor: Option<[f64; 3]>,
    pub(super) specular_color_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Transmission {
    pub(super) transmission_factor: Option<f64>,
    pub(super) transmission_texture: Option<TextureInfo>,
}

/// The volume extension. Its texture of thicknesses is left out: it is for renderers that do not
/// follow rays.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Volume {
    pub(super) thickness_factor: Option<f64>,
    pub(super) attenuation_distance: Option<f64>,
    pub(super) attenuation_color: Option<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
#[expect(clippy::struct_field_names, reason = "as glTF has them")]
pub(super) struct Clearcoat {
    pub(super) clearcoat_factor: Option<f64>,
    pub(super) clearcoat_texture: Option<TextureInfo>,
    pub(super) clearcoat_roughness_factor: Option<f64>,
    pub(super) clearcoat_roughness_texture: Option<TextureInfo>,
    pub(super) clearcoat_normal_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
#[expect(clippy::struct_field_names, reason = "as glTF has them")]
pub(super) struct Sheen {
    pub(super) sheen_color_factor: Option<[f64; 3]>,
    pub(super) sheen_color_texture: Option<TextureInfo>,
    pub(super) sheen_roughness_factor: Option<f64>,
    pub(super) sheen_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
#[expect(clippy::struct_field_names, reason = "as glTF has them")]
pub(super) struct Diffuse {
    pub(super) diffuse_factor: Option<[f64; 4]>,
    pub(super) diffuse_texture: Option<TextureInfo>,
    pub(super) specular_factor: Option<[f64; 3]>,
    pub(super) glossiness_factor: Option<f64>,
    pub(super) specular_glossiness_texture: Option<TextureInfo>,
}

/// The reference of a material to a texture.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: Index,
    #[serde(default)]
    pub(super) tex_coord: Index,
    /// The scale of normal maps.
    pub(super) scale: Option<f64>,
    /// The strength of occlusion maps.
    pub(super) strength: Option<f64>,
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
    pub(super) webp: Option<ImageSource>,
    #[serde(rename = "KHR_texture_basisu")]
    pub(super) basisu: Option<ImageSource>,
}

#[derive(Debug, Deserialize)]
pub(super) struct ImageSource {
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
    /// The textures that are read, what each is for, and where it stands; that of the colour first.
    pub(super) fn textures(&self) -> impl Iterator<Item = (MapRole, &'static str, &TextureInfo)> {
        /// The role of a texture of an extension, the texture, and its place.
        macro_rules! of {
            ($role:ident: $extension:ident, $texture:ident, $place:literal) => {
                (
                    MapRole::$role,
                    self.extensions.$extension.as_ref().and_then(|it| it.$texture.as_ref()),
                    concat!("extensions/KHR_materials_", $place),
                )
            };
        }
        let pbr = &self.pbr_metallic_roughness;
        let base = pbr.base_color_texture.as_ref();
        let rough = pbr.metallic_roughness_texture.as_ref();
        // The extension stands in the place of the rest.
        let (color, rough) = match &self.extensions.diffuse {
            Some(_) => {
                (of!(Color: diffuse, diffuse_texture, "pbrSpecularGlossiness/diffuseTexture"), None)
            }
            None => ((MapRole::Color, base, "pbrMetallicRoughness/baseColorTexture"), rough),
        };
        let all = [
            color,
            (MapRole::MetallicRoughness, rough, "pbrMetallicRoughness/metallicRoughnessTexture"),
            (MapRole::Normal, self.normal_texture.as_ref(), "normalTexture"),
            (MapRole::Occlusion, self.occlusion_texture.as_ref(), "occlusionTexture"),
            (MapRole::Emission, self.emissive_texture.as_ref(), "emissiveTexture"),
            of!(Transmission: transmission, transmission_texture, "transmission/transmissionTexture"),
            of!(Specular: specular, specular_texture, "specular/specularTexture"),
            of!(SpecularColor: specular, specular_color_texture, "specular/specularColorTexture"),
            of!(Clearcoat: clearcoat, clearcoat_texture, "clearcoat/clearcoatTexture"),
            of!(ClearcoatRoughness: clearcoat, clearcoat_roughness_texture,
                "clearcoat/clearcoatRoughnessTexture"),
            of!(ClearcoatNormal: clearcoat, clearcoat_normal_texture, "clearcoat/clearcoatNormalTexture"),
            of!(SheenColor: sheen, sheen_color_texture, "sheen/sheenColorTexture"),
            of!(SheenRoughness: sheen, sheen_roughness_texture, "sheen/sheenRoughnessTexture"),
            of!(SpecularColor: diffuse, specular_glossiness_texture,
                "pbrSpecularGlossiness/specularGlossinessTexture"),
        ];
        all.into_iter().filter_map(|(role, texture, place)| Some((role, place, texture?)))
    }

    /// The linear colour and alpha, and the name of the key that has them.
    pub(super) fn base(&self) -> ([f64; 4], &'static str) {
        let base = self.pbr_metallic_roughness.base_color_factor;
        let (factor, name) = match &self.extensions.diffuse {
            Some(diffuse) => (diffuse.diffuse_factor, "diffuseFactor"),
            None => (base, "baseColorFactor"),
        };
        (factor.unwrap_or([1.0; 4]), name)
    }
}

impl TextureInfo {
    /// The set of texture coordinates that the texture takes.
    pub(super) fn set(&self) -> usize {
        let transform = self.extensions.transform.as_ref();
        transform.and_then(|transform| transform.tex_coord).unwrap_or(self.tex_coord).0
    }

    /// The map of texture coordinates to the picture's: scaled, then turned, then moved.
    ///
    /// v counts downwards, so what turns counter-clockwise on paper has its sine the other way
    /// round. (The extension's listing has it wrong, its text and its test asset have it right:
    /// `KhronosGroup/glTF` issue 1563.)
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
        let named = extensions.into_iter().flatten().filter_map(|source| source.source);
        self.source.into_iter().chain(named)
    }
}
