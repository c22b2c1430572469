//! The metadata of an output: one structure, kept as JSON in every file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::cryptomatte::{Cryptomatte, ascii};
use super::frame::{Channel, Data, Display, Frame};
use super::names::Names;
use super::origin::{CameraRecord, ColorsRecord, Origin, SensorRecord, ShadingRecord};
use crate::geometry::Digest;

/// The name that a file keeps the metadata under: an attribute of an EXR, a text of a PNG.
pub(super) const KEY: &str = "firsthit";

/// The version of this structure. It grows when a reader of the old version would misread the new
/// one.
pub const METADATA_VERSION: u32 = 1;

/// Describes an output to people and programs that have only the file.
///
/// `docs/output-metadata.schema.json` is its JSON Schema, `docs/outputs.md` shows it. It has no
/// date and no path: the same picture has the same metadata.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// [`METADATA_VERSION`].
    pub metadata_version: u32,
    /// The version of firsthit that made the output.
    pub firsthit: String,
    /// The fingerprint of the scene, see [`Origin::scene`].
    pub scene: Option<String>,
    /// `[rows, columns]` of a picture, `[n]` of a batch of rays.
    pub shape: Vec<u64>,
    /// The layout of pixels; `None` for a batch of rays.
    pub pixels: Option<Pixels>,
    /// The camera that made the rays, if one did.
    pub camera: Option<CameraRecord>,
    /// The sensor that made the rays, if it is no camera.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<SensorRecord>,
    /// The number of samples whose mean is a pixel's colour, and whose shares are those of its
    /// mattes: where a noise ends them earlier, the most that a pixel has. Other channels are
    /// sampled at the pixel's centre.
    pub samples: Option<u32>,
    /// The shading that made the colours, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shading: Option<ShadingRecord>,
    /// The colouring of surfaces by numbers: the legend of the colours, if they are in this file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colors: Option<ColorsRecord>,
    /// A digest of the numbers, where they are the state of a picture to be continued.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<String>,
    /// The channels in this file.
    pub channels: Vec<ChannelRecord>,
    /// The names behind the identifiers of the channels `object`, `node`, `mesh` and `material`, if
    /// one of them is in this file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub names: Option<Names>,
    /// The names behind the identifiers of mattes, by the channel.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cryptomatte: BTreeMap<String, Cryptomatte>,
    /// The laser scanner that made the points, where a scan is what is in this file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scan: Option<serde_json::Value>,
    /// The scans that were put together, where there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scans: Option<serde_json::Value>,
}

/// The layout of pixels, equal in all outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pixels {
    /// The centre of the first pixel (row 0, column 0): across and down, in pixels from the corner
    /// of the camera's whole picture.
    pub first_center: [f64; 2],
    /// The place of row 0.
    pub row_0: String,
    /// The place of column 0.
    pub column_0: String,
}

/// A channel, as it was computed and as this file stores it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelRecord {
    /// The channel's name.
    pub name: String,
    /// The description, in a sentence.
    pub about: String,
    /// The NumPy name of the type in which it was computed.
    pub dtype: String,
    /// The number of components of each element.
    pub components: u64,
    /// The unit; `None` for numbers without one.
    pub unit: Option<String>,
    /// The frame that the numbers are in: `world`, `camera`, `ray`, `triangle` or `texture`.
    pub frame: Option<String>,
    /// The value for a ray that met nothing: `inf`, `-1`, `nan`, `false`, `background` or
    /// `transparent`.
    pub miss: String,
    /// The encoding in this file; `None` where the numbers are in memory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stored: Option<Stored>,
}

/// The encoding of a channel in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    /// The names of the components in the file.
    pub names: Vec<String>,
    /// The type of the numbers in the file.
    pub dtype: String,
    /// The conversion of the channel's numbers to the file's.
    pub encoding: Encoding,
    /// The value of a miss in the file.
    pub miss: String,
    /// The size of one step, in the channel's unit, with [`Encoding::Steps`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// The number that stands for distances beyond the last step, with [`Encoding::Steps`], where
    /// that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub far: Option<String>,
    /// The text that explains the picture, with [`Encoding::Picture`], where it needs words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub legend: Option<String>,
    /// The exposure in stops that was applied to colours, with [`Encoding::Picture`], unless it is
    /// 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f64>,
    /// The name of the tone map that was applied to colours, with [`Encoding::Picture`], unless it
    /// is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tone_map: Option<String>,
}

/// The conversion of a channel's numbers to stored ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// Stored as they are.
    Exact,
    /// Rounded to the nearest float32.
    Rounded,
    /// The 32 bits of a signed number, in an unsigned one: -1 is 4294967295.
    TwosComplement,
    /// Rounded to the nearest whole number of steps of `scale`.
    Steps,
    /// A whole number, plus one.
    Labels,
    /// Bytes to look at, by the formula of `docs/outputs.md`.
    Picture,
}

impl Encoding {
    /// The name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Rounded => "rounded",
            Self::TwosComplement => "two's complement",
            Self::Steps => "steps",
            Self::Labels => "plus one",
            Self::Picture => "to look at",
        }
    }
}

/// The channels that say how they were shaded.
const COLOR: &str = "color";
const STATE: &str = "sums";

impl Frame {
    /// The metadata of the frame and all its channels.
    pub fn metadata(&self) -> Metadata {
        let all: Vec<&Channel> = self.channels.iter().collect();
        Metadata::of(self, &all, |_| None)
    }
}

