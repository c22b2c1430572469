use firsthit::Scene;
use firsthit::channel::THICKNESS;
use firsthit::image::Data;
use firsthit::measure::thickness_with;
use serde_json::json;

use super::list::{self, Answers};
use crate::args::SolidArgs;
use crate::failure::Failure;
use crate::hints::{extent, place};
use crate::progress::Progress;
use crate::rays;

pub(crate) fn run(args: &SolidArgs, progress: &Progress) -> Result<(), Failure> {
    let rule = args.fill.rule.unwrap_or_default();
    let ask = |scene: &Scene, points: &[[f64; 3]], progress: &Progress| {
        let lengths = thickness_with(rule, scene, points, progress)?;
        let finite = lengths.iter().copied().enumerate();
        let finite = finite.filter(|(_, length)| length.is_finite());
        let least = finite.min_by(|(_, a), (_, b)| a.total_cmp(b));
        Ok(Answers {
            data: Data::Float64(lengths),
            summary: least.map_or("nothing behind any".into(), |(index, least)| {
                let place = place(points[index].into(), extent(scene.bounds()));
                format!("{least} at the thinnest, near point {index} ({place})")
            }),
            facts: vec![
                ("least", json!(least.map(|(_, length)| length))),
                ("least_at", json!(least.map(|(index, _)| index))),
            ],
            warnings: Vec::new(),
        })
    };
    list::run(&args.list, (THICKNESS, "point"), rays::read_positions, ask, progress)
}
