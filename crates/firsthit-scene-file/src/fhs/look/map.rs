//! Textures on surfaces.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::super::number::Number;
use super::missing;
use crate::error::{Error, Result};
use crate::scene::{Filter, Texture, TextureMap, UvSet, Wrap};

/// A texture on a surface. Its texture is named by its place in the record.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::fhs) struct MapRecord {
    texture: usize,
    wrap: [String; 2],
    filter: String,
    /// Whether it takes a mesh's second texture coordinates.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    second_uvs: bool,
    picture_from_uv: [[Number; 3]; 2],
}

impl MapRecord {
    /// The record of a map whose texture has this number.
    pub(in crate::fhs) fn new(map: &TextureMap, texture: usize) -> Self {
        Self {
            texture,
            wrap: map.wrap.map(|wrap| name_of(wrap, &Wrap::NAMES)),
            filter: name_of(map.filter, &Filter::NAMES),
            second_uvs: map.uv_set == UvSet::Second,
            picture_from_uv: map.picture_from_uv.map(|row| row.map(Number)),
        }
    }

    pub(in crate::fhs) fn map(&self, textures: &[Arc<Texture>]) -> Result<TextureMap> {
        let texture = textures.get(self.texture);
        let texture = texture.ok_or_else(|| missing("a texture", self.texture))?;
        let [across, down] = &self.wrap;
        Ok(TextureMap {
            texture: Arc::clone(texture),
            wrap: [named(across, &Wrap::NAMES)?, named(down, &Wrap::NAMES)?],
            filter: named(&self.filter, &Filter::NAMES)?,
            uv_set: if self.second_uvs { UvSet::Second } else { UvSet::First },
            picture_from_uv: self.picture_from_uv.map(|row| row.map(|Number(number)| number)),
        })
    }
}

fn named<T: Copy>(name: &str, known: &[(&'static str, T)]) -> Result<T> {
    let found = known.iter().find(|&&(known, _)| known == name);
    found
        .map(|&(_, value)| value)
        .ok_or_else(|| Error::argument("wrap or filter", "a name that textures know", name))
}

fn name_of<T: Copy + PartialEq>(value: T, known: &[(&'static str, T)]) -> String {
    let found = known.iter().find(|&&(_, known)| known == value);
    found.map_or("", |&(name, _)| name).to_owned()
}
