//! Numbers by name: what files, the command line and Python say about a lens.

use crate::error::{Error, Result};

/// Numbers that have names.
pub(super) trait Parameters {
    /// Visits each with its name.
    fn each(&mut self, visit: &mut dyn FnMut(&'static str, &mut f64));
    /// Whether a number is left out where all are listed: it has its default value.
    fn is_silent(&self, _name: &str) -> bool {
        false
    }
}

/// Makes a struct of named numbers, all of which are zero unless said otherwise. One that is `silent` is not listed while it is what
/// it is by default.
macro_rules! parameters {
    ($(#[$doc:meta])* pub struct $kind:ident $((silent $silent:ident))? {
        $($(#[$of_field:meta])* $field:ident = $default:expr,)*
    }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $kind {
            $($(#[$of_field])* pub $field: f64,)*
        }

        impl Default for $kind {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl crate::camera::parameters::Parameters for $kind {
            fn each(&mut self, _visit: &mut dyn FnMut(&'static str, &mut f64)) {
                $(_visit(stringify!($field), &mut self.$field);)*
            }
            $(
                fn is_silent(&self, name: &str) -> bool {
                    name == stringify!($silent) && self.$silent == Self::default().$silent
                }
            )?
        }
    };
}
pub(super) use parameters;

/// Every parameter with its value.
pub(super) fn values(parameters: &mut dyn Parameters) -> Vec<(&'static str, f64)> {
    let mut values = Vec::new();
    parameters.each(&mut |name, value| values.push((name, *value)));
    values.retain(|(name, _)| !parameters.is_silent(name));
    values
}

/// Sets those that are given.
///
/// # Errors
///
/// [`Error::Argument`] for a name that no parameter has.
pub(super) fn set(parameters: &mut dyn Parameters, given: &[(&str, f64)]) -> Result<()> {
    for &(name, value) in given {
        let mut names = Vec::new();
        let mut is_known = false;
        parameters.each(&mut |own, number| {
            names.push(own);
            if own == name {
                *number = value;
                is_known = true;
            }
        });
        if !is_known {
            let expected = "a name that the projection has";
            let known = if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            };
            let got = format!("{name:?}; there are {known}");
            return Err(Error::argument("parameter", expected, got));
        }
    }
    Ok(())
}
