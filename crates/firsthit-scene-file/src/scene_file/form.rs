//! The forms of values: the accepted ones in code, in words and in JSON Schema.

use std::borrow::Cow;

use serde_json::{Value as Json, json};

use super::document::{Value, array, integer, number, numbers};
use super::settings;
use super::table::{Form, Record};
use crate::geometry::{COLOR_NAMES, Color, DVec3, Domain, color_of};

impl Form {
    /// The expected values, for "must be ...".
    pub(super) fn expected(self) -> String {
        match self {
            Self::Of(domain) => of_domain(domain).into(),
            Self::Whole(least, most) => format!("a whole number from {least} to {most}"),
            Self::Text => "a text, not empty".into(),
            Self::Path => "the name of a file".into(),
            Self::Word(word) => format!("\"{word}\""),
            Self::OneOf(words) => format!("one of {}", quoted(&words())),
            Self::OneOfOr(words, beginning) => {
                format!("one of {}, \"{beginning}NAME\"", quoted(&words()))
            }
            Self::Range => "two finite numbers that rise, [low, high]".into(),
            Self::Span(end) => format!("{}, or two that do not decrease", end.expected()),
            Self::Scale => "a factor, or three of them, [x, y, z], none of them zero".into(),
            Self::Quaternion => "four finite numbers, [x, y, z, w], not all zero".into(),
            Self::Matrix => {
                "three rows of four finite numbers, or four, the last being [0, 0, 0, 1]".into()
            }
            Self::Array(item, least, most) => {
                let count = match least {
                    0 => String::new(),
                    _ if least == most => format!(" of {least}"),
                    _ => format!(" of at least {least}"),
                };
                format!("an array{count}, each item {}", item.expected())
            }
            Self::Either(one, Self::Array(other, ..)) if one.expected() == other.expected() => {
                format!("{}, or an array of them", one.expected())
            }
            Self::Either(one, other) => format!("{}, or {}", one.expected(), other.expected()),
            Self::Table(_) | Self::Named(_) => "a table".into(),
            Self::List(_) => "an array of tables".into(),
        }
    }

    /// Whether a value has this form; tables in it are checked when they are opened.
    pub(super) fn accepts(self, value: &Value<'_>) -> bool {
        let raw = value.get_ref();
        match self {
            Self::Of(domain) => settings::value(raw, domain)
                .is_some_and(|value| domain.checked("value", value).is_ok()),
            Self::Whole(least, most) => {
                integer(raw).is_some_and(|number| (least..=most).contains(&number))
            }
            Self::Text | Self::Path => raw.as_str().is_some_and(|text| !text.is_empty()),
            Self::Word(word) => raw.as_str() == Some(word),
            Self::OneOf(words) => is_one_of(raw, words),
            Self::OneOfOr(words, beginning) => {
                let rest = raw.as_str().and_then(|text| text.strip_prefix(beginning));
                is_one_of(raw, words) || rest.is_some_and(|rest| !rest.is_empty())
            }
            Self::Range => numbers::<2>(raw).is_some_and(|[low, high]| low < high),
            Self::Span(end) => {
                end.accepts(value) || {
                    let ends = raw.as_array().filter(|items| items.iter().all(|x| end.accepts(x)));
                    ends.is_some() && numbers::<2>(raw).is_some_and(|[low, high]| low <= high)
                }
            }
            Self::Scale => scale(raw).is_some(),
            Self::Quaternion => numbers::<4>(raw).is_some_and(|q| q != [0.0; 4]),
            Self::Matrix => matrix(raw).is_some(),
            Self::Array(item, least, most) => raw.as_array().is_some_and(|items| {
                (least..=most).contains(&items.len()) && items.iter().all(|each| item.accepts(each))
            }),
            Self::Either(one, other) => one.accepts(value) || other.accepts(value),
            Self::Table(_) | Self::Named(_) => raw.is_table(),
            Self::List(_) => raw
                .as_array()
                .is_some_and(|items| items.iter().all(|item| item.get_ref().is_table())),
        }
    }

