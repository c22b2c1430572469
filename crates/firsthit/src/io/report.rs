//! What a loader has to say: faults that stop it, warnings that do not.

use std::path::{Path, PathBuf};

use super::LoadSettings;
use crate::error::{Error, Place, escaped};

/// The result of a loader's steps, before the path is known.
pub(super) type Checked<T> = Result<T, Fault>;

/// Why a file cannot be read.
#[derive(Debug)]
pub(super) enum Fault {
    /// Its content is wrong.
    Content { place: Place, what: String },
    /// Anything else, as it will be reported.
    Other(Error),
}

impl Fault {
    pub(super) fn at(place: Place, what: impl Into<String>) -> Self {
        let what = what.into();
        Self::Content { place, what }
    }

    pub(super) fn line(number: u64, what: impl Into<String>) -> Self {
        Self::at(Place::Line(number), what)
    }

    pub(super) fn file(what: impl Into<String>) -> Self {
        Self::at(Place::File, what)
    }

    pub(super) fn into_error(self, path: &Path) -> Error {
        let path = path.to_owned();
        match self {
            Self::Content { place, what } => Error::Parse { path, place, what },
            Self::Other(error) => error,
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Other(error)
    }
}

/// The warnings about one file: one for each kind, however often it occurs.
#[derive(Debug)]
pub(super) struct Report {
    path: PathBuf,
    settings: LoadSettings,
    kinds: Vec<Kind>,
    dropped: u64,
    first_dropped: String,
    /// Warnings of files that this one names, worded.
    absorbed: Vec<String>,
    files: Vec<PathBuf>,
}

#[derive(Debug)]
struct Kind {
    key: &'static str,
    line: String,
    count: u64,
}

impl Report {
    pub(super) fn new(path: &Path, settings: LoadSettings) -> Self {
        Self {
            path: path.to_owned(),
            settings,
            kinds: Vec::new(),
            dropped: 0,
            first_dropped: String::new(),
            absorbed: Vec::new(),
            files: Vec::new(),
        }
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn settings(&self) -> &LoadSettings {
        &self.settings
    }

    /// The file's name without its extension: what an object without a name is called.
    pub(super) fn stem(&self) -> String {
        escaped(Path::new(self.path.file_stem().unwrap_or_default()))
    }

    /// Notes something doubtful. `key` tells the kinds apart; only the first of a kind is worded.
    pub(super) fn warn(&mut self, key: &'static str, place: &Place, what: impl FnOnce() -> String) {
        let path = self.path.clone();
        self.warn_in(&path, key, place, what);
    }

    /// The same about another file, such as a material library.
    pub(super) fn warn_in(
        &mut self,
        path: &Path,
        key: &'static str,
        place: &Place,
        what: impl FnOnce() -> String,
    ) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.key == key) {
            kind.count += 1;
        } else {
            let line = format!("{}{place}: {}", escaped(path), what());
            let count = 1;
            self.kinds.push(Kind { key, line, count });
        }
    }

    /// Takes over what another file's report came to, with the files that were read for it.
    pub(super) fn absorb(&mut self, lines: Vec<String>, files: Vec<PathBuf>) {
        self.absorbed.extend(lines);
        self.files.extend(files);
    }

    /// Notes a further file that was read, such as a texture.
    pub(super) fn note_file(&mut self, path: PathBuf) {
        self.files.push(path);
    }

    /// The further files that were read.
    pub(super) fn take_files(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.files)
    }

    /// Notes triangles that cannot be used; `first` words which one came first.
    pub(super) fn drop_triangles(&mut self, count: u64, first: impl FnOnce() -> String) {
        if self.dropped == 0 && count > 0 {
            self.first_dropped = first();
        }
        self.dropped += count;
    }

    /// What to say about the triangles that were dropped, if any were.
    pub(super) fn dropped(&self) -> Option<String> {
        (self.dropped > 0).then(|| {
            let (count, first) = (self.dropped, &self.first_dropped);
            format!(
                "{count} triangles have a corner that is not finite or not below 1e30; \
                 the first is {first}"
            )
        })
    }

    /// The warnings, ready to print.
    pub(super) fn into_lines(self) -> Vec<String> {
        let dropped = self
            .dropped()
            .map(|what| format!("{}: dropped: {what}", escaped(&self.path)));
        let worded = self.kinds.into_iter().map(|kind| match kind.count {
            1 => kind.line,
            count => format!("{} (and {} more like it)", kind.line, count - 1),
        });
        worded.chain(dropped).chain(self.absorbed).collect()
    }
}
