//! The description of a table in a scene file: its keys, the forms of their values, and rules.

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
    Key {
        name: "",
        form,
        is_required: false,
        about: "",
    }
}

/// A key that must be there.
pub(super) const fn required(form: Form) -> Key {
    Key {
        is_required: true,
        ..optional(form)
    }
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
}

/// The form of a key's value.
#[derive(Debug, Clone, Copy)]
pub(super) enum Form {
    /// A finite number.
    Number,
    /// A number above zero.
    Positive,
    /// A number from zero on.
    NonNegative,
    /// A number strictly between two.
    Between(f64, f64),
    /// A number from the first to the last.
    From(f64, f64),
    /// A positive number, up to the given one.
    UpTo(f64),
    /// A number above another.
    Above(f64),
    /// A whole number from the first to the last.
    Whole(i64, i64),
    Boolean,
    /// Any text but an empty one.
    Text,
    /// A file's name.
    Path,
    /// One of some words.
    OneOf(fn() -> Vec<&'static str>),
    /// One of some words, or a word with the beginning and something after it.
    OneOfOr(fn() -> Vec<&'static str>, &'static str),
    /// One or more of some words, or of words with the beginning, if there is one.
    SomeOf(fn() -> Vec<&'static str>, Option<&'static str>),
    /// Two numbers of which the second is larger.
    Range,
    /// Three numbers.
    Vector,
    /// Three numbers that are not all zero.
    Direction,
    /// Linear red, green and blue, or sRGB as `"#rrggbb"` or by a name of CSS.
    Color,
    /// A colour, or `"transparent"`.
    ColorOrTransparent,
    /// A factor, or one for each axis.
    Scale,
    /// A positive distance, or a point.
    Focus,
    /// `x, y, z, w`.
    Quaternion,
    /// Three or four rows of four numbers.
    Matrix,
    /// Any number of points.
    Points,
    /// Any number of triples of indices.
    Triples,
    /// A table.
    Table(&'static Record),
    /// A table, or an array of them.
    TableOrList(&'static Record),
    /// A number of degrees, or a table.
    Turn(&'static Record),
    /// An array of tables.
    List(&'static Record),
    /// Tables by name.
    Named(&'static Record),
}
