//! The JSON Schema of scene files and the reader say the same: what one refuses the other refuses.

use std::fs;
use std::path::{Path, PathBuf};

use firsthit::load::{LoadSettings, load};
use firsthit::scene_file::schema;
use serde_json::{Map, Value, json};
use toml::de::{DeTable, DeValue};

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

fn parsed() -> Value {
    serde_json::from_str(&schema()).expect("JSON")
}

fn validator() -> jsonschema::Validator {
    jsonschema::draft202012::new(&parsed()).expect("a schema")
}

/// TOML as JSON.
fn as_json(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => json!(text),
        DeValue::Integer(digits) => json!(digits.as_str().parse::<i64>().expect("a small number")),
        DeValue::Float(digits) => json!(digits.as_str().parse::<f64>().expect("a number")),
        DeValue::Boolean(value) => json!(value),
        DeValue::Datetime(_) => panic!("no dates in scenes"),
        DeValue::Array(items) => items.iter().map(|item| as_json(item.get_ref())).collect(),
        DeValue::Table(table) => Value::Object(table_as_json(table)),
    }
}

fn table_as_json(table: &DeTable<'_>) -> Map<String, Value> {
    let entries = table.iter();
    entries
        .map(|(name, value)| (name.get_ref().to_string(), as_json(value.get_ref())))
        .collect()
}

/// JSON as an inline value of TOML.
fn as_toml(value: &Value) -> String {
    match value {
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(as_toml).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Object(entries) => {
            let entries: Vec<String> = (entries.iter())
                .map(|(name, value)| format!("{name} = {}", as_toml(value)))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
        other => other.to_string(),
    }
}

/// Where the kinds of tables stand in a scene file.
fn in_scene(kind: &str, table: &Map<String, Value>) -> Value {
    match kind {
        "scene" => json!(table),
        "camera" => json!({"cameras": {"front": table}}),
        "object" | "light" | "output" => json!({(format!("{kind}s")): [table]}),
        "rotation" => {
            json!({"objects": [{"shape": "sphere", "center": [0, 0, 0], "radius": 1, "rotate": table}]})
        }
        "material" => {
            json!({"objects": [{"shape": "sphere", "center": [0, 0, 0], "radius": 1, "material": table}]})
        }
        "daylight" => json!({"environment": {"daylight": table}}),
        other => json!({(other): table}),
    }
}

/// A value that makes sense under a key.
fn sample(kind: &str, name: &str, form: &Value) -> Value {
    let known = match (kind, name) {
        ("object", "file") => json!("t.obj"),
        ("output", "file") => json!("a.png"),
        ("environment", "file") => json!("t.hdr"),
        (_, "position") => json!([5, 0.5, 0]),
        (_, "look_at" | "up") => json!([0, 0, 1]),
        (_, "aim") => json!([0, 2, 0]),
        (_, "low" | "bottom") => json!([-1, -1, -1]),
        (_, "high" | "top") => json!([1, 1, 1]),
        (_, "matrix") => json!([[0, 0, 1, 5], [1, 0, 0, 6], [0, 1, 0, 7]]),
        ("colors", "range") => json!([-2, 3]),
        (_, "scale") => json!([1, 2, -3]),
        (_, "vertices") => json!([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]]),
        (_, "triangles") => json!([[0, 1, 2]]),
        (_, "rotate") => json!({"quaternion": [0, 0, 1, 1]}),
        // A cube map has three faces across and two down.
        (_, "columns") => json!(6),
        (_, "rows") => json!(4),
        _ => Value::Null,
    };
    if known != Value::Null {
        return known;
    }
    if let Some(value) = form.get("const") {
        return value.clone();
    }
    if let Some(words) = form["enum"].as_array() {
        return words[0].clone();
    }
    if let Some(forms) = form["oneOf"].as_array() {
        return sample(kind, name, &forms[0]);
    }
    match form["$ref"].as_str() {
        Some(COLOR) => return json!("tomato"),
        Some(_) => return Value::Null,
        None => {}
    }
    match form["type"].as_str() {
        Some("number" | "integer" | "boolean") if form["type"] == "boolean" => json!(false),
        Some("number" | "integer") => json!(1),
        Some("string") => json!("text"),
        Some("array") => {
            let count = form["minItems"].as_u64().unwrap_or(1);
            (0..count)
                .map(|_| sample(kind, "", &form["items"]))
                .collect()
        }
        _ => json!({}),
    }
}

