//! One table of a scene file, checked against the list of its keys.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::document::{Name, Text, Value, integer, named, number, numbers};
use super::form::color;
use super::suggest::suggestion;
use super::table::{Form, Key, Pick, Record, Rule, Variant};
use super::variant::pick;
use crate::error::{Error, Result, escape_controls};
use crate::geometry::{Color, DVec3};
use crate::io::fault::{Checked, Fault};

/// A table whose keys are all known, of the right form, and in each other's company as they must
/// be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section<'v, 't> {
    text: Text<'t>,
    table: &'v DeTable<'t>,
    /// The byte of the text at which the table begins.
    at: usize,
    variant: &'static Variant,
    /// The variant of the record whose keys the table also has.
    more: Option<&'static Variant>,
}

impl<'v, 't> Section<'v, 't> {
    /// Checks a table that begins at the byte `at`, and all tables in it.
    pub(super) fn new(
        text: Text<'t>,
        table: &'v DeTable<'t>,
        at: usize,
        record: &'static Record,
    ) -> Checked<Self> {
        let variant = pick(text, table, at, record)?;
        let also = variant.also().next();
        let section = Self {
            text,
            table,
            at,
            variant,
            more: also.map(|record| pick(text, table, at, record)).transpose()?,
        };
        section.check_keys()?;
        section.check_rules()?;
        Ok(section)
    }

