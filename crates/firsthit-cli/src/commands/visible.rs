use std::path::Path;

use firsthit::channel::VISIBLE;
use firsthit::image::Data;
use firsthit::shoot::{Viewpoint, visible};
use firsthit::{DVec3, Scene};
use serde_json::json;

use super::list::{self, Answers};
use crate::args::VisibleArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::rays;

pub(crate) fn run(args: &VisibleArgs, progress: &Progress) -> Result<(), Failure> {
    let read = |path: &Path| match args.from {
        Some(from) => rays::read_pairs_from(path, from),
        None => rays::read_pairs(path),
    };
    let ask = |scene: &Scene, pairs: &[[f64; 6]], progress: &Progress| {
        let ends = pairs.iter().map(|&[a, b, c, x, y, z]| {
            [DVec3::new(a, b, c), DVec3::new(x, y, z)].map(Viewpoint::new)
        });
        let ends: Vec<_> = ends.collect();
        let seen = visible(scene, &ends, args.tolerance, progress)?;
        let count = seen.iter().filter(|&&is_seen| is_seen).count();
        Ok(Answers {
            data: Data::Bool(seen),
            summary: format!("{count} visible"),
            facts: vec![("visible", json!(count))],
            warnings: Vec::new(),
        })
    };
    let noun = if args.from.is_some() { "point" } else { "pair" };
    list::run(&args.list, (VISIBLE, noun), read, ask, progress)
}
