//! The description of a table in a scene file: its keys, the forms of their values, and rules.

use crate::geometry::Domain;

/// A key and the form of its value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) form: Form,
    pub(super) is_required: bool,
    /// The meaning, which editors show.
    pub(super) about: &'static str,
}

/// A key that may be left out.
pub(super) const fn optional(form: Form) -> Key {
    Key { name: "", form, is_required: false, about: "" }
}

/// A key that must be there.
pub(super) const fn required(form: Form) -> Key {
    Key { is_required: true, ..optional(form) }
}

/// A list of keys: each has a row, and its meaning as a doc comment.
macro_rules! keys {
    ($($(#[doc = $about:literal])+ $name:ident: $key:expr,)+) => {
        &[$(crate::scene_file::table::Key {
            name: stringify!($name),
            about: concat!($($about),+).trim_ascii(),
            ..$key
        }),+]
    };
}
pub(super) use keys;

/// A kind of table.
#[derive(Debug)]
pub(super) struct Record {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    /// The first whose `pick` fits is the one; all have the same tag.
    pub(super) variants: &'static [Variant],
}

/// A kind of table: its name, its meaning, and a row for each variant, with its lists of keys and
/// its rules.
macro_rules! record {
    ($name:expr, $about:expr; $($pick:expr => [$($keys:expr),*] $([$($rule:expr),* $(,)?])?;)+) => {
        crate::scene_file::table::Record {
            name: $name,
            about: $about,
            variants: &[$(crate::scene_file::table::Variant {
                pick: $pick,
                keys: &[$($keys),*],
                rules: &[$($($rule),*)?],
            }),+],
        }
    };
}
pub(super) use record;

/// One form of a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variant {
    pub(super) pick: Pick,
    pub(super) keys: &'static [&'static [Key]],
    pub(super) rules: &'static [Rule],
}

impl Variant {
    pub(super) fn keys(&self) -> impl Iterator<Item = &'static Key> {
        self.keys.iter().flat_map(|group| group.iter())
    }

    /// The records whose keys its tables have, too.
    pub(super) fn also(&self) -> impl Iterator<Item = &'static Record> + use<> {
        self.rules.iter().filter_map(|rule| match rule {
            Rule::Also(record) => Some(*record),
            _ => None,
        })
    }
}

/// The sign that tells a table's variant.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pick {
    /// There is one variant.
    Always,
    /// The key is there.
    Has(&'static str),
    /// The key has the value.
    Tag(&'static str, &'static str),
    /// The key has the value, or is not there.
    Default(&'static str, &'static str),
}

impl Pick {
    /// The tag's key and value.
    pub(super) fn tag(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Tag(key, value) | Self::Default(key, value) => Some((key, value)),
            Self::Always | Self::Has(_) => None,
        }
    }
}

/// A rule on keys together.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rule {
    NotBoth(&'static str, &'static str),
    /// The first does nothing without the second.
    Needs(&'static str, &'static str),
    /// Exactly one of the two has to be there.
    OneOf(&'static str, &'static str),
    /// The table also has the keys of another record, and keeps its rules.
    Also(&'static Record),
}

/// The form of a key's value.
#[derive(Debug, Clone, Copy)]
pub(super) enum Form {
    /// A value of a setting. Numbers are finite; colours may be linear red, green and blue, or sRGB
    /// as `"#rrggbb"` or by a name of CSS.
    Of(Domain),
    /// A whole number from the first to the last, of 64 bits.
    Whole(i64, i64),
    /// Any text but an empty one.
    Text,
    /// A file's name.
    Path,
    /// This word.
    Word(&'static str),
    /// One of some words.
    OneOf(fn() -> Vec<&'static str>),
    /// One of some words, or a word with the beginning and something after it.
    OneOfOr(fn() -> Vec<&'static str>, &'static str),
    /// Two numbers of which the second is larger.
    Range,
    /// A number of a form, or two that do not decrease.
    Span(&'static Form),
    /// A factor that is not zero, or one for each axis.
    Scale,
    /// `x, y, z, w`.
    Quaternion,
    /// Three or four rows of four numbers.
    Matrix,
    /// An array of items of a form: at least and at most so many.
    Array(&'static Form, usize, usize),
    /// A value of the one form or of the other.
    Either(&'static Form, &'static Form),
    /// A table.
    Table(&'static Record),
    /// An array of tables.
    List(&'static Record),
    /// A table whose keys are names, and its values of a form.
    Named(&'static Form),
}

impl Form {
    pub(super) const NUMBER: Self = Self::Of(Domain::Number);
    pub(super) const POSITIVE: Self = Self::Of(Domain::Positive);
    pub(super) const NON_NEGATIVE: Self = Self::Of(Domain::NonNegative);
    pub(super) const FLAG: Self = Self::Of(Domain::Flag);
    pub(super) const VECTOR: Self = Self::Of(Domain::Position);
    pub(super) const DIRECTION: Self = Self::Of(Domain::Direction);
    pub(super) const COLOR: Self = Self::Of(Domain::Color);
}
