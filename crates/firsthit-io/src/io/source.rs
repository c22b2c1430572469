//! The file that is read, and the files that were read for it.

use std::path::{Path, PathBuf};

use crate::error::escaped;

/// The name that a packed file has unpacked: `a.ply` of `a.ply.gz`.
pub(crate) fn without_gz(path: &Path) -> PathBuf {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("gz") => path.with_extension(""),
        _ => path.to_owned(),
    }
}

/// Whether a file's name ends with one of some extensions, in any case; packed files by their name
/// unpacked.
pub fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let unpacked = without_gz(path);
    let own = unpacked.extension().unwrap_or_default();
    extensions.iter().any(|known| own.eq_ignore_ascii_case(known))
}

/// The file that is read.
#[derive(Debug)]
pub struct SourceFile {
    path: PathBuf,
    /// Whether its path is a mere name without a folder: no file that it names is opened.
    pub in_memory: bool,
    /// Files that were read for it, such as textures.
    pub(crate) further: Vec<PathBuf>,
}

impl SourceFile {
    pub(crate) fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), in_memory: false, further: Vec::new() }
    }

    /// The path, as messages call it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file that the names in the file are relative to: itself.
    ///
    /// # Errors
    ///
    /// In words, for content in memory.
    pub fn base(&self) -> Result<&Path, String> {
        if self.in_memory {
            Err("refused: content that is in memory has no folder".to_owned())
        } else {
            Ok(&self.path)
        }
    }

    /// The file's name without extensions: the name of an object without one.
    pub(crate) fn stem(&self) -> String {
        let path = without_gz(&self.path);
        escaped(Path::new(path.file_stem().unwrap_or_default()))
    }

    /// All files that were read, itself first.
    pub fn take_files(&mut self) -> Vec<PathBuf> {
        let further = std::mem::take(&mut self.further);
        [vec![self.path.clone()], further].concat()
    }
}
