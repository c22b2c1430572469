//! Values with names: what files, the command line, Python and metadata say of lights, shaders,
//! materials and lenses.

mod macros;

#[doc(hidden)]
pub use macros::{kinds, setting_list, settings};

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};

use super::{Color, DVec3, color_of, require};
use crate::error::{Error, Result};

/// The value of a setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// Yes or no.
    Flag(bool),
    /// A number.
    Number(f64),
    /// Three numbers: a point, a direction, or a linear colour.
    Vector(DVec3),
}

/// The values that a setting may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain {
    /// Yes or no.
    Flag,
    /// A finite number.
    Number,
    /// A number from the first to the last, both included.
    From(f64, f64),
    /// A number between two, both excluded.
    Between(f64, f64),
    /// A number above another.
    Above(f64),
    /// A number above zero, up to another.
    UpTo(f64),
    /// Zero or a number above it.
    NonNegative,
    /// A number above zero.
    Positive,
    /// A number above zero, or infinity.
    PositiveOrInfinite,
    /// A whole number from the first to the last.
    Whole(u32, u32),
    /// A point in the world.
    Position,
    /// A direction in the world, of any length but zero.
    Direction,
    /// A linear colour of a surface: no number is negative.
    Color,
    /// A linear colour of light, however bright: no number is negative.
    Light,
}

/// A setting: its name, its meaning, and which values it may have.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// The name in Rust, in Python, in files and in metadata.
    pub name: &'static str,
    /// The meaning, in a sentence or two.
    pub about: &'static str,
    /// The values that it may have.
    pub domain: Domain,
    /// Whether it has to be given: there is no default value.
    pub is_required: bool,
}

/// A kind of light, shader or material.
#[derive(Debug, Clone, Copy)]
pub struct SettingsSchema {
    /// The name in Python, in files and in metadata.
    pub name: &'static str,
    /// The meaning, in a sentence or two.
    pub about: &'static str,
    /// The settings of the kind.
    pub settings: &'static [Setting],
}

/// A type with settings.
pub trait Settings: Clone {
    /// Every setting, in the order in which they are listed.
    const LIST: &'static [Setting];

    /// The value of each, in the order of [`Settings::LIST`].
    fn values(&self) -> Vec<Value>;

    /// Sets the one with this place in [`Settings::LIST`]; the value has the form of its domain.
    fn put(&mut self, place: usize, value: Value);

    /// Sets one by its name.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a name that is not in the list, and for a value out of its domain.
    fn set(&mut self, name: &str, value: Value) -> Result<()> {
        let Some(place) = Self::LIST.iter().position(|known| known.name == name) else {
            let known: Vec<&str> = Self::LIST.iter().map(|known| known.name).collect();
            let got = format!("{name:?}; there are {}", known.join(", "));
            return Err(Error::argument("setting", "one that is known", got));
        };
        let setting = &Self::LIST[place];
        self.put(place, setting.domain.checked(setting.name, value)?);
        Ok(())
    }

    /// The names and values of all.
    fn named_values(&self) -> Vec<(&'static str, Value)> {
        let names = Self::LIST.iter().map(|known| known.name);
        names.zip(self.values()).collect()
    }

    /// Fails where a value is out of its domain.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`], with the setting's name.
    fn check(&self) -> Result<()> {
        for (setting, value) in Self::LIST.iter().zip(self.values()) {
            setting.domain.checked(setting.name, value)?;
        }
        Ok(())
    }
}

impl Settings for () {
    const LIST: &'static [Setting] = &[];

    fn values(&self) -> Vec<Value> {
        Vec::new()
    }

    fn put(&mut self, _place: usize, _value: Value) {}
}

impl Domain {
    /// The expected values, for messages.
    pub fn expected(self) -> Cow<'static, str> {
        let range = match self {
            Self::Flag => return "true or false".into(),
            Self::Number => return "a finite number".into(),
            Self::NonNegative => return "zero or a positive, finite number".into(),
            Self::Positive => return "a positive, finite number".into(),
            Self::PositiveOrInfinite => return "a positive number, or infinity".into(),
            Self::Position => return "three finite numbers".into(),
            Self::Direction => return "three finite numbers that are not all zero".into(),
            Self::Color | Self::Light => {
                return "a colour of finite numbers that are not negative".into();
            }
            Self::From(least, most) => format!("a number from {} to {}", end(least), end(most)),
            Self::Between(low, high) => format!("a number between {} and {}", end(low), end(high)),
            Self::Above(low) => format!("a finite number above {low}"),
            Self::UpTo(most) => format!("a number above 0 and up to {most}"),
            Self::Whole(least, most) => format!("a whole number from {least} to {most}"),
        };
        range.into()
    }

    /// The value, if it is one of these. A number serves as a grey colour.
    #[doc(hidden)]
    pub fn checked(self, name: &'static str, value: Value) -> Result<Value> {
        let value = match (self, value) {
            (Self::Color | Self::Light, Value::Number(grey)) => Value::Vector(DVec3::splat(grey)),
            _ => value,
        };
        let fits = match value {
            Value::Flag(_) => self == Self::Flag,
            Value::Number(number) => self.has_number(number),
            Value::Vector(v) => match self {
                Self::Position => v.is_finite(),
                Self::Direction => v.is_finite() && v != DVec3::ZERO,
                Self::Color | Self::Light => v.is_finite() && v.min_element() >= 0.0,
                _ => false,
            },
        };
        require(name, self.expected(), fits, value.text()).map(|()| value)
    }

    /// Whether a number is one of these.
    fn has_number(self, x: f64) -> bool {
        match self {
            Self::Number => x.is_finite(),
            Self::From(least, most) => (least..=most).contains(&x),
            Self::Between(low, high) => low < x && x < high,
            Self::Above(low) => x > low && x < f64::INFINITY,
            Self::UpTo(most) => x > 0.0 && x <= most,
            Self::NonNegative => (0.0..f64::INFINITY).contains(&x),
            Self::Positive => x > 0.0 && x < f64::INFINITY,
            Self::PositiveOrInfinite => x > 0.0,
            Self::Whole(least, most) => {
                (f64::from(least)..=f64::from(most)).contains(&x) && x.fract() == 0.0
            }
            _ => false,
        }
    }

    /// The value that a text says: `true`, `0.5`, `1,2,3`, or of a colour its name in CSS or
    /// `#rrggbb`.
    pub fn parsed(self, text: &str) -> Option<Value> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        match self {
            Self::Flag => text.trim().parse().ok().map(Value::Flag),
            Self::Position | Self::Direction => vector(text),
            Self::Color | Self::Light => {
                let named = color_of(text).map(Value::Vector);
                named.or_else(|| vector(text)).or_else(|| number(text).map(Value::Number))
            }
            _ => number(text).map(Value::Number),
        }
    }
}

