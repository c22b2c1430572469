//! The meshes of a scene as a PLY file whose faces are coloured by what is wrong with them.

use std::io::{self, Write};
use std::path::Path;

use super::Report;
use crate::error::{Error, Result};
use crate::geometry::DVec3;
use crate::image::write_whole;
use crate::scene::{Object, Scene};
use crate::watch::Watch;

/// The colour of a face that nothing is wrong with, sRGB.
const FINE: [u8; 3] = [200, 200, 200];

/// Writes all meshes to a PLY file, whole or not at all, in world space. A face has the colour of the first kind of which it is a
/// part ([`Kind::color`](super::Kind::color)), or light grey.
///
/// # Errors
///
/// [`Error::Argument`] for another extension than `.ply`, [`Error::Limit`] for more vertices than the format counts, and those of
/// [`write_whole`].
pub fn save_marked(
    scene: &Scene,
    report: &Report,
    path: impl AsRef<Path>,
    watch: &dyn Watch,
) -> Result<()> {
    let path = path.as_ref();
    let extension = path.extension().unwrap_or_default();
    if !extension.eq_ignore_ascii_case("ply") {
        return Err(Error::argument("output", "a file in .ply", path.display()));
    }
    let used = scene.objects().iter().map(used);
    let used = used.collect::<Result<Vec<_>>>()?;
    let vertices: usize = used.iter().map(Vec::len).sum();
    if u32::try_from(vertices).is_err() {
        let (got, limit) = (vertices.to_string(), u32::MAX.to_string());
        let what = "vertices in a PLY file";
        return Err(Error::Limit { what, got, limit });
    }
    write_whole(path, watch, |out| {
        let header = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n\
            property double x\nproperty double y\nproperty double z\nelement face {}\n\
            property list uchar uint vertex_indices\nproperty uchar red\nproperty uchar green\n\
            property uchar blue\nend_header\n",
            scene.triangles()
        );
        out.write_all(header.as_bytes())?;
        for (object, used) in scene.objects().iter().zip(&used) {
            write_vertices(object, used, out)?;
        }
        let mut first = 0;
        for (identifier, (object, used)) in scene.objects().iter().zip(&used).enumerate() {
            write_faces(object, (identifier, report), (first, used), out)?;
            first += used.len();
        }
        Ok(())
    })
}

/// The vertices that an object's faces use.
fn used(object: &Object) -> Result<Vec<u32>> {
    object
        .mesh()
        .map_or_else(|| Ok(Vec::new()), |mesh| mesh.used_vertices())
}

fn write_vertices(object: &Object, used: &[u32], out: &mut dyn Write) -> io::Result<()> {
    let Some(mesh) = object.mesh() else {
        return Ok(());
    };
    let transform = object.transform();
    for &vertex in used {
        let point = mesh.positions().get(vertex);
        let point: DVec3 = if transform.is_identity() {
            point
        } else {
            transform.world_from_object().transform_point3(point)
        };
        for x in point.to_array() {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    Ok(())
}

/// The faces of an object whose vertices come after the `first` ones.
fn write_faces(
    object: &Object,
    (identifier, report): (usize, &Report),
    (first, used): (usize, &[u32]),
    out: &mut dyn Write,
) -> io::Result<()> {
    let (Some(mesh), Some(marks)) = (object.mesh(), report.marked(identifier)) else {
        return Ok(());
    };
    for (triangle, kind) in mesh.triangles().iter().zip(marks) {
        out.write_all(&[3])?;
        for vertex in triangle {
            let index = first + used.binary_search(vertex).unwrap_or(0);
            let index = u32::try_from(index).unwrap_or(u32::MAX);
            out.write_all(&index.to_le_bytes())?;
        }
        out.write_all(&kind.map_or(FINE, |kind| kind.color))?;
    }
    Ok(())
}
