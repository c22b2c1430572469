//! The door's answers where it is compiled for this machine: `tests/module.mjs` compares the
//! module's answers with these.
//!
//! Reads one JSON array of calls, and writes a line of JSON for each: whether it was refused, the
//! answer, and the file with its pixels. A call is `{"example": true}`, `{"name": .., "file": ..}`
//! or `{"question": .., "about": ..}`.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use firsthit_wasm::Door;
use serde::Deserialize;
use serde_json::{Value, json};

#[derive(Deserialize)]
#[serde(untagged)]
enum Call {
    File { name: String, file: PathBuf },
    Question { question: String, about: Value },
    Example {},
}

/// Puts a name and what follows it into the room.
fn put(door: &mut Door, name: &str, rest: &[u8]) -> Result<usize, Box<dyn Error>> {
    let both = [name.as_bytes(), rest].concat();
    let room = door.room(both.len()).ok_or("no memory")?;
    room.copy_from_slice(&both);
    Ok(name.len())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [calls, folder] = &arguments[..] else {
        return Err("usage: answers CALLS.json FOLDER".into());
    };
    let calls: Vec<Call> = serde_json::from_slice(&fs::read(calls)?)?;
    let mut door = Door::new();
    for (number, call) in calls.iter().enumerate() {
        let done = match call {
            Call::Example {} => door.example(),
            Call::File { name, file } => {
                let name_bytes = put(&mut door, name, &fs::read(file)?)?;
                door.load(name_bytes)
            }
            Call::Question { question, about } => {
                let name_bytes = put(&mut door, question, about.to_string().as_bytes())?;
                door.ask(name_bytes)
            }
        };
        let pixels = folder.join(format!("{number}.bin"));
        fs::write(&pixels, door.pixels())?;
        println!(
            "{}",
            json!({"refused": done.is_err(), "answer": door.answer(), "pixels": pixels})
        );
    }
    Ok(())
}
