//! Lights, shaders and material models: what has settings.

use serde::{Deserialize, Serialize};

use super::super::number::{Number, Triple};
use crate::error::Result;
use crate::geometry::Value;
use crate::scene::{Light, Model};
use crate::shade::Shader;

/// A light, a shader, or a material's model: what it is, and its settings by their names.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::fhs) struct KindRecord {
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

impl KindRecord {
    pub(in crate::fhs) fn of_light(light: &Light) -> Self {
        Self::new(light.name(), light.settings())
    }

    pub(super) fn new(kind: &str, settings: Vec<(&'static str, Value)>) -> Self {
        let settings = settings.into_iter();
        let settings = settings.map(|(name, value)| (name.to_owned(), ValueRecord::new(value)));
        Self { kind: kind.to_owned(), settings: settings.collect() }
    }

    /// The light, whose numbers make sense.
    pub(in crate::fhs) fn light(&self) -> Result<Light> {
        Light::from_settings(&self.kind, self.settings())
    }

    /// The material model, whose numbers make sense.
    pub(super) fn model(&self) -> Result<Model> {
        Model::from_settings(&self.kind, self.settings())
    }

    /// The shader, whose numbers make sense.
    pub(super) fn shader(&self) -> Result<Shader> {
        Shader::from_settings(&self.kind, self.settings())
    }

    fn settings(&self) -> impl Iterator<Item = (&str, Value)> {
        let settings = self.settings.iter();
        settings.map(|(name, value)| (&**name, value.value()))
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
