//! The door's functions, in safe code.

#![deny(unsafe_code)]

use std::mem;
use std::path::Path;

use firsthit::error::escaped;
use firsthit::load::{LoadSettings, load_bytes};
use firsthit::shoot::{First, trace};
use firsthit_view::{Answer, FlatCamera, Viewer};
use serde::Deserialize;
use serde_json::{Value, json};

/// The memory that may be spent on a file: of the 4 GiB that a module addresses, half is left for
/// trees and pictures.
const MAX_MEMORY: u64 = 2 << 30;

/// A call was refused. Why is the door's answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refused;

/// One viewer, what it is handed, and what it answers.
///
/// It answers what [`Viewer::answer`] does, and one question more: `hits`, about a `camera`, is
/// answered by rows and columns, and its pixels are all t as float64, then all objects and all
/// primitives as int32, little endian.
#[derive(Debug, Default)]
pub struct Door {
    room: Vec<u8>,
    viewer: Option<Viewer>,
    answer: String,
    pixels: Vec<u8>,
}

/// The question of `hits`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HitsQuestion {
    camera: FlatCamera,
}

/// An answer and its pixels, or why there is none.
type Answered = Result<(Value, Vec<u8>), String>;

impl Door {
    /// A door without a scene.
    pub const fn new() -> Self {
        Self { room: Vec::new(), viewer: None, answer: String::new(), pixels: Vec::new() }
    }

    /// Room for that many bytes, which are zero; `None` where there is no memory for them.
    pub fn room(&mut self, bytes: usize) -> Option<&mut [u8]> {
        self.room = Vec::new();
        self.room.try_reserve_exact(bytes).ok()?;
        self.room.resize(bytes, 0);
        Some(&mut self.room)
    }

    /// Reads the file in the room: `name_bytes` bytes of name, then its content. Where that goes
    /// well the viewer is about this file, and the answer is [`Viewer::info`]; else there is no
    /// viewer.
    ///
    /// # Errors
    ///
    /// [`Refused`] where the file is bad or too large.
    pub fn load(&mut self, name_bytes: usize) -> Result<(), Refused> {
        // The memory of the scene before is there for the next.
        self.viewer = None;
        let room = mem::take(&mut self.room);
        let opened = split(&room, name_bytes).and_then(|(name, content)| open(name, content));
        self.show(opened)
    }

    /// Takes the embedded example in place of a file.
    ///
    /// # Errors
    ///
    /// None that is known.
    pub fn example(&mut self) -> Result<(), Refused> {
        self.show(Viewer::of_example().map_err(|error| error.to_string()))
    }

    /// Answers the question in the room: `name_bytes` bytes of name, then its JSON.
    ///
    /// # Errors
    ///
    /// [`Refused`] before a file was read, and for a question that makes no sense.
    pub fn ask(&mut self, name_bytes: usize) -> Result<(), Refused> {
        let room = mem::take(&mut self.room);
        let answered = split(&room, name_bytes).and_then(|(name, json)| {
            let viewer = self.viewer.as_ref().ok_or("no file was loaded")?;
            answered(viewer, name, json)
        });
        self.put(answered)
    }

    /// The last answer: JSON, or where a call was refused a line of text.
    pub fn answer(&self) -> &str {
        &self.answer
    }

    /// The pixels of the last answer; empty where it has none.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    fn show(&mut self, opened: Result<Viewer, String>) -> Result<(), Refused> {
        let answered = opened.map(|viewer| {
            let viewer = self.viewer.insert(viewer);
            (viewer.info(), Vec::new())
        });
        self.put(answered)
    }

    fn put(&mut self, answered: Answered) -> Result<(), Refused> {
        let (answer, pixels, result) = match answered {
            Ok((answer, pixels)) => (answer.to_string(), pixels, Ok(())),
            Err(why) => (why, Vec::new(), Err(Refused)),
        };
        (self.answer, self.pixels) = (answer, pixels);
        result
    }
}

/// A name and what follows it.
fn split(room: &[u8], name_bytes: usize) -> Result<(&str, &[u8]), String> {
    let parts = room.split_at_checked(name_bytes);
    let (name, rest) = parts.ok_or("the name is longer than the room")?;
    let name = str::from_utf8(name).map_err(|_| "the name is no UTF-8")?;
    Ok((name, rest))
}

fn open(name: &str, content: &[u8]) -> Result<Viewer, String> {
    let settings = LoadSettings { max_memory: MAX_MEMORY, ..LoadSettings::default() };
    let name = Path::new(name);
    let loaded = load_bytes(name, content, &settings);
    let opened = loaded.and_then(|loaded| Viewer::of_file(escaped(name), loaded));
    opened.map_err(|error| error.to_string())
}