/// The end of a range, of angles by its name.
fn end(number: f64) -> String {
    let pi = match number.abs() {
        PI => "pi",
        FRAC_PI_2 => "pi/2",
        _ => return number.to_string(),
    };
    format!("{}{pi}", if number < 0.0 { "-" } else { "" })
}

/// Three numbers with commas between.
fn vector(text: &str) -> Option<Value> {
    let parts = text.split(',').map(|part| part.trim().parse().ok());
    let parts: Vec<f64> = parts.collect::<Option<_>>()?;
    let parts: [f64; 3] = parts.try_into().ok()?;
    Some(Value::Vector(parts.into()))
}

impl Value {
    /// Adds it to a digest.
    #[doc(hidden)]
    pub fn digest(self, digest: &mut super::Digest) {
        match self {
            Self::Flag(flag) => digest.numbers(&[f64::from(flag)]),
            Self::Number(number) => digest.numbers(&[number]),
            Self::Vector(vector) => digest.vector(vector),
        }
    }

    /// The value as one writes it.
    pub fn text(self) -> String {
        match self {
            Self::Flag(flag) => flag.to_string(),
            Self::Number(number) => number.to_string(),
            Self::Vector(v) => format!("{},{},{}", v.x, v.y, v.z),
        }
    }
}

/// A type that a setting's field has.
pub trait Field: Copy {
    /// The number as a value.
    fn value(self) -> Value;
    /// The number of a value of this form; `None` for another.
    fn from_value(value: Value) -> Option<Self>;
}

/// Types that are one kind of [`Value`].
macro_rules! fields {
    ($($type:ty => $kind:ident;)*) => {$(
        impl Field for $type {
            fn value(self) -> Value {
                Value::$kind(self)
            }
            fn from_value(value: Value) -> Option<Self> {
                match value {
                    Value::$kind(value) => Some(value),
                    _ => None,
                }
            }
        }
    )*};
}

fields! {
    bool => Flag;
    f64 => Number;
    Color => Vector;
}

impl Field for u32 {
    fn value(self) -> Value {
        Value::Number(f64::from(self))
    }
    fn from_value(value: Value) -> Option<Self> {
        let number = f64::from_value(value)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "`as` saturates, and whoever checks the domain knows that it is whole"
        )]
        let whole = number as Self;
        (f64::from(whole) == number).then_some(whole)
    }
}

#[cfg(test)]
mod tests {
    #![allow(unreachable_pub, reason = "the macro makes what others see")]

    use super::*;

    settings! {
        /// A test.
        pub struct Lamp {
            /// The position.
            position: DVec3, Domain::Position, required DVec3::ZERO;
            /// The brightness.
            color: Color, Domain::Color, default Color::ONE;
            /// The number of flashes.
            count: u32, Domain::Whole(1, 9), default 2;
            /// Whether.
            is_on: bool, Domain::Flag, default true;
        }
    }

    #[test]
    fn settings_are_set_by_name_and_refuse_what_makes_no_sense() {
        let mut lamp = Lamp::default();
        lamp.set("position", Value::Vector(DVec3::X)).unwrap();
        lamp.set("color", Value::Number(0.5)).unwrap();
        lamp.set("count", Value::Number(9.0)).unwrap();
        lamp.set("is_on", Value::Flag(false)).unwrap();
        let expected =
            Lamp { position: DVec3::X, color: DVec3::splat(0.5), count: 9, is_on: false };
        assert_eq!(lamp, expected);
        for (name, value) in [
            ("colour", Value::Number(1.0)),
            ("color", Value::Vector(DVec3::NEG_X)),
            ("count", Value::Number(1.5)),
            ("count", Value::Number(f64::NAN)),
            ("position", Value::Number(1.0)),
            ("is_on", Value::Number(1.0)),
        ] {
            assert!(lamp.set(name, value).is_err(), "{name} {value:?}");
        }
        assert_eq!(lamp, expected);
        assert!(Lamp::LIST[0].is_required && !Lamp::LIST[1].is_required);
        assert_eq!(Lamp::LIST[1].about, "The brightness.");
    }

    #[test]
    fn values_are_read_as_they_are_written() {
        for (domain, value) in [
            (Domain::Flag, Value::Flag(true)),
            (Domain::Positive, Value::Number(0.1)),
            (Domain::Position, Value::Vector(DVec3::new(1e-7, 2.0, -3.5))),
        ] {
            assert_eq!(domain.parsed(&value.text()), Some(value));
        }
        assert_eq!(Domain::Color.parsed("#ffffff"), Some(Value::Vector(DVec3::ONE)));
        assert_eq!(Domain::Positive.parsed("x"), None);
        assert_eq!(Domain::Position.parsed("1,2"), None);
    }
}
