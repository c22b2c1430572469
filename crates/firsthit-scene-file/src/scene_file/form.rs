//! The forms of values: the accepted ones in code, in words and in JSON Schema.

use serde_json::{Value as Json, json};

use super::document::{Value, array, integer, number, numbers};
use super::table::Form;
use crate::geometry::{COLOR_NAMES, Color, DVec3, color_of};

impl Form {
    /// The expected values, for "must be ...".
    pub(super) fn expected(self) -> String {
        match self {
            Self::Number => "a finite number".into(),
            Self::Positive => "a positive number".into(),
            Self::NonNegative => "zero or a positive number".into(),
            Self::Between(low, high) => format!("a number between {low} and {high}"),
            Self::From(least, most) => format!("a number from {least} to {most}"),
            Self::UpTo(most) => format!("above 0 and up to {most}"),
            Self::Above(low) => format!("above {low}"),
            Self::Whole(least, most) => format!("a whole number from {least} to {most}"),
            Self::Boolean => "true or false".into(),
            Self::Text => "a text, not empty".into(),
            Self::Path => "the name of a file".into(),
            Self::OneOf(words) => format!("one of {}", quoted(&words())),
            Self::OneOfOr(words, beginning) => {
                format!("one of {}, \"{beginning}NAME\"", quoted(&words()))
            }
            Self::SomeOf(words, beginning) => {
                let words = quoted(&words());
                let others = beginning.map(|beginning| format!(", \"{beginning}NAME\""));
                format!("an array of some of {words}{}", others.unwrap_or_default())
            }
            Self::Range => "two finite numbers that rise, [low, high]".into(),
            Self::Vector => "three finite numbers, [x, y, z]".into(),
            Self::Direction => "three finite numbers, [x, y, z], not all zero".into(),
            Self::Color => {
                "linear [red, green, blue], none of them negative, or sRGB as \"#rrggbb\" or by a CSS name"
                    .into()
            }
            Self::ColorOrTransparent => {
                format!("{}, or \"transparent\"", Self::Color.expected())
            }
            Self::Scale => "a factor, or three of them, [x, y, z], none of them zero".into(),
            Self::Focus => "a positive distance, or a point, [x, y, z]".into(),
            Self::Quaternion => "four finite numbers, [x, y, z, w], not all zero".into(),
            Self::Matrix => {
                "three rows of four finite numbers, or four, the last being [0, 0, 0, 1]".into()
            }
            Self::Points => "an array of points, [x, y, z]".into(),
            Self::Triples => "an array of triangles, each three indices of vertices".into(),
            Self::Table(_) | Self::Named(_) => "a table".into(),
            Self::TableOrList(_) => "a table or an array of tables".into(),
            Self::Turn(_) => "a number of degrees or a table".into(),
            Self::List(record) => format!("an array of tables, [[{}s]]", record.name),
        }
    }

