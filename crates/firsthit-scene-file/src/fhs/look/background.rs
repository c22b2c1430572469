//! Backgrounds.

use serde::{Deserialize, Serialize};

use super::super::number::Triple;
use super::direction_of;
use crate::error::Result;
use crate::scene::Background;

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum BackgroundRecord {
    Uniform(Triple),
    Gradient { horizon: Triple, zenith: Triple, up: Triple },
    Transparent,
}

impl BackgroundRecord {
    pub(super) fn new(background: Background) -> Self {
        match background {
            Background::Uniform(color) => Self::Uniform(color.into()),
            Background::Gradient { horizon, zenith, up } => {
                Self::Gradient { horizon: horizon.into(), zenith: zenith.into(), up: up.into() }
            }
            Background::Transparent => Self::Transparent,
        }
    }

    pub(super) fn background(&self) -> Result<Background> {
        Ok(match *self {
            Self::Uniform(color) => Background::Uniform(color.into()),
            Self::Gradient { horizon, zenith, up } => Background::Gradient {
                horizon: horizon.into(),
                zenith: zenith.into(),
                up: direction_of(up)?,
            },
            Self::Transparent => Background::Transparent,
        })
    }
}
