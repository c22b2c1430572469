use std::path::{Path, PathBuf};
use std::time::Instant;

use firsthit::error::escaped;
use firsthit::fhs;
use firsthit::inputs;
use firsthit::scene::BuildSettings;
use serde_json::json;

use crate::args::BuildArgs;
use crate::console::{counted, end_report, is_quiet, say, warn};
use crate::failure::Failure;
use crate::loading;
use crate::output;
use crate::progress::Progress;
use crate::threads::with_threads;

pub(crate) fn run(args: &BuildArgs, progress: &Progress) -> Result<(), Failure> {
    let started = Instant::now();
    let named = PathBuf::from(args.file.file_name().unwrap_or_default()).with_extension("fhs");
    let path = args.output.as_ref().unwrap_or(&named);
    if !path.extension().is_some_and(|own| own.eq_ignore_ascii_case("fhs")) {
        let what = format!("--output: {} must end in .fhs", escaped(path));
        return Err(Failure::usage(what));
    }
    inputs::note(&args.file);
    output::check_other(path, &[])?;
    with_threads(args.run.threads, || {
        let loaded = loading::read(&args.file, &args.load, BuildSettings::default(), progress)?;
        output::check_other(path, &[])?;
        warn(&loaded.warnings);
        let scene = &loaded.scene;
        fhs::save(path, scene, &loaded.model, progress)?;
        let bytes = path.metadata().map_or(0, |written| written.len());
        let seconds = started.elapsed().as_secs_f64();
        if args.run.json {
            let done = json!({
                "outputs": [{"file": path.to_string_lossy()}],
                "bytes": bytes,
                "objects": scene.objects().len(),
                "triangles": scene.triangles(),
                "seconds": seconds,
            });
            end_report(done)?;
        } else if !is_quiet() {
            say(line(path, scene.triangles(), bytes, seconds));
        }
        Ok(())
    })
}

fn line(path: &Path, triangles: u64, bytes: u64, seconds: f64) -> String {
    let (triangles, bytes) = (counted(triangles, "triangle"), counted(bytes, "byte"));
    format!("{}: {triangles}, {bytes}, {seconds:.2} s", escaped(path))
}
