//! The meshes of a scene as a PLY file whose faces are coloured by what is wrong with them.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use super::Report;
use super::report::Marks;
use crate::error::{Error, Result};
use crate::geometry::DVec3;
use crate::image::write_whole;
use crate::scene::{Object, Scene};
use crate::shape::Mesh;
use crate::watch::Watch;

/// The colour of a face that nothing is wrong with, sRGB.
const FINE: [u8; 3] = [200, 200, 200];

/// Writes all meshes to a PLY file, whole or not at all, in world space. A face has the colour of
/// the first kind of which it is a part ([`FindingKind::color`](super::FindingKind::color)), or
/// light grey.
///
/// # Errors
///
/// [`Error::Argument`] for another extension than `.ply` and for the report of another scene,
/// [`Error::Limit`] for more vertices than the format counts and when memory is short, and those of
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
    if !is_of(report, scene) {
        let got = format!(
            "one about {} objects for a scene of {}, or with other meshes",
            report.of_objects.len(),
            scene.objects().len()
        );
        return Err(Error::argument("report", "that of the scene", got));
    }
    let used = used(report, scene)?;
    let numbers = report.of_objects.iter().flatten();
    let vertices: u64 = numbers.map(|&k| used[k as usize].len() as u64).sum();
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
        let of_object = |&index: &Option<u32>| index.map_or(&[][..], |k| &used[k as usize]);
        let used = || report.of_objects.iter().map(of_object);
        for (object, used) in scene.objects().iter().zip(used()) {
            write_vertices(object, used, out)?;
        }
        let mut first = 0;
        for (identifier, (object, used)) in scene.objects().iter().zip(used()).enumerate() {
            write_faces(object, (identifier, report), (first, used), out)?;
            first += used.len();
        }
        Ok(())
    })
}

/// The first object that has the mesh of marks.
fn first_mesh<'a>(marks: &Marks, scene: &'a Scene) -> Option<&'a Arc<Mesh>> {
    let first = usize::try_from(*marks.objects.first()?).ok()?;
    scene.objects().get(first)?.mesh()
}

/// Whether the marks of a report are those of a scene's meshes.
fn is_of(report: &Report, scene: &Scene) -> bool {
    let is_of_mesh = |(object, &index): (&Object, &Option<u32>)| {
        let marks = index.and_then(|k| report.marks.get(k as usize));
        match (object.mesh(), marks) {
            (None, None) => true,
            (Some(mesh), Some(marks)) => {
                let first = first_mesh(marks, scene);
                marks.of_triangles.len() == mesh.triangles().len()
                    && first.is_some_and(|first| Arc::ptr_eq(first, mesh))
            }
            _ => false,
        }
    };
    let mut objects = scene.objects().iter().zip(&report.of_objects);
    scene.objects().len() == report.of_objects.len() && objects.all(is_of_mesh)
}

/// The vertices that the faces of each distinct mesh use.
fn used(report: &Report, scene: &Scene) -> Result<Vec<Vec<u32>>> {
    let of_mesh = |marks: &Marks| {
        let mesh = first_mesh(marks, scene);
        let mut used = mesh.map_or_else(|| Ok(Vec::new()), |mesh| mesh.used_vertices())?;
        // Of six corners about one is left.
        used.shrink_to_fit();
        Ok(used)
    };
    report.marks.iter().map(of_mesh).collect()
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
