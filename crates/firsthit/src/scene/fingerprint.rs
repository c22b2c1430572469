use std::collections::HashMap;
use std::sync::Arc;

use super::{AlphaMode, Filter, Light, MapRole, Material, Object, Scene, TextureMap, Wrap};
use crate::geometry::Digest;
use crate::shape::Surface;

impl Scene {
    /// A fingerprint of what can be seen: shapes, transforms, colours, lights, which objects are hidden. Scenes with the same
    /// one give the same pictures; it is the same on every machine, and says nothing of files, names and masks other than 0.
    ///
    /// `blake3:` and 32 hexadecimal digits: the first half of the BLAKE3 digest of all that numbers say. Made
    /// once for a scene, by all threads of the current rayon pool.
    pub fn fingerprint(&self) -> &str {
        // Made outside of the cell: a process that is forked meanwhile would wait for a thread that it does not have.
        let made = match self.fingerprint.get() {
            Some(known) => return known,
            None => self.digest().name(),
        };
        self.fingerprint.get_or_init(|| made)
    }

    fn digest(&self) -> Digest {
        let mut digest = Digest::default();
        // To be changed with whatever is added here: then no old fingerprint can be met by chance.
        digest.word("firsthit scene 1");
        digest.count(self.objects.len());
        let mut known = self.digests.get().cloned().unwrap_or_default();
        for object in &self.objects {
            digest_object(object, &mut known, &mut digest);
        }
        // Whoever was first has the same.
        let _ = self.digests.set(known);
        let own: &[Light] = if self.has_own_lights {
            &self.lights
        } else {
            &[]
        };
        digest.count(own.len());
        for light in own {
            digest_light(light, &mut digest);
        }
        digest
    }
}

/// What was met before, by where it is in memory: objects share meshes, and materials textures.
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
    // Nobody's look is the neutral colour, whoever chose it.
    let neutral = [Material::colored(Object::NEUTRAL)];
    let materials = if object.materials().is_empty() {
        &neutral[..]
    } else {
        object.materials()
    };
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
        maps,
        alpha_mode,
        unlit,
        double_sided: _,
    } = material;
    digest.vector(*color);
    digest.numbers(&[*alpha, f64::from(*unlit)]);
    match alpha_mode {
        AlphaMode::Opaque => digest.word("opaque"),
        AlphaMode::Mask { cutoff } => {
            digest.word("mask");
            digest.numbers(&[*cutoff]);
        }
        AlphaMode::Blend => digest.word("blend"),
    }
    for map in MapRole::ALL.map(|role| maps.get(role)) {
        digest.count(usize::from(map.is_some()));
        if let Some(map) = map {
            digest_map(map, known, digest);
        }
    }
}

fn digest_map(map: &TextureMap, known: &mut Known, digest: &mut Digest) {
    let TextureMap {
        texture,
        wrap,
        filter,
        picture_from_uv,
    } = map;
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
        digest.word(match wrap {
            Wrap::Repeat => "repeat",
            Wrap::Mirror => "mirror",
            Wrap::Clamp => "clamp",
        });
    }
    digest.word(match filter {
        Filter::Nearest => "nearest",
        Filter::Linear => "linear",
    });
    digest.numbers(picture_from_uv.as_flattened());
}

fn digest_light(light: &Light, digest: &mut Digest) {
    match *light {
        Light::Directional { direction, color } => {
            digest.word("directional");
            digest.vector(direction);
            digest.vector(color);
        }
        Light::Point {
            position,
            intensity,
        } => {
            digest.word("point");
            digest.vector(position);
            digest.vector(intensity);
        }
        Light::Spot {
            position,
            direction,
            intensity,
            inner_angle,
            outer_angle,
        } => {
            digest.word("spot");
            digest.vector(position);
            digest.vector(direction);
            digest.vector(intensity);
            digest.numbers(&[inner_angle, outer_angle]);
        }
    }
}
