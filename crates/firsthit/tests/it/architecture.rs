//! The walls of the house: which room may import which (see ARCHITECTURE.md), where `unsafe` may
//! be, and how one-line docs begin.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Each room of the table in ARCHITECTURE.md, and the rooms it may import.
fn rooms() -> HashMap<String, Vec<String>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let table = text.split("| room | job | imports |").nth(1).unwrap();
    let rows = table.lines().skip(2);
    let rows = rows.take_while(|line| line.starts_with('|'));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let imports = cells[2].split(',').map(|name| name.trim().to_owned());
        (cells[0].trim_matches('`').to_owned(), imports.collect())
    })
    .collect()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// The rooms that a line of code names after `crate::`, also within braces.
fn imported(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or_default();
    let mut rooms = Vec::new();
    for rest in code.split("crate::").skip(1) {
        let list = rest
            .strip_prefix('{')
            .map_or(rest, |list| list.split('}').next().unwrap_or(list));
        let names: Vec<&str> = if rest.starts_with('{') {
            list.split(',').collect()
        } else {
            vec![list]
        };
        for name in names {
            let room: String = name
                .trim()
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            rooms.push(room);
        }
    }
    rooms
}

#[test]
fn rooms_import_only_what_they_may() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let rooms = rooms();
    let mut imports = 0;
    for path in sources(&src) {
        let inside = path.strip_prefix(&src).unwrap().with_extension("");
        let room = inside.iter().next().unwrap().to_str().unwrap().to_owned();
        if room == "lib" {
            continue;
        }
        let allowed = rooms
            .get(&room)
            .unwrap_or_else(|| panic!("{room} is no room of ARCHITECTURE.md"));
        for line in fs::read_to_string(&path).unwrap().lines() {
            for other in imported(line) {
                // The crate's own names, such as `crate::Error`, are re-exports of `lib.rs`, for documentation only.
                let fine = other == room
                    || ["error", "inputs", "memory", "parallel", "watch"].contains(&&*other)
                    || allowed.contains(&other);
                assert!(
                    fine,
                    "{}: {room} may not import {other}: {line}",
                    path.display()
                );
                imports += 1;
            }
        }
    }
    assert!(
        imports > 50,
        "{imports}: is this test reading the right files?"
    );
}

#[test]
fn unsafe_code_is_nowhere_but_in_simd() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for path in sources(&src) {
        let is_simd = path.starts_with(src.join("simd"));
        let text = fs::read_to_string(&path).unwrap();
        assert!(is_simd || !text.contains("unsafe"), "{}", path.display());
    }
}

/// A list of documentation shows first lines alone: each names its item.
#[test]
fn one_line_docs_begin_with_their_subject() {
    const RIDDLES: [&str; 4] = ["What ", "The same", "That of ", "Those of "];
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let is_source =
        |path: &PathBuf| path.strip_prefix(&crates).unwrap().iter().nth(1) == Some("src".as_ref());
    let mut docs = 0;
    for path in sources(&crates).into_iter().filter(is_source) {
        let mut before_is_doc = false;
        for line in fs::read_to_string(&path).unwrap().lines() {
            let line = line.trim_start();
            let doc = line
                .strip_prefix("///")
                .or_else(|| line.strip_prefix("//!"));
            if let Some(first) = doc.filter(|_| !before_is_doc) {
                let riddle = RIDDLES
                    .iter()
                    .find(|word| first.trim_start().starts_with(**word));
                assert!(riddle.is_none(), "{}: {line}", path.display());
                docs += 1;
            }
            before_is_doc = doc.is_some();
        }
    }
    assert!(docs > 5000, "{docs}: is this test reading the right files?");
}

/// The unit test of `shoot/batch.rs` looks for this name where it must not be.
#[test]
fn packets_have_the_name_that_a_unit_test_looks_for() {
    let program = fs::read(std::env::current_exe().unwrap()).unwrap();
    let name = "5shoot5batch-10fill_batch".replace('-', "");
    assert!(
        program
            .windows(name.len())
            .any(|bytes| bytes == name.as_bytes())
    );
}
