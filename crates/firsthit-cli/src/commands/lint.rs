use std::path::Path;

use firsthit::error::{escape_controls, escaped};
use firsthit::inputs;
use firsthit::lint::{Finding, FindingKind, KINDS, LintSettings, Place, Report, lint, save_marked};
use firsthit::{Error, Scene};
use serde_json::{Value, json};

use crate::args::LintArgs;
use crate::console::{counted, end_report, print, say, warn};
use crate::failure::{Failure, INTERRUPTED};
use crate::hints::{self, extent};
use crate::loading;
use crate::output;
use crate::progress::Progress;
use crate::threads::with_threads;

/// The number of places of each kind in texts for people.
const PLACES_IN_TEXT: usize = 3;

/// The number of places of each kind in JSON for programs.
const PLACES_IN_JSON: usize = 100;

pub(crate) fn run(args: &LintArgs, progress: &Progress) -> Result<(), Failure> {
    args.files.iter().for_each(|file| inputs::note(file));
    check_output(args)?;
    let settings = settings(args)?;
    with_threads(args.threads, || {
        let (mut files, mut is_clean) = (Vec::new(), true);
        let mut failed: Option<(u8, String)> = None;
        for file in &args.files {
            match check(file, args, &settings, progress) {
                Ok((scene, report)) => {
                    is_clean &= report.is_clean();
                    if args.json {
                        files.push(as_json(file, &scene, &report));
                    } else {
                        let name = (args.files.len() > 1).then(|| escaped(file) + ":\n");
                        print(&(name.unwrap_or_default() + &as_text(&scene, &report)))?;
                    }
                }
                Err(failure) => {
                    let (code, message) = failure.into_parts();
                    if code == INTERRUPTED {
                        failed = Some((code, message));
                        break;
                    }
                    say(format_args!("firsthit: error: {}", escape_controls(&message)));
                    files.push(json!({ "file": file.to_string_lossy(), "error": message }));
                    failed.get_or_insert((code, message));
                }
            }
        }
        if args.json {
            let mut done = json!({
                "is_clean": is_clean && failed.is_none(),
                "checked": checked(&settings),
                "files": files,
            });
            if let Some((code, message)) = &failed {
                done["error"] = json!(message);
                done["exit_code"] = json!(code);
            }
            end_report(done)?;
        }
        match failed {
            Some((INTERRUPTED, _)) => Err(Error::Interrupted.into()),
            Some((code, _)) => Err(Failure::said(code)),
            None if is_clean => Ok(()),
            None => Err(Failure::no()),
        }
    })
}

/// Refuses an output that cannot take the findings.
fn check_output(args: &LintArgs) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        let extension = path.extension().unwrap_or_default();
        if !extension.eq_ignore_ascii_case("ply") {
            return Err(Failure::usage("--output: the file must end in .ply"));
        }
        if args.files.len() > 1 {
            return Err(Failure::usage("--output takes the findings of one file"));
        }
    }
    output::check_files(args.output.as_slice())
}

/// The names of the kinds that are looked for.
fn checked(settings: &LintSettings) -> Vec<&'static str> {
    let kinds = KINDS.iter().filter(|kind| !settings.ignore.contains(kind));
    kinds.map(|kind| kind.name).collect()
}

/// The scene in `file`, and what is found in it.
fn check(
    file: &Path,
    args: &LintArgs,
    settings: &LintSettings,
    progress: &Progress,
) -> Result<(Scene, Report), Failure> {
    let loaded = loading::read(file, &args.load, args.trees.settings(None), progress)?;
    warn(&loaded.warnings);
    output::check_files(args.output.as_slice())?;
    let report = lint(&loaded.scene, settings, progress)?;
    if let Some(path) = &args.output {
        save_marked(&loaded.scene, &report, path, progress)?;
    }
    Ok((loaded.scene, report))
}

fn settings(args: &LintArgs) -> Result<LintSettings, Failure> {
    let default = if args.json { PLACES_IN_JSON } else { PLACES_IN_TEXT };
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
    let lines = report.findings().iter().flat_map(|finding| of_finding(scene, finding));
    lines.map(|line| escape_controls(&line) + "\n").collect()
}

fn of_finding(scene: &Scene, finding: &Finding) -> Vec<String> {
    let Finding { kind, count, places, note } = finding;
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
        let position = place.position.is_finite().then(|| place.position.to_array());
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
