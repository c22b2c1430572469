//! Settings for reading a file.

use std::path::PathBuf;

/// Settings for reading a file.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadSettings {
    /// Whether unusable triangles, and a text file that seems to be truncated, are errors instead
    /// of warnings.
    pub strict: bool,
    /// The bytes of memory that may be spent on the file: on its content, unpacked, on what it
    /// names, and on the vertices, triangles and textures of all that. The trees of a scene come on
    /// top. Neither this nor `max_texture` limits a `.fhs` file that is mapped.
    ///
    /// The contents of a file are bounded by its size too: vertices, triangles, instances
    /// and names may take 256 times the bytes that were read, and 1/256 of `max_memory` beside. Of
    /// textures a sixteenth counts there.
    pub max_memory: u64,
    /// The most texels that a texture may have across or down, and the root of the most bytes that
    /// it may have in all.
    pub max_texture: u32,
    /// Whether the checksums of a `.fhs` file are compared with all of its content. Its structure
    /// is checked in any case.
    pub verify: bool,
    /// Folders whose files a file may name, as textures, beside those of its own folder. Names that
    /// are not found beside it are looked for there, by the whole name and by its last part.
    /// Nothing else is opened: links that lead elsewhere are refused.
    pub resources: Vec<PathBuf>,
    /// The factor of all lengths of a mesh file or a model, positive and finite; see [`UNITS`]. Its
    /// lights are as bright on its surfaces as before. Scene files and built scenes have lengths of
    /// their own: for them it is 1.
    pub scale: f64,
    /// The variant of a glTF file's materials, by its name (`KHR_materials_variants`); that which
    /// the file shows without one if left out. Of the files that a scene file names, those that
    /// have the variant are read so.
    pub variant: Option<String>,
}

/// The units that a file's lengths may be in, by name, and how many metres each is.
pub const UNITS: &[(&str, f64)] = &[
    ("um", 1e-6),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("m", 1.0),
    ("km", 1e3),
    ("in", 0.0254),
    ("ft", 0.3048),
];

impl Default for LoadSettings {
    /// Doubtful triangles are dropped; 8 GiB; textures of 16,384 texels and 256 MiB.
    fn default() -> Self {
        Self {
            strict: false,
            max_memory: 8 << 30,
            max_texture: 16_384,
            verify: false,
            resources: Vec::new(),
            scale: 1.0,
            variant: None,
        }
    }
}
