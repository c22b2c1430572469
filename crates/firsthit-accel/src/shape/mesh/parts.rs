//! The parts of a mesh, which have no edge in common; its area and its volume.

use super::disjoint_sets::DisjointSets;
use super::facing::edges;
use super::weld::sort;
use super::{Attribute, Mesh};
use crate::error::Result;
use crate::geometry::DVec3;
use crate::memory::{self, Storage};
use crate::shape::{Positions, Property, PropertyOf, PropertyValues};

impl Mesh {
    /// The triangles of each part: those that edges join, where an edge is where its two ends are.
    /// Parts are in the order of their first triangles.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub(crate) fn parts(&self) -> Result<Vec<Vec<u32>>> {
        let count = self.triangles.len();
        memory::check("the parts of a mesh", count.saturating_mul(72))?;
        let welded = self.welded()?.triangles;
        let sides = |(&places, triangle): (&[u32; 3], u32)| {
            edges(places).map(move |(ends, _)| (ends, triangle))
        };
        let mut uses: Vec<([u32; 2], u32)> = welded.iter().zip(0..).flat_map(sides).collect();
        sort(&mut uses, Ord::cmp);
        let mut sets = DisjointSets::new(count);
        for two in uses.windows(2).filter(|two| two[0].0 == two[1].0) {
            sets.unite(two[0].1, two[1].1);
        }
        drop(uses);
        let mut part_of = memory::filled(count, u32::MAX)?;
        let mut parts: Vec<Vec<u32>> = Vec::new();
        for triangle in (0..).take(count) {
            let first = sets.first(triangle);
            if first == triangle {
                part_of[first as usize] = u32::try_from(parts.len()).unwrap_or(u32::MAX);
                parts.push(Vec::new());
            }
            parts[part_of[first as usize] as usize].push(triangle);
        }
        Ok(parts)
    }

    /// The number of parts: see [`split`](Self::split).
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub fn part_count(&self) -> Result<usize> {
        Ok(self.parts()?.len())
    }

    /// The parts of the mesh as meshes of their own, with all that it knows about them, in the
    /// order of their first triangles. Triangles that have an edge in common are of one part; an
    /// edge is where its two ends are, to the last bit. So shells are parts that do not touch, or
    /// only at vertices.
    ///
    /// ```
    /// use firsthit::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [5.0, 0.0, 0.0], [5.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2], [3, 4, 5], [1, 3, 2]])?;
    /// let parts = mesh.split()?;
    /// assert_eq!(parts.len(), 2);
    /// assert_eq!((parts[0].triangles().len(), parts[1].area()), (2, 2.0));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when memory is short.
    pub fn split(&self) -> Result<Vec<Self>> {
        let mut number = memory::filled(self.positions.len(), u32::MAX)?;
        let parts = self.parts()?;
        parts.iter().map(|part| self.of_triangles(part, &mut number)).collect()
    }

    /// A mesh of some triangles alone, with their vertices. `number` is memory for a number of each
    /// vertex, all of them `u32::MAX` before and after.
    #[expect(clippy::too_many_lines, reason = "a few lines for each attribute")]
    fn of_triangles(&self, triangles: &[u32], number: &mut [u32]) -> Result<Self> {
        let mut vertices: Vec<u32> = Vec::new();
        let mut corners: Vec<[u32; 3]> = Vec::with_capacity(triangles.len());
        for &triangle in triangles {
            corners.push(self.triangles[triangle as usize].map(|vertex| {
                let number = &mut number[vertex as usize];
                if *number == u32::MAX {
                    *number = u32::try_from(vertices.len()).unwrap_or(u32::MAX);
                    vertices.push(vertex);
                }
                *number
            }));
        }
        for &vertex in &vertices {
            number[vertex as usize] = u32::MAX;
        }
        let some = Chosen { triangles, vertices: &vertices };
        let points = vertices.iter().map(|&vertex| self.positions.get(vertex).to_array());
        let positions = match &*self.positions {
            Positions::Single(all) => Positions::Single(some.of_vertices(all, 1).into()),
            Positions::Double(_) => Positions::Double(points.collect::<Vec<_>>().into()),
        };
        // Faces are numbered anew where numbers belong to them.
        let mut faces: Vec<u32> = triangles
            .iter()
            .map(|&triangle| u32::try_from(self.face(triangle as usize)).unwrap_or(u32::MAX))
            .collect();
        let mut own = faces.clone();
        own.sort_unstable();
        own.dedup();
        for face in &mut faces {
            let found = own.binary_search(face).unwrap_or(0);
            *face = u32::try_from(found).unwrap_or(u32::MAX);
        }
        let mut mesh = Self::new(positions, corners)?;
        if self.faces.is_some() {
            mesh = mesh.with_faces(faces)?;
        }
        mesh.normals = self.normals.as_ref().map(|all| some.attribute(all));
        mesh.uvs = self.uvs.as_ref().map(|all| some.attribute(all));
        mesh.second_uvs = self.second_uvs.as_ref().map(|all| some.attribute(all));
        mesh.tangents = self.tangents.as_ref().map(|all| some.attribute(all));
        mesh.colors = self.colors.as_ref().map(|all| some.attribute(all));
        mesh.alphas = self.alphas.as_ref().map(|all| some.attribute(all));
        mesh.slots = (self.slots.as_ref()).map(|all| some.of_triangles(all, 1).into());
        let properties = self.properties.iter().map(|property| {
            let parts = match property.of {
                PropertyOf::Vertices => (&*vertices, property.components),
                PropertyOf::Corners => (triangles, 3 * property.components),
                PropertyOf::Faces => (&*own, property.components),
            };
            Property {
                values: match &property.values {
                    PropertyValues::Single(all) => {
                        PropertyValues::Single(chosen(all, parts).into())
                    }
                    PropertyValues::Double(all) => {
                        PropertyValues::Double(chosen(all, parts).into())
                    }
                },
                ..property.clone()
            }
        });
        mesh.with_properties(properties.collect())
    }

    /// The area of all triangles, in squares of object space, in float64 and in their order.
    pub fn area(&self) -> f64 {
        let areas = (0..self.triangles.len()).map(|k| {
            let [a, b, c] = self.corners(k);
            0.5 * (b - a).cross(c - a).length()
        });
        0.0 + areas.sum::<f64>()
    }

    /// The volume inside, in cubes of object space; `None` for a mesh that is not closed, and for
    /// one whose triangles cannot all face alike. It does not matter whether they face outwards.
    /// Where shells overlap, each counts, and the volume of one that faces the other way than most,
    /// as a cavity does, is taken off.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`](crate::error::Error::Limit) when there is no memory to find out whether it
    /// is closed.
    pub fn volume(&self) -> Result<Option<f64>> {
        let facing = self.facing()?;
        if matches!(facing, super::Facing::Undecided) {
            return Ok(None);
        }
        let bounds = self.bounds;
        // From the middle, for far from the origin what is added would cancel.
        let middle = if bounds.is_empty() { DVec3::ZERO } else { bounds.centre() };
        let volumes = (0..self.triangles.len()).map(|k| {
            let [a, b, c] = self.corners(k).map(|corner| corner - middle);
            let volume = a.dot(b.cross(c));
            if facing.is_turned(k) { -volume } else { volume }
        });
        Ok(Some((volumes.sum::<f64>() / 6.0).abs()))
    }
}

