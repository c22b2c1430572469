//! COLMAP's cameras and images, in text and in binary: <https://colmap.github.io/format.html>.
//! Opening files is for others.
//!
//! Files are untrusted: no count in them sizes an allocation.

// A reader that panics is a reader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

mod binary;
mod export;
mod text;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::{Camera, Convention, Lens, PixelMatrix, Projection};
use crate::error::{Error, Place, Result, escape_controls};

pub use export::ColmapCamera;

/// A result whose error says in words what is wrong with an entry of a file.
type InWords<T> = std::result::Result<T, String>;

/// A camera model of COLMAP that a projection of this library is.
///
/// ```
/// use firsthit::camera::ColmapModel;
///
/// let model = ColmapModel::ALL.iter().find(|model| model.name == "FOV").unwrap();
/// assert_eq!((model.number, model.projection.name()), (7, "fov"));
/// assert_eq!(model.parameters, ["fx", "fy", "cx", "cy", "omega"]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColmapModel {
    /// The number in binary files.
    pub number: i32,
    /// The name in text files.
    pub name: &'static str,
    /// The parameters in COLMAP's order, by the names that the projection has for them; `f` is both
    /// `fx` and `fy`.
    pub parameters: &'static [&'static str],
    /// The projection.
    pub projection: Projection,
}

/// Makes the list of models.
macro_rules! models {
    ($($number:literal $name:ident => $projection:ident: $($parameter:ident)*;)*) => {
        impl ColmapModel {
            /// All models, by their numbers.
            pub const ALL: &'static [Self] = &[$(Self {
                number: $number,
                name: stringify!($name),
                parameters: &[$(stringify!($parameter)),*],
                projection: Projection::$projection,
            }),*];
        }
    };
}

models! {
    0 SIMPLE_PINHOLE => Perspective: f cx cy;
    1 PINHOLE => Perspective: fx fy cx cy;
    2 SIMPLE_RADIAL => OpenCv: f cx cy k1;
    3 RADIAL => OpenCv: f cx cy k1 k2;
    4 OPENCV => OpenCv: fx fy cx cy k1 k2 p1 p2;
    5 OPENCV_FISHEYE => OpenCvFisheye: fx fy cx cy k1 k2 k3 k4;
    6 FULL_OPENCV => OpenCv: fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6;
    7 FOV => Fov: fx fy cx cy omega;
    8 SIMPLE_RADIAL_FISHEYE => OpenCvFisheye: f cx cy k1;
    9 RADIAL_FISHEYE => OpenCvFisheye: f cx cy k1 k2;
    10 THIN_PRISM_FISHEYE => ThinPrismFisheye: fx fy cx cy k1 k2 p1 p2 k3 k4 sx1 sy1;
    11 RAD_TAN_THIN_PRISM_FISHEYE => RadTanThinPrismFisheye: fx fy cx cy k0 k1 k2 k3 k4 k5 p0 p1 s0 s1 s2 s3;
    14 SIMPLE_FISHEYE => Equidistant: f cx cy;
    15 FISHEYE => Equidistant: fx fy cx cy;
    16 EUCM => Eucm: fx fy cx cy alpha beta;
}