    /// The item of an array that keeps it from having this form, if it is a single one.
    pub(super) fn culprit<'v, 't>(self, value: &'v Value<'t>) -> Option<&'v Value<'t>> {
        let items = value.get_ref().as_array()?;
        let fine: &dyn Fn(&Value<'t>) -> bool = match self {
            Self::Of(Domain::Position | Domain::Direction) | Self::Quaternion | Self::Scale => {
                &|item| Self::NUMBER.accepts(item)
            }
            Self::Of(Domain::Color | Domain::Light) => &|item| Self::NON_NEGATIVE.accepts(item),
            Self::Array(form, ..) => &|item| form.accepts(item),
            Self::List(_) => &|item| item.get_ref().is_table(),
            Self::Either(one, other) => {
                return one.culprit(value).or_else(|| other.culprit(value));
            }
            _ => return None,
        };
        items.iter().find(|item| !fine(item))
    }

    /// The words that a text of this form can be, for suggestions.
    pub(super) fn words(self) -> Vec<&'static str> {
        match self {
            Self::Word(word) => vec![word],
            Self::OneOf(words) | Self::OneOfOr(words, _) => words(),
            Self::Of(Domain::Color | Domain::Light) => {
                COLOR_NAMES.iter().map(|&(name, _)| name).collect()
            }
            Self::Array(item, ..) => item.words(),
            Self::Either(one, other) => [one.words(), other.words()].concat(),
            _ => Vec::new(),
        }
    }

    /// The records of tables that a value of this form may hold.
    pub(super) fn records(self) -> Vec<&'static Record> {
        match self {
            Self::Table(record) | Self::List(record) => vec![record],
            Self::Named(form) | Self::Array(form, ..) => form.records(),
            Self::Either(one, other) => [one.records(), other.records()].concat(),
            _ => Vec::new(),
        }
    }

    /// The form as JSON Schema (draft 2020-12).
    pub(super) fn schema(self) -> Json {
        let array = |items: &Json, count: usize| json!({"type": "array", "items": items, "minItems": count, "maxItems": count});
        let number = json!({"type": "number"});
        match self {
            Self::Of(domain) => domain_schema(domain),
            Self::Whole(least, most) => {
                json!({"type": "integer", "minimum": least, "maximum": most})
            }
            Self::Text | Self::Path => json!({"type": "string", "minLength": 1}),
            Self::Word(word) => json!({"const": word}),
            Self::OneOf(words) => json!({"enum": words()}),
            Self::OneOfOr(words, beginning) => {
                let other = json!({"type": "string", "pattern": format!("^{beginning}.")});
                json!({"oneOf": [{"enum": words()}, other]})
            }
            Self::Range => array(&number, 2),
            Self::Span(end) => json!({"oneOf": [end.schema(), array(&end.schema(), 2)]}),
            Self::Scale => {
                let factor = json!({"type": "number", "not": {"const": 0}});
                json!({"oneOf": [factor, array(&factor, 3)]})
            }
            Self::Quaternion => nonzero(4),
            Self::Matrix => {
                let row = array(&number, 4);
                let last = json!({"const": [0, 0, 0, 1]});
                json!({"type": "array", "minItems": 3, "maxItems": 4, "prefixItems": [row, row, row, last]})
            }
            Self::Array(item, least, most) => {
                let mut schema = json!({"type": "array", "items": item.schema()});
                if least > 0 {
                    insert(&mut schema, "minItems", json!(least));
                }
                if most < usize::MAX {
                    insert(&mut schema, "maxItems", json!(most));
                }
                schema
            }
            Self::Either(one, other) => json!({"oneOf": [one.schema(), other.schema()]}),
            Self::Table(record) => record.schema(),
            Self::List(record) => json!({"type": "array", "items": record.schema()}),
            Self::Named(form) => json!({"type": "object", "additionalProperties": form.schema()}),
        }
    }
}

/// The expected values of a domain in a file, whose numbers are finite.
fn of_domain(domain: Domain) -> Cow<'static, str> {
    match domain {
        Domain::Position => "three finite numbers, [x, y, z]".into(),
        Domain::Direction => "three finite numbers, [x, y, z], not all zero".into(),
        Domain::Color | Domain::Light => {
            "linear [red, green, blue], none of them negative, or sRGB as \"#rrggbb\" or by a CSS name".into()
        }
        Domain::PositiveOrInfinite => Domain::Positive.expected(),
        _ => domain.expected(),
    }
}