    /// Whether a value that holds no tables has this form.
    pub(super) fn accepts(self, value: &Value<'_>) -> bool {
        let value = value.get_ref();
        let positive = |number: f64| number > 0.0;
        match self {
            Self::Number => number(value).is_some(),
            Self::Positive => number(value).is_some_and(positive),
            Self::NonNegative => number(value).is_some_and(|number| number >= 0.0),
            Self::Between(low, high) => number(value).is_some_and(|x| low < x && x < high),
            Self::From(least, most) => number(value).is_some_and(|x| (least..=most).contains(&x)),
            Self::UpTo(most) => number(value).is_some_and(|x| x > 0.0 && x <= most),
            Self::Above(low) => number(value).is_some_and(|x| x > low),
            Self::Whole(least, most) => {
                integer(value).is_some_and(|number| (least..=most).contains(&number))
            }
            Self::Boolean => value.is_bool(),
            Self::Text | Self::Path => value.as_str().is_some_and(|text| !text.is_empty()),
            Self::OneOf(words) => is_one_of(value, words),
            Self::OneOfOr(words, beginning) => is_one_of_or(value, words, Some(beginning)),
            Self::SomeOf(words, beginning) => {
                let is_empty = value.as_array().is_some_and(|items| items.is_empty());
                !is_empty && all(value, |item| is_one_of_or(item, words, beginning))
            }
            Self::Range => numbers::<2>(value).is_some_and(|[low, high]| low < high),
            Self::Vector => numbers::<3>(value).is_some(),
            Self::Direction => numbers::<3>(value).is_some_and(|v| v != [0.0; 3]),
            Self::Color => color(value).is_some(),
            Self::ColorOrTransparent => is_transparent(value) || color(value).is_some(),
            Self::Scale => scale(value).is_some(),
            Self::Focus => number(value).is_some_and(positive) || numbers::<3>(value).is_some(),
            Self::Quaternion => numbers::<4>(value).is_some_and(|q| q != [0.0; 4]),
            Self::Matrix => matrix(value).is_some(),
            Self::Points => all(value, |item| numbers::<3>(item).is_some()),
            Self::Triples => all(value, |item| triple(item).is_some()),
            Self::Table(_) | Self::Named(_) => value.is_table(),
            Self::TableOrList(_) => value.is_table() || all(value, is_table),
            Self::Turn(_) => value.is_table() || number(value).is_some(),
            Self::List(_) => all(value, is_table),
        }
    }

    /// The item of an array that keeps it from having this form, if it is a single one.
    pub(super) fn culprit<'v, 't>(self, value: &'v Value<'t>) -> Option<&'v Value<'t>> {
        let items = value.get_ref().as_array()?;
        let fine: &dyn Fn(&Value<'t>) -> bool = match self {
            Self::Vector | Self::Direction | Self::Quaternion | Self::Scale | Self::Focus => {
                &|item| number(item.get_ref()).is_some()
            }
            Self::Color | Self::ColorOrTransparent => {
                &|item| number(item.get_ref()).is_some_and(|x| x >= 0.0)
            }
            Self::Points => &|item| numbers::<3>(item.get_ref()).is_some(),
            Self::Triples => &|item| triple(item.get_ref()).is_some(),
            Self::SomeOf(words, beginning) => {
                let fine = |item: &&Value<'t>| is_one_of_or(item.get_ref(), words, beginning);
                return items.iter().find(|item| !fine(item));
            }
            Self::List(_) | Self::TableOrList(_) => &|item| item.get_ref().is_table(),
            _ => return None,
        };
        items.iter().find(|item| !fine(item))
    }

