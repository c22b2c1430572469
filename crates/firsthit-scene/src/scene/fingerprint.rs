use std::collections::HashMap;
use std::sync::Arc;

use super::{
    ColorBy, Environment, EnvironmentKind, Light, MapRole, Material, Model, Object, Scene,
    TextureMap, UvSet,
};
use crate::geometry::{Color, Digest, Value};
use crate::parallel;
use crate::shape::{Property, Surface};

impl Scene {
    /// A fingerprint of what can be seen: shapes, transforms, colours, lights, which objects are
    /// hidden. Scenes with the same one give the same pictures; it is the same on every machine,
    /// and says nothing of files, names and masks other than 0.
    ///
    /// `blake3:` and 32 hexadecimal digits: the first half of the BLAKE3 digest of all that numbers
    /// say. Made once for a scene, by all threads of the current rayon pool.
    pub fn fingerprint(&self) -> &str {
        parallel::once::<String>(&self.derived.fingerprint, || self.digest().name())
    }

    /// Adds all that shines but surfaces, the scene's own and borrowed lights alike.
    #[doc(hidden)]
    pub fn digest_light(&self, digest: &mut Digest) {
        digest.count(self.lights.len());
        for light in &self.lights {
            digest_light(light, digest);
        }
        if let Some(environment) = self.environment() {
            digest_environment(environment, digest);
        }
    }

    /// Adds the numbers that surfaces are coloured by, as far as the fingerprint does not know
    /// them.
    #[doc(hidden)]
    pub fn digest_coloring(&self, digest: &mut Digest) {
        match self.colored().map(|colored| &colored.coloring().by) {
            Some(ColorBy::Values(values)) => {
                digest.word("values");
                digest.numbers(values);
            }
            Some(ColorBy::Attribute(name)) => self.digest_attribute(name, digest),
            _ => {}
        }
    }

    /// Adds the numbers of an attribute of all meshes.
    fn digest_attribute(&self, name: &str, digest: &mut Digest) {
        digest.word("attribute");
        for mesh in self.objects.iter().filter_map(Object::mesh) {
            let named = mesh.properties().iter();
            for property in named.filter(|property| property.name == name) {
                let Property { name: _, of, components, between, values } = property;
                digest.word(&format!("{of:?} {between:?}"));
                digest.count(*components);
                digest.count(values.len());
                let mut chunk = Vec::new();
                for first in (0..values.len()).step_by(512) {
                    let rest = first..values.len().min(first + 512);
                    chunk.clear();
                    chunk.extend(rest.filter_map(|index| values.get(index)));
                    digest.numbers(&chunk);
                }
            }
        }
    }

    fn digest(&self) -> Digest {
        let mut digest = Digest::default();
        // To be changed with whatever is added here: then no old fingerprint can be met by chance.
        digest.word("firsthit scene 1");
        digest.count(self.objects.len());
        let mut known = self.derived.digests.get().cloned().unwrap_or_default();
        for object in &self.objects {
            digest_object(object, &mut known, &mut digest);
        }
        // The first thread's value is equal.
        let _ = self.derived.digests.set(known);
        let own: &[Light] = if self.has_own_lights { &self.lights } else { &[] };
        digest.count(own.len());
        for light in own {
            digest_light(light, &mut digest);
        }
        let own = self.environment.as_deref().filter(|_| self.has_own_environment);
        if let Some(environment) = own {
            digest_environment(environment, &mut digest);
        }
        digest
    }
}

/// Digests of meshes and textures, by their address in memory: objects share meshes, and materials
/// share textures.
pub(super) type Known = HashMap<usize, [u8; 32]>;

fn digest_object(object: &Object, known: &mut Known, digest: &mut Digest) {
    let of_shape = || {
        let mut digest = Digest::default();
        object.shape().digest(&mut digest);
        digest.finish()
    };
    let shape = match object.mesh() {
        Some(mesh) => *(known.entry(Arc::as_ptr(mesh).addr())).or_insert_with(of_shape),
        None => of_shape(),
    };
    digest.bytes(&shape);
    digest.numbers(&object.transform().world_from_object().to_cols_array());
    // An object without a look counts as one in the neutral colour.
    let neutral = [Material::colored(Object::NEUTRAL)];
    let materials = if object.materials().is_empty() { &neutral[..] } else { object.materials() };
    digest.count(materials.len());
    for material in materials {
        digest_material(material, known, digest);
    }
    // For hidden objects only, so that scenes without any keep the fingerprints they had.
    if object.is_hidden() {
        digest.word("hidden");
    }
}

