//! Describes a file beside its shapes: cameras, lights, environment, materials, textures.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use firsthit::error::escape_controls;
use firsthit::geometry::Value as Setting;
use firsthit::scene::{Environment, MapRole};
use firsthit::world::{NamedCamera, World};
use firsthit::{DVec3, Lens, Light, Material, Scene, Texture};
use serde_json::{Map, Value, json};

use super::info_environment;
use super::listing::listed;
use crate::camera::labelled;
use crate::hints::{extent, number, place, triple};

/// The looks of a file, in its order; materials and textures are those in use, each once.
pub(super) struct Looks<'a> {
    pub(super) cameras: &'a [NamedCamera],
    pub(super) lights: &'a [Light],
    environment: Option<&'a Environment>,
    up: DVec3,
    extent: f64,
    pub(super) materials: Vec<&'a Material>,
    pub(super) textures: Vec<&'a Arc<Texture>>,
}

impl<'a> Looks<'a> {
    pub(super) fn of(model: &'a World, scene: &'a Scene) -> Self {
        let materials = materials(scene);
        Self {
            cameras: &model.cameras,
            lights: &model.lights,
            environment: model.environment.as_deref(),
            up: model.up_in(scene),
            extent: extent(scene.bounds()),
            textures: textures(&materials),
            materials,
        }
    }

    /// The first `most` cameras.
    pub(super) fn cameras_as_json(&self, most: usize) -> Vec<Value> {
        let camera = |camera: &NamedCamera| {
            let view = &camera.view;
            let viewplane = view.lens.viewplane();
            json!({
                "name": camera.name,
                "own_name": camera.own_name,
                "projection": view.lens.projection().name(),
                "position": view.position.to_array(),
                "aim": view.aim.to_array(),
                "up": view.up.to_array(),
                "focal_length": viewplane.map(|viewplane| viewplane.focal_length),
                "width": viewplane.map(|viewplane| viewplane.width),
                "height": viewplane.map(|viewplane| viewplane.height),
                "parameters": view.lens.parameters().into_iter().collect::<BTreeMap<_, _>>(),
            })
        };
        self.cameras.iter().take(most).map(camera).collect()
    }

    /// The first `most` lights.
    pub(super) fn lights_as_json(&self, most: usize) -> Vec<Value> {
        let light = |light: &Light| {
            let mut entries = Map::new();
            entries.insert("kind".into(), json!(light.name()));
            for (name, value) in light.settings() {
                entries.insert(name.into(), value_json(value));
            }
            Value::Object(entries)
        };
        self.lights.iter().take(most).map(light).collect()
    }

    /// The light from all around; null if there is none.
    pub(super) fn environment_as_json(&self) -> Value {
        let environment = |environment| info_environment::as_json(environment, self.up);
        self.environment.map_or(Value::Null, environment)
    }

    /// The first `most` materials.
    pub(super) fn materials_as_json(&self, most: usize) -> Vec<Value> {
        let material = |material: &&Material| {
            let texture = material.maps.get(MapRole::Color);
            json!({
                "name": &*material.name,
                "color": material.color.to_array(),
                "alpha": material.alpha,
                "alpha_mode": material.alpha_mode.name(),
                "texture": texture.map(|map| size(&map.texture)),
                "unlit": material.unlit,
                "double_sided": material.double_sided,
            })
        };
        self.materials.iter().take(most).map(material).collect()
    }

    /// The sizes of the first `most` textures.
    pub(super) fn textures_as_json(&self, most: usize) -> Vec<Value> {
        self.textures.iter().take(most).map(|&one| size(one)).collect()
    }

    /// The lines of the text, none for what there is none of.
    pub(super) fn as_text(&self, most: usize) -> Vec<String> {
        let mut lines = Vec::new();
        let cameras = self.cameras.iter().enumerate();
        let cameras = cameras.map(|(k, camera)| camera_line(k, camera, self.extent));
        list("cameras", most, cameras, &mut lines);
        let lights = self.lights.iter().enumerate();
        let lights = lights.map(|(k, light)| light_line(k, light, self.extent));
        list("lights", most, lights, &mut lines);
        let environment = self.environment.into_iter();
        lines.extend(environment.map(|one| info_environment::line(one, self.up)));
        let textures = self.textures.iter().enumerate();
        let textures = textures
            .map(|(k, texture)| format!("{k}  {} x {} texels", texture.columns(), texture.rows()));
        list("textures", most, textures, &mut lines);
        let materials = self.materials.iter().enumerate();
        let materials =
            materials.map(|(k, material)| format!("{k}  {}", escape_controls(&material.name)));
        list("materials", most, materials, &mut lines);
        lines
    }
}

