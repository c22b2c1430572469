//! The text of a plan: checked against its records, its values, and the places of them.

use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::document::{Text, Value, integer, number};
use super::plan::PLAN;
use super::section::{Section, in_order};
use crate::error::{Place, Result};
use crate::io::fault::{Checked, Fault};
use crate::io::read;

/// The reason why a text is no plan.
#[doc(hidden)]
#[derive(Debug)]
pub struct Mistake {
    /// Its line and column.
    pub place: Place,
    /// The table that it is in, such as `sensors[0]`; empty for the whole.
    pub table: String,
    /// The reason.
    pub what: String,
}

/// The values of a plan as JSON, in the order of the text.
///
/// # Errors
///
/// [`Error::Limit`](crate::error::Error::Limit) where memory is short.
#[doc(hidden)]
pub fn read_plan(bytes: &[u8]) -> Result<std::result::Result<String, Mistake>> {
    match checked(bytes) {
        Ok(json) => Ok(Ok(json)),
        Err(Fault::Content { place, what }) => {
            let table = table_at(bytes, &place).unwrap_or_default();
            Ok(Err(Mistake { place, table, what }))
        }
        Err(other) => Err(other.into_error("plan".as_ref())),
    }
}

fn checked(bytes: &[u8]) -> Checked<String> {
    let text = Text::new(bytes)?;
    let document = text.parse()?;
    Section::new(text, document.get_ref(), 0, &PLAN)?.check_deep()?;
    Ok(json_of_table(document.get_ref()))
}

fn json(value: &DeValue<'_>) -> String {
    match value {
        DeValue::Table(table) => json_of_table(table),
        DeValue::Array(items) => {
            let items: Vec<String> = items.iter().map(|item| json(item.get_ref())).collect();
            format!("[{}]", items.join(","))
        }
        DeValue::String(word) => serde_json::json!(word).to_string(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Integer(digits) => match integer(value) {
            Some(whole) => whole.to_string(),
            None => digits.as_str().trim_start_matches('+').to_owned(),
        },
        DeValue::Float(_) | DeValue::Datetime(_) => serde_json::json!(number(value)).to_string(),
    }
}

fn json_of_table(table: &DeTable<'_>) -> String {
    let entry = |name: &str, value| format!("{}:{}", serde_json::json!(name), json(value));
    let entries = in_order(table).into_iter();
    let entries = entries.map(|(name, value)| entry(name.get_ref(), value.get_ref()));
    format!("{{{}}}", entries.collect::<Vec<_>>().join(","))
}

/// The file that a plan in `folder` names: it is there, in the folder or below.
///
/// # Errors
///
/// In words, the name and why it is refused or cannot be found.
#[doc(hidden)]
pub fn plan_file(folder: &Path, name: &str) -> std::result::Result<PathBuf, String> {
    read::within(folder, name).map_err(|why| format!("{name:?}: {why}"))
}

/// The place of the value to which keys and indices lead, or of the last on the way that is there.
#[doc(hidden)]
pub fn place_in_plan(bytes: &[u8], way: &[String]) -> Option<Place> {
    let text = Text::new(bytes).ok()?;
    let document = text.parse().ok()?;
    let (first, rest) = way.split_first()?;
    let mut found = document.get_ref().get(first.as_str())?;
    for step in rest {
        let next = match found.get_ref() {
            DeValue::Table(table) => table.get(step.as_str()),
            DeValue::Array(items) => step.parse().ok().and_then(|index: usize| items.get(index)),
            _ => None,
        };
        let Some(next) = next else { break };
        found = next;
    }
    Some(text.place(found.span().start))
}

/// The table whose key or value is at a place.
fn table_at(bytes: &[u8], place: &Place) -> Option<String> {
    let text = Text::new(bytes).ok()?;
    let document = text.parse().ok()?;
    in_table(document.get_ref(), text.byte(place)?, "")
}

fn in_table(table: &DeTable<'_>, at: usize, way: &str) -> Option<String> {
    in_order(table).into_iter().find_map(|(name, value)| {
        let dot = if way.is_empty() { "" } else { "." };
        let is_here = name.span().start == at;
        let inner = || in_value(value, at, way, &format!("{way}{dot}{}", name.get_ref()));
        is_here.then(|| way.to_owned()).or_else(inner)
    })
}

fn in_value(value: &Value<'_>, at: usize, table: &str, way: &str) -> Option<String> {
    let is_here = value.span().start == at;
    match value.get_ref() {
        DeValue::Table(_) if is_here => Some(way.to_owned()),
        _ if is_here => Some(table.to_owned()),
        DeValue::Table(inner) => in_table(inner, at, way),
        DeValue::Array(items) => (items.iter().enumerate())
            .find_map(|(index, item)| in_value(item, at, table, &format!("{way}[{index}]"))),
        _ => None,
    }
}
