//! `firsthit view`: a page that shows a scene, in the browser.

use std::ffi::OsStr;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use firsthit::error::escaped;
use firsthit::image::write_whole;
use firsthit::inputs;
use firsthit::watch::Watch;
use firsthit::world::World;
use firsthit_view::Viewer;
use firsthit_view::server::Server;

use super::render::{Asked, asked_for};
use crate::args::{SceneArgs, ViewArgs};
use crate::camera::{camera, of_file};
use crate::console::{counted, say, warn};
use crate::failure::Failure;
use crate::loading::{self, Loaded};
use crate::output;
use crate::progress::Progress;
use crate::threads;

pub(crate) fn run(args: &ViewArgs, progress: &Progress) -> Result<(), Failure> {
    let asked = Asked {
        given: &args.given,
        camera: &args.camera,
        light: &args.light,
        colors: &args.colors,
        load: &args.scene.load,
    };
    asked.check()?;
    let report = args.output.as_deref().map(|path| Report::new(path, args));
    let report = report.transpose()?;
    // Pictures are made in the threads of connections, which all share these.
    threads::share_threads(args.threads)?;
    let SceneArgs { pick, trees, load } = &args.scene;
    let settings = loading::settings(&args.file, load);
    let build = |_: &World| trees.settings(None);
    let loaded = loading::read_with(&args.file, &settings, build, args.light.color, progress)?;
    let Loaded { scene, warnings, model, .. } = loaded.picked(pick)?;
    warn(&warnings);
    let base = of_file(&args.camera, &model)?;
    let chosen = camera(&args.camera, (&args.file, &base), &scene, &model)?;
    let (scene, appearance) = asked_for(&asked, &model, scene, &chosen.camera)?;
    if let Some(report) = &report {
        output::check_other(report.path, &[])?;
    }
    let viewer = Viewer::new(title(&args.file), scene, appearance, &chosen.camera)?;
    let viewer = viewer
        .shown(model.display, model.edges)
        .warned(warnings.iter().map(ToString::to_string).collect());
    if let Some(report) = &report {
        return report.write(&viewer, progress);
    }
    let server = Server::bind(viewer, args.port.unwrap_or(0)).map_err(|error| {
        let option = args.port.map(|port| format!("--port {port}"));
        let option = option.unwrap_or_else(|| "a free port".to_owned());
        Failure::usage(format!("{option}: {error}"))
    })?;
    let address = server.address();
    // A program that starts this one reads it.
    let mut out = std::io::stdout();
    let _ = writeln!(out, "{address}").and_then(|()| out.flush());
    if !args.no_browser {
        open(&address);
    }
    let is_stopped = || progress.is_stopped();
    let server = if args.keep { server.lingering(None) } else { server };
    server.run(&is_stopped);
    Ok(())
}

/// The page as a file, in place of a server.
struct Report<'a> {
    path: &'a Path,
}

impl<'a> Report<'a> {
    fn new(path: &'a Path, args: &ViewArgs) -> Result<Self, Failure> {
        let is_html = |own: &OsStr| ["html", "htm"].iter().any(|one| own.eq_ignore_ascii_case(one));
        if !path.extension().is_some_and(is_html) {
            let what = format!("--output: {} must end in .html", escaped(path));
            return Err(Failure::usage(what));
        }
        inputs::note(&args.file);
        output::check_other(path, &[])?;
        Ok(Self { path })
    }

    fn write(&self, viewer: &Viewer, watch: &dyn Watch) -> Result<(), Failure> {
        let report = viewer.report(watch)?;
        write_whole(self.path, watch, |out| out.write_all(&report))?;
        let bytes = counted(report.len() as u64, "byte");
        say(format!("{}: {bytes}", escaped(self.path)));
        Ok(())
    }
}

/// The file's name, which the page shows.
fn title(file: &Path) -> String {
    let name = file.file_name().map_or(file, Path::new);
    escaped(name)
}

/// Opens the default browser. The program that opens it is waited for aside: some browsers are that
/// program themselves.
fn open(address: &str) {
    let (program, before): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(before).arg(address);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    std::thread::spawn(move || {
        let status = command.status();
        if !status.is_ok_and(|status| status.success()) {
            say("firsthit: note: no browser could be opened: open the address above");
        }
    });
}
