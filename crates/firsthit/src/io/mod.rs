//! Mesh and scene files, read with suspicion.
//!
//! A file is bytes from a stranger: no count in it sizes an allocation, no index in it is used
//! unchecked, and nothing outside its folder is opened on its word.

// A loader that panics is a loader that a file can crash.
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::indexing_slicing
    )
)]

mod decimal;
#[cfg(feature = "gltf")]
mod gltf;
mod gzip;
mod mend;
#[cfg(feature = "obj")]
mod mtl;
#[cfg(feature = "obj")]
mod obj;
#[cfg(any(feature = "gltf", feature = "obj", feature = "ply"))]
mod picture;
#[cfg(feature = "ply")]
mod ply;
mod polygon;
mod read;
mod report;
#[cfg(feature = "scene-file")]
mod scene_file;
#[cfg(feature = "stl")]
mod stl;
mod surface;
mod text;

use std::borrow::Cow;
use std::fmt::{self, Debug, Formatter};
use std::path::{Path, PathBuf};

#[cfg(feature = "scene-file")]
pub use scene_file::{nearest_word, schema};

use crate::camera::{Aim, Description, Opening, View};
use crate::error::{Error, Place, Result};
use crate::geometry::DVec3;
use crate::geometry::summary::Few;
use crate::scene::{Background, Light, Object, Scene};
use crate::shade::Shader;
use report::{Checked, Report, without_gz};

/// What a file holds.
#[derive(Clone, Default)]
pub struct Model {
    /// The objects, in the order of their identifiers. Those without materials got no colour from the file.
    pub objects: Vec<Object>,
    /// The cameras, in the file's order.
    pub cameras: Vec<NamedCamera>,
    /// The lights.
    pub lights: Vec<Light>,
    /// Whether the first camera is the one to look through where nobody asks for another: scene files say
    /// how they are to be seen, models only how they can be.
    pub has_view: bool,
    /// What rays see that meet nothing, if the file says.
    pub background: Option<Background>,
    /// How hits get their colour, if the file says.
    pub shader: Option<Shader>,
    /// How many points of a pixel make its colour, if the file says.
    pub samples: Option<u32>,
    /// The files that it asks for.
    pub outputs: Vec<Output>,
    /// The files that were read for it, itself first.
    pub files: Vec<PathBuf>,
    /// How many vertices the file has, if its objects' buffers do not tell: a buffer that several primitives or
    /// nodes of a glTF name counts for each.
    pub vertices: Option<u64>,
    /// What was doubtful in the file: a line each, ready to print.
    pub warnings: Vec<String>,
    /// Which way is up: as a scene file says, else by the format's convention: +y for OBJ, +z for STL and PLY.
    pub up: DVec3,
    /// Whether `up` is only a convention: OBJ, STL and PLY files do not say which way is up. (glTF has a rule.)
    pub up_is_guessed: bool,
}

/// A summary: the first objects, and how many there are of all else.
impl Debug for Model {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Model")
            .field("objects", &Few(&self.objects))
            .field("cameras", &self.cameras.len())
            .field("lights", &self.lights.len())
            .field("up", &self.up)
            .field("files", &self.files.len())
            .field("warnings", &self.warnings.len())
            .finish_non_exhaustive()
    }
}

impl Model {
    /// The scene of the objects and the lights, with [`Scene::up`] as the file says, or as [`Scene::likely_up`] guesses if it does
    /// not say. Cameras, background and the rest are dropped: take them before.
    ///
    /// ```
    /// use std::path::Path;
    ///
    /// use firsthit::io::{LoadSettings, load_bytes};
    ///
    /// let stl = b"solid one\nfacet normal 0 0 1\nouter loop\n\
    ///     vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid one\n";
    /// let model = load_bytes(Path::new("one.stl"), stl, &LoadSettings::default())?;
    /// let scene = model.into_scene()?;
    /// assert_eq!(scene.triangles(), 1);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`Scene::new`].
    pub fn into_scene(self) -> Result<Scene> {
        let (up, up_is_guessed) = (self.up, self.up_is_guessed);
        let scene = Scene::new(self.objects)?.with_lights(self.lights);
        let up = up_in(&scene, up, up_is_guessed);
        Ok(scene.with_up(up))
    }

    /// Which way is up in `scene`, the scene of the objects: as the file says, or as [`Scene::likely_up`] guesses if it
    /// does not say.
    pub fn up_in(&self, scene: &Scene) -> DVec3 {
        up_in(scene, self.up, self.up_is_guessed)
    }

    fn of(objects: Vec<Object>) -> Self {
        Self {
            objects,
            ..Self::default()
        }
    }
}

fn up_in(scene: &Scene, up: DVec3, is_guessed: bool) -> DVec3 {
    if is_guessed { scene.likely_up(up) } else { up }
}

