pub mod mesh;
pub mod triangle;
pub use mesh::*;
