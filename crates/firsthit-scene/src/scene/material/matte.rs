//! Matte surfaces.

use super::bsdf::{Bsdf, Frame};
use crate::geometry::{Setting, Settings, Value};
use crate::scene::SurfaceInteraction;

/// A matte surface (Lambert, "Photometria", 1760). It has no settings but its colour.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Matte;

impl Settings for Matte {
    const LIST: &'static [Setting] = &[];

    fn values(&self) -> Vec<Value> {
        Vec::new()
    }

    fn put(&mut self, _place: usize, _value: Value) {}
}

impl Matte {
    #[expect(clippy::unused_self, reason = "as the other models have it")]
    pub(super) fn bsdf(self, surface: &SurfaceInteraction<'_>, frame: Frame, side: f64) -> Bsdf {
        let frame = match surface.mapped_normal(side) {
            Some(normal) => Frame { normal, ..frame }.bent(),
            None => frame,
        };
        Bsdf::even(frame, surface.color())
    }
}
