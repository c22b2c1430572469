//! Tangents for normal maps, where the file has none: as tools that bake such maps make them
//! (Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008; `MikkTSpace`).
//!
//! Triangles that agree at a corner in place, normal and texture coordinates share its tangent,
//! unless the map is mirrored on one of them: the mean of theirs, across the normal, by their
//! angles there. (`MikkTSpace` tells two fans apart that only touch in a point; here they are one.)

use std::collections::HashMap;

use crate::geometry::{DVec2, DVec3, unit};
use crate::shape::{Attribute, Mesh};

/// The identity of a corner: the bits of its place, its normal and its texture coordinates, and
/// whether the map is mirrored.
type Key = ([u64; 3], [u32; 3], [u32; 2], bool);

/// The tangent of a corner so far.
#[derive(Debug, Clone, Copy)]
struct Sum {
    tangent: DVec3,
    is_mirrored: bool,
}

impl Mesh {
    /// Tangents for normal maps by these texture coordinates, for
    /// [`with_tangents`](Self::with_tangents), as `MikkTSpace` makes them (Mikkelsen, "Simulation
    /// of Wrinkled Surfaces Revisited", 2008). Of texture coordinates that run downwards, as in
    /// glTF.
    ///
    /// Each is x, y and z of the direction in which the map's columns run, across the vertex'
    /// normal (or without normals the face's own), in object space and of length one, or zero where
    /// there is none; and 1 or -1, which the bitangent, normal cross tangent, is to be multiplied
    /// by. Corners with the same place, normal and texture coordinates share one.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for coordinates that do not fit the mesh.
    pub fn made_tangents(&self, uvs: &Attribute<2>) -> crate::error::Result<Attribute<4>> {
        uvs.check("uvs", self.positions.len(), &self.triangles)?;
        let (mut known, mut sums) = (HashMap::<Key, u32>::new(), Vec::<Sum>::new());
        let corners = (0..self.triangles.len()).map(|triangle| {
            let corners = self.with_uvs_of(uvs, triangle);
            let (along, area) = self.along_columns(uvs, triangle);
            let is_mirrored = area > 0.0;
            // Written so that a NaN fails, as coordinates do that are all on a line.
            let along = if is_mirrored {
                along
            } else if area < 0.0 {
                -along
            } else {
                DVec3::ZERO
            };
            [0, 1, 2].map(|corner| {
                let here = &corners[corner];
                let next = sums.len();
                let number = *known.entry(here.key(is_mirrored)).or_insert_with(|| {
                    sums.push(Sum { tangent: DVec3::ZERO, is_mirrored });
                    u32::try_from(next).unwrap_or(u32::MAX)
                });
                let others = [1, 2].map(|k| corners[(corner + k) % 3].position);
                if let Some(tangent) = here.weighted(along, others) {
                    sums[number as usize].tangent += tangent;
                }
                number
            })
        });
        let corners: Vec<[u32; 3]> = corners.collect();
        Ok(Attribute {
            values: sums.iter().map(Sum::value).collect(),
            corners: Some(corners.into()),
        })
    }

    /// The direction in which the columns of a map run on a triangle, or where the area is negative
    /// the opposite one, in object space; and twice the triangle's signed area in texture
    /// coordinates, with which the direction's length grows.
    #[doc(hidden)]
    pub fn along_columns(&self, uvs: &Attribute<2>, triangle: usize) -> (DVec3, f64) {
        let [a, b, c] = self.corners(triangle);
        let uvs = uvs.of_triangle(triangle, self);
        let [uv_a, uv_b, uv_c] = uvs.map(|uv| DVec2::from(uv.map(f64::from)));
        let (b, c, uv_b, uv_c) = (b - a, c - a, uv_b - uv_a, uv_c - uv_a);
        (uv_c.y * b - uv_b.y * c, uv_b.perp_dot(uv_c))
    }

    fn with_uvs_of(&self, uvs: &Attribute<2>, triangle: usize) -> [Corner; 3] {
        let positions = self.corners(triangle);
        let own = self.normal(triangle).as_vec3().to_array();
        let normals = (self.normals.as_ref()).map(|normals| normals.of_triangle(triangle, self));
        let uvs = uvs.of_triangle(triangle, self);
        [0, 1, 2].map(|k| Corner {
            position: positions[k],
            normal: normals.map_or(own, |normals| normals[k]),
            uv: uvs[k],
        })
    }
}

impl Sum {
    /// The tangent, and what the bitangent is to be multiplied by: rows of maps run downwards, so
    /// that a map that is not mirrored turns the other way round than its surface.
    #[expect(clippy::cast_possible_truncation, reason = "of length one, or zero")]
    fn value(&self) -> [f32; 4] {
        let tangent = self.tangent.try_normalize().unwrap_or(DVec3::ZERO);
        let [x, y, z] = tangent.to_array().map(|x| x as f32);
        [x, y, z, if self.is_mirrored { -1.0 } else { 1.0 }]
    }
}

struct Corner {
    position: DVec3,
    normal: [f32; 3],
    uv: [f32; 2],
}

impl Corner {
    fn key(&self, is_mirrored: bool) -> Key {
        // Zeros have a sign that makes no difference.
        let position = (self.position + DVec3::ZERO).to_array().map(f64::to_bits);
        let bits = |x: f32| (x + 0.0).to_bits();
        (position, self.normal.map(bits), self.uv.map(bits), is_mirrored)
    }

    /// A triangle's tangent across the normal, by the triangle's angle here. `None` where there is
    /// no such thing.
    fn weighted(&self, along: DVec3, others: [DVec3; 2]) -> Option<DVec3> {
        let normal = unit(DVec3::from(self.normal.map(f64::from)));
        let across = |vector: DVec3| (vector - vector.dot(normal) * normal).try_normalize();
        let [a, b] = others.map(|other| across(other - self.position));
        let angle = libm::acos(a?.dot(b?).clamp(-1.0, 1.0));
        Some(angle * across(along)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Positions;

    fn triangle(uvs: [[f32; 2]; 3]) -> Attribute<4> {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let mesh = Mesh::new(Positions::compact(points), vec![[0, 1, 2]]).unwrap();
        let uvs = Attribute::per_vertex(uvs.to_vec());
        mesh.made_tangents(&uvs).unwrap()
    }

    #[test]
    fn a_tangent_runs_as_the_columns_of_the_map_do() {
        // Columns along x, rows downwards along -y.
        let plain = triangle([[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]);
        assert_eq!(plain.at_corners(0, [0, 1, 2]), [[1.0, 0.0, 0.0, 1.0]; 3]);
        let mirrored = triangle([[1.0, 1.0], [0.0, 1.0], [1.0, 0.0]]);
        assert_eq!(mirrored.at_corners(0, [0, 1, 2]), [[-1.0, 0.0, 0.0, -1.0]; 3]);
        let turned = triangle([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]);
        assert_eq!(turned.at_corners(0, [0, 1, 2]), [[0.0, 1.0, 0.0, 1.0]; 3]);
    }

    #[test]
    fn coordinates_without_an_area_give_no_tangent_and_no_nan() {
        let none = triangle([[0.3; 2]; 3]);
        assert_eq!(none.at_corners(0, [0, 1, 2]), [[0.0, 0.0, 0.0, 1.0]; 3]);
        for uvs in [[[f32::MAX, 0.0], [-f32::MAX, 1.0], [0.0, f32::MAX]], [[f32::NAN; 2]; 3]] {
            let all = triangle(uvs);
            assert!(all.values.iter().flatten().all(|x| x.is_finite()), "{all:?}");
        }
    }
}
