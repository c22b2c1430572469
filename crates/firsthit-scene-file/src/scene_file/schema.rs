//! The JSON Schema of scene files, made from the tables that the reader goes by.

use serde_json::{Map, Value as Json, json};

use super::form::{color_schema, insert};
use super::plan::PLAN;
use super::records::SCENE;
use super::table::{Pick, Record, Rule, Variant};

/// The JSON Schema (draft 2020-12) of scene files, as text with a newline at its end. Editors
/// complete and check scene files by it.
pub fn schema() -> String {
    of(&SCENE, "firsthit scene file")
}

/// The JSON Schema (draft 2020-12) of plans of data sets.
#[doc(hidden)]
pub fn plan_schema() -> String {
    of(&PLAN, "firsthit plan of a data set")
}

fn of(root: &'static Record, title: &str) -> String {
    let records = root.all();
    let mut definitions = Map::new();
    for record in &records {
        let is_part = |other: &&&Record| other.also().any(|part| part.name == record.name);
        let is_open = records.iter().any(|other| is_part(&other));
        definitions.insert(record.name.to_owned(), definition(record, is_open));
    }
    let mut whole = definitions.remove(root.name).unwrap_or_default();
    insert(&mut whole, "$schema", json!("https://json-schema.org/draft/2020-12/schema"));
    insert(&mut whole, "title", json!(title));
    definitions.insert("color".to_owned(), color_schema());
    insert(&mut whole, "$defs", Json::Object(definitions));
    format!("{whole:#}\n")
}

impl Record {
    /// The record, and all that its tables may be of.
    pub(super) fn all(&'static self) -> Vec<&'static Self> {
        let mut found = vec![self];
        let mut next = 0;
        while let Some(record) = found.get(next) {
            let keys = record.variants.iter().flat_map(Variant::keys);
            let of_keys = keys.flat_map(|key| key.form.records());
            let new: Vec<&Self> = record.also().chain(of_keys).collect();
            for record in new {
                if !found.iter().any(|known| known.name == record.name) {
                    found.push(record);
                }
            }
            next += 1;
        }
        found
    }

    fn also(&self) -> impl Iterator<Item = &'static Self> + use<> {
        self.variants.iter().flat_map(Variant::also)
    }

    pub(super) fn schema(&self) -> Json {
        json!({"$ref": format!("#/$defs/{}", self.name)})
    }
}

/// The schema of a table; an open one is a part of another, and has further keys there.
fn definition(record: &Record, is_open: bool) -> Json {
    let variants = record.variants.iter().map(|each| variant(each, is_open));
    let mut schema = match &*variants.collect::<Vec<_>>() {
        [only] => only.clone(),
        several => json!({"oneOf": several}),
    };
    insert(&mut schema, "description", json!(record.about));
    schema
}

fn variant(variant: &Variant, is_open: bool) -> Json {
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
    let mut schema = json!({"type": "object", "properties": properties});
    // Keys of the parts of a table count as evaluated, and not as its properties.
    let others = match variant.also().next() {
        Some(_) => "unevaluatedProperties",
        None => "additionalProperties",
    };
    if !is_open {
        insert(&mut schema, others, json!(false));
    }
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
        Rule::Also(record) => record.schema(),
    }
}