/// The model of a camera in a file.
#[derive(Debug, Clone, Copy)]
enum Model {
    /// A model that is a projection of this library.
    Known(&'static ColmapModel),
    /// A model that is none: a camera of it can be passed over, and not be used.
    Other(&'static Unsupported),
}

/// A model that COLMAP has, and that no projection here is: its number, its name and its
/// parameters.
type Unsupported = (i32, &'static str, &'static [&'static str]);

const UNSUPPORTED: &[Unsupported] = &[
    (12, "SIMPLE_DIVISION", &["f", "cx", "cy", "k"]),
    (13, "DIVISION", &["fx", "fy", "cx", "cy", "k"]),
    (17, "EQUIRECTANGULAR", &["w", "h"]),
];

impl Model {
    /// The model that `is_it` says is the one.
    ///
    /// # Errors
    ///
    /// In words, that there is none of the name or number that is `shown`.
    fn of(shown: &str, is_it: impl Fn(i32, &str) -> bool) -> InWords<Self> {
        let mut known = ColmapModel::ALL.iter();
        if let Some(model) = known.find(|model| is_it(model.number, model.name)) {
            return Ok(Self::Known(model));
        }
        let mut others = UNSUPPORTED.iter();
        if let Some(model) = others.find(|(number, name, _)| is_it(*number, name)) {
            return Ok(Self::Other(model));
        }
        let names: Vec<&str> = ColmapModel::ALL.iter().map(|model| model.name).collect();
        let names = names.join(", ");
        Err(format!("the model must be one of {names}, got {shown}"))
    }

    /// The names of its parameters, in the file's order.
    fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Known(model) => model.parameters,
            Self::Other((_, _, parameters)) => parameters,
        }
    }
}

/// The cameras of a reconstruction by COLMAP: one for each image.
///
/// ```
/// use std::path::Path;
///
/// use firsthit::camera::ColmapImages;
///
/// let cameras = b"# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n1 PINHOLE 640 480 500 500 320 240\n";
/// let images = b"1 1 0 0 0 0 0 5 1 front.jpg\n\n";
/// let paths = [Path::new("cameras.txt"), Path::new("images.txt")];
/// let images = ColmapImages::read([cameras, images], paths)?;
/// assert_eq!(images.names().collect::<Vec<_>>(), ["front.jpg"]);
/// let camera = images.camera("front.jpg").unwrap()?;
/// assert_eq!(camera.position().z, -5.0);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ColmapImages {
    paths: [PathBuf; 2],
    cameras: HashMap<u32, Intrinsics>,
    images: Vec<Image>,
}

/// A camera of the first file.
#[derive(Debug, Clone)]
struct Intrinsics {
    model: Model,
    /// Rows and columns.
    size: [usize; 2],
    numbers: Vec<f64>,
    place: Place,
}

/// An image of the second file.
#[derive(Debug, Clone)]
struct Image {
    name: String,
    camera: u32,
    /// The pose from the world to the camera: a quaternion, real part first, and a translation.
    pose: [f64; 7],
    place: Place,
}

impl ColmapImages {
    /// Reads the content of `cameras.txt` or `cameras.bin`, and that of `images.txt` or
    /// `images.bin`. The extensions of `paths` say which; else they are only what errors call the
    /// files.
    ///
    /// # Errors
    ///
    /// [`Error::Parse`] with its place for what is wrong in a file: what is cut off or no number,
    /// counts that the file has no room for, numbers that are not finite, a model that COLMAP does
    /// not have, a camera or an image's name that is there twice, and an image of a camera that is
    /// not there.
    pub fn read([cameras, images]: [&[u8]; 2], paths: [&Path; 2]) -> Result<Self> {
        let is_binary = |path: &Path| path.extension().is_some_and(|name| name == "bin");
        let [of_cameras, of_images] = paths;
        let listed = if is_binary(of_cameras) {
            binary::cameras(cameras, of_cameras)?
        } else {
            text::cameras(cameras, of_cameras)?
        };
        let mut cameras = HashMap::new();
        for (number, camera) in listed {
            let place = camera.place.clone();
            if cameras.insert(number, camera).is_some() {
                let what = format!("camera {number} is there twice");
                return Err(wrong(of_cameras, place, what));
            }
        }
        let images = if is_binary(of_images) {
            binary::images(images, of_images)?
        } else {
            text::images(images, of_images)?
        };
        for image in &images {
            if !cameras.contains_key(&image.camera) {
                let what = format!("there is no camera {}", image.camera);
                return Err(image.wrong(of_images, what));
            }
        }
        // Stable, so that of two the later is the second.
        let mut by_name: Vec<&Image> = images.iter().collect();
        by_name.sort_by_key(|image| &image.name);
        let twice = by_name.windows(2).find_map(|pair| match pair {
            [first, second] if first.name == second.name => Some(*second),
            _ => None,
        });
        if let Some(image) = twice {
            return Err(image.wrong(of_images, "the name is there twice"));
        }
        Ok(Self { paths: paths.map(Path::to_owned), cameras, images })
    }

    /// The images' names, in the order of the file.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.images.iter().map(|image| &*image.name)
    }

    /// The camera of the image of a name; `None` where there is no such image.
    ///
    /// # Errors
    ///
    /// [`Error::Parse`] for numbers that no camera has, as [`Camera::new`] refuses them, and for
    /// the models that are not in [`ColmapModel::ALL`].
    pub fn camera(&self, name: &str) -> Option<Result<Camera>> {
        let image = self.images.iter().find(|image| image.name == name)?;
        Some(self.camera_of(image))
    }

