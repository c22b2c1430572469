//! Checks for `--resume` before anything is made.

use std::path::Path;

use super::job::needs_shade;
use crate::failure::Failure;
use crate::output::{self, Order};

/// Refuses a picture without anything to continue, and a state over another file of the run.
pub(super) fn check(path: &Path, orders: &[Order]) -> Result<(), Failure> {
    if !orders.iter().any(needs_shade) {
        return Err(Failure::usage(
            "--resume is of colours: it needs color, alpha or samples among the --channels",
        ));
    }
    output::check_other(path, orders)
}
