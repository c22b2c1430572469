//! Filters of rays, in NumPy's memory.

use firsthit::shoot::{Viewpoint, visible as see};
use firsthit::{DVec2, DVec3, Departure, RayFilter, Side, SurfaceId};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{collected, of};
use crate::errors::{Outcome, Raised};
use crate::run::{FEW, run_sized};
use crate::scene::Scene;

type Identifiers<'py> = (PyReadonlyArray1<'py, i32>, PyReadonlyArray1<'py, i32>);

/// Objects and primitives, and two weights of each place: n of them, or one for all.
type Places<'py> = (
    PyReadonlyArray1<'py, i32>,
    PyReadonlyArray1<'py, i32>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray1<'py, i8>,
);

/// Filters as they come: masks, the name of the side that is culled, surfaces that are skipped,
/// places that are left, objects that alone are met. Of each array n elements or one.
#[derive(FromPyObject)]
pub(crate) struct FilterArrays<'py>(
    Option<PyReadonlyArray1<'py, u32>>,
    Option<String>,
    Option<Identifiers<'py>>,
    Option<Places<'py>>,
    Option<PyReadonlyArray1<'py, i32>>,
);

/// The arrays of [`Places`].
type PlaceSlices<'a> = (&'a [i32], &'a [i32], &'a [[f64; 2]], &'a [i8]);

/// [`FilterArrays`] for a number of rays.
pub(crate) struct Filters<'a> {
    masks: Option<&'a [u32]>,
    cull: Option<Side>,
    skip: Option<(&'a [i32], &'a [i32])>,
    left: Option<PlaceSlices<'a>>,
    only: Option<&'a [i32]>,
}

impl FilterArrays<'_> {
    /// The filters of `count` rays.
    pub(crate) fn filters(&self, count: usize) -> Outcome<Filters<'_>> {
        let Self(masks, cull, skip, left, only) = self;
        let masks = masks.as_ref().map(|masks| slice(masks, count)).transpose()?;
        let skip = skip.as_ref();
        let skip = skip.map(|(object, primitive)| identifiers(object, primitive, count));
        let left = left.as_ref().map(|(object, primitive, weights, sides)| {
            let (object, primitive) = identifiers(object, primitive, count)?;
            let weights = weights.as_slice()?;
            let weights = of_count(weights.as_chunks::<2>().0, count)?;
            Ok::<_, PyErr>((object, primitive, weights, slice(sides, count)?))
        });
        Ok(Filters {
            masks,
            cull: cull.as_deref().map(str::parse).transpose()?,
            skip: skip.transpose()?,
            left: left.transpose()?,
            only: only.as_ref().map(|only| slice(only, count)).transpose()?,
        })
    }
}

fn slice<'a, T: numpy::Element>(
    array: &'a PyReadonlyArray1<'_, T>,
    count: usize,
) -> Outcome<&'a [T]> {
    of_count(array.as_slice()?, count)
}

fn identifiers<'a>(
    object: &'a PyReadonlyArray1<'_, i32>,
    primitive: &'a PyReadonlyArray1<'_, i32>,
    count: usize,
) -> Outcome<(&'a [i32], &'a [i32])> {
    Ok((slice(object, count)?, slice(primitive, count)?))
}

fn of_count<T>(elements: &[T], count: usize) -> Outcome<&[T]> {
    if elements.len() == count || elements.len() == 1 {
        Ok(elements)
    } else {
        Err(Raised::value("expected an element for each ray"))
    }
}

/// A surface, unless its object is negative.
fn surface(object: i32, primitive: i32) -> Option<SurfaceId> {
    (object >= 0).then_some(SurfaceId { object, primitive })
}

impl Filters<'_> {
    /// The filter of the ray `index`.
    pub(crate) fn filter(&self, index: usize) -> RayFilter {
        let skip = self
            .skip
            .and_then(|(object, primitive)| surface(*of(object, index), *of(primitive, index)));
        let departure = self.left.and_then(|(object, primitive, weights, sides)| {
            let surface = surface(*of(object, index), *of(primitive, index))?;
            let barycentric = DVec2::from(*of(weights, index));
            let side = match of(sides, index).signum() {
                1 => Some(Side::Front),
                -1 => Some(Side::Back),
                _ => None,
            };
            Some(Departure { surface, barycentric, side })
        });
        RayFilter {
            mask: self.masks.map_or(u32::MAX, |masks| *of(masks, index)),
            only: self.only.map(|only| *of(only, index)),
            cull: self.cull,
            skip: [skip, None],
            departure,
        }
    }
}

/// Ends of lines of sight: positions, and the surfaces that they lie on.
#[derive(FromPyObject)]
pub(crate) struct EndsIn<'py>(PyReadonlyArray2<'py, f64>, Option<Identifiers<'py>>);

impl EndsIn<'_> {
    fn viewpoints(&self, count: usize) -> Outcome<impl Fn(usize) -> Viewpoint> {
        let Self(positions, surfaces) = self;
        let positions = positions.as_slice()?;
        let positions = of_count(positions.as_chunks::<3>().0, count)?;
        let surfaces = surfaces.as_ref();
        let surfaces = surfaces.map(|(object, primitive)| identifiers(object, primitive, count));
        let surfaces = surfaces.transpose()?;
        Ok(move |index| Viewpoint {
            position: DVec3::from(*of(positions, index)),
            surface: surfaces
                .and_then(|(object, primitive)| surface(*of(object, index), *of(primitive, index))),
        })
    }
}

/// Whether the ends of some lines of sight see each other, with a tolerance.
#[pyfunction]
pub(crate) fn visible<'py>(
    py: Python<'py>,
    scene: &Scene,
    ends: (EndsIn<'py>, EndsIn<'py>),
    how: (usize, f64),
    threads: usize,
    report: Option<Bound<'py, PyAny>>,
) -> Outcome<Bound<'py, PyArray1<bool>>> {
    let (count, tolerance) = how;
    let (a, b) = (ends.0.viewpoints(count)?, ends.1.viewpoints(count)?);
    let pairs = collected(count, (0..count).map(|index| [a(index), b(index)]))?;
    let size = (count, count < FEW);
    let seen = run_sized(py, size, threads, report.as_ref(), |watch| {
        see(&scene.0, &pairs, tolerance, watch)
    })?;
    Ok(PyArray1::from_vec(py, seen))
}
