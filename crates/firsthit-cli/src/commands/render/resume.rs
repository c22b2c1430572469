//! What `--resume` refuses before anything is made.

use std::path::{Path, PathBuf};

use firsthit::error::escaped;

use super::job::needs_shade;
use crate::failure::Failure;
use crate::output::{self, Order};

/// Refuses a file that cannot hold a state.
pub(super) fn check_name(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("npz") {
        return Ok(());
    }
    let name = escaped(path);
    Err(Failure::usage(format!("--resume: {name} must end in .npz")))
}

/// Refuses a picture without anything to go on with, and a state over another file of the run.
pub(super) fn check(path: &Path, orders: &[Order], inputs: &[PathBuf]) -> Result<(), Failure> {
    if !orders.iter().any(needs_shade) {
        return Err(Failure::usage(
            "--resume is of colours: it needs color, alpha or samples among the --channels",
        ));
    }
    output::check_other(path, orders, inputs)
}
