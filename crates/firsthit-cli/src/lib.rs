//! The firsthit program: [`run`] takes the arguments and returns the exit code. A file per command.

mod args;
mod asked;
mod camera;
mod commands;
mod completion;
mod console;
mod environment;
mod exhaustion;
mod failure;
mod help;
mod hints;
mod hits_csv;
mod legend;
mod loading;
mod output;
mod progress;
mod rays;
#[doc(hidden)]
pub mod threads;
mod usage;
mod values;

pub use firsthit_view::explanation;

use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Arc, Mutex};

use clap::{CommandFactory, FromArgMatches};

use args::{Cli, Command};
use failure::Failure;
use progress::Progress;

/// Runs the program with its arguments, the first of which is its own name, and returns the exit
/// code: 0 done, 1 outputs that differ or findings of lint, 2 wrong usage, 3 bad input, 4 the
/// output could not be written, 5 a limit was reached, 70 a bug of ours, 130 interrupted.
pub fn run<I, T>(args: I) -> u8
where
    I: IntoIterator<Item = T>,
    T: Into<OsString> + Clone,
{
    let args: Vec<OsString> = args.into_iter().map(Into::into).collect();
    console::begin_report(usage::wants_json(&args));
    firsthit::inputs::begin_run();
    let cli = match parse(args) {
        Ok(cli) => cli,
        Err(error) => return usage::report(error),
    };
    let exhaustion = exhaustion::catch();
    // A panic is a bug of ours; the user gets one line of it, not a trace. A panic that the library
    // catches in another crate is the file's fault, and gets no line here.
    let last = Arc::new(Mutex::new(String::new()));
    let noted = Arc::clone(&last);
    std::panic::set_hook(Box::new(move |panic| {
        exhaustion.rule_out();
        if let Ok(mut text) = noted.lock() {
            *text = panic.to_string().replace('\n', " ");
        }
    }));
    match catch_unwind(AssertUnwindSafe(|| dispatch(cli))) {
        Ok(Ok(())) => 0,
        Ok(Err(failure)) => failure.report(),
        Err(_) => {
            let text = last.lock().map_or_else(|_| String::new(), |text| text.clone());
            Failure::bug(&text).report()
        }
    }
}

/// The answer of `firsthit info --json` about a file; else the exit code and the message.
///
/// # Errors
///
/// The program's exit code and message: 2 for a file that is neither a 3D file nor an output, 3 for
/// a bad one, 5 where a limit is reached.
pub fn info(file: &Path) -> Result<String, (u8, String)> {
    let args = ["firsthit", "info", "--quiet", "--json", "--"].map(OsString::from);
    let args = args.into_iter().chain([file.into()]).collect();
    let told = match parse(args) {
        Ok(Cli { command: Command::Info(args), verbosity }) => {
            commands::info::text(&args, &Progress::new(&verbosity))
        }
        Ok(_) => unreachable!("the command is info"),
        Err(error) => Err(Failure::usage(error)),
    };
    told.map_err(Failure::into_parts)
}

fn parse(args: Vec<OsString>) -> Result<Cli, clap::Error> {
    // `firsthit render -V` names the program, not a program firsthit-render.
    let command = Cli::command().mut_subcommands(|command| {
        command.display_name("firsthit").mut_args(args::may_begin_with_hyphen)
    });
    Cli::from_arg_matches(&command.try_get_matches_from(args)?)
}

fn dispatch(cli: Cli) -> Result<(), Failure> {
    let progress = &Progress::new(&cli.verbosity);
    progress.catch_interrupts();
    match cli.command {
        Command::Render(args) => commands::render::run(&args, progress),
        Command::View(args) => commands::view::run(&args, progress),
        Command::Shoot(args) => commands::shoot::run(&args, progress),
        Command::Build(args) => commands::build::run(&args, progress),
        Command::Nearest(args) => commands::nearest::run(&args, progress),
        Command::Inside(args) => commands::inside::run(&args, progress),
        Command::Visible(args) => commands::visible::run(&args, progress),
        Command::Thickness(args) => commands::thickness::run(&args, progress),
        Command::Probe(args) => commands::probe::run(&args, progress),
        Command::Info(args) => commands::info::run(&args, progress),
        Command::Diff(args) => commands::diff::run(&args),
        Command::Section(args) => commands::section::run(&args, progress),
        Command::Lint(args) => commands::lint::run(&args, progress),
        Command::Scan(args) => commands::scan::run(&args, progress),
        Command::Dataset(_) => commands::in_python::run("dataset"),
        Command::Parts(_) => commands::in_python::run("parts"),
        Command::Pack(_) => commands::in_python::run("pack"),
        Command::Demo(args) => commands::demo::run(&args, progress),
        Command::Schema { plan } => commands::schema::run(plan),
        Command::Completions { shell } => commands::completions::run(shell),
    }
}
