use crate::failure::Failure;

/// Says where a command is that this binary has not. The Python package's program runs it before it
/// comes here.
pub(crate) fn run(command: &str) -> Result<(), Failure> {
    Err(Failure::usage(format!(
        "firsthit {command} comes with the Python package: pip install . in a clone, see README.md"
    )))
}
