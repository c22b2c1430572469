use std::time::Instant;

use firsthit::error::escaped;
use firsthit::inputs;
use firsthit::section::{Section, SectionFormat, SectionPlane, section_with};
use serde_json::{Value, json};

use crate::args::SectionArgs;
use crate::console::{counted, end_report, is_quiet, print, say, warn};
use crate::failure::Failure;
use crate::hints::{extent, number, place, triple};
use crate::loading::{self, Loaded, NO_RAYS};
use crate::output;
use crate::progress::Progress;
use crate::threads::with_threads;

pub(crate) fn run(args: &SectionArgs, progress: &Progress) -> Result<(), Failure> {
    for path in &args.output {
        SectionFormat::of(path)?;
    }
    inputs::note(&args.file);
    output::check_files(&args.output)?;
    with_threads(args.run.threads, || {
        let started = Instant::now();
        let loaded =
            loading::read(&args.file, &args.load, NO_RAYS, progress)?.picked(&args.pick)?;
        warn(&loaded.warnings);
        output::check_files(&args.output)?;
        let rule = args.fill.rule.unwrap_or_default();
        let cut = section_with(rule, &loaded.scene, plane(args, &loaded)?, progress)?;
        warn(cut.warnings());
        for path in &args.output {
            cut.save(path, progress)?;
        }
        let seconds = started.elapsed().as_secs_f64();
        if args.run.json {
            return end_report(as_json(args, &cut, seconds));
        }
        let text = as_text(args, &cut, extent(loaded.scene.bounds()));
        if args.output.is_empty() {
            return print(&text);
        }
        if !is_quiet() {
            say(text.trim_end());
        }
        Ok(())
    })
}

/// The plane that was asked for; else through the middle, across what is up.
fn plane(args: &SectionArgs, loaded: &Loaded) -> Result<SectionPlane, Failure> {
    let Loaded { scene, model, .. } = loaded;
    let bounds = scene.bounds();
    let middle = if bounds.is_empty() { firsthit::DVec3::ZERO } else { bounds.centre() };
    let origin = args.origin.unwrap_or(middle);
    let normal = args.normal.unwrap_or_else(|| model.up_in(scene));
    Ok(SectionPlane::new(origin, normal)?)
}

/// The numbers of closed and of open polylines.
fn counts(cut: &Section) -> [usize; 2] {
    let closed = cut.polylines().filter(|polyline| polyline.is_closed).count();
    [closed, cut.len() - closed]
}

fn as_text(args: &SectionArgs, cut: &Section, reach: f64) -> String {
    let (plane, [closed, open]) = (cut.plane(), counts(cut));
    let mut lines = vec![
        format!(
            "plane      through {}, normal {}",
            place(plane.origin(), reach),
            triple(plane.normal())
        ),
        format!("curves     {closed} closed, {open} open, {}", counted(segments(cut), "segment")),
        format!("area       {}", number(cut.area())),
        format!("perimeter  {}", number(cut.perimeter())),
    ];
    let written = args.output.iter();
    lines.extend(written.map(|path| format!("written    {}", escaped(path))));
    lines.join("\n") + "\n"
}

fn segments(cut: &Section) -> u64 {
    cut.polylines().map(|polyline| polyline.primitives.len() as u64).sum()
}

fn as_json(args: &SectionArgs, cut: &Section, seconds: f64) -> Value {
    let (plane, [closed, open]) = (cut.plane(), counts(cut));
    let outputs: Vec<Value> =
        (args.output.iter()).map(|path| json!({ "file": path.to_string_lossy() })).collect();
    json!({
        "outputs": outputs,
        "origin": plane.origin().to_array(),
        "normal": plane.normal().to_array(),
        "u": plane.u().to_array(),
        "v": plane.v().to_array(),
        "closed_polylines": closed,
        "open_polylines": open,
        "segments": segments(cut),
        "area": cut.area(),
        "perimeter": cut.perimeter(),
        "left_out": cut.left_out(),
        "seconds": seconds,
    })
}
