use std::io::Write;
use std::path::Path;

use firsthit::Scene;
use firsthit::error::{escape_controls, escaped};
use firsthit::inputs;
use firsthit::lint::{Finding, FindingKind, LintSettings, Place, Report, lint, save_marked};
use serde_json::{Value, json};

use crate::args::LintArgs;
use crate::console::{counted, json_text, kept_warnings, warn};
use crate::failure::Failure;
use crate::hints::{self, extent};
use crate::loading::{self, with_count};
use crate::output;
use crate::progress::Progress;

/// The number of places of each kind in texts for people.
const PLACES_IN_TEXT: usize = 3;

/// The number of places of each kind in JSON for programs.
const PLACES_IN_JSON: usize = 100;

pub(crate) fn run(args: &LintArgs, progress: &Progress) -> Result<(), Failure> {
    let outputs = args.output.as_slice();
    if let Some(path) = &args.output {
        let extension = path.extension().unwrap_or_default();
        if !extension.eq_ignore_ascii_case("ply") {
            return Err(Failure::usage("--output: the file must end in .ply"));
        }
        if args.files.len() > 1 {
            return Err(Failure::usage("--output takes the findings of one file"));
        }
    }
    args.files.iter().for_each(|file| inputs::note(file));
    output::check_files(outputs)?;
    let settings = settings(args)?;
    with_count(args.threads, || {
        let (mut files, mut checked, mut is_clean) = (Vec::new(), Vec::new(), true);
        for file in &args.files {
            let loaded =
                loading::read(file, &args.load, args.trees.settings(None), None, progress)?;
            warn(&loaded.warnings);
            output::check_files(outputs)?;
            let scene = &loaded.scene;
            let report = lint(scene, &settings, progress)?;
            if let Some(path) = &args.output {
                save_marked(scene, &report, path, progress)?;
            }
            is_clean &= report.is_clean();
            checked = report.checked().iter().map(|kind| kind.name).collect();
            if args.json {
                files.push(as_json(file, scene, &report));
            } else {
                let name = (args.files.len() > 1).then(|| escaped(file) + ":\n");
                print(&(name.unwrap_or_default() + &as_text(scene, &report)))?;
            }
        }
        if args.json {
            print(
                &(json_text(&json!({
                    "is_clean": is_clean,
                    "checked": checked,
                    "files": files,
                    "warnings": kept_warnings(),
                })) + "\n"),
            )?;
        }
        if is_clean {
            Ok(())
        } else {
            Err(Failure::no())
        }
    })
}

fn print(text: &str) -> Result<(), Failure> {
    let written = std::io::stdout().write_all(text.as_bytes());
    written.map_err(|error| Failure::stdout(&error))
}

fn settings(args: &LintArgs) -> Result<LintSettings, Failure> {
    let default = if args.json {
        PLACES_IN_JSON
    } else {
        PLACES_IN_TEXT
    };
    let ignore = args.ignore.iter().map(|name| FindingKind::named(name));
    Ok(LintSettings {
        ignore: ignore.collect::<Result<_, _>>()?,
        places: args.places.map_or(default, |places| places as usize),
    })
}

/// The name of the object, if it is about one.
fn name<'a>(scene: &'a Scene, place: &Place) -> Option<&'a str> {
    let object = usize::try_from(place.object?).ok()?;
    Some(scene.objects().get(object)?.name())
}

/// The line about a place, for people.
fn line(scene: &Scene, place: &Place) -> String {
    let position = hints::place(place.position, extent(scene.bounds()));
    let (Some(object), Some(name)) = (place.object, name(scene, place)) else {
        return format!("  at {position}");
    };
    let triangle = place.primitive.map(|k| format!(", triangle {k}"));
    let triangle = triangle.unwrap_or_default();
    format!("  object {object} '{name}'{triangle}, at {position}")
}

fn as_text(scene: &Scene, report: &Report) -> String {
    if report.is_clean() {
        return "clean: nothing was found\n".to_owned();
    }
    let lines = report
        .findings()
        .iter()
        .flat_map(|finding| of_finding(scene, finding));
    lines.map(|line| escape_controls(&line) + "\n").collect()
}

fn of_finding(scene: &Scene, finding: &Finding) -> Vec<String> {
    let Finding {
        kind,
        count,
        places,
        note,
    } = finding;
    let counted = match kind.counted {
        "vertex" if *count != 1 => format!("{count} vertices"),
        "mesh" if *count != 1 => format!("{count} meshes"),
        noun => counted(*count, noun),
    };
    let separator = match &**note {
        "" => "",
        around if around.starts_with("around ") => " ",
        _ => ": ",
    };
    let mut lines = vec![format!("{}: {counted}{separator}{note}", kind.name)];
    lines.extend(places.iter().map(|place| line(scene, place)));
    let more = finding.count - places.len() as u64;
    if more > 0 {
        lines.push(format!("  ... and {more} more (--places N lists them)"));
    }
    lines
}

fn as_json(file: &Path, scene: &Scene, report: &Report) -> Value {
    let place = |place: &Place| {
        let position = place
            .position
            .is_finite()
            .then(|| place.position.to_array());
        json!({
            "object": place.object,
            "name": name(scene, place),
            "primitive": place.primitive,
            "position": position,
        })
    };
    let finding = |finding: &Finding| {
        json!({
            "kind": finding.kind.name,
            "count": finding.count,
            "of": finding.kind.counted,
            "note": finding.note,
            "places": finding.places.iter().map(place).collect::<Vec<_>>(),
        })
    };
    json!({
        "file": file.to_string_lossy(),
        "is_clean": report.is_clean(),
        "findings": report.findings().iter().map(finding).collect::<Vec<_>>(),
    })
}
