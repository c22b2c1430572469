//! Sections as files: a format is a row of the list.

mod dxf;
mod json;
mod svg;

use std::io::{self, Write};
use std::path::Path;
use std::sync::OnceLock;

use super::Section;
use crate::error::{Error, Result};
use crate::geometry::DVec2;
use crate::image::write_whole;
use crate::parallel;
use crate::watch::Watch;

/// A kind of file that a [`Section`] can be written to.
#[derive(Debug, Clone, Copy)]
pub struct SectionFormat {
    /// The format's name, and the extension of its files.
    pub name: &'static str,
    /// The content of a file, in a few words.
    pub about: &'static str,
    write: fn(&Section, &mut dyn Write) -> io::Result<()>,
}

/// All formats.
pub const SECTION_FORMATS: &[SectionFormat] = &[
    SectionFormat {
        name: "svg",
        about: "a drawing in plane coordinates, one scene unit a millimetre",
        write: svg::write,
    },
    SectionFormat {
        name: "dxf",
        about: "polylines in plane coordinates, for CAD (release 12)",
        write: dxf::write,
    },
    SectionFormat {
        name: "json",
        about: "all there is: points in space and in the plane, objects, primitives, areas",
        write: json::write,
    },
];

/// The extensions of paths, for messages.
fn extensions() -> &'static str {
    static EXTENSIONS: OnceLock<String> = OnceLock::new();
    parallel::once::<String>(&EXTENSIONS, || {
        let names: Vec<&str> = SECTION_FORMATS.iter().map(|format| format.name).collect();
        let (last, others) = names.split_last().expect("there are formats");
        format!("a file in .{} or .{last}", others.join(", ."))
    })
}

impl SectionFormat {
    /// The format that a path's extension names.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for any other.
    pub fn of(path: &Path) -> Result<&'static Self> {
        let wanted = path.extension().unwrap_or_default();
        let mut formats = SECTION_FORMATS.iter();
        let found = formats.find(|format| wanted.eq_ignore_ascii_case(format.name));
        found.ok_or_else(|| Error::argument("output", extensions(), path.display()))
    }

    /// Writes a section.
    ///
    /// # Errors
    ///
    /// The errors of `out`.
    pub fn write(&self, section: &Section, out: &mut dyn Write) -> io::Result<()> {
        (self.write)(section, out)
    }
}

impl Section {
    /// Writes the section to a file, whole or not at all. The extension is that of one of the
    /// [`SECTION_FORMATS`].
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for another extension, and those of [`write_whole`].
    pub fn save(&self, path: impl AsRef<Path>, watch: &dyn Watch) -> Result<()> {
        let path = path.as_ref();
        let format = SectionFormat::of(path)?;
        write_whole(path, watch, |out| format.write(self, out))
    }

    /// The points of a polyline in the plane.
    fn in_plane<'a>(
        &'a self,
        polyline: &super::Polyline<'a>,
    ) -> impl ExactSizeIterator<Item = DVec2> + 'a {
        let points = polyline.points.iter();
        points.map(|&point| self.plane.coordinates(point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_is_found_by_its_extension() {
        for format in SECTION_FORMATS {
            let path = format!("a.b/cut.{}", format.name.to_uppercase());
            assert_eq!(SectionFormat::of(Path::new(&path)).unwrap().name, format.name);
        }
        let error = SectionFormat::of(Path::new("cut.pdf")).unwrap_err().to_string();
        for format in SECTION_FORMATS {
            assert!(error.contains(&format!(".{}", format.name)), "{error}");
        }
    }
}
