//! The values of a material's maps at a hit.

use super::SurfaceInteraction;
use crate::geometry::{Color, DVec2, DVec3, unit};
use crate::scene::{AlphaMode, MapRole, TextureMap, UvSet};

impl SurfaceInteraction<'_> {
    /// The texture coordinates that a map takes, where the mesh has them.
    pub(super) fn uv_of(&self, map: &TextureMap) -> Option<DVec2> {
        let (mesh, triangle) = self.mesh?;
        match map.uv_set {
            UvSet::First => mesh.uv(triangle, self.hit.barycentric),
            UvSet::Second => mesh.second_uv(triangle, self.hit.barycentric),
        }
    }

    /// The value of a role's map: red, green, blue and alpha. Colours are linear. `None` without a
    /// map, and without texture coordinates.
    pub fn mapped(&self, role: MapRole) -> Option<[f64; 4]> {
        let map = self.material()?.maps.get(role)?;
        let uv = self.uv_of(map)?;
        if role.is_color() {
            let sample = map.at(uv)?;
            Some(sample.color.extend(sample.alpha).to_array())
        } else {
            map.data_at(uv)
        }
    }

    /// The radiance that the surface gives off to the ray, on both sides: a clear coat keeps some
    /// of it back, and a material that is shown as it is gives off none.
    pub fn emitted(&self) -> Color {
        let Some(material) = self.material() else {
            return Color::ZERO;
        };
        if material.emission == Color::ZERO || material.unlit {
            return Color::ZERO;
        }
        let map = self.mapped(MapRole::Emission);
        let map = map.map_or(Color::ONE, |[r, g, b, _]| Color::new(r, g, b));
        (1.0 - material.model.coat_share(self)) * material.emission * map
    }

    /// The alpha: the material's, times its map's, times the mesh's own. Whether it means anything
    /// is the alpha mode's to say.
    pub fn alpha(&self) -> f64 {
        let Some(material) = self.material() else {
            return 1.0;
        };
        let own = self.mesh.and_then(|(mesh, triangle)| mesh.alpha(triangle, self.hit.barycentric));
        let [color, alpha] = [MapRole::Color, MapRole::Alpha].map(|role| material.maps.get(role));
        let uv = alpha.or(color).and_then(|map| self.uv_of(map));
        material.alpha_at(uv, own.unwrap_or(1.0))
    }

    /// The opacity: the alpha, where the material's mode is [`AlphaMode::Blend`], and otherwise 1.
    pub fn opacity(&self) -> f64 {
        let mode = self.material().map(|material| material.alpha_mode);
        if mode == Some(AlphaMode::Blend) { self.alpha().clamp(0.0, 1.0) } else { 1.0 }
    }

    /// The share of light from all directions that reaches the surface by the occlusion map; 1
    /// without one.
    pub fn occlusion(&self) -> f64 {
        let Some([red, ..]) = self.mapped(MapRole::Occlusion) else {
            return 1.0;
        };
        let strength = self.material().map_or(1.0, |material| material.occlusion_strength);
        1.0 + strength * (red - 1.0)
    }

    /// The normal that the normal map makes of the shading normal, in the world. `side` is -1 for
    /// that of the back. `None` without a map.
    pub(in crate::scene) fn mapped_normal(&self, side: f64) -> Option<DVec3> {
        let scale = self.material()?.normal_scale;
        self.turned(MapRole::Normal, scale).map(|normal| side * normal)
    }

    /// The shading normal by the clear coat's map, with a scale, on a side.
    pub(in crate::scene) fn mapped_coat_normal(&self, scale: f64, side: f64) -> Option<DVec3> {
        self.turned(MapRole::ClearcoatNormal, scale).map(|normal| side * normal)
    }

    fn turned(&self, role: MapRole, scale: f64) -> Option<DVec3> {
        let [red, green, blue, _] = self.mapped(role)?;
        let [x, y, z] = [red, green, blue].map(|share| 2.0 * share - 1.0);
        let map = self.material()?.maps.get(role)?;
        let normal = self.shading_normal();
        let (tangent, bitangent) = self.tangents(map, normal)?;
        let turned = unit(scale * (x * tangent + y * bitangent) + z * normal);
        turned.is_finite().then_some(turned)
    }

    /// The directions in which a normal map's columns and, upwards, its rows run: across the
    /// normal, in the world.
    fn tangents(&self, map: &TextureMap, normal: DVec3) -> Option<(DVec3, DVec3)> {
        let (mesh, triangle) = self.mesh?;
        let (tangent, is_flipped) =
            mesh.tangent(triangle, self.hit.barycentric).or_else(|| self.along(map))?;
        let to_world = self.object.transform().world_from_object().matrix3;
        let tangent = to_world * tangent;
        let tangent = unit(tangent - tangent.dot(normal) * normal);
        // A mirror turns normal and tangent, and not their product.
        let is_mirrored = to_world.determinant() < 0.0;
        let sign = if is_flipped == is_mirrored { 1.0 } else { -1.0 };
        tangent.is_finite().then(|| (tangent, sign * normal.cross(tangent)))
    }

    /// The direction in which the map's columns run, in object space, from texture coordinates, for
    /// a mesh without tangents; and whether the picture is mirrored.
    fn along(&self, map: &TextureMap) -> Option<(DVec3, bool)> {
        let (mesh, triangle) = self.mesh?;
        let uvs = match map.uv_set {
            UvSet::First => mesh.uvs(),
            UvSet::Second => mesh.second_uvs(),
        };
        let (along, area) = mesh.along_columns(uvs?, triangle);
        let [[m, n, _], [o, p, _]] = map.picture_from_uv;
        // Rows run downwards: a picture that is not mirrored turns the other way round than its
        // surface.
        let is_flipped = (area > 0.0) == (m * p - n * o > 0.0);
        Some((area.signum() * along, is_flipped))
    }
}
