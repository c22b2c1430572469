//! Every key of a scene file: the reader, the JSON Schema and the documentation's test all go by
//! these tables.

use super::background::{BACKGROUND, SKY};
use super::camera::CAMERA;
use super::form::Form;
use super::light::LIGHT;
use super::object::OBJECT;
use super::output::OUTPUT;
use super::placement::ROTATION;
use super::shading::SHADING;

/// A key and what it takes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) form: Form,
    pub(super) is_required: bool,
    /// What it means, for people; editors show it.
    pub(super) about: &'static str,
}

pub(super) const fn key(name: &'static str, form: Form, about: &'static str) -> Key {
    Key {
        name,
        form,
        is_required: false,
        about,
    }
}

pub(super) const fn required(name: &'static str, form: Form, about: &'static str) -> Key {
    Key {
        is_required: true,
        ..key(name, form, about)
    }
}

/// A kind of table.
#[derive(Debug)]
pub(super) struct Record {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    /// The first whose `pick` fits is the one; all have the same tag.
    pub(super) variants: &'static [Variant],
}

/// One form of a table.
#[derive(Debug)]
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

/// What tells a table's variants apart.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pick {
    /// Nothing: there is one.
    Always,
    /// That the key is there.
    Has(&'static str),
    /// That the key has the value.
    Tag(&'static str, &'static str),
    /// The same, or that it is not there.
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

/// How keys go together.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rule {
    NotBoth(&'static str, &'static str),
    /// The first does nothing without the second.
    Needs(&'static str, &'static str),
    /// Exactly one of the two has to be there.
    OneOf(&'static str, &'static str),
}

/// Every kind of table, the file itself first.
pub(super) const RECORDS: &[&Record] = &[
    &SCENE,
    &CAMERA,
    &OBJECT,
    &ROTATION,
    &LIGHT,
    &BACKGROUND,
    &SKY,
    &SHADING,
    &OUTPUT,
];

pub(super) static SCENE: Record = Record {
    name: "scene",
    about: "A scene for firsthit: cameras, objects, lights, background and outputs.",
    variants: &[Variant {
        pick: Pick::Always,
        keys: &[&[
            key(
                "version",
                Form::Whole(1, 1),
                "The version of this form of scene file. There is one, 1, which is the default.",
            ),
            key(
                "up",
                Form::Direction,
                "Which way is up, for cameras and the sky where they do not say. Default: [0, 0, 1].",
            ),
            key(
                "camera",
                Form::Table(&CAMERA),
                "The camera that a picture is taken with, unless another is asked for.",
            ),
            key(
                "cameras",
                Form::Named(&CAMERA),
                "Further cameras, each a table [cameras.NAME]. Without [camera] the first of them takes the picture.",
            ),
            key(
                "objects",
                Form::List(&OBJECT),
                "What there is to see, in the order of the identifiers.",
            ),
            key(
                "lights",
                Form::List(&LIGHT),
                "What shines. Without any, one light over the camera's shoulder does.",
            ),
            key(
                "background",
                Form::Table(&BACKGROUND),
                "What is seen where nothing is hit: one colour.",
            ),
            key(
                "sky",
                Form::Table(&SKY),
                "What is seen where nothing is hit: a sky.",
            ),
            key(
                "shading",
                Form::Table(&SHADING),
                "How hits get their colour.",
            ),
            key(
                "outputs",
                Form::List(&OUTPUT),
                "The files that firsthit render writes unless told otherwise by -o.",
            ),
        ]],
        rules: &[Rule::NotBoth("background", "sky")],
    }],
};

/// The tags of a record, for the lists that they must be the same as.
#[cfg(test)]
pub(super) fn tags(record: &Record) -> Vec<&'static str> {
    let tags = record
        .variants
        .iter()
        .filter_map(|variant| variant.pick.tag());
    tags.map(|(_, value)| value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::shade::Shader;
    use crate::shape::Shape;

    #[test]
    fn every_kind_there_is_can_be_in_a_scene_file() {
        let sorted = |names: &[&'static str]| {
            let mut names = names.to_vec();
            names.sort_unstable();
            names
        };
        assert_eq!(sorted(&tags(&OBJECT)), sorted(Shape::NAMES));
        assert_eq!(tags(&CAMERA), Projection::NAMES);
        assert_eq!(tags(&SHADING), Shader::NAMES);
    }

    #[test]
    fn no_table_has_a_key_twice_and_rules_name_keys_that_it_has() {
        for record in RECORDS {
            for variant in record.variants {
                let mut names: Vec<_> = variant.keys().map(|key| key.name).collect();
                for rule in variant.rules {
                    let (Rule::NotBoth(a, b) | Rule::Needs(a, b) | Rule::OneOf(a, b)) = *rule;
                    assert!(names.contains(&a) && names.contains(&b), "{rule:?}");
                }
                let count = names.len();
                names.sort_unstable();
                names.dedup();
                assert_eq!(names.len(), count, "{}", record.name);
            }
        }
    }
}
