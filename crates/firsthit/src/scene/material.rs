//! The look of a surface, and its alpha cut-outs.

use std::sync::Arc;

use super::texture::{Sample, TextureMap};
use crate::geometry::{Color, DVec2};

/// The look of a surface.
///
/// ```
/// use firsthit::{Color, DVec3, Material, Object, Sphere};
///
/// let glowing = Material { unlit: true, ..Material::colored(Color::new(1.0, 0.9, 0.5)) };
/// let lamp = Object::new(Sphere::new(DVec3::ZERO, 0.1)?).with_materials([glowing]);
/// assert_eq!(lamp.color(), Color::new(1.0, 0.9, 0.5));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// A name, which may be empty and changes no picture.
    pub name: Arc<str>,
    /// The linear colour. The mesh's own colours and the colour map multiply it.
    pub color: Color,
    /// From 0, transparent, to 1, opaque. The mesh's own alpha and the map's multiply it.
    pub alpha: f64,
    /// The textures, for meshes with texture coordinates.
    pub maps: Maps,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Whether the colour is seen as it is, whatever the light.
    pub unlit: bool,
    /// Whether the file says that both sides are to be seen. Rays meet both in any case.
    pub double_sided: bool,
}

/// What a texture of a material is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MapRole {
    /// The colour; the alpha too, unless there is a map for that.
    Color,
    /// The alpha.
    Alpha,
}

impl MapRole {
    /// Every role, in the order of [`Maps`].
    pub const ALL: [Self; 2] = [Self::Color, Self::Alpha];
}

/// The textures of a material: at most one for each role.
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::scene::{MapRole, Maps};
/// use firsthit::{Material, Texture, TextureMap};
///
/// let texture = Arc::new(Texture::new(1, 1, vec![[255, 0, 0, 255]])?);
/// let map = TextureMap::new(texture, TextureMap::V_UP);
/// let red = Material { maps: Maps::default().with(MapRole::Color, map), ..Material::default() };
/// assert!(red.maps.get(MapRole::Color).is_some() && red.maps.get(MapRole::Alpha).is_none());
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Maps([Option<TextureMap>; MapRole::ALL.len()]);

impl Maps {
    /// The map of a role.
    pub fn get(&self, role: MapRole) -> Option<&TextureMap> {
        self.0[role as usize].as_ref()
    }

    /// The same maps with another one, or none, for a role.
    pub fn with(mut self, role: MapRole, map: impl Into<Option<TextureMap>>) -> Self {
        self.0[role as usize] = map.into();
        self
    }

    /// Whether no role has a map.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// All maps, in the order of [`MapRole::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = &TextureMap> {
        self.0.iter().flatten()
    }
}

/// What a surface's alpha means.
///
/// ```
/// use firsthit::{AlphaMode, Material};
///
/// // Half there: with a cutoff of 0.6 rays pass through it.
/// let leaf = Material {
///     alpha: 0.5,
///     alpha_mode: AlphaMode::Mask { cutoff: 0.6 },
///     ..Material::default()
/// };
/// assert!(leaf.has_cutouts());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum AlphaMode {
    /// Nothing: all of the surface is there.
    #[default]
    Opaque,
    /// Where alpha is below the cutoff there is no surface: rays pass.
    Mask {
        /// The least alpha that is there.
        cutoff: f64,
    },
    /// The surface is translucent. Opaque for now: loaders warn of it.
    Blend,
}

impl Default for Material {
    /// White, opaque, lit.
    fn default() -> Self {
        Self::colored(Color::ONE)
    }
}

impl Material {
    /// Opaque, of one linear colour.
    pub fn colored(color: Color) -> Self {
        Self {
            name: Arc::default(),
            color,
            alpha: 1.0,
            maps: Maps::default(),
            alpha_mode: AlphaMode::Opaque,
            unlit: false,
            double_sided: true,
        }
    }

    /// The linear colour at texture coordinates, if the surface has any.
    pub fn color_at(&self, uv: Option<DVec2>) -> Color {
        let sample = sample(self.maps.get(MapRole::Color), uv);
        self.color * sample.map_or(Color::ONE, |sample| sample.color)
    }

    /// Whether alpha cuts anything out: whether it is a mask.
    pub fn has_cutouts(&self) -> bool {
        matches!(self.alpha_mode, AlphaMode::Mask { .. })
    }

    /// Whether the surface is cut out at texture coordinates, where the mesh's own alpha is `own`.
    pub fn is_cut_out(&self, uv: Option<DVec2>, own: f64) -> bool {
        let AlphaMode::Mask { cutoff } = self.alpha_mode else {
            return false;
        };
        let [color, alpha] = [MapRole::Color, MapRole::Alpha].map(|role| self.maps.get(role));
        let map = alpha.or(color);
        self.alpha * own * sample(map, uv).map_or(1.0, |sample| sample.alpha) < cutoff
    }
}

fn sample(map: Option<&TextureMap>, uv: Option<DVec2>) -> Option<Sample> {
    map?.at(uv?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_cuts_out_only_where_it_is_a_mask() {
        let mut material = Material {
            alpha: 0.5,
            ..Material::default()
        };
        assert!(!material.is_cut_out(None, 0.1));
        material.alpha_mode = AlphaMode::Mask { cutoff: 0.4 };
        assert!(!material.is_cut_out(None, 1.0));
        assert!(!material.is_cut_out(None, 0.8));
        assert!(material.is_cut_out(None, 0.7));
        material.alpha_mode = AlphaMode::Blend;
        assert!(!material.is_cut_out(None, 0.1));
    }
}
