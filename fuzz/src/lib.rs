//! What every target asks of a loader, beyond not crashing.

use std::fs;
use std::path::Path;

use firsthit::image::read_bytes;
use firsthit::load::{LoadSettings, Loaded, load, load_bytes};
use firsthit::{DVec3, Result, Scene};

/// Small, so that a file that gets around the limits is noticed by the fuzzer's own.
const SETTINGS: LoadSettings = LoadSettings {
    strict: false,
    max_memory: 64 << 20,
    max_texture: 1024,
};

/// Reads content under a name that tells its format.
pub fn read(name: &str, bytes: &[u8]) {
    check(load_bytes(Path::new(name), bytes, &SETTINGS));
}

/// Reads an output back, and says what is in it.
pub fn read_output(name: &str, bytes: &[u8]) {
    match read_bytes(Path::new(name), bytes, SETTINGS.max_memory) {
        Err(error) => check_line(&error.to_string()),
        Ok(output) => {
            output.notes.iter().for_each(|line| check_line(line));
            for array in &output.arrays {
                let count: usize = array.shape.iter().product();
                assert_eq!(array.numbers.len(), count);
            }
        }
    }
}

/// Files in a folder, where the one that is read finds the others.
#[derive(Debug)]
pub struct Folder(tempfile::TempDir);

impl Default for Folder {
    fn default() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }
}

impl Folder {
    /// Puts a file there, in place of the one of that name.
    pub fn put(&self, name: &str, bytes: &[u8]) {
        fs::write(self.0.path().join(name), bytes).expect("room for a file");
    }

    /// Reads one of the files.
    pub fn read(&self, name: &str) {
        check(load(&self.0.path().join(name), &SETTINGS));
    }
}

/// A refusal is one line; what is not refused can be shot at.
fn check(read: Result<Loaded>) {
    match read {
        Err(error) => check_line(&error.to_string()),
        Ok(model) => {
            model.warnings.iter().for_each(|line| check_line(line));
            if let Ok(scene) = Scene::new(model.world.objects) {
                let target = scene.bounds();
                let origin = DVec3::new(3.0, 2.0, 1.0);
                let direction = if target.is_empty() { -origin } else { target.centre() - origin };
                assert!(firsthit::shoot(&scene, origin, direction).t > 0.0);
            }
        }
    }
}

fn check_line(line: &str) {
    assert!(!line.chars().any(char::is_control), "{line:?}");
    assert!(line.len() < 2000, "{line:?}");
}
