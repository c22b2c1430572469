//! What every target asks of a loader, beyond not crashing.

use std::fs;
use std::path::Path;

use firsthit::image::{points_of, read_bytes};
use firsthit::load::{LoadSettings, Loaded, load, load_bytes};
use firsthit::{DVec3, Result};

/// Small, so that a file that gets around the limits is noticed by the fuzzer's own.
const SETTINGS: LoadSettings = LoadSettings {
    strict: false,
    variant: None,
    max_memory: 64 << 20,
    max_texture: 1024,
    verify: false,
    resources: Vec::new(),
    scale: 1.0,
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

/// Reads points, each with a row in every column.
pub fn read_points(bytes: &[u8]) {
    match points_of(Path::new("cloud"), bytes) {
        Err(error) => check_line(&error.to_string()),
        Ok(points) => {
            for array in &points.columns {
                assert_eq!(array.shape.first(), Some(&points.positions.len()));
                assert_eq!(array.numbers.len(), points.positions.len() * array.components);
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
            // Of a built scene as it is in the file, which may be wrong.
            if let Ok(scene) = model.into_scene() {
                let target = scene.bounds();
                let origin = DVec3::new(3.0, 2.0, 1.0);
                let direction = if target.is_empty() { -origin } else { target.centre() - origin };
                assert!(firsthit::shoot(&scene, origin, direction).t > 0.0);
            }
        }
    }
}

/// Makes the length in the header of a built scene, and the checksum of its header, table and
/// record, what they must be.
pub fn mend_built_scene(bytes: &mut [u8]) {
    let number = |bytes: &[u8], at: usize| {
        let number = bytes.get(at..at + 8).and_then(|number| number.try_into().ok());
        usize::try_from(number.map_or(0, u64::from_le_bytes)).unwrap_or(usize::MAX)
    };
    let length = bytes.len() as u64;
    let (count, start, size) = (number(bytes, 24), number(bytes, 72), number(bytes, 80));
    let table = count.checked_add(1).and_then(|count| bytes.get(64..count.checked_mul(64)?));
    let record = start.checked_add(size).and_then(|end| bytes.get(start..end));
    let (Some(table), Some(record), Some(header)) = (table, record, bytes.get(..32)) else {
        return;
    };
    let mut header = header.to_vec();
    header[16..24].copy_from_slice(&length.to_le_bytes());
    let mut hasher = blake3::Hasher::new();
    for part in [&header[..], table, record] {
        hasher.update(part);
    }
    let sum = *hasher.finalize().as_bytes();
    bytes[..32].copy_from_slice(&header);
    bytes[32..64].copy_from_slice(&sum);
}

fn check_line(line: &str) {
    assert!(!line.chars().any(char::is_control), "{line:?}");
    assert!(line.len() < 2000, "{line:?}");
}
