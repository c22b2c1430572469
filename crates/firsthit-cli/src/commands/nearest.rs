use std::time::Instant;

use firsthit::Scene;
use firsthit::channel::{ChannelKind, DISTANCE, POINT, SIGNED_DISTANCE, kind};
use firsthit::image::{Data, Frame};
use firsthit::nearest::{
    ClosestPoints, NearestSettings, SignSettings, closest_points, signed_distances_from,
};
use firsthit::render::origin;
use firsthit::watch::Watch as _;
use serde_json::json;

use super::cloud::{Summary, with_column};
use super::sinks::{self, Sinks};
use crate::args::NearestArgs;
use crate::console::{counted, end_report, is_quiet, say, warn};
use crate::failure::Failure;
use crate::loading::{self, Loaded};
use crate::output;
use crate::progress::Progress;
use crate::rays;
use crate::threads::with_threads;

/// The number of rays through a tree that take the time of a search for a nearest point.
const RAYS: u64 = 10;

pub(crate) fn run(args: &NearestArgs, progress: &Progress) -> Result<(), Failure> {
    // With a cloud alone nothing goes to standard output.
    let is_asked = !args.output.is_empty() || args.format.is_some();
    if is_asked || args.cloud.is_empty() {
        sinks::announce(&args.output);
    }
    let kinds = kinds(args)?;
    let outputs = (&args.output[..], args.format);
    let inputs = [args.file.as_path(), args.points.as_path()];
    let sinks = Sinks::new(outputs, &inputs, &kinds)?;
    let sinks = sinks.beside(output::clouds(&args.cloud)?, is_asked)?;
    let started = Instant::now();
    with_threads(args.run.threads, || {
        let cloud = rays::read_cloud(&args.points)?;
        let points = &cloud.positions;
        let rays = Some(points.len() as u64 * RAYS);
        let Loaded { scene, warnings, .. } =
            loading::read_picked(&args.file, &args.scene, rays, progress)?;
        sinks.check()?;
        warn(&warnings);
        progress.begin("measuring", work(args, points.len()), "points");
        let found = search(args, &scene, points, progress)?;
        progress.end();
        let count = points.len();
        let summary = Summary::of(&found.distance);
        let is_found = found.object.iter().filter(|&&object| object >= 0).count();
        let origin = origin(&scene, None, None, &kinds);
        let mut frame = Frame::new([found.distance.len()]).from_origin(origin.clone());
        for (kind, data) in kinds.iter().zip(columns(args, count, found)?) {
            frame.push(kind.channel(data))?;
        }
        if let (Some(distance), false) = (frame.channel("distance"), args.cloud.is_empty()) {
            let cloud = with_column(cloud, distance.clone(), origin)?;
            sinks.write_clouds(&cloud, progress)?;
        }
        sinks.write(&frame, progress)?;
        let seconds = started.elapsed().as_secs_f64();
        if args.run.json {
            let done = json!({
                "outputs": sinks.as_json(&kinds),
                "points": count,
                "found": is_found,
                "distances": summary.map(|summary| summary.as_json()),
                "objects": scene.objects().len(),
                "triangles": scene.triangles(),
                "seconds": seconds,
            });
            end_report(done)?;
        } else if !is_quiet() {
            let (names, asked) = (sinks.names(), counted(count as u64, "point"));
            let summary =
                summary.map_or(String::new(), |summary| format!(", {}", summary.in_words()));
            say(format_args!("{names}: {asked}, {is_found} found{summary}, {seconds:.2} s"));
        }
        Ok(())
    })
}

/// The channels that are written, in this order; [`columns`] has the numbers.
fn kinds(args: &NearestArgs) -> Result<Vec<&'static ChannelKind>, Failure> {
    let mut kinds = Vec::new();
    kinds.extend(args.count.is_some().then_some(POINT));
    kinds.push(if args.signed { SIGNED_DISTANCE } else { DISTANCE });
    for name in ["object", "primitive", "position", "barycentric"] {
        kinds.push(kind(name)?);
    }
    Ok(kinds)
}

/// The number of points to be done: for signs once more.
fn work(args: &NearestArgs, points: usize) -> u64 {
    points as u64 * if args.signed { 2 } else { 1 }
}

fn search(
    args: &NearestArgs,
    scene: &Scene,
    points: &[[f64; 3]],
    progress: &Progress,
) -> Result<ClosestPoints, Failure> {
    let wanted = NearestSettings {
        count: args.count.map_or(1, |count| count as usize),
        radius: args.radius.unwrap_or(f64::INFINITY),
    };
    let mut found = closest_points(scene, points, wanted, progress)?;
    if args.signed {
        let settings = SignSettings {
            rule: args.rule.unwrap_or_default(),
            allow_open: args.allow_open,
            ..SignSettings::default()
        };
        found.distance = signed_distances_from(settings, scene, points, &found.distance, progress)?;
    }
    Ok(found)
}

fn columns(args: &NearestArgs, points: usize, found: ClosestPoints) -> Result<Vec<Data>, Failure> {
    let mut columns = Vec::new();
    if args.count.is_some() {
        let Ok(points) = i32::try_from(points) else {
            return Err(Failure::bad_input(
                "--count numbers points, of which there may be 2147483647",
            ));
        };
        let numbers = (0..points).flat_map(|point| std::iter::repeat_n(point, found.count));
        columns.push(Data::Int32(numbers.collect()));
    }
    let weights = found.barycentric.iter().flat_map(|weights| {
        let [b, c] = weights.to_array();
        [1.0 - b - c, b, c]
    });
    let weights = Data::Float64(weights.collect());
    columns.extend([
        Data::Float64(found.distance),
        Data::Int32(found.object),
        Data::Int32(found.primitive),
        Data::Float64(found.point.into_flattened()),
        weights,
    ]);
    Ok(columns)
}
