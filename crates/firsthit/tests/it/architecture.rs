//! The walls of the house (see ARCHITECTURE.md): what each crate depends on, and which rooms of a
//! crate import which. The compiler holds the walls between crates.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The rows of the table in ARCHITECTURE.md that has this head, without the marks of code.
fn table(head: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let table = text.split(head).nth(1).unwrap();
    let rows = table.lines().skip(2);
    let rows = rows.take_while(|line| line.starts_with('|'));
    rows.map(|row| {
        let cells = row.trim_matches('|').split('|');
        let cells = cells.map(|cell| cell.trim().trim_matches('`').to_owned());
        cells.collect()
    })
    .collect()
}

/// The names of a list in a cell; `-` stands for none.
fn names(list: &str) -> Vec<String> {
    let names = list.split(',').map(|name| name.trim().to_owned());
    let mut names: Vec<String> = names.filter(|name| name != "-").collect();
    names.sort();
    names
}

/// The crates, each with those that it depends on.
fn crates() -> Vec<(String, Vec<String>)> {
    let rows = table("| crate | depends on | may never know |").into_iter();
    rows.map(|row| (row[0].clone(), names(&row[1]))).collect()
}

/// The rooms, each with its crate and those of the same crate that it may import.
fn rooms() -> HashMap<String, (String, Vec<String>)> {
    let rows = table("| room | crate | job | imports of the same crate |").into_iter();
    rows.map(|row| (row[0].clone(), (row[1].clone(), names(&row[3])))).collect()
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
        let list =
            rest.strip_prefix('{').map_or(rest, |list| list.split('}').next().unwrap_or(list));
        let names: Vec<&str> =
            if rest.starts_with('{') { list.split(',').collect() } else { vec![list] };
        for name in names {
            let room: String =
                name.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            rooms.push(room);
        }
    }
    rooms
}

#[test]
fn crates_depend_on_what_the_table_says() {
    let crates = crates();
    assert!(crates.len() > 10, "{crates:?}");
    for (name, expected) in crates {
        let manifest = root().join("crates").join(&name).join("Cargo.toml");
        let text = fs::read_to_string(manifest).unwrap();
        let dependencies = text.split("[dependencies]").nth(1).unwrap();
        let dependencies = dependencies.split("\n[").next().unwrap();
        let ours = dependencies.lines().filter_map(|line| {
            let name = line.split([' ', '.']).next()?;
            Some(name.strip_prefix("firsthit-")?.to_owned())
        });
        let mut found: Vec<String> = ours.collect();
        found.sort();
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn rooms_import_only_what_they_may() {
    let rooms = rooms();
    let mut imports = 0;
    for (name, _) in crates() {
        let src = root().join("crates").join(&name).join("src");
        for path in sources(&src) {
            let inside = path.strip_prefix(&src).unwrap().with_extension("");
            let room = inside.iter().next().unwrap().to_str().unwrap().to_owned();
            if room == "lib" {
                continue;
            }
            let (of, allowed) =
                rooms.get(&room).unwrap_or_else(|| panic!("{room} is no room of ARCHITECTURE.md"));
            assert_eq!(name, format!("firsthit-{of}"), "{room}");
            for line in fs::read_to_string(&path).unwrap().lines() {
                for other in imported(line) {
                    let is_near = rooms.get(&other).is_some_and(|(crate_, _)| crate_ == of);
                    imports += 1;
                    assert!(
                        !is_near || other == room || allowed.contains(&other),
                        "{}: {room} may not import {other}: {line}",
                        path.display()
                    );
                }
            }
        }
    }
    assert!(imports > 1000, "{imports}: is this test reading the right files?");
}

#[test]
fn unsafe_code_is_forbidden_in_every_crate_but_one() {
    let names = crates().into_iter().map(|(name, _)| name);
    for name in names.chain(["firsthit".to_owned()]) {
        let lib = root().join("crates").join(&name).join("src/lib.rs");
        let text = fs::read_to_string(lib).unwrap();
        let is_forbidden = text.contains("#![forbid(unsafe_code)]");
        assert_eq!(is_forbidden, name != "firsthit-simd", "{name}");
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
            let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
            if let Some(first) = doc.filter(|_| !before_is_doc) {
                let riddle = RIDDLES.iter().find(|word| first.trim_start().starts_with(**word));
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
    assert!(program.windows(name.len()).any(|bytes| bytes == name.as_bytes()));
}
