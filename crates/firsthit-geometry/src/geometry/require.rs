//! Checks of constructors' arguments.

use std::borrow::Cow;
use std::fmt::Display;

use super::DVec3;
use crate::error::{Error, Result};

/// [`Error::Argument`] unless the value is fine.
#[doc(hidden)]
pub fn require(
    name: &'static str,
    expected: impl Into<Cow<'static, str>>,
    fine: bool,
    got: impl Display,
) -> Result<()> {
    if fine { Ok(()) } else { Err(Error::argument(name, expected, got)) }
}

#[doc(hidden)]
pub fn require_finite(name: &'static str, value: DVec3) -> Result<DVec3> {
    require(name, "finite", value.is_finite(), value).map(|()| value)
}

#[doc(hidden)]
pub fn require_direction(name: &'static str, value: DVec3) -> Result<DVec3> {
    let fine = value.is_finite() && value != DVec3::ZERO;
    require(name, "a finite direction, not zero", fine, value).map(|()| value)
}

#[doc(hidden)]
pub fn require_positive(name: &'static str, value: f64) -> Result<f64> {
    let fine = value > 0.0 && value.is_finite();
    require(name, "positive and finite", fine, value).map(|()| value)
}