    /// The words that a text of this form can be, for suggestions.
    pub(super) fn words(self) -> Vec<&'static str> {
        match self {
            Self::OneOf(words) | Self::OneOfOr(words, _) | Self::SomeOf(words, _) => words(),
            Self::Color => COLOR_NAMES.iter().map(|&(name, _)| name).collect(),
            Self::ColorOrTransparent => {
                let mut words = Self::Color.words();
                words.push(TRANSPARENT);
                words
            }
            _ => Vec::new(),
        }
    }

    /// The form as JSON Schema (draft 2020-12).
    #[expect(clippy::too_many_lines, reason = "a line or two for each form")]
    pub(super) fn schema(self) -> Json {
        let array = |items: &Json, least: usize, most: usize| json!({"type": "array", "items": items, "minItems": least, "maxItems": most});
        let number = json!({"type": "number"});
        let vector = array(&number, 3, 3);
        // Not all zero: one of the items is not.
        let nonzero = |count: usize| {
            let mut schema = array(&number, count, count);
            insert(&mut schema, "contains", json!({"not": {"const": 0}}));
            schema
        };
        match self {
            Self::Number => number,
            Self::Positive => json!({"type": "number", "exclusiveMinimum": 0}),
            Self::NonNegative => json!({"type": "number", "minimum": 0}),
            Self::Between(low, high) => {
                json!({"type": "number", "exclusiveMinimum": low, "exclusiveMaximum": high})
            }
            Self::From(least, most) => {
                json!({"type": "number", "minimum": least, "maximum": most})
            }
            Self::UpTo(most) => {
                json!({"type": "number", "exclusiveMinimum": 0, "maximum": most})
            }
            Self::Above(low) => json!({"type": "number", "exclusiveMinimum": low}),
            Self::Whole(least, most) => {
                json!({"type": "integer", "minimum": least, "maximum": most})
            }
            Self::Boolean => json!({"type": "boolean"}),
            Self::Text | Self::Path => json!({"type": "string", "minLength": 1}),
            Self::OneOf(words) => json!({"enum": words()}),
            Self::OneOfOr(words, beginning) => {
                let other = json!({"type": "string", "pattern": format!("^{beginning}.")});
                json!({"oneOf": [{"enum": words()}, other]})
            }
            Self::SomeOf(words, beginning) => {
                let items = match beginning {
                    Some(beginning) => {
                        let other = json!({"type": "string", "pattern": format!("^{beginning}.")});
                        json!({"anyOf": [{"enum": words()}, other]})
                    }
                    None => json!({"enum": words()}),
                };
                json!({"type": "array", "items": items, "minItems": 1})
            }
            Self::Range => array(&number, 2, 2),
            Self::Vector => vector,
            Self::Direction => nonzero(3),
            Self::Color => json!({"$ref": "#/$defs/color"}),
            Self::ColorOrTransparent => {
                json!({"oneOf": [{"$ref": "#/$defs/color"}, {"const": TRANSPARENT}]})
            }
            Self::Scale => {
                let factor = json!({"type": "number", "not": {"const": 0}});
                json!({"oneOf": [factor, array(&factor, 3, 3)]})
            }
            Self::Focus => {
                json!({"oneOf": [{"type": "number", "exclusiveMinimum": 0}, vector]})
            }
            Self::Quaternion => nonzero(4),
            Self::Matrix => {
                let row = array(&number, 4, 4);
                let last = json!({"const": [0, 0, 0, 1]});
                json!({"type": "array", "minItems": 3, "maxItems": 4, "prefixItems": [row, row, row, last]})
            }
            Self::Points => json!({"type": "array", "items": vector}),
            Self::Triples => {
                let index = json!({"type": "integer", "minimum": 0, "maximum": u32::MAX});
                json!({"type": "array", "items": array(&index, 3, 3)})
            }
            Self::Table(record) => record.schema(),
            Self::TableOrList(record) => {
                let list = json!({"type": "array", "items": record.schema()});
                json!({"oneOf": [record.schema(), list]})
            }
            Self::Turn(record) => json!({"oneOf": [number, record.schema()]}),
            Self::List(record) => json!({"type": "array", "items": record.schema()}),
            Self::Named(record) => {
                json!({"type": "object", "additionalProperties": record.schema()})
            }
        }
    }
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

fn is_table(value: &Raw<'_>) -> bool {
    value.is_table()
}

fn is_one_of(value: &Raw<'_>, words: fn() -> Vec<&'static str>) -> bool {
    value.as_str().is_some_and(|text| words().contains(&text))
}

/// Whether a value is one of some words, or has the beginning and something after it.
fn is_one_of_or(
    value: &Raw<'_>,
    words: fn() -> Vec<&'static str>,
    beginning: Option<&str>,
) -> bool {
    let rest = value
        .as_str()
        .and_then(|text| text.strip_prefix(beginning?));
    is_one_of(value, words) || rest.is_some_and(|rest| !rest.is_empty())
}

fn all(value: &Raw<'_>, fine: impl Fn(&Raw<'_>) -> bool) -> bool {
    value
        .as_array()
        .is_some_and(|items| items.iter().all(|item| fine(item.get_ref())))
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

const TRANSPARENT: &str = "transparent";

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
