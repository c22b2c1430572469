//! The scenes: those of `benches/scenes.py`, or small ones made here.

mod built_in;
mod look;

use std::fs;
use std::path::Path;

use firsthit::{Object, Positions, Shape};

use crate::embree::Triangles;
use crate::firsthit_side;
pub(crate) use look::Look;

/// Objects, for both sides, and from where to look at them.
#[derive(Debug)]
pub(crate) struct BenchScene {
    pub(crate) name: String,
    pub(crate) objects: Vec<Object>,
    /// The same triangles for Embree.
    pub(crate) triangles: Vec<Triangles>,
    pub(crate) look: Look,
}

/// The names of the scenes in `folder`, small ones first; of the built-in ones where there are none.
pub(crate) fn all(folder: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.map_err(|error| error.to_string())?.path();
        let mesh = path.with_extension("ply");
        if path.extension().is_some_and(|extension| extension == "cam") && mesh.is_file() {
            let size = fs::metadata(&mesh)
                .map_err(|error| error.to_string())?
                .len();
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            found.push((size, name.into_owned()));
        }
    }
    found.sort();
    Ok(if found.is_empty() {
        built_in::NAMES.iter().map(ToString::to_string).collect()
    } else {
        found.into_iter().map(|(_, name)| name).collect()
    })
}

/// The scene `name`, from the folder or built in.
pub(crate) fn find(name: &str, folder: &Path) -> Result<BenchScene, String> {
    let file = folder.join(name).with_extension("cam");
    let (objects, look) = if file.is_file() {
        let text = fs::read_to_string(&file).map_err(|error| error.to_string())?;
        let look = look::parse(&text).ok_or_else(|| {
            format!(
                "{}: expected four lines of 3 numbers and one more of 3",
                file.display()
            )
        })?;
        (firsthit_side::load(&file.with_extension("ply"))?, look)
    } else {
        built_in::make(name).ok_or_else(|| {
            let known = built_in::NAMES.join(", ");
            format!(
                "no scene {name}: neither {} nor one of {known}",
                file.display()
            )
        })?
    };
    let triangles = objects.iter().map(triangles).collect::<Result<_, _>>()?;
    Ok(BenchScene {
        name: name.into(),
        objects,
        triangles,
        look,
    })
}

/// An object as Embree takes it: a mesh where it is.
fn triangles(object: &Object) -> Result<Triangles, String> {
    let Shape::Mesh(mesh) = object.shape() else {
        return Err(format!(
            "object {} must be a mesh for Embree",
            object.name()
        ));
    };
    let vertices = match mesh.positions().as_ref() {
        Positions::Single(points) => points.to_vec(),
        Positions::Double(points) => points.iter().map(|point| point.map(|x| x as f32)).collect(),
    };
    Ok(Triangles::new(vertices, mesh.triangles().to_vec()))
}
