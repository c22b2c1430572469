//! Keys that are the settings of a light, a shader or a material, under the names that they have
//! everywhere.

#![allow(
    clippy::indexing_slicing,
    reason = "tables are made when this is compiled, not when a file is read"
)]

use toml::de::DeValue;

use super::document::{integer, number, numbers};
use super::form::color;
use super::section::Section;
use super::table::{Form, Key, Pick, Variant, optional};
use crate::geometry::{Domain, Setting, SettingsSchema, Value};

/// Makes `VARIANTS`: a table's variants, one for each of these kinds, with its settings and the
/// keys that all of them have. The key of a variant is made of the kind's name.
macro_rules! variants {
    ($kinds:expr, |$name:ident| $pick:expr, $common:expr) => {
        const COUNT: usize = $kinds.len();

        static KEYS: [[Key; settings::MOST]; COUNT] = {
            let mut keys = [settings::keys::<{ settings::MOST }>(&[]); COUNT];
            let mut kind = 0;
            while kind < COUNT {
                keys[kind] = settings::keys($kinds[kind].settings);
                kind += 1;
            }
            keys
        };

        static GROUPS: [[&[Key]; 2]; COUNT] = {
            let mut groups: [[&[Key]; 2]; COUNT] = [[&[], $common]; COUNT];
            let mut kind = 0;
            while kind < COUNT {
                groups[kind][0] = KEYS[kind].split_at($kinds[kind].settings.len()).0;
                kind += 1;
            }
            groups
        };

        static VARIANTS: [Variant; COUNT] = {
            let mut variants = [settings::variant(Pick::Always, &[]); COUNT];
            let mut kind = 0;
            while kind < COUNT {
                let $name = $kinds[kind].name;
                variants[kind] = settings::variant($pick, &GROUPS[kind]);
                kind += 1;
            }
            variants
        };
    };
}
pub(super) use variants;

/// The most settings of a kind.
pub(super) const MOST: usize = 16;

/// The keys of settings, and more that are not used.
pub(super) const fn keys<const MOST: usize>(settings: &'static [Setting]) -> [Key; MOST] {
    let mut keys = [optional(Form::NUMBER); MOST];
    let mut place = 0;
    while place < settings.len() {
        let Setting { name, about, domain, is_required } = settings[place];
        keys[place] = Key { name, form: Form::Of(domain), is_required, about };
        place += 1;
    }
    keys
}

/// The keys of settings, none of which has to be given.
pub(super) const fn optional_keys<const MOST: usize>(settings: &'static [Setting]) -> [Key; MOST] {
    let mut keys = keys(settings);
    let mut place = 0;
    while place < MOST {
        keys[place].is_required = false;
        place += 1;
    }
    keys
}

/// A variant that has this tag, and these groups of keys.
pub(super) const fn variant(pick: Pick, keys: &'static [&'static [Key]]) -> Variant {
    let rules = &[];
    Variant { pick, keys, rules }
}

/// The value that a domain may have.
pub(super) fn value(raw: &DeValue<'_>, domain: Domain) -> Option<Value> {
    match domain {
        Domain::Flag => raw.as_bool().map(Value::Flag),
        Domain::Position | Domain::Direction => numbers::<3>(raw).map(|v| Value::Vector(v.into())),
        Domain::Color | Domain::Light => color(raw).map(Value::Vector),
        Domain::Whole(..) => integer(raw).map(|whole| Value::Number(whole as f64)),
        _ => number(raw).map(Value::Number),
    }
}

/// The settings that a table gives, of those that the kind of this name has.
pub(super) fn given(
    section: &Section<'_, '_>,
    kinds: &'static [SettingsSchema],
    name: &str,
) -> Vec<(&'static str, Value)> {
    let kind = kinds.iter().find(|kind| kind.name == name);
    let list = kind.map_or(&[][..], |kind| kind.settings);
    let value = |setting: &Setting| value(section.raw(setting.name)?, setting.domain);
    let given = list.iter().map(|setting| Some((setting.name, value(setting)?)));
    given.flatten().collect()
}
