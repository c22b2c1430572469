#[cfg(feature = "frame")]
mod digest;
mod surface;

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

use super::attribute::check_indices;
use super::triangle::{Meeting, Shear, TriangleHit, are_close};
use super::{Attribute, Crossing, Positions, Property, PropertyOf, PropertyValues};
use crate::error::{Error, Result};
use crate::geometry::{Bounds, DVec2, DVec3, Ray, moderation, unit};

/// Triangles over shared vertices. Immutable; objects share it through an [`Arc`].
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::{DVec3, Mesh, Object, Positions, Scene, shoot};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2], [0, 2, 3]])?;
/// // Objects that share the Arc share the mesh and its tree.
/// let scene = Scene::new(vec![Object::new(Arc::new(mesh))])?;
/// let hit = shoot(&scene, DVec3::new(0.2, 0.7, 9.0), DVec3::NEG_Z);
/// assert_eq!((hit.t, hit.primitive), (9.0, 1));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Mesh {
    positions: Arc<Positions>,
    triangles: Vec<[u32; 3]>,
    bounds: Bounds,
    faces: Option<Vec<u32>>,
    normals: Option<Attribute<3>>,
    uvs: Option<Attribute<2>>,
    colors: Option<Attribute<3>>,
    alphas: Option<Attribute<1>>,
    slots: Option<Vec<u32>>,
    properties: Vec<Property>,
}

/// A summary: meshes are large.
impl Debug for Mesh {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let has = [
            ("faces", self.faces.is_some()),
            ("normals", self.normals.is_some()),
            ("uvs", self.uvs.is_some()),
            ("colors", self.colors.is_some()),
            ("alphas", self.alphas.is_some()),
            ("slots", self.slots.is_some()),
        ];
        let has: Vec<_> = has.iter().filter(|(_, has)| *has).collect();
        let has: Vec<_> = has.into_iter().map(|(name, _)| name).collect();
        f.debug_struct("Mesh")
            .field("triangles", &self.triangles.len())
            .field("vertices", &self.positions.len())
            .field("bounds", &self.bounds)
            .field("has", &has)
            .field("properties", &self.properties.len())
            .finish_non_exhaustive()
    }
}

impl Mesh {
    /// Whether its triangles are those of another mesh, to the last bit and in the same order, whatever they look like.
    pub(crate) fn is_congruent(&self, other: &Self) -> bool {
        // (Equal zeros may have different signs, which shows in a hit's weights.)
        let same_bits = || {
            let bits = |mesh: &Self, k: u32| mesh.positions.get(k).to_array().map(f64::to_bits);
            let mut corners = self.triangles.iter().flatten();
            corners.all(|&k| bits(self, k) == bits(other, k))
        };
        self.triangles == other.triangles
            && (Arc::ptr_eq(&self.positions, &other.positions) || same_bits())
    }

    /// Whether `new` is the first of two crossings of a ray with triangles of the mesh: the one with the smaller nearest `t`, of
    /// equal ones the lower triangle.
    #[inline]
    pub(crate) fn precedes(&self, ray: &Ray, new: &Crossing, old: &Crossing) -> bool {
        if are_close(new.t, old.t) {
            self.precedes_closely(ray, new, old)
        } else {
            new.t < old.t
        }
    }

    #[cold]
    fn precedes_closely(&self, ray: &Ray, new: &Crossing, old: &Crossing) -> bool {
        let key = |crossing: &Crossing| (self.nearest_t(ray, crossing), crossing.primitive);
        key(new) < key(old)
    }

    /// The float64 nearest to the exact `t` of a crossing.
    #[inline]
    pub(crate) fn nearest_t(&self, ray: &Ray, crossing: &Crossing) -> f64 {
        let corners = usize::try_from(crossing.primitive).map(|triangle| self.corners(triangle));
        corners.map_or(crossing.t, |corners| {
            Meeting::new(ray.origin, ray.direction, corners).nearest_t()
        })
    }

