//! Textures and materials.

use std::sync::Arc;

use firsthit::geometry::{self, COLOR_NAMES, color_of};
use firsthit::scene::{AlphaMode, Filter, MapRole, Maps, Wrap};
use firsthit::scene_file::nearest_word;
use firsthit::{Color, Material, Texture, TextureMap};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{copied, not_contiguous};
use crate::errors::raise;

/// The texels of a texture, which materials can share.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Texels(pub(crate) Arc<Texture>);

#[pymethods]
impl Texels {
    /// From uint8 (rows, columns, 4).
    #[new]
    fn new(py: Python<'_>, texels: PyReadonlyArray3<'_, u8>) -> PyResult<Self> {
        let &[rows, columns, _] = texels.shape() else {
            return Err(PyValueError::new_err("texels must have three axes"));
        };
        let bytes = texels.as_slice().map_err(not_contiguous)?;
        let texture = Texture::new(columns, rows, copied(bytes.as_chunks().0)?);
        texture
            .map(|texture| Self(Arc::new(texture)))
            .map_err(|error| raise(py, &error))
    }

    /// The texels, uint8 (rows, columns, 4): a copy.
    fn array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let bytes = PyArray1::from_vec(py, copied(self.0.texels().as_flattened())?);
        bytes.reshape([self.0.rows(), self.0.columns(), 4])
    }
}

/// A texture on a surface: texels, the names of its wraps and its filter, its coordinates' map.
#[derive(FromPyObject)]
pub(crate) struct MapIn<'py>(PyRef<'py, Texels>, [String; 2], String, [[f64; 3]; 2]);

/// A material: colour, alpha, texture, texture for alpha, how alpha counts, its cutoff, unlit, double-sided, its name.
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
);

/// What a name stands for.
fn named<T: Copy>(what: &str, name: &str, known: &[(&'static str, T)]) -> PyResult<T> {
    let found = known.iter().find(|&&(known, _)| known == name);
    found.map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<_> = known.iter().map(|&(name, _)| name).collect();
        let text = format!("{what} must be one of {}, got {name:?}", names.join(", "));
        PyValueError::new_err(text)
    })
}

fn map(MapIn(texels, wraps, filter, rows): &MapIn<'_>) -> PyResult<TextureMap> {
    let [across, down] = wraps;
    Ok(TextureMap {
        texture: Arc::clone(&texels.0),
        wrap: [
            named("wrap", across, &Wrap::NAMES)?,
            named("wrap", down, &Wrap::NAMES)?,
        ],
        filter: named("filter", filter, &Filter::NAMES)?,
        picture_from_uv: *rows,
    })
}

pub(crate) fn material(material: &MaterialIn<'_>) -> PyResult<Material> {
    let MaterialIn(color, alpha, texture, alpha_texture, mode, cutoff, unlit, double_sided, name) =
        material;
    let modes = [
        ("opaque", AlphaMode::Opaque),
        ("mask", AlphaMode::Mask { cutoff: *cutoff }),
        ("blend", AlphaMode::Blend),
    ];
    Ok(Material {
        name: name.as_str().into(),
        color: Color::from(*color),
        alpha: *alpha,
        maps: (Maps::default())
            .with(MapRole::Color, texture.as_ref().map(map).transpose()?)
            .with(MapRole::Alpha, alpha_texture.as_ref().map(map).transpose()?),
        alpha_mode: named("alpha_mode", mode, &modes)?,
        unlit: *unlit,
        double_sided: *double_sided,
    })
}

/// Refuses a material of words that are not known.
#[pyfunction]
pub(crate) fn check_material(candidate: MaterialIn<'_>) -> PyResult<()> {
    material(&candidate).map(drop)
}

type Triple = (f64, f64, f64);

/// A [`MapIn`] on its way out, its texels by number. Tuples, since Python is to compare and hash them.
type MapOut = (
    usize,
    (&'static str, &'static str),
    &'static str,
    (Triple, Triple),
);

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
);

/// What Python makes a material from; `number` gives textures their numbers.
pub(crate) fn material_out(
    material: &Material,
    mut number: impl FnMut(&Arc<Texture>) -> usize,
) -> MaterialOut {
    let mut map_out = |role| {
        let map = material.maps.get(role)?;
        let wrap = map.wrap.map(|wrap| name_of(wrap, &Wrap::NAMES));
        let filter = name_of(map.filter, &Filter::NAMES);
        let rows = map.picture_from_uv.map(Triple::from);
        Some((number(&map.texture), wrap.into(), filter, rows.into()))
    };
    let (mode, cutoff) = match material.alpha_mode {
        AlphaMode::Opaque => ("opaque", 0.5),
        AlphaMode::Mask { cutoff } => ("mask", cutoff),
        AlphaMode::Blend => ("blend", 0.5),
    };
    (
        material.color.into(),
        material.alpha,
        map_out(MapRole::Color),
        map_out(MapRole::Alpha),
        mode,
        cutoff,
        material.unlit,
        material.double_sided,
        material.name.to_string(),
    )
}

fn name_of<T: Copy + PartialEq>(value: T, known: &[(&'static str, T)]) -> &'static str {
    let found = known.iter().find(|&&(_, known)| known == value);
    found.map_or("", |&(name, _)| name)
}

/// The linear colour that a text names; else the name of a colour, or one of `others`, that was probably meant.
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
    (0..=u8::MAX)
        .map(|level| geometry::srgb_decode(f64::from(level) / 255.0))
        .collect()
}
