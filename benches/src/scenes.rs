//! The scenes: those of `benches/scenes.py`, or small ones made here.

mod built_in;
mod look;

use std::fs;
use std::path::{Path, PathBuf};

use firsthit::Object;

use crate::embree::Model;
use crate::firsthit_side;
pub(crate) use look::Look;

/// Objects, for both sides, and from where to look at them.
#[derive(Debug)]
pub(crate) struct BenchScene {
    pub(crate) name: String,
    pub(crate) objects: Vec<Object>,
    /// The objects as Embree has them.
    pub(crate) model: Model,
    pub(crate) look: Look,
}

/// The extensions of scene files, which stand beside NAME.cam.
const EXTENSIONS: [&str; 3] = ["ply", "glb", "toml"];

/// The file of the scene whose camera `look` describes.
fn file_beside(look: &Path) -> Option<PathBuf> {
    let files = EXTENSIONS.map(|extension| look.with_extension(extension));
    files.into_iter().find(|file| file.is_file())
}

/// The names of the scenes in `folder`, small ones first; of the built-in ones where there are
/// none.
pub(crate) fn all(folder: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.map_err(|error| error.to_string())?.path();
        let is_look = path.extension().is_some_and(|extension| extension == "cam");
        if let Some(file) = file_beside(&path).filter(|_| is_look) {
            let size = fs::metadata(&file).map_err(|error| error.to_string())?.len();
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
    let (objects, look) = if let Some(scene) = file_beside(&file).filter(|_| file.is_file()) {
        let text = fs::read_to_string(&file).map_err(|error| error.to_string())?;
        let look = look::parse(&text).ok_or_else(|| {
            format!("{}: expected four lines of 3 numbers and one more of 3", file.display())
        })?;
        (firsthit_side::load(&scene)?, look)
    } else {
        built_in::make(name).ok_or_else(|| {
            let known = built_in::NAMES.join(", ");
            format!("no scene {name}: neither {} nor one of {known}", file.display())
        })?
    };
    Ok(BenchScene { name: name.into(), model: Model::new(&objects)?, objects, look })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_of_many_objects_is_found_beside_its_camera() {
        let folder = std::env::temp_dir().join(format!("firsthit-bench-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let sphere = "[[objects]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n";
        let moved = format!("{sphere}translate = [3, 0, 0]\n");
        fs::write(folder.join("balls.toml"), format!("{sphere}{moved}")).unwrap();
        let look = "1 2 3\n4 5 6\n0 0 1\n7 8 9\n40 2.5 0.1\n";
        fs::write(folder.join("balls.cam"), look).unwrap();
        fs::write(folder.join("nothing.cam"), look).unwrap();
        let names = all(&folder);
        let scene = find("balls", &folder);
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!(names.unwrap(), ["balls"]);
        assert_eq!(scene.unwrap().objects.len(), 2);
    }
}
