use std::sync::atomic::AtomicBool;

use firsthit::channel::VISIBLE;
use firsthit::image::Data;
use firsthit::shoot::{Viewpoint, visible};
use firsthit::{DVec3, Scene};
use serde_json::json;

use super::list::{self, Answers};
use crate::args::ListArgs;
use crate::failure::Failure;
use crate::progress::Progress;

pub(crate) fn run(args: &ListArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let ask = |scene: &Scene, pairs: &[[f64; 6]], progress: &Progress<'_>| {
        let ends = pairs.iter().map(|&[a, b, c, x, y, z]| {
            [DVec3::new(a, b, c), DVec3::new(x, y, z)].map(Viewpoint::new)
        });
        let ends: Vec<_> = ends.collect();
        let seen = visible(scene, &ends, progress)?;
        let count = seen.iter().filter(|&&is_seen| is_seen).count();
        Ok(Answers {
            data: Data::Bool(seen),
            summary: format!("{count} visible"),
            facts: vec![("visible", json!(count))],
            warnings: Vec::new(),
        })
    };
    list::run(args, (VISIBLE, "pair"), ask, interrupted)
}
