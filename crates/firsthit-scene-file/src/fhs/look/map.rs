//! Textures on surfaces.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::super::number::Number;
use super::missing;
use crate::error::Result;
use crate::scene::{Texture, TextureMap, UvSet};

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
            wrap: map.wrap.map(|wrap| wrap.name().to_owned()),
            filter: map.filter.name().to_owned(),
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
            wrap: [across.parse()?, down.parse()?],
            filter: self.filter.parse()?,
            uv_set: if self.second_uvs { UvSet::Second } else { UvSet::First },
            picture_from_uv: self.picture_from_uv.map(|row| row.map(|Number(number)| number)),
        })
    }
}
