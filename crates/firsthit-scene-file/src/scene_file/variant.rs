//! The variant of a table, told by its tag: `shape = "sphere"`.

use toml::de::DeTable;

use super::document::{Text, named};
use super::form::quoted;
use super::suggest::suggestion;
use super::table::{Pick, Record, Variant};
use crate::error::escape_controls;
use crate::io::fault::Checked;

/// The variant that a table is of.
pub(super) fn pick(
    text: Text<'_>,
    table: &DeTable<'_>,
    at: usize,
    record: &'static Record,
) -> Checked<&'static Variant> {
    let fits = |variant: &&Variant| match variant.pick {
        Pick::Always => true,
        Pick::Has(key) => table.contains_key(key),
        Pick::Tag(key, value) => has_text(table, key, value),
        Pick::Default(key, value) => !table.contains_key(key) || has_text(table, key, value),
    };
    if let Some(variant) = record.variants.iter().find(fits) {
        return Ok(variant);
    }
    let tags: Vec<_> = (record.variants.iter()).filter_map(|variant| variant.pick.tag()).collect();
    let words: Vec<&str> = tags.iter().map(|&(_, value)| value).collect();
    let key = tags.first().map_or("", |&(key, _)| key);
    let Some((name, value)) = table.get_key_value(key) else {
        return Err(text.fault(at, missing_tag(table, record, key, &words)));
    };
    let came = value.get_ref();
    if !came.is_str() {
        let (words, came) = (quoted(&words), named(came));
        let what = format!("`{key}` must be one of {words}, got {came}");
        return Err(text.fault(name.span().start, what));
    }
    let what = format!("unknown {key} {}", named(came));
    let hint = match suggestion(came.as_str().unwrap_or_default(), &words) {
        Some(meant) => format!(", did you mean \"{meant}\"?"),
        None => format!("; there are {}", quoted(&words)),
    };
    Err(text.fault(value.span().start, what + &hint))
}

/// The message where the key that tells the variants apart is missing; it may be only misspelt.
fn missing_tag(table: &DeTable<'_>, record: &Record, key: &'static str, words: &[&str]) -> String {
    let mut known = Vec::from_iter((!words.is_empty()).then_some(key));
    for variant in record.variants {
        if let Pick::Has(key) = variant.pick {
            known.push(key);
        }
    }
    let of_variants: Vec<&str> =
        (record.variants.iter()).flat_map(Variant::keys).map(|key| key.name).collect();
    let mut names: Vec<_> = table.keys().collect();
    names.sort_unstable_by_key(|name| name.span().start);
    let misspelt = names.iter().find_map(|name| {
        let word = name.get_ref().as_ref();
        let is_open = !of_variants.contains(&word);
        let meant = suggestion(word, &known).filter(|_| is_open)?;
        let word = escape_controls(word);
        Some(format!(": unknown key `{word}`, did you mean `{meant}`?"))
    });
    let hint = misspelt.unwrap_or_else(|| match words {
        [] => String::new(),
        _ => format!(", {key} being one of {}", quoted(words)),
    });
    let known: Vec<String> = known.iter().map(|key| format!("`{key}`")).collect();
    format!("this {} needs {}{hint}", record.name, known.join(" or "))
}

fn has_text(table: &DeTable<'_>, key: &str, value: &str) -> bool {
    table.get(key).is_some_and(|came| came.get_ref().as_str() == Some(value))
}
