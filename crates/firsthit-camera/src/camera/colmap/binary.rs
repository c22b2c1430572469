//! `cameras.bin` and `images.bin`, in little-endian.

use std::path::Path;

use super::{Image, Intrinsics, Model, wrong};
use crate::error::{Error, Place, Result};

/// The cameras by their numbers, in the order of the file.
pub(super) fn cameras(data: &[u8], path: &Path) -> Result<Vec<(u32, Intrinsics)>> {
    /// A camera's bytes but for its parameters.
    const LEAST: u64 = 24;
    let mut file = Bytes::new(data, path);
    let mut cameras = Vec::new();
    for _ in 0..file.count(LEAST)? {
        let place = file.place();
        let wrong_here = |what| wrong(path, place.clone(), what);
        let number = u32::from_le_bytes(file.take()?);
        let model = i32::from_le_bytes(file.take()?);
        let model = Model::of(&format!("number {model}"), |own, _| own == model);
        let model = model.map_err(wrong_here)?;
        let size = [u64::from_le_bytes(file.take()?), u64::from_le_bytes(file.take()?)];
        let mut numbers = Vec::new();
        for _ in model.parameters() {
            numbers.push(f64::from_le_bytes(file.take()?));
        }
        let camera = Intrinsics::new(model, size, numbers, place.clone());
        cameras.push((number, camera.map_err(wrong_here)?));
    }
    file.end()?;
    Ok(cameras)
}

/// The images, in the order of the file.
pub(super) fn images(data: &[u8], path: &Path) -> Result<Vec<Image>> {
    /// An image's bytes but for its name and its points.
    const LEAST: u64 = 73;
    /// A point's: where it is in the image, and its number.
    const OF_POINT: u64 = 24;
    let mut file = Bytes::new(data, path);
    let mut images = Vec::new();
    for _ in 0..file.count(LEAST)? {
        let place = file.place();
        let _: [u8; 4] = file.take()?;
        let mut pose = [0.0; 7];
        for number in &mut pose {
            *number = f64::from_le_bytes(file.take()?);
        }
        let camera = u32::from_le_bytes(file.take()?);
        let name = file.text()?;
        let points = u64::from_le_bytes(file.take()?);
        file.skip(points, OF_POINT)?;
        let image = Image::new(name, camera, pose, place.clone());
        images.push(image.map_err(|what| wrong(path, place, what))?);
    }
    file.end()?;
    Ok(images)
}

/// A file, from its beginning on.
struct Bytes<'a> {
    path: &'a Path,
    whole: usize,
    rest: &'a [u8],
}

impl<'a> Bytes<'a> {
    fn new(data: &'a [u8], path: &'a Path) -> Self {
        let whole = data.len();
        Self { path, whole, rest: data }
    }

    fn place(&self) -> Place {
        Place::Byte((self.whole - self.rest.len()) as u64)
    }

    fn wrong(&self, what: impl Into<String>) -> Error {
        wrong(self.path, self.place(), what)
    }

    fn cut_off(&self) -> Error {
        self.wrong("the file is cut off")
    }

    /// The next bytes.
    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let Some((&taken, rest)) = self.rest.split_first_chunk() else {
            return Err(self.cut_off());
        };
        self.rest = rest;
        Ok(taken)
    }

    /// Reads the number of entries, each of at least `least` bytes.
    fn count(&mut self, least: u64) -> Result<u64> {
        let count = u64::from_le_bytes(self.take()?);
        if count > self.rest.len() as u64 / least {
            return Err(self.wrong(format!(
                "the file says that it has {count} entries, and is too short for them"
            )));
        }
        Ok(count)
    }

    /// Text up to a zero. Bytes that are not UTF-8 are replaced.
    fn text(&mut self) -> Result<String> {
        let end = self.rest.iter().position(|&byte| byte == 0);
        let Some((text, [_, rest @ ..])) = end.and_then(|end| self.rest.split_at_checked(end))
        else {
            return Err(self.cut_off());
        };
        self.rest = rest;
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    /// Checks that all has been read. More would say that the count is too small, and that images
    /// are missing.
    fn end(&self) -> Result<()> {
        if self.rest.is_empty() {
            return Ok(());
        }
        let more = self.rest.len();
        Err(self.wrong(format!("expected the file to end, got {more} more bytes")))
    }

    /// Skips `count` entries of `size` bytes.
    fn skip(&mut self, count: u64, size: u64) -> Result<()> {
        let bytes = count.checked_mul(size).map(usize::try_from);
        let Some(Ok(bytes)) = bytes else {
            return Err(self.cut_off());
        };
        self.rest = self.rest.get(bytes..).ok_or_else(|| self.cut_off())?;
        Ok(())
    }
}
