//! Opens files: regular ones only, and those that a scene names only under its folder. No other
//! file of this room does.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::fault::Checked;
use super::gzip;
use super::memory_budget::size_in_words;
use super::report::Report;
use super::source::without_gz;
use crate::error::{Error, Place, Result, escaped};
use crate::inputs;
use crate::memory::Block;
use crate::watch::{OnlyStops, Watch, stop_if_asked};

/// The whole content of a regular file. Devices and pipes, which may never end, are refused, and no
/// file is mapped: one that shrinks meanwhile would end the process. More than `most` bytes are
/// refused.
pub fn regular_file(path: &Path, most: u64, watch: &dyn Watch) -> Result<Vec<u8>> {
    /// The number of bytes between two questions whether to stop.
    const PIECE: u64 = 1 << 24;
    let refuse = |source| refused(path, source);
    let (file, size) = opened(path)?;
    let too_large = |limit: &str| Error::TooLarge {
        path: path.to_owned(),
        place: Place::File,
        what: format!("the file's {} are more than {limit}", size_in_words(size)),
    };
    if size > most {
        let limit = size_in_words(most);
        let limit =
            format!("the {limit} of memory that are allowed (--max-memory raises the limit)");
        return Err(too_large(&limit));
    }
    let mut bytes = Vec::new();
    let reserved = usize::try_from(size).map(|size| bytes.try_reserve_exact(size));
    if !matches!(reserved, Ok(Ok(()))) {
        return Err(too_large("what memory is free"));
    }
    watch.begin(&format!("reading {}", escaped(path)), size, "bytes");
    // `take`: a file that grows while it is read stays within what was reserved.
    let mut file = file.take(size);
    loop {
        let piece = file.by_ref().take(PIECE).read_to_end(&mut bytes);
        match piece.map_err(refuse)? {
            0 => return Ok(bytes),
            read => watch.advance(read as u64),
        }
        stop_if_asked(watch)?;
    }
}

/// The whole content of a regular file, mapped where the system can do that. For files of our own
/// that are replaced and never changed: one that shrinks meanwhile ends the process.
pub fn mapped_file(path: &Path) -> Result<Block> {
    let (file, size) = opened(path)?;
    let length = usize::try_from(size).map_err(|_| io::ErrorKind::FileTooLarge.into());
    let mapped = length.and_then(|length| Block::map(&file, length));
    mapped.map_err(|source| refused(path, source))
}

/// Whether a file's name says that it is packed by gzip.
pub fn is_named_as_packed(path: &Path) -> bool {
    without_gz(path) != path
}

/// A regular file and its size.
fn opened(path: &Path) -> Result<(File, u64)> {
    let open = || {
        // Asked before opening: to open a pipe waits for its other end.
        check_regular(&fs::metadata(path)?)?;
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        check_regular(&metadata)?;
        inputs::note(path);
        Ok((file, metadata.len()))
    };
    open().map_err(|source| refused(path, source))
}

fn refused(path: &Path, source: io::Error) -> Error {
    Error::Read { path: path.to_owned(), source }
}

/// Fails for a folder, in the words that [`regular_file`] has for one.
pub fn refuse_folder(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => check_regular(&metadata),
        _ => Ok(()),
    }
    .map_err(|source| refused(path, source))
}

/// The content of a file that a scene names, unpacked. It is charged to the scene's memory budget.
pub(crate) fn content(path: &Path, report: &mut Report) -> Checked<Vec<u8>> {
    // The step that is followed is the reading of the file that names it.
    let bytes = regular_file(path, report.budget.left(), &OnlyStops(report.watch))?;
    report.budget.charge_read(path, bytes.len())?;
    report.source.further.push(path.to_owned());
    Ok(gzip::unpacked(bytes.into(), report)?.into_owned())
}

/// The content of a sibling; a file that cannot be read is no more than a warning. So is a stop
/// here, which the reader of the whole then notices.
///
/// # Errors
///
/// In words, why it cannot be read.
pub(crate) fn sibling_content(
    path: &Path,
    report: &mut Report,
) -> std::result::Result<Vec<u8>, String> {
    content(path, report).map_err(|fault| fault.into_error(path).to_string())
}

