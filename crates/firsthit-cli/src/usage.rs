//! Reports clap's errors in one line, as the program's other errors.

use std::ffi::OsString;
use std::path::Path;

use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use firsthit::error::escape_controls;

use crate::args::Cli;
use crate::console::{end_report_with_error, say};
use crate::failure::USAGE;
use crate::loading::has_model_extension;

/// Prints what was asked for, help or version, or what is wrong with the command line; returns the
/// exit code.
pub(crate) fn report(mut error: Error) -> u8 {
    if let Some(option) = swapped(&error) {
        error.insert(ContextKind::SuggestedArg, ContextValue::String(option));
    }
    let error = &error;
    match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // A closed pipe (`firsthit --help | head -1`) is nothing to complain about.
            let _ = error.print();
        }
        _ => {
            let line =
                file_for_command(error).or_else(|| elsewhere(error)).unwrap_or_else(|| line(error));
            end_report_with_error(&line, USAGE);
            say(format_args!("firsthit: error: {line}"));
        }
    }
    u8::try_from(error.exit_code()).unwrap_or(USAGE)
}

/// Whether `--json` is among the arguments, before it is known whether they make sense.
pub(crate) fn wants_json(args: &[OsString]) -> bool {
    let options = args.iter().skip(1).take_while(|&arg| arg != "--");
    options.into_iter().any(|arg| arg == "--json")
}

/// The message for a file where a command belongs.
fn file_for_command(error: &Error) -> Option<String> {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    let path = Path::new(word);
    let shown = escape_controls(word);
    if path.is_dir() {
        return Some(format!("{shown} is a folder, not a command; see --help"));
    }
    let is_output = firsthit::image::format_of(path).is_ok();
    let is_model = has_model_extension(path);
    if !(is_output || is_model || path.is_file()) {
        return None;
    }
    let command = if is_output && !is_model { "info" } else { "render" };
    // As it would have to be typed.
    let is_plain = |c: char| c.is_alphanumeric() || "._-/+:,@%".contains(c);
    let typed = if shown.chars().all(is_plain) {
        shown.clone()
    } else {
        format!("'{}'", shown.replace('\'', r"'\''"))
    };
    Some(format!(
        "{shown} is a file, not a command; did you mean firsthit {command} {typed}? see --help"
    ))
}

/// The message for an option that there is under no name: what has it instead.
fn elsewhere(error: &Error) -> Option<String> {
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else {
        return None;
    };
    let is_bar = ["--color-bar", "--colour-bar", "--colorbar", "--colourbar"].contains(&&**option);
    let is_unknown = error.kind() == ErrorKind::UnknownArgument;
    (is_bar && is_unknown).then(|| {
        let instead = "plot() of the Python package draws a bar of colours, a file has none";
        format!("unexpected argument '{option}': {instead}")
    })
}

/// clap's message and tips; its usage is left to `--help`.
fn line(error: &Error) -> String {
    let text = error.render().to_string();
    let mut line = String::new();
    for part in text.split("\n\n").map(str::trim) {
        if part.starts_with("Usage:") || part.starts_with("For more information") {
            continue;
        }
        let words: Vec<&str> = part.lines().map(str::trim).collect();
        if !line.is_empty() {
            line += "; ";
        }
        line += words.join(" ").trim_start_matches("error: ");
    }
    let help = command(&text).map_or("--help".into(), |name| format!("firsthit {name} --help"));
    format!("{}; see {help}", escape_controls(&line))
}

/// The command whose usage a message has.
fn command(message: &str) -> Option<&str> {
    let (_, usage) = message.split_once("Usage: firsthit ")?;
    let name = usage.split_whitespace().next()?;
    name.starts_with(char::is_alphabetic).then_some(name)
}

/// The option of the command that has both words of an unknown one, the other way round.
fn swapped(error: &Error) -> Option<String> {
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else {
        return None;
    };
    let (first, last) = option.strip_prefix("--")?.split_once('-')?;
    let swapped = format!("{last}-{first}");
    let program = Cli::command();
    let command = program.find_subcommand(command(&error.render().to_string())?)?;
    let mut options = command.get_arguments().filter_map(clap::Arg::get_long);
    options.any(|long| long == swapped).then(|| format!("--{swapped}"))
}
