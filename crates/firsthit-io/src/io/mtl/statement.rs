//! The statements of an MTL file.

use std::path::{Path, PathBuf};

use crate::error::{Place, escape_controls};
use crate::geometry::Color;
use crate::io::report::Report;
use crate::io::text::{Lines, Words, next_number, number, shown, unended, unended_line};
use crate::scene::Wrap;

/// The statements about a material.
#[derive(Debug, Default)]
pub(super) struct Stated {
    /// Linear.
    pub(super) color: Option<Color>,
    /// A radiance.
    pub(super) emission: Option<Color>,
    /// Physically based, as some programs write it beside the rest.
    pub(super) roughness: Option<f64>,
    pub(super) metallic: Option<f64>,
    pub(super) color_map: Option<Map>,
    pub(super) alpha_map: Option<Map>,
}

/// A texture that is named and not yet read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Map {
    pub(super) library: PathBuf,
    pub(super) line: u64,
    pub(super) name: String,
    pub(super) offset: [f64; 2],
    pub(super) scale: [f64; 2],
    pub(super) wrap: Wrap,
}

impl Map {
    /// Warns that its picture cannot be read.
    pub(super) fn warn(&self, reason: &str, report: &mut Report) {
        let place = Place::Line(self.line);
        report.warnings.add(&self.library, "texture", &place, || {
            let name = escape_controls(&self.name);
            format!("texture '{name}' is not read: {reason}")
        });
    }
}

/// The sign that the library is truncated, if there is one: its last line has no line break and
/// makes no sense as the last.
pub(super) fn cut(text: &[u8]) -> Option<String> {
    let line = unended_line(text)?;
    let mut words = Words::new(line);
    let keyword = words.next()?;
    let count = words.count();
    let begins_one = || KEYWORDS.iter().any(|known| known.starts_with(keyword));
    let why = match keyword {
        b"newmtl" => "nothing is said of this material",
        b"Kd" | b"Ka" | b"Ks" | b"Ke" if matches!(count, 0 | 2) => "a number is missing",
        b"d" | b"Tr" | b"Ni" | b"Ns" | b"Pr" | b"Pm" | b"illum" if count == 0 => {
            "a number is missing"
        }
        // One number is a grey, unless the file writes out all three elsewhere.
        b"Kd" if count == 1 && has_full_colors(text) => "numbers are missing",
        word if !KEYWORDS.contains(&word) && begins_one() => "this is no statement",
        _ => return None,
    };
    Some(unended(line, why))
}

/// Whether a colour is written with all its numbers.
fn has_full_colors(text: &[u8]) -> bool {
    Lines::new(text).any(|line| {
        let mut words = Words::new(line);
        words.next() == Some(b"Kd") && words.count() == 3
    })
}

/// The known keywords.
const KEYWORDS: &[&[u8]] = &[
    b"newmtl",
    b"Ka",
    b"Kd",
    b"Ks",
    b"Ke",
    b"Km",
    b"Tf",
    b"Tr",
    b"d",
    b"illum",
    b"sharpness",
    b"Ni",
    b"Ns",
    b"Pr",
    b"Pm",
    b"Ps",
    b"Pc",
    b"Pcr",
    b"aniso",
    b"anisor",
    b"map_Ka",
    b"map_Kd",
    b"map_Ks",
    b"map_Ke",
    b"map_Ns",
    b"map_d",
    b"map_aat",
    b"map_bump",
    b"map_Bump",
    b"map_Pr",
    b"map_Pm",
    b"map_Ps",
    b"map_refl",
    b"bump",
    b"disp",
    b"decal",
    b"refl",
    b"norm",
];

/// Reads a line about a material.
#[expect(clippy::too_many_lines, reason = "an arm for each statement")]
pub(super) fn state(
    material: &mut Stated,
    keyword: &[u8],
    words: Words,
    (path, line): (&Path, u64),
    report: &mut Report,
) {
    let place = Place::Line(line);
    let mut warn = |key: &'static str, what: &dyn Fn() -> String| {
        report.warnings.add(path, key, &place, what);
    };
    match keyword {
        b"Kd" => match parse_color("Kd", words) {
            Ok(color) => {
                if color.max_element() > 1.0 {
                    warn("bright", &|| {
                        format!(
                            "Kd is from 0 to 1, got {color}: the surface gives more light than it gets"
                        )
                    });
                }
                material.color = Some(color);
            }
            Err(what) => warn("Kd", &|| what.clone()),
        },
        b"Ke" => match parse_color("Ke", words) {
            Ok(color) => material.emission = Some(color),
            Err(what) => warn("Ke", &|| what.clone()),
        },
        b"Pr" | b"Pm" => match parse_share(keyword, words) {
            Ok(share) if keyword == b"Pr" => material.roughness = Some(share),
            Ok(share) => material.metallic = Some(share),
            Err(what) => warn("Pr", &|| what.clone()),
        },
        b"map_Kd" | b"map_d" => match parse_map(words, path, line) {
            Ok((map, passed_over)) => {
                if let Some(option) = passed_over {
                    warn("option", &|| {
                        format!("option '{option}' of {} is not read", shown(keyword))
                    });
                }
                if keyword == b"map_Kd" {
                    material.color_map = Some(map);
                } else {
                    material.alpha_map = Some(map);
                }
            }
            Err(what) => warn("map", &|| format!("{}: {what}", shown(keyword))),
        },
        b"d" | b"Tr" => {
            let solid = if keyword == b"d" { 1.0 } else { 0.0 };
            let word = words.last();
            if word.and_then(number).is_some_and(|value| value != solid) {
                warn("dissolve", &|| {
                    let (keyword, value) = (shown(keyword), shown(word.unwrap_or_default()));
                    format!(
                        "a surface that lets light through is seen as opaque: {keyword} {value}"
                    )
                });
            }
        }
        _ if is_texture(keyword) => {
            let rest = shown(words.rest());
            warn("kind of texture", &|| {
                format!(
                    "of textures only map_Kd and map_d are read, not {} '{rest}'",
                    shown(keyword)
                )
            });
        }
        _ => {}
    }
}