fn answered(viewer: &Viewer, question: &str, json: &[u8]) -> Answered {
    if question == "hits" {
        let HitsQuestion { camera } =
            serde_json::from_slice(json).map_err(|error| error.to_string())?;
        return hits(viewer, &camera).map_err(|error| error.to_string());
    }
    let answer = viewer.answer(question, json, &());
    let Answer { json, pixels } = answer.map_err(|error| error.to_string())?;
    Ok((json, pixels))
}

/// The hits of a page's camera, for computations where the float32 of a frame do not suffice.
fn hits(viewer: &Viewer, camera: &FlatCamera) -> firsthit::Result<(Value, Vec<u8>)> {
    let hits = trace(viewer.scene(), &camera.camera()?, First, &())?;
    let mut bytes = Vec::with_capacity(16 * hits.len());
    bytes.extend(hits.t.iter().flat_map(|t| t.to_le_bytes()));
    bytes.extend(hits.object.iter().flat_map(|object| object.to_le_bytes()));
    bytes.extend(hits.primitive.iter().flat_map(|primitive| primitive.to_le_bytes()));
    let about = json!({"rows": camera.rows, "columns": camera.columns});
    Ok((about, bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Puts a name and what follows it into the room.
    fn put(door: &mut Door, name: &str, rest: &[u8]) -> usize {
        let both = [name.as_bytes(), rest].concat();
        door.room(both.len()).unwrap().copy_from_slice(&both);
        name.len()
    }

    fn load(door: &mut Door, name: &str, content: &[u8]) -> Result<(), Refused> {
        let name_bytes = put(door, name, content);
        door.load(name_bytes)
    }

    fn ask(door: &mut Door, name: &str, question: &Value) -> Result<(), Refused> {
        let name_bytes = put(door, name, question.to_string().as_bytes());
        door.ask(name_bytes)
    }

    const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    #[test]
    fn a_file_is_loaded_and_asked() {
        let mut door = Door::new();
        load(&mut door, "a.obj", TRIANGLE).unwrap();
        let info: Value = serde_json::from_str(door.answer()).unwrap();
        assert_eq!((&info["title"], &info["triangles"]), (&json!("a.obj"), &json!(1)));
        let camera = json!({
            "position": [0.2, 0.2, 2.0], "aim": [0, 0, -1], "up": [0, 1, 0],
            "projection": "perspective", "focal_length": 1.0, "width": 0.8, "height": 0.5, "rows": 3, "columns": 5,
        });
        ask(&mut door, "hits", &json!({"camera": camera})).unwrap();
        assert_eq!(door.pixels().len(), 15 * 16);
        assert_eq!(door.pixels()[7 * 8..8 * 8], 2.0_f64.to_le_bytes());
        ask(&mut door, "frame", &json!({"camera": camera})).unwrap();
        assert!(door.pixels().starts_with(b"\x89PNG"));
        ask(&mut door, "frame", &json!({"camera": camera, "channel": "object"})).unwrap();
        assert_eq!(
            door.answer(),
            r#"{"columns":5,"components":1,"dtype":"int32","full_samples":16,"rows":3,"samples":1}"#
        );
        ask(&mut door, "probe", &json!({"camera": camera, "pixel": [2, 1]})).unwrap();
        ask(&mut door, "camera", &json!({"camera": camera})).unwrap();
        assert_eq!(door.pixels(), b"");
    }

    #[test]
    fn what_is_refused_is_one_line() {
        let mut door = Door::new();
        assert_eq!(ask(&mut door, "info", &Value::Null), Err(Refused));
        assert_eq!(door.answer(), "no file was loaded");
        assert_eq!(load(&mut door, "a.obj", b"v 0 0\n"), Err(Refused));
        assert!(door.answer().starts_with("a.obj:1: "), "{}", door.answer());
        load(&mut door, "a.obj", TRIANGLE).unwrap();
        assert_eq!(ask(&mut door, "fr\name", &Value::Null), Err(Refused));
        assert_eq!(door.answer(), "there is no question 'fr\\u{a}ame'");
        assert_eq!(ask(&mut door, "frame", &json!({"camera": 1})), Err(Refused));
        assert_eq!(door.answer().lines().count(), 1);
        assert_eq!(door.ask(1), Err(Refused));
        assert_eq!(door.answer(), "the name is longer than the room");
        // A bad file leaves no scene behind that could be taken for its own.
        assert_eq!(load(&mut door, "b.xyz", b""), Err(Refused));
        assert_eq!(ask(&mut door, "info", &Value::Null), Err(Refused));
    }

    #[test]
    fn a_room_that_nobody_has_is_refused() {
        assert_eq!(Door::new().room(usize::MAX), None);
    }

    #[test]
    fn the_example_needs_no_file() {
        let mut door = Door::new();
        door.example().unwrap();
        assert!(door.answer().contains("knot"));
    }
}