/// All but `name` and `double_sided`, which change no picture.
fn digest_material(material: &Material, known: &mut Known, digest: &mut Digest) {
    let Material {
        name: _,
        color,
        alpha,
        model,
        emission,
        maps,
        normal_scale,
        occlusion_strength,
        alpha_mode,
        unlit,
        double_sided: _,
    } = material;
    digest.vector(*color);
    digest.numbers(&[*alpha, f64::from(*unlit)]);
    digest.word(alpha_mode.name());
    digest.numbers(alpha_mode.cutoff().as_slice());
    let first = [MapRole::Color, MapRole::Alpha];
    for map in first.map(|role| maps.get(role)) {
        digest.count(usize::from(map.is_some()));
        if let Some(map) = map {
            digest_map(map, known, digest);
        }
    }
    // All that follows only where it is unusual, so that scenes of plain materials keep the
    // fingerprints they had.
    for (role, map) in maps.roles().filter(|(role, _)| !first.contains(role)) {
        digest.word(role.name());
        digest_map(map, known, digest);
    }
    if *model != Model::default() {
        digest.word(model.name());
        digest_settings(&model.settings(), digest);
    }
    let numbers = [*normal_scale, *occlusion_strength];
    if *emission != Color::ZERO || numbers != [1.0; 2] {
        digest.word("emission");
        digest.vector(*emission);
        digest.numbers(&numbers);
    }
}

fn digest_settings(settings: &[(&'static str, Value)], digest: &mut Digest) {
    for (_, value) in settings {
        value.digest(digest);
    }
}

fn digest_map(map: &TextureMap, known: &mut Known, digest: &mut Digest) {
    let TextureMap { texture, wrap, filter, uv_set, picture_from_uv } = map;
    let of_texture = || {
        let mut digest = Digest::default();
        digest.count(texture.columns());
        digest.count(texture.rows());
        digest.bytes(texture.texels().as_flattened());
        digest.finish()
    };
    let texels = *(known.entry(Arc::as_ptr(texture).addr())).or_insert_with(of_texture);
    digest.bytes(&texels);
    for wrap in wrap {
        digest.word(wrap.name());
    }
    digest.word(filter.name());
    if *uv_set == UvSet::Second {
        digest.word("second uvs");
    }
    digest.numbers(picture_from_uv.as_flattened());
}

fn digest_light(light: &Light, digest: &mut Digest) {
    digest.word(light.name());
    let mut settings = light.settings();
    // For suns only, so that scenes without any keep the fingerprints they had.
    settings.retain(|setting| *setting != ("angle_degrees", Value::Number(0.0)));
    digest_settings(&settings, digest);
}

/// Adds the environment's radiance, not whether the camera sees it.
fn digest_environment(environment: &Environment, digest: &mut Digest) {
    digest.word("environment");
    digest.numbers(&[environment.strength]);
    match &environment.kind {
        EnvironmentKind::Uniform(color) => {
            digest.word("uniform");
            digest.vector(*color);
        }
        EnvironmentKind::Hemispheres { above, below, up } => {
            digest.word("hemispheres");
            for vector in [above, below, up] {
                digest.vector(*vector);
            }
        }
        EnvironmentKind::Gradient { horizon, zenith, up } => {
            digest.word("gradient");
            for vector in [horizon, zenith, up] {
                digest.vector(*vector);
            }
        }
        EnvironmentKind::Map { map, world_from_map } => {
            digest.word("map");
            digest.count(map.columns());
            digest.count(map.rows());
            digest.bytes(&digest_of_texels(map.texels()));
            digest.numbers(&world_from_map.to_cols_array());
        }
        EnvironmentKind::Daylight(daylight) => {
            digest.word("daylight");
            let [elevation, azimuth] = [daylight.elevation_degrees(), daylight.azimuth_degrees()];
            digest.numbers(&[elevation, azimuth, daylight.turbidity()]);
            for vector in [daylight.up(), daylight.ground()] {
                digest.vector(vector);
            }
        }
    }
}

/// The number of texels in one part of a digest: a constant, because the parts show in the result.
const AT_ONCE: usize = 1 << 16;

fn digest_of_texels(texels: &[[f32; 3]]) -> [u8; 32] {
    let part = |texels: &[[f32; 3]]| {
        let mut digest = Digest::default();
        let numbers = texels.as_flattened().iter();
        digest.numbers(&numbers.map(|&number| f64::from(number)).collect::<Vec<_>>());
        digest.finish()
    };
    let parts = parallel::map(texels.chunks(AT_ONCE), part);
    let mut digest = Digest::default();
    digest.bytes(parts.as_flattened());
    digest.finish()
}
