use firsthit::explain::{ExplainSettings, Explanation, explain, explain_pixel};
use firsthit::{Ray, RayFilter};
use serde_json::json;

use super::ends;
use crate::args::ProbeArgs;
use crate::camera::{camera, check, of_file};
use crate::console::{end_report, print, warn};
use crate::explanation;
use crate::failure::Failure;
use crate::loading::{self, Loaded};
use crate::progress::Progress;
use crate::threads::with_threads;

/// An explanation shoots no more rays than this.
const FEW: u64 = 100;

pub(crate) fn run(args: &ProbeArgs, progress: &Progress) -> Result<(), Failure> {
    check(&args.camera)?;
    let ends = ends(args.t_min, args.t_max)?;
    with_threads(args.threads, || {
        let loaded = loading::read_picked(&args.file, &args.scene, Some(FEW), progress)?;
        warn(&loaded.warnings);
        let (explained, guessed) = probe(args, ends, &loaded, progress)?;
        if args.json {
            let mut done = explanation::json(&explained);
            if let Some(fields) = done.as_object_mut() {
                fields.insert("guessed".to_owned(), json!(guessed));
            }
            return end_report(done);
        }
        let mut text = explanation::text(&explained, args.all);
        if !guessed.is_empty() {
            text.extend(["guessed    ", &guessed.join(", "), "\n"]);
        }
        print(&text)
    })
}

/// The explanation of the ray that the arguments name, and what was guessed of the camera.
fn probe<'a>(
    args: &ProbeArgs,
    (t_min, t_max): (f64, f64),
    loaded: &'a Loaded,
    progress: &Progress,
) -> Result<(Explanation<'a>, Vec<String>), Failure> {
    let Loaded { scene, model, .. } = loaded;
    let filter = RayFilter { cull: args.cull, ..RayFilter::NONE };
    let mut settings = ExplainSettings {
        t_min: Some(t_min),
        t_max: Some(t_max),
        filter,
        ..ExplainSettings::default()
    };
    if args.all {
        settings.behind = usize::MAX;
    }
    if let Some((origin, direction)) = args.ray {
        let ray = Ray::new(origin, direction);
        return Ok((explain(scene, &ray, &settings, progress)?, Vec::new()));
    }
    let base = of_file(&args.camera, model)?;
    let chosen = camera(&args.camera, (&args.file, &base), scene, model)?;
    let pixel = args.pixel.unwrap_or_default();
    let explained = explain_pixel(scene, &chosen.camera, pixel, &settings, progress)?;
    Ok((explained, chosen.guessed))
}