/// A texture's name and options, and the first option that is not read.
fn parse_map(mut words: Words, path: &Path, line: u64) -> Result<(Map, Option<String>), String> {
    let mut map = Map {
        library: path.to_owned(),
        line,
        name: String::new(),
        offset: [0.0; 2],
        scale: [1.0; 2],
        wrap: Wrap::Repeat,
    };
    let mut passed_over = None;
    loop {
        // The name follows the options, and may have blanks.
        let rest = words.rest();
        let Some(option) = words.next() else {
            return Err("the file's name is missing".to_owned());
        };
        match option {
            b"-o" => map.offset = pair(&mut words, 0.0)?,
            b"-s" => map.scale = pair(&mut words, 1.0)?,
            b"-clamp" => {
                if words.next() == Some(b"on") {
                    map.wrap = Wrap::Clamp;
                }
            }
            _ => {
                let known = OPTIONS.iter().find(|&&(name, _)| name == option);
                let Some(&(_, arguments)) = known else {
                    map.name = String::from_utf8_lossy(rest).into_owned();
                    return Ok((map, passed_over));
                };
                passed_over.get_or_insert_with(|| shown(option));
                for _ in 0..arguments {
                    words.next();
                }
            }
        }
    }
}

/// Options of textures that are not read, and how many words each takes.
const OPTIONS: &[(&[u8], usize)] = &[
    (b"-blendu", 1),
    (b"-blendv", 1),
    (b"-bm", 1),
    (b"-boost", 1),
    (b"-cc", 1),
    (b"-imfchan", 1),
    (b"-mm", 2),
    (b"-t", 3),
    (b"-texres", 1),
    (b"-type", 1),
];

/// The first two of one to three numbers; `missing` in the place of those that are not there.
fn pair(words: &mut Words, missing: f64) -> Result<[f64; 2], String> {
    let mut values = [next_number(words)?, missing, missing];
    for value in values.iter_mut().skip(1) {
        let mut ahead = words.clone();
        let Some(next) = ahead.next().and_then(number) else {
            break;
        };
        *value = next;
        *words = ahead;
    }
    let [u, v, _] = values;
    if u.is_finite() && v.is_finite() {
        Ok([u, v])
    } else {
        Err(format!("an offset or scale must be finite, got {u} {v}"))
    }
}

fn is_texture(keyword: &[u8]) -> bool {
    keyword.starts_with(b"map_")
        || matches!(keyword, b"bump" | b"disp" | b"decal" | b"refl" | b"norm")
}

/// A linear colour: three numbers, or one for all three.
fn parse_color(name: &str, mut words: Words) -> Result<Color, String> {
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
        Err(format!("{name} must be finite and not negative, got {color}"))
    }
}

/// A number from 0 to 1.
fn parse_share(name: &[u8], mut words: Words) -> Result<f64, String> {
    let share = next_number(&mut words)?;
    if (0.0..=1.0).contains(&share) {
        Ok(share)
    } else {
        let name = shown(name);
        Err(format!("{name} must be from 0 to 1, got {share}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_textures_come_before_a_name_with_blanks() {
        let map = |text: &[u8]| parse_map(Words::new(text), "x.mtl".as_ref(), 3);
        let (read, passed_over) =
            map(b"-s 2 -o 0.5 0.25 0 -mm 0 1 -clamp on my wood.png ").unwrap();
        assert_eq!(read.name, "my wood.png");
        assert_eq!((read.scale, read.offset), ([2.0, 1.0], [0.5, 0.25]));
        assert_eq!(read.wrap, Wrap::Clamp);
        assert_eq!(passed_over.as_deref(), Some("-mm"));
        assert!(map(b"-s 1 1 1").is_err());
        assert!(map(b"-o inf 1 x.png").is_err());
    }
}
