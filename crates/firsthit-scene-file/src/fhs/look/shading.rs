//! The record of shading in a file.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::super::colors::ColoringRecord;
use super::super::number::Number;
use super::super::record::Section;
use super::background::BackgroundRecord;
use super::edges::EdgesRecord;
use super::environment::EnvironmentRecord;
use super::kind::KindRecord;
use crate::edge::Edges;
use crate::error::Result;
use crate::geometry::{DisplayTransform, ToneMap, require};
use crate::io::fault::Checked;
use crate::memory::Storage;
use crate::scene::Environment;
use crate::shade::Appearance;
use crate::world::World;

/// The record of shading in a file, if there is any.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::fhs) struct ShadingRecord {
    shader: Option<KindRecord>,
    samples: Option<u32>,
    /// The name of the lights that go with the camera.
    light: Option<String>,
    ground: Option<bool>,
    background: Option<BackgroundRecord>,
    environment: Option<EnvironmentRecord>,
    /// The exposure of PNGs in stops, unless unchanged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    exposure: Option<Number>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tone_map: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    colors: Option<ColoringRecord>,
    /// The edges; not in the files of worlds without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    edges: Option<EdgesRecord>,
}

/// The most samples of a picture.
const MOST_SAMPLES: u32 = 1 << 16;

impl ShadingRecord {
    /// `add` makes a section of the texels of the environment's map, if it has one.
    pub(in crate::fhs) fn new<'a>(
        world: &'a World,
        add: impl FnOnce(&'a [[f32; 3]]) -> Section,
    ) -> Self {
        let environment = world.environment.as_deref();
        let Appearance { shader, rig, background, ground, coloring, samples } = &world.appearance;
        let DisplayTransform { exposure, tone_map } = world.display;
        let is_mapped = tone_map != ToneMap::default();
        Self {
            shader: shader.as_ref().map(|shader| KindRecord::new(shader.name(), shader.settings())),
            samples: *samples,
            light: rig.map(|rig| rig.name().to_owned()),
            ground: *ground,
            colors: coloring.as_ref().map(ColoringRecord::new),
            background: background.map(BackgroundRecord::new),
            environment: environment.map(|environment| EnvironmentRecord::new(environment, add)),
            exposure: (exposure != 0.0).then_some(Number(exposure)),
            tone_map: is_mapped.then(|| tone_map.name().to_owned()),
            edges: world.edges.as_ref().map(EdgesRecord::new),
        }
    }

    pub(in crate::fhs) fn edges(&self) -> Result<Option<Edges>> {
        self.edges.as_ref().map(EdgesRecord::edges).transpose()
    }

    /// The appearance, with a number of samples that pictures can have.
    pub(in crate::fhs) fn appearance(&self) -> Result<Appearance> {
        if let Some(samples) = self.samples {
            let is_possible = (1..=MOST_SAMPLES).contains(&samples);
            require("samples", "from 1 to 65536 in a file", is_possible, samples)?;
        }
        Ok(Appearance {
            shader: self.shader.as_ref().map(KindRecord::shader).transpose()?,
            rig: self.light.as_deref().map(str::parse).transpose()?,
            background: self.background.as_ref().map(BackgroundRecord::background).transpose()?,
            ground: self.ground,
            coloring: self.colors.as_ref().map(ColoringRecord::coloring).transpose()?,
            samples: self.samples,
        })
    }

    /// `take` gets the texels of a section.
    pub(in crate::fhs) fn environment(
        &self,
        take: impl FnOnce(Section) -> Checked<Storage<[f32; 3]>>,
    ) -> Checked<Option<Arc<Environment>>> {
        let record = self.environment.as_ref();
        let made = record.map(|record| record.environment(take));
        Ok(made.transpose()?.map(Arc::new))
    }

    /// The display of colours in PNGs.
    pub(in crate::fhs) fn display(&self) -> Result<DisplayTransform> {
        let tone_map = self.tone_map.as_deref().map(str::parse).transpose()?;
        let display = DisplayTransform {
            exposure: self.exposure.map_or(0.0, |stops| stops.0),
            tone_map: tone_map.unwrap_or_default(),
        };
        display.check().map(|()| display)
    }
}