/// A file that a scene file asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    /// Where it goes: in the scene file's folder or below. `{channel}` stands for a channel's name.
    pub path: PathBuf,
    /// The channels' names, at least one.
    pub channels: Vec<String>,
}

/// A camera of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCamera {
    /// Its name; may be empty. In glTF, that of its node.
    pub name: String,
    /// Another name that it goes by; may be empty. In glTF, that of the camera itself, which nodes may share.
    pub own_name: String,
    /// What it is made from.
    pub view: View,
    /// Whether the file gives the number of pixels and the shape of the viewplane too. If not, the view's height
    /// alone counts, and whoever makes the picture decides about the rest.
    pub has_size: bool,
    /// What the file says of it, where that may leave something open: whoever replaces a part of it decides the
    /// open rest anew.
    pub description: Option<Description>,
}

impl NamedCamera {
    /// The camera in words, for a picture of so many columns and rows; `None`: as many as the camera asks for,
    /// or as the shape of its viewplane does. Where the file gives no size, the viewplane keeps its height, and
    /// its width follows from square pixels.
    pub fn described(&self, size: Option<(usize, usize)>) -> Description {
        let view = self.view;
        let viewplane = view.lens.viewplane();
        let whole = Description {
            position: Some(view.position),
            aim: Some(Aim::Along(view.aim)),
            up: Some(view.up),
            opening: viewplane.map(|viewplane| Opening::Viewplane {
                width: viewplane.width,
                height: viewplane.height,
                focal_length: Some(viewplane.focal_length),
            }),
            projection: Some(view.lens.projection()),
            ray_start: viewplane.map(|viewplane| viewplane.ray_start),
            columns: None,
            rows: None,
        };
        let mut described = self.description.unwrap_or(whole);
        if let Some((columns, rows)) = size {
            (described.columns, described.rows) = (Some(columns), Some(rows));
        }
        if let (Some(Opening::Viewplane { width, height, .. }), false) =
            (&mut described.opening, self.has_size)
        {
            let (columns, rows) = (described.columns, described.rows);
            if let (Some(columns), Some(rows)) = (columns, rows) {
                *width = *height * columns as f64 / rows.max(1) as f64;
            }
        }
        described
    }
}

/// How to read a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoadSettings {
    /// Whether unusable triangles, and a text file that seems to be truncated, are errors instead of warnings.
    pub strict: bool,
    /// How many bytes of memory may be spent on the file: on its content, unpacked, on what it names, and
    /// on the vertices, triangles and textures of all that. The trees of a scene come on top.
    ///
    /// What a small file may describe is bounded by its size too: vertices, triangles, instances and names may take
    /// 256 times the bytes that were read, and 1/256 of `max_memory` beside. Of textures a sixteenth counts there.
    pub max_memory: u64,
    /// How many texels a texture may have across or down, and the root of how many bytes it may have in all.
    pub max_texture: u32,
}

impl Default for LoadSettings {
    /// Doubtful triangles are dropped; 8 GiB; textures of 16,384 texels and 256 MiB.
    fn default() -> Self {
        Self {
            strict: false,
            max_memory: 8 << 30,
            max_texture: 16_384,
        }
    }
}

/// A kind of file.
struct Format {
    name: &'static str,
    /// In lower case, without the dot.
    extensions: &'static [&'static str],
    up: DVec3,
    /// Whether `up` is a rule of the format, not a convention.
    rules_up: bool,
    read: fn(&[u8], &mut Report) -> Checked<Model>,
}

/// Every format there is; all else is derived from this table.
const FORMATS: &[Format] = &[
    #[cfg(feature = "gltf")]
    Format {
        name: "glTF",
        extensions: &["gltf", "glb"],
        up: DVec3::Y,
        rules_up: true,
        read: gltf::read,
    },
    #[cfg(feature = "obj")]
    Format {
        name: "OBJ",
        extensions: &["obj"],
        up: DVec3::Y,
        rules_up: false,
        read: obj::read,
    },
    #[cfg(feature = "ply")]
    Format {
        name: "PLY",
        extensions: &["ply"],
        up: DVec3::Z,
        rules_up: false,
        read: ply::read,
    },
    #[cfg(feature = "stl")]
    Format {
        name: "STL",
        extensions: &["stl"],
        up: DVec3::Z,
        rules_up: false,
        read: stl::read,
    },
    #[cfg(feature = "scene-file")]
    scene_file::FORMAT,
];