fn check_regular(metadata: &fs::Metadata) -> io::Result<()> {
    let what = if metadata.is_file() {
        return Ok(());
    } else if metadata.is_dir() {
        "a folder, not a file"
    } else {
        "a device or a pipe, not a regular file"
    };
    Err(io::Error::new(io::ErrorKind::InvalidInput, what))
}

/// The file that a scene at `scene` calls `name`, which must lie under the scene's folder, or under
/// one of the folders that the user allows. There it is looked for too: by its whole name, and by
/// the last part of it, since names are often of another machine.
///
/// # Errors
///
/// In words, why it is refused or cannot be found.
pub(crate) fn sibling(
    scene: &Path,
    name: &str,
    allowed: &[PathBuf],
) -> std::result::Result<PathBuf, String> {
    // As programs on Windows write it.
    let name = name.replace('\\', "/");
    let refused = check_name(&name).err();
    if let Some(refused) = refused
        && (allowed.is_empty() || !refused.is_mended_by_folder)
    {
        let hint = if refused.is_mended_by_folder {
            ", or in a folder that is allowed (resources= in Python, --resources, --allow-parent)"
        } else {
            ""
        };
        return Err(format!("{}{hint}", refused.why));
    }
    let folder = folder_of(scene)?;
    let mut tops = vec![folder.clone()];
    for folder in allowed {
        let wrong = |error: io::Error| format!("the folder {}: {error}", escaped(folder));
        tops.push(folder.canonicalize().map_err(wrong)?);
    }
    let last = name.rsplit('/').next().filter(|last| check_name(last).is_ok());
    let is_relative = !name.starts_with('/') && !name.contains(':');
    let beside = is_relative.then(|| folder.join(&name));
    let within = tops.iter().skip(1).flat_map(|top| {
        let whole = refused.is_none().then(|| top.join(&name));
        [whole, last.map(|last| top.join(last))]
    });
    let mut reason = None;
    for path in [beside].into_iter().chain(within).flatten() {
        match within_any(&path, &tops) {
            Ok(path) => return Ok(path),
            Err(why) => reason = reason.or(Some(why)),
        }
    }
    Err(reason.unwrap_or_else(|| "not found in the folders that are allowed".to_owned()))
}

/// The reason why a path is refused whose name is not.
const OUTSIDE: &str = "refused: it leads outside the folder";

/// A regular file in canonical form, so that no symbolic link leads out of the folders.
fn within_any(path: &Path, tops: &[PathBuf]) -> std::result::Result<PathBuf, String> {
    let path = path.canonicalize().map_err(|error| error.to_string())?;
    if !tops.iter().any(|top| path.starts_with(top)) {
        return Err(OUTSIDE.to_owned());
    }
    let metadata = fs::metadata(&path).map_err(|error| error.to_string())?;
    check_regular(&metadata).map_err(|error| error.to_string())?;
    Ok(path)
}

/// The folder of a file, in canonical form.
fn folder_of(scene: &Path) -> std::result::Result<PathBuf, String> {
    let folder = match scene.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    folder.canonicalize().map_err(|error| error.to_string())
}

/// The file that `name` is in `folder` or below, where nothing else may be read.
///
/// # Errors
///
/// In words, why it is refused or cannot be found.
pub fn within(folder: &Path, name: &str) -> std::result::Result<PathBuf, String> {
    check_plain_name(name)?;
    let top = folder.canonicalize().map_err(|error| error.to_string())?;
    within_any(&top.join(name), &[top])
}

/// The file that a scene at `scene` wants written as `name`, under the scene's folder. It need not
/// be there, nor need its folder.
///
/// # Errors
///
/// In words, why it is refused.
pub fn sibling_to_be(scene: &Path, name: &str) -> std::result::Result<PathBuf, String> {
    check_plain_name(name)?;
    let path = scene.parent().unwrap_or(Path::new("")).join(name);
    let top = folder_of(scene)?;
    // The parts of the path that exist must not lead out of the folder. The others cannot be links.
    let there = path.ancestors().find_map(|part| part.canonicalize().ok());
    let is_within = there.is_none_or(|there| there.starts_with(&top));
    let is_link = path.ancestors().any(|part| part.is_symlink() && part.canonicalize().is_err());
    if !is_within || is_link {
        return Err(OUTSIDE.to_owned());
    }
    // To write to a FIFO waits for a reader, and a device is no place for a picture.
    if path.metadata().is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return Err("refused: it is no regular file".to_owned());
    }
    Ok(path)
}

