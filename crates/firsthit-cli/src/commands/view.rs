//! `firsthit view`: a page that shows a scene, in the browser.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

use firsthit::error::escaped;
use firsthit_view::Viewer;
use firsthit_view::server::Server;

use super::render::{Asked, asked_for};
use crate::args::ViewArgs;
use crate::camera::{camera, of_file};
use crate::console::{say, warn};
use crate::failure::Failure;
use crate::loading::{self, Loaded};

pub(crate) fn run(args: &ViewArgs, interrupted: &AtomicBool) -> Result<(), Failure> {
    let asked = Asked {
        camera: &args.camera,
        light: &args.light,
        colors: &args.colors,
        load: &args.load,
    };
    asked.check()?;
    // Pictures are made in the threads of connections, which all share these.
    loading::share_threads(args.threads)?;
    let loaded = loading::read(&args.file, &args.load, args.light.color)?.picked(&args.pick)?;
    let Loaded {
        scene,
        warnings,
        model,
        ..
    } = loaded;
    warn(&warnings);
    let base = of_file(&args.camera, &model)?;
    let chosen = camera(&args.camera, (&args.file, &base), &scene, &model)?;
    let (scene, appearance) = asked_for(&asked, &model, scene, &chosen.camera)?;
    let viewer = Viewer::new(title(&args.file), scene, appearance, &chosen.camera)?;
    let viewer = viewer
        .shown(model.display, model.edges)
        .warned(warnings.iter().map(ToString::to_string).collect());
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
    let is_stopped = || interrupted.load(Ordering::Relaxed);
    let server = if args.keep {
        server.lingering(None)
    } else {
        server
    };
    server.run(&is_stopped);
    Ok(())
}

/// The file's name, which the page shows.
fn title(file: &Path) -> String {
    let name = file.file_name().map_or(file, Path::new);
    escaped(name)
}

/// Opens the default browser. What opens it is waited for aside: some browsers are that program themselves.
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
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    std::thread::spawn(move || {
        let status = command.status();
        if !status.is_ok_and(|status| status.success()) {
            say("firsthit: note: no browser could be opened: open the address above");
        }
    });
}
