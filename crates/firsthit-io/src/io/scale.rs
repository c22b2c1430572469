//! Takes a model from its own unit of length to another.

use super::model::Model;
#[cfg(feature = "gltf")]
use crate::camera::{Lens, Opening};
use crate::error::Result;
use crate::geometry::{DAffine3, DVec3, Transform};
#[cfg(feature = "gltf")]
use crate::scene::Light;

/// Multiplies all lengths of a model. Its meshes keep their coordinates: transforms are exact, and
/// shared meshes stay shared.
pub(super) fn scaled(mut model: Model, factor: f64) -> Result<Model> {
    let whole = DAffine3::from_scale(DVec3::splat(factor));
    for object in &mut model.objects {
        let placed = Transform::new(whole * *object.transform().world_from_object())?;
        *object = object.clone().placed(placed);
    }
    #[cfg(feature = "gltf")]
    scale_looks(&mut model, factor);
    Ok(model)
}

/// Cameras and lights, which glTF alone of all models has.
#[cfg(feature = "gltf")]
fn scale_looks(model: &mut Model, factor: f64) {
    for camera in &mut model.cameras {
        camera.view.position *= factor;
        if let Lens::Flat(viewplane) = &mut camera.view.lens {
            viewplane.focal_length *= factor;
            viewplane.width *= factor;
            viewplane.height *= factor;
        }
        if let Some(described) = &mut camera.description {
            described.position = described.position.map(|position| factor * position);
            if let Some(Opening::Viewplane { width, height, .. }) = &mut described.opening {
                *width *= factor;
                *height *= factor;
            }
        }
    }
    // Light that falls off with the square of the distance is as bright on surfaces that are
    // farther away.
    for light in &mut model.lights {
        match light {
            Light::Point(lamp) => {
                lamp.position *= factor;
                lamp.intensity *= factor * factor;
            }
            Light::Spot(lamp) => {
                lamp.position *= factor;
                lamp.intensity *= factor * factor;
            }
            _ => {}
        }
    }
}
