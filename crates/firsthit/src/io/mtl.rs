//! MTL: the materials that OBJ files name.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::report::Report;
use super::text::{self, Lines, Words, next_number, number, shown, unended_line};
use super::{picture, read};
use crate::error::{Place, escape_controls};
use crate::geometry::Color;
use crate::scene::{AlphaMode, Material, Texture, TextureMap, Wrap};

/// The materials of all libraries that a file names.
#[derive(Debug, Default)]
pub(super) struct Library {
    /// Of two with one name the first counts.
    materials: HashMap<Vec<u8>, Stated>,
    /// Statements and files that were dealt with: each is read once, however often it is named.
    asked: HashSet<Vec<u8>>,
    read: HashSet<PathBuf>,
    /// The pictures that were asked for, by library and name; `None` for those that cannot be read.
    pictures: HashMap<(PathBuf, String), Option<Arc<Texture>>>,
    /// What is made of them where they say what is solid.
    masks: HashMap<(PathBuf, String), Option<Arc<Texture>>>,
}

/// What a library says of a material.
#[derive(Debug, Default)]
struct Stated {
    /// Linear.
    color: Option<Color>,
    color_map: Option<Map>,
    alpha_map: Option<Map>,
}

/// A texture that is named and not yet read.
#[derive(Debug, Clone, PartialEq)]
struct Map {
    library: PathBuf,
    line: u64,
    name: String,
    offset: [f64; 2],
    scale: [f64; 2],
    wrap: Wrap,
}

/// No library has a material of that name.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct UnknownMaterial;

impl Library {
    /// What a material looks like, if it says; reads its textures.
    pub(super) fn look(
        &mut self,
        name: &[u8],
        report: &mut Report,
    ) -> Result<Option<Material>, UnknownMaterial> {
        let stated = self.materials.get(name).ok_or(UnknownMaterial)?;
        let color = stated.color;
        let [color_map, alpha_map] = [&stated.color_map, &stated.alpha_map].map(Clone::clone);
        let texture = color_map.and_then(|map| self.texture(&map, report));
        let alpha_texture = alpha_map.and_then(|map| {
            let texture = self.texture(&map, report)?;
            let mask = self.mask(&map, &texture.texture, report)?;
            Some(TextureMap {
                texture: mask,
                ..texture
            })
        });
        if color.is_none() && texture.is_none() && alpha_texture.is_none() {
            return Ok(None);
        }
        let alpha_mode = match alpha_texture {
            Some(_) => AlphaMode::Mask { cutoff: 0.5 },
            None => AlphaMode::Opaque,
        };
        Ok(Some(Material {
            texture,
            alpha_texture,
            alpha_mode,
            ..Material::colored(color.unwrap_or(Color::ONE))
        }))
    }

    /// A texture that a library names, under the library's folder; `None`, with a warning, if it cannot be read.
    fn texture(&mut self, map: &Map, report: &mut Report) -> Option<TextureMap> {
        let texture = self.picture(map, report)?;
        let ([u, v], [across, up]) = (map.offset, map.scale);
        Some(TextureMap {
            wrap: [map.wrap; 2],
            // Coordinates run upwards: 1 - (scale * v + offset).
            picture_from_uv: [[across, 0.0, u], [0.0, -up, 1.0 - v]],
            ..TextureMap::new(texture, TextureMap::V_UP)
        })
    }

    /// What a picture says of what is solid; each is made, and paid for, once.
    fn mask(
        &mut self,
        map: &Map,
        picture: &Arc<Texture>,
        report: &mut Report,
    ) -> Option<Arc<Texture>> {
        if picture.has_alpha() {
            return Some(Arc::clone(picture));
        }
        let key = (map.library.clone(), map.name.clone());
        if let Some(known) = self.masks.get(&key) {
            return known.clone();
        }
        let spent = report.spend_on_texture(size_of_val(picture.texels()) as u64);
        let mask = match spent {
            Ok(()) => Some(Arc::new(brightness_as_alpha(picture))),
            Err(fault) => {
                let reason = fault.into_error(&map.library).to_string();
                report.warn_in(&map.library, "texture", &Place::Line(map.line), || {
                    let name = escape_controls(&map.name);
                    format!("texture '{name}' is not read: {reason}")
                });
                None
            }
        };
        self.masks.insert(key, mask.clone());
        mask
    }

    /// The picture of a texture; each is read, and warned of, once.
    fn picture(&mut self, map: &Map, report: &mut Report) -> Option<Arc<Texture>> {
        let key = (map.library.clone(), map.name.clone());
        if let Some(known) = self.pictures.get(&key) {
            return known.clone();
        }
        let read = picture::sibling(&map.library, &map.name, report);
        let read = read.map(Arc::new).map_err(|reason| {
            report.warn_in(&map.library, "texture", &Place::Line(map.line), || {
                let name = escape_controls(&map.name);
                format!("texture '{name}' is not read: {reason}")
            });
        });
        self.pictures.insert(key, read.clone().ok());
        read.ok()
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
        let path = read::sibling(report.scene()?, &String::from_utf8_lossy(name))?;
        if self.read.insert(path.clone()) {
            let bytes = read::sibling_content(&path, report)?;
            self.parse(&text::decode(&bytes), &path, report);
        }
        Ok(())
    }

