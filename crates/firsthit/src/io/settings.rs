//! How to read a file.

/// How to read a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoadSettings {
    /// Whether unusable triangles, and a text file that seems to be truncated, are errors instead of warnings.
    pub strict: bool,
    /// How many bytes of memory may be spent on the file: on its content, unpacked, on what it names, and
    /// on the vertices, triangles and textures of all that. The trees of a scene come on top. Neither this nor
    /// `max_texture` limits a `.fhs` file that is mapped.
    ///
    /// What a small file may describe is bounded by its size too: vertices, triangles, instances and names may take
    /// 256 times the bytes that were read, and 1/256 of `max_memory` beside. Of textures a sixteenth counts there.
    pub max_memory: u64,
    /// How many texels a texture may have across or down, and the root of how many bytes it may have in all.
    pub max_texture: u32,
    /// Whether the checksums of a `.fhs` file are compared with all of its content. Its structure is checked in any case.
    pub verify: bool,
}

impl Default for LoadSettings {
    /// Doubtful triangles are dropped; 8 GiB; textures of 16,384 texels and 256 MiB.
    fn default() -> Self {
        Self {
            strict: false,
            max_memory: 8 << 30,
            max_texture: 16_384,
            verify: false,
        }
    }
}
