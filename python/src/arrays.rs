//! Rays and hits in NumPy's memory, as the library sees them.

use firsthit::shoot::HitSlices;
use firsthit::{DVec2, DVec3, Hits, Ray, Rays};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1, PyReadwriteArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Rays in arrays of the interpreter.
pub(crate) struct RaySlices<'a> {
    origins: &'a [[f64; 3]],
    directions: &'a [[f64; 3]],
    /// One for all, or one for each.
    t_min: &'a [f64],
    t_max: &'a [f64],
}

impl Rays for RaySlices<'_> {
    fn len(&self) -> usize {
        self.origins.len()
    }

    fn ray(&self, index: usize) -> Ray {
        let ray = Ray::new(
            DVec3::from(self.origins[index]),
            DVec3::from(self.directions[index]),
        );
        let of = |limits: &[f64]| limits.get(index).or(limits.first()).copied();
        ray.beyond(of(self.t_min).unwrap_or(0.0))
            .up_to(of(self.t_max).unwrap_or(f64::INFINITY))
    }
}

/// Arrays of rays as they come: C-contiguous float64 of the shapes (n, 3), (n, 3), and twice (n,) or (1,).
#[derive(FromPyObject)]
pub(crate) struct RayArrays<'py>(
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
);

impl RayArrays<'_> {
    pub(crate) fn slices(&self) -> PyResult<RaySlices<'_>> {
        let rays = RaySlices {
            origins: self.0.as_slice().map_err(not_contiguous)?.as_chunks().0,
            directions: self.1.as_slice().map_err(not_contiguous)?.as_chunks().0,
            t_min: self.2.as_slice().map_err(not_contiguous)?,
            t_max: self.3.as_slice().map_err(not_contiguous)?,
        };
        let count = rays.origins.len();
        let fits = |limits: &[f64]| limits.len() == count || limits.len() == 1;
        if rays.directions.len() == count && fits(rays.t_min) && fits(rays.t_max) {
            Ok(rays)
        } else {
            Err(PyValueError::new_err("expected arrays of one length"))
        }
    }
}

/// Where hits go: `t`, `object`, `primitive` and `barycentric`, C-contiguous, of the shapes (n,), (n,), (n,) and (n, 2).
#[derive(FromPyObject)]
pub(crate) struct HitsOut<'py>(
    PyReadwriteArray1<'py, f64>,
    PyReadwriteArray1<'py, i32>,
    PyReadwriteArray1<'py, i32>,
    PyReadwriteArray2<'py, f64>,
);

impl HitsOut<'_> {
    /// For so many hits.
    pub(crate) fn slices(&mut self, count: usize) -> PyResult<HitSlices<'_>> {
        let weights = self.3.as_slice_mut().map_err(not_contiguous)?;
        let slices = HitSlices {
            t: self.0.as_slice_mut().map_err(not_contiguous)?,
            object: self.1.as_slice_mut().map_err(not_contiguous)?,
            primitive: self.2.as_slice_mut().map_err(not_contiguous)?,
            barycentric: bytemuck::cast_slice_mut(weights.as_chunks_mut::<2>().0),
        };
        if slices.count() == Some(count) {
            Ok(slices)
        } else {
            Err(PyValueError::new_err("expected an element for each ray"))
        }
    }
}

/// What [`HitsOut`] became, back again.
#[derive(FromPyObject)]
pub(crate) struct HitsIn<'py>(
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, i32>,
    PyReadonlyArray1<'py, i32>,
    PyReadonlyArray2<'py, f64>,
);

impl HitsIn<'_> {
    /// A copy: callers send a limited number at a time.
    pub(crate) fn hits(&self) -> PyResult<Hits> {
        let pairs = self
            .3
            .as_slice()
            .map_err(not_contiguous)?
            .as_chunks::<2>()
            .0;
        Ok(Hits {
            t: self.0.as_slice().map_err(not_contiguous)?.to_vec(),
            object: self.1.as_slice().map_err(not_contiguous)?.to_vec(),
            primitive: self.2.as_slice().map_err(not_contiguous)?.to_vec(),
            barycentric: pairs.iter().map(|&pair| DVec2::from(pair)).collect(),
        })
    }
}

/// The Python half sends contiguous arrays; this is for calls around it.
pub(crate) fn not_contiguous<E>(_: E) -> PyErr {
    PyValueError::new_err("expected a C-contiguous array")
}
