//! The attributes of a mesh: of vertices and corners, faces, slots, numbers by name.

use crate::error::{Error, Result};
use crate::geometry::{DVec2, DVec3};
use crate::shape::property::Counts;
use crate::shape::{Attribute, Mesh, Property, PropertyOf, PropertyValues};

/// Makes a function for each attribute of vertices or corners, of so many numbers each.
macro_rules! attributes {
    ($($(#[$about:meta])+ $with:ident $name:ident $numbers:literal)+) => {$(
        $(#[$about])+
        ///
        /// # Errors
        ///
        /// [`Error::Argument`] when they do not fit the mesh.
        pub fn $with(mut self, $name: Attribute<$numbers>) -> Result<Self> {
            $name.check(stringify!($name), self.positions.len(), &self.triangles)?;
            self.$name = Some($name);
            Ok(self)
        }
    )+};
}

impl Mesh {
    /// The mesh with the polygon of the file that each triangle was part of.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when there are not as many `faces` as triangles, or one is no
    /// identifier: 2^31 or more.
    pub fn with_faces(mut self, faces: Vec<u32>) -> Result<Self> {
        if faces.len() != self.triangles.len() {
            return Err(Error::argument("faces", "one for each triangle", faces.len()));
        }
        if let Some(&face) = faces.iter().find(|&&face| i32::try_from(face).is_err()) {
            return Err(Error::argument("faces", "below 2^31", face));
        }
        self.faces = Some(faces.into());
        Ok(self)
    }

    attributes! {
        /// The mesh with shading normals, in object space; they need not be of length one.
        with_normals normals 3
        /// The mesh with texture coordinates.
        with_uvs uvs 2
        /// The mesh with a second set of texture coordinates, for textures that take it.
        with_second_uvs second_uvs 2
        /// The mesh with tangents, in object space, for normal maps: the direction in which the
        /// map's columns run, and 1, or -1 where the bitangent is not normal times tangent but the
        /// opposite.
        with_tangents tangents 4
        /// The mesh with linear colours, which the object's own colour multiplies.
        with_colors colors 3
        /// The mesh with an alpha of its own, which a material's multiplies.
        with_alphas alphas 1
    }

    /// The mesh with a slot for each triangle: the index of its object's material.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when there are not as many `slots` as triangles.
    pub fn with_slots(mut self, slots: Vec<u32>) -> Result<Self> {
        if slots.len() != self.triangles.len() {
            let expected = "one for each triangle";
            return Err(Error::argument("slots", expected, slots.len()));
        }
        self.slots = Some(slots.into());
        Ok(self)
    }

    /// The mesh with numbers by name, in place of those it had.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when they are not as many as what has them.
    pub fn with_properties(mut self, properties: Vec<Property>) -> Result<Self> {
        let last = (0..self.triangles.len()).map(|k| self.face(k) + 1).max();
        let counts = Counts {
            vertices: self.positions.len(),
            triangles: self.triangles.len(),
            faces: last.unwrap_or(0),
        };
        for property in &properties {
            property.check(&counts)?;
        }
        self.properties = properties;
        Ok(self)
    }

    /// The numbers that it has by name.
    #[inline]
    pub fn properties(&self) -> &[Property] {
        &self.properties
    }

    /// The numbers of that name.
    pub fn property(&self, of: PropertyOf, name: &str) -> Option<&PropertyValues> {
        let mut properties = self.properties.iter();
        let found = properties.find(|property| property.of == of && property.name == name);
        found.map(|property| &property.values)
    }

    /// The polygon that each triangle was part of, where the mesh has polygons.
    #[inline]
    pub fn faces(&self) -> Option<&[u32]> {
        self.faces.as_deref()
    }

    /// The shading normals, in object space, not of length one.
    #[inline]
    pub fn normals(&self) -> Option<&Attribute<3>> {
        self.normals.as_ref()
    }

    /// The texture coordinates.
    #[inline]
    pub fn uvs(&self) -> Option<&Attribute<2>> {
        self.uvs.as_ref()
    }

    /// The second set of texture coordinates.
    #[inline]
    pub fn second_uvs(&self) -> Option<&Attribute<2>> {
        self.second_uvs.as_ref()
    }

    /// The tangents, in object space; see [`with_tangents`](Self::with_tangents).
    #[inline]
    pub fn tangents(&self) -> Option<&Attribute<4>> {
        self.tangents.as_ref()
    }

    /// The linear colours.
    #[inline]
    pub fn colors(&self) -> Option<&Attribute<3>> {
        self.colors.as_ref()
    }

    /// The alphas.
    #[inline]
    pub fn alphas(&self) -> Option<&Attribute<1>> {
        self.alphas.as_ref()
    }

    /// The slot of each triangle, where the mesh has more than one.
    #[inline]
    pub fn slots(&self) -> Option<&[u32]> {
        self.slots.as_deref()
    }

    /// The polygon that a triangle was part of; without polygons, the triangle's own index.
    pub fn face(&self, triangle: usize) -> usize {
        self.faces.as_ref().map_or(triangle, |faces| faces[triangle] as usize)
    }

    /// The shading normal in object space, interpolated and not of length one; `None` where the
    /// mesh has none.
    #[inline]
    pub fn shading_normal(&self, triangle: usize, barycentric: DVec2) -> Option<DVec3> {
        self.normals
            .as_ref()
            .map(|normals| DVec3::from(self.between(normals, triangle, barycentric)))
    }

    /// The texture coordinates; `None` where the mesh has none.
    pub fn uv(&self, triangle: usize, barycentric: DVec2) -> Option<DVec2> {
        self.uvs.as_ref().map(|uvs| DVec2::from(self.between(uvs, triangle, barycentric)))
    }

    /// The second texture coordinates; `None` where the mesh has none.
    pub fn second_uv(&self, triangle: usize, barycentric: DVec2) -> Option<DVec2> {
        let uvs = self.second_uvs.as_ref()?;
        Some(DVec2::from(self.between(uvs, triangle, barycentric)))
    }

    /// The tangent in object space, not of length one, and whether the bitangent is the opposite of
    /// normal times tangent; `None` where the mesh has none.
    pub fn tangent(&self, triangle: usize, barycentric: DVec2) -> Option<(DVec3, bool)> {
        let tangents = self.tangents.as_ref()?;
        let [x, y, z, sign] = self.between(tangents, triangle, barycentric);
        Some((DVec3::new(x, y, z), sign < 0.0))
    }

    /// The linear colour; `None` where the mesh has none.
    #[inline]
    pub fn color(&self, triangle: usize, barycentric: DVec2) -> Option<DVec3> {
        self.colors.as_ref().map(|colors| DVec3::from(self.between(colors, triangle, barycentric)))
    }

    /// The alpha of its own; `None` where the mesh has none.
    pub fn alpha(&self, triangle: usize, barycentric: DVec2) -> Option<f64> {
        self.alphas.as_ref().map(|alphas| {
            let [alpha] = self.between(alphas, triangle, barycentric);
            alpha
        })
    }

    /// The slot of a triangle: the index of its object's material.
    #[inline]
    pub fn slot(&self, triangle: usize) -> usize {
        self.slots.as_ref().map_or(0, |slots| slots[triangle] as usize)
    }

    /// Whether all of a triangle's points look alike as far as holes are concerned: of two
    /// triangles in one place the first then hides the other.
    pub(crate) fn has_plain_triangles(&self) -> bool {
        self.uvs.is_none()
            && self.second_uvs.is_none()
            && self.slots.is_none()
            && self.alphas.is_none()
    }

    fn between<const N: usize>(
        &self,
        attribute: &Attribute<N>,
        triangle: usize,
        barycentric: DVec2,
    ) -> [f64; N] {
        let weights = [1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y];
        attribute.interpolate(triangle, self.triangles[triangle], weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Positions;

    fn square() -> Mesh {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh::new(Positions::compact(points), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    #[test]
    fn attributes_are_weighted_by_the_corners() {
        let colors = Attribute::per_vertex(vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0; 3],
        ]);
        let mesh = square().with_colors(colors).unwrap();
        assert_eq!(mesh.color(0, DVec2::new(0.5, 0.25)).unwrap(), DVec3::new(0.25, 0.5, 0.25));
        assert_eq!(mesh.color(1, DVec2::new(0.0, 1.0)).unwrap(), DVec3::ONE);
    }
}