fn domain_schema(domain: Domain) -> Json {
    let number = |limits: &[(&str, f64)]| {
        let mut schema = json!({"type": "number"});
        for (name, limit) in limits {
            insert(&mut schema, name, json!(limit));
        }
        schema
    };
    match domain {
        Domain::Flag => json!({"type": "boolean"}),
        Domain::Number => number(&[]),
        Domain::From(least, most) => number(&[("minimum", least), ("maximum", most)]),
        Domain::Between(low, high) => {
            number(&[("exclusiveMinimum", low), ("exclusiveMaximum", high)])
        }
        Domain::Above(low) => number(&[("exclusiveMinimum", low)]),
        Domain::UpTo(most) => number(&[("exclusiveMinimum", 0.0), ("maximum", most)]),
        Domain::NonNegative => number(&[("minimum", 0.0)]),
        Domain::Positive | Domain::PositiveOrInfinite => number(&[("exclusiveMinimum", 0.0)]),
        Domain::Whole(least, most) => Form::Whole(least.into(), most.into()).schema(),
        Domain::Position => Form::Array(&Form::NUMBER, 3, 3).schema(),
        Domain::Direction => nonzero(3),
        Domain::Color | Domain::Light => json!({"$ref": "#/$defs/color"}),
    }
}

/// The schema of so many numbers that are not all zero: one of the items is not.
fn nonzero(count: usize) -> Json {
    json!({"type": "array", "items": {"type": "number"}, "minItems": count, "maxItems": count, "contains": {"not": {"const": 0}}})
}

/// The schema of colours, shared by all keys; editors complete the names from it.
pub(super) fn color_schema() -> Json {
    let names: Vec<&str> = COLOR_NAMES.iter().map(|&(name, _)| name).collect();
    json!({
        "description": "A colour: linear [red, green, blue], or sRGB as \"#rrggbb\" or by a name of CSS.",
        "oneOf": [
            {"type": "array", "items": {"type": "number", "minimum": 0}, "minItems": 3, "maxItems": 3},
            {"type": "string", "pattern": "^#([0-9a-fA-F]{3}){1,2}$"},
            {"enum": names},
        ],
    })
}

pub(super) fn insert(schema: &mut Json, key: &str, value: Json) {
    if let Some(map) = schema.as_object_mut() {
        map.insert(key.to_owned(), value);
    }
}

/// Words as an error lists them.
pub(super) fn quoted(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    quoted.join(", ")
}

type Raw<'t> = toml::de::DeValue<'t>;

fn is_one_of(value: &Raw<'_>, words: fn() -> Vec<&'static str>) -> bool {
    value.as_str().is_some_and(|text| words().contains(&text))
}

/// A linear colour.
pub(super) fn color(value: &Raw<'_>) -> Option<Color> {
    if let Some(text) = value.as_str() {
        // One spelling of a name, which is that of the schema.
        let is_plain = text.starts_with('#') || !text.bytes().any(|b| b.is_ascii_uppercase());
        return color_of(text).filter(|_| is_plain);
    }
    let color = Color::from(numbers::<3>(value)?);
    (color.min_element() >= 0.0).then_some(color)
}

pub(super) const TRANSPARENT: &str = "transparent";

/// Whether a background is transparent.
pub(super) fn is_transparent(value: &Raw<'_>) -> bool {
    value.as_str() == Some(TRANSPARENT)
}

/// A factor for each axis, none of them zero.
pub(super) fn scale(value: &Raw<'_>) -> Option<DVec3> {
    let factors = number(value).map(DVec3::splat);
    let factors = factors.or_else(|| numbers::<3>(value).map(DVec3::from))?;
    factors.cmpne(DVec3::ZERO).all().then_some(factors)
}

/// The upper three rows.
pub(super) fn matrix(value: &Raw<'_>) -> Option<[[f64; 4]; 3]> {
    if let Some(rows) = array(value, numbers::<4>) {
        return Some(rows);
    }
    let [a, b, c, last] = array(value, numbers::<4>)?;
    (last == [0.0, 0.0, 0.0, 1.0]).then_some([a, b, c])
}

/// Three indices.
pub(super) fn triple(value: &Raw<'_>) -> Option<[u32; 3]> {
    array(value, |item| u32::try_from(integer(item)?).ok())
}
