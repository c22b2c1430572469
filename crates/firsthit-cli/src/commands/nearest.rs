use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use firsthit::Scene;
use firsthit::channel::kind;
use firsthit::image::{Channel, Data, Description, Display, Frame, Unit, WriteSettings};
use firsthit::nearest::{ClosestPoints, Wanted, closest_points, signed_distances};
use firsthit::render::origin;
use serde_json::json;

use crate::args::NearestArgs;
use crate::console::{counted, end_report, report_beside_data, say, warn};
use crate::failure::Failure;
use crate::hits_csv::stream_csv;
use crate::loading::{self, Loaded, with_threads};
use crate::output::{self, Source};
use crate::progress::Progress;
use crate::rays;

pub(crate) fn run(args: &NearestArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let streams = args.output.is_empty();
    if streams {
        report_beside_data();
    }
    let inputs = [args.file.as_path(), args.points.as_path()];
    let targets = output::targets(&args.output, &[], Source::Rays, &inputs)?;
    let started = Instant::now();
    with_threads(&args.run, || {
        let points = rays::read_points(&args.points)?;
        let Loaded {
            scene, warnings, ..
        } = loading::read(&args.file, &args.load, None)?.picked(&args.pick)?;
        warn(&warnings);
        let is_quiet = args.run.quiet || args.run.json;
        let progress = Progress::new(work(args, points.len()), is_quiet, interrupted);
        let frame = answers(args, &scene, &points, &progress)?;
        drop(progress);
        output::write(&frame, &targets, WriteSettings::default(), interrupted)?;
        if streams {
            stream_csv(&frame)?;
        }
        report(args, &frame, points.len(), started)
    })
}

/// How many points are to be done.
fn work(args: &NearestArgs, points: usize) -> u64 {
    points as u64 * if args.signed { 2 } else { 1 }
}

/// The channels of what is nearest to the points.
fn answers(
    args: &NearestArgs,
    scene: &Scene,
    points: &[[f64; 3]],
    progress: &Progress<'_>,
) -> Result<Frame, Failure> {
    let wanted = Wanted {
        count: args.count.map_or(1, |count| count as usize),
        radius: args.radius.unwrap_or(f64::INFINITY),
    };
    let mut found = closest_points(scene, points, wanted, progress)?;
    if args.signed {
        found.distance = signed_distances(scene, points, progress)?;
    }
    let origin = origin(scene, None, None, &[kind("object")?]);
    let mut frame = Frame::new([found.distance.len()]).from_origin(origin);
    if args.count.is_some() {
        frame.push(numbers(points.len(), found.count)?)?;
    }
    for channel in channels(found, args.signed) {
        frame.push(channel)?;
    }
    Ok(frame)
}

fn described(channel: Channel, about: &'static str) -> Channel {
    let is_length = channel.name == "distance" || channel.name == "position";
    let unit = if is_length {
        Unit::SceneLength
    } else {
        Unit::None
    };
    let description = Description {
        about,
        unit,
        ..Description::default()
    };
    Channel {
        description,
        ..channel
    }
}

/// Of each line, which point it is for.
fn numbers(points: usize, count: usize) -> Result<Channel, Failure> {
    let Ok(points) = i32::try_from(points) else {
        return Err(Failure::bad_input(
            "--count numbers points, of which there may be 2147483647",
        ));
    };
    let numbers = (0..points).flat_map(|point| std::iter::repeat_n(point, count));
    let data = Data::Int32(numbers.collect());
    let channel = Channel::new("point", 1, data, Display::Identifier);
    Ok(described(channel, "the number of the point that was given"))
}

fn channels(found: ClosestPoints, is_signed: bool) -> [Channel; 5] {
    let weights = found.barycentric.iter().flat_map(|weights| {
        let [b, c] = weights.to_array();
        [1.0 - b - c, b, c]
    });
    let weights = Data::Float64(weights.collect());
    let position = Data::Float64(found.point.into_flattened());
    let distance = Data::Float64(found.distance);
    [
        described(
            Channel::new("distance", 1, distance, Display::Distance),
            if is_signed {
                "how far away the nearest point is, negative inside; inf if there is none"
            } else {
                "how far away the nearest point is; inf if there is none"
            },
        ),
        described(
            Channel::new("object", 1, Data::Int32(found.object), Display::Identifier),
            "the object's index; -1 if there is none",
        ),
        described(
            Channel::new(
                "primitive",
                1,
                Data::Int32(found.primitive),
                Display::Identifier,
            ),
            "which part of the object; -1 if there is none",
        ),
        described(
            Channel::new("position", 3, position, Display::Position),
            "the nearest point, in world space; nan if there is none",
        ),
        described(
            Channel::new("barycentric", 3, weights, Display::Fraction),
            "the weights of the triangle's corners; nan elsewhere",
        ),
    ]
}

fn report(
    args: &NearestArgs,
    frame: &Frame,
    points: usize,
    started: Instant,
) -> Result<(), Failure> {
    let seconds = started.elapsed().as_secs_f64();
    let found = match frame.channel("object").map(|channel| &channel.data) {
        Some(Data::Int32(objects)) => objects.iter().filter(|&&object| object >= 0).count(),
        _ => 0,
    };
    let names = |files: &[PathBuf]| -> Vec<String> {
        let files = files.iter().map(|file| file.to_string_lossy().into_owned());
        files.collect()
    };
    if args.run.json {
        let channels: Vec<&str> = frame
            .channels()
            .iter()
            .map(|channel| &*channel.name)
            .collect();
        let of_file = |file| json!({"file": file, "channels": channels});
        let files = if args.output.is_empty() {
            vec!["-".to_owned()]
        } else {
            names(&args.output)
        };
        let done = json!({
            "outputs": files.into_iter().map(of_file).collect::<Vec<_>>(),
            "points": points,
            "found": found,
            "seconds": seconds,
        });
        end_report(done).map_err(|error| Failure::stdout(&error))?;
    } else if !args.run.quiet {
        let files: Vec<String> = (args.output.iter())
            .map(|file| firsthit::error::escaped(Path::new(file)))
            .collect();
        let place = if files.is_empty() {
            "standard output".to_owned()
        } else {
            files.join(", ")
        };
        say(format_args!(
            "{place}: {}, {found} found, {seconds:.2} s",
            counted(points as u64, "point"),
        ));
    }
    Ok(())
}
