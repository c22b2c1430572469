//! What a page that shows a scene asks, and the server that answers it.
//!
//! A page asks three things of an engine, whatever carries them: [`Viewer::info`] once, [`Viewer::frame`] for each picture, and
//! [`Viewer::probe`] for a pixel. [`Viewer::say`] tells a camera in the words of other programs. Each takes and gives JSON or bytes, and
//! opens nothing.
//!
//! [`server`] serves the page and answers it, on the loopback interface alone.

mod cut;
mod frame;
mod info;
mod look;
mod open;
mod probe;
mod say;
#[cfg(feature = "server")]
pub mod server;
pub mod story;
mod viewer;
pub mod words;

pub use frame::{Painted, Pixels};
pub use look::{Cut, FlatCamera, FrameRequest, Projection, RaysStart, Visibility};
pub use probe::Probe;
pub use viewer::Viewer;
