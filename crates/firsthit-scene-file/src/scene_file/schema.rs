//! The JSON Schema of scene files, made from the tables that the reader goes by.

use serde_json::{Map, Value as Json, json};

use super::form::{color_schema, insert};
use super::records::{RECORDS, SCENE};
use super::table::{Pick, Record, Rule, Variant};

/// The JSON Schema (draft 2020-12) of scene files, as text with a newline at its end. Editors complete
/// and check scene files by it.
pub fn schema() -> String {
    let mut definitions = Map::new();
    for record in RECORDS {
        definitions.insert(record.name.to_owned(), definition(record));
    }
    let mut whole = definition(&SCENE);
    definitions.remove(SCENE.name);
    insert(
        &mut whole,
        "$schema",
        json!("https://json-schema.org/draft/2020-12/schema"),
    );
    insert(&mut whole, "title", json!("firsthit scene file"));
    definitions.insert("color".to_owned(), color_schema());
    insert(&mut whole, "$defs", Json::Object(definitions));
    format!("{whole:#}\n")
}

impl Record {
    pub(super) fn schema(&self) -> Json {
        json!({"$ref": format!("#/$defs/{}", self.name)})
    }
}

fn definition(record: &Record) -> Json {
    let mut schema = match record.variants {
        [only] => variant(only),
        several => json!({"oneOf": several.iter().map(variant).collect::<Vec<_>>()}),
    };
    insert(&mut schema, "description", json!(record.about));
    schema
}

fn variant(variant: &Variant) -> Json {
    let (mut properties, mut needed) = (Map::new(), Vec::new());
    if let Some((key, value)) = variant.pick.tag() {
        properties.insert(key.to_owned(), json!({"const": value}));
        if let Pick::Tag(..) = variant.pick {
            needed.push(key);
        }
    }
    for key in variant.keys() {
        let mut form = key.form.schema();
        insert(&mut form, "description", json!(key.about));
        properties.insert(key.name.to_owned(), form);
        if key.is_required {
            needed.push(key.name);
        }
    }
    let mut schema = json!({
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if !needed.is_empty() {
        insert(&mut schema, "required", json!(needed));
    }
    if let Some((_, value)) = variant.pick.tag() {
        insert(&mut schema, "title", json!(value));
    }
    let rules: Vec<Json> = variant.rules.iter().map(rule).collect();
    if !rules.is_empty() {
        insert(&mut schema, "allOf", json!(rules));
    }
    schema
}

fn rule(rule: &Rule) -> Json {
    match *rule {
        Rule::NotBoth(a, b) => json!({"not": {"required": [a, b]}}),
        Rule::Needs(a, b) => json!({"dependentRequired": {(a): [b]}}),
        Rule::OneOf(a, b) => json!({"oneOf": [{"required": [a]}, {"required": [b]}]}),
    }
}
