//! Numbers by name: what files, the command line and Python say about a lens.

use crate::error::{Error, Result};
use crate::geometry::{Setting, Settings, Value};

/// A lens' numbers, each with its name, its meaning and its domain.
pub(super) trait Parameters {
    /// Visits each.
    fn each(&mut self, visit: &mut dyn FnMut(&'static Setting, &mut f64));
    /// Whether a number is left out where all are listed: it has its default value.
    fn is_silent(&self, _name: &str) -> bool {
        false
    }
}

impl<S: Settings> Parameters for S {
    fn each(&mut self, visit: &mut dyn FnMut(&'static Setting, &mut f64)) {
        for (place, value) in self.values().into_iter().enumerate() {
            if let (Some(setting), Value::Number(mut number)) = (S::LIST.get(place), value) {
                visit(setting, &mut number);
                self.put(place, Value::Number(number));
            }
        }
    }
}

/// Every parameter with its value.
pub(super) fn values(parameters: &mut dyn Parameters) -> Vec<(&'static str, f64)> {
    let mut values = Vec::new();
    parameters.each(&mut |setting, value| values.push((setting.name, *value)));
    values.retain(|(name, _)| !parameters.is_silent(name));
    values
}

/// Refuses numbers that are out of their domains.
pub(super) fn check(parameters: &mut dyn Parameters) -> Result<()> {
    let mut fine = Ok(());
    parameters.each(&mut |setting, &mut number| {
        let checked = setting.domain.checked(setting.name, Value::Number(number));
        if fine.is_ok() {
            fine = checked.map(drop);
        }
    });
    fine
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
        parameters.each(&mut |setting, number| {
            names.push(setting.name);
            if setting.name == name {
                *number = value;
                is_known = true;
            }
        });
        if !is_known {
            let expected = "a name that the projection has";
            let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            let got = format!("{name:?}; there are {known}");
            return Err(Error::argument("parameter", expected, got));
        }
    }
    Ok(())
}
