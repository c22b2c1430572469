//! The look of a surface, and its alpha cut-outs.

mod bsdf;
mod glass;
mod maps;
mod matte;
mod metal_rough;
mod model;

use std::sync::Arc;

#[doc(hidden)]
pub use bsdf::Lambertian;
pub use bsdf::{Bsdf, BsdfSample};
pub use glass::Glass;
pub use maps::{MapRole, Maps};
pub use matte::Matte;
pub use metal_rough::MetalRough;
pub use model::Model;

use super::texture::{Sample, TextureMap};
use crate::error::Result;
use crate::geometry::{Color, DVec2, require};

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
    /// The opacity from 0, transparent, to 1, opaque. The mesh's own alpha and the map's multiply
    /// it.
    pub alpha: f64,
    /// The scattering model.
    pub model: Model,
    /// The radiance that it gives off. The emission map multiplies it.
    pub emission: Color,
    /// The textures, for meshes with texture coordinates.
    pub maps: Maps,
    /// The factor on the steepness of the normal map.
    pub normal_scale: f64,
    /// The weight of the occlusion map, from 0 to 1.
    pub occlusion_strength: f64,
    /// The meaning of alpha.
    pub alpha_mode: AlphaMode,
    /// Whether the colour is seen as it is, whatever the light.
    pub unlit: bool,
    /// Whether the file says that both sides are to be seen. Rays meet both in any case.
    pub double_sided: bool,
}

/// The meaning of a surface's alpha.
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
    /// Alpha means nothing: all of the surface is there.
    #[default]
    Opaque,
    /// The surface is cut out where alpha is below the cutoff: rays pass.
    Mask {
        /// The least alpha that is there.
        cutoff: f64,
    },
    /// The surface is translucent: it hides as much of what is behind it as alpha says. Rays of
    /// queries meet it as any other.
    Blend,
}

impl AlphaMode {
    /// The name: `opaque`, `mask` or `blend`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Opaque => "opaque",
            Self::Mask { .. } => "mask",
            Self::Blend => "blend",
        }
    }

    /// The least alpha that is there, of a mask.
    pub fn cutoff(self) -> Option<f64> {
        match self {
            Self::Mask { cutoff } => Some(cutoff),
            Self::Opaque | Self::Blend => None,
        }
    }
}

impl Default for Material {
    /// White, opaque, lit, matte.
    fn default() -> Self {
        Self::colored(Color::ONE)
    }
}

impl Material {
    /// Whether the material is a plain Lambertian one: light is scattered evenly, and nothing else.
    pub(in crate::scene) fn is_plain_matte(&self) -> bool {
        let has = |role| self.maps.get(role).is_some();
        matches!(self.model, Model::Matte(_))
            && self.emission == Color::ZERO
            && !self.unlit
            && !has(MapRole::Normal)
            && !has(MapRole::Occlusion)
    }

    /// Matte, opaque, of one linear colour.
    pub fn colored(color: Color) -> Self {
        Self {
            name: Arc::default(),
            color,
            alpha: 1.0,
            model: Model::default(),
            emission: Color::ZERO,
            maps: Maps::default(),
            normal_scale: 1.0,
            occlusion_strength: 1.0,
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

    /// Fails for numbers that make no sense: a light or a strength that is not finite, a setting of
    /// its model out of its domain.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument), with the number's name.
    pub fn check_numbers(&self) -> Result<()> {
        let Self { normal_scale, occlusion_strength, .. } = *self;
        self.check_emission()?;
        require("normal_scale", "finite", normal_scale.is_finite(), normal_scale)?;
        let is_share = (0.0..=1.0).contains(&occlusion_strength);
        require("occlusion_strength", "from 0 to 1", is_share, occlusion_strength)?;
        self.model.check()
    }

    /// Fails for an emission that is negative or not finite.
    pub(in crate::scene) fn check_emission(&self) -> Result<()> {
        require(
            "emission",
            "a colour of finite numbers that are not negative",
            self.emission.is_finite() && self.emission.min_element() >= 0.0,
            self.emission,
        )
    }

    /// Whether it may let light through by its alpha: whether its mode is [`AlphaMode::Blend`].
    pub fn is_translucent(&self) -> bool {
        self.alpha_mode == AlphaMode::Blend
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
        self.alpha_at(uv, own) < cutoff
    }

    /// The alpha at texture coordinates, where the mesh's own is `own`.
    pub fn alpha_at(&self, uv: Option<DVec2>, own: f64) -> f64 {
        let [color, alpha] = [MapRole::Color, MapRole::Alpha].map(|role| self.maps.get(role));
        let map = alpha.or(color);
        self.alpha * own * sample(map, uv).map_or(1.0, |sample| sample.alpha)
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
        let mut material = Material { alpha: 0.5, ..Material::default() };
        assert!(!material.is_cut_out(None, 0.1));
        material.alpha_mode = AlphaMode::Mask { cutoff: 0.4 };
        assert!(!material.is_cut_out(None, 1.0));
        assert!(!material.is_cut_out(None, 0.8));
        assert!(material.is_cut_out(None, 0.7));
        material.alpha_mode = AlphaMode::Blend;
        assert!(!material.is_cut_out(None, 0.1));
    }
}
