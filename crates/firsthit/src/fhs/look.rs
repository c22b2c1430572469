//! Materials, textures on surfaces, lights, backgrounds and shaders, to the record and back.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::number::{Number, Triple};
use crate::error::{Error, Result, escape_controls};
use crate::geometry::DVec3;
use crate::scene::{
    AlphaMode, Background, Filter, Light, MapRole, Maps, Material, Texture, TextureMap, Wrap,
};
use crate::shade::{Lambert, Shader};
use crate::world::World;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialRecord {
    #[serde(default, skip_serializing_if = "String::is_empty")]
    name: String,
    color: Triple,
    alpha: Number,
    /// The map of each role, by its place in the record.
    color_map: Option<usize>,
    alpha_map: Option<usize>,
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

/// A texture on a surface. Its texture is named by its place in the record.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MapRecord {
    texture: usize,
    wrap: [String; 2],
    filter: String,
    picture_from_uv: [[Number; 3]; 2],
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum LightRecord {
    Directional {
        direction: Triple,
        color: Triple,
    },
    Point {
        position: Triple,
        intensity: Triple,
    },
    Spot {
        position: Triple,
        direction: Triple,
        intensity: Triple,
        inner_angle: Number,
        outer_angle: Number,
    },
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum BackgroundRecord {
    Uniform(Triple),
    Gradient {
        horizon: Triple,
        zenith: Triple,
        up: Triple,
    },
    Transparent,
}

/// What a file says of shading, if anything.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShadingRecord {
    shader: Option<String>,
    /// Of the Lambert shader.
    ambient: Option<Triple>,
    shadows: Option<bool>,
    samples: Option<u32>,
    background: Option<BackgroundRecord>,
}

impl MaterialRecord {
    /// `number` gives a map its place.
    pub(super) fn new<'a>(
        material: &'a Material,
        mut number: impl FnMut(&'a TextureMap) -> usize,
    ) -> Self {
        let mut map = |role| material.maps.get(role).map(&mut number);
        Self {
            name: material.name.to_string(),
            color: material.color.into(),
            alpha: Number(material.alpha),
            color_map: map(MapRole::Color),
            alpha_map: map(MapRole::Alpha),
            alpha_mode: match material.alpha_mode {
                AlphaMode::Opaque => AlphaRecord::Opaque,
                AlphaMode::Mask { cutoff } => AlphaRecord::Mask(Number(cutoff)),
                AlphaMode::Blend => AlphaRecord::Blend,
            },
            unlit: material.unlit,
            double_sided: material.double_sided,
        }
    }

    pub(super) fn material(&self, maps: &[TextureMap]) -> Result<Material> {
        let map = |number: Option<usize>| {
            let found = number.map(|number| maps.get(number).cloned().ok_or(number));
            found.transpose().map_err(|number| missing("a map", number))
        };
        Ok(Material {
            name: escape_controls(&self.name).into(),
            color: self.color.into(),
            alpha: self.alpha.0,
            maps: Maps::default()
                .with(MapRole::Color, map(self.color_map)?)
                .with(MapRole::Alpha, map(self.alpha_map)?),
            alpha_mode: match self.alpha_mode {
                AlphaRecord::Opaque => AlphaMode::Opaque,
                AlphaRecord::Mask(Number(cutoff)) => AlphaMode::Mask { cutoff },
                AlphaRecord::Blend => AlphaMode::Blend,
            },
            unlit: self.unlit,
            double_sided: self.double_sided,
        })
    }
}

impl MapRecord {
    /// Of a map whose texture has this place.
    pub(super) fn new(map: &TextureMap, texture: usize) -> Self {
        Self {
            texture,
            wrap: map.wrap.map(|wrap| name_of(wrap, &Wrap::NAMES)),
            filter: name_of(map.filter, &Filter::NAMES),
            picture_from_uv: map.picture_from_uv.map(|row| row.map(Number)),
        }
    }

    pub(super) fn map(&self, textures: &[Arc<Texture>]) -> Result<TextureMap> {
        let texture = textures.get(self.texture);
        let texture = texture.ok_or_else(|| missing("a texture", self.texture))?;
        let [across, down] = &self.wrap;
        Ok(TextureMap {
            texture: Arc::clone(texture),
            wrap: [named(across, &Wrap::NAMES)?, named(down, &Wrap::NAMES)?],
            filter: named(&self.filter, &Filter::NAMES)?,
            picture_from_uv: self
                .picture_from_uv
                .map(|row| row.map(|Number(number)| number)),
        })
    }
}

impl LightRecord {
    pub(super) fn new(light: &Light) -> Self {
        match *light {
            Light::Directional { direction, color } => Self::Directional {
                direction: direction.into(),
                color: color.into(),
            },
            Light::Point {
                position,
                intensity,
            } => Self::Point {
                position: position.into(),
                intensity: intensity.into(),
            },
            Light::Spot {
                position,
                direction,
                intensity,
                inner_angle,
                outer_angle,
            } => Self::Spot {
                position: position.into(),
                direction: direction.into(),
                intensity: intensity.into(),
                inner_angle: Number(inner_angle),
                outer_angle: Number(outer_angle),
            },
        }
    }

    /// The light, whose direction is one.
    pub(super) fn light(&self) -> Result<Light> {
        Ok(match *self {
            Self::Directional { direction, color } => Light::Directional {
                direction: direction_of(direction)?,
                color: color.into(),
            },
            Self::Point {
                position,
                intensity,
            } => Light::Point {
                position: position.into(),
                intensity: intensity.into(),
            },
            Self::Spot {
                position,
                direction,
                intensity,
                inner_angle,
                outer_angle,
            } => Light::Spot {
                position: position.into(),
                direction: direction_of(direction)?,
                intensity: intensity.into(),
                inner_angle: inner_angle.0,
                outer_angle: outer_angle.0,
            },
        })
    }
}

impl ShadingRecord {
    pub(super) fn new(world: &World) -> Self {
        let lambert = match &world.shader {
            Some(Shader::Lambert(lambert)) => Some(lambert),
            _ => None,
        };
        let background = world.background.map(|background| match background {
            Background::Uniform(color) => BackgroundRecord::Uniform(color.into()),
            Background::Gradient {
                horizon,
                zenith,
                up,
            } => BackgroundRecord::Gradient {
                horizon: horizon.into(),
                zenith: zenith.into(),
                up: up.into(),
            },
            Background::Transparent => BackgroundRecord::Transparent,
        });
        Self {
            shader: world.shader.as_ref().map(|shader| shader.name().to_owned()),
            ambient: lambert.map(|lambert| lambert.ambient.into()),
            shadows: lambert.map(|lambert| lambert.shadows),
            samples: world.samples,
            background,
        }
    }

    pub(super) fn shader(&self) -> Result<Option<Shader>> {
        let shader = self.shader.as_deref().map(Shader::named).transpose()?;
        let usual = Lambert::default();
        Ok(shader.map(|shader| match shader {
            Shader::Lambert(_) => Shader::Lambert(Lambert {
                ambient: self.ambient.map_or(usual.ambient, DVec3::from),
                shadows: self.shadows.unwrap_or(usual.shadows),
            }),
            other => other,
        }))
    }

    /// The number of samples, which is one that pictures can have.
    pub(super) fn samples(&self) -> Result<Option<u32>> {
        match self.samples {
            Some(samples) if !(1..=MOST_SAMPLES).contains(&samples) => Err(Error::argument(
                "samples",
                "from 1 to 65536 in a file",
                samples,
            )),
            samples => Ok(samples),
        }
    }

    pub(super) fn background(&self) -> Result<Option<Background>> {
        let background = self.background.as_ref().map(|background| {
            Ok(match *background {
                BackgroundRecord::Uniform(color) => Background::Uniform(color.into()),
                BackgroundRecord::Gradient {
                    horizon,
                    zenith,
                    up,
                } => Background::Gradient {
                    horizon: horizon.into(),
                    zenith: zenith.into(),
                    up: direction_of(up)?,
                },
                BackgroundRecord::Transparent => Background::Transparent,
            })
        });
        background.transpose()
    }
}

/// As many as a picture has at most.
const MOST_SAMPLES: u32 = 1 << 16;

/// A direction: finite and not zero.
pub(super) fn direction_of(direction: Triple) -> Result<DVec3> {
    let direction = DVec3::from(direction);
    if direction.is_finite() && direction != DVec3::ZERO {
        Ok(direction)
    } else {
        Err(Error::argument(
            "direction",
            "finite and not zero",
            direction,
        ))
    }
}

/// That the record names something by a place that it has not.
pub(super) fn missing(what: &'static str, number: usize) -> Error {
    Error::argument(what, "one of the record's", number)
}

fn named<T: Copy>(name: &str, known: &[(&'static str, T)]) -> Result<T> {
    let found = known.iter().find(|&&(known, _)| known == name);
    found
        .map(|&(_, value)| value)
        .ok_or_else(|| Error::argument("wrap or filter", "a name that textures know", name))
}

fn name_of<T: Copy + PartialEq>(value: T, known: &[(&'static str, T)]) -> String {
    let found = known.iter().find(|&&(_, known)| known == value);
    found.map_or("", |&(name, _)| name).to_owned()
}
