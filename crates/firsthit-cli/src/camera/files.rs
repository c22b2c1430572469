//! Cameras that files have: models, outputs, reconstructions, and poses as text.

use std::path::Path;

use firsthit::camera::{Description, orthonormalised, rounded_pose};
use firsthit::error::{escape_controls, escaped};
use firsthit::sensor::camera_of;
use firsthit::world::{NamedCamera, World};
use firsthit::{Camera, load};

use crate::args::CameraArgs;
use crate::console::{in_words, warn};
use crate::failure::Failure;

/// The output that is named as the camera.
fn output(args: &CameraArgs) -> Option<&Path> {
    let path = Path::new(args.camera.as_deref()?);
    let is_output = firsthit::image::format_of(path).is_ok();
    (is_output && path.is_file()).then_some(path)
}

/// The camera that made the output that is named as the camera, if one is.
pub(super) fn of_output(args: &CameraArgs) -> Result<Option<Camera>, Failure> {
    let Some(path) = output(args) else {
        return Ok(None);
    };
    let read = firsthit::image::read(path)?;
    firsthit::inputs::note(path);
    let record = read.metadata.and_then(|metadata| metadata.camera);
    let Some(record) = record else {
        return Err(Failure::bad_input(format!(
            "{}: the file does not say which camera made it",
            escaped(path)
        )));
    };
    Ok(Some(camera_of(&record)?))
}

/// The camera of an image of a reconstruction, if one is named.
pub(super) fn of_colmap(args: &CameraArgs) -> Result<Option<Camera>, Failure> {
    let Some(folder) = &args.colmap else {
        return Ok(None);
    };
    let [cameras, images] = &load::colmap_files(folder)?;
    let reconstruction = load::read_colmap([cameras, images])?;
    let named = args.image.as_ref().map(|name| reconstruction.camera(name));
    if let Some(Some(camera)) = named {
        return Ok(Some(camera?));
    }
    let what = match &args.image {
        Some(name) => format!("--image '{}'", escape_controls(name)),
        None => "--colmap needs --image".to_owned(),
    };
    let names = reconstruction.names();
    let there = if names.len() == 0 {
        "no images".to_owned()
    } else {
        in_words(names.map(escape_controls))
    };
    let images = escaped(images);
    Err(Failure::usage(format!("{what}: {images} has {there}")))
}

/// The file's description of the camera that is asked for, or that it is to be looked through.
pub(crate) fn of_file(args: &CameraArgs, model: &World) -> Result<Description, Failure> {
    if args.colmap.is_some() || output(args).is_some() {
        return Ok(Description::default());
    }
    let camera = match &args.camera {
        Some(name) => Some(named(name, &model.cameras)?),
        None => model.cameras.first().filter(|_| model.has_view),
    };
    Ok(camera.map_or_else(Description::default, |camera| camera.described(args.size)))
}

/// The camera of a name, or else of another name that it goes by, or else of a number.
fn named<'a>(name: &str, cameras: &'a [NamedCamera]) -> Result<&'a NamedCamera, Failure> {
    if name.is_empty() {
        return Err(Failure::usage(
            "--camera: the name is empty; use the number of a camera without a name",
        ));
    }
    let called = |of: &dyn Fn(&NamedCamera) -> bool| -> Vec<usize> {
        let all = cameras.iter().enumerate();
        all.filter(|(_, camera)| of(camera)).map(|(k, _)| k).collect()
    };
    let mut found = called(&|camera| camera.name == name);
    if found.is_empty() {
        found = called(&|camera| camera.own_name == name);
    }
    if found.is_empty() {
        let number: Option<usize> = name.parse().ok();
        found.extend(number.filter(|&number| number < cameras.len()));
    }
    if let &[number] = &found[..] {
        return Ok(&cameras[number]);
    }
    let shown = escape_controls(name);
    Err(Failure::usage(match (cameras.len(), found.len()) {
        (_, 0) if firsthit::image::format_of(Path::new(name)).is_ok() => {
            format!("--camera '{shown}': there is no such file, and no camera of this name")
        }
        (0, _) => format!("--camera '{shown}': the file has no cameras"),
        (_, 0) => {
            let names = cameras.iter().enumerate().map(|(k, camera)| labelled(k, camera));
            let names = in_words(names);
            format!("--camera '{shown}': the file has {names}")
        }
        _ => format!(
            "--camera '{shown}': several cameras have this name, use a number: {}",
            in_words(found.iter().map(usize::to_string))
        ),
    }))
}

/// A camera by its number and name.
pub(crate) fn labelled(number: usize, camera: &NamedCamera) -> String {
    let NamedCamera { name, own_name, .. } = camera;
    match (name.is_empty(), own_name.is_empty() || own_name == name) {
        (true, _) => number.to_string(),
        (false, true) => format!("{number} {}", escape_controls(name)),
        (false, false) => {
            let (name, own_name) = (escape_controls(name), escape_controls(own_name));
            format!("{number} {name} (or {own_name})")
        }
    }
}

/// The matrix of a pose in a text file; a rotation that is rounded becomes the nearest one.
pub(crate) fn matrix_of_file(path: &Path) -> Result<[[f64; 4]; 4], Failure> {
    /// A matrix takes less than this, in bytes.
    const LARGEST: u64 = 1 << 16;
    let wrong = |what: &str| Failure::bad_input(format!("{}: {what}", escaped(path)));
    let bytes = firsthit::image::read_regular(path, LARGEST)?;
    let text = String::from_utf8_lossy(&bytes);
    let words = text.split(|c: char| c.is_whitespace() || ",;[]".contains(c));
    let numbers = words.filter(|word| !word.is_empty()).map(str::parse::<f64>);
    let numbers: Option<Vec<f64>> = numbers.map(Result::ok).collect();
    let numbers = numbers.filter(|numbers| [12, 16].contains(&numbers.len()));
    let Some(mut numbers) = numbers else {
        return Err(wrong("expected the 12 or 16 numbers of a 3 x 4 or 4 x 4 matrix, row by row"));
    };
    if numbers.len() == 12 {
        numbers.extend([0.0, 0.0, 0.0, 1.0]);
    }
    let row = |k: usize| [0, 1, 2, 3].map(|column| numbers[4 * k + column]);
    let mut pose = [row(0), row(1), row(2), row(3)];
    if let Some((turned, off)) = orthonormalised(pose) {
        warn(&[format!("{}: {}", escaped(path), rounded_pose(off))]);
        pose = turned;
    }
    Ok(pose)
}
