//! firsthit beside Embree: the same scenes, the same rays, one run. `docs/performance.md` says how
//! to read it.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "counts of rays and triangles, and float64 to float32 on purpose: Embree takes nothing else"
)]

mod check;
mod embree;
mod firsthit_side;
mod measure;
mod memory;
mod pairs;
mod picture;
mod report;
mod row;
mod rows;
mod scenes;
mod settings;
mod tinybvh;
mod tree;
mod visits;

use std::process::ExitCode;

use clap::Parser;
use firsthit::InstructionSet;
use rayon::ThreadPoolBuilder;

use embree::Library;
use report::Report;
use settings::Settings;

fn main() -> ExitCode {
    match run(&Settings::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            eprintln!("firsthit-bench: error: firsthit differs from the judge, see the table");
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("firsthit-bench: error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Makes an instruction set the one that everything is shot with.
#[expect(unsafe_code, reason = "the environment is changed before there are other threads")]
fn choose(set: InstructionSet) {
    // SAFETY: this is the only thread so far.
    unsafe { std::env::set_var("FIRSTHIT_ISA", set.name()) };
}

/// The whole table; false when an answer of firsthit is not the judge's.
fn run(settings: &Settings) -> Result<bool, String> {
    let library = settings
        .embree
        .as_deref()
        .map(Library::open)
        .transpose()
        .map_err(|error| format!("--embree: {error}"))?;
    let device = |library| embree::Device::new(library, settings.embree_isa());
    let device = library.as_ref().map(device).transpose()?;
    let tinybvh = settings
        .tinybvh
        .as_deref()
        .map(tinybvh::Library::open)
        .transpose()
        .map_err(|error| format!("--tinybvh: {error}"))?;
    if let Some(set) = settings.isa {
        choose(set);
    }
    // The main thread is the one worker of the default pool: the measured code runs here, on one
    // thread.
    let failed = |error: rayon::ThreadPoolBuildError| error.to_string();
    let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    alone.build_global().map_err(failed)?;
    let pool = ThreadPoolBuilder::new().num_threads(2).build().map_err(failed)?;
    if settings.pairs {
        return pairs::serve(settings).map(|()| true);
    }
    let mut report = Report::new(settings, device.as_ref());
    for name in settings.scenes()? {
        let scene = scenes::find(&name, &settings.folder)?;
        let trees = tree::measure(&scene, device.as_ref(), settings, &pool)?;
        let tinybvh =
            tinybvh.as_ref().and_then(|library| tinybvh::Tree::new(library, &trees.firsthit));
        report.tree(&scene, &trees);
        rows::measure(&scene, (&trees, tinybvh.as_ref()), settings, &pool, &mut report)?;
    }
    report.finish()
}
