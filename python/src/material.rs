//! Textures and materials.

use std::sync::Arc;

use firsthit::geometry::{self, COLOR_NAMES, color_of};
use firsthit::scene::{AlphaMode, MapRole, Maps, Model, UvSet, Wrap};
use firsthit::scene_file::nearest_word;
use firsthit::{Color, Material, Texture, TextureMap};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::copied;
use crate::errors::{Outcome, Raised};
use crate::shading::{SettingsOut, ValueIn, settings_out};

/// The texels of a texture, which materials can share.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Texels(pub(crate) Arc<Texture>);

#[pymethods]
impl Texels {
    /// A texture from uint8 (rows, columns, 4).
    #[new]
    fn new(texels: PyReadonlyArray3<'_, u8>) -> Outcome<Self> {
        let &[rows, columns, _] = texels.shape() else {
            return Err(Raised::value("texels must have three axes"));
        };
        let bytes = texels.as_slice()?;
        let texture = Texture::new(columns, rows, copied(bytes.as_chunks().0)?)?;
        Ok(Self(Arc::new(texture)))
    }

    /// The texels, uint8 (rows, columns, 4): a copy.
    fn array<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray3<u8>>> {
        let bytes = PyArray1::from_vec(py, copied(self.0.texels().as_flattened())?);
        Ok(bytes.reshape([self.0.rows(), self.0.columns(), 4])?)
    }
}

/// A texture on a surface: texels, the names of its wraps and its filter, its coordinates' map,
/// whether those are the second.
#[derive(FromPyObject)]
pub(crate) struct MapIn<'py>(PyRef<'py, Texels>, [String; 2], String, [[f64; 3]; 2], bool);

/// The scattering model of a material: the model's name, and its settings.
#[derive(FromPyObject)]
struct ModelIn(String, Vec<(String, ValueIn)>);

/// The emission, the scale of the normal map, and the weight of the occlusion map.
#[derive(FromPyObject)]
struct StrengthsIn([f64; 3], f64, f64);

/// A material: colour, alpha, texture, texture for alpha, how alpha counts, its cutoff, unlit,
/// double-sided, its name; what it is made of, its strengths, its other textures by role.
#[derive(FromPyObject)]
pub(crate) struct MaterialIn<'py>(
    [f64; 3],
    f64,
    Option<MapIn<'py>>,
    Option<MapIn<'py>>,
    String,
    f64,
    bool,
    bool,
    String,
    ModelIn,
    StrengthsIn,
    Vec<(String, MapIn<'py>)>,
);

fn map(MapIn(texels, wraps, filter, rows, is_second): &MapIn<'_>) -> Outcome<TextureMap> {
    let [across, down] = wraps;
    Ok(TextureMap {
        texture: Arc::clone(&texels.0),
        wrap: [across.parse()?, down.parse()?],
        filter: filter.parse()?,
        uv_set: if *is_second { UvSet::Second } else { UvSet::First },
        picture_from_uv: *rows,
    })
}

pub(crate) fn material(material: &MaterialIn<'_>) -> Outcome<Material> {
    let MaterialIn(
        color,
        alpha,
        texture,
        alpha_texture,
        mode,
        cutoff,
        unlit,
        double_sided,
        name,
        ModelIn(kind, settings),
        StrengthsIn(emission, normal_scale, occlusion_strength),
        textures,
    ) = material;
    let mut model = Model::named(kind)?;
    for (name, value) in settings {
        model.set(name, (*value).into())?;
    }
    let mut maps = (Maps::default())
        .with(MapRole::Color, texture.as_ref().map(map).transpose()?)
        .with(MapRole::Alpha, alpha_texture.as_ref().map(map).transpose()?);
    for (role, texture) in textures {
        maps = maps.with(role.parse()?, map(texture)?);
    }
    let alpha_mode = match mode.as_str() {
        "opaque" => AlphaMode::Opaque,
        "mask" => AlphaMode::Mask { cutoff: *cutoff },
        "blend" => AlphaMode::Blend,
        _ => {
            let what = format!("alpha_mode must be one of opaque, mask, blend, got '{mode}'");
            return Err(Raised::value(what));
        }
    };
    let material = Material {
        name: name.as_str().into(),
        color: Color::from(*color),
        alpha: *alpha,
        model,
        emission: Color::from(*emission),
        maps,
        normal_scale: *normal_scale,
        occlusion_strength: *occlusion_strength,
        alpha_mode,
        unlit: *unlit,
        double_sided: *double_sided,
    };
    material.check_numbers()?;
    Ok(material)
}

