//! MTL: the materials that OBJ files name.

mod statement;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::report::Report;
use super::text::{self, Lines, Words, shown};
use super::{picture, read};
use crate::error::{Place, escape_controls};
use crate::geometry::Color;
use crate::scene::{
    AlphaMode, MapRole, Maps, Material, MetalRough, Model, Object, Texture, TextureMap,
};
use statement::{Map, Stated, cut, state};

/// The materials of all libraries that a file names.
#[derive(Debug, Default)]
pub(super) struct Library {
    /// The materials by name; of two with one name the first counts.
    materials: HashMap<Vec<u8>, Stated>,
    /// The statements and files that were read: each is read once, however often it is named.
    asked: HashSet<Vec<u8>>,
    read: HashSet<PathBuf>,
    /// The pictures that were asked for, by library and name; `None` for those that cannot be read.
    pictures: HashMap<(PathBuf, String), Option<Arc<Texture>>>,
    /// The pictures as masks: opaque where the surface is.
    masks: HashMap<(PathBuf, String), Option<Arc<Texture>>>,
}

impl Stated {
    /// Matte, unless a roughness or a metal is stated.
    fn model(&self) -> Model {
        if self.roughness.is_none() && self.metallic.is_none() {
            return Model::default();
        }
        let usual = MetalRough::default();
        Model::from(MetalRough {
            roughness: self.roughness.unwrap_or(usual.roughness),
            metallic: self.metallic.unwrap_or(usual.metallic),
            ..usual
        })
    }
}

/// The error that no library has a material of that name.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct UnknownMaterial;

impl Library {
    /// The look of a material, if the library states one; reads its textures.
    pub(super) fn look(
        &mut self,
        name: &[u8],
        report: &mut Report,
    ) -> Result<Option<Material>, UnknownMaterial> {
        let stated = self.materials.get(name).ok_or(UnknownMaterial)?;
        let (color, emission, model) =
            (stated.color, stated.emission.unwrap_or(Color::ZERO), stated.model());
        let [color_map, alpha_map] = [&stated.color_map, &stated.alpha_map].map(Clone::clone);
        let is_textured = color_map.is_some() || alpha_map.is_some();
        let color_map = color_map.and_then(|map| self.texture(&map, report));
        let alpha_map = alpha_map.and_then(|map| {
            let texture = self.texture(&map, report)?;
            let mask = self.mask(&map, &texture.texture, report)?;
            Some(TextureMap { texture: mask, ..texture })
        });
        let alpha_mode = match alpha_map {
            Some(_) => AlphaMode::Mask { cutoff: 0.5 },
            None => AlphaMode::Opaque,
        };
        let maps = Maps::default().with(MapRole::Color, color_map);
        let maps = maps.with(MapRole::Alpha, alpha_map);
        let is_plain = emission == Color::ZERO && model == Model::default();
        if color.is_none() && !is_textured && is_plain {
            return Ok(None);
        }
        // Without its textures it is as neutral as an object without a material.
        let usual = if maps.is_empty() && is_plain { Object::NEUTRAL } else { Color::ONE };
        Ok(Some(Material {
            name: escape_controls(&String::from_utf8_lossy(name)).into(),
            model,
            emission,
            maps,
            alpha_mode,
            ..Material::colored(color.unwrap_or(usual))
        }))
    }

    /// A texture that a library names, under the library's folder; `None`, with a warning, if it
    /// cannot be read.
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

    /// A picture as a mask; each is made, and charged, once.
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
        let bytes = size_of_val(picture.texels()) as u64;
        let spent = report.budget.charge_texture(bytes);
        let mask = spent
            .map(|()| Arc::new(brightness_as_alpha(picture)))
            .map_err(|fault| map.warn(&fault.into_error(&map.library).to_string(), report));
        self.masks.insert(key, mask.clone().ok());
        mask.ok()
    }

    /// The picture of a texture; each is read, and warned of, once.
    fn picture(&mut self, map: &Map, report: &mut Report) -> Option<Arc<Texture>> {
        let key = (map.library.clone(), map.name.clone());
        if let Some(known) = self.pictures.get(&key) {
            return known.clone();
        }
        let read = picture::sibling(&map.library, &map.name, report);
        let read = read.map(Arc::new);
        let read = read.map_err(|reason| map.warn(&reason, report));
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
        let path = report.sibling(&String::from_utf8_lossy(name))?;
        if self.read.insert(path.clone()) {
            let bytes = read::sibling_content(&path, report)?;
            self.parse(&text::decode(&bytes), &path, report);
        }
        Ok(())
    }

    fn parse(&mut self, text: &[u8], path: &Path, report: &mut Report) {
        let mut lines = Lines::new(text);
        // A second material of one name is read and ignored.
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
            report.warnings.cut_short(path, Place::Line(lines.number), &why);
        }
    }
}

/// A texture whose alpha is the brightness of the given one, as programs write it where it has
/// none.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::LoadSettings;

    fn parsed(text: &[u8]) -> (Library, Report<'_>) {
        let mut library = Library::default();
        let mut report = Report::new("x.obj".as_ref(), LoadSettings::default(), &());
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
        let named = Material { name: "a b".into(), ..Material::colored(Color::splat(0.5)) };
        assert_eq!(look(b"a b"), Ok(Some(named)));
        assert_eq!(look(b"c"), Ok(None));
        assert_eq!(look(b"d"), Err(UnknownMaterial));
        assert_eq!(
            report.take_lines(),
            [
                "x.mtl:1: Kd is from 0 to 1, got [9, 9, 9]: the surface gives more light than it gets",
                "x.mtl:5: Kd must be finite and not negative, got [1, 0, NaN]",
                "x.mtl:6: of textures only map_Kd and map_d are read, not bump 'x.png'",
                "x.mtl:9: a surface that lets light through is seen as opaque: d 0.5",
            ]
        );
    }

    #[test]
    fn physically_based_numbers_and_emission_are_read() {
        let (mut library, mut report) = parsed(b"newmtl a\nPr 0.25\nPm 1\nKe 2 4 8\nPr 7\n");
        let look = library.look(b"a", &mut report).unwrap().unwrap();
        let expected = MetalRough { roughness: 0.25, metallic: 1.0, ..MetalRough::default() };
        assert_eq!(look.model, Model::from(expected));
        assert_eq!((look.color, look.emission), (Color::ONE, Color::new(2.0, 4.0, 8.0)));
        assert_eq!(report.take_lines(), ["x.mtl:5: Pr must be from 0 to 1, got 7"]);
    }

    #[test]
    fn alpha_is_brightness_where_a_picture_has_none() {
        let texture = Texture::new(2, 1, vec![[255; 4], [0, 0, 0, 255]]).unwrap();
        let alphas = brightness_as_alpha(&texture);
        let alphas: Vec<u8> = alphas.texels().iter().map(|texel| texel[3]).collect();
        assert_eq!(alphas, [255, 0]);
    }
}
