use std::io::Write;

use crate::failure::Failure;

pub(crate) fn run(is_plan: bool) -> Result<(), Failure> {
    let schema = if is_plan {
        firsthit::scene_file::plan_schema()
    } else {
        firsthit::scene_file::schema()
    };
    std::io::stdout()
        .write_all(schema.as_bytes())
        .map_err(|error| Failure::stdout(&error))
}
