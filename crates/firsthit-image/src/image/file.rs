use std::fs::{self, File, OpenOptions};
#[cfg(target_os = "linux")]
use std::io::Seek;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::stream::{check_watch, opened_stream, wait_for_room};
use crate::error::{Error, Result};
use crate::inputs;
use crate::watch::Watch;

/// The writer's buffer, in bytes: few system calls, and small beside any picture.
const BUFFER: usize = 1 << 18;

/// Linux itself gives up after 40 symbolic links.
const MOST_LINKS: usize = 40;

/// Writes a file whole or not at all: a reader of `path` finds the old file or the new one at any
/// moment.
///
/// `content` writes to a temporary file `.NAME.XXXXXX.tmp` in the same folder, which is then
/// flushed to the disk and renamed. The new file gets the permission bits of the one that it
/// replaces, else those that the umask gives; owner, further attributes and hard links of the old
/// file are not kept. A symbolic link stays, its target is replaced. Devices, FIFOs and open files
/// such as `/dev/null` and `/dev/stdout` are written straight into, without this promise.
///
/// On Linux the temporary file has no name until it is complete, where the file system can do that:
/// of a process that is killed nothing stays behind, except between naming and renaming. Elsewhere
/// it has its name from the start, and a kill leaves it behind.
///
/// # Errors
///
/// [`Error::Write`] with `path` if the system, or `content`, refuses; or if `path` is a folder, a
/// read-only file or [a file that was read](inputs::is_input); [`Error::Interrupted`] when `watch`
/// stops it. The temporary file is then gone and the old file as it was.
pub fn write_whole(
    path: &Path,
    watch: &dyn Watch,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    let written = target(path).and_then(|target| match target {
        Target::File(path, permissions) => {
            prepare(path, permissions, watch, content).and_then(Prepared::commit)
        }
        Target::Stream(path) => append(&path, watch, content),
    });
    reported(path, watch, written)
}

/// Fails where [`write_whole`] could not make a whole file: a folder that is not there or is
/// read-only, a folder in the place of the file, or a device.
#[doc(hidden)]
pub fn check_writable(path: &Path) -> Result<()> {
    reported(path, &(), prepare_at(path, &(), |_| Ok(())).map(drop))
}

/// [`write_whole`] with a second file beside, called `path` with `.json` after it. Whatever happens
/// in between, no old `sidecar` stays beside the new content: for an instant there is none.
pub(super) fn write_with_sidecar(
    path: &Path,
    watch: &dyn Watch,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    sidecar: &[u8],
) -> Result<()> {
    let beside = sidecar_of(path);
    let refuse_sidecar = |error| reported(&beside, watch, Err(error));
    let (target, permissions) = match target(path) {
        Ok(Target::File(target, permissions)) => (target, permissions),
        // A pipe has no file beside it.
        Ok(Target::Stream(path)) => return reported(&path, watch, append(&path, watch, content)),
        Err(error) => return reported(path, watch, Err(error)),
    };
    // Both are on the disk before either is touched: a disk that is full leaves the old ones.
    let prepared = match prepare(target, permissions, watch, content) {
        Ok(prepared) => prepared,
        Err(error) => return reported(path, watch, Err(error)),
    };
    let second = match prepare_at(&beside, watch, |out| out.write_all(sidecar)) {
        Ok(second) => second,
        Err(error) => return refuse_sidecar(error),
    };
    if second.replaces
        && let Err(error) = fs::remove_file(&second.path)
    {
        return refuse_sidecar(error);
    }
    reported(path, watch, prepared.commit())?;
    second.commit().or_else(refuse_sidecar)
}

/// The path of an array's metadata: `x.npy.json` beside `x.npy`.
pub fn sidecar_of(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".json");
    PathBuf::from(name)
}

/// The error as callers get it.
fn reported(path: &Path, watch: &dyn Watch, written: io::Result<()>) -> Result<()> {
    written.map_err(|source| {
        if watch.is_stopped() {
            return Error::Interrupted;
        }
        Error::Write { path: path.to_owned(), source }
    })
}

/// The destination of the bytes.
enum Target {
    /// A file to replace, or to make; the permissions of the one that is there.
    File(PathBuf, Option<fs::Permissions>),
    /// Something that a rename would destroy: a device, a FIFO, a file that a process has open.
    Stream(PathBuf),
}

