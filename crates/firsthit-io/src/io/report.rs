//! The context of a loader beside the bytes: settings, the source, the memory budget and a place
//! for warnings.

use std::path::{Path, PathBuf};

use super::fault::Checked;
use super::memory_budget::MemoryBudget;
use super::read;
use super::settings::LoadSettings;
use super::source::SourceFile;
use super::warnings::Warnings;
use crate::error::{Error, Place, escaped};
use crate::scene::Scene;
use crate::watch::{Watch, stop_if_asked};

/// All about the reading of one file but its content.
pub struct Report<'w> {
    pub watch: &'w dyn Watch,
    /// The bytes of the content that the watch was not told of.
    unparsed: usize,
    pub settings: LoadSettings,
    pub source: SourceFile,
    pub budget: MemoryBudget,
    pub warnings: Warnings,
    /// The names of the variants of the materials that the file has.
    pub variants: Vec<String>,
    /// The number of vertices in a glTF file, where a buffer counts for each primitive that names
    /// it; for other formats `None`.
    pub vertices: Option<u64>,
    /// The scene that the file, or a part of it, holds built.
    pub scene: Option<Scene>,
}

impl<'w> Report<'w> {
    pub fn new(path: &Path, settings: LoadSettings, watch: &'w dyn Watch) -> Self {
        Self {
            watch,
            unparsed: 0,
            source: SourceFile::new(path),
            budget: MemoryBudget::new(settings.max_memory),
            settings,
            warnings: Warnings::default(),
            variants: Vec::new(),
            vertices: None,
            scene: None,
        }
    }

    /// The report about a file that this one names, within this one's budget.
    pub fn part(&self, path: &Path) -> Self {
        let settings = LoadSettings { scale: 1.0, ..self.settings.clone() };
        Self { budget: self.budget.part(), ..Self::new(path, settings, self.watch) }
    }

    /// The file that the one that is read calls `name`, see [`read::sibling`].
    ///
    /// # Errors
    ///
    /// In words, why there is none.
    pub fn sibling(&self, name: &str) -> Result<PathBuf, String> {
        read::sibling(self.source.base()?, name, &self.settings.resources)
    }

    /// Takes over what reading a part of the file came to: its warnings, files and variants, and
    /// the first scene that is built.
    pub fn absorb(&mut self, mut part: Self) {
        self.budget.absorb(&part.budget);
        self.warnings.absorb(part.take_lines());
        self.source.further.extend(part.source.take_files());
        self.add_variants(part.variants);
        self.scene = self.scene.take().or(part.scene);
    }

    /// Tells the watch that `bytes` bytes of the file's content, or of `what` it names, are parsed
    /// from now on.
    pub(crate) fn begin_parsing(&mut self, what: &str, bytes: usize) {
        self.unparsed = bytes;
        let step = format!("parsing {what}{}", escaped(self.source.path()));
        self.watch.begin(&step, bytes as u64, "bytes");
    }

    /// Tells the watch that all of the content is parsed but its last `left` bytes.
    ///
    /// # Errors
    ///
    /// [`Error::Interrupted`].
    pub fn advance_until(&mut self, left: usize) -> Checked<()> {
        let bytes = self.unparsed.saturating_sub(left);
        self.unparsed -= bytes;
        self.watch.advance(bytes as u64);
        Ok(stop_if_asked(self.watch)?)
    }

    /// Tells the watch that bytes of the content are parsed, wherever they are; they may come
    /// again.
    ///
    /// # Errors
    ///
    /// [`Error::Interrupted`].
    pub(crate) fn advance(&mut self, bytes: usize) -> Checked<()> {
        self.advance_until(self.unparsed.saturating_sub(bytes))
    }

    /// Adds the names of variants that are not known yet.
    pub fn add_variants(&mut self, names: impl IntoIterator<Item = String>) {
        for name in names {
            if !self.variants.contains(&name) {
                self.variants.push(name);
            }
        }
    }

    /// Adds a warning, see [`Warnings::add`].
    pub fn warn(&mut self, key: &'static str, place: &Place, what: impl FnOnce() -> String) {
        self.warnings.add(self.source.path(), key, place, what);
    }

    /// Warns that the file seems to be truncated, and why. If reading is strict, that is an error.
    pub(crate) fn cut_short(&mut self, place: Place, why: &str) {
        self.warnings.cut_short(self.source.path(), place, why);
    }

    /// The first reason why strict reading fails; `None` if reading is not strict.
    pub fn strict_error(&mut self) -> Option<Error> {
        let strict = self.settings.strict;
        strict.then(|| self.warnings.strict_error(self.source.path()))?
    }

    /// The warnings, ready to print.
    pub fn take_lines(&mut self) -> Vec<String> {
        self.warnings.take_lines(self.source.path())
    }
}
