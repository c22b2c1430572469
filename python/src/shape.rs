//! Meshes and shapes, as handles.

use std::sync::Arc;

use firsthit::load::polygons as polygons_of;
use firsthit::shape::Attribute;
use firsthit::{Cone, Cuboid, Cylinder, Disc, Plane, Positions, Sphere};
use numpy::{
    PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::arrays::{collected, copied};
use crate::attributes::{PropertyIn, PropertyOut, property_out};
use crate::errors::Outcome;
use crate::run::run;

/// A mesh that objects can share.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Mesh(pub(crate) Arc<firsthit::Mesh>);

#[pymethods]
impl Mesh {
    /// A mesh from float64 vertices (n, 3) and uint32 triangles (m, 3); float32 normals, uvs,
    /// colours, alphas, second uvs and tangents for each vertex (n, k) or for each corner (m, 3,
    /// k); and the triangles' faces and slots.
    #[new]
    fn new(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        triangles: PyReadonlyArray2<'_, u32>,
        attributes: AttributesIn<'_>,
        labels: [Option<PyReadonlyArray1<'_, u32>>; 2],
        properties: Vec<PropertyIn<'_>>,
    ) -> Outcome<Self> {
        let vertices = vertices.as_slice()?;
        let points = copied(vertices.as_chunks::<3>().0)?;
        let triangles = triangles.as_slice()?;
        let corners = copied(triangles.as_chunks::<3>().0)?;
        let AttributesIn(normals, uvs, colors, alphas, second_uvs, tangents) = attributes;
        let (normals, uvs, colors) = (attribute(normals)?, attribute(uvs)?, attribute(colors)?);
        let (alphas, second_uvs) = (attribute(alphas)?, attribute(second_uvs)?);
        let tangents = attribute(tangents)?;
        let label = |array: PyReadonlyArray1<'_, u32>| copied(array.as_slice()?);
        let [faces, slots] = labels.map(|array| array.map(label).transpose());
        let (faces, slots) = (faces?, slots?);
        let properties = properties.into_iter().map(PropertyIn::property);
        let properties = properties.collect::<Outcome<Vec<_>>>()?;
        py.detach(|| {
            use firsthit::Mesh;
            let mesh = Mesh::new(Positions::compact(points), corners)?;
            let mesh = with(mesh, normals, Mesh::with_normals)?;
            let mesh = with(mesh, uvs, Mesh::with_uvs)?;
            let mesh = with(mesh, colors, Mesh::with_colors)?;
            let mesh = with(mesh, alphas, Mesh::with_alphas)?;
            let mesh = with(mesh, second_uvs, Mesh::with_second_uvs)?;
            let mesh = with(mesh, tangents, Mesh::with_tangents)?;
            let mesh = with(mesh, faces, Mesh::with_faces)?;
            let mesh = with(mesh, slots, Mesh::with_slots)?;
            Ok(Self(Arc::new(mesh.with_properties(properties)?)))
        })
    }

    /// The mesh with other vertices under its triangles and attributes.
    fn moved(&self, py: Python<'_>, vertices: PyReadonlyArray2<'_, f64>) -> Outcome<Self> {
        let vertices = vertices.as_slice()?;
        let points = copied(vertices.as_chunks::<3>().0)?;
        let moved = py.detach(|| {
            // A clone shares triangles and attributes, and has no vertices of its own.
            let mesh = firsthit::Mesh::clone(&self.0);
            mesh.with_positions(Positions::compact(points))
        });
        Ok(Self(Arc::new(moved?)))
    }

    /// Normals, uvs, colours, alphas, second uvs and tangents, as they go in: a copy.
    fn attributes<'py>(&self, py: Python<'py>) -> Outcome<[Option<ArrayOut<'py>>; 6]> {
        Ok([
            self.0.normals().map(|a| array_of(py, a)).transpose()?,
            self.0.uvs().map(|a| array_of(py, a)).transpose()?,
            self.0.colors().map(|a| array_of(py, a)).transpose()?,
            self.0.alphas().map(|a| array_of(py, a)).transpose()?,
            self.0.second_uvs().map(|a| array_of(py, a)).transpose()?,
            self.0.tangents().map(|a| array_of(py, a)).transpose()?,
        ])
    }

    /// The triangles' faces and slots: a copy.
    fn labels<'py>(&self, py: Python<'py>) -> Outcome<[Option<Bound<'py, PyArray1<u32>>>; 2]> {
        let out = |labels: &[u32]| Ok::<_, PyErr>(PyArray1::from_vec(py, copied(labels)?));
        Ok([self.0.faces().map(out).transpose()?, self.0.slots().map(out).transpose()?])
    }

    /// The numbers by name, as they go in: a copy.
    fn properties<'py>(&self, py: Python<'py>) -> Outcome<Vec<PropertyOut<'py>>> {
        let properties = self.0.properties().iter();
        properties.map(|property| property_out(py, property)).collect()
    }

    /// The numbers of vertices and triangles.
    fn counts(&self) -> (usize, usize) {
        (self.0.positions().len(), self.0.triangles().len())
    }

    /// Whether every edge belongs to an even number of triangles.
    fn is_closed(&self, py: Python<'_>) -> Outcome<bool> {
        run(py, 1, |_| self.0.is_closed())
    }

    /// The area of all triangles.
    fn area(&self, py: Python<'_>) -> Outcome<f64> {
        run(py, 1, |_| Ok(self.0.area()))
    }

    /// The volume inside, if it has an inside.
    fn volume(&self, py: Python<'_>) -> Outcome<Option<f64>> {
        run(py, 1, |_| self.0.volume())
    }

    /// The parts.
    fn split(&self, py: Python<'_>) -> Outcome<Vec<Self>> {
        let parts = run(py, 1, |_| self.0.split())?;
        Ok(parts.into_iter().map(|part| Self(Arc::new(part))).collect())
    }

    /// The vertices, float64 (n, 3): a copy.
    fn vertices<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray2<f64>>> {
        let positions = self.0.positions();
        let count = u32::try_from(positions.len()).unwrap_or(u32::MAX);
        let values = (0..count).flat_map(|index| positions.get(index).to_array());
        let values = collected(3 * positions.len(), values)?;
        Ok(PyArray1::from_vec(py, values).reshape([positions.len(), 3])?)
    }

    /// The triangles, uint32 (m, 3): a copy.
    fn triangles<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray2<u32>>> {
        let values = copied(self.0.triangles().as_flattened())?;
        Ok(PyArray1::from_vec(py, values).reshape([self.0.triangles().len(), 3])?)
    }
}