/// What colours refer to: no table, but a value of several forms.
const COLOR: &str = "#/$defs/color";

/// The forms of each kind of table.
fn variants() -> Vec<(String, Value)> {
    let whole = parsed();
    let mut found = vec![("scene".to_owned(), whole.clone())];
    let records = whole["$defs"].as_object().expect("definitions").iter();
    for (kind, record) in records.filter(|(kind, _)| !COLOR.ends_with(&format!("/{kind}"))) {
        match record["oneOf"].as_array() {
            Some(forms) => found.extend(forms.iter().map(|form| (kind.clone(), form.clone()))),
            None => found.push((kind.clone(), record.clone())),
        }
    }
    assert!(found.len() > 18, "{}", found.len());
    found
}

/// The keys of a form of table with a value for each; without those that are tables themselves.
fn properties(kind: &str, form: &Value) -> Vec<(String, Value)> {
    let properties = form["properties"].as_object().expect("properties");
    let samples = properties
        .iter()
        .map(|(name, form)| (name.clone(), sample(kind, name, form)));
    samples
        .filter(|(_, value)| *value != Value::Null && *value != json!([null]))
        .collect()
}

/// The least table of a form.
fn least(kind: &str, form: &Value) -> Map<String, Value> {
    let required = form["required"].as_array().cloned().unwrap_or_default();
    let mut table: Map<String, Value> = properties(kind, form)
        .into_iter()
        .filter(|(name, _)| required.contains(&json!(name)))
        .collect();
    let tags = form["properties"].as_object().expect("properties");
    let tag = tags.iter().find(|(_, form)| form["const"].is_string());
    table.extend(tag.map(|(name, form)| (name.clone(), form["const"].clone())));
    if required.contains(&json!("daylight")) {
        table.insert("daylight".to_owned(), json!({"elevation": 30}));
    }
    if kind == "rotation" {
        table.insert("quaternion".to_owned(), json!([0, 0, 0, 1]));
    }
    table
}

/// Asks both.
struct Judges {
    folder: tempfile::TempDir,
    validator: jsonschema::Validator,
    asked: usize,
    refused: usize,
}

impl Judges {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(
            folder.path().join("t.obj"),
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        )
        .expect("room for a file");
        let picture = b"#?RADIANCE\n\n-Y 1 +X 2\n\x01\x02\x03\x80\x01\x02\x03\x80";
        fs::write(folder.path().join("t.hdr"), picture).expect("room for a file");
        let validator = validator();
        Self {
            folder,
            validator,
            asked: 0,
            refused: 0,
        }
    }

    /// Whether both accept; fails where they do not agree.
    fn accept(&mut self, kind: &str, table: &Map<String, Value>) -> bool {
        let scene = in_scene(kind, table);
        let entries = scene.as_object().expect("a table").iter();
        let lines: Vec<String> = entries
            .map(|(name, value)| format!("{name} = {}\n", as_toml(value)))
            .collect();
        let text = lines.concat();
        let path = self.folder.path().join("scene.toml");
        fs::write(&path, &text).expect("room for a file");
        let read = load(&path, &LoadSettings::default());
        let is_valid = self.validator.is_valid(&scene);
        assert_eq!(read.is_ok(), is_valid, "{text}\n{:?}", read.err());
        self.asked += 1;
        self.refused += usize::from(!is_valid);
        is_valid
    }
}

#[test]
fn the_committed_schema_is_the_program_s() {
    let committed =
        fs::read_to_string(docs().join("scene.schema.json")).expect("docs/scene.schema.json");
    assert!(
        committed == schema(),
        "run: firsthit schema > docs/scene.schema.json"
    );
}

#[test]
fn the_schema_is_one() {
    assert!(jsonschema::meta::is_valid(&parsed()));
}

#[test]
fn colours_are_refused_or_taken_by_both() {
    let mut both = Judges::new();
    for (color, is_one) in [
        (json!("tomato"), true),
        (json!("Tomato"), false),
        (json!("#FF6347"), true),
        (json!("#ff634"), false),
        (json!("reddish"), false),
        (json!([1, 0, 2.5]), true),
        (json!([1, -1, 0]), false),
        (json!([1, 0]), false),
        (json!(1), false),
    ] {
        for (kind, key) in [("background", "color"), ("shading", "ambient")] {
            let table = Map::from_iter([(key.to_owned(), color.clone())]);
            assert_eq!(both.accept(kind, &table), is_one, "{kind}: {color}");
        }
    }
    for (kind, key, is_taken) in [("background", "color", true), ("shading", "ambient", false)] {
        let table = Map::from_iter([(key.to_owned(), json!("transparent"))]);
        assert_eq!(both.accept(kind, &table), is_taken, "{kind}");
    }
}

