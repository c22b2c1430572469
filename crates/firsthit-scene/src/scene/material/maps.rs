//! The textures of a material, and what each is for.

use crate::geometry::names;
use crate::scene::TextureMap;

/// Makes [`MapRole`] and what depends on the list of roles: a name, and whether the texture holds
/// colours. Their levels are encoded as sRGB, those of all others are the numbers themselves.
macro_rules! roles {
    ($($(#[doc = $about:literal])* $name:literal => $role:ident, $is_color:literal;)*) => {
        /// The role of a texture in a material.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum MapRole {
            $($(#[doc = $about])* $role,)*
        }

        names! { MapRole, "texture": $($name => $role;)* }

        impl MapRole {
            /// Whether its textures hold colours, in sRGB.
            pub(crate) fn is_color(self) -> bool {
                match self { $(Self::$role => $is_color,)* }
            }
        }
    };
}

roles! {
    /// The colour; the alpha too, unless there is a map for that.
    "color" => Color, true;
    /// The alpha.
    "alpha" => Alpha, true;
    /// Green multiplies the roughness, blue the metallic.
    "metallic_roughness" => MetallicRoughness, false;
    /// The normal, in the space of tangent, bitangent and normal.
    "normal" => Normal, false;
    /// Red says how much of the light from all around reaches the surface.
    "occlusion" => Occlusion, false;
    /// Multiplies the emission.
    "emission" => Emission, true;
    /// Red multiplies the transmission.
    "transmission" => Transmission, false;
    /// Alpha multiplies the specular.
    "specular" => Specular, false;
    /// Multiplies the specular colour.
    "specular_color" => SpecularColor, true;
    /// Red multiplies the clear coat.
    "clearcoat" => Clearcoat, false;
    /// Green multiplies the roughness of the coat.
    "clearcoat_roughness" => ClearcoatRoughness, false;
    /// The normal of the coat.
    "clearcoat_normal" => ClearcoatNormal, false;
    /// Multiplies the colour of the sheen.
    "sheen_color" => SheenColor, true;
    /// Alpha multiplies the roughness of the sheen.
    "sheen_roughness" => SheenRoughness, false;
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
pub struct Maps(Vec<(MapRole, TextureMap)>);

impl Maps {
    /// The map of a role.
    pub fn get(&self, role: MapRole) -> Option<&TextureMap> {
        let found = self.0.iter().find(|(known, _)| *known == role);
        found.map(|(_, map)| map)
    }

    /// The maps with another one, or none, for a role.
    pub fn with(mut self, role: MapRole, map: impl Into<Option<TextureMap>>) -> Self {
        self.0.retain(|(known, _)| *known != role);
        if let Some(map) = map.into() {
            let place = self.0.partition_point(|(known, _)| *known < role);
            self.0.insert(place, (role, map));
        }
        self
    }

    /// Whether no role has a map.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All maps, in the order of [`MapRole::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = &TextureMap> {
        self.roles().map(|(_, map)| map)
    }

    /// All maps with their roles, in the order of [`MapRole::ALL`].
    pub fn roles(&self) -> impl Iterator<Item = (MapRole, &TextureMap)> {
        self.0.iter().map(|(role, map)| (*role, map))
    }
}