    /// The first crossing of a ray that is ready for triangles, by brute force.
    pub(crate) fn first_crossing(&self, ray: &Ray, shear: &Shear) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        for (triangle, primitive) in (0..self.triangles.len()).zip(0..) {
            if let Some(hit) = self.intersect_triangle(triangle, shear)
                && ray.holds(hit.t)
            {
                let new = hit.crossing(primitive);
                if first.is_none_or(|first| self.precedes(ray, &new, &first)) {
                    first = Some(new);
                }
            }
        }
        first
    }

    /// Whether all of a triangle's points look alike as far as holes are concerned: of two triangles in one place
    /// the first then hides the other.
    pub(crate) fn has_plain_triangles(&self) -> bool {
        self.uvs.is_none() && self.slots.is_none() && self.alphas.is_none()
    }

    /// The mesh of `triangles`, which index `positions`; counter-clockwise is front. Several meshes may
    /// share their positions: surfaces that meet there have no cracks between them.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an index without a vertex and for a triangle whose corner is NaN or
    /// infinite, [`Error::Limit`] for more triangles than an identifier can name.
    pub fn new(positions: impl Into<Arc<Positions>>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        let positions = positions.into();
        if i32::try_from(triangles.len()).is_err() {
            let (got, limit) = (triangles.len().to_string(), i32::MAX.to_string());
            return Err(Error::Limit {
                what: "triangles in a mesh",
                got,
                limit,
            });
        }
        let bounds = match &*positions {
            Positions::Single(points) => bounds_of(points, &triangles),
            Positions::Double(points) => bounds_of(points, &triangles),
        };
        let Some(bounds) = bounds else {
            check_indices("triangles", &triangles, positions.len())?;
            let mut corners = triangles.iter().flatten();
            let bad = corners.find(|&&k| !positions.get(k).is_finite());
            let got = bad.map_or_else(String::new, |&bad| {
                format!("{} at index {bad}", positions.get(bad))
            });
            return Err(Error::argument("vertices", "finite", got));
        };
        Ok(Self {
            positions,
            triangles,
            bounds,
            faces: None,
            normals: None,
            uvs: None,
            colors: None,
            alphas: None,
            slots: None,
            properties: Vec::new(),
        })
    }

    /// The same mesh, its triangles knowing which polygon of the file they were part of.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when there are not as many `faces` as triangles, or one is no identifier: 2^31 or more.
    pub fn with_faces(mut self, faces: Vec<u32>) -> Result<Self> {
        if faces.len() != self.triangles.len() {
            return Err(Error::argument(
                "faces",
                "one for each triangle",
                faces.len(),
            ));
        }
        if let Some(&face) = faces.iter().find(|&&face| i32::try_from(face).is_err()) {
            return Err(Error::argument("faces", "below 2^31", face));
        }
        self.faces = Some(faces);
        Ok(self)
    }

    /// The same mesh with shading normals, in object space; they need not be of length one.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when they do not fit the mesh.
    pub fn with_normals(mut self, normals: Attribute<3>) -> Result<Self> {
        normals.check("normals", self.positions.len(), &self.triangles)?;
        self.normals = Some(normals);
        Ok(self)
    }

    /// The same mesh with texture coordinates.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when they do not fit the mesh.
    pub fn with_uvs(mut self, uvs: Attribute<2>) -> Result<Self> {
        uvs.check("uvs", self.positions.len(), &self.triangles)?;
        self.uvs = Some(uvs);
        Ok(self)
    }

    /// The same mesh with linear colours, which the object's own colour multiplies.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when they do not fit the mesh.
    pub fn with_colors(mut self, colors: Attribute<3>) -> Result<Self> {
        colors.check("colors", self.positions.len(), &self.triangles)?;
        self.colors = Some(colors);
        Ok(self)
    }

    /// The same mesh with an alpha of its own, which a material's multiplies.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when they do not fit the mesh.
    pub fn with_alphas(mut self, alphas: Attribute<1>) -> Result<Self> {
        alphas.check("alphas", self.positions.len(), &self.triangles)?;
        self.alphas = Some(alphas);
        Ok(self)
    }

    /// The same mesh, each triangle having a slot: which of its object's materials it takes.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when there are not as many `slots` as triangles.
    pub fn with_slots(mut self, slots: Vec<u32>) -> Result<Self> {
        if slots.len() != self.triangles.len() {
            let expected = "one for each triangle";
            return Err(Error::argument("slots", expected, slots.len()));
        }
        self.slots = Some(slots);
        Ok(self)
    }

    /// The same mesh with numbers by name, in place of those it had.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when they are not as many as what has them.
    pub fn with_properties(mut self, properties: Vec<Property>) -> Result<Self> {
        let last = (0..self.triangles.len()).map(|k| self.face(k) + 1).max();
        for property in &properties {
            property.check(self.positions.len(), last.unwrap_or(0))?;
        }
        self.properties = properties;
        Ok(self)
    }

    /// The numbers that it has by name.
    pub fn properties(&self) -> &[Property] {
        &self.properties
    }

    /// The numbers of that name.
    pub fn property(&self, of: PropertyOf, name: &str) -> Option<&PropertyValues> {
        let mut properties = self.properties.iter();
        let found = properties.find(|property| property.of == of && property.name == name);
        found.map(|property| &property.values)
    }

    /// The vertices, shared with other meshes perhaps: some may belong to no triangle of this one.
    pub fn positions(&self) -> &Arc<Positions> {
        &self.positions
    }

    /// The triangles' vertex indices, in file order.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Which polygon each triangle was part of, where the mesh knows.
    pub fn faces(&self) -> Option<&[u32]> {
        self.faces.as_deref()
    }

    /// The shading normals, in object space, not of length one.
    pub fn normals(&self) -> Option<&Attribute<3>> {
        self.normals.as_ref()
    }

    /// The texture coordinates.
    pub fn uvs(&self) -> Option<&Attribute<2>> {
        self.uvs.as_ref()
    }

    /// The linear colours.
    pub fn colors(&self) -> Option<&Attribute<3>> {
        self.colors.as_ref()
    }

    /// The alphas.
    pub fn alphas(&self) -> Option<&Attribute<1>> {
        self.alphas.as_ref()
    }

    /// Each triangle's slot, where the mesh has more than one.
    pub fn slots(&self) -> Option<&[u32]> {
        self.slots.as_deref()
    }

    /// The smallest box around all triangles.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The three corners of a triangle, in object space.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions.get(vertex))
    }

    /// The polygon that a triangle was part of; without polygons, the triangle's own index.
    pub fn face(&self, triangle: usize) -> usize {
        self.faces
            .as_ref()
            .map_or(triangle, |faces| faces[triangle] as usize)
    }

    /// Where the ray of `shear` meets a triangle, wherever that is along the ray.
    pub fn intersect_triangle(&self, triangle: usize, shear: &Shear) -> Option<TriangleHit> {
        shear.intersect(self.corners(triangle))
    }

    /// The triangle's own normal, counter-clockwise front, of length one; NaN if it has no area.
    pub fn normal(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        // Not edges of length one: their rounding would give collinear corners an area.
        let [ab, ac] = [b - a, c - a].map(|edge| moderation(edge) * edge);
        unit(ab.cross(ac))
    }

    /// The shading normal in object space, not of length one; `None` where the mesh has none.
    pub fn shading_normal(&self, triangle: usize, barycentric: DVec2) -> Option<DVec3> {
        self.normals
            .as_ref()
            .map(|normals| DVec3::from(self.between(normals, triangle, barycentric)))
    }

    /// The texture coordinates; `None` where the mesh has none.
    pub fn uv(&self, triangle: usize, barycentric: DVec2) -> Option<DVec2> {
        self.uvs
            .as_ref()
            .map(|uvs| DVec2::from(self.between(uvs, triangle, barycentric)))
    }

    /// The linear colour; `None` where the mesh has none.
    pub fn color(&self, triangle: usize, barycentric: DVec2) -> Option<DVec3> {
        self.colors
            .as_ref()
            .map(|colors| DVec3::from(self.between(colors, triangle, barycentric)))
    }

    /// The alpha of its own; `None` where the mesh has none.
    pub fn alpha(&self, triangle: usize, barycentric: DVec2) -> Option<f64> {
        self.alphas.as_ref().map(|alphas| {
            let [alpha] = self.between(alphas, triangle, barycentric);
            alpha
        })
    }

    /// Which of its object's materials a triangle takes.
    pub fn slot(&self, triangle: usize) -> usize {
        self.slots
            .as_ref()
            .map_or(0, |slots| slots[triangle] as usize)
    }

    fn between<const N: usize>(
        &self,
        attribute: &Attribute<N>,
        triangle: usize,
        barycentric: DVec2,
    ) -> [f64; N] {
        let weights = [
            1.0 - barycentric.x - barycentric.y,
            barycentric.x,
            barycentric.y,
        ];
        attribute.interpolate(triangle, self.triangles[triangle], weights)
    }
}

