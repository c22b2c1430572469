//! Enums whose variants have names.

use crate::error::Error;

/// The refusal of a name, as that of a `what`, which is none of `names`.
#[doc(hidden)]
pub fn none_of(names: &[&str], what: &'static str, name: &str) -> Error {
    Error::argument(what, format!("one of {}", names.join(", ")), format_args!("'{name}'"))
}

/// Makes an enum of named variants, and everything that depends on the list of names. `$what` is
/// what a name that is none of them is refused as.
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($(#[$doc:meta])* pub enum $kind:ident, $what:literal: $($(#[$of_variant:meta])* $name:literal => $variant:ident;)*) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
        pub enum $kind {
            $($(#[$of_variant])* $variant,)*
        }

        $crate::geometry::names! { $kind, $what: $($name => $variant;)* }
    };
}
#[doc(hidden)]
pub use named;

/// Gives the variants of an enum names, as [`named!`] does: for enums with other derives.
#[doc(hidden)]
#[macro_export]
macro_rules! names {
    ($kind:ident, $what:literal: $($name:literal => $variant:ident;)*) => {
        impl $kind {
            /// Every name.
            pub const NAMES: &[&'static str] = &[$($name),*];

            /// All variants.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The name, as in files and on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }
        }

        impl std::str::FromStr for $kind {
            type Err = $crate::error::Error;

            fn from_str(name: &str) -> $crate::error::Result<Self> {
                match name {
                    $($name => Ok(Self::$variant),)*
                    _ => Err($crate::geometry::none_of(Self::NAMES, $what, name)),
                }
            }
        }
    };
}
#[doc(hidden)]
pub use names;
