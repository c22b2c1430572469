//! A mesh's attributes by their names, looked up at points of its triangles.

use super::Mesh;
use crate::geometry::DVec2;
use crate::shape::property::{PointOfTriangle, mean};
use crate::shape::{Attribute, Property, PropertyOf};

/// An attribute of a mesh, found by its name: one of its properties, or `normals`, `uvs`,
/// `second_uvs`, `tangents`, `colors` or `alphas`.
#[derive(Debug, Clone, Copy)]
pub struct NamedAttribute<'a> {
    mesh: &'a Mesh,
    name: &'a str,
    values: Values<'a>,
}

#[derive(Debug, Clone, Copy)]
enum Values<'a> {
    Property(&'a Property),
    One(&'a Attribute<1>),
    Two(&'a Attribute<2>),
    Three(&'a Attribute<3>),
    Four(&'a Attribute<4>),
}

impl Mesh {
    /// All attributes: the properties in their order, then `normals`, `uvs` and the others of a
    /// mesh where the mesh has them.
    ///
    /// ```
    /// use firsthit::shape::{Property, PropertyOf, PropertyValues};
    /// use firsthit::{DVec2, Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let heat = PropertyValues::Single(vec![10.0, 20.0, 40.0].into());
    /// let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2]])?;
    /// let mesh = mesh.with_properties(vec![Property::new("heat", PropertyOf::Vertices, heat)])?;
    /// let heat = mesh.attributes().next().expect("there is one");
    /// assert_eq!((heat.name(), heat.components()), ("heat", 1));
    /// let mut value = [0.0];
    /// heat.look_up(0, DVec2::new(0.25, 0.5), &mut value);
    /// assert_eq!(value, [0.25 * 10.0 + 0.25 * 20.0 + 0.5 * 40.0]);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn attributes(&self) -> impl Iterator<Item = NamedAttribute<'_>> {
        let named = |property| (property_name(property), Values::Property(property));
        let own = [
            ("normals", self.normals.as_ref().map(Values::Three)),
            ("uvs", self.uvs.as_ref().map(Values::Two)),
            ("second_uvs", self.second_uvs.as_ref().map(Values::Two)),
            ("tangents", self.tangents.as_ref().map(Values::Four)),
            ("colors", self.colors.as_ref().map(Values::Three)),
            ("alphas", self.alphas.as_ref().map(Values::One)),
        ];
        let own = own.into_iter();
        let own = own.filter_map(|(name, values)| Some((name, values?)));
        let all = self.properties.iter().map(named).chain(own);
        all.map(|(name, values)| NamedAttribute { mesh: self, name, values })
    }

    /// The attribute of that name. Where several have it, `of` chooses, or else the corners' comes
    /// before the vertices', and that before the faces'. A property comes before `normals`, `uvs`
    /// and the others of a mesh.
    pub fn attribute(&self, name: &str, of: Option<PropertyOf>) -> Option<NamedAttribute<'_>> {
        let rank = |of| match of {
            PropertyOf::Corners => 0,
            PropertyOf::Vertices => 1,
            PropertyOf::Faces => 2,
        };
        let named = self
            .attributes()
            .filter(|found| found.name == name && of.is_none_or(|of| found.of() == of));
        // Of equal ones the first.
        named.min_by_key(|found| (found.is_own(), rank(found.of())))
    }
}

fn property_name(property: &Property) -> &str {
    &property.name
}

impl<'a> NamedAttribute<'a> {
    /// The name.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// The elements that have the values.
    pub fn of(&self) -> PropertyOf {
        let has_corners = match self.values {
            Values::Property(property) => return property.of,
            Values::One(attribute) => attribute.corners.is_some(),
            Values::Two(attribute) => attribute.corners.is_some(),
            Values::Three(attribute) => attribute.corners.is_some(),
            Values::Four(attribute) => attribute.corners.is_some(),
        };
        if has_corners { PropertyOf::Corners } else { PropertyOf::Vertices }
    }

    /// The number of components of a value.
    pub fn components(&self) -> usize {
        match self.values {
            Values::Property(property) => property.components,
            Values::One(_) => 1,
            Values::Two(_) => 2,
            Values::Three(_) => 3,
            Values::Four(_) => 4,
        }
    }

    /// The number of values.
    #[doc(hidden)]
    pub fn count(&self) -> usize {
        match self.values {
            Values::Property(property) => property.values.len() / property.components,
            Values::One(attribute) => attribute.values.len(),
            Values::Two(attribute) => attribute.values.len(),
            Values::Three(attribute) => attribute.values.len(),
            Values::Four(attribute) => attribute.values.len(),
        }
    }

    /// Writes one of the values as it is to the front of `out`, as far as there is room. Where
    /// there is none of that number, nothing is written.
    #[doc(hidden)]
    pub fn value(&self, index: usize, out: &mut [f64]) {
        match self.values {
            Values::Property(property) => {
                let first = index * property.components;
                let numbers =
                    (first..first + property.components).map_while(|k| property.values.get(k));
                for (out, number) in out.iter_mut().zip(numbers) {
                    *out = number;
                }
            }
            Values::One(attribute) => copy(attribute, index, out),
            Values::Two(attribute) => copy(attribute, index, out),
            Values::Three(attribute) => copy(attribute, index, out),
            Values::Four(attribute) => copy(attribute, index, out),
        }
    }

    /// Whether it is one that every mesh may have, not one that a file names.
    fn is_own(&self) -> bool {
        !matches!(self.values, Values::Property(_))
    }

    /// Writes the value at a point of a triangle, given by the weights of its corners 1 and 2, to
    /// the front of `out`. Where there is no room for all its numbers, the last are left out; where
    /// there is no such triangle, nothing is written.
    ///
    /// With the weights `w` of the corners, the first of which is `1 - w1 - w2`, an interpolated
    /// number is `w0 * v0 + w1 * v1 + w2 * v2` in float64, added from left to right, where corners
    /// of weight zero are left out. [`Between::NearestCorner`](crate::shape::Between) and faces
    /// have their numbers as they are. `normals` are interpolated as they are: in object space, of
    /// any length.
    pub fn look_up(&self, triangle: usize, barycentric: DVec2, out: &mut [f64]) {
        let Some(&vertices) = self.mesh.triangles.get(triangle) else {
            return;
        };
        let point = PointOfTriangle {
            triangle,
            vertices,
            face: self.mesh.face(triangle),
            weights: [1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y],
        };
        match self.values {
            Values::Property(property) => property.look_up(&point, out),
            Values::One(attribute) => look_up(attribute, &point, out),
            Values::Two(attribute) => look_up(attribute, &point, out),
            Values::Three(attribute) => look_up(attribute, &point, out),
            Values::Four(attribute) => look_up(attribute, &point, out),
        }
    }
}

fn look_up<const N: usize>(attribute: &Attribute<N>, point: &PointOfTriangle, out: &mut [f64]) {
    let corners = attribute.at_corners(point.triangle, point.vertices);
    for (n, out) in out.iter_mut().enumerate().take(N) {
        *out = mean(corners.map(|value| value[n].into()), point.weights);
    }
}

fn copy<const N: usize>(attribute: &Attribute<N>, index: usize, out: &mut [f64]) {
    let numbers = attribute.values.get(index).into_iter().flatten();
    for (out, &number) in out.iter_mut().zip(numbers) {
        *out = number.into();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Between, Positions, PropertyValues};

    fn square() -> Mesh {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh::new(Positions::compact(points), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    fn numbers(values: &[f64]) -> PropertyValues {
        PropertyValues::Double(values.to_vec().into())
    }

    fn at<const N: usize>(mesh: &Mesh, name: &str, of: Option<PropertyOf>) -> [f64; N] {
        let mut out = [f64::NAN; N];
        let found = mesh.attribute(name, of).unwrap();
        found.look_up(1, DVec2::new(0.25, 0.625), &mut out);
        out
    }

    #[test]
    fn vertices_corners_and_faces_have_their_own_values() {
        let labels = Property {
            between: Between::NearestCorner,
            ..Property::new("a", PropertyOf::Vertices, numbers(&[1.0, 2.0, 4.0, 8.0]))
        };
        let pairs = Property {
            components: 2,
            ..Property::new(
                "a",
                PropertyOf::Corners,
                numbers(&[0., 0., 0., 0., 0., 0., 8., 80., 16., 160., 24., 240.]),
            )
        };
        let faces = Property::new("a", PropertyOf::Faces, numbers(&[5.0, 7.5]));
        let mesh = square().with_properties(vec![faces, labels, pairs]);
        let mesh = mesh.unwrap();
        assert_eq!(at(&mesh, "a", Some(PropertyOf::Vertices)), [8.0]);
        assert_eq!(at(&mesh, "a", Some(PropertyOf::Faces)), [7.5]);
        let mean = 0.125 * 8.0 + 0.25 * 16.0 + 0.625 * 24.0;
        assert_eq!(at(&mesh, "a", None), [mean, 10.0 * mean]);
        // Less room than numbers, and more.
        assert_eq!(at(&mesh, "a", None), [mean]);
        let [_, _, rest] = at(&mesh, "a", None);
        assert!(rest.is_nan());
    }

    #[test]
    fn a_property_comes_before_the_meshs_own() {
        let colors = Attribute::per_vertex(vec![[0.5, 0.25, 0.125]; 4]);
        let mesh = square().with_colors(colors).unwrap();
        assert_eq!(at(&mesh, "colors", None), [0.5, 0.25, 0.125]);
        let named = Property::new("colors", PropertyOf::Faces, numbers(&[1.0, 2.0]));
        let mesh = mesh.with_properties(vec![named]).unwrap();
        assert_eq!(at(&mesh, "colors", None), [2.0]);
        assert!(mesh.attribute("uvs", None).is_none());
        let names: Vec<&str> = mesh.attributes().map(|found| found.name()).collect();
        assert_eq!(names, ["colors", "colors"]);
    }

    #[test]
    fn numbers_that_do_not_fit_the_mesh_are_refused() {
        let refused = |property: Property| square().with_properties(vec![property]).unwrap_err();
        let corners = Property::new("a", PropertyOf::Corners, numbers(&[0.0; 5]));
        assert_eq!(
            refused(corners).to_string(),
            "properties must be three for each triangle, got 5 of 'a'"
        );
        let pairs = Property {
            components: 2,
            ..Property::new("a", PropertyOf::Vertices, numbers(&[0.0; 9]))
        };
        assert_eq!(
            refused(pairs.clone()).to_string(),
            "properties must be as many as vertices, got 9 numbers, 2 for each, of 'a'"
        );
        assert!(square().with_properties(vec![Property { components: 0, ..pairs }]).is_err());
    }
}
