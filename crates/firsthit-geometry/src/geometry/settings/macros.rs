//! Macros that make structs of settings, and enums of kinds with settings.

/// A list of settings, each with its domain, and `default`, or `required` where it has to be given.
#[doc(hidden)]
#[macro_export]
macro_rules! setting_list {
    (@required required) => { true };
    (@required default) => { false };
    ($($(#[doc = $about:literal])+ $field:ident: $domain:expr, $need:ident;)*) => {
        &[$($crate::geometry::Setting {
            name: stringify!($field),
            about: concat!($($about),+).trim_ascii(),
            domain: $domain,
            is_required: $crate::geometry::setting_list!(@required $need),
        },)*]
    };
}
#[doc(hidden)]
pub use setting_list;

/// Makes a struct of settings, each with its domain and its default value, or `required`.
#[doc(hidden)]
#[macro_export]
macro_rules! settings {
    ($(#[$doc:meta])* pub struct $kind:ident {
        $($(#[doc = $about:literal])+ $field:ident: $type:ty, $domain:expr, $need:ident $default:expr;)*
    }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $kind {
            $($(#[doc = $about])+ pub $field: $type,)*
        }

        impl Default for $kind {
            /// The default values; those that have to be given are there only to be replaced.
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $crate::geometry::Settings for $kind {
            const LIST: &'static [$crate::geometry::Setting] = $crate::geometry::setting_list! {
                $($(#[doc = $about])+ $field: $domain, $need;)*
            };

            fn values(&self) -> Vec<$crate::geometry::Value> {
                vec![$($crate::geometry::Field::value(self.$field),)*]
            }

            #[allow(unused_mut, unused_variables, reason = "some structs have no field")]
            fn put(&mut self, place: usize, value: $crate::geometry::Value) {
                let mut fields = 0..;
                $(if fields.next() == Some(place)
                    && let Some(value) = $crate::geometry::Field::from_value(value)
                {
                    self.$field = value;
                })*
            }
        }
    };
}
#[doc(hidden)]
pub use settings;

/// Gives an enum of kinds its list of kinds, and settings that are read and set by name.
#[doc(hidden)]
#[macro_export]
macro_rules! kinds {
    ($what:literal, $enum:ident { $($(#[doc = $about:literal])* $name:literal => $kind:ident($settings:ty);)* }) => {
        impl $enum {
            /// Every kind, with its settings.
            pub const KINDS: &[$crate::geometry::SettingsSchema] = &[$($crate::geometry::SettingsSchema {
                name: $name,
                about: concat!($($about),*).trim_ascii(),
                settings: <$settings as $crate::geometry::Settings>::LIST,
            }),*];

            /// Every kind's name.
            pub const NAMES: &[&'static str] = &[$($name),*];

            /// One of this name, with its default settings. Those that have to be given are there
            /// only to be replaced.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`](crate::error::Error::Argument) for a name that is not in the
            /// list.
            pub fn named(name: &str) -> $crate::error::Result<Self> {
                match name {
                    $($name => Ok(Self::$kind(<$settings>::default())),)*
                    _ => Err($crate::geometry::none_of(Self::NAMES, $what, name)),
                }
            }

            /// One of this name with these settings, by their names; the others have their
            /// defaults.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`](crate::error::Error::Argument) for a name that is not in the
            /// list, for a setting that it does not have, and for a value that makes no sense.
            pub fn from_settings<'a>(
                name: &str,
                settings: impl IntoIterator<Item = (&'a str, $crate::geometry::Value)>,
            ) -> $crate::error::Result<Self> {
                let mut made = Self::named(name)?;
                for (name, value) in settings {
                    made.set(name, value)?;
                }
                made.check().map(|()| made)
            }

            /// The list of settings.
            pub fn list(&self) -> &'static [$crate::geometry::Setting] {
                match self { $(Self::$kind(_) => <$settings as $crate::geometry::Settings>::LIST,)* }
            }

            /// The name of its kind.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$kind(_) => $name,)* }
            }

            /// The settings, by their names.
            pub fn settings(&self) -> Vec<(&'static str, $crate::geometry::Value)> {
                match self { $(Self::$kind(one) => $crate::geometry::Settings::named_values(one),)* }
            }

            /// Sets one of its settings.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`](crate::error::Error::Argument) for a name that it does not have,
            /// and for a value that makes no sense.
            pub fn set(&mut self, name: &str, value: $crate::geometry::Value) -> $crate::error::Result<()> {
                match self { $(Self::$kind(one) => $crate::geometry::Settings::set(one, name, value),)* }
            }

            /// Fails where a setting makes no sense.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`](crate::error::Error::Argument), with the setting's name.
            pub fn check(&self) -> $crate::error::Result<()> {
                match self { $(Self::$kind(one) => $crate::geometry::Settings::check(one),)* }
            }
        }
    };
}
#[doc(hidden)]
pub use kinds;