    /// The models that are none of [`ColmapModel::ALL`], for each image in the order of
    /// [`names`](Self::names) whose camera has one.
    pub fn unsupported(&self) -> impl Iterator<Item = Option<&'static str>> {
        let model = |image: &Image| self.cameras.get(&image.camera).map(|camera| camera.model);
        self.images.iter().map(move |image| match model(image)? {
            Model::Known(_) => None,
            Model::Other((_, name, _)) => Some(*name),
        })
    }

    /// The cameras of all images, in the order of [`names`](Self::names).
    ///
    /// # Errors
    ///
    /// As [`camera`](Self::camera).
    pub fn cameras(&self) -> impl Iterator<Item = Result<Camera>> {
        self.images.iter().map(|image| self.camera_of(image))
    }

    fn camera_of(&self, image: &Image) -> Result<Camera> {
        let [of_cameras, of_images] = &self.paths;
        let Some(intrinsics) = self.cameras.get(&image.camera) else {
            let what = format!("there is no camera {}", image.camera);
            return Err(image.wrong(of_images, what));
        };
        let in_file = |error: Error| {
            let place = intrinsics.place.clone();
            wrong(of_cameras, place, error.to_string())
        };
        let model = match intrinsics.model {
            Model::Known(model) => model,
            Model::Other((_, model, _)) => {
                let image = shown(&image.name);
                let what = format!("the model {model} of image {image} is not supported");
                return Err(wrong(of_cameras, intrinsics.place.clone(), what));
            }
        };
        let lens = intrinsics.lens(model).map_err(in_file)?;
        let [rows, columns] = intrinsics.size;
        // The lens alone, so that what is wrong with it is told of its own file.
        Camera::new(super::View { rows, columns, lens, ..super::View::default() })
            .map_err(in_file)?;
        let pose = Convention::Colmap.pose(matrix(&image.pose));
        let camera = pose.and_then(|pose| Camera::at_pose(&pose, lens, rows, columns));
        camera.map_err(|error| image.wrong(of_images, error.to_string()))
    }
}

impl Intrinsics {
    /// A camera, if its numbers can be one's.
    ///
    /// # Errors
    ///
    /// In words, why they cannot.
    fn new(
        model: Model,
        [columns, rows]: [u64; 2],
        numbers: Vec<f64>,
        place: Place,
    ) -> InWords<Self> {
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(format!("parameters must be finite, got {number}"));
        }
        let pixels = |count: u64| usize::try_from(count).ok().filter(|&count| count > 0);
        let (Some(rows), Some(columns)) = (pixels(rows), pixels(columns)) else {
            return Err(format!("width and height must be positive, got {columns} and {rows}"));
        };
        Ok(Self { model, size: [rows, columns], numbers, place })
    }

    fn lens(&self, model: &ColmapModel) -> Result<Lens> {
        let (mut matrix, mut others) = (PixelMatrix::default(), Vec::new());
        for (&name, &value) in model.parameters.iter().zip(&self.numbers) {
            match name {
                "f" => (matrix.fx, matrix.fy) = (value, value),
                "fx" => matrix.fx = value,
                "fy" => matrix.fy = value,
                "cx" => matrix.cx = value,
                "cy" => matrix.cy = value,
                other => others.push((other, value)),
            }
        }
        matrix.lens(model.projection, &others, self.size)
    }
}

impl Image {
    /// An image, if its pose is one.
    ///
    /// # Errors
    ///
    /// In words, why it is not.
    fn new(name: String, camera: u32, pose: [f64; 7], place: Place) -> InWords<Self> {
        let [w, x, y, z, ..] = pose;
        let square = w * w + x * x + y * y + z * z;
        let is_turned = square > 0.0 && square.is_finite();
        if !is_turned || pose.iter().any(|number| !number.is_finite()) {
            return Err(format!("a pose must be a quaternion and a translation, got {pose:?}"));
        }
        Ok(Self { name, camera, pose, place })
    }

    fn wrong(&self, path: &Path, what: impl AsRef<str>) -> Error {
        let what = format!("image {}: {}", shown(&self.name), what.as_ref());
        wrong(path, self.place.clone(), what)
    }
}

/// Camera from world of a quaternion of any length, real part first, and a translation.
fn matrix(&[w, x, y, z, ref t @ ..]: &[f64; 7]) -> [[f64; 4]; 4] {
    let s = 2.0 / (w * w + x * x + y * y + z * z);
    let &[t_x, t_y, t_z] = t;
    #[rustfmt::skip]
    let rows = [
        [1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), t_x],
        [s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x), t_y],
        [s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y), t_z],
        [0.0, 0.0, 0.0, 1.0],
    ];
    rows
}

/// A word of a file for a message, within quotes; of a long one its beginning.
fn shown(word: &str) -> String {
    const MOST: usize = 80;
    let start: String = word.chars().take(MOST).collect();
    let more = if start.len() < word.len() { "..." } else { "" };
    format!("'{}{more}'", escape_controls(&start))
}

/// The error that something is wrong at a place of a file.
fn wrong(path: &Path, place: Place, what: impl Into<String>) -> Error {
    let (path, what) = (path.to_owned(), what.into());
    Error::Parse { path, place, what }
}

#[cfg(test)]
mod tests;
