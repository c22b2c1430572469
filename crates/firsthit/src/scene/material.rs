//! What a surface looks like, and where it has holes.

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
    /// The linear colour, which a mesh's own colours and the texture multiply.
    pub color: Color,
    /// From 0, not there, to 1, opaque; multiplied likewise.
    pub alpha: f64,
    /// A texture for colour and alpha, for meshes with texture coordinates.
    pub texture: Option<TextureMap>,
    /// A texture of its own for alpha, in place of the other's.
    pub alpha_texture: Option<TextureMap>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Whether the colour is seen as it is, whatever the light.
    pub unlit: bool,
    /// Whether the file says that both sides are to be seen. Rays meet both in any case.
    pub double_sided: bool,
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
/// assert!(leaf.may_have_holes());
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
    /// How much of what is behind shows through. Opaque for now: loaders warn of it.
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
            color,
            alpha: 1.0,
            texture: None,
            alpha_texture: None,
            alpha_mode: AlphaMode::Opaque,
            unlit: false,
            double_sided: true,
        }
    }

    /// The linear colour at texture coordinates, if the surface has any.
    pub fn color_at(&self, uv: Option<DVec2>) -> Color {
        self.color * sample(self.texture.as_ref(), uv).map_or(Color::ONE, |sample| sample.color)
    }

    /// Whether alpha can make holes at all.
    pub fn may_have_holes(&self) -> bool {
        matches!(self.alpha_mode, AlphaMode::Mask { .. })
    }

    /// Whether the surface has a hole at texture coordinates, its own alpha there being `own`.
    pub fn is_hole(&self, uv: Option<DVec2>, own: f64) -> bool {
        let AlphaMode::Mask { cutoff } = self.alpha_mode else {
            return false;
        };
        let map = self.alpha_texture.as_ref().or(self.texture.as_ref());
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
    fn alpha_makes_holes_only_where_it_is_a_mask() {
        let mut material = Material {
            alpha: 0.5,
            ..Material::default()
        };
        assert!(!material.is_hole(None, 0.1));
        material.alpha_mode = AlphaMode::Mask { cutoff: 0.4 };
        assert!(!material.is_hole(None, 1.0));
        assert!(!material.is_hole(None, 0.8));
        assert!(material.is_hole(None, 0.7));
        material.alpha_mode = AlphaMode::Blend;
        assert!(!material.is_hole(None, 0.1));
    }
}
