use std::path::PathBuf;

use firsthit::error::escaped;
use firsthit::image::SCAN_EXTENSIONS;
use firsthit::scan::{Returns, Scan, ScanSettings, scan};
use firsthit::scene::{Build, BuildSettings};
use firsthit::watch::Watch as _;
use firsthit::{DVec3, Scene, inputs};
use serde_json::json;

use super::scanner::Scanner;
use crate::args::ScanArgs;
use crate::camera::axis;
use crate::console::{counted, end_report, is_quiet, say, warn};
use crate::failure::Failure;
use crate::hints::{extent, number, place, span};
use crate::loading::{self, Loaded, called};
use crate::output;
use crate::progress::{Progress, RAYS};
use crate::threads::with_threads;

pub(crate) fn run(args: &ScanArgs, progress: &Progress) -> Result<(), Failure> {
    let outputs = outputs(args)?;
    let settings = settings(args)?;
    inputs::note(&args.file);
    output::check_files(&outputs)?;
    let scanner = Scanner::of(&args.given, &args.scanner, &args.place)?;
    with_threads(args.run.threads, || {
        let [rows, columns] = scanner.shape;
        let columns = columns * scanner.turns;
        let lines = (rows * columns) as u64;
        let lines = lines.saturating_mul(settings.lines() as u64);
        let build = BuildSettings { build: Build::Auto, rays: Some(lines) };
        let loaded = loading::read(&args.file, &args.load, build, progress)?;
        warn(&loaded.warnings);
        let up = loaded.model.up_in(&loaded.scene);
        let is_guessed = scanner.needs_up(&args.place) && loaded.model.up_is_guessed;
        let guessed = is_guessed.then(|| format!("up {} (--up)", axis(up)));
        progress.begin("scanning", lines, RAYS);
        let (scan, start) = turns(args, (&scanner, up), &settings, &loaded, progress)?;
        progress.end();
        output::check_files(&outputs)?;
        if scan.is_empty() {
            warn(&[why_none(&loaded.scene, start, &settings)]);
        }
        for path in &outputs {
            scan.write(path, progress)?;
        }
        let returns = scan.len() as u64;
        if args.run.json {
            let done = json!({
                "file": args.file.to_string_lossy(),
                "outputs": outputs.iter().map(|path| path.to_string_lossy()).collect::<Vec<_>>(),
                "lidar": scanner.name,
                "turns": scanner.turns,
                "rows": rows,
                "columns": columns,
                "returns": returns,
                "guessed": guessed.iter().collect::<Vec<_>>(),
                "scene": loaded.scene.fingerprint(),
            });
            return end_report(done);
        }
        if !is_quiet() {
            let mut what = format!("{} of {rows} x {columns} beams", counted(returns, "return"));
            if scanner.turns > 1 {
                what = format!("{what} in {} turns", scanner.turns);
            }
            if let Some(guessed) = guessed {
                what = format!("{what}; guessed: {guessed}");
            }
            for path in &outputs {
                say(format_args!("{}: {what}", escaped(path)));
            }
        }
        Ok(())
    })
}

/// The files to write, of formats that can be written.
fn outputs(args: &ScanArgs) -> Result<Vec<PathBuf>, Failure> {
    if args.output.is_empty() {
        let stem = args.file.file_stem().unwrap_or_default().to_string_lossy();
        return Ok(vec![format!("{stem}-scan.ply").into()]);
    }
    for path in &args.output {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if !SCAN_EXTENSIONS.contains(&&*extension.to_string_lossy()) {
            let known = SCAN_EXTENSIONS.iter().map(|known| format!(".{known}"));
            return Err(Failure::usage(format!(
                "--output must end in one of {}, got {}",
                known.collect::<Vec<_>>().join(", "),
                escaped(path)
            )));
        }
    }
    Ok(args.output.clone())
}

/// The settings, checked before anything is read.
fn settings(args: &ScanArgs) -> Result<ScanSettings, Failure> {
    let given = &args.returns;
    if given.max_returns.is_some() && given.returns != Returns::All {
        return Err(Failure::usage("--max-returns needs --returns all"));
    }
    if given.seed.is_some() && given.noise.is_none() && given.dropout.is_none() {
        return Err(Failure::usage("--seed needs --noise or --dropout"));
    }
    let settings = ScanSettings {
        returns: given.returns,
        divergence: given.divergence,
        subrays: given.subrays.unwrap_or(16),
        range_gate: given.range_gate,
        max_returns: given.max_returns,
        min_range: given.min_range,
        max_range: given.max_range.unwrap_or(f64::INFINITY),
        intensity: given.intensity,
        noise: given.noise,
        dropout: given.dropout,
        seed: given.seed,
        rings: given.rings,
    };
    settings.check()?;
    Ok(settings)
}

/// All turns as one scan, and where the scanner is at first.
fn turns(
    args: &ScanArgs,
    (scanner, up): (&Scanner<'_>, DVec3),
    settings: &ScanSettings,
    loaded: &Loaded,
    progress: &Progress,
) -> Result<(Scan, DVec3), Failure> {
    let last = scanner.turns - 1;
    if let Some(seed) = settings.seed
        && seed.checked_add(last as u64).is_none_or(|seed| seed >= 1 << 63)
    {
        return Err(Failure::usage(format!(
            "--seed must leave a number below 2^63 to each turn, got {seed}"
        )));
    }
    let pose = scanner.pose(&args.place, up)?;
    let classes = classes(args, &loaded.scene)?;
    // An error of the last turn is told before any is scanned.
    let first = scanner.at(0, pose)?;
    scanner.at(last, pose)?;
    warn(settings.warning().as_slice());
    let scans = (0..scanner.turns).map(|turn| {
        let settings =
            ScanSettings { seed: settings.seed.map(|seed| seed + turn as u64), ..*settings };
        let scan = scan(&scanner.at(turn, pose)?, &loaded.scene, &settings, progress)?;
        match &classes {
            Some(classes) => Ok(scan.classified(classes)?),
            None => Ok(scan),
        }
    });
    let mut scans = scans.collect::<Result<Vec<Scan>, Failure>>()?;
    let scan = match scans.len() {
        1 => scans.remove(0),
        _ => Scan::joined(scans)?,
    };
    Ok((scan, first.pose(0).position))
}

/// The class of each object, if some are given.
fn classes(args: &ScanArgs, scene: &Scene) -> Result<Option<Vec<u8>>, Failure> {
    let objects = scene.objects();
    let mut classes = vec![0; objects.len()];
    for (name, class) in &args.returns.classes {
        for object in called(objects, name)? {
            classes[object] = *class;
        }
    }
    Ok((!args.returns.classes.is_empty()).then_some(classes))
}

/// The reason why a scan may have met nothing.
fn why_none(scene: &Scene, start: DVec3, settings: &ScanSettings) -> String {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return "no beam met anything: there is nothing to see".to_owned();
    }
    format!(
        "no beam met anything: the scanner starts at {}, the scene goes from {}, and ranges of {} to {} count",
        place(start, extent(bounds)),
        span(bounds),
        number(settings.min_range),
        number(settings.max_range)
    )
}
