//! Materials.

use serde::{Deserialize, Serialize};

use super::super::number::{Number, Triple};
use super::kind::KindRecord;
use super::missing;
use crate::error::{Result, escape_controls};
use crate::geometry::DVec3;
use crate::scene::{AlphaMode, MapRole, Maps, Material, Model, TextureMap};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::fhs) struct MaterialRecord {
    #[serde(default, skip_serializing_if = "String::is_empty")]
    name: String,
    color: Triple,
    alpha: Number,
    /// The map of each role, by its place in the record.
    color_map: Option<usize>,
    alpha_map: Option<usize>,
    /// The maps of other roles, by their names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    maps: Vec<(String, usize)>,
    /// `None` for a matte one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    model: Option<KindRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    emission: Option<Triple>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal_scale: Option<Number>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    occlusion_strength: Option<Number>,
    alpha_mode: AlphaRecord,
    unlit: bool,
    double_sided: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AlphaRecord {
    Opaque,
    Mask(Number),
    Blend,
}

impl MaterialRecord {
    /// `number` gives a map its place.
    pub(in crate::fhs) fn new<'a>(
        material: &'a Material,
        mut number: impl FnMut(&'a TextureMap) -> usize,
    ) -> Self {
        let is_own = |role| matches!(role, MapRole::Color | MapRole::Alpha);
        let mut map = |role| material.maps.get(role).map(&mut number);
        let [color_map, alpha_map] = [map(MapRole::Color), map(MapRole::Alpha)];
        let others = material.maps.roles().filter(|&(role, _)| !is_own(role));
        let maps = others.map(|(role, map)| (role.name().to_owned(), number(map)));
        let unless_one = |value: f64| (value != 1.0).then_some(Number(value));
        Self {
            name: material.name.to_string(),
            color: material.color.into(),
            alpha: Number(material.alpha),
            color_map,
            alpha_map,
            maps: maps.collect(),
            model: (material.model != Model::default())
                .then(|| KindRecord::new(material.model.name(), material.model.settings())),
            emission: (material.emission != DVec3::ZERO).then(|| material.emission.into()),
            normal_scale: unless_one(material.normal_scale),
            occlusion_strength: unless_one(material.occlusion_strength),
            alpha_mode: match material.alpha_mode {
                AlphaMode::Opaque => AlphaRecord::Opaque,
                AlphaMode::Mask { cutoff } => AlphaRecord::Mask(Number(cutoff)),
                AlphaMode::Blend => AlphaRecord::Blend,
            },
            unlit: material.unlit,
            double_sided: material.double_sided,
        }
    }

    pub(in crate::fhs) fn material(&self, maps: &[TextureMap]) -> Result<Material> {
        let map = |number: Option<usize>| {
            let found = number.map(|number| maps.get(number).cloned().ok_or(number));
            found.transpose().map_err(|number| missing("a map", number))
        };
        let mut all = Maps::default()
            .with(MapRole::Color, map(self.color_map)?)
            .with(MapRole::Alpha, map(self.alpha_map)?);
        for (name, number) in &self.maps {
            all = all.with(name.parse()?, map(Some(*number))?);
        }
        let or_one = |value: Option<Number>| value.map_or(1.0, |Number(value)| value);
        let material = Material {
            name: escape_controls(&self.name).into(),
            color: self.color.into(),
            alpha: self.alpha.0,
            maps: all,
            model: self.model.as_ref().map_or(Ok(Model::default()), KindRecord::model)?,
            emission: self.emission.map_or(DVec3::ZERO, Into::into),
            normal_scale: or_one(self.normal_scale),
            occlusion_strength: or_one(self.occlusion_strength),
            alpha_mode: match self.alpha_mode {
                AlphaRecord::Opaque => AlphaMode::Opaque,
                AlphaRecord::Mask(Number(cutoff)) => AlphaMode::Mask { cutoff },
                AlphaRecord::Blend => AlphaMode::Blend,
            },
            unlit: self.unlit,
            double_sided: self.double_sided,
        };
        material.check_numbers()?;
        Ok(material)
    }
}
