//! The result of reading a file.

use std::path::PathBuf;

use crate::error::{Result, there_are};
use crate::geometry::summary::summary;
use crate::scene::Scene;
use crate::world::World;

/// A file that was read: the world that it describes, and facts about the reading.
#[derive(Clone)]
pub struct Loaded {
    /// The world that the file describes.
    pub world: World,
    /// The files that were read, the loaded one first.
    pub files: Vec<PathBuf>,
    /// The warnings about the file: a line each, ready to print.
    pub warnings: Vec<String>,
    /// The names of the variants of the materials that the file has, one of which [`LoadSettings::variant`](super::LoadSettings::variant)
    /// may ask for.
    pub variants: Vec<String>,
    /// The number of vertices in a glTF file: a buffer counts once for each primitive or node that names it. For other
    /// formats `None`: the objects' buffers tell.
    pub vertices: Option<u64>,
    /// The built scene of the file, as `.fhs` files have one, and scene files that name one: the
    /// scene of the world's objects, or of some.
    pub scene: Option<Scene>,
}

// The world's own, and counts.
summary!(
    Loaded, "Loaded", |loaded| "world": loaded.world, "files": loaded.files.len(), "warnings": loaded.warnings.len()
);

impl Loaded {
    /// The scene of the world, see [`World::into_scene`]. Trees that the file holds are not built again.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use firsthit::load::{LoadSettings, load_bytes};
    ///
    /// let stl = b"solid one\nfacet normal 0 0 1\nouter loop\n\
    ///     vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid one\n";
    /// let loaded = load_bytes(Path::new("one.stl"), stl, &LoadSettings::default())?;
    /// let scene = loaded.into_scene()?;
    /// assert_eq!(scene.triangles(), 1);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`Scene::new`].
    pub fn into_scene(self) -> Result<Scene> {
        self.world.into_scene_after(self.scene.as_ref())
    }
}

/// The warning about a variant that is asked for, where none of a file's has that name.
pub(crate) fn unknown_variant(asked: &str, names: &[String]) -> Option<String> {
    if names.iter().any(|name| name == asked) {
        return None;
    }
    let quoted: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    let there = there_are(&quoted, "it has none");
    Some(format!("{asked:?}; {there}"))
}
