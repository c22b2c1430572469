//! The origin of outputs, and the names behind their identifiers.

use super::{legend, mattes};
use crate::channel::ChannelKind;
use crate::geometry::Value;
use crate::image::{Names, Origin, ShadingRecord};
use crate::scene::Scene;
use crate::sensor::{Record, Sensor};
use crate::shade::Recipe;

/// The origin of outputs: the scene's fingerprint, the camera, if one made the rays, and the names
/// behind the identifiers of the `channels`. `samples` are the points of a pixel that its colour is
/// the mean of, if there are colours or mattes.
pub fn origin(
    scene: &Scene,
    sensor: Option<&dyn Sensor>,
    samples: Option<u32>,
    channels: &[&ChannelKind],
) -> Origin {
    let has_names = channels.iter().any(|kind| kind.has_names());
    let (camera, sensor) = match sensor.map(Sensor::record) {
        Some(Record::Camera(camera)) => (Some(*camera), None),
        Some(Record::Other(sensor)) => (None, Some(*sensor)),
        None => (None, None),
    };
    Origin {
        scene: Some(scene.fingerprint().to_owned()),
        camera,
        sensor,
        samples,
        shading: None,
        colors: (scene.colored())
            .filter(|_| channels.iter().any(|kind| kind.needs_shade()))
            .map(legend::record),
        first_pixel: [0, 0],
        names: has_names.then(|| names(scene)),
        cryptomatte: (channels.iter()).filter_map(|kind| mattes::record(scene, kind)).collect(),
        scan: None,
        scans: None,
    }
}

/// A recipe as outputs have it.
pub(super) fn record(recipe: Recipe) -> ShadingRecord {
    let number = |x: f64| {
        if x.is_finite() { x.into() } else { x.to_string().into() }
    };
    let value = |value| match value {
        Value::Flag(flag) => flag.into(),
        Value::Number(x) => number(x),
        Value::Vector(v) => v.to_array().map(number).to_vec().into(),
    };
    let settings = recipe.settings.into_iter();
    ShadingRecord {
        shader: recipe.shader.to_owned(),
        settings: settings.map(|(name, of)| (name.to_owned(), value(of))).collect(),
        digest: recipe.digest,
    }
}

/// The names of a scene's objects, and of what they come from.
pub fn names(scene: &Scene) -> Names {
    let catalog = scene.catalog();
    let objects = scene.objects().iter().enumerate();
    let objects = objects.map(|(number, object)| {
        let (node, mesh) = (catalog.node_of(number), catalog.mesh_of(number));
        (object.name(), node, mesh, catalog.materials_of(number))
    });
    let lists = [catalog.nodes(), catalog.meshes(), catalog.materials()];
    Names::new(objects, lists)
}
