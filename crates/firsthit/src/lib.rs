pub mod error;
pub mod geometry;
pub mod image;
pub mod io;
pub mod shape;
pub mod watch;
pub use error::{Error, Result};