/// A selection of a mesh's triangles, and their vertices.
struct Chosen<'a> {
    triangles: &'a [u32],
    vertices: &'a [u32],
}

impl Chosen<'_> {
    fn of_vertices<T: Copy>(&self, all: &[T], each: usize) -> Vec<T> {
        chosen(all, (self.vertices, each))
    }

    fn of_triangles<T: Copy>(&self, all: &[T], each: usize) -> Vec<T> {
        chosen(all, (self.triangles, each))
    }

    fn attribute<const N: usize>(&self, all: &Attribute<N>) -> Attribute<N> {
        let Attribute { values, corners } = all;
        let Some(corners) = corners else {
            return Attribute::per_vertex(self.of_vertices(values, 1));
        };
        let mut used = self.of_triangles(corners, 1);
        let mut own: Vec<u32> = used.as_flattened().to_vec();
        own.sort_unstable();
        own.dedup();
        for corner in used.as_flattened_mut() {
            let found = own.binary_search(corner).unwrap_or(0);
            *corner = u32::try_from(found).unwrap_or(u32::MAX);
        }
        let values: Storage<[f32; N]> = chosen(values, (&own, 1)).into();
        Attribute { values, corners: Some(used.into()) }
    }
}

/// The groups of `each` numbers whose indices are listed.
fn chosen<T: Copy>(all: &[T], (which, each): (&[u32], usize)) -> Vec<T> {
    which.iter().flat_map(|&k| &all[k as usize * each..][..each]).copied().collect()
}
