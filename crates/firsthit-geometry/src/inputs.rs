//! The files that this process has read: readers note them here, and writers ask before they
//! replace a file.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The identity of a file, however its name is spelled and whatever links lead to it.
#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = PathBuf;

struct Files {
    /// The files that were read, and where each was.
    read: BTreeMap<Identity, PathBuf>,
    /// The places of the files: another program may have replaced one since.
    places: BTreeSet<PathBuf>,
    /// The files that this process wrote. They are not lost when they are made anew.
    own: BTreeMap<PathBuf, Identity>,
}

impl Files {
    const NONE: Self =
        Self { read: BTreeMap::new(), places: BTreeSet::new(), own: BTreeMap::new() };
}

static FILES: Mutex<Files> = Mutex::new(Files::NONE);

fn files() -> MutexGuard<'static, Files> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Begins a run: what was read and written before is of another one. A program calls it for each of
/// its commands.
pub fn begin_run() {
    *files() = Files::NONE;
}

/// Notes that the file at `path` is read: from now on nothing is written over it. A path to no
/// regular file, or to nothing, is not noted, nor is a file that this process wrote.
///
/// The readers of this crate note what they open. A caller that reads by itself calls this.
pub fn note(path: &Path) {
    let Some((identity, place)) = found(path) else {
        return;
    };
    let mut files = files();
    if files.own.get(&place) != Some(&identity) {
        files.places.insert(place.clone());
        files.read.insert(identity, place);
    }
}

/// Whether `path` leads to a file that was read, by whatever name, and that is still there.
pub fn is_input(path: &Path) -> bool {
    let Some((identity, place)) = found(path) else {
        return false;
    };
    let files = files();
    if files.places.contains(&place) {
        return true;
    }
    let read = files.read.get(&identity).cloned();
    drop(files);
    // Where the file that was read is gone, the system may have given its identity to another.
    read.and_then(|place| found(&place)).is_some_and(|(there, _)| there == identity)
}

/// Notes that this process has written the file at `path`.
#[doc(hidden)]
pub fn written(path: &Path) {
    if let Some((identity, place)) = found(path) {
        let mut files = files();
        files.places.remove(&place);
        files.own.insert(place, identity);
    }
}

/// A regular file, and where it is without links.
fn found(path: &Path) -> Option<(Identity, PathBuf)> {
    let there = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
    let place = path.canonicalize().ok()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Some(((there.dev(), there.ino()), place))
    }
    #[cfg(not(unix))]
    {
        let _ = there;
        Some((place.clone(), place))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_was_read_is_known_by_each_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "a").unwrap();
        fs::write(at("b"), "b").unwrap();
        std::os::unix::fs::symlink("a", at("link")).unwrap();
        fs::hard_link(at("a"), at("second")).unwrap();
        note(&at("./a"));
        fs::create_dir(at("folder")).unwrap();
        for name in ["a", "link", "second", "folder/../a"] {
            assert!(is_input(&at(name)), "{name}");
        }
        assert!(!is_input(&at("b")) && !is_input(&at("c")));
    }

    #[test]
    fn a_file_that_was_removed_is_an_input_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "a").unwrap();
        note(&path);
        fs::remove_file(&path).unwrap();
        assert!(!is_input(&path));
        // It may have the inode of the one that is gone.
        let other = folder.path().join("b");
        fs::write(&other, "b").unwrap();
        assert!(!is_input(&other));
    }
}