impl Metadata {
    /// The metadata of `channels` of `frame`; `stored` tells how a file stores each.
    pub(super) fn of(
        frame: &Frame,
        channels: &[&Channel],
        stored: impl Fn(&Channel) -> Option<Stored>,
    ) -> Self {
        let Origin {
            scene,
            camera,
            sensor,
            samples,
            shading,
            colors,
            first_pixel,
            names,
            mut cryptomatte,
            scan,
            scans,
        } = frame.origin.clone();
        // The channels that are made from all samples of a pixel.
        let of_samples =
            |channel: &&Channel| matches!(channel.display, Display::Color | Display::Matte);
        let has_samples = channels.iter().any(of_samples);
        let is_color = |channel: &&Channel| channel.display == Display::Color;
        let has_colors = channels.iter().any(is_color);
        // A table of rays has directions of any length, all other sensors have those of length one.
        let has_units =
            camera.is_some() || sensor.as_ref().is_some_and(|sensor| sensor.kind != "rays");
        let has = |name: &str| channels.iter().any(|channel| channel.name == name);
        cryptomatte.retain(|name, _| has(name));
        Self {
            metadata_version: METADATA_VERSION,
            firsthit: env!("CARGO_PKG_VERSION").to_owned(),
            scene,
            shape: frame.shape.iter().map(|&side| side as u64).collect(),
            pixels: (frame.shape.len() == 2).then(|| Pixels::from(first_pixel)),
            samples: samples.filter(|_| has_samples),
            shading: shading.filter(|_| has(COLOR) || has(STATE)),
            colors: colors.filter(|_| has_colors || has(STATE)),
            state: has(STATE).then(|| digest(channels)),
            channels: (channels.iter())
                .map(|channel| ChannelRecord::of(channel, has_units, stored(channel)))
                .map(|record| if scan.is_some() { record.of_returns() } else { record })
                .collect(),
            camera,
            sensor,
            names: names.and_then(|names| names.of_channels(has)),
            cryptomatte,
            scan,
            scans,
        }
    }

    /// The metadata of a point cloud, whose elements are a list and no longer pixels.
    #[cfg(feature = "cloud")]
    pub(super) fn of_points(self, count: u64) -> Self {
        Self { shape: vec![count], pixels: None, ..self }
    }

    /// The metadata as JSON in one line of ASCII.
    ///
    /// # Panics
    ///
    /// Never: every field is of a type that JSON has.
    pub fn to_json(&self) -> String {
        let text =
            serde_json::to_string(self).expect("strings, numbers and lists of them are JSON");
        ascii(&text)
    }

    /// The metadata of a JSON text.
    ///
    /// # Errors
    ///
    /// In words, for text that is no metadata.
    pub fn from_json(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|error| format!("metadata: {error}"))
    }

    /// The record of the channel called `name`.
    pub fn channel(&self, name: &str) -> Option<&ChannelRecord> {
        self.channels.iter().find(|channel| channel.name == name)
    }
}

/// A digest of all numbers of some channels.
fn digest(channels: &[&Channel]) -> String {
    const PIECE: usize = 1 << 12;
    let mut digest = Digest::default();
    for channel in channels {
        digest.word(&channel.name);
        digest.count(channel.data.len());
        if let Data::Float64(values) = &channel.data {
            digest.numbers(values);
            continue;
        }
        for start in (0..channel.data.len()).step_by(PIECE) {
            let places = start..channel.data.len().min(start + PIECE);
            let numbers: Vec<f64> = places.map(|place| channel.data.value(place)).collect();
            digest.numbers(&numbers);
        }
    }
    digest.name()
}

impl Pixels {
    /// Pixels whose first is that row and column of the camera's.
    fn from([row, column]: [u64; 2]) -> Self {
        Self {
            first_center: [column as f64 + 0.5, row as f64 + 0.5],
            row_0: "top".to_owned(),
            column_0: "left".to_owned(),
        }
    }
}

impl ChannelRecord {
    fn of(channel: &Channel, has_camera: bool, stored: Option<Stored>) -> Self {
        let description = &channel.description;
        Self {
            name: channel.name.to_string(),
            about: description.about.to_owned(),
            dtype: channel.data.kind().to_owned(),
            components: channel.components as u64,
            unit: description.unit.name(has_camera).map(str::to_owned),
            frame: description.frame.map(str::to_owned),
            miss: channel.miss().to_owned(),
            stored,
        }
    }

    /// The record of a channel that has no misses.
    fn of_returns(mut self) -> Self {
        let stored = self.stored.iter_mut().map(|stored| &mut stored.miss);
        for miss in stored.chain([&mut self.miss]) {
            "none".clone_into(miss);
        }
        self
    }
}

impl Stored {
    /// Numbers under `names`, without a scale, a legend or a display transform.
    pub(super) fn new(names: Vec<String>, dtype: &str, encoding: Encoding, miss: &str) -> Self {
        Self {
            names,
            dtype: dtype.to_owned(),
            encoding,
            miss: miss.to_owned(),
            scale: None,
            far: None,
            legend: None,
            exposure: None,
            tone_map: None,
        }
    }

    /// The channel's own numbers, under some names.
    pub(super) fn exact(channel: &Channel, names: Vec<String>) -> Self {
        Self::new(names, channel.data.kind(), Encoding::Exact, channel.miss())
    }
}