    fn variants(&self) -> impl Iterator<Item = &'static Variant> + use<> {
        [Some(self.variant), self.more].into_iter().flatten()
    }

    fn keys(&self) -> impl Iterator<Item = &'static Key> + use<> {
        self.variants().flat_map(Variant::keys)
    }

    /// The keys that tell the variant.
    fn tags(&self) -> impl Iterator<Item = &'static str> + use<> {
        let tags = self.variants().filter_map(|variant| variant.pick.tag());
        tags.map(|(tag, _)| tag)
    }

    fn check_keys(&self) -> Checked<()> {
        // In the order of the text, so that the first mistake is the one that is told.
        for (name, value) in in_order(self.table) {
            let word = name.get_ref().as_ref();
            if self.tags().any(|tag| tag == word) {
                continue;
            }
            let Some(key) = self.keys().find(|key| key.name == word) else {
                return Err(self.text.fault(name.span().start, self.unknown(word)));
            };
            check_form(self.text, key.name, key.form, value)?;
        }
        let Some(missing) = self.keys().find(|key| key.is_required && !self.has(key.name)) else {
            return Ok(());
        };
        let (title, expected) = (self.title(), missing.form.expected());
        Err(self.fault(format!("{title} needs `{}`: {expected}", missing.name)))
    }

    fn check_rules(&self) -> Checked<()> {
        for rule in self.variants().flat_map(|variant| variant.rules) {
            let (at, what) = match *rule {
                Rule::NotBoth(a, b) | Rule::OneOf(a, b) if self.has(a) && self.has(b) => {
                    // At the later one, which is the one too many.
                    let at = self.key_at(a).max(self.key_at(b));
                    (at, format!("`{a}` and `{b}` exclude each other"))
                }
                Rule::OneOf(a, b) if !self.has(a) && !self.has(b) => {
                    (self.at, format!("{} needs `{a}` or `{b}`", self.title()))
                }
                Rule::Needs(a, b) if self.has(a) && !self.has(b) => {
                    (self.key_at(a), format!("`{a}` needs `{b}` beside it"))
                }
                _ => continue,
            };
            return Err(self.text.fault(at, what));
        }
        Ok(())
    }

    fn unknown(&self, word: &str) -> String {
        let known = self.keys().map(|key| key.name).chain(self.tags());
        let known: Vec<&str> = known.collect();
        let shown = escape_controls(&word.chars().take(60).collect::<String>());
        if let Some(meant) = suggestion(word, &known) {
            return format!("unknown key `{shown}`, did you mean `{meant}`?");
        }
        let (title, known) = (self.title(), known.join(", "));
        format!("unknown key `{shown}`; {title} takes {known}")
    }

    /// A name of the table for messages.
    fn title(&self) -> String {
        match self.more.unwrap_or(self.variant).pick {
            Pick::Always | Pick::Has(_) => "this table".to_owned(),
            Pick::Tag(key, value) | Pick::Default(key, value) => format!("{key} = \"{value}\""),
        }
    }

    /// The value of the tag that chose the variant.
    pub(super) fn tag(&self) -> Option<&'static str> {
        let tag = self.more.unwrap_or(self.variant).pick.tag();
        tag.map(|(_, value)| value)
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.table.contains_key(name)
    }

    fn get(&self, name: &str) -> Option<&'v Value<'t>> {
        self.table.get(name)
    }

    pub(super) fn raw(&self, name: &str) -> Option<&'v DeValue<'t>> {
        self.get(name).map(Spanned::get_ref)
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        number(self.raw(name)?)
    }

    pub(super) fn whole<N: TryFrom<i64>>(&self, name: &str) -> Option<N> {
        N::try_from(integer(self.raw(name)?)?).ok()
    }

    pub(super) fn boolean(&self, name: &str) -> Option<bool> {
        self.raw(name)?.as_bool()
    }

    pub(super) fn text(&self, name: &str) -> Option<&'v str> {
        self.raw(name)?.as_str()
    }

    /// The items of an array; none where it is not there.
    pub(super) fn items(&self, name: &str) -> impl Iterator<Item = &'v DeValue<'t>> + use<'v, 't> {
        let items = self.raw(name).and_then(DeValue::as_array);
        items.into_iter().flat_map(|items| items.iter()).map(Spanned::get_ref)
    }

    pub(super) fn range(&self, name: &str) -> Option<[f64; 2]> {
        numbers(self.raw(name)?)
    }

    pub(super) fn vector(&self, name: &str) -> Option<DVec3> {
        numbers::<3>(self.raw(name)?).map(DVec3::from)
    }

    pub(super) fn color(&self, name: &str) -> Option<Color> {
        color(self.raw(name)?)
    }

    /// A value that the tables require.
    pub(super) fn need<T>(
        &self,
        name: &str,
        get: impl FnOnce(&Self, &str) -> Option<T>,
    ) -> Checked<T> {
        get(self, name).ok_or_else(|| self.fault(format!("{} needs `{name}`", self.title())))
    }

    /// The table under a key, if it is there.
    pub(super) fn table(&self, name: &str, record: &'static Record) -> Checked<Option<Self>> {
        self.get(name).and_then(|value| self.open(value, record)).transpose()
    }

    /// The tables of an array, or the only one.
    pub(super) fn list(&self, name: &str, record: &'static Record) -> Checked<Vec<Self>> {
        let Some(value) = self.get(name) else {
            return Ok(Vec::new());
        };
        match value.get_ref().as_array() {
            Some(items) => items.iter().filter_map(|item| self.open(item, record)).collect(),
            None => self.open(value, record).into_iter().collect(),
        }
    }

    /// The tables under a key by their names, in the order of the text.
    pub(super) fn named(
        &self,
        name: &str,
        record: &'static Record,
    ) -> Checked<Vec<(&'v str, Self)>> {
        let Some(table) = self.raw(name).and_then(DeValue::as_table) else {
            return Ok(Vec::new());
        };
        let mut found = Vec::new();
        for (name, value) in in_order(table) {
            let word = name.get_ref().as_ref();
            let section = self.open(value, record).ok_or_else(|| {
                let (word, came) = (escape_controls(word), named(value.get_ref()));
                let what = format!("`{word}` must be a table, got {came}");
                self.text.fault(name.span().start, what)
            })?;
            found.push((word, section?));
        }
        Ok(found)
    }

    fn open(&self, value: &'v Value<'t>, record: &'static Record) -> Option<Checked<Self>> {
        let table = value.get_ref().as_table()?;
        Some(Self::new(self.text, table, value.span().start, record))
    }

    /// Checks all tables in it.
    pub(super) fn check_deep(&self) -> Checked<()> {
        for (name, value) in in_order(self.table) {
            if let Some(key) = self.keys().find(|key| key.name == name.get_ref().as_ref()) {
                self.check_tables(value, key.form)?;
            }
        }
        Ok(())
    }

    /// Checks all tables of a value that has a form.
    fn check_tables(&self, value: &'v Value<'t>, form: Form) -> Checked<()> {
        match (form, value.get_ref()) {
            (Form::Table(record), DeValue::Table(_)) => {
                let section = self.open(value, record).transpose()?;
                section.map_or(Ok(()), |section| section.check_deep())
            }
            (Form::List(record), DeValue::Array(items)) => {
                let mut items = items.iter();
                items.try_for_each(|item| self.check_tables(item, Form::Table(record)))
            }
            (Form::Named(form), DeValue::Table(table)) => {
                in_order(table).into_iter().try_for_each(|(name, value)| {
                    check_form(self.text, name.get_ref(), *form, value)?;
                    self.check_tables(value, *form)
                })
            }
            (Form::Either(one, other), _) => {
                let is_first = one.accepts(value);
                self.check_tables(value, if is_first { *one } else { *other })
            }
            _ => Ok(()),
        }
    }

    /// The byte at which a key stands; the table's where it is not there.
    fn key_at(&self, name: &str) -> usize {
        self.table.get_key_value(name).map_or(self.at, |(key, _)| key.span().start)
    }

    /// A fault of the table as a whole.
    pub(super) fn fault(&self, what: impl Into<String>) -> Fault {
        self.text.fault(self.at, what)
    }

    /// A fault of the value of a key.
    pub(super) fn fault_at(&self, name: &str, what: impl Into<String>) -> Fault {
        Fault::at(self.place(name), what)
    }

    /// A fault of an item of the array under a key.
    pub(super) fn fault_in(&self, name: &str, item: usize, what: impl Into<String>) -> Fault {
        let items = self.raw(name).and_then(DeValue::as_array);
        match items.and_then(|items| items.get(item)) {
            Some(value) => self.text.fault(value.span().start, what),
            None => self.fault_at(name, what),
        }
    }

    /// The result of a constructor of the library, its error at the place of the value that it
    /// names.
    pub(super) fn checked<T>(&self, made: Result<T>) -> Checked<T> {
        made.map_err(|error| match &error {
            Error::Argument { name, .. } => self.fault_at(name, error.to_string()),
            _ => Fault::Other(error),
        })
    }

    /// The place of the value of a key.
    pub(super) fn place(&self, name: &str) -> crate::error::Place {
        let at = self.get(name).map_or(self.at, |value| value.span().start);
        self.text.place(at)
    }
}

/// The entries of a table in the order of the text.
pub(super) fn in_order<'v, 't>(table: &'v DeTable<'t>) -> Vec<(&'v Name<'t>, &'v Value<'t>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_unstable_by_key(|(name, _)| name.span().start);
    entries
}

/// Checks the form of a value; tables in it are checked when they are opened.
fn check_form(text: Text<'_>, name: &str, form: Form, value: &Value<'_>) -> Checked<()> {
    if form.accepts(value) {
        return Ok(());
    }
    let culprit = form.culprit(value).unwrap_or(value);
    let came = culprit.get_ref();
    let (name, got, words) = (escape_controls(name), named(came), form.words());
    let what = if let Some(meant) = came.as_str().and_then(|word| suggestion(word, &words)) {
        format!("unknown {name} {got}, did you mean \"{meant}\"?")
    } else {
        let mut expected = form.expected();
        // Most often two brackets are missing.
        if let Form::List(_) = form {
            expected = format!("{expected}, [[{name}]]");
        }
        format!("`{name}` must be {expected}, got {got}")
    };
    Err(text.fault(culprit.span().start, what))
}
