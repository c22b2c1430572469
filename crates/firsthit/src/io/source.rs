//! Which file is read, and which files were read for it.

use std::path::{Path, PathBuf};

use crate::error::escaped;

/// The name that a packed file has unpacked: `a.ply` of `a.ply.gz`.
pub(crate) fn without_gz(path: &Path) -> PathBuf {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("gz") => path.with_extension(""),
        _ => path.to_owned(),
    }
}

/// The file that is read.
#[derive(Debug)]
pub(crate) struct Source {
    path: PathBuf,
    in_memory: bool,
    files: Vec<PathBuf>,
}

impl Source {
    pub(crate) fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            in_memory: false,
            files: Vec::new(),
        }
    }

    /// The same for content in memory. Its path is a mere name without a folder: no file that it names is opened.
    pub(crate) fn in_memory(self) -> Self {
        Self {
            in_memory: true,
            ..self
        }
    }

    /// Its path, as messages call it.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The file that the names in the file are relative to: itself.
    ///
    /// # Errors
    ///
    /// In words, for content in memory.
    pub(crate) fn base(&self) -> Result<&Path, String> {
        if self.in_memory {
            Err("refused: content that is in memory has no folder".to_owned())
        } else {
            Ok(&self.path)
        }
    }

    /// Its name without extensions: the name of an object without one.
    pub(crate) fn stem(&self) -> String {
        let path = without_gz(&self.path);
        escaped(Path::new(path.file_stem().unwrap_or_default()))
    }

    /// Notes a further file that was read, such as a texture.
    pub(crate) fn note_file(&mut self, path: PathBuf) {
        self.files.push(path);
    }

    /// Notes the files that were read for another one.
    pub(crate) fn note_files(&mut self, paths: Vec<PathBuf>) {
        self.files.extend(paths);
    }

    /// All files that were read, itself first.
    pub(crate) fn take_files(&mut self) -> Vec<PathBuf> {
        let further = std::mem::take(&mut self.files);
        [vec![self.path.clone()], further].concat()
    }
}
