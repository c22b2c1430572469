//! `KHR_draco_mesh_compression`, unpacked by the `draco-core` crate.

use std::panic::{AssertUnwindSafe, catch_unwind};

use draco_core::decode_limits::DecodeLimits;
use draco_core::decoder_buffer::DecoderBuffer;
use draco_core::mesh::Mesh;
use draco_core::mesh_decoder::MeshDecoder;

use super::super::report::Report;
use super::index::Index;
use super::problem::Problem;
use crate::error::escape_controls;

/// A primitive as it was packed.
pub(super) struct Unpacked {
    mesh: Mesh,
}

/// The peak memory of unpacking a face, the tables of its corners included.
const FACE_BYTES: u64 = 96;

impl Unpacked {
    pub(super) fn new(source: &[u8], report: &mut Report) -> Result<Self, Problem> {
        // The work, if nothing else: many primitives may name the same bytes.
        report.budget.charge(source.len() as u64, "a packed mesh")?;
        let memory = report.budget.left_to_describe();
        let limits = DecodeLimits::default()
            .with_max_faces(memory / FACE_BYTES)
            .with_max_points(memory / FACE_BYTES)
            .with_max_decoded_bytes(memory / 2);
        // The one place where another's code decodes hostile bytes with indices of its own: it is
        // safe Rust throughout, so a bug in it can only panic. That is an error of the file, not of
        // the program; the decoder's state is dropped.
        let decoded = catch_unwind(AssertUnwindSafe(|| {
            let mut mesh = Mesh::new();
            let mut buffer = DecoderBuffer::new(source).with_limits(limits);
            MeshDecoder::new()
                .decode(&mut buffer, &mut mesh)
                .map_err(|error| escape_controls(&error.to_string()))?;
            Ok::<_, String>(mesh)
        }));
        let mesh = decoded
            .unwrap_or_else(|_| Err("the packed mesh cannot be read".to_owned()))
            .map_err(|reason| format!("Draco: {reason}"))?;
        let faces = mesh.num_faces() as u64;
        report.budget.charge(FACE_BYTES.saturating_mul(faces), "a packed mesh")?;
        Ok(Self { mesh })
    }

    pub(super) fn vertices(&self) -> usize {
        self.mesh.num_points()
    }

    pub(super) fn triangles(&self) -> Vec<[u32; 3]> {
        let faces = self.mesh.faces().iter();
        faces.map(|face| face.map(|point| point.0)).collect()
    }

    /// The values of an attribute at the vertices, `components` numbers each.
    pub(super) fn attribute(
        &self,
        Index(identifier): Index,
        components: usize,
        report: &mut Report,
    ) -> Result<Vec<f32>, Problem> {
        let identifier = u32::try_from(identifier).ok();
        let attribute = identifier.and_then(|id| self.mesh.attribute_by_unique_id(id));
        let attribute = attribute.ok_or("the packed mesh has no attribute of that identifier")?;
        let count = self.vertices();
        report.budget.charge(4 * (count as u64) * components as u64, "a packed attribute")?;
        Ok(attribute.read_f32s(count, components))
    }
}