/// The box around the corners of all triangles, in one pass; `None` if a corner is not there or not finite.
fn bounds_of<T>(points: &[[T; 3]], triangles: &[[u32; 3]]) -> Option<Bounds>
where
    T: Copy + PartialOrd + Into<f64>,
{
    let Some(&[first, ..]) = triangles.first() else {
        return Some(Bounds::EMPTY);
    };
    let [mut low, mut high] = [*points.get(first as usize)?; 2];
    let mut is_finite = true;
    for &corner in triangles.iter().flatten() {
        let point = points.get(corner as usize)?;
        for axis in 0..3 {
            let x = point[axis];
            low[axis] = if x < low[axis] { x } else { low[axis] };
            high[axis] = if x > high[axis] { x } else { high[axis] };
            is_finite &= Into::<f64>::into(x).abs() < f64::INFINITY;
        }
    }
    is_finite.then(|| Bounds {
        low: DVec3::from(low.map(Into::into)),
        high: DVec3::from(high.map(Into::into)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Mesh {
        let points = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        Mesh::new(Positions::compact(points), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    #[test]
    fn indices_without_a_vertex_are_refused() {
        let points = vec![[0.0; 3]; 3];
        let error = Mesh::new(Positions::compact(points), vec![[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "triangles must be indices of what is there, got [0, 1, 3] in triangle 1, of 3"
        );
    }

    #[test]
    fn a_corner_that_is_not_finite_is_refused_and_an_unused_vertex_is_not() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f64::NAN; 3]];
        assert!(Mesh::new(Positions::compact(points.clone()), vec![[0, 1, 2]]).is_ok());
        assert!(Mesh::new(Positions::compact(points), vec![[0, 1, 3]]).is_err());
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
        assert_eq!(
            mesh.color(0, DVec2::new(0.5, 0.25)).unwrap(),
            DVec3::new(0.25, 0.5, 0.25)
        );
        assert_eq!(mesh.color(1, DVec2::new(0.0, 1.0)).unwrap(), DVec3::ONE);
    }

    #[test]
    fn corners_on_a_line_have_no_normal() {
        for k in 1..100 {
            let [x, y, z] = [1.0, f64::from(k), f64::from(k % 7) + 0.5];
            let points = vec![[0.0; 3], [x, y, z], [3.0 * x, 3.0 * y, 3.0 * z]];
            let mesh = Mesh::new(Positions::compact(points), vec![[0, 1, 2]]).unwrap();
            assert!(mesh.normal(0).is_nan(), "{k}");
        }
    }

    #[test]
    fn tiny_triangles_have_normals_too() {
        let points = vec![[0.0; 3], [1e-200, 0.0, 0.0], [0.0, 1e-200, 0.0]];
        let mesh = Mesh::new(Positions::compact(points), vec![[0, 1, 2]]).unwrap();
        assert_eq!(mesh.normal(0), DVec3::Z);
    }
}