/// Refuses a material of words that are not known and of numbers that make no sense; all settings
/// of what it is made of.
#[pyfunction]
pub(crate) fn check_material(candidate: MaterialIn<'_>) -> Outcome<SettingsOut> {
    Ok(settings_out(material(&candidate)?.model.settings()))
}

type Triple = (f64, f64, f64);

/// A [`MapIn`] on its way out, its texels by number. Tuples, since Python is to compare and hash
/// them.
type MapOut = (usize, (&'static str, &'static str), &'static str, (Triple, Triple), bool);

/// A [`MaterialIn`] on its way out.
pub(crate) type MaterialOut = (
    Triple,
    f64,
    Option<MapOut>,
    Option<MapOut>,
    &'static str,
    f64,
    bool,
    bool,
    String,
    (&'static str, SettingsOut),
    (Triple, f64, f64),
    Vec<(&'static str, MapOut)>,
);

/// The material as Python makes it; `number` gives textures their numbers.
pub(crate) fn material_out(
    material: &Material,
    mut number: impl FnMut(&Arc<Texture>) -> usize,
) -> MaterialOut {
    let mut out = |map: &TextureMap| {
        let wrap = map.wrap.map(Wrap::name);
        let filter = map.filter.name();
        let rows = map.picture_from_uv.map(Triple::from);
        let is_second = map.uv_set == UvSet::Second;
        let texels = number(&map.texture);
        (texels, wrap.into(), filter, rows.into(), is_second)
    };
    let [texture, alpha_texture] =
        [MapRole::Color, MapRole::Alpha].map(|role| material.maps.get(role).map(&mut out));
    let others = material.maps.roles();
    let others = others.filter(|(role, _)| !matches!(role, MapRole::Color | MapRole::Alpha));
    let others = others.map(|(role, map)| (role.name(), out(map))).collect();
    (
        material.color.into(),
        material.alpha,
        texture,
        alpha_texture,
        material.alpha_mode.name(),
        material.alpha_mode.cutoff().unwrap_or(0.5),
        material.unlit,
        material.double_sided,
        material.name.to_string(),
        (material.model.name(), settings_out(material.model.settings())),
        (material.emission.into(), material.normal_scale, material.occlusion_strength),
        others,
    )
}

/// The linear colour that a text names; else the name of a colour, or one of `others`, that was
/// probably meant.
#[pyfunction]
pub(crate) fn named_color(text: &str, others: Vec<String>) -> (Option<[f64; 3]>, Option<String>) {
    let names = COLOR_NAMES.iter().map(|&(name, _)| name);
    let names = names.chain(others.iter().map(String::as_str));
    let color = color_of(text).map(Color::into);
    let meant = match color {
        Some(_) => None,
        None => nearest_word(text, names).map(str::to_owned),
    };
    (color, meant)
}

/// The sRGB colour that was probably meant by numbers up to 255.
#[pyfunction]
pub(crate) fn meant_as_levels(color: [f64; 3]) -> Option<String> {
    geometry::meant_as_levels(color.into())
}

/// The linear value of each of the 256 levels of sRGB.
#[pyfunction]
pub(crate) fn srgb_levels() -> Vec<f64> {
    (0..=u8::MAX).map(|level| geometry::srgb_decode(f64::from(level) / 255.0)).collect()
}