/// Triangles, and how many each polygon has.
type PolygonsOut<'py> = (Bound<'py, PyArray2<u32>>, Bound<'py, PyArray1<u32>>);

/// The triangles (m, 3) of polygons over float64 points (n, 3), and of each the polygon that it is
/// part of. Of all polygons the corners come one after the other, and how many each has.
#[pyfunction]
pub(crate) fn polygons<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'_, f64>,
    corners: PyReadonlyArray1<'_, u32>,
    sizes: PyReadonlyArray1<'_, u32>,
) -> Outcome<PolygonsOut<'py>> {
    let points = points.as_slice()?;
    let points = Positions::Double(copied(points.as_chunks::<3>().0)?.into());
    let corners = corners.as_slice()?;
    let sizes = sizes.as_slice()?;
    let (triangles, faces) = run(py, 1, |_| polygons_of(points, corners, sizes))?;
    let count = triangles.len();
    let triangles = PyArray1::from_vec(py, triangles.into_flattened());
    Ok((triangles.reshape([count, 3])?, PyArray1::from_vec(py, faces)))
}

/// Normals, uvs, colours, alphas, second uvs and tangents.
#[derive(FromPyObject)]
struct AttributesIn<'py>(
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, f32>>,
    Option<PyReadonlyArrayDyn<'py, f32>>,
);

type ArrayOut<'py> = Bound<'py, PyArrayDyn<f32>>;

/// The mesh with some of its parts, if there are any.
fn with<T>(
    mesh: firsthit::Mesh,
    part: Option<T>,
    set: impl FnOnce(firsthit::Mesh, T) -> firsthit::Result<firsthit::Mesh>,
) -> firsthit::Result<firsthit::Mesh> {
    match part {
        Some(part) => set(mesh, part),
        None => Ok(mesh),
    }
}

/// An attribute from an array: (n, k) for each vertex, (m, 3, k) for each corner.
fn attribute<const N: usize>(
    array: Option<PyReadonlyArrayDyn<'_, f32>>,
) -> Outcome<Option<Attribute<N>>> {
    let Some(array) = array else {
        return Ok(None);
    };
    let values = array.as_slice()?;
    let values = copied(values.as_chunks().0)?;
    let corners = if array.shape().len() == 3 {
        let count = u32::try_from(values.len()).unwrap_or(u32::MAX) / 3;
        let corners = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        Some(collected(values.len() / 3, corners)?.into())
    } else {
        None
    };
    let values = values.into();
    Ok(Some(Attribute { values, corners }))
}

fn array_of<'py, const N: usize>(
    py: Python<'py>,
    attribute: &Attribute<N>,
) -> Outcome<ArrayOut<'py>> {
    Ok(match &attribute.corners {
        None => {
            let values = PyArray1::from_vec(py, copied(attribute.values.as_flattened())?);
            values.reshape(vec![attribute.values.len(), N])?
        }
        Some(corners) => {
            let values = corners.iter().flatten();
            let values = values.flat_map(|&k| attribute.values[k as usize]);
            let values = collected(3 * N * corners.len(), values)?;
            PyArray1::from_vec(py, values).reshape(vec![corners.len(), 3, N])?
        }
    })
}

/// A shape in object space.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Shape(pub(crate) firsthit::Shape);

impl Shape {
    fn checked(shape: firsthit::Result<impl Into<firsthit::Shape>>) -> Outcome<Self> {
        Ok(Self(shape?.into()))
    }
}

#[pymethods]
impl Shape {
    #[staticmethod]
    fn mesh(mesh: &Mesh) -> Self {
        Self(Arc::clone(&mesh.0).into())
    }

    #[staticmethod]
    fn sphere(center: [f64; 3], radius: f64) -> Outcome<Self> {
        Self::checked(Sphere::new(center.into(), radius))
    }

    #[staticmethod]
    fn plane(point: [f64; 3], normal: [f64; 3]) -> Outcome<Self> {
        Self::checked(Plane::new(point.into(), normal.into()))
    }

    #[staticmethod]
    fn disc(center: [f64; 3], normal: [f64; 3], radius: f64) -> Outcome<Self> {
        Self::checked(Disc::new(center.into(), normal.into(), radius))
    }

    #[staticmethod]
    fn r#box(low: [f64; 3], high: [f64; 3]) -> Outcome<Self> {
        Self::checked(Cuboid::new(low.into(), high.into()))
    }

    #[staticmethod]
    fn cylinder(bottom: [f64; 3], top: [f64; 3], radius: f64) -> Outcome<Self> {
        Self::checked(Cylinder::new(bottom.into(), top.into(), radius))
    }

    #[staticmethod]
    fn cone(bottom: [f64; 3], top: [f64; 3], bottom_radius: f64, top_radius: f64) -> Outcome<Self> {
        let (bottom, top) = (bottom.into(), top.into());
        Self::checked(Cone::new(bottom, top, bottom_radius, top_radius))
    }
}
