use crate::console::print;
use crate::failure::Failure;

pub(crate) fn run(is_plan: bool) -> Result<(), Failure> {
    let schema =
        if is_plan { firsthit::scene_file::plan_schema() } else { firsthit::scene_file::schema() };
    print(&schema)
}
