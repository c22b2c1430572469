//! The answers to a page that shows a scene, and the server that gives them.
//!
//! A page asks three things of an engine, whatever carries them: [`Viewer::info`] once,
//! [`Viewer::frame`] for each picture, and [`Viewer::probe`] for a pixel. [`Viewer::camera_text`]
//! writes a camera as other programs read it, and [`Viewer::section`] measures what a plane cuts.
//! Each takes and gives JSON or bytes, and opens nothing. [`Viewer::answer`] takes such a question
//! by its name.
//!
//! [`server`] serves the page and answers it, on the loopback interface alone. [`Viewer::report`]
//! puts the page, the scene and an engine into one file.

mod answer;
mod camera_text;
mod cap;
mod cut;
pub mod explanation;
mod frame;
mod info;
mod look;
mod open;
#[cfg(feature = "page")]
mod page_files;
mod probe;
#[cfg(feature = "page")]
mod report;
mod section;
#[cfg(feature = "server")]
pub mod server;
mod viewer;
pub mod words;

pub use answer::{Answer, AnswerError};
pub use frame::{Painted, Pixels};
pub use look::{
    Cut, EnvironmentChoice, EnvironmentRequest, FlatCamera, FrameRequest, Projection, RaysStart,
    Visibility,
};
pub use probe::Probe;
pub use section::SectionRequest;
pub use viewer::Viewer;
