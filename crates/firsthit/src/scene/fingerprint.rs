use std::collections::HashMap;
use std::sync::Arc;

use super::{Light, Object, Scene};
use crate::geometry::Digest;
use crate::shape::{Shape, Surface};

impl Scene {
    /// A fingerprint of what can be seen: shapes, transforms, colours, lights. Scenes with the same one
    /// give the same pictures; it is the same on every machine, and says nothing of files and names.
    ///
    /// `blake3:` and 32 hexadecimal digits: the first half of the BLAKE3 digest of all that numbers say. Made
    /// once for a scene, by all threads of the current rayon pool.
    pub fn fingerprint(&self) -> &str {
        self.fingerprint.get_or_init(|| self.digest().name())
    }

    fn digest(&self) -> Digest {
        let mut digest = Digest::default();
        // To be changed with whatever is added here: then no old fingerprint can be met by chance.
        digest.word("firsthit scene 1");
        digest.count(self.objects.len());
        let mut known = HashMap::new();
        for object in &self.objects {
            digest_object(object, &mut known, &mut digest);
        }
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

/// `known` are the shared shapes that were met before, by where they are in memory.
fn digest_object(object: &Object, known: &mut HashMap<usize, [u8; 32]>, digest: &mut Digest) {
    let of_shape = || {
        let mut digest = Digest::default();
        object.shape().digest(&mut digest);
        digest.finish()
    };
    let shape = match object.shape() {
        Shape::Mesh(mesh) => *known
            .entry(Arc::as_ptr(mesh) as usize)
            .or_insert_with(of_shape),
        _ => of_shape(),
    };
    digest.bytes(&shape);
    digest.numbers(&object.transform().world_from_object().to_cols_array());
    digest.vector(object.color());
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
    }
}
