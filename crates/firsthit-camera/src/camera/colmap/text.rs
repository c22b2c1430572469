//! `cameras.txt` and `images.txt`.

use std::path::Path;
use std::str::FromStr;

use super::{Image, InWords, Intrinsics, Model, shown, wrong};
use crate::error::{Place, Result};

/// The cameras by their numbers, in the order of the file.
pub(super) fn cameras(data: &[u8], path: &Path) -> Result<Vec<(u32, Intrinsics)>> {
    let mut cameras = Vec::new();
    for (line, content) in lines(data, path)? {
        if content.is_empty() {
            continue;
        }
        let place = Place::Line(line);
        let camera = camera(content, place.clone());
        cameras.push(camera.map_err(|what| wrong(path, place, what))?);
    }
    Ok(cameras)
}

/// The images, in the order of the file. Each is a line, and the line after it has its points, or
/// is empty. Files of known poses often lack the second lines.
pub(super) fn images(data: &[u8], path: &Path) -> Result<Vec<Image>> {
    let mut images = Vec::new();
    let mut may_be_points = false;
    for (line, content) in lines(data, path)? {
        let is_passed = content.is_empty() || (may_be_points && are_points(content));
        may_be_points = !is_passed;
        if is_passed {
            continue;
        }
        let place = Place::Line(line);
        let image = image(content, place.clone());
        images.push(image.map_err(|what| wrong(path, place, what))?);
    }
    Ok(images)
}

/// Whether a line has the points of an image, `X Y POINT3D_ID` each. An image's line has ten words,
/// and more only where its name has blanks.
fn are_points(line: &str) -> bool {
    let words = || line.split_whitespace();
    words().count().is_multiple_of(3) && words().all(|word| word.parse::<f64>().is_ok())
}

/// The lines with their numbers, without blanks around them. Comments are left out.
fn lines<'a>(data: &'a [u8], path: &Path) -> Result<impl Iterator<Item = (u64, &'a str)>> {
    let data = data.strip_prefix(b"\xef\xbb\xbf").unwrap_or(data);
    let text = str::from_utf8(data).map_err(|error| {
        let place = Place::Byte(error.valid_up_to() as u64);
        wrong(path, place, "the file must be UTF-8 text")
    })?;
    let lines = text.lines().map(str::trim);
    let numbered = (1..).zip(lines);
    Ok(numbered.filter(|(_, line)| !line.starts_with('#')))
}

/// A camera's line: `CAMERA_ID MODEL WIDTH HEIGHT PARAMS`.
fn camera(line: &str, place: Place) -> InWords<(u32, Intrinsics)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [number, name, width, height, ref parameters @ ..] = words[..] else {
        return Err("expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS".to_owned());
    };
    let model = Model::of(&shown(name), |_, own| own == name)?;
    let wanted = model.parameters();
    if parameters.len() != wanted.len() {
        return Err(format!(
            "{name} must have {} parameters ({}), got {}",
            wanted.len(),
            wanted.join(", "),
            parameters.len()
        ));
    }
    let size = [parsed(width, WHOLE)?, parsed(height, WHOLE)?];
    let numbers: InWords<Vec<f64>> = parameters.iter().map(|word| parsed(word, NUMBER)).collect();
    let camera = Intrinsics::new(model, size, numbers?, place)?;
    Ok((parsed(number, WHOLE)?, camera))
}

/// An image's line: `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`. The name is the rest of it,
/// blanks and all.
fn image(line: &str, place: Place) -> InWords<Image> {
    let mut rest = line;
    let mut word = || -> InWords<&str> {
        let end = rest.find(char::is_whitespace);
        let (first, after) = end.map_or((rest, ""), |end| rest.split_at(end));
        rest = after.trim_start();
        let is_there = !first.is_empty();
        let expected = "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME";
        is_there.then_some(first).ok_or_else(|| expected.to_owned())
    };
    let _: u32 = parsed(word()?, WHOLE)?;
    let mut pose = [0.0; 7];
    for number in &mut pose {
        *number = parsed(word()?, NUMBER)?;
    }
    let camera = parsed(word()?, WHOLE)?;
    // One more word must be there, with which the name begins.
    let name = rest;
    if name.is_empty() {
        return Err("expected a NAME after the CAMERA_ID".to_owned());
    }
    Image::new(name.to_owned(), camera, pose, place)
}

const WHOLE: &str = "a whole number";
const NUMBER: &str = "a number";

fn parsed<T: FromStr>(word: &str, expected: &str) -> InWords<T> {
    word.parse().map_err(|_| format!("expected {expected}, got {}", shown(word)))
}
