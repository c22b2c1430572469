//! A file format, and how a file of it is read.

use std::borrow::Cow;
use std::path::Path;

use super::fault::{Checked, Fault};
use super::gzip;
use super::loaded::Loaded;
use super::memory_budget::check_free;
use super::recognize;
use super::report::Report;
use super::scale::scaled;
use super::source::has_extension;
use crate::error::Result;
use crate::geometry::DVec3;
use crate::world::World;

/// A kind of file.
pub(crate) struct Format {
    pub(crate) name: &'static str,
    /// The extensions in lower case, without the dot.
    pub(crate) extensions: &'static [&'static str],
    pub(crate) up: DVec3,
    /// Whether `up` is a rule of the format, not a convention.
    pub(crate) rules_up: bool,
    pub(crate) read: fn(&[u8], &mut Report) -> Checked<World>,
}

/// The memory for reading a file, in multiples of its content, unless it is an attack.
const TIMES_CONTENT: usize = 3;

impl Format {
    /// Reads a file's content, packed by gzip or not.
    ///
    /// # Errors
    ///
    /// [`Error::Parse`](crate::Error::Parse) for wrong content, [`Error::TooLarge`](crate::Error::TooLarge) for more than the
    /// settings allow, and [`Error::Limit`](crate::Error::Limit) for more than identifiers hold.
    pub(crate) fn load(&self, bytes: Cow<'_, [u8]>, report: &mut Report) -> Result<Loaded> {
        let path = report.source.path().to_owned();
        let read = |report: &mut Report| {
            report.budget.charge_read(&path, bytes.len())?;
            let bytes = gzip::unpacked(bytes, report)?;
            check_free(bytes.len().saturating_mul(TIMES_CONTENT))?;
            (self.read)(&bytes, report).map_err(|fault| recognize::hinted(fault, self, &bytes))
        };
        let world = read(report).map_err(|fault| fault.into_error(&path))?;
        let scale = report.settings.scale;
        let world = if scale == 1.0 {
            world
        } else {
            scaled(world, scale)?
        };
        self.loaded(world, report)
    }

    /// The loaded file, with all that the format says beside the world.
    pub(crate) fn loaded(&self, world: World, report: &mut Report) -> Result<Loaded> {
        if let Some(error) = report.strict_error() {
            return Err(error);
        }
        let is_up_stated = world.up != DVec3::ZERO;
        Ok(Loaded {
            warnings: report.take_lines(),
            files: report.source.take_files(),
            variants: std::mem::take(&mut report.variants),
            vertices: report.vertices,
            scene: report.scene.take(),
            world: World {
                up: if is_up_stated { world.up } else { self.up },
                // A file that was made from another may say so itself.
                up_is_guessed: world.up_is_guessed || (!is_up_stated && !self.rules_up),
                ..world
            },
        })
    }
}

/// The format, of `formats`, that the extension of `path` names.
///
/// # Errors
///
/// [`Error::Parse`](crate::Error::Parse) if there is none.
pub(crate) fn format_of<'a>(
    path: &Path,
    mut formats: impl Iterator<Item = &'a Format> + Clone,
) -> Result<&'a Format> {
    let known: Vec<String> = (formats.clone())
        .flat_map(|format| format.extensions.iter().map(move |e| (format.name, e)))
        .map(|(name, extension)| format!(".{extension} ({name})"))
        .collect();
    let found = formats.find(|format| has_extension(path, format.extensions));
    found.ok_or_else(|| {
        let known = known.join(", ");
        let way = recognize::way_of(path).map_or_else(String::new, |way| format!("; {way}"));
        let what = format!("the extension names no known format; it must be one of {known}{way}");
        Fault::file(what).into_error(path)
    })
}
