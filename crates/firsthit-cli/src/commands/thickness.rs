use std::sync::atomic::AtomicBool;

use firsthit::Scene;
use firsthit::channel::THICKNESS;
use firsthit::image::Data;
use firsthit::measure::thickness;
use serde_json::json;

use super::list::{self, Answers};
use crate::args::ListArgs;
use crate::failure::Failure;
use crate::progress::Progress;

pub(crate) fn run(args: &ListArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let ask = |scene: &Scene, points: &[[f64; 3]], progress: &Progress<'_>| {
        let lengths = thickness(scene, points, progress)?;
        let finite = lengths.iter().copied().filter(|length| length.is_finite());
        let least = finite.reduce(f64::min);
        Ok(Answers {
            data: Data::Float64(lengths),
            summary: least.map_or("nothing behind any".into(), |least| {
                format!("{least} at the thinnest")
            }),
            facts: vec![("least", json!(least))],
            warnings: Vec::new(),
        })
    };
    list::run(args, (THICKNESS, "point"), ask, interrupted)
}
