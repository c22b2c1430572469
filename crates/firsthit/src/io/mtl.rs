//! MTL: the colours that OBJ files name.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::read;
use super::report::Report;
use super::text::{self, Lines, Words, next_number, shown};
use crate::error::Place;
use crate::geometry::Color;

/// The materials of all libraries that a file names.
#[derive(Debug, Default)]
pub(super) struct Library {
    /// Linear; `None` where a material states no colour. Of two with one name the first counts.
    colors: HashMap<Vec<u8>, Option<Color>>,
    /// Statements and files that were dealt with: each is read once, however often it is named.
    asked: HashSet<Vec<u8>>,
    read: HashSet<PathBuf>,
}

/// No library has a material of that name.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct UnknownMaterial;

impl Library {
    /// The colour of a material, if it states one.
    pub(super) fn color(&self, name: &[u8]) -> Result<Option<Color>, UnknownMaterial> {
        self.colors.get(name).copied().ok_or(UnknownMaterial)
    }

    /// Reads what a statement `mtllib` names: one file whose name may have blanks, or several. What
    /// cannot be read is a warning.
    pub(super) fn add(&mut self, names: &[u8], line: u64, report: &mut Report) {
        if !self.asked.insert(names.to_vec()) {
            return;
        }
        let Err(reason) = self.add_file(names, report) else {
            return;
        };
        let words: Vec<_> = Words::new(names).collect();
        if words.len() < 2 {
            return warn_of(names, &reason, line, report);
        }
        for word in words {
            if let Err(reason) = self.add_file(word, report) {
                warn_of(word, &reason, line, report);
            }
        }
    }

    fn add_file(&mut self, name: &[u8], report: &mut Report) -> Result<(), String> {
        let path = read::sibling(report.path(), &String::from_utf8_lossy(name))?;
        if self.read.insert(path.clone()) {
            let bytes = read::regular_file(&path).map_err(|error| error.to_string())?;
            self.parse(&text::decode(&bytes), &path, report);
        }
        Ok(())
    }

    fn parse(&mut self, text: &[u8], path: &Path, report: &mut Report) {
        let mut lines = Lines::new(text);
        let mut material: Option<Vec<u8>> = None;
        while let Some(line) = lines.next() {
            let place = Place::Line(lines.number);
            let mut words = Words::new(line);
            match words.next() {
                Some(b"newmtl") => {
                    let name = words.rest().to_vec();
                    // Of two with one name the first counts.
                    material = (!self.colors.contains_key(&name)).then(|| name.clone());
                    self.colors.entry(name).or_insert(None);
                }
                Some(b"Kd") => match parse_color(words) {
                    Ok(color) => {
                        let known = material.as_ref().and_then(|name| self.colors.get_mut(name));
                        if let Some(known) = known {
                            *known = Some(color);
                        }
                    }
                    Err(what) => report.warn_in(path, "Kd", &place, || what),
                },
                Some(map) if is_texture(map) => report.warn_in(path, "texture", &place, || {
                    let (map, file) = (shown(map), shown(words.rest()));
                    format!("textures are not read yet: {map} '{file}'")
                }),
                _ => {}
            }
        }
    }
}

fn warn_of(name: &[u8], reason: &str, line: u64, report: &mut Report) {
    report.warn("mtllib", &Place::Line(line), || {
        format!("material library '{}' is not read: {reason}", shown(name))
    });
}

fn is_texture(keyword: &[u8]) -> bool {
    keyword.starts_with(b"map_")
        || matches!(keyword, b"bump" | b"disp" | b"decal" | b"refl" | b"norm")
}

/// A linear colour: three numbers, or one for all three.
fn parse_color(mut words: Words) -> Result<Color, String> {
    let red = next_number(&mut words)?;
    let (green, blue) = if words.rest().is_empty() {
        (red, red)
    } else {
        (next_number(&mut words)?, next_number(&mut words)?)
    };
    let color = Color::new(red, green, blue);
    if color.is_finite() && color.min_element() >= 0.0 {
        Ok(color)
    } else {
        Err(format!("Kd must be finite and not negative, got {color}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_linear_and_the_first_of_a_name_counts() {
        let mut library = Library::default();
        let text = b"Kd 9 9 9\nnewmtl a b\n Kd 0.5\nnewmtl c\nKd 1 0 nan\nmap_Kd x.png\n\
            newmtl a b\nKd 1 1 1\n";
        let mut report = Report::new("x.obj".as_ref());
        library.parse(text, "x.mtl".as_ref(), &mut report);
        assert_eq!(library.color(b"a b"), Ok(Some(Color::splat(0.5))));
        assert_eq!(library.color(b"c"), Ok(None));
        assert_eq!(library.color(b"d"), Err(UnknownMaterial));
        assert_eq!(
            report.into_lines(),
            [
                "x.mtl:5: Kd must be finite and not negative, got [1, 0, NaN]",
                "x.mtl:6: textures are not read yet: map_Kd 'x.png'"
            ]
        );
    }
}
