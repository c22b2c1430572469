use firsthit::channel::INSIDE;
use firsthit::image::Data;
use firsthit::measure::{Grouping, Rule, inside_with};
use firsthit::{DVec3, Scene};
use serde_json::json;

use super::list::{self, Answers};
use crate::args::SolidArgs;
use crate::console::counted;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::rays;

pub(crate) fn run(args: &SolidArgs, progress: &Progress) -> Result<(), Failure> {
    let rule = args.fill.rule.unwrap_or_default();
    let ask = |scene: &Scene, points: &[[f64; 3]], progress: &Progress| {
        let points: Vec<_> = points.iter().copied().map(DVec3::from).collect();
        let found = inside_with(rule, scene, &points, Grouping::Union, progress)?;
        let held = found.is_inside.iter().filter(|&&is_inside| is_inside);
        let count = held.count();
        let rules: Vec<_> = found.rules.iter().map(|rule| rule.name()).collect();
        Ok(Answers {
            data: Data::Bool(found.is_inside),
            summary: format!("{count} inside"),
            facts: vec![("inside", json!(count)), ("rules", json!(rules))],
            warnings: warning(scene, &found.rules).into_iter().collect(),
        })
    };
    list::run(&args.list, (INSIDE, "point"), rays::read_positions, ask, progress)
}

/// The warning that some objects are open.
fn warning(scene: &Scene, rules: &[Rule]) -> Option<String> {
    let open = rules.iter().filter(|&&rule| rule == Rule::WindingNumber).count();
    let of_all = format!("{} of {}", counted(open as u64, "object"), scene.objects().len());
    let are = if open == 1 { "is" } else { "are" };
    (open > 0).then(|| {
        format!("{of_all} {are} open: what is inside is decided by the winding number, not exactly")
    })
}
