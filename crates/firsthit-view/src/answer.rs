//! Questions by their names: what an engine hands on, whatever carries it.

use firsthit::error::escape_controls;
use firsthit::watch::Watch;
use firsthit::{Error, Result};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::frame::Pixels;
use crate::look::{FlatCamera, FrameRequest};
use crate::probe::Probe;
use crate::section::SectionRequest;
use crate::viewer::Viewer;

/// The answer to a question.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The answer; of a frame, what its pixels are.
    pub json: Value,
    /// The pixels of a frame; of other questions none.
    pub pixels: Vec<u8>,
}

/// The reason why a question has no answer.
#[derive(Debug)]
pub enum AnswerError {
    /// No question has that name.
    Unknown(String),
    /// The question is not written as such a question is.
    Malformed(String),
    /// The question makes no sense, cannot be answered, or was interrupted.
    Failed(Error),
}

impl std::fmt::Display for AnswerError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "there is no question '{}'", escape_controls(name)),
            Self::Malformed(why) => f.write_str(why),
            Self::Failed(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for AnswerError {}

impl From<Error> for AnswerError {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

/// A question about a camera.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraQuestion {
    camera: FlatCamera,
}

impl Viewer {
    /// Answers the question of that name, until the watch stops it.
    ///
    /// | question | JSON | answer | pixels |
    /// |---|---|---|---|
    /// | `info` | not read | [`Viewer::info`] | |
    /// | `frame` | [`FrameRequest`] | `rows`, `columns`, `samples`, `full_samples`, `range` of colours by numbers, and of values `components` and `dtype` | a PNG, or values as a zlib stream |
    /// | `probe` | [`Probe`] | [`Viewer::probe`] | |
    /// | `section` | [`SectionRequest`] | [`Viewer::section`] | |
    /// | `camera` | `camera` | [`Viewer::camera_text`] | |
    ///
    /// # Errors
    ///
    /// [`AnswerError`], whose text is one line.
    pub fn answer(
        &self,
        question: &str,
        json: &[u8],
        watch: &dyn Watch,
    ) -> std::result::Result<Answer, AnswerError> {
        let told = |value: Result<Value>| {
            let json = value?;
            let pixels = Vec::new();
            Ok(Answer { json, pixels })
        };
        match question {
            "info" => told(Ok(self.info())),
            "frame" => Ok(self.frame_answer(&parsed(json)?, watch)?),
            "probe" => told(self.probe(&parsed::<Probe>(json)?, watch)),
            "section" => told(self.section(&parsed::<SectionRequest>(json)?, watch)),
            "camera" => told(self.camera_text(&parsed::<CameraQuestion>(json)?.camera)),
            other => Err(AnswerError::Unknown(other.to_owned())),
        }
    }

    fn frame_answer(&self, request: &FrameRequest, watch: &dyn Watch) -> Result<Answer> {
        let painted = self.frame(request, watch)?;
        let [rows, columns] = painted.shape;
        let mut json = json!({
            "rows": rows,
            "columns": columns,
            "samples": painted.samples,
            "full_samples": painted.full_samples,
        });
        if let Some(range) = painted.range {
            json["range"] = json!(range);
        }
        let pixels = match painted.pixels {
            Pixels::Png(bytes) => bytes,
            Pixels::Values { components, dtype, bytes } => {
                json["components"] = components.into();
                json["dtype"] = dtype.into();
                bytes
            }
        };
        Ok(Answer { json, pixels })
    }
}

fn parsed<T: DeserializeOwned>(json: &[u8]) -> std::result::Result<T, AnswerError> {
    serde_json::from_slice(json).map_err(|error| AnswerError::Malformed(error.to_string()))
}
