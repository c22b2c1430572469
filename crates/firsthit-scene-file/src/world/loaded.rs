//! The result of reading a file.

use std::borrow::Cow;
use std::path::PathBuf;

use super::World;
use crate::error::{Result, there_are};
use crate::geometry::summary::summary;
use crate::io::fault::Checked;
use crate::io::{Format, Report};
use crate::scene::Scene;

/// A file that was read: the world that it describes, and facts about the reading.
#[derive(Clone)]
pub struct Loaded {
    /// The world that the file describes.
    pub world: World,
    /// The files that were read, the loaded one first.
    pub files: Vec<PathBuf>,
    /// The warnings about the file: a line each, ready to print.
    pub warnings: Vec<String>,
    /// The names of the variants of materials that the file has, one of which
    /// [`LoadSettings::variant`](crate::io::LoadSettings::variant) may ask for.
    pub variants: Vec<String>,
    /// The number of vertices in a glTF file: a buffer counts once for each primitive or node that
    /// names it. For other formats `None`: the objects' buffers tell.
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
    /// The content of a file: its world, with all that the format says beside it.
    ///
    /// # Errors
    ///
    /// The first warning, where the settings are strict.
    pub(crate) fn new(mut world: World, format: &Format, report: &mut Report) -> Result<Self> {
        if let Some(error) = report.strict_error() {
            return Err(error);
        }
        (world.up, world.up_is_guessed) = format.up(world.up, world.up_is_guessed);
        Ok(Self {
            warnings: report.take_lines(),
            files: report.source.take_files(),
            variants: std::mem::take(&mut report.variants),
            vertices: report.vertices,
            scene: report.scene.take(),
            world,
        })
    }

    /// The scene of the world, see [`World::into_scene`]. Trees that the file holds are not built
    /// again.
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
    /// The errors of [`Scene::new`].
    pub fn into_scene(self) -> Result<Scene> {
        self.world.into_scene_after(self.scene.as_ref())
    }
}

/// A format whose files say how their scenes look.
pub(crate) struct WorldFormat {
    pub(crate) format: Format,
    pub(crate) read: fn(&[u8], &mut Report) -> Checked<World>,
}

impl WorldFormat {
    /// Reads a file's content, packed by gzip or not.
    ///
    /// # Errors
    ///
    /// The errors of [`Format::read`].
    pub(crate) fn load(&self, bytes: Cow<'_, [u8]>, report: &mut Report) -> Result<World> {
        self.format.read(bytes, report, self.read)
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
