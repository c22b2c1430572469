//! Environments.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::super::number::{Number, Triple};
use super::super::read::of_record;
use super::super::record::Section;
use crate::geometry::{DMat3, DVec3};
use crate::io::fault::Checked;
use crate::memory::Storage;
use crate::scene::{Daylight, Environment, EnvironmentKind, EnvironmentMap};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EnvironmentRecord {
    surroundings: EnvironmentKindRecord,
    strength: Number,
    is_seen: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum EnvironmentKindRecord {
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

impl EnvironmentRecord {
    /// `add` makes a section of a map's texels.
    pub(super) fn new<'a>(
        environment: &'a Environment,
        add: impl FnOnce(&'a [[f32; 3]]) -> Section,
    ) -> Self {
        Self {
            surroundings: EnvironmentKindRecord::new(&environment.kind, add),
            strength: Number(environment.strength),
            is_seen: environment.is_seen,
        }
    }

    /// `take` gets a section's texels.
    pub(super) fn environment(
        &self,
        take: impl FnOnce(Section) -> Checked<Storage<[f32; 3]>>,
    ) -> Checked<Environment> {
        let environment = Environment {
            kind: self.surroundings.kind(take)?,
            strength: self.strength.0,
            is_seen: self.is_seen,
        };
        of_record(environment.check())?;
        Ok(environment)
    }
}

impl EnvironmentKindRecord {
    fn new<'a>(kind: &'a EnvironmentKind, add: impl FnOnce(&'a [[f32; 3]]) -> Section) -> Self {
        match kind {
            EnvironmentKind::Uniform(color) => Self::Uniform((*color).into()),
            EnvironmentKind::Hemispheres { above, below, up } => Self::Hemispheres {
                above: (*above).into(),
                below: (*below).into(),
                up: (*up).into(),
            },
            EnvironmentKind::Gradient { horizon, zenith, up } => Self::Gradient {
                horizon: (*horizon).into(),
                zenith: (*zenith).into(),
                up: (*up).into(),
            },
            EnvironmentKind::Map { map, world_from_map } => Self::Map {
                columns: map.columns(),
                rows: map.rows(),
                texels: add(map.texels()),
                world_from_map: [0, 1, 2].map(|axis| world_from_map.col(axis).into()),
            },
            EnvironmentKind::Daylight(daylight) => Self::Daylight {
                up: daylight.up().into(),
                elevation_degrees: Number(daylight.elevation_degrees()),
                azimuth_degrees: Number(daylight.azimuth_degrees()),
                turbidity: Number(daylight.turbidity()),
                ground: daylight.ground().into(),
            },
        }
    }

    fn kind(
        &self,
        take: impl FnOnce(Section) -> Checked<Storage<[f32; 3]>>,
    ) -> Checked<EnvironmentKind> {
        Ok(match *self {
            Self::Uniform(color) => EnvironmentKind::Uniform(color.into()),
            Self::Hemispheres { above, below, up } => EnvironmentKind::Hemispheres {
                above: above.into(),
                below: below.into(),
                up: up.into(),
            },
            Self::Gradient { horizon, zenith, up } => EnvironmentKind::Gradient {
                horizon: horizon.into(),
                zenith: zenith.into(),
                up: up.into(),
            },
            Self::Map { columns, rows, texels, world_from_map } => {
                let map = of_record(EnvironmentMap::new(columns, rows, take(texels)?))?;
                let [x, y, z] = world_from_map.map(DVec3::from);
                EnvironmentKind::Map {
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
                EnvironmentKind::Daylight(of_record(day)?)
            }
        })
    }
}