#[test]
fn every_example_is_valid() {
    let (validator, mut count) = (validator(), 0);
    for entry in fs::read_dir(docs().join("scenes")).expect("docs/scenes") {
        let path = entry.expect("docs/scenes").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("text");
        let scene = Value::Object(table_as_json(
            DeTable::parse(&text).expect("TOML").get_ref(),
        ));
        let mistake = validator
            .validate(&scene)
            .err()
            .map(|error| error.to_string());
        assert_eq!(mistake, None, "{}", path.display());
        count += 1;
    }
    assert!(count >= 8, "{count}");
}

#[test]
fn every_key_is_taken_alone_and_with_every_other_as_the_schema_says() {
    let mut judges = Judges::new();
    for (kind, form) in variants() {
        let (least, all) = (least(&kind, &form), properties(&kind, &form));
        assert!(judges.accept(&kind, &least), "{kind} {least:?}");
        for (k, (name, value)) in all.iter().enumerate() {
            for (other, with) in &all[k..] {
                let mut table = least.clone();
                table.insert(name.clone(), value.clone());
                table.insert(other.clone(), with.clone());
                judges.accept(&kind, &table);
            }
        }
    }
    assert!(
        judges.asked > 400 && judges.refused > 40,
        "{} {}",
        judges.asked,
        judges.refused
    );
}

#[test]
fn misspelt_missing_and_mistyped_keys_are_refused_by_both() {
    let mut judges = Judges::new();
    for (kind, form) in variants() {
        let least = least(&kind, &form);
        for (name, value) in properties(&kind, &form) {
            let mut misspelt = least.clone();
            misspelt.insert(format!("{name}x"), value.clone());
            assert!(!judges.accept(&kind, &misspelt), "{kind}: {name}x");
            for wrong in [
                json!(true),
                json!("?"),
                json!(-7.5),
                json!([]),
                json!([[1]]),
                json!({"a": 1}),
                json!(0),
                json!([0, 0, 0]),
            ] {
                // What only the reader can know: the middle of an empty scene, which the camera looks at, and
                // the names of files, that not both ends of a cone are points, and
                // that triangles index vertices.
                if (name == "position" && wrong == json!([0, 0, 0]))
                    || (name == "bottom_radius" && wrong == 0)
                    || (name == "vertices" && wrong == json!([]))
                    || (name == "file" && wrong.is_string())
                {
                    continue;
                }
                let mut mistyped = least.clone();
                mistyped.insert(name.clone(), wrong);
                judges.accept(&kind, &mistyped);
            }
        }
        for name in least.keys() {
            let mut missing = least.clone();
            missing.remove(name);
            judges.accept(&kind, &missing);
        }
    }
    assert!(
        judges.asked > 800 && judges.refused > 600,
        "{} {}",
        judges.asked,
        judges.refused
    );
}

#[test]
fn the_documentation_says_of_every_key_what_the_schema_says() {
    let text = fs::read_to_string(docs().join("scene.md")).expect("docs/scene.md");
    for (kind, form) in variants() {
        for (name, form) in form["properties"].as_object().expect("properties") {
            let row = match (&form["description"], &form["const"]) {
                (Value::String(about), _) => format!("\n| `{name}` | {about} |\n"),
                (_, Value::String(tag)) => format!("\"{tag}\"`"),
                _ => panic!("{kind}: {name} is described nowhere"),
            };
            assert!(text.contains(&row), "docs/scene.md lacks: {row}");
        }
    }
}

#[test]
fn every_example_is_in_the_documentation_with_its_pictures() {
    let text = fs::read_to_string(docs().join("scene.md")).expect("docs/scene.md");
    for entry in fs::read_dir(docs().join("scenes")).expect("docs/scenes") {
        let name = entry.expect("docs/scenes").file_name();
        let name = name.to_string_lossy();
        if Path::new(&*name).extension() != Some("obj".as_ref()) {
            assert!(text.contains(&format!("(scenes/{name})")), "{name}");
        }
    }
}
