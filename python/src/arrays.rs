//! Rays and hits in NumPy's memory, as the library sees them.

use firsthit::shoot::HitSlices;
use firsthit::{DVec2, DVec3, Hits, Ray, RayFilter, Rays};
use numpy::{
    PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn, PyReadwriteArray1, PyReadwriteArray2,
    PyReadwriteArrayDyn,
};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::errors::{Outcome, Raised};
use rayon::prelude::*;

use crate::filters::{FilterArrays, Filters};

/// Rays in arrays of the interpreter: of each array one element for all rays, or one for each.
pub(crate) struct RaySlices<'a> {
    count: usize,
    origins: &'a [[f64; 3]],
    directions: &'a [[f64; 3]],
    t_min: &'a [f64],
    t_max: &'a [f64],
    filters: Option<Filters<'a>>,
}

impl Rays for RaySlices<'_> {
    fn len(&self) -> usize {
        self.count
    }

    fn ray(&self, index: usize) -> Ray {
        let ray = Ray::new(
            DVec3::from(*of(self.origins, index)),
            DVec3::from(*of(self.directions, index)),
        );
        ray.beyond(*of(self.t_min, index)).up_to(*of(self.t_max, index))
    }

    fn is_filtered(&self) -> bool {
        self.filters.is_some()
    }

    fn filter(&self, index: usize) -> RayFilter {
        let filters = self.filters.as_ref();
        filters.map_or(RayFilter::NONE, |filters| filters.filter(index))
    }
}

impl<'a> RaySlices<'a> {
    /// The rays, their origins and directions copied to where `copies` say, by all threads of the
    /// current rayon pool.
    pub(crate) fn copied(self, copies: [Option<&'a mut [[f64; 3]]>; 2]) -> Self {
        let [origins, directions] = copies;
        Self {
            origins: copied_to(self.origins, origins),
            directions: copied_to(self.directions, directions),
            ..self
        }
    }
}

fn copied_to<'a>(values: &'a [[f64; 3]], copy: Option<&'a mut [[f64; 3]]>) -> &'a [[f64; 3]] {
    /// Elements that are copied at a time: what remains is nothing beside them.
    const PIECE: usize = 1 << 14;
    let Some(copy) = copy else {
        return values;
    };
    let pieces = copy.par_chunks_mut(PIECE).zip(values.par_chunks(PIECE));
    pieces.for_each(|(copy, values)| copy.copy_from_slice(values));
    copy
}

/// The element of a ray: its own, or the one for all.
pub(crate) fn of<T>(elements: &[T], index: usize) -> &T {
    elements.get(index).unwrap_or(&elements[0])
}

/// Arrays of rays as they come: C-contiguous float64, twice of 3 n or 3 numbers, and twice of n or
/// 1; and what the rays do not meet.
#[derive(FromPyObject)]
pub(crate) struct RayArrays<'py>(
    PyReadonlyArrayDyn<'py, f64>,
    PyReadonlyArrayDyn<'py, f64>,
    PyReadonlyArrayDyn<'py, f64>,
    PyReadonlyArrayDyn<'py, f64>,
    Option<FilterArrays<'py>>,
);

impl RayArrays<'_> {
    /// The slices of `count` rays.
    pub(crate) fn slices(&self, count: usize) -> Outcome<RaySlices<'_>> {
        let filters = self.4.as_ref().map(|filters| filters.filters(count));
        let rays = RaySlices {
            count,
            origins: self.0.as_slice()?.as_chunks().0,
            directions: self.1.as_slice()?.as_chunks().0,
            t_min: self.2.as_slice()?,
            t_max: self.3.as_slice()?,
            filters: filters.transpose()?,
        };
        let counts =
            [rays.origins.len(), rays.directions.len(), rays.t_min.len(), rays.t_max.len()];
        if counts.iter().all(|&each| each == count || each == 1) {
            Ok(rays)
        } else {
            Err(Raised::value("expected arrays of one length"))
        }
    }
}

/// Memory for copies of origins and directions as [`RayArrays`] have them, of each that is to be
/// copied.
#[derive(FromPyObject)]
pub(crate) struct CopiesOut<'py>(
    Option<PyReadwriteArrayDyn<'py, f64>>,
    Option<PyReadwriteArrayDyn<'py, f64>>,
);

impl CopiesOut<'_> {
    /// The slices for copies of `rays`, whose arrays must be as long.
    pub(crate) fn slices(&mut self, rays: &RaySlices<'_>) -> Outcome<[Option<&mut [[f64; 3]]>; 2]> {
        Ok([
            copy_slice(self.0.as_mut(), rays.origins.len())?,
            copy_slice(self.1.as_mut(), rays.directions.len())?,
        ])
    }
}

fn copy_slice<'a>(
    copy: Option<&'a mut PyReadwriteArrayDyn<'_, f64>>,
    count: usize,
) -> Outcome<Option<&'a mut [[f64; 3]]>> {
    let Some(copy) = copy else {
        return Ok(None);
    };
    let copy = copy.as_slice_mut()?;
    let copy = copy.as_chunks_mut().0;
    if copy.len() == count {
        Ok(Some(copy))
    } else {
        Err(Raised::value("expected copies of the rays' length"))
    }
}

/// A copy of what Python owns, or a `MemoryError`.
pub(crate) fn copied<T: Copy>(values: &[T]) -> Outcome<Vec<T>> {
    collected(values.len(), values.iter().copied())
}

/// `count` values in memory, or a `MemoryError`.
pub(crate) fn collected<T>(count: usize, values: impl Iterator<Item = T>) -> Outcome<Vec<T>> {
    let mut all = Vec::new();
    all.try_reserve_exact(count)
        .map_err(|error| PyMemoryError::new_err(format!("{count} elements: {error}")))?;
    all.extend(values.take(count));
    Ok(all)
}

/// The arrays for hits: `t`, `object`, `primitive` and `barycentric`, C-contiguous, of the shapes
/// (n,), (n,), (n,) and (n, 2).
#[derive(FromPyObject)]
pub(crate) struct HitsOut<'py>(
    PyReadwriteArray1<'py, f64>,
    PyReadwriteArray1<'py, i32>,
    PyReadwriteArray1<'py, i32>,
    PyReadwriteArray2<'py, f64>,
);

impl HitsOut<'_> {
    pub(crate) fn slices(&mut self) -> Outcome<(HitSlices<'_>, usize)> {
        let weights = self.3.as_slice_mut()?;
        let slices = HitSlices {
            t: self.0.as_slice_mut()?,
            object: self.1.as_slice_mut()?,
            primitive: self.2.as_slice_mut()?,
            barycentric: bytemuck::cast_slice_mut(weights.as_chunks_mut::<2>().0),
        };
        match slices.count() {
            Some(count) => Ok((slices, count)),
            None => Err(Raised::value("expected an element for each ray")),
        }
    }
}

/// The arrays of hits, filled by [`HitsOut`], back again.
#[derive(FromPyObject)]
pub(crate) struct HitsIn<'py>(
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, i32>,
    PyReadonlyArray1<'py, i32>,
    PyReadonlyArray2<'py, f64>,
);

impl HitsIn<'_> {
    /// A copy: callers send a limited number at a time.
    pub(crate) fn hits(&self) -> Outcome<Hits> {
        let pairs = self.3.as_slice()?.as_chunks::<2>().0;
        Ok(Hits {
            t: copied(self.0.as_slice()?)?,
            object: copied(self.1.as_slice()?)?,
            primitive: copied(self.2.as_slice()?)?,
            barycentric: collected(pairs.len(), pairs.iter().map(|&pair| DVec2::from(pair)))?,
        })
    }
}