/// Adds a title with the number of its entries, and the first `most` of them.
fn list(
    title: &str,
    most: usize,
    entries: impl ExactSizeIterator<Item = String>,
    lines: &mut Vec<String>,
) {
    if entries.len() > 0 {
        lines.push(format!("{title:<10} {}", entries.len()));
        lines.extend(listed(most, "  ", entries));
    }
}

fn size(texture: &Arc<Texture>) -> Value {
    json!([texture.columns(), texture.rows()])
}

fn camera_line(number_of: usize, camera: &NamedCamera, extent: f64) -> String {
    let view = &camera.view;
    let sees = match &view.lens {
        Lens::Flat(viewplane) if viewplane.parallel => format!("{} high", number(viewplane.height)),
        Lens::Flat(viewplane) => {
            let angle = 2.0 * (viewplane.height / 2.0 / viewplane.focal_length).atan();
            let angle = format!("{} degrees", number(angle.to_degrees()));
            if viewplane.aperture > 0.0 {
                let (aperture, focus) = (number(viewplane.aperture), number(viewplane.focus));
                format!("{angle}, aperture {aperture}, focus {focus}")
            } else {
                angle
            }
        }
        lens => {
            let parameters = lens.parameters().into_iter();
            let parameters = parameters.filter(|&(_, value)| value != 0.0);
            let parameters = parameters.map(|(name, value)| format!("{name} {}", number(value)));
            let parameters: Vec<String> = parameters.collect();
            if parameters.is_empty() { "all directions".to_owned() } else { parameters.join(" ") }
        }
    };
    let (label, kind) = (labelled(number_of, camera), view.lens.projection().name());
    let (position, aim) = (place(view.position, extent), triple(view.aim));
    format!("{label}  ({kind}, {sees}, at {position}, aim {aim})")
}

/// The kind of a light, where it is, and where it goes.
fn light_line(number: usize, light: &Light, extent: f64) -> String {
    let mut line = format!("{number}  {}", light.name());
    for (name, value) in light.settings() {
        let word = match name {
            "position" | "center" => "at",
            "direction" | "normal" => "along",
            _ => continue,
        };
        if let Setting::Vector(vector) = value {
            line += " ";
            line += word;
            line += " ";
            line += &match word {
                "at" => place(vector, extent),
                _ => triple(vector),
            };
        }
    }
    line
}

fn value_json(value: Setting) -> Value {
    match value {
        Setting::Flag(flag) => json!(flag),
        Setting::Number(number) => json!(number),
        Setting::Vector(vector) => json!(vector.to_array()),
    }
}

/// All materials in use, in the order of their identifiers.
fn materials(scene: &Scene) -> Vec<&Material> {
    let (mut known, mut found) = (HashSet::new(), Vec::new());
    for (number, object) in scene.objects().iter().enumerate() {
        let list = object.materials();
        if !known.insert(Arc::as_ptr(list).cast::<Material>()) {
            continue;
        }
        let identifiers = scene.catalog().materials_of(number);
        for (&identifier, material) in identifiers.iter().zip(list.iter()) {
            if usize::try_from(identifier) == Ok(found.len()) {
                found.push(material);
            }
        }
    }
    found
}

/// All textures in use, in the order of the materials.
fn textures<'a>(materials: &[&'a Material]) -> Vec<&'a Arc<Texture>> {
    let mut known = HashSet::new();
    let maps = materials.iter();
    let maps = maps.flat_map(|material| material.maps.iter());
    let textures = maps.map(|map| &map.texture);
    textures.filter(|texture| known.insert(Arc::as_ptr(texture))).collect()
}
