//! Warns of colours that were probably meant as levels from 0 to 255.

use toml::de::{DeTable, DeValue};

use super::document::{Text, Value, integer};
use crate::geometry::meant_as_levels;
use crate::io::Report;

/// The keys of colours that should not exceed 1. Lights may.
const KEYS: &[&str] = &["color", "ambient", "horizon", "zenith"];

fn entries<'v, 't>(table: &'v DeTable<'t>) -> impl Iterator<Item = (&'v str, &'v Value<'t>)> {
    table.iter().map(|(name, value)| (name.get_ref().as_ref(), value))
}

/// Warns of linear colours in whole numbers up to 255 of which one is more than 1.
pub(super) fn warn(text: Text<'_>, scene: &DeTable<'_>, report: &mut Report) {
    // Not recursive: a file may nest its tables deeply.
    let mut open: Vec<_> = entries(scene).filter(|(name, _)| *name != "lights").collect();
    // Only the first is told: to count the lines up to each would take long.
    let mut first = None;
    while let Some((name, value)) = open.pop() {
        match value.get_ref() {
            DeValue::Table(table) => open.extend(entries(table)),
            DeValue::Array(items) if KEYS.contains(&name) => {
                let levels: Option<Vec<i64>> =
                    items.iter().map(|item| integer(item.get_ref())).collect();
                let Some(&[red, green, blue]) = levels.as_deref() else {
                    continue;
                };
                let levels = [red, green, blue];
                if let Some(hex) = meant_as_levels(levels.map(|level| level as f64).into()) {
                    let place = first.get_or_insert_with(|| text.place(value.span().start));
                    report.warn("levels", place, || {
                        format!(
                            "the colour {levels:?} is brighter than white: colours are linear, from 0 to 1; \
                             levels from 0 to 255 are written \"{hex}\""
                        )
                    });
                }
            }
            DeValue::Array(items) => open.extend(items.iter().map(|item| ("", item))),
            _ => {}
        }
    }
}
