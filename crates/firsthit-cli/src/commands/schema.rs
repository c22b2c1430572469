use std::io::Write;

use crate::failure::Failure;

pub(crate) fn run() -> Result<(), Failure> {
    std::io::stdout()
        .write_all(firsthit::scene_file::schema().as_bytes())
        .map_err(|error| Failure::stdout(&error))
}