    fn parse(&mut self, text: &[u8], path: &Path, report: &mut Report) {
        let mut lines = Lines::new(text);
        // What is stated of a material whose name there was before counts for nothing.
        let (mut known, mut again) = (None, Stated::default());
        while let Some(line) = lines.next() {
            let mut words = Words::new(line);
            let Some(keyword) = words.next() else {
                continue;
            };
            if keyword == b"newmtl" {
                let name = words.rest().to_vec();
                let is_new = !self.materials.contains_key(&name);
                self.materials.entry(name.clone()).or_default();
                known = is_new.then_some(name);
                continue;
            }
            let material = known.as_ref().and_then(|name| self.materials.get_mut(name));
            let material = material.unwrap_or(&mut again);
            state(material, keyword, words, (path, lines.number), report);
        }
        if let Some(why) = cut(text) {
            report.cut_short_in(path, Place::Line(lines.number), &why);
        }
    }
}

/// Why the library seems to be truncated, if it does: its last line has no line break and makes no sense as the last.
fn cut(text: &[u8]) -> Option<String> {
    let line = unended_line(text)?;
    let mut words = Words::new(line);
    let keyword = words.next()?;
    let count = words.count();
    let begins_one = || KEYWORDS.iter().any(|known| known.starts_with(keyword));
    let why = match keyword {
        b"newmtl" => "nothing is said of this material",
        b"Kd" | b"Ka" | b"Ks" | b"Ke" if matches!(count, 0 | 2) => "a number is missing",
        b"d" | b"Tr" | b"Ni" | b"Ns" | b"illum" if count == 0 => "a number is missing",
        // One number is a grey, unless the file writes out all three elsewhere.
        b"Kd" if count == 1 && has_full_colors(text) => "numbers are missing",
        word if !KEYWORDS.contains(&word) && begins_one() => "this is no statement",
        _ => return None,
    };
    Some(format!(
        "its last line has no line break, and {why}: '{}'",
        shown(line)
    ))
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

/// Notes what a line says of a material.
fn state(
    material: &mut Stated,
    keyword: &[u8],
    words: Words,
    (path, line): (&Path, u64),
    report: &mut Report,
) {
    let place = Place::Line(line);
    let mut warn = |key: &'static str, what: &dyn Fn() -> String| {
        report.warn_in(path, key, &place, what);
    };
    match keyword {
        b"Kd" => match parse_color(words) {
            Ok(color) => material.color = Some(color),
            Err(what) => warn("Kd", &|| what.clone()),
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
        // What follows the options is the name, which may have blanks.
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

/// A texture whose alpha is the brightness of the given one, as programs write it where it has none.
fn brightness_as_alpha(texture: &Texture) -> Texture {
    texture.with_alpha_from(|[red, green, blue, _]| {
        // The weights of Rec. 709, in 256ths.
        let sum = 54 * u32::from(red) + 183 * u32::from(green) + 19 * u32::from(blue);
        u8::try_from(sum / 256).unwrap_or(u8::MAX)
    })
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
    use crate::io::LoadSettings;

    fn parsed(text: &[u8]) -> (Library, Report) {
        let mut library = Library::default();
        let mut report = Report::new("x.obj".as_ref(), LoadSettings::default());
        library.parse(text, "x.mtl".as_ref(), &mut report);
        (library, report)
    }

    #[test]
    fn colours_are_linear_and_the_first_of_a_name_counts() {
        let (mut library, mut report) = parsed(
            b"Kd 9 9 9\nnewmtl a b\n Kd 0.5\nnewmtl c\nKd 1 0 nan\nbump x.png\n\
            newmtl a b\nKd 1 1 1\nd 0.5\n",
        );
        let mut look = |name: &[u8]| library.look(name, &mut report);
        assert_eq!(look(b"a b"), Ok(Some(Material::colored(Color::splat(0.5)))));
        assert_eq!(look(b"c"), Ok(None));
        assert_eq!(look(b"d"), Err(UnknownMaterial));
        assert_eq!(
            report.take_lines(),
            [
                "x.mtl:5: Kd must be finite and not negative, got [1, 0, NaN]",
                "x.mtl:6: of textures only map_Kd and map_d are read, not bump 'x.png'",
                "x.mtl:9: a surface that lets light through is seen as opaque: d 0.5",
            ]
        );
    }

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

    #[test]
    fn alpha_is_brightness_where_a_picture_has_none() {
        let texture = Texture::new(2, 1, vec![[255; 4], [0, 0, 0, 255]]).unwrap();
        let alphas = brightness_as_alpha(&texture);
        let alphas: Vec<u8> = alphas.texels().iter().map(|texel| texel[3]).collect();
        assert_eq!(alphas, [255, 0]);
    }
}
