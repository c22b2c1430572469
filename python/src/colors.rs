//! Colours by numbers.

use firsthit::geometry::ColorMap;
use firsthit::scene::{ColorBy, Coloring};
use pyo3::prelude::*;

/// The source of the numbers, or the numbers of the objects; the map's name; the range; the colours
/// below, above and where there is no number.
#[derive(FromPyObject)]
pub(crate) struct ColorsIn(
    Option<String>,
    Vec<f64>,
    String,
    Option<(f64, f64)>,
    [Option<[f64; 3]>; 3],
);

type Triple = (f64, f64, f64);

/// The colouring on its way out. Tuples, since Python is to compare and hash them.
pub(crate) type ColorsOut = (
    Option<String>,
    Vec<f64>,
    &'static str,
    Option<(f64, f64)>,
    (Option<Triple>, Option<Triple>, Option<Triple>),
);

pub(crate) fn coloring_in(colors: &ColorsIn) -> firsthit::Result<Coloring> {
    let ColorsIn(by, values, map, range, outside) = colors;
    let by = match by {
        Some(by) => by.parse()?,
        None => ColorBy::Values(values.as_slice().into()),
    };
    let [below, above, missing] = outside.map(|color| color.map(Into::into));
    Ok(Coloring { by, map: map.parse()?, range: range.map(Into::into), below, above, missing })
}

pub(crate) fn coloring_out(coloring: &Coloring) -> ColorsOut {
    let (by, values) = match &coloring.by {
        ColorBy::Values(values) => (None, values.to_vec()),
        by => (Some(by.text()), Vec::new()),
    };
    let [below, above, missing] =
        [coloring.below, coloring.above, coloring.missing].map(|color| color.map(Into::into));
    (by, values, coloring.map.name(), coloring.range.map(Into::into), (below, above, missing))
}

/// The words for what gives numbers, beside `attribute:NAME`, and the names of the maps.
#[pyfunction]
pub(crate) fn color_names() -> (Vec<&'static str>, Vec<&'static str>) {
    (ColorBy::NAMES.to_vec(), ColorMap::NAMES.to_vec())
}
