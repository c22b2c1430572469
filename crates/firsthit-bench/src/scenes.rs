//! What is shot at: the scenes of `benches/scenes.py`, or small ones made here.

mod built_in;

use std::fs;
use std::path::Path;
use std::str::SplitWhitespace;

use firsthit::camera::View;
use firsthit::{Camera, DVec3, Object, Positions, Projection, RayStart, Shape};

use crate::embree::Triangles;
use crate::firsthit_side;
use crate::settings::Settings;

/// Objects, for both sides, and from where to look at them.
#[derive(Debug)]
pub(crate) struct BenchScene {
    pub(crate) name: String,
    pub(crate) objects: Vec<Object>,
    /// The same triangles for Embree.
    pub(crate) triangles: Vec<Triangles>,
    pub(crate) look: Look,
}

/// Where the cameras and the light are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    pub(crate) eye: DVec3,
    pub(crate) target: DVec3,
    pub(crate) up: DVec3,
    pub(crate) light: DVec3,
    pub(crate) vertical_fov_degrees: f64,
    /// What the orthographic camera sees from top to bottom, in scene units.
    pub(crate) height: f64,
    /// How far ambient occlusion reaches, in scene units.
    pub(crate) reach: f64,
}

impl Look {
    /// A camera of square pixels, its rays starting at the eye.
    pub(crate) fn camera(&self, projection: Projection, side: usize) -> Result<Camera, String> {
        let view = View {
            position: self.eye,
            aim: self.target - self.eye,
            up: self.up,
            rows: side,
            columns: side,
            width: self.height,
            height: self.height,
            projection,
            ray_start: RayStart::Eye,
            ..View::default()
        };
        let view = match projection {
            Projection::Perspective => view.with_vertical_fov(self.vertical_fov_degrees),
            Projection::Orthographic => Ok(view),
        };
        view.and_then(Camera::new)
            .map_err(|error| error.to_string())
    }
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
pub(crate) fn find(name: &str, settings: &Settings) -> Result<BenchScene, String> {
    let file = settings.folder.join(name).with_extension("cam");
    let (objects, look) = if file.is_file() {
        let text = fs::read_to_string(&file).map_err(|error| error.to_string())?;
        let look = parse(&text).ok_or_else(|| {
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

/// Reads what `benches/scenes.py` writes beside a mesh.
fn parse(text: &str) -> Option<Look> {
    fn vector(words: &mut SplitWhitespace) -> Option<DVec3> {
        let mut number = || words.next()?.parse().ok();
        Some(DVec3::new(number()?, number()?, number()?))
    }
    let mut words = text.split_whitespace();
    let [eye, target, up, light, rest] = [(); 5].map(|()| vector(&mut words));
    let rest = rest?;
    Some(Look {
        eye: eye?,
        target: target?,
        up: up?,
        light: light?,
        vertical_fov_degrees: rest.x,
        height: rest.y,
        reach: rest.z,
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
        Positions::Single(points) => points.clone(),
        Positions::Double(points) => points.iter().map(|point| point.map(|x| x as f32)).collect(),
    };
    Ok(Triangles::new(vertices, mesh.triangles().to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_file_is_read_and_a_short_one_refused() {
        let text = "1 2 3\n4 5 6\n0 0 1\n7 8 9\n40 2.5 0.1\n";
        let look = parse(text).unwrap();
        assert_eq!(look.light, DVec3::new(7.0, 8.0, 9.0));
        assert_eq!(
            (look.vertical_fov_degrees, look.height, look.reach),
            (40.0, 2.5, 0.1)
        );
        assert_eq!(parse(text.trim_end_matches("0.1\n")), None);
        assert_eq!(parse(&text.replace("2.5", "high")), None);
    }
}
