//! Materials, textures on surfaces, lights, backgrounds and shaders, to the record and back.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::colors::ColoringRecord;
use super::number::{Number, Triple};
use super::read::of_record;
use super::record::Section;
use crate::edge::{Dash, EdgeKinds, Edges};
use crate::error::{Error, Result, escape_controls};
use crate::geometry::{DMat3, DVec3, DisplayTransform, ToneMap, Value};
use crate::io::fault::Checked;
use crate::memory::Storage;
use crate::scene::{
    AlphaMode, Background, Coloring, Daylight, Environment, EnvironmentMap, Filter, Light, MapRole,
    Maps, Material, Model, Surroundings, Texture, TextureMap, UvSet, Wrap,
};
use crate::shade::{LightRig, Shader};
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

/// A texture on a surface. Its texture is named by its place in the record.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MapRecord {
    texture: usize,
    wrap: [String; 2],
    filter: String,
    /// Whether it takes a mesh's second texture coordinates.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    second_uvs: bool,
    picture_from_uv: [[Number; 3]; 2],
}

/// A light, a shader, or a material's model: what it is, and its settings by their names.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KindRecord {
    kind: String,
    settings: Vec<(String, ValueRecord)>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum ValueRecord {
    Flag(bool),
    Number(Number),
    Vector(Triple),
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
    shader: Option<KindRecord>,
    samples: Option<u32>,
    /// The name of the lights that go with the camera.
    light: Option<String>,
    ground: Option<bool>,
    background: Option<BackgroundRecord>,
    environment: Option<EnvironmentRecord>,
    /// How PNGs show colours, unless unchanged: the exposure in stops, and the tone map.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    exposure: Option<Number>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tone_map: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    colors: Option<ColoringRecord>,
    /// Not in the files of worlds without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    edges: Option<EdgesRecord>,
}

