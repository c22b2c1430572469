//! Files that a fuzzer has found: each is read or refused, in lines that harm no terminal.

use std::fs;
use std::path::Path;

use firsthit::load::{LoadSettings, load};

#[test]
fn what_was_found_once_is_not_found_again() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/regressions");
    let settings =
        LoadSettings { max_memory: 64 << 20, max_texture: 1024, ..LoadSettings::default() };
    let mut count = 0;
    for entry in fs::read_dir(folder).expect("the regression files") {
        let path = entry.expect("a regression file").path();
        let lines = match load(&path, &settings) {
            Ok(model) => model.warnings,
            Err(error) => vec![error.to_string()],
        };
        for line in lines {
            assert!(!line.chars().any(char::is_control), "{}: {line:?}", path.display());
            assert!(line.len() < 2000, "{}: {line:?}", path.display());
        }
        count += 1;
    }
    assert!(count > 0);
}
