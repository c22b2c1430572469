//! Reads a mesh, a model or a scene file.

mod colmap;

use std::borrow::Cow;
use std::path::Path;

use crate::error::{Error, Result};
#[cfg(feature = "fhs")]
use crate::fhs;
use crate::io::{FORMATS, Format, ModelFormat, Report, format_of, read};
use crate::scene::EnvironmentMap;
#[cfg(feature = "scene-file")]
use crate::scene_file;
use crate::watch::Watch;
use crate::world::{World, WorldFormat, unknown_variant};

pub use crate::io::{LoadSettings, UNITS, polygons};
pub use crate::world::loaded::Loaded;
pub use colmap::{colmap_files, read_colmap};

/// The formats whose files say how their scenes look, of those that this crate was compiled with.
const WORLD_FORMATS: &[&WorldFormat] = &[
    #[cfg(feature = "fhs")]
    &fhs::FORMAT,
    #[cfg(feature = "scene-file")]
    &scene_file::FORMAT,
];

/// A format that is read.
#[derive(Clone, Copy)]
enum Reader {
    Model(&'static ModelFormat),
    World(&'static WorldFormat),
}

impl AsRef<Format> for Reader {
    fn as_ref(&self) -> &Format {
        self.format()
    }
}

impl Reader {
    fn format(self) -> &'static Format {
        match self {
            Self::Model(model) => &model.format,
            Self::World(world) => &world.format,
        }
    }

    fn load(self, bytes: Cow<'_, [u8]>, report: &mut Report) -> Result<Loaded> {
        let world = match self {
            Self::Model(model) => World::of(model.load(bytes, report)?),
            Self::World(world) => world.load(bytes, report)?,
        };
        Loaded::new(world, self.format(), report)
    }
}

/// The formats that this crate was compiled with.
fn formats() -> impl Iterator<Item = Reader> + Clone {
    let worlds = WORLD_FORMATS.iter().map(|format| Reader::World(format));
    FORMATS.iter().map(Reader::Model).chain(worlds)
}

/// Reads the file at `path`. Its extension tells the format. A file packed by gzip is unpacked; its
/// name may end with `.gz`.
///
/// ```no_run
/// use std::path::Path;
///
/// use firsthit::load::{LoadSettings, load};
///
/// let loaded = load(Path::new("house.glb"), &LoadSettings::default())?;
/// for warning in &loaded.warnings {
///     eprintln!("{warning}");
/// }
/// println!("{} cameras", loaded.world.cameras.len());
/// let scene = loaded.into_scene()?;
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Read`] when the system refuses, or `path` is no regular file; [`Error::Parse`] when the
/// content or the extension is wrong; [`Error::TooLarge`] for more than `settings` allow,
/// [`Error::Limit`] for more than identifiers hold, and [`Error::Argument`] for a scale that the
/// file cannot have and a variant that there is not.
///
/// [`Error::Argument`]: crate::error::Error::Argument
/// [`Error::Read`]: crate::error::Error::Read
/// [`Error::Parse`]: crate::error::Error::Parse
/// [`Error::TooLarge`]: crate::error::Error::TooLarge
/// [`Error::Limit`]: crate::error::Error::Limit
pub fn load(path: &Path, settings: &LoadSettings) -> Result<Loaded> {
    load_watched(path, settings, &())
}

/// As [`load`]; `watch` follows it, and may end it.
///
/// # Errors
///
/// The errors of [`load`], and [`Error::Interrupted`].
pub fn load_watched(path: &Path, settings: &LoadSettings, watch: &dyn Watch) -> Result<Loaded> {
    // A folder is refused as such, before its extension is.
    read::refuse_folder(path)?;
    let format = format_of(path, formats())?;
    check_scale(format, settings)?;
    let mut report = Report::new(path, settings.clone(), watch);
    #[cfg(feature = "fhs")]
    if format.format().name == fhs::FORMAT.format.name && !read::is_named_as_packed(path) {
        let block = read::mapped_file(path)?;
        return with_variant(fhs::open_mapped(block.into(), &mut report)?, settings);
    }
    let bytes = read::regular_file(path, settings.max_memory, watch)?;
    with_variant(format.load(bytes.into(), &mut report)?, settings)
}

/// Refuses a variant that no file has.
fn with_variant(loaded: Loaded, settings: &LoadSettings) -> Result<Loaded> {
    let asked = settings.variant.as_deref();
    match asked.and_then(|asked| unknown_variant(asked, &loaded.variants)) {
        Some(unknown) => Err(Error::argument("variant", "one of the file's", unknown)),
        None => Ok(loaded),
    }
}

/// Reads a file's content from memory. Messages call it `name`; the extension of `name` tells the
/// format. No file that the content names, such as a texture, is opened: each is a warning.
///
/// # Errors
///
/// The errors of [`load`], but for [`Error::Read`].
pub fn load_bytes(name: &Path, bytes: &[u8], settings: &LoadSettings) -> Result<Loaded> {
    let format = format_of(name, formats())?;
    check_scale(format, settings)?;
    let mut report = Report::new(name, settings.clone(), &());
    report.source.in_memory = true;
    with_variant(format.load(bytes.into(), &mut report)?, settings)
}

/// Refuses a factor that is none, and one for files that say themselves how long everything is.
fn check_scale(format: Reader, settings: &LoadSettings) -> Result<()> {
    let scale = settings.scale;
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(Error::argument("scale", "positive and finite", scale));
    }
    if scale != 1.0
        && let Reader::World(WorldFormat { format, .. }) = format
    {
        let got = format!("{scale} for a {}", format.name);
        return Err(Error::argument("scale", "1 but for mesh files and models", got));
    }
    Ok(())
}

/// Reads an environment map, a picture of all directions by longitude and latitude: Radiance's
/// `.hdr`, or with the feature `exr` an `.exr`. The file's first bytes tell which. Returns warnings
/// beside it, ready to print.
///
/// Texels are taken as they are, in linear light. NaN and negative numbers become 0, infinity
/// becomes 65,504, with one warning.
///
/// # Errors
///
/// [`Error::Read`] when the system refuses, or `path` is no regular file;
/// [`Error::Parse`] when the content is wrong; [`Error::TooLarge`] for more than
/// `settings` allow: of `max_texture`, as many texels as another texture may have.
pub fn load_environment(
    path: &Path,
    settings: &LoadSettings,
) -> Result<(EnvironmentMap, Vec<String>)> {
    let mut report = Report::new(path, settings.clone(), &());
    let map = crate::io::load_environment(&mut report)?;
    Ok((map, report.take_lines()))
}

/// The extensions of all formats that [`load`] reads, in lower case and without the dot.
pub fn extensions() -> impl Iterator<Item = &'static str> {
    formats().flat_map(|format| format.format().extensions.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_known_in_any_case() {
        let of =
            |name: &str| format_of(Path::new(name), formats()).map(|format| format.format().name);
        assert_eq!(of("a.b/C.StL").unwrap(), "STL");
        assert_eq!(
            of("x.3ds").unwrap_err().to_string(),
            "x.3ds: the extension names no known format; \
             it must be one of .gltf (glTF), .glb (glTF), .obj (OBJ), .ply (PLY), .stl (STL), .off (OFF), \
             .fhs (built scene), .toml (scene file); Blender opens .3ds and exports .glb"
        );
        assert!(of("noextension").is_err());
    }

    #[test]
    fn what_is_no_regular_file_is_refused() {
        let folder = tempfile::Builder::new().suffix(".obj").tempdir().unwrap();
        let error = load(folder.path(), &LoadSettings::default()).unwrap_err();
        assert!(error.to_string().ends_with("a folder, not a file"), "{error}");
        let missing = folder.path().join("x.ply");
        assert!(matches!(load(&missing, &LoadSettings::default()), Err(Error::Read { .. })));
    }
}