/// Lines along edges.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EdgesRecord {
    width: Number,
    angle: Number,
    kinds: Vec<String>,
    /// The lengths of dashes and gaps.
    hidden: Option<[Number; 2]>,
    color: Triple,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EnvironmentRecord {
    surroundings: SurroundingsRecord,
    strength: Number,
    is_seen: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum SurroundingsRecord {
    Uniform(Triple),
    Hemispheres {
        above: Triple,
        below: Triple,
        up: Triple,
    },
    Gradient {
        horizon: Triple,
        zenith: Triple,
        up: Triple,
    },
    Map {
        columns: usize,
        rows: usize,
        texels: Section,
        /// The columns of a rotation.
        world_from_map: [Triple; 3],
    },
    Daylight {
        up: Triple,
        elevation_degrees: Number,
        azimuth_degrees: Number,
        turbidity: Number,
        ground: Triple,
    },
}

impl MaterialRecord {
    /// `number` gives a map its place.
    pub(super) fn new<'a>(
        material: &'a Material,
        mut number: impl FnMut(&'a TextureMap) -> usize,
    ) -> Self {
        let is_own = |role| matches!(role, MapRole::Color | MapRole::Alpha);
        let mut map = |role| material.maps.get(role).map(&mut number);
        let [color_map, alpha_map] = [map(MapRole::Color), map(MapRole::Alpha)];
        let others = material.maps.roles().filter(|&(role, _)| !is_own(role));
        let maps = others.map(|(role, map)| (role.name().to_owned(), number(map)));
        let unusual = |value: f64| (value != 1.0).then_some(Number(value));
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
            normal_scale: unusual(material.normal_scale),
            occlusion_strength: unusual(material.occlusion_strength),
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
        let mut all = Maps::default()
            .with(MapRole::Color, map(self.color_map)?)
            .with(MapRole::Alpha, map(self.alpha_map)?);
        for (name, number) in &self.maps {
            let role = MapRole::named(name);
            let role = role.ok_or_else(|| Error::argument("map", "a role that is known", name))?;
            all = all.with(role, map(Some(*number))?);
        }
        let usual = |value: Option<Number>| value.map_or(1.0, |Number(value)| value);
        let material = Material {
            name: escape_controls(&self.name).into(),
            color: self.color.into(),
            alpha: self.alpha.0,
            maps: all,
            model: self
                .model
                .as_ref()
                .map_or(Ok(Model::default()), KindRecord::model)?,
            emission: self.emission.map_or(DVec3::ZERO, Into::into),
            normal_scale: usual(self.normal_scale),
            occlusion_strength: usual(self.occlusion_strength),
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

impl MapRecord {
    /// Of a map whose texture has this place.
    pub(super) fn new(map: &TextureMap, texture: usize) -> Self {
        Self {
            texture,
            wrap: map.wrap.map(|wrap| name_of(wrap, &Wrap::NAMES)),
            filter: name_of(map.filter, &Filter::NAMES),
            second_uvs: map.uv_set == UvSet::Second,
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
            uv_set: if self.second_uvs {
                UvSet::Second
            } else {
                UvSet::First
            },
            picture_from_uv: self
                .picture_from_uv
                .map(|row| row.map(|Number(number)| number)),
        })
    }
}

impl KindRecord {
    pub(super) fn of_light(light: &Light) -> Self {
        Self::new(light.name(), light.settings())
    }

    fn new(kind: &str, settings: Vec<(&'static str, Value)>) -> Self {
        let settings = settings.into_iter();
        let settings = settings.map(|(name, value)| (name.to_owned(), ValueRecord::new(value)));
        Self {
            kind: kind.to_owned(),
            settings: settings.collect(),
        }
    }

    /// The light, whose numbers make sense.
    pub(super) fn light(&self) -> Result<Light> {
        let mut light = Light::named(&self.kind)?;
        for (name, value) in &self.settings {
            light.set(name, value.value())?;
        }
        Ok(light)
    }

    /// The material model, whose numbers make sense.
    fn model(&self) -> Result<Model> {
        let mut model = Model::named(&self.kind)?;
        for (name, value) in &self.settings {
            model.set(name, value.value())?;
        }
        Ok(model)
    }

    fn shader(&self) -> Result<Shader> {
        let mut shader = Shader::named(&self.kind)?;
        for (name, value) in &self.settings {
            shader.set(name, value.value())?;
        }
        Ok(shader)
    }
}

impl ValueRecord {
    fn new(value: Value) -> Self {
        match value {
            Value::Flag(flag) => Self::Flag(flag),
            Value::Number(number) => Self::Number(Number(number)),
            Value::Vector(vector) => Self::Vector(vector.into()),
        }
    }

    fn value(&self) -> Value {
        match *self {
            Self::Flag(flag) => Value::Flag(flag),
            Self::Number(Number(number)) => Value::Number(number),
            Self::Vector(vector) => Value::Vector(vector.into()),
        }
    }
}

impl EnvironmentRecord {
    /// `add` makes a section of a map's texels.
    fn new<'a>(environment: &'a Environment, add: impl FnOnce(&'a [[f32; 3]]) -> Section) -> Self {
        Self {
            surroundings: SurroundingsRecord::new(&environment.surroundings, add),
            strength: Number(environment.strength),
            is_seen: environment.is_seen,
        }
    }

    /// `take` gets a section's texels.
    fn environment(
        &self,
        take: impl FnOnce(Section) -> Checked<Storage<[f32; 3]>>,
    ) -> Checked<Environment> {
        let environment = Environment {
            surroundings: self.surroundings.surroundings(take)?,
            strength: self.strength.0,
            is_seen: self.is_seen,
        };
        of_record(environment.check())?;
        Ok(environment)
    }
}

impl SurroundingsRecord {
    fn new<'a>(
        surroundings: &'a Surroundings,
        add: impl FnOnce(&'a [[f32; 3]]) -> Section,
    ) -> Self {
        match surroundings {
            Surroundings::Uniform(color) => Self::Uniform((*color).into()),
            Surroundings::Hemispheres { above, below, up } => Self::Hemispheres {
                above: (*above).into(),
                below: (*below).into(),
                up: (*up).into(),
            },
            Surroundings::Gradient {
                horizon,
                zenith,
                up,
            } => Self::Gradient {
                horizon: (*horizon).into(),
                zenith: (*zenith).into(),
                up: (*up).into(),
            },
            Surroundings::Map {
                map,
                world_from_map,
            } => Self::Map {
                columns: map.columns(),
                rows: map.rows(),
                texels: add(map.texels()),
                world_from_map: [0, 1, 2].map(|axis| world_from_map.col(axis).into()),
            },
            Surroundings::Daylight(daylight) => Self::Daylight {
                up: daylight.up().into(),
                elevation_degrees: Number(daylight.elevation_degrees()),
                azimuth_degrees: Number(daylight.azimuth_degrees()),
                turbidity: Number(daylight.turbidity()),
                ground: daylight.ground().into(),
            },
        }
    }

    fn surroundings(
        &self,
        take: impl FnOnce(Section) -> Checked<Storage<[f32; 3]>>,
    ) -> Checked<Surroundings> {
        Ok(match *self {
            Self::Uniform(color) => Surroundings::Uniform(color.into()),
            Self::Hemispheres { above, below, up } => Surroundings::Hemispheres {
                above: above.into(),
                below: below.into(),
                up: up.into(),
            },
            Self::Gradient {
                horizon,
                zenith,
                up,
            } => Surroundings::Gradient {
                horizon: horizon.into(),
                zenith: zenith.into(),
                up: up.into(),
            },
            Self::Map {
                columns,
                rows,
                texels,
                world_from_map,
            } => {
                let map = of_record(EnvironmentMap::new(columns, rows, take(texels)?))?;
                let [x, y, z] = world_from_map.map(DVec3::from);
                Surroundings::Map {
                    map: Arc::new(map),
                    world_from_map: DMat3::from_cols(x, y, z),
                }
            }
            Self::Daylight {
                up,
                elevation_degrees: Number(elevation),
                azimuth_degrees: Number(azimuth),
                turbidity: Number(turbidity),
                ground,
            } => {
                let day = Daylight::new(up.into(), elevation, azimuth, turbidity, ground.into());
                Surroundings::Daylight(of_record(day)?)
            }
        })
    }
}

impl ShadingRecord {
    /// `add` makes a section of the texels of the environment's map, if it has one.
    pub(super) fn new<'a>(world: &'a World, add: impl FnOnce(&'a [[f32; 3]]) -> Section) -> Self {
        let environment = world.environment.as_deref();
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
        let shader = world.shader.as_ref();
        let DisplayTransform { exposure, tone_map } = world.display;
        let is_mapped = tone_map != ToneMap::default();
        Self {
            shader: shader.map(|shader| KindRecord::new(shader.name(), shader.settings())),
            samples: world.samples,
            light: world.rig.map(|rig| rig.name().to_owned()),
            ground: world.ground,
            colors: world.coloring.as_ref().map(ColoringRecord::new),
            background,
            environment: environment.map(|environment| EnvironmentRecord::new(environment, add)),
            exposure: (exposure != 0.0).then_some(Number(exposure)),
            tone_map: is_mapped.then(|| tone_map.name().to_owned()),
            edges: world.edges.as_ref().map(EdgesRecord::new),
        }
    }

    pub(super) fn edges(&self) -> Result<Option<Edges>> {
        self.edges.as_ref().map(EdgesRecord::edges).transpose()
    }

    pub(super) fn shader(&self) -> Result<Option<Shader>> {
        self.shader.as_ref().map(KindRecord::shader).transpose()
    }

    pub(super) fn rig(&self) -> Result<Option<LightRig>> {
        self.light.as_deref().map(str::parse).transpose()
    }

    pub(super) fn coloring(&self) -> Result<Option<Coloring>> {
        self.colors
            .as_ref()
            .map(ColoringRecord::coloring)
            .transpose()
    }

    pub(super) fn ground(&self) -> Option<bool> {
        self.ground
    }

    /// `take` gets the texels of a section.
    pub(super) fn environment(
        &self,
        take: impl FnOnce(Section) -> Checked<Storage<[f32; 3]>>,
    ) -> Checked<Option<Arc<Environment>>> {
        let record = self.environment.as_ref();
        let made = record.map(|record| record.environment(take));
        Ok(made.transpose()?.map(Arc::new))
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

    /// How PNGs show colours.
    pub(super) fn display(&self) -> Result<DisplayTransform> {
        let tone_map = self.tone_map.as_deref().map(str::parse).transpose()?;
        let display = DisplayTransform {
            exposure: self.exposure.map_or(0.0, |stops| stops.0),
            tone_map: tone_map.unwrap_or_default(),
        };
        display.check().map(|()| display)
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

impl EdgesRecord {
    fn new(edges: &Edges) -> Self {
        let names = edges.kinds.names().into_iter();
        Self {
            width: Number(edges.width),
            angle: Number(edges.angle),
            kinds: names.map(str::to_owned).collect(),
            hidden: edges.hidden.map(|dash| [Number(dash.on), Number(dash.off)]),
            color: edges.color.into(),
        }
    }

    fn edges(&self) -> Result<Edges> {
        let dash = |[Number(on), Number(off)]: [Number; 2]| Dash { on, off };
        let edges = Edges {
            width: self.width.0,
            angle: self.angle.0,
            kinds: EdgeKinds::named(self.kinds.iter().map(|name| &**name))?,
            hidden: self.hidden.map(dash),
            color: self.color.into(),
        };
        edges.check().map(|()| edges)
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
