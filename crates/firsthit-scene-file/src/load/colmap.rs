//! The files of a reconstruction by COLMAP.

use std::path::{Path, PathBuf};

use crate::camera::ColmapImages;
use crate::error::{Error, Place, Result};
use crate::io::read::regular_file;

/// The largest size of each file, in bytes: the points of ten thousand images may come to half of
/// it.
const LARGEST: u64 = 1 << 32;

/// The files of cameras and images in the folder of a reconstruction: binary ones, or else text.
/// Neither may be elsewhere, as by a symbolic link.
///
/// # Errors
///
/// [`Error::Read`] if the system refuses, and [`Error::Parse`] for a folder without these files.
pub fn colmap_files(folder: &Path) -> Result<[PathBuf; 2]> {
    let wrong = |path: &Path, what: &str| Error::Parse {
        path: path.to_owned(),
        place: Place::File,
        what: what.to_owned(),
    };
    let real = |path: &Path| {
        path.canonicalize().map_err(|source| Error::Read { path: path.to_owned(), source })
    };
    let top = real(folder)?;
    if !top.is_dir() {
        return Err(wrong(folder, "expected the folder of a COLMAP reconstruction"));
    }
    let named = |suffix| ["cameras", "images"].map(|name| folder.join(name).with_extension(suffix));
    let mut pairs = ["bin", "txt"].into_iter().map(named);
    // A link that leads nowhere is there: it is an error, and no reason to read the others.
    let is_there = |pair: &[PathBuf; 2]| pair.iter().all(|path| path.symlink_metadata().is_ok());
    let Some(pair) = pairs.find(is_there) else {
        let expected =
            "expected cameras.bin and images.bin, or cameras.txt and images.txt in the folder";
        return Err(wrong(folder, expected));
    };
    for path in &pair {
        if !real(path)?.starts_with(&top) {
            let what = "refused: it leads outside the reconstruction's folder";
            return Err(wrong(path, what));
        }
    }
    Ok(pair)
}

/// Reads the cameras of a reconstruction by COLMAP from the files of cameras and of images, which
/// are then inputs.
///
/// # Errors
///
/// [`Error::Read`] if the system refuses, and the errors of [`ColmapImages::read`].
pub fn read_colmap([cameras, images]: [&Path; 2]) -> Result<ColmapImages> {
    let content = [regular_file(cameras, LARGEST, &())?, regular_file(images, LARGEST, &())?];
    ColmapImages::read(content.each_ref().map(Vec::as_slice), [cameras, images])
}