/// Reads the file at `path`, its format chosen by its extension. Packed by gzip, it is unpacked; its
/// name may end with `.gz` then.
///
/// ```no_run
/// use std::path::Path;
///
/// use firsthit::io::{LoadSettings, load};
///
/// let model = load(Path::new("house.glb"), &LoadSettings::default())?;
/// for warning in &model.warnings {
///     eprintln!("{warning}");
/// }
/// println!("{} objects, {} cameras", model.objects.len(), model.cameras.len());
/// let scene = model.into_scene()?;
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Read`] when the system refuses, or `path` is no regular file; [`Error::Parse`] when the
/// content or the extension is wrong; [`Error::TooLarge`] for more than `settings` allow, and
/// [`Error::Limit`] for more than identifiers hold.
pub fn load(path: &Path, settings: &LoadSettings) -> Result<Model> {
    // A folder is refused as such, before its extension is.
    read::refuse_folder(path)?;
    let format = format_of(path)?;
    let bytes = read::regular_file(path, settings.max_memory)?;
    model(format, bytes.into(), &mut Report::new(path, *settings))
}

/// [`load`] for a file that another one names: from the memory that is left to that one, whose report takes
/// over this one's.
fn load_part(path: &Path, whole: &mut Report) -> Result<Model> {
    let format = format_of(path)?;
    let bytes = read::regular_file(path, whole.settings().max_memory)?;
    let mut report = Report::of_part(path, whole);
    let mut model = model(format, bytes.into(), &mut report)?;
    let warnings = std::mem::take(&mut model.warnings);
    whole.absorb(&report, warnings, std::mem::take(&mut model.files));
    Ok(model)
}

/// Reads a file's content from memory. `name` is what messages call it; its extension tells the format.
/// Nothing that the content names, such as textures, is opened: each is a warning.
///
/// # Errors
///
/// Those of [`load`], but for [`Error::Read`].
pub fn load_bytes(name: &Path, bytes: &[u8], settings: &LoadSettings) -> Result<Model> {
    let format = format_of(name)?;
    let mut report = Report::new(name, *settings).in_memory();
    model(format, bytes.into(), &mut report)
}

/// How many times its content a file takes while it is read, where it is no attack.
const TIMES_CONTENT: usize = 3;

fn model(format: &Format, bytes: Cow<'_, [u8]>, report: &mut Report) -> Result<Model> {
    let path = &report.path().to_owned();
    let read = |report: &mut Report| {
        report.spend_on_read(path, bytes.len())?;
        let bytes = gzip::unpacked(bytes, report)?;
        report.check_memory(bytes.len().saturating_mul(TIMES_CONTENT))?;
        (format.read)(&bytes, report)
    };
    let model = read(report).map_err(|fault| fault.into_error(path))?;
    if let Some(error) = report.strict_error() {
        return Err(error);
    }
    let up = if model.up == DVec3::ZERO {
        format.up
    } else {
        model.up
    };
    let mut files = vec![path.to_owned()];
    files.extend(report.take_files());
    Ok(Model {
        warnings: report.take_lines(),
        files,
        up,
        up_is_guessed: model.up == DVec3::ZERO && !format.rules_up,
        ..model
    })
}

/// The extensions of all formats that [`load`] reads, in lower case and without the dot.
pub fn extensions() -> impl Iterator<Item = &'static str> {
    FORMATS
        .iter()
        .flat_map(|format| format.extensions.iter().copied())
}

fn format_of(path: &Path) -> Result<&'static Format> {
    let unpacked = without_gz(path);
    let extension = unpacked.extension().unwrap_or_default();
    let extension = extension.to_ascii_lowercase();
    FORMATS
        .iter()
        .find(|format| format.extensions.iter().any(|&known| extension == known))
        .ok_or_else(|| {
            let known: Vec<_> = FORMATS
                .iter()
                .flat_map(|format| format.extensions.iter().map(move |e| (format.name, e)))
                .map(|(name, extension)| format!(".{extension} ({name})"))
                .collect();
            let what = format!(
                "the extension names no known format; it must be one of {}",
                known.join(", ")
            );
            parse_error(path, what)
        })
}

fn parse_error(path: &Path, what: String) -> Error {
    Error::Parse {
        path: path.to_owned(),
        place: Place::File,
        what,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_known_in_any_case() {
        assert_eq!(format_of(Path::new("a.b/C.StL")).unwrap().name, "STL");
        let error = format_of(Path::new("x.3ds")).err().unwrap().to_string();
        assert_eq!(
            error,
            "x.3ds: the extension names no known format; \
             it must be one of .gltf (glTF), .glb (glTF), .obj (OBJ), .ply (PLY), .stl (STL), \
             .toml (scene file)"
        );
        assert!(format_of(Path::new("noextension")).is_err());
    }

    #[test]
    fn what_is_no_regular_file_is_refused() {
        let folder = tempfile::Builder::new().suffix(".obj").tempdir().unwrap();
        let error = load(folder.path(), &LoadSettings::default()).unwrap_err();
        assert!(
            error.to_string().ends_with("a folder, not a file"),
            "{error}"
        );
        let missing = folder.path().join("x.ply");
        assert!(matches!(
            load(&missing, &LoadSettings::default()),
            Err(Error::Read { .. })
        ));
    }
}
