//! A list of questions, and a channel of answers.

use std::path::Path;
use std::time::Instant;

use firsthit::channel::ChannelKind;
use firsthit::image::{Data, Frame};
use firsthit::render::origin;
use firsthit::watch::Watch as _;
use firsthit::{DVec3, Scene};
use serde_json::{Map, Value, json};

use super::sinks::{self, Sinks};
use crate::args::ListArgs;
use crate::console::{counted, end_report, is_quiet, say, warn};
use crate::failure::Failure;
use crate::hints::far_off;
use crate::loading::{self, Loaded};
use crate::progress::Progress;
use crate::threads::with_threads;

/// The approximate number of rays for one answer.
const RAYS: u64 = 2;

/// The answers to a list.
pub(super) struct Answers {
    /// One for each question.
    pub(super) data: Data,
    /// The summary, such as `3 inside`.
    pub(super) summary: String,
    /// The summary for `--json`, by name.
    pub(super) facts: Vec<(&'static str, Value)>,
    pub(super) warnings: Vec<String>,
}

/// Reads a list of rows of numbers, asks, and writes and reports what the answers are.
pub(super) fn run<const COLUMNS: usize>(
    args: &ListArgs,
    (kind, noun): (&'static ChannelKind, &str),
    read: impl FnOnce(&Path) -> Result<Vec<[f64; COLUMNS]>, Failure> + Send,
    ask: impl FnOnce(&Scene, &[[f64; COLUMNS]], &Progress) -> Result<Answers, Failure> + Send,
    progress: &Progress,
) -> Result<(), Failure> {
    sinks::announce(&args.output);
    let outputs = (&args.output[..], args.format);
    let inputs = [args.file.as_path(), args.points.as_path()];
    let sinks = Sinks::new(outputs, &inputs, &[kind])?;
    let started = Instant::now();
    with_threads(args.run.threads, || {
        let list = read(&args.points)?;
        let rays = Some(list.len() as u64 * RAYS);
        let Loaded { scene, warnings, .. } =
            loading::read_picked(&args.file, &args.scene, rays, progress)?;
        sinks.check()?;
        warn(&warnings);
        let points = list.as_flattened().chunks_exact(3);
        warn(far_off(&scene, points.map(DVec3::from_slice)).as_slice());
        progress.begin("asking", list.len() as u64, "rows");
        let answers = ask(&scene, &list, progress)?;
        progress.end();
        warn(&answers.warnings);
        let mut frame = Frame::new([list.len()]).from_origin(origin(&scene, None, None, &[kind]));
        frame.push(kind.channel(answers.data))?;
        sinks.write(&frame, progress)?;
        let seconds = started.elapsed().as_secs_f64();
        if args.run.json {
            let mut done = Map::new();
            done.insert("outputs".into(), sinks.as_json(&[kind]).into());
            done.insert(format!("{noun}s"), json!(list.len()));
            for (name, fact) in answers.facts {
                done.insert(name.into(), fact);
            }
            done.insert("objects".into(), json!(scene.objects().len()));
            done.insert("triangles".into(), json!(scene.triangles()));
            done.insert("seconds".into(), json!(seconds));
            end_report(Value::Object(done))?;
        } else if !is_quiet() {
            let (names, asked) = (sinks.names(), counted(list.len() as u64, noun));
            let summary = answers.summary;
            say(format_args!("{names}: {asked}, {summary}, {seconds:.2} s"));
        }
        Ok(())
    })
}