fn target(path: &Path) -> io::Result<Target> {
    // `Path` drops a closing slash, which says that a folder is meant.
    if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
        return Err(is_folder());
    }
    let path = without_links(path)?;
    match fs::metadata(&path) {
        Ok(there) if there.is_dir() => Err(is_folder()),
        Ok(there) if !there.is_file() || is_open_file(&path) => Ok(Target::Stream(path)),
        // A rename would replace it without asking: that is not what its owner protected it for.
        Ok(there) if there.permissions().readonly() => {
            Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"))
        }
        Ok(_) if inputs::is_input(&path) => Err(io::Error::other(
            "is an input; it will not be overwritten (remove it first, or take another name)",
        )),
        Ok(there) => Ok(Target::File(path, Some(there.permissions()))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Target::File(path, None)),
        Err(error) => Err(error),
    }
}

fn is_folder() -> io::Error {
    io::Error::new(io::ErrorKind::IsADirectory, "is a folder, not a file")
}

/// `path` with the links that its last part goes through followed, even to a file that is not
/// there.
fn without_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        if is_open_file(&path) || !path.is_symlink() {
            return Ok(path);
        }
        // `join` takes an absolute target as it is.
        path = folder_of(&path).join(fs::read_link(&path)?);
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Whether `path` is a process's open file, such as what `/dev/stdout` and `/dev/fd/1` lead to.
/// They look like links to regular files, but replacing those would miss the reader of the open
/// one.
fn is_open_file(path: &Path) -> bool {
    fs::canonicalize(folder_of(path)).is_ok_and(|folder| folder.starts_with("/proc"))
}

/// The folder that `path` is in; of a mere name, the current one.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// A new file on the disk, under another name until it is committed. Dropping it removes it.
struct Prepared {
    temporary: Temporary,
    path: PathBuf,
    /// Whether there is an old file.
    replaces: bool,
}

fn prepare(
    path: PathBuf,
    permissions: Option<fs::Permissions>,
    watch: &dyn Watch,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<Prepared> {
    // Dropping `temporary` removes it: every error below leaves nothing behind.
    let temporary = Temporary::beside(&path)?;
    buffered(temporary.file(), watch, content)?;
    let replaces = permissions.is_some();
    if let Some(permissions) = permissions {
        temporary.file().set_permissions(permissions)?;
    }
    temporary.file().sync_all()?;
    Ok(Prepared { temporary, path, replaces })
}

/// [`prepare`] for a path that must not lead to a stream.
fn prepare_at(
    path: &Path,
    watch: &dyn Watch,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<Prepared> {
    match target(path)? {
        Target::File(path, permissions) => prepare(path, permissions, watch, content),
        Target::Stream(_) => Err(io::Error::other("is not a regular file")),
    }
}

impl Prepared {
    fn commit(self) -> io::Result<()> {
        self.temporary.become_file(&self.path)?;
        inputs::written(&self.path);
        // Without this a power cut may undo the rename, but never tear the file: best effort is
        // enough, and not every system can do it.
        let _ = File::open(folder_of(&self.path)).and_then(|folder| folder.sync_all());
        Ok(())
    }
}

/// Appending, so that what a redirected standard output already holds stays.
fn append(
    path: &Path,
    watch: &dyn Watch,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    buffered(&opened_stream(path, watch)?, watch, content)
}

/// A temporary file, not yet under its final name.
enum Temporary {
    /// A file without a name, which vanishes with the process.
    #[cfg(target_os = "linux")]
    Nameless(File),
    Named(NamedTempFile),
}

impl Temporary {
    fn beside(path: &Path) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(file) = nameless_in(folder_of(path)) {
            return Ok(Self::Nameless(file));
        }
        beside(path, create).map(Self::Named)
    }

    fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => file,
            Self::Named(named) => named.as_file(),
        }
    }

    /// Takes the place of the file at `path`, from one instant to the next.
    fn become_file(self, path: &Path) -> io::Result<()> {
        let named = match self {
            // Only a name can replace a name: there is no other way than by a second one.
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => match beside(path, |name| give_name(&file, name)) {
                Ok(named) => named.into_temp_path(),
                Err(_) => copied(file, path)?.into_temp_path(),
            },
            Self::Named(named) => named.into_temp_path(),
        };
        named.persist(path).map_err(|refused| refused.error)
    }
}

/// A file without a name; `None` where the file system has none, or the folder takes no files at
/// all.
#[cfg(target_os = "linux")]
fn nameless_in(folder: &Path) -> Option<File> {
    use rustix::fs::{Mode, OFlags, open};
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    // As every other new file: the umask takes its bits away.
    let file: File = open(folder, flags, Mode::from_raw_mode(0o666)).ok()?.into();
    // Without /proc it could not be given a name later.
    fs::metadata(path_of_open(&file)).ok().map(|_| file)
}

