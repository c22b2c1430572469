//! The rays of a camera, tile by tile.

mod edge_test;
pub(super) mod frustum;
mod raster;
pub(super) mod traverse;
pub(super) mod visibility;
