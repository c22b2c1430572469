use std::sync::atomic::AtomicBool;
use std::time::Instant;

use firsthit::channel::INSIDE;
use firsthit::image::{Data, Frame};
use firsthit::measure::{By, Rule, inside};
use firsthit::render::origin;
use firsthit::{DVec3, Scene};
use serde_json::json;

use super::sinks::{self, Sinks};
use crate::args::InsideArgs;
use crate::console::{counted, end_report, say, warn};
use crate::failure::Failure;
use crate::loading::{self, Loaded, with_threads};
use crate::progress::Progress;
use crate::rays;

pub(crate) fn run(args: &InsideArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    sinks::announce(&args.output);
    let outputs = (&args.output[..], args.format);
    let inputs = [args.file.as_path(), args.points.as_path()];
    let sinks = Sinks::new(outputs, &inputs, &[INSIDE], &args.run)?;
    let started = Instant::now();
    with_threads(&args.run, || {
        let points = rays::read_points(&args.points)?;
        let points: Vec<_> = points.into_iter().map(DVec3::from).collect();
        let Loaded {
            scene, warnings, ..
        } = loading::read(&args.file, &args.load, None)?.picked(&args.pick)?;
        warn(&warnings);
        let progress = Progress::new(points.len() as u64, sinks.is_quiet, interrupted);
        let found = inside(&scene, &points, By::Union, &progress)?;
        drop(progress);
        warn(warning(&scene, &found.rules).as_slice());
        let count = found
            .is_inside
            .iter()
            .filter(|&&is_inside| is_inside)
            .count() as u64;
        let mut frame = Frame::new([points.len()]).from_origin(origin(&scene, None, None));
        frame.push(INSIDE.channel(Data::Bool(found.is_inside)))?;
        sinks.write(&frame, interrupted)?;
        let seconds = started.elapsed().as_secs_f64();
        if args.run.json {
            let rules: Vec<_> = found.rules.iter().map(|rule| rule.name()).collect();
            let done = json!({
                "outputs": sinks.as_json(&[INSIDE]),
                "points": points.len(),
                "inside": count,
                "rules": rules,
                "objects": scene.objects().len(),
                "triangles": scene.triangles(),
                "seconds": seconds,
            });
            end_report(done).map_err(|error| Failure::stdout(&error))?;
        } else if !args.run.quiet {
            let (names, points) = (sinks.names(), counted(points.len() as u64, "point"));
            say(format_args!(
                "{names}: {points}, {count} inside, {seconds:.2} s"
            ));
        }
        Ok(())
    })
}

/// That some objects are open.
fn warning(scene: &Scene, rules: &[Rule]) -> Option<String> {
    let open = rules
        .iter()
        .filter(|&&rule| rule == Rule::WindingNumber)
        .count();
    let all = counted(scene.objects().len() as u64, "object");
    (open > 0).then(|| {
        format!(
            "{open} of {all} open: what is inside is decided by the winding number, not exactly"
        )
    })
}