/// Copies a nameless file to a named one, for systems that refuse to give it a name.
#[cfg(target_os = "linux")]
fn copied(mut file: File, path: &Path) -> io::Result<NamedTempFile<File>> {
    let named = beside(path, create)?;
    file.seek(io::SeekFrom::Start(0))?;
    io::copy(&mut file, &mut named.as_file())?;
    named.as_file().set_permissions(file.metadata()?.permissions())?;
    named.as_file().sync_all()?;
    Ok(named)
}

#[cfg(target_os = "linux")]
fn path_of_open(file: &File) -> String {
    use std::os::fd::AsRawFd;
    format!("/proc/self/fd/{}", file.as_raw_fd())
}

#[cfg(target_os = "linux")]
fn give_name(file: &File, name: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    Ok(linkat(CWD, path_of_open(file), CWD, name, AtFlags::SYMLINK_FOLLOW)?)
}

/// Calls `make` with a free name, `.NAME.XXXXXX.tmp` beside `path`.
fn beside<R>(
    path: &Path,
    make: impl FnMut(&Path) -> io::Result<R>,
) -> io::Result<NamedTempFile<R>> {
    let name = path.file_name().ok_or_else(is_folder)?.to_string_lossy();
    // Cut short: names have at most 255 bytes, and 50 characters have at most 200.
    let prefix = format!(".{}.", name.chars().take(50).collect::<String>());
    // A folder that is missing says so in the system's words; `tempfile` keeps only the kind of the
    // error.
    fs::metadata(folder_of(path))?;
    tempfile::Builder::new()
        .prefix(&prefix)
        .suffix(".tmp")
        .make_in(folder_of(path), make)
        .map_err(|error| without_name(&error))
}

/// A new file, its permissions those that the umask gives: `tempfile` would make it private.
fn create(name: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).create_new(true).open(name)
}

/// The system's reason alone, without the temporary file's name, which `tempfile` adds.
fn without_name(error: &io::Error) -> io::Error {
    let inner = error.get_ref().and_then(|error| error.source());
    let code = inner.and_then(|inner| inner.downcast_ref::<io::Error>()?.raw_os_error());
    code.map_or_else(|| error.kind().into(), io::Error::from_raw_os_error)
}

fn buffered(
    file: &File,
    watch: &dyn Watch,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = BufWriter::with_capacity(BUFFER, Stoppable { file, watch });
    content(&mut writer)?;
    writer.flush()
}

/// A writer that fails once the watch says stop, so that the temporary file is removed.
struct Stoppable<'a> {
    file: &'a File,
    watch: &'a dyn Watch,
}

impl Write for Stoppable<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        loop {
            check_watch(self.watch)?;
            match self.file.write(bytes) {
                Err(full) if full.kind() == io::ErrorKind::WouldBlock => wait_for_room(self.file),
                written => return written,
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn write_text(path: &Path, text: &str) -> Result<()> {
        write_whole(path, &(), |out| out.write_all(text.as_bytes()))
    }

    #[test]
    fn the_new_file_replaces_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_text(&path, "the old one, longer").unwrap();
        write_text(&path, "new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    /// A kill while the content is written must leave nothing behind.
    #[test]
    #[cfg(target_os = "linux")]
    fn an_incomplete_file_has_no_name_where_that_can_be() {
        let folder = tempfile::tempdir().unwrap();
        if nameless_in(folder.path()).is_none() {
            return;
        }
        let path = folder.path().join("a.png");
        write_whole(&path, &(), |out| {
            assert!(names(folder.path()).is_empty());
            out.write_all(b"new")
        })
        .unwrap();
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_text(&path, "old").unwrap();
        let result = write_whole(&path, &(), |out| {
            out.write_all(&vec![1; 2 * BUFFER])?;
            Err(io::Error::other("out of ink"))
        });
        let message = result.unwrap_err().to_string();
        assert_eq!(message, format!("{}: out of ink", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn errors_name_the_target_and_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("none/a.png");
        let error = write_text(&missing, "").unwrap_err();
        let Error::Write { path, source } = error else {
            panic!("{error}");
        };
        assert_eq!((path, source.kind()), (missing, io::ErrorKind::NotFound));
        assert!(!source.to_string().contains("tmp"), "{source}");
        let message = write_text(folder.path(), "").unwrap_err().to_string();
        assert!(message.ends_with("is a folder, not a file"), "{message}");
        assert!(write_text(&folder.path().join("a.png/"), "").is_err());
        assert!(write_text(Path::new(""), "").is_err());
    }

    #[test]
    fn a_read_only_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_text(&path, "old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        let message = write_text(&path, "new").unwrap_err().to_string();
        assert!(message.ends_with("the file is read-only"), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn a_name_of_the_longest_length_can_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("é".repeat(127));
        write_text(&path, "long").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"long");
    }
}
