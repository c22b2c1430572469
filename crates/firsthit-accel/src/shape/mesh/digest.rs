//! The digest of a mesh: all the numbers that it is made from.

use std::ops::Range;

use super::Mesh;
use crate::geometry::{DVec3, Digest};
use crate::parallel;
use crate::shape::Attribute;

/// The number of triangles in one part of a digest: a constant, because the parts show in the
/// result.
const AT_ONCE: usize = 4096;

impl Mesh {
    /// Adds what the triangles are, not how they are stored: neither the order of the vertices nor
    /// those that no triangle uses make a difference.
    pub(super) fn digest(&self, digest: &mut Digest) {
        let count = self.triangles.len();
        digest.count(count);
        let starts = (0..count).step_by(AT_ONCE);
        let parts = parallel::map(starts, |first| self.part(first..count.min(first + AT_ONCE)));
        digest.bytes(parts.as_flattened());
    }

    /// The digest of some triangles with all their attributes.
    fn part(&self, triangles: Range<usize>) -> [u8; 32] {
        let mut digest = Digest::default();
        let corners = triangles.clone().flat_map(|k| self.corners(k));
        let numbers: Vec<f64> = corners.flat_map(|corner: DVec3| corner.to_array()).collect();
        digest.numbers(&numbers);
        let numbers = triangles.clone().flat_map(|k| [self.face(k), self.slot(k)]);
        let numbers: Vec<f64> = numbers.map(|number| number as f64).collect();
        digest.numbers(&numbers);
        self.add_attribute(self.normals.as_ref(), triangles.clone(), &mut digest);
        self.add_attribute(self.uvs.as_ref(), triangles.clone(), &mut digest);
        self.add_attribute(self.colors.as_ref(), triangles.clone(), &mut digest);
        self.add_attribute(self.alphas.as_ref(), triangles.clone(), &mut digest);
        // Only where there are some, so that meshes without them keep the digests they had.
        if self.second_uvs.is_some() {
            digest.word("second uvs");
            self.add_attribute(self.second_uvs.as_ref(), triangles.clone(), &mut digest);
        }
        if self.tangents.is_some() {
            digest.word("tangents");
            self.add_attribute(self.tangents.as_ref(), triangles, &mut digest);
        }
        digest.finish()
    }

    fn add_attribute<const N: usize>(
        &self,
        attribute: Option<&Attribute<N>>,
        triangles: Range<usize>,
        digest: &mut Digest,
    ) {
        digest.count(usize::from(attribute.is_some()));
        if let Some(attribute) = attribute {
            let values = triangles.flat_map(|k| attribute.at_corners(k, self.triangles[k]));
            let numbers: Vec<f64> = values.flatten().map(f64::from).collect();
            digest.numbers(&numbers);
        }
    }
}
