//! A file format, and how a file of it is read.

use std::borrow::Cow;
use std::path::Path;

use super::fault::{Checked, Fault};
use super::gzip;
use super::memory_budget::check_free;
use super::model::Model;
use super::recognize;
use super::report::Report;
use super::scale::scaled;
use super::source::has_extension;
use crate::error::Result;
use crate::geometry::DVec3;

/// A kind of file: how it is named, and which way is up in it.
pub struct Format {
    pub name: &'static str,
    /// The extensions in lower case, without the dot.
    pub extensions: &'static [&'static str],
    pub up: DVec3,
    /// Whether `up` is a rule of the format, not a convention.
    pub rules_up: bool,
}

/// The memory for reading a file, in multiples of its content, unless it is an attack.
const TIMES_CONTENT: usize = 3;

impl Format {
    /// Reads a file's content, packed by gzip or not, by `read`.
    ///
    /// # Errors
    ///
    /// [`Error::Parse`](crate::error::Error::Parse) for wrong content,
    /// [`Error::TooLarge`](crate::error::Error::TooLarge) for more than the settings allow, and
    /// [`Error::Limit`](crate::error::Error::Limit) for more than identifiers hold.
    pub fn read<T>(
        &self,
        bytes: Cow<'_, [u8]>,
        report: &mut Report,
        read: fn(&[u8], &mut Report) -> Checked<T>,
    ) -> Result<T> {
        let path = report.source.path().to_owned();
        let content = |report: &mut Report| -> Checked<T> {
            report.budget.charge_read(&path, bytes.len())?;
            let bytes = gzip::unpacked(bytes, report)?;
            check_free(bytes.len().saturating_mul(TIMES_CONTENT))?;
            report.begin_parsing("", bytes.len());
            let made =
                read(&bytes, report).map_err(|fault| recognize::hinted(fault, self, &bytes))?;
            report.advance_until(0)?;
            Ok(made)
        };
        content(report).map_err(|fault| fault.into_error(&path))
    }

    /// Which way is up in a file that says `stated`, zero for nothing, and whether that is only a
    /// convention. A file that was made from another may say so itself.
    pub fn up(&self, stated: DVec3, is_guessed: bool) -> (DVec3, bool) {
        let is_stated = stated != DVec3::ZERO;
        let up = if is_stated { stated } else { self.up };
        (up, is_guessed || (!is_stated && !self.rules_up))
    }
}

/// A format of meshes or models.
pub struct ModelFormat {
    pub format: Format,
    pub read: fn(&[u8], &mut Report) -> Checked<Model>,
}

impl ModelFormat {
    /// Reads a file's content, packed by gzip or not.
    ///
    /// # Errors
    ///
    /// The errors of [`Format::read`], and [`Error::Argument`](crate::error::Error::Argument) for a
    /// scale that it cannot have.
    pub fn load(&self, bytes: Cow<'_, [u8]>, report: &mut Report) -> Result<Model> {
        let model = self.format.read(bytes, report, self.read)?;
        let scale = report.settings.scale;
        if scale == 1.0 { Ok(model) } else { scaled(model, scale) }
    }
}

impl AsRef<Format> for &'static ModelFormat {
    fn as_ref(&self) -> &Format {
        &self.format
    }
}

/// The format, of `formats`, that the extension of `path` names.
///
/// # Errors
///
/// [`Error::Parse`](crate::error::Error::Parse) if there is none.
pub fn format_of<F: AsRef<Format>>(
    path: &Path,
    mut formats: impl Iterator<Item = F> + Clone,
) -> Result<F> {
    let known: Vec<String> = (formats.clone())
        .flat_map(|format| {
            let Format { name, extensions, .. } = *format.as_ref();
            (extensions.iter()).map(move |extension| format!(".{extension} ({name})"))
        })
        .collect();
    let found = formats.find(|format| has_extension(path, format.as_ref().extensions));
    found.ok_or_else(|| {
        let known = known.join(", ");
        let way = recognize::way_of(path).map_or_else(String::new, |way| format!("; {way}"));
        let what = format!("the extension names no known format; it must be one of {known}{way}");
        Fault::file(what).into_error(path)
    })
}