/// Refuses a name as [`check_name`] does, and backslashes.
fn check_plain_name(name: &str) -> std::result::Result<(), String> {
    if name.contains('\\') {
        return Err("refused: the name has a backslash; folders are separated by /".to_owned());
    }
    Ok(check_name(name).map_err(|refused| refused.why)?)
}

/// The reason why a name is refused.
#[derive(Debug, Clone, Copy)]
struct Refused {
    why: &'static str,
    /// Whether it may be found in a folder that the user allows.
    is_mended_by_folder: bool,
}

/// Refuses every name that is not plainly a relative path downwards, on any system.
fn check_name(name: &str) -> std::result::Result<(), Refused> {
    let mut is_mended_by_folder = false;
    let why = if name.is_empty() {
        "refused: the name is empty"
    } else if name.chars().any(char::is_control) {
        "refused: the name has a control character"
    } else if name.contains("://") {
        "refused: the name has a scheme; only relative paths are read"
    } else {
        is_mended_by_folder = true;
        if name.contains(':') {
            "refused: the name has a scheme or a drive; only relative paths are read"
        } else if name.starts_with('/') {
            "refused: the path is absolute; only relative paths are read"
        } else if name.split('/').any(|component| component == "..") {
            "refused: the path has ..; only files in the same folder and below are read and written"
        } else {
            return Ok(());
        }
    };
    Err(Refused { why, is_mended_by_folder })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_elsewhere_are_refused() {
        for name in [
            "",
            "/etc/passwd",
            "../x",
            "..\\x",
            "\\x",
            "a/../../x",
            "C:x",
            "http://h/x",
            "file:///etc/passwd",
            "a\0b",
        ] {
            let reason = sibling(Path::new("scene.obj"), name, &[]).unwrap_err();
            assert!(reason.starts_with("refused"), "{name}: {reason}");
            let reason = within(Path::new("."), name).unwrap_err();
            assert!(reason.starts_with("refused"), "{name}: {reason}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_folder_are_refused_and_links_within_are_not() {
        let top = tempfile::tempdir().unwrap();
        let folder = top.path().join("scene");
        fs::create_dir(&folder).unwrap();
        fs::write(top.path().join("secret"), "x").unwrap();
        fs::write(folder.join("inner"), "x").unwrap();
        std::os::unix::fs::symlink("../secret", folder.join("out")).unwrap();
        std::os::unix::fs::symlink("inner", folder.join("in")).unwrap();
        let scene = folder.join("a.obj");
        assert!(sibling(&scene, "out", &[]).unwrap_err().contains("outside"));
        assert!(sibling(&scene, "in", &[]).unwrap().ends_with("inner"));
        assert!(sibling(&scene, ".", &[]).unwrap_err().contains("folder"));
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_is_allowed_opens_itself_and_nothing_else() {
        let top = tempfile::tempdir().unwrap();
        for folder in ["model", "textures", "other"] {
            fs::create_dir(top.path().join(folder)).unwrap();
        }
        let textures = top.path().join("textures");
        fs::write(top.path().join("other/secret.png"), "x").unwrap();
        fs::write(textures.join("wood.png"), "x").unwrap();
        std::os::unix::fs::symlink("../other/secret.png", textures.join("out.png")).unwrap();
        let (scene, allowed) = (top.path().join("model/a.obj"), [textures]);
        for name in [
            "../textures/wood.png",
            "..\\textures\\wood.png",
            "wood.png",
            "maps/wood.png",
            "C:\\Users\\me\\wood.png",
            "/srv/models/wood.png",
        ] {
            let path = sibling(&scene, name, &allowed).unwrap();
            assert!(path.ends_with("textures/wood.png"), "{name}");
        }
        for name in [
            "../other/secret.png",
            "../textures/../other/secret.png",
            "../textures/out.png",
            "out.png",
            "secret.png",
            "/etc/passwd",
            "http://host/wood.png",
            "..",
            "../textures/",
        ] {
            assert!(sibling(&scene, name, &allowed).is_err(), "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused() {
        let error = regular_file(Path::new("/dev/zero"), u64::MAX, &()).unwrap_err();
        assert!(error.to_string().contains("device"), "{error}");
    }
}
