//! Takes a model from its own unit of length to another.

#[cfg(feature = "gltf")]
use crate::camera::{Lens, Opening};
use crate::error::Result;
use crate::geometry::{DAffine3, DVec3, Transform};
#[cfg(feature = "gltf")]
use crate::scene::Light;
use crate::world::World;

/// Multiplies all lengths of a model. Its meshes keep their coordinates: transforms are exact, and shared meshes stay shared.
pub(super) fn scaled(mut world: World, factor: f64) -> Result<World> {
    let whole = DAffine3::from_scale(DVec3::splat(factor));
    for object in &mut world.objects {
        let placed = Transform::new(whole * *object.transform().world_from_object())?;
        *object = object.clone().placed(placed);
    }
    #[cfg(feature = "gltf")]
    scale_looks(&mut world, factor);
    Ok(world)
}

/// Cameras and lights, which glTF alone of all models has.
#[cfg(feature = "gltf")]
fn scale_looks(world: &mut World, factor: f64) {
    for camera in &mut world.cameras {
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
    // Light that falls off with the square of the distance is as bright on surfaces that are farther away.
    for light in &mut world.lights {
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
